#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

const Setting kFlat = {"V0", "0"};

/// Force of the driver of a tip on no corrugation, pulled from rest (m = 1, c = k = 2).
double pulled(double t) {
  // 1 - exp(-t) cos t without cancellation.
  const double half = std::sin(0.5 * t);
  return 2.0 * 0.01 * (2.0 * half * half - std::expm1(-t) * std::cos(t));
}

/// Its integral from 0, over 2 * 0.01.
double pulled_so_far(double t) {
  return t - 0.5 * (1.0 + std::exp(-t) * (std::sin(t) - std::cos(t)));
}

/// A swinging tip after n steps of velocity Verlet: the scheme's own frequency, which is known.
double swing(double steps, long double h) {
  const long double angle = 2.0L * std::asin(0.5L * h * std::sqrt(2.0L));
  return static_cast<double>(0.2L * std::cos(static_cast<long double>(steps) * angle));
}

ExtremeCase many_steps(const std::string& name, const std::string& count, double tolerance) {
  const double steps = std::stod(count);
  const double h = 0x1p-7;  // times are exact
  ExtremeCase made = finishes(kTip, name, count + " steps",
                              {kFlat,
                               {"v", "0"},
                               {"c", "0"},
                               {"force.driver.start", "[\"x0 + 0.1\"]"},
                               {"T", count + " / 128"},
                               with_verlet(h)},
                              {is("time.end", steps * h, 0.0, "a product, not a sum"),
                               is("time.steps", steps, 0.0, "none more, none less"),
                               is("drivers.driver.final_force.x", swing(steps, h), tolerance,
                                  "the scheme's own frequency, 2 asin(h omega/2)/h")});
  made.seconds = 1500.0;
  return made;
}

/// A bond's swings: the largest step of a fixed scheme is known, and kept to a hundredth. Whether
/// they soon grow when it is a hundredth longer depends on the scheme.
std::vector<ExtremeCase> at_the_limit(const std::string& scheme, double limit, double most_energy,
                                      bool grows = true) {
  const auto with_step = [&](double part) { return fixed(scheme, part * limit); };
  const std::vector<Setting> bond = {{"d", "1.001"}, {"T", "2000"}};
  const auto with = [&](const Setting& step, const std::vector<Setting>& more = {}) {
    std::vector<Setting> all = bond;
    all.push_back(step);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const std::vector<Setting> beyond = with(with_step(1.01), {{"run.allow_unstable", "true"}});
  const ExtremeCase insisted =
      grows ? fails(kPair, scheme + "_1p01_insisted", "the same, insisted on", beyond,
                    {"further in one step than is allowed", "stability limit"})
            : finishes(kPair, scheme + "_1p01_insisted",
                       "the same, insisted on: its growth does not show yet", beyond,
                       {is("energy.potential", 0.0, most_energy, "what it has at 0.99")},
                       {FaultCode::integrator_beyond_stability, FaultCode::run_energy_balance});
  return {
      finishes(kPair, scheme + "_0p99", "a step of 0.99 of the stable one", with(with_step(0.99)),
               {is("energy.kinetic", 0.0, most_energy, "what the scheme lets it have at most"),
                is("energy.potential", 0.0, most_energy, "the same")},
               {FaultCode::run_energy_balance}),
      fails(kPair, scheme + "_1p01", "a step of 1.01 of the stable one", with(with_step(1.01)),
            {"stability limit of " + scheme, "harmonic_bonds", "allow_unstable"}),
      insisted};
}

/// Midpoint is stable with friction alone: here up to 2/gamma = 1, the limit of its slowest
/// motions; the tip's own, pulled on its spring, still dies out a little beyond.
std::vector<ExtremeCase> midpoint_at_the_limit() {
  const Value drag = is("drivers.driver.final_force.x", 0.02, 1e-9, "drag alone");
  return {
      finishes(kTip, "midpoint_0p99", "a step of 0.99 of the stable one",
               {kFlat, fixed("midpoint", 0.99)}, {drag}),
      fails(kTip, "midpoint_1p01", "a step of 1.01 of the stable one",
            {kFlat, fixed("midpoint", 1.01)}, {"stability limit of midpoint", "allow_unstable"}),
      finishes(kTip, "midpoint_1p01_insisted", "the same, insisted on",
               {kFlat, fixed("midpoint", 1.01), {"run.allow_unstable", "true"}}, {drag},
               {FaultCode::integrator_beyond_stability}),
      fails(kTip, "midpoint_undamped", "the same scheme without friction",
            {kFlat, {"c", "0"}, fixed("midpoint", 1e-2)}, {"stability limit of midpoint"})};
}

}  // namespace

Subject steps() {
  const std::string final_force = "drivers.driver.final_force.x";
  const std::string mean_force = "drivers.driver.mean_force.x";
  const double omega = std::sqrt(2.0);
  Subject subject = {
      "steps",
      "Steps, durations, tolerances, samples",
      {finishes(kTip, "one_step", "a run of a single step", {kFlat, {"T", "0.01"}, rk4(0.01)},
                {is(final_force, pulled(0.01), 1e-12, "its closed form"),
                 is("time.steps", 1.0, 0.0, "a single one")},
                {FaultCode::run_window_too_short}),
       finishes(kTip, "half_a_step", "a run of half a step", {kFlat, {"T", "0.005"}, rk4(0.01)},
                {is(final_force, pulled(0.005), 1e-12, "its closed form"),
                 is("time.steps", 1.0, 0.0, "a single one"),
                 is("time.end", 0.005, 0.0, "the end of the run")},
                {FaultCode::run_window_too_short}),
       finishes(kTip, "duration_1e_300", "a run of 1e-300",
                {kFlat, {"x0", "0"}, {"T", "1e-300"}, rk4(0.01)},
                {is(final_force, 2e-302, 1e-314, "stiffness times way"),
                 is("time.end", 1e-300, 0.0, "the end of the run")},
                {FaultCode::run_window_too_short}),
       refused(kTip, "duration_0", "a run of no duration", {{"T", "0"}}, {"run.duration", "> 0"}),
       finishes(kTip, "tolerance_1e_15", "a tolerance of 1e-15", {kFlat, {"T", "3"}, dopri5(1e-15)},
                {is(final_force, pulled(3.0), 1e-15, "its closed form")},
                {FaultCode::run_window_not_whole}),
       finishes(kTip, "tolerance_0_1", "a tolerance of a tenth of a period",
                {kFlat, {"T", "3"}, dopri5(0.1)},
                {is(final_force, pulled(3.0), 0.1, "its closed form")},
                {FaultCode::integrator_coarse_tolerance, FaultCode::run_window_not_whole}),
       fails(kTip, "tolerance_1", "a tolerance of a period", {kFlat, {"T", "3"}, dopri5(1.0)},
             {"does not resolve the scene's shortest length"}),
       fails(kTip, "tolerance_1e_300", "a tolerance of 1e-300", {kFlat, {"T", "3"}, dopri5(1e-300)},
             {"tolerances too fine"}),
       refused(kTip, "tolerance_0", "a tolerance of 0", {dopri5(0.0)}, {"must not be 0"}),
       finishes(kTip, "samples_within_steps", "samples ten times a step",
                {kFlat, {"T", "3"}, rk4(0.01), {"output.every", "1e-3"}},
                {is_that_of(final_force, kTip, {kFlat, {"T", "3"}, rk4(0.01)}, 0.0,
                            "the same run without samples")},
                {FaultCode::run_window_not_whole}),
       finishes(kTip, "samples_beyond_the_run", "a sampling interval longer than the run",
                {kFlat, {"T", "3"}, rk4(0.01), {"output.every", "1e3"}},
                {is(final_force, pulled(3.0), 1e-9, "its closed form")},
                {FaultCode::run_window_not_whole}),
       refused(kTip, "samples_without_end", "a sampling interval of 1e-12",
               {{"output.every", "1e-12"}}, {"samples", "at most"}),
       finishes(kTip, "window_of_a_step", "a window of a single step",
                {kFlat,
                 {"T", "3"},
                 rk4(0.01),
                 {"v", "1"},
                 {"measure.from", "1.0"},
                 {"measure.to", "1.01"},
                 {"measure.in", "time"}},
                {is(mean_force, 2.0 * (pulled_so_far(1.01) - pulled_so_far(1.0)) / 0.01, 1e-8,
                    "its closed form")},
                {FaultCode::run_window_not_whole}),
       finishes(kTip, "window_of_rounding", "a window of one place in the last digit",
                {kFlat,
                 {"T", "3"},
                 rk4(0.01),
                 {"v", "1"},
                 {"measure.from", "1.0"},
                 {"measure.to", "1.0000000000000002"},
                 {"measure.in", "time"}},
                {is(mean_force, 100.0 * pulled(1.0), 2.0, "its closed form: no digit of it")},
                {FaultCode::run_window_rounding, FaultCode::run_window_too_short}),
       refused(kTip, "window_of_nothing", "a window of no length",
               {{"measure.from", "1.0"}, {"measure.to", "1.0"}, {"measure.in", "time"}},
               {"ends before it begins"}),
       refused(kTip, "steps_without_end", "1e300 steps", {{"T", "1e300"}, rk4(1e-2)},
               {"steps", "days"}),
       finishes(kTip, "largest_seed", "a seed of 2^63 - 1",
                {kFlat,
                 {"T", "3"},
                 {"run.seed", "9223372036854775807"},
                 {"run.perturb", "{ size = 1e-12, repeats = 2 }"}},
                {is(final_force, pulled(3.0), 1e-8, "its closed form")},
                {FaultCode::run_window_not_whole}),
       refused(kTip, "negative_seed", "a seed of -1", {{"run.seed", "-1"}}, {"run.seed", ">= 0"}),
       many_steps("many", "1e7", 1e-6)}};
  const auto add = [&](const std::vector<ExtremeCase>& cases) {
    subject.cases.insert(subject.cases.end(), cases.begin(), cases.end());
  };
  const double energy = 0.5 * 1e-6;  // of the bond at the start
  add(at_the_limit("rk4", 2.82842712 / omega, energy));
  // Near the limit the conserved ellipse is 1/(1 - 0.99^2) times longer than high.
  // How much more energy than it has a scheme's conserved ellipse lets a swing show at most, near
  // the limit.
  constexpr double kMostSwing = 100.0;
  add(at_the_limit("velocity_verlet", 2.0 / omega, energy / (1.0 - 0.99 * 0.99)));
  add(at_the_limit("blanes_moan", 3.163 / omega, energy * kMostSwing, false));
  add(midpoint_at_the_limit());
  subject.cases.push_back(many_steps("very_many", "1e9", 1e-4));
  subject.cases.back().slow = true;
  return subject;
}

}  // namespace tomlin::test
