#include <fmt/format.h>

#include "framework/run/steps/stepping.hpp"

namespace tomlin {
namespace {

constexpr std::int64_t kStepsBetweenLooksAhead = 1 << 18;

}  // namespace

void AdaptiveSteps::advance(std::uint64_t) {
  const RunPlan& plan = run_.plan;
  const double rest = static_cast<double>(DoubleDouble(plan.duration) - run_.clock.now());
  if (rest <= 0.0) {
    run_.outcome.ended = true;
    return;
  }
  if (foresees_too_many_steps()) return;
  const double longest = parts_.uncontrolled.longest_step();
  if (longest < rest) {
    take(up_to_switch({0.0, longest, run_.clock.now() + longest}));
  } else {
    take(up_to_switch({0.0, rest, DoubleDouble(plan.duration)}));
  }
  // Steps may be few and expensive.
  if (run_.too_expensive() && !run_.outcome.done()) run_.outcome.interrupt();
}

/// To the end of a block.
std::int64_t AdaptiveSteps::steps_for_lanes() {
  const std::int64_t taken = run_.clock.steps();
  if (!may_be_in_lanes() || taken % kStepsBetweenLooksAhead == 0) return 0;
  run_.model.anchor(run_.clock.now());
  return kBlock - taken % kBlock;
}

void AdaptiveSteps::count_steps(std::int64_t steps, const DoubleDouble& time) {
  run_.clock.add(steps, 0);
  run_.clock.set(time);
  run_.clock.keep_cost(run_.model.system());
  run_.seen = time;
  run_.model.anchor(time);
  if (steps > 0 && run_.block_ends()) parts_.housekeeping.after_block();
  if (run_.too_expensive() && !run_.outcome.done()) run_.outcome.interrupt();
}

/// Looked at every quarter of a million steps: a run that will be out of steps long before its end
/// need not go on for hours.
bool AdaptiveSteps::foresees_too_many_steps() {
  constexpr double kPaceFactor = 10.0;  // paces change
  const std::int64_t taken = run_.clock.steps();
  const IntegratorRecord& scheme = run_.scheme;
  if (scheme.most_steps == nullptr || taken == 0 || taken % kStepsBetweenLooksAhead != 0)
    return false;
  const void* description = run_.scene->run.integrator.description.get();
  const auto most = static_cast<double>(scheme.most_steps(description));
  const double foreseen = static_cast<double>(taken) * (run_.plan.duration / run_.clock.time());
  if (foreseen <= kPaceFactor * most) return false;
  run_.fail(StepFault::too_many_steps, 0.0);
  run_.outcome.failure->what = fmt::format(
      "at its present step size the run would take {:.2g} steps, and most_steps allows {:g}",
      foreseen, most);
  return true;
}

double AdaptiveSteps::anchor_next() {
  run_.model.anchor(run_.clock.now());
  return 0.0;
}

/// To the next equilibrium. What the scene loses is the difference of two energies.
bool EquilibriumSteps::slip() {
  Model& model = run_.model;
  const SystemView<double>& view = model.system().view;
  const auto energy = [&] {
    return model.potential_energy(run_.clock.now(), view.position, view.velocity, view.integrals);
  };
  const double before = energy();
  const double ahead = static_cast<double>(DoubleDouble(run_.plan.duration) - run_.clock.now());
  const StepFault fault = run_.path->slip(0.0, ahead);
  run_.clock.keep_cost(model.system());
  if (fault != StepFault::none) {
    run_.fail(fault, 0.0);
    return false;
  }
  const double lost = before - energy();
  if (model.assembly().friction_rate() != kNoRate)
    view.integrals[model.assembly().friction_rate()] += lost;
  parts_.observation.at_equilibrium();
  if (run_.path->jumped()) parts_.observation.path_slip(lost);
  return true;
}

}  // namespace tomlin
