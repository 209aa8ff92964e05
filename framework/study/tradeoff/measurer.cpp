#include "framework/study/tradeoff/measurer.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/results/observables.hpp"

namespace tomlin {
namespace {

/// Runs shorter than this are timed anew, up to so often: the clock's and the machine's noise is
/// not theirs.
constexpr double kShortRun = 5e-3;
constexpr int kTimings = 3;

Measurement measurement_of(const TrialRun& trial, const std::string& path) {
  Measurement found;
  found.end = trial.end;
  found.evaluations = trial.result.force_evaluations;
  found.columns = trial.result.jacobian_columns;
  found.seconds = trial.seconds;
  found.why = trial.why;
  if (trial.finished()) {
    found.value = observable(trial.result, path);
    if (!found.value) found.why = path + " is undefined in it";
  } else if (trial.end == TrialRun::End::over_budget) {
    found.why = fmt::format("over budget: {:.2g} s for {:.2g} % of the run", trial.seconds,
                            100.0 * trial.part());
  }
  return found;
}

}  // namespace

Measurer::Measurer(const Variants& variants, std::string observable, double budget_seconds,
                   const std::atomic<bool>* stop, double pace)
    : variants_(variants),
      observable_(std::move(observable)),
      budget_(budget_seconds),
      stop_(stop),
      pace_(pace),
      started_(std::chrono::steady_clock::now()) {}

double Measurer::used() const {
  if (pace_ > 0.0) return static_cast<double>(spent_) / pace_;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

Measurement Measurer::with(const std::vector<Setting>& settings, double most_seconds,
                           const std::optional<Perturbation>& perturbation) {
  try {
    TrialLimits limits{.stop = stop_, .perturbation = perturbation, .observables = {observable_}};
    const double seconds = std::min(most_seconds, left());
    if (pace_ > 0.0) {
      limits.cost = static_cast<std::uint64_t>(std::max(std::ceil(seconds * pace_), 1.0));
    } else {
      limits.seconds = seconds;
    }
    TrialRun trial = try_run(variants_.with(settings), limits);
    spent_ += trial.cost();
    if (pace_ > 0.0) trial.seconds = static_cast<double>(trial.cost()) / pace_;
    return measurement_of(trial, observable_);
  } catch (const InputError& error) {
    Measurement refused;
    refused.end = TrialRun::End::refused;
    refused.why = condensed(error);
    return refused;
  }
}

const Measurement& Measurer::at(const Method& method, double resolution, double most_seconds) {
  const auto [entry, is_new] = known_.try_emplace({method.name, resolution});
  Remembered& remembered = entry->second;
  const double limit = std::min(most_seconds, left());
  const bool may_get_further =
      remembered.measurement.end == TrialRun::End::over_budget && limit > 2.0 * remembered.limit;
  if (!is_new && !may_get_further) return remembered.measurement;
  remembered.limit = limit;
  Measurement& found = remembered.measurement;
  found = with(method.at(resolution), limit);
  const int timings = pace_ > 0.0 ? 1 : kTimings;
  for (int k = 1; k < timings && found.defined() && found.seconds < kShortRun && !is_over(); ++k) {
    const Measurement again = with(method.at(resolution), limit);
    if (again.defined()) found.seconds = std::min(found.seconds, again.seconds);
  }
  return found;
}

}  // namespace tomlin
