#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

const std::vector<Setting> kForwards = {{"T", "200"}};

std::vector<Setting> with(std::vector<Setting> settings, const Setting& one) {
  settings.push_back(one);
  return settings;
}

std::vector<Setting> quasistatic(const std::string& velocity) {
  return {{"v", velocity},
          {"T", "3 * a / v"},
          {"run.dynamics", "\"quasistatic\""},
          {"run.integrator", "{ type = \"continuation\" }"},
          {"measure.from", "1"},
          {"measure.to", "3"},
          {"measure.in", "driver_periods"}};
}

/// Force of the driver after it has come v T, for the tip in its minimum as a spring.
double quasi_static(double v, double duration) {
  const double k = 2.0;
  const double c = 2.0;
  const double curvature = kTau * kTau * 0.1;
  const double speed = k * v / (k + curvature);
  return k * ((v - speed) * duration + c * speed / (k + curvature));
}

ExtremeCase way(const std::string& name, const std::string& velocity, const Setting& scheme,
                std::vector<std::string> words) {
  return fails(kWay, name, "a prescribed velocity of " + velocity,
               {{"body.tip.motion.velocity", "[\"" + velocity + "\"]"}, scheme}, std::move(words));
}

}  // namespace

Subject driving() {
  return {
      "driving",
      "Driving: velocity and prescribed ways",
      {finishes(kTip, "velocity_0", "a driver at rest", {{"v", "0"}},
                {is("drivers.driver.final_force.x", 0.0, 1e-15, "nothing pulls"),
                 is("drivers.driver.mean_force.x", 0.0, 1e-15, "nothing pulls")}),
       finishes(kTip, "backwards", "a driver that pulls backwards", with(kForwards, {"v", "-0.01"}),
                {is_that_of("drivers.driver.mean_force.x", kTip, kForwards, 1e-8,
                            "minus that of the way forwards", -1.0)},
                {FaultCode::run_few_slips}),
       finishes(kTip, "velocity_1e3", "a velocity of 1e3", {{"v", "1e3"}},
                {is("drivers.driver.final_force.x", 2e3, 2e-4,
                    "drag; the tolerance is relative to the velocity")}),
       fails(kTip, "velocity_1e3_long_run", "the same for 1e11 periods",
             {{"v", "1e3"}, {"T", "1e8"}}, {"the run would take", "most_steps"}),
       fails(kTip, "velocity_1e3_long_step", "the same at ten periods a step",
             {{"v", "1e3"}, rk4(1e-2)}, {"further in one step than is allowed"}),
       finishes(kTip, "velocity_1e_12", "a velocity of 1e-12, a run of 3e-10 of a period",
                {{"v", "1e-12"}, {"T", "300"}, rk4(0.05)},
                {is("drivers.driver.final_force.x", quasi_static(1e-12, 300.0), 2e-15,
                    "the minimum as a spring; positions round to 1e-16")},
                {FaultCode::run_window_too_short}),
       fails(kTip, "velocity_1e_12_adaptive", "the same over three periods, adaptive",
             {{"v", "1e-12"}, {"T", "3 * a / v"}}, {"would take at least", "dopri5", "most_steps"}),
       finishes(kTip, "velocity_1e_12_implicit", "the same, the implicit scheme",
                {{"v", "1e-12"},
                 {"T", "3 * a / v"},
                 {"run.integrator", "{ type = \"radau9\" }"},
                 {"measure.from", "1"},
                 {"measure.to", "3"},
                 {"measure.in", "driver_periods"}},
                {is_that_of("drivers.driver.mean_force.x", kTip,
                            {{"v", "1e-6"},
                             {"T", "3 * a / v"},
                             {"run.integrator", "{ type = \"radau9\" }"},
                             {"measure.from", "1"},
                             {"measure.to", "3"},
                             {"measure.in", "driver_periods"}},
                            1e-3, "a velocity of 1e-6, less as v^(2/3)")},
                {FaultCode::run_few_slips}),
       refused(kTip, "velocity_1e_12_fixed", "the same with fixed steps",
               {{"v", "1e-12"}, {"T", "3 * a / v"}, rk4(1e-2)}, {"3e+14 steps", "days"}),
       finishes(kTip, "velocity_1e_12_quasistatic", "the same, following the equilibria",
                quasistatic("1e-12"),
                {is_that_of("drivers.driver.mean_force.x", kTip, quasistatic("1"), 1e-9,
                            "a velocity of 1: equilibria know no velocity")},
                {FaultCode::run_few_slips}),
       finishes(kWay, "way", "nothing: for comparison", {},
                {is("drivers.tip.mean_force.x", 0.0, 1e-12, "whole periods of a substrate")}),
       finishes(kWay, "way_1e_300", "a prescribed velocity of 1e-300",
                {{"body.tip.motion.velocity", "[1e-300]"}},
                {is("drivers.tip.final_force.x", -kTau * kTau * 0.1 * 10.0e-300, 1e-308,
                    "the substrate's curvature times the way")},
                {FaultCode::run_window_too_short}),
       way("way_1e300", "1e300", rk4(1e-2), {"periods in a step", "too long"}),
       way("way_1e19", "1e19", rk4(1e-2), {"periods in a step", "too long"}),
       way("way_exp", "exp(100 * t)", rk4(1e-2), {"periods in a step", "too long"}),
       way("way_1e10_adaptive", "1e10", dopri5(1e-9), {"would take at least", "most_steps"}),
       finishes(
           kWay, "way_too_fast_to_see", "a prescribed velocity that swings 1e7 times a step",
           {{"body.tip.motion.velocity", "[\"sin(1e10 * t)\"]"}},
           {is("bodies.tip.centre_of_mass.x", 0.0, 1.0, "the true way, 1e-10: no digit of it")},
           {FaultCode::integrator_unresolved_time}),
       finishes(kWay, "way_too_fast_adaptive", "the same, adaptive, for 1e5 swings",
                {{"body.tip.motion.velocity", "[\"sin(1e10 * t)\"]"}, {"T", "1e-5"}, dopri5(1e-9)},
                {is("bodies.tip.centre_of_mass.x", 0.0, 609 * 1e-9,
                    "the way, 1e-10: some 600 steps of the tolerance")}),
       finishes(kWay, "way_slow_enough", "a prescribed velocity that swings as it should",
                {{"body.tip.motion.velocity", "[\"sin(t)\"]"}},
                {is("bodies.tip.centre_of_mass.x", 1.0 - std::cos(10.0), 1e-9, "its closed form")}),
       refused(kWay, "way_1_over_t", "a prescribed velocity of 1/t",
               {{"body.tip.motion.velocity", "[\"1 / t\"]"}}, {"division by zero"})}};
}

}  // namespace tomlin::test
