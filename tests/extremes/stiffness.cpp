#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

constexpr double kCurvature = kTau * kTau * 0.1;  // of the tip's substrate

/// The tip in its minimum, taken as a spring: what the driver feels when it has come v T.
double force_in_minimum(double curvature, double k, double v, double c, double duration) {
  const double speed = k * v / (k + curvature);
  return k * (v * duration - speed * duration + c * speed / (k + curvature));
}

std::vector<Setting> flexible_ring(const std::string& bonds) {
  return {{"k_wh", bonds}, {"body.ring.coordinates", "particles"}, {"T", "10"}, dopri5(1e-12)};
}

/// Flexible rings differ from the rigid one by what their bonds give, which falls as 1/k_wh: seen
/// between two ends, not just as small.
ExtremeCase flexible(const std::string& name, const std::string& bonds) {
  const std::string path = "drivers.driver.mean_force.x";
  const double softer = 1e2 / std::stod(bonds);
  constexpr double kGiven = 3.77e-6;     // by bonds of 1e2
  constexpr double kSecondOrder = 0.02;  // of what is given: (1e2)^-2 of it shows
  const auto right = [path, softer] {
    const double rigid = result_of(kRing.text, {{"T", "10"}, dopri5(1e-12)}, path);
    return rigid + softer * (result_of(kRing.text, flexible_ring("1e2"), path) - rigid);
  };
  return finishes(kRing, name, "bonds of " + bonds, flexible_ring(bonds),
                  {{path, right, kSecondOrder * kGiven * softer,
                    "the rigid ring, and what bonds of 1e2 add to it, less as 1/k_wh"}});
}

/// Beyond what explicit schemes can pay for: the rigid ring's to the tolerance of the implicit one.
ExtremeCase stiffer(const std::string& name, const std::string& bonds) {
  return finishes(kRing, name, "bonds of " + bonds + ", the implicit scheme",
                  {{"k_wh", bonds},
                   {"body.ring.coordinates", "particles"},
                   {"T", "10"},
                   {"run.integrator", "{ type = \"radau9\" }"}},
                  {is_that_of("drivers.driver.mean_force.x", kRing, {{"T", "10"}}, 1e-6,
                              "the rigid ring; a tolerance of 1e-7")});
}

ExtremeCase too_stiff(const std::string& name, const Setting& scheme, const std::string& limit) {
  return fails(kRing, name, "bonds of 1e14, an explicit step",
               {{"k_wh", "1e14"}, {"body.ring.coordinates", "particles"}, scheme},
               {"stability limit", limit, "harmonic_bonds"});
}

}  // namespace

Subject stiffness() {
  const std::vector<Setting> loose = {
      {"k_wh", "1e-6"}, {"body.ring.coordinates", "particles"}, {"T", "1"}};
  std::vector<Setting> loose_in_quadruple = loose;
  loose_in_quadruple.push_back({"run.number_type", "quadruple"});
  loose_in_quadruple.push_back(dopri5(1e-12));
  return {
      "stiffness",
      "Stiffness: bonds, driver, corrugation",
      {finishes(kRing, "bonds_1e_6", "bonds of 1e-6", loose,
                {is_that_of("drivers.driver.mean_force.x", kRing, loose_in_quadruple, 1e-8,
                            "quadruple precision and a tolerance of 1e-12")},
                {FaultCode::run_window_not_whole}),
       flexible("bonds_1e3", "1e3"),
       flexible("bonds_1e4", "1e4"),
       flexible("bonds_1e6", "1e6"),
       finishes(kRing, "bonds_1e14_exponential", "bonds of 1e14, taken exactly",
                {{"k_wh", "1e14"},
                 {"body.ring.coordinates", "particles"},
                 {"T", "10"},
                 fixed("exponential_verlet", 1e-3)},
                {is_that_of("drivers.driver.mean_force.x", kRing, {{"T", "10"}}, 1e-6,
                            "the rigid ring; of second order in the step")}),
       too_stiff("bonds_1e14_rk4", rk4(1e-3), "3.536e-08"),
       too_stiff("bonds_1e14_verlet", with_verlet(1e-3), "2.5e-08"),
       fails(kRing, "bonds_1e14_adaptive", "bonds of 1e14, an explicit adaptive scheme",
             {{"k_wh", "1e14"}, {"body.ring.coordinates", "particles"}, {"T", "1e4"}},
             {"would take at least", "most_steps"}),
       stiffer("bonds_1e10", "1e10"),
       stiffer("bonds_1e12", "1e12"),
       stiffer("bonds_1e14", "1e14"),
       refused(kTip, "driver_0", "a driver of no stiffness", {{"k", "0"}}, {"out of range", "> 0"}),
       finishes(kTip, "driver_1e_300", "a driver of stiffness 1e-300", {{"k", "1e-300"}},
                {is("drivers.driver.final_force.x", 1e-300, 1e-309,
                    "stiffness times way: the tip stays where it is")}),
       finishes(kTip, "driver_1e12", "a driver of stiffness 1e12",
                {{"k", "1e12"}, {"T", "0.5"}, rk4(1e-6), {"body.tip.velocity", "[\"v\"]"}},
                {is("drivers.driver.final_force.x",
                    2.0 * 0.01 + kTau * 0.1 * std::sin(kTau * 0.005), 1e-2,
                    "drag and substrate where the driver is; positions round to 1e-16, forces to "
                    "1e-4 and swing")},
                {FaultCode::run_window_too_short}),
       fails(kTip, "driver_1e12_long_step", "the same with a step for soft ones",
             {{"k", "1e12"}, rk4(1e-2)}, {"stability limit of rk4", "2.828e-06", "force: driver"}),
       finishes(kTip, "driver_1e12_implicit", "the same, the implicit scheme",
                {{"k", "1e12"},
                 {"T", "50.5"},
                 {"run.integrator", "{ type = \"radau9\" }"},
                 {"body.tip.velocity", "[\"v\"]"}},
                {is("drivers.driver.mean_force.x",
                    2.0 * 0.01 + 0.1 * (1.0 - std::cos(kTau * 0.505)) / 0.505, 1e-3,
                    "drag and substrate along the driver's way")},
                {FaultCode::run_stiff_driver, FaultCode::run_window_not_whole,
                 FaultCode::run_work_rounding}),
       finishes(
           kTip, "corrugation_0", "no corrugation", {{"V0", "0"}},
           {is("drivers.driver.final_force.x", 0.02, 1e-8, "drag, coefficient times velocity")}),
       finishes(
           kTip, "corrugation_0p1", "nothing: for comparison", {{"T", "10"}, {"v", "1e-4"}},
           {is("drivers.driver.final_force.x", force_in_minimum(kCurvature, 2.0, 1e-4, 2.0, 10.0),
               1e-8, "the minimum as a spring")},
           {FaultCode::run_window_too_short}),
       finishes(kTip, "corrugation_1e6", "a corrugation of 1e6", {{"V0", "1e6"}},
                {is("drivers.driver.final_force.x",
                    force_in_minimum(1e7 * kCurvature, 2.0, 0.01, 2.0, 100.0), 1e-6,
                    "the minimum as a spring")},
                {FaultCode::run_window_not_steady}),
       fails(kTip, "corrugation_1e6_long_step", "the same with a step for weak ones",
             {{"V0", "1e6"}, rk4(1e-2)},
             {"stability limit of rk4", "sinusoidal_substrate", "0.0004502"}),
       fails(kTip, "corrugation_1e300", "a corrugation of 1e300", {{"V0", "1e300"}, {"x0", "0.3"}},
             {"most_steps", "sinusoidal_substrate"}),
       refused(kTip, "corrugation_inf", "an infinite corrugation", {{"V0", "inf"}}, {"V0", "inf"}),
       refused(kTip, "corrugation_nan", "a corrugation that is no number", {{"V0", "nan"}},
               {"V0", "nan"})}};
}

}  // namespace tomlin::test
