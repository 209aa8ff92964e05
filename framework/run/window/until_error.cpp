#include "framework/run/window/until_error.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/window/blocking.hpp"

namespace tomlin {
namespace {

/// Numbers of parts at which the error is looked at: 50 and more, of six leading binary digits.
bool is_looked_at(std::int64_t parts) {
  constexpr int kLeading = 6;
  if (static_cast<double>(parts) < kFewestCorrelationTimes) return false;
  const auto count = static_cast<std::uint64_t>(parts);
  return std::countr_zero(count) + kLeading >= static_cast<int>(std::bit_width(count));
}

}  // namespace

UntilError::UntilError(RunContext& run, Observation& observation)
    : run_(run), observation_(observation) {
  const RunPlan& plan = run.plan;
  part_ = part_of_window(run.model, plan.dt, plan.window_to - plan.window_from);
}

void UntilError::start(const RunResult& before) {
  const UntilSettings& until = settings();
  const SourceLocation& location = until.location_of("of");
  path_ = full_path(before, until.of, location);
  const std::vector<std::string> paths = observation_.estimated();
  if (std::find(paths.begin(), paths.end(), path_) != paths.end()) return;
  Fault fault(FaultCode::run_until_never, location, "run.until.of", "\"" + until.of + "\"",
              "it has no statistical error, which means over the window have",
              fmt::format("one of {}", fmt::join(paths, ", ")));
  fault.nearest = nearest_name(path_, paths).value_or("");
  throw InputError({fault});
}

/// That have ended by the end of a step of the grid.
std::int64_t UntilError::parts_at(std::int64_t grid_step) const {
  const double time = static_cast<double>(grid_step) * run_.plan.dt;
  const double since = time - observation_.window().from().time;
  return since > 0.0 ? static_cast<std::int64_t>(since / part_) : 0;
}

void UntilError::look() {
  if (run_.outcome.done() || !observation_.window().is_open()) return;
  const std::int64_t step = run_.clock.grid_steps();
  std::int64_t parts = parts_at(step - kBlock);
  const std::int64_t now = parts_at(step);
  while (parts < now && !is_looked_at(parts + 1)) ++parts;
  if (parts == now) return;
  const std::optional<double> error = observation_.error_so_far(path_);
  if (!error || *error > settings().error) return;
  reached_ = true;
  observation_.window().set(observation_.window().from().time, run_.clock.time());
  run_.outcome.ended = true;
}

void UntilError::finish() {
  if (reached_) return;
  const UntilSettings& until = settings();
  const std::optional<double> error = observation_.error_so_far(path_);
  const std::string what =
      error ? fmt::format("is {:.3g}", *error)
            : fmt::format("is not known, the window being shorter than {:g} correlation times",
                          kFewestCorrelationTimes);
  run_.outcome.warnings.push_back(
      {FaultCode::run_until_error_not_reached,
       fmt::format("the statistical error of {} is not {:g} by time {:g}: it {}", until.of,
                   until.error, run_.plan.duration, what),
       "run.until"});
}

UntilErrorResult UntilError::result() const {
  UntilErrorResult result;
  result.path = settings().of;
  result.reached = reached_;
  result.asked = settings().error;
  if (observation_.window().is_over()) result.error = observation_.error_so_far(path_);
  return result;
}

}  // namespace tomlin
