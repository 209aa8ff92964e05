#include "framework/study/accuracy/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "framework/model/stability.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/results/results.hpp"
#include "framework/run/results/selection.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {
namespace {

/// Nothing is known better than to the last digits of a double.
constexpr double kRounding = 1e-15;

/// Differences to two companions may both be small by chance, where errors change their sign
/// between their steps: no error is stated that is below this part of the typical one of a run,
/// relative to the result, but for what is exact.
constexpr double kLeastOfTypical = 0.3;
constexpr double kExact = 10.0 * kRounding;

/// An integrator of another family that is off the run by more than so many times what is asked for
/// contradicts it: over whole runs such a companion was off by 1.6 times, where it was a fiftieth
/// in the pilot.
constexpr double kContradiction = 5.0;

bool key_has_any_of(const ResultQuantity& quantity, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&quantity](std::string_view word) {
    return quantity.key.find(word) != std::string::npos;
  });
}

/// Whether an observable has an error: those of drivers, bodies, forces and the energy balance have
/// one. Counts and clocks have none, nor has what is read off steps at single events.
bool has_error(const Observable& one) {
  const std::string& path = one.path;
  if (one.quantity->shape == Shape::count) return false;
  if (key_has_any_of(*one.quantity, {"slip_", "effective_stiffness"})) return false;
  return path.starts_with("drivers.") || path.starts_with("bodies.") ||
         path.starts_with("forces.") || path.starts_with("energy.");
}

/// Components are not typical beside the force that they are components of.
bool is_typical(const std::string& path) {
  const ResultQuantity* row = quantity_at(path);
  return row == nullptr || !key_has_any_of(*row, {"mean_force_along", "mean_force_across"});
}

/// A companion that has run, and the share of the difference to it that is the error.
struct Beside {
  RunResult result;
  double share = 1.0;
};

void lift_small_errors(RunResult& result) {
  const auto relative = [&](const ErrorEstimate& estimate) {
    const double value = std::abs(observable(result, estimate.path).value_or(0.0));
    return estimate.error && value > 0.0 ? *estimate.error / value : 0.0;
  };
  std::vector<double> typical;
  for (const ErrorEstimate& estimate : result.errors) {
    const double error = relative(estimate);
    if (error > kExact && is_typical(estimate.path)) typical.push_back(error);
  }
  if (typical.empty()) return;
  const auto middle = typical.begin() + static_cast<std::ptrdiff_t>(typical.size() / 2);
  std::nth_element(typical.begin(), middle, typical.end());
  for (ErrorEstimate& estimate : result.errors) {
    const double error = relative(estimate);
    if (error > kExact) *estimate.error *= std::max(1.0, kLeastOfTypical * *middle / error);
  }
}

/// Errors of what is made of other quantities: two of them may well differ by the same in a run and
/// its companion, and hide it.
void add_up_errors(RunResult& result) {
  const std::vector<Observable> all = observables(result);
  const auto error_of = [&](const std::string& path) {
    const auto found = std::find_if(result.errors.begin(), result.errors.end(),
                                    [&](const ErrorEstimate& one) { return one.path == path; });
    return found == result.errors.end() ? std::nullopt : found->error;
  };
  for (const Observable& one : all) {
    const std::vector<std::string>& parts = one.quantity->made_of;
    const auto estimate =
        std::find_if(result.errors.begin(), result.errors.end(),
                     [&](const ErrorEstimate& it) { return it.path == one.path; });
    if (parts.empty() || estimate == result.errors.end()) continue;
    std::optional<double> sum = 0.0;
    for (const std::string& part : parts) {
      std::string path = one.path;
      path.replace(path.find("." + one.quantity->key) + 1, one.quantity->key.size(), part);
      const std::optional<double> error = error_of(path);
      sum = sum && error ? std::optional(*sum + *error) : std::nullopt;
    }
    estimate->error = sum;
  }
}

void add_errors(RunResult& result, const std::vector<Beside>& companions) {
  for (const Observable& one : observables(result)) {
    if (!has_error(one)) continue;
    ErrorEstimate estimate{one.path, std::nullopt};
    for (const Beside& companion : companions) {
      if (!one.quantity->made_of.empty()) break;  // from its parts' below
      const auto other = observable(companion.result, one.path);
      if (!one.value || !other) continue;
      const double error = std::max(companion.share * std::abs(*one.value - *other),
                                    kRounding * std::abs(*one.value));
      estimate.error = std::max(estimate.error.value_or(0.0), error);
    }
    result.errors.push_back(std::move(estimate));
  }
  lift_small_errors(result);
  add_up_errors(result);
}

void warn(RunResult& result, FaultCode code, std::string text) {
  result.warnings.push_back({code, std::move(text), kAccuracyKey});
}

void warn_of_large_errors(RunResult& result, const std::vector<Beside>& companions,
                          const ChosenIntegrator& chosen) {
  const double accuracy = *chosen.scene->run.accuracy;
  double found = 0.0;
  for (const Beside& companion : companions) {
    const double difference = relative_difference(companion.result, result, chosen.length);
    found = std::max(found, companion.share * difference);
  }
  if (found <= accuracy) return;
  warn(result, FaultCode::run_accuracy_not_reached,
       fmt::format("accuracy {:g} was not reached: the estimated error is {:.1e} of the result",
                   accuracy, found));
}

/// A scene with other numbers in the rows of its integrator: `change` has each row and its number.
template <class Change>
std::shared_ptr<const Scene> with_integrator(const std::shared_ptr<const Scene>& scene,
                                             Change change) {
  const SceneIntegrator& integrator = scene->run.integrator;
  auto description = integrator.record->make_description();
  for (const Parameter& row : integrator.record->parameters) {
    ParameterValue value = row.read(integrator.description.get());
    if (double* number = std::get_if<double>(&value)) change(row, *number);
    row.assign(description.get(), std::move(value));
  }
  auto other = std::make_shared<Scene>(*scene);
  other->run.integrator.description = std::move(description);
  return other;
}

/// A scene with its integrator coarser by this factor, or finer below 1.
std::shared_ptr<const Scene> with_integrator_coarser(const std::shared_ptr<const Scene>& scene,
                                                     double factor) {
  const SceneIntegrator& integrator = scene->run.integrator;
  const bool fixed = integrator.record->step(integrator.description.get()) > 0.0;
  return with_integrator(scene, [=](const Parameter& row, double& number) {
    if (fixed ? row.key == "dt" : row.key.ends_with("tolerance")) number *= factor;
  });
}

/// Begun with this step where an adaptive scheme would guess one. The guess does not know the
/// tolerance: runs that begin with the same step have the same error in what happens within it.
std::shared_ptr<const Scene> with_first_step(const std::shared_ptr<const Scene>& scene,
                                             double step) {
  return with_integrator(scene, [=](const Parameter& row, double& number) {
    if (row.key == "initial_step" && number == 0.0) number = step;
  });
}

double mean_step_of(const RunResult& result) {
  return result.steps > 0 ? result.end_time / static_cast<double>(result.steps) : 0.0;
}

/// The integrator of a scene, coarser; steps half as long where longer ones are not stable.
std::vector<Companion> companions_of(const std::shared_ptr<const Scene>& scene) {
  constexpr double kToleranceFactor = 10.0;
  constexpr double kLongestOfStable = 0.95;
  const IntegratorRecord& scheme = *scene->run.integrator.record;
  const double dt = scheme.step(scene->run.integrator.description.get());
  std::vector<Companion> companions;
  if (dt == 0.0) {
    for (const double share : kSharesOfTolerances) {
      const double factor = std::pow(kToleranceFactor, static_cast<double>(companions.size() + 1));
      companions.push_back({with_integrator_coarser(scene, factor), "", share});
    }
    return companions;
  }
  Engine engine(scene, options_to_bind());
  const double stable = kLongestOfStable * stable_step_of(engine.model(), scheme);
  double factor = 1.0;
  for (const double share : shares_of_steps(scheme.order)) {
    factor *= 2.0;
    if (factor * dt > stable) break;
    companions.push_back({with_integrator_coarser(scene, factor), "", share});
  }
  if (companions.size() == 1) companions.front().share *= kSingleCompanion;
  if (!companions.empty()) return companions;
  // Half the step removes at least three quarters of the error from second order on.
  return {{with_integrator_coarser(scene, 0.5), "", kSingleCompanion * 4.0 / 3.0}};
}

/// Errors are held against the typical one of all observables: all are looked at, and those that
/// nobody has asked for are left out in the end.
RunOptions looking_at_all(RunOptions options) {
  options.all_observables = true;
  return options;
}

void keep_what_is_asked_for(const Scene& scene, const RunOptions& options, RunResult& result) {
  if (options.all_observables) return;
  selection_of(scene, options).keep_rows(result.groups);
  const std::vector<Observable> left = observables(result);
  std::erase_if(result.errors, [&](const ErrorEstimate& error) {
    return std::none_of(left.begin(), left.end(),
                        [&](const Observable& one) { return one.path == error.path; });
  });
}

}  // namespace

void estimate_errors(const ChosenIntegrator& chosen, const RunOptions& options, RunResult& result) {
  const double accuracy = *chosen.scene->run.accuracy;
  result.accuracy = AccuracyResult{};
  AccuracyResult& taken = *result.accuracy;
  taken.asked = accuracy;
  taken.integrator = chosen.text;
  taken.pilot_cost = chosen.pilot_cost;
  taken.scheme = chosen.scene->run.integrator.record;
  if (!chosen.companions.empty()) {
    taken.companion = chosen.companions.front().text;
    taken.companion_scheme = chosen.companions.front().scene->run.integrator.record;
  }
  result.warnings.insert(result.warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
  if (result.status != RunStatus::finished) return;
  if (chosen.companions.empty()) {
    warn(result, FaultCode::run_error_not_estimated,
         "no error was estimated: nothing cheaper than the run will do");
    return;
  }
  const auto cost = static_cast<double>(result.force_evaluations + result.jacobian_columns);
  const double mean_step = mean_step_of(result);
  std::vector<Beside> finished;
  for (const Companion& companion : chosen.companions) {
    TrialLimits limits;
    limits.stop = options.stop;
    limits.start_from = options.start_from;
    limits.store = options.store;
    limits.all_observables = true;
    limits.name = companion.other_family ? "other_family"
                  : finished.empty()     ? "companion"
                                         : "second_companion";
    // A run may end a little above its limit.
    const auto most = static_cast<std::uint64_t>(kMostForCompanions * cost);
    limits.cost = most - std::min(most, taken.companion_cost);
    if (companion.other_family) limits.cost = std::max(limits.cost, taken.pilot_cost);
    TrialRun trial = try_run(with_first_step(companion.scene, mean_step), limits);
    taken.companion_cost += trial.cost();
    if (trial.end == TrialRun::End::interrupted) {
      result.status = RunStatus::interrupted;
      warn(result, FaultCode::run_comparison_stopped,
           "stopped while errors were estimated: there are none yet");
      return;
    }
    if (!trial.finished()) {
      if (!finished.empty()) {
        if (!companion.other_family) finished.front().share *= kSingleCompanion;
        continue;
      }
      warn(result, FaultCode::run_error_not_estimated,
           trial.end == TrialRun::End::over_budget
               ? fmt::format("no error was estimated: a coarser run took more than {} of this one",
                             kMostForCompanions)
               : "no error was estimated: the coarser run did not end" +
                     (trial.why.empty() ? std::string() : ": " + trial.why));
      return;
    }
    if (!finished.empty()) taken.second_companion = companion.text;
    if (companion.other_family) taken.companion_scheme = companion.scene->run.integrator.record;
    // A difference of the size of the companion's own error is no error of the run.
    if (companion.other_family && !finished.empty() &&
        relative_difference(trial.result, result, chosen.length) <= kContradiction * accuracy) {
      continue;
    }
    finished.push_back({std::move(trial.result), companion.share});
  }
  add_errors(result, finished);
  warn_of_large_errors(result, finished, chosen);
}

RunResult run(const std::shared_ptr<const Scene>& scene, const RunOptions& options) {
  if (!scene->run.accuracy) return run_as_bound(scene, options);
  const ChosenIntegrator chosen =
      choose_integrator(scene, *scene->registry, options.stop, kMostPilotWork, options.store);
  if (chosen.interrupted) {
    RunResult result;
    result.status = RunStatus::interrupted;
    return result;
  }
  RunResult result = run_as_bound(chosen.scene, looking_at_all(options));
  estimate_errors(chosen, options, result);
  keep_what_is_asked_for(*scene, options, result);
  return result;
}

RunResult run_with_errors(const std::shared_ptr<const Scene>& scene, const RunOptions& options) {
  if (scene->run.accuracy) return run(scene, options);
  RunResult result = run_as_bound(scene, looking_at_all(options));
  if (result.status != RunStatus::finished) return result;
  TrialLimits limits;
  limits.stop = options.stop;
  limits.all_observables = true;
  const double mean_step = mean_step_of(result);
  std::vector<Beside> finished;
  for (const Companion& companion : companions_of(scene)) {
    TrialRun other = try_run(with_first_step(companion.scene, mean_step), limits);
    if (other.end == TrialRun::End::interrupted) result.status = RunStatus::interrupted;
    if (other.finished()) finished.push_back({std::move(other.result), companion.share});
  }
  if (!finished.empty()) add_errors(result, finished);
  keep_what_is_asked_for(*scene, options, result);
  return result;
}

}  // namespace tomlin
