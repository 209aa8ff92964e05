#include "framework/run/window/until_steady.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/model/stability.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/window/time_scale.hpp"

namespace tomlin {

void UntilSteady::declare(StateLayout& layout) const {
  layout.add_reals("until", Steadiness::kNumbers);
}

void UntilSteady::attach(RunState& state) { steadiness_.attach(state.reals("until")); }

void UntilSteady::start(const Measured& measured) {
  const UntilSettings& until = settings();
  observable(measured(), until.steady, until.location_of("steady"));
  Model& model = run_.model;
  const auto slowest = slowest_time_of(model);
  slowest_time_ = slowest.value_or(0.0);
  for (const TimeDependence& change : time_dependences(model)) {
    slowest_time_ = std::max(slowest_time_, slowest_cycle(change, run_.plan.duration));
  }
  model.anchor(DoubleDouble(0.0));
  if (slowest) return;
  run_.outcome.warnings.push_back(
      {FaultCode::run_until_slowest_unknown,
       fmt::format("run.until: the slowest internal time of so many coordinates is not known, only "
                   "how {} has changed so far",
                   until.steady),
       "run.until"});
}

/// After the run's last period its window stays.
void UntilSteady::set_window() {
  const double period = run_.plan.period;
  const double last = std::nearbyint(run_.plan.duration / period) - 1.0;
  const double before = std::min(steadiness_.periods(), last);
  window_.set(before * period, (before + 1.0) * period);
}

/// The window has been one period of the driver: is the run steady, or what is the next one?
bool UntilSteady::end_period(const Measured& measured) {
  const RunPlan& plan = run_.plan;
  const UntilSettings& until = settings();
  const double value = observable(measured(), until.steady).value_or(0.0);
  steadiness_.add(value);
  const double ahead = plan.duration / plan.period - steadiness_.periods();
  if (const auto distance = steadiness_.distance(slowest_time_ / plan.period, ahead)) {
    steadiness_.kept_distance() = value != 0.0 ? *distance / std::abs(value) : *distance;
    if (steadiness_.kept_distance() <= until.tolerance) {
      steadiness_.reach();
      run_.outcome.ended = true;
      return false;
    }
  }
  const double next = (steadiness_.periods() + 1.0) * plan.period;
  if (next > plan.duration * (1.0 + 1e-9)) return false;  // the last period of the run
  window_.shift_to(next);
  return true;
}

void UntilSteady::finish() {
  if (steadiness_.reached()) return;
  const UntilSettings& until = settings();
  const double least = Steadiness::least_periods(slowest_time_ / run_.plan.period);
  std::string why =
      fmt::format("it still changes by a part of {:.2g}", steadiness_.kept_distance());
  if (steadiness_.periods() < least) {
    why = fmt::format("that takes {:g} periods at least", least);
    if (least > static_cast<double>(Steadiness::kWindows)) {
      why += fmt::format(", since the slowest internal time of the scene is {:.3g}", slowest_time_);
    }
  }
  run_.outcome.warnings.push_back(
      {FaultCode::run_until_not_steady,
       fmt::format("{} is not steady to {:g} by time {:g}: {}", until.steady, until.tolerance,
                   run_.plan.duration, why),
       "run.until"});
}

SteadyResult UntilSteady::result() const {
  SteadyResult result;
  result.path = settings().steady;
  result.reached = steadiness_.reached();
  result.periods = static_cast<std::uint64_t>(steadiness_.periods());
  if (steadiness_.periods() >= Steadiness::least_periods(slowest_time_ / run_.plan.period)) {
    result.change = steadiness_.kept_distance();
  }
  return result;
}

}  // namespace tomlin
