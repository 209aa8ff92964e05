#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

/// The tip with lengths, masses and times in other units, which shifts the exponents of everything.
struct Units {
  double length = 1.0;
  double mass = 1.0;
  double time = 1.0;

  double force() const { return mass * (length / time) / time; }
  std::vector<Setting> settings() const {
    return {{"m", text_of(mass)},
            {"a", text_of(length)},
            {"V0", text_of(0.1 * force() * length)},
            {"k", text_of(2.0 * (mass / time) / time)},
            {"v", text_of(0.01 * (length / time))},
            {"c", text_of(2.0 * (mass / time))},
            {"x0", text_of(0.5 * length)},
            {"T", text_of(100.0 * time)}};
  }
};

std::vector<Setting> with_tolerance(std::vector<Setting> settings) {
  settings.push_back({"run.integrator", "{ type = \"dopri5\", absolute_tolerance = 1e-9 }"});
  return settings;
}

ExtremeCase scaled(const std::string& name, const std::string& extreme, const Units& units,
                   std::vector<FaultCode> warnings = {}) {
  std::vector<Setting> settings = units.settings();
  settings.push_back(rk4(0.01 * units.time));
  return finishes(
      kTip, name, extreme, settings,
      {is_that_of("drivers.driver.final_force.x", kTip, {rk4(0.01)}, 1e-9 * units.force(),
                  "the same in units of 1, scaled", units.force()),
       is_that_of("drivers.driver.mean_force.x", kTip, {rk4(0.01)}, 1e-9 * units.force(),
                  "the same in units of 1, scaled", units.force())},
      std::move(warnings));
}

}  // namespace

Subject units() {
  const Units atoms = {.length = 1e-10};
  std::vector<Setting> atoms_adaptive = atoms.settings();
  return {
      "units",
      "Units: everything huge or tiny",
      {scaled("length_1e_150", "lengths of 1e-150", {.length = 1e-150}, {FaultCode::run_few_slips}),
       scaled("length_1e150", "lengths of 1e150", {.length = 1e150}, {FaultCode::run_few_slips}),
       scaled("mass_1e_150", "masses of 1e-150", {.mass = 1e-150}, {FaultCode::run_few_slips}),
       scaled("mass_1e150", "masses of 1e150", {.mass = 1e150}, {FaultCode::run_few_slips}),
       scaled("time_1e_150", "times of 1e-150", {.time = 1e-150}),
       scaled("time_1e150", "times of 1e150", {.time = 1e150}),
       finishes(kTip, "default_tolerance", "lengths of 1e-10 and default tolerances",
                atoms_adaptive,
                {is_that_of("drivers.driver.final_force.x", kTip, {}, 1e-8 * atoms.force(),
                            "the same in units of 1, scaled", atoms.force())},
                {FaultCode::run_few_slips}),
       fails(kTip, "tolerance_of_1e_9", "lengths of 1e-10 and a tolerance of 1e-9",
             with_tolerance(atoms_adaptive), {"does not resolve the scene's shortest length"}),
       finishes(kTip, "corrugation_5e_324", "a corrugation of the smallest number there is",
                {{"V0", "5e-324"}}, {is("drivers.driver.final_force.x", 0.02, 1e-8, "drag alone")}),
       finishes(kTip, "velocity_5e_324", "a velocity of the smallest number there is",
                {{"v", "5e-324"}},
                {is("drivers.driver.final_force.x", 0.0, 1e-300, "nothing pulls")},
                {FaultCode::run_window_too_short}),
       fails(kTip, "period_1e_300", "a period of 1e-300", {{"a", "1e-300"}, rk4(1e-2)},
             {"stability limit of rk4", "sinusoidal_substrate"}),
       finishes(kTip, "period_1e300", "a period of 1e300", {{"a", "1e300"}, {"x0", "0"}, rk4(1e-2)},
                {is("drivers.driver.final_force.x", 0.02, 1e-8, "drag alone")},
                {FaultCode::run_window_too_short})}};
}

}  // namespace tomlin::test
