#include "framework/run/steps/stepping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tomlin {

StepReport Stepping::step_scheme(double since, double h, bool dense) {
  StepReport report = run_.step_from(since, h, dense);
  // Schemes watch the coordinates and the forces; forces' own variables, prescribed motions, and
  // velocities after operators with variables of their own are watched here.
  const SystemView<double>& view = run_.model.system().view;
  const auto finite = [](double x) { return std::isfinite(x); };
  const bool flows = view.flow_count > 0 && view.own_count > 0;
  if (report.fault == StepFault::none &&
      !(std::all_of(view.integrals, view.integrals + view.own_count, finite) &&
        (!flows || std::all_of(view.velocity, view.velocity + view.dofs, finite)))) {
    report.fault = StepFault::not_finite_or_too_far;
  }
  return report;
}

bool Stepping::may_be_in_lanes() const {
  const Observation& observation = parts_.observation;
  return !parts_.triggers.waiting() && !observation.looks_within_steps() &&
         (!observation.watches() || run_.point_blocks() != nullptr) &&
         !parts_.observation.rotations().is_needed_at_every_step() && run_.integrator->is_started();
}

bool Stepping::take(const Step& step) {
  Observation& observation = parts_.observation;
  const bool adaptive = run_.plan.dt == 0.0;
  const DoubleDouble begin = run_.clock.now();
  const bool waits = step.may_split && parts_.triggers.waiting();
  const double next_time = observation.next_time();
  // Samples and edges at the end of a fixed step need no interpolation.
  const bool dense = adaptive || waits || next_time < static_cast<double>(step.end) ||
                     observation.looks_within_steps() || is_looked_into();
  const bool may_be_taken_again = parts_.uncontrolled.any();
  if (waits || may_be_taken_again) run_.keep_state();
  if (may_be_taken_again) parts_.uncontrolled.begin_step();
  observation.begin_step(static_cast<double>(begin));
  const StepReport report = step_scheme(step.since, step.h, dense);
  if (report.fault != StepFault::none) {
    run_.fail(report.fault, step.h);
    return false;
  }
  const bool shorter = adaptive && report.taken < step.h;
  const DoubleDouble arrived = shorter ? begin + report.taken : step.end;
  if (may_be_taken_again && !parts_.uncontrolled.accept(begin, report.taken)) return true;
  if (waits) {
    const double length = adaptive ? report.taken : step.h;
    if (const auto passed = parts_.triggers.first_passed(begin, length, step.since)) {
      return take_to_event(*passed, step, begin, length, arrived);
    }
  }
  run_.seen = arrived;
  look(begin, arrived);
  run_.clock.set(arrived);
  run_.clock.keep_cost(run_.model.system());
  run_.clock.add(1, step.to_grid ? 1 : 0);
  const double next_since = anchor_next();
  observation.integrate(begin, arrived, next_since);
  bool whole = true;
  if (next_time <= static_cast<double>(arrived)) {
    whole = observation.serve(next_time, begin, arrived, next_since);
  }
  if (is_looked_into()) parts_.balance->look_into(observation, begin, next_since);
  if (!end_step()) return false;
  observation.look_at_end_of_step();
  if (observation.window_has_ended() && parts_.window_ended()) {
    observation.integrate(begin, arrived, next_since);
  }
  const double next_switch = run_.model.next_switch();
  if (next_switch < run_.plan.duration && next_switch_time() <= run_.clock.time()) switch_forces();
  if (whole) {
    parts_.housekeeping.after_step();
  } else {
    parts_.housekeeping.stop_within_step();
  }
  return true;
}

/// Back to the start of the step, and to the event alone: what is left of a step of the grid is a
/// step of its own. An event at either end of a step splits nothing.
bool Stepping::take_to_event(const Triggers::Passed& passed, const Step& step,
                             const DoubleDouble& begin, double length,
                             const DoubleDouble& arrived) {
  run_.go_back();
  if (passed.theta <= kNoStep) {
    fire(passed);
    return true;
  }
  const bool split = passed.theta < 1.0 - kNoStep;
  Step part = step;
  part.may_split = false;
  part.end = split ? begin + passed.theta * length : arrived;
  part.h = split ? passed.theta * length : length;
  part.to_grid = step.to_grid && !split;
  if (!take(part)) return false;
  // An adaptive scheme may have stopped before.
  if (static_cast<double>(run_.clock.now() - part.end) == 0.0) fire(passed);
  return true;
}

void Stepping::fire(const Triggers::Passed& passed) {
  const std::string& force = parts_.triggers.fire(passed);
  run_.anchor_here();
  parts_.observation.force_changed(force);
  run_.integrator->forces_changed();
}

Stepping::Step Stepping::up_to_switch(Step step) const {
  const double next = run_.model.next_switch();
  if (!(next_switch_time() < static_cast<double>(step.end) - 2.0 * kNoStep * run_.plan.dt))
    return step;
  step.end = DoubleDouble(next);
  step.h = static_cast<double>(step.end - run_.clock.now());
  step.to_grid = false;
  return step;
}

/// Switches forces: the integrator's findings about the next step were of the forces before.
void Stepping::switch_forces() {
  const double latest = run_.clock.time() + kNoStep * run_.plan.dt;
  for (const std::string& force : run_.model.switch_forces(run_.clock.now(), latest)) {
    parts_.observation.force_switched(force);
  }
  run_.anchor_here();
  run_.integrator->forces_changed();
}

std::unique_ptr<Stepping> stepping_of(StepParts parts) {
  if (parts.run.plan.dt > 0.0) return std::make_unique<FixedGrid>(std::move(parts));
  if (parts.run.path != nullptr) return std::make_unique<EquilibriumSteps>(std::move(parts));
  return std::make_unique<AdaptiveSteps>(std::move(parts));
}

}  // namespace tomlin
