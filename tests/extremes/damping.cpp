#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

const Setting kFlat = {"V0", "0"};

/// A tip on no corrugation that is pulled from rest at critical damping.
double critical(double duration) {
  const double k = 2.0;
  const double v = 0.01;
  const double omega = std::sqrt(k);
  return k * (2.0 * v / omega - std::exp(-omega * duration) * (2.0 * v / omega + v * duration));
}

}  // namespace

Subject damping() {
  const double omega = std::sqrt(2.0);
  return {
      "damping",
      "Damping",
      {finishes(kTip, "none", "no damping", {kFlat, {"c", "0"}},
                {is("drivers.driver.final_force.x", 2.0 * 0.01 / omega * std::sin(omega * 100.0),
                    1e-6, "a free oscillator's swings")}),
       finishes(kTip, "critical", "critical damping", {kFlat, {"c", "2 * sqrt(2)"}, {"T", "3"}},
                {is("drivers.driver.final_force.x", critical(3.0), 1e-8, "its closed form")},
                {FaultCode::run_window_not_whole}),
       finishes(kTip, "critical_verlet", "the same, friction as an operator",
                {kFlat, {"c", "2 * sqrt(2)"}, {"T", "3"}, with_verlet(1e-3)},
                {is("drivers.driver.final_force.x", critical(3.0), 1e-7, "its closed form")},
                {FaultCode::run_window_not_whole}),
       fails(kTip, "strong_rk4", "damping of 1e8, explicit", {kFlat, {"c", "1e8"}, rk4(1e-2)},
             {"stability limit of rk4", "2.785e-08", "viscous_damping"}),
       fails(kTip, "strong_dopri5", "damping of 1e8, explicit and adaptive", {kFlat, {"c", "1e8"}},
             {"would take at least", "without inertia"}),
       fails(kTip, "strong_verlet", "damping of 1e8, as an operator: stable, but wrong",
             {kFlat, {"c", "1e8"}, with_verlet(1e-2)},
             {"underestimates the friction force", "overdamped"}),
       fails(kTip, "stronger_verlet", "damping of 1e300, as an operator",
             {kFlat, {"c", "1e300"}, with_verlet(1e-2)},
             {"underestimates the friction force", "overdamped"}),
       finishes(kTip, "strongish_verlet", "damping that stops a motion within two steps",
                {kFlat, {"c", "50"}, {"T", "1000"}, with_verlet(1e-2)},
                {is("drivers.driver.final_force.x", 0.5, 0.5 * 0.03,
                    "drag, less the scheme's own error")},
                {FaultCode::integrator_weak_drag}),
       finishes(kTip, "moderate_verlet", "damping that takes ten steps to stop a motion",
                {kFlat, {"c", "10"}, {"T", "1000"}, with_verlet(1e-2)},
                {is("drivers.driver.final_force.x", 0.1, 0.1 * 1e-3,
                    "drag, less (h gamma)^2/12 of it")}),
       finishes(kTip, "strong_implicit", "damping of 1e8, the implicit scheme",
                {kFlat, {"c", "1e8"}, {"run.integrator", "{ type = \"radau9\" }"}},
                {is("drivers.driver.final_force.x", -1e6 * std::expm1(-2e-6), 1e-6,
                    "its closed form without inertia")}),
       finishes(kTip, "strong_exponential", "damping of 1e8, its drift taken exactly",
                {kFlat, {"c", "1e8"}, fixed("exponential_verlet", 1e-2)},
                {is("drivers.driver.final_force.x", -1e6 * std::expm1(-2e-6), 1e-8,
                    "its closed form without inertia")}),
       finishes(
           kTip, "strong_overdamped", "damping of 1e8 without inertia",
           {kFlat, {"c", "1e8"}, {"run.dynamics", "overdamped"}},
           {is("drivers.driver.final_force.x", -1e6 * std::expm1(-2e-6), 1e-8, "its closed form")}),
       finishes(kTip, "stronger_overdamped", "damping of 1e300 without inertia",
                {kFlat, {"c", "1e300"}, {"run.dynamics", "overdamped"}},
                {is("drivers.driver.final_force.x", 2.0, 1e-12, "the tip stays where it is")}),
       refused(kTip, "none_overdamped", "no damping, and no inertia",
               {{"c", "0"}, {"run.dynamics", "overdamped"}}, {"tip", "friction"}),
       refused(kTip, "negative", "negative damping", {{"c", "-1"}}, {"out of range", ">= 0"})}};
}

}  // namespace tomlin::test
