#include "framework/study/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "framework/run/engine.hpp"
#include "framework/run/observables.hpp"
#include "framework/study/trial_run.hpp"

namespace tomlin {
namespace {

/// Nothing is known better than to the last digits of a double.
constexpr double kRounding = 1e-15;

/// What has an error: what drivers, bodies and the ledger show. Counts and clocks have none.
bool has_error(const std::string& path) {
  return path.starts_with("drivers.") || path.starts_with("bodies.") || path.starts_with("energy.");
}

void add_errors(RunResult& result, const RunResult& companion, double share) {
  for (const Observable& one : observables(result)) {
    if (!has_error(one.path)) continue;
    const auto other = observable(companion, one.path);
    ErrorEstimate estimate{one.path, std::nullopt};
    if (one.value && other) {
      estimate.error =
          std::max(share * std::abs(*one.value - *other), kRounding * std::abs(*one.value));
    }
    result.errors.push_back(std::move(estimate));
  }
}

void warn_of_large_errors(const RunResult& main, const RunResult& companion,
                          const ChosenIntegrator& chosen, std::vector<std::string>& warnings) {
  const double accuracy = *chosen.scene->run.accuracy;
  const double found = chosen.share * relative_difference(companion, main, chosen.length);
  if (found <= accuracy) return;
  warnings.push_back(
      fmt::format("accuracy {:g} was not reached: the estimated error is {:.1e} of the result",
                  accuracy, found));
}

/// The integrator of a scene, coarser or finer, and what part of the difference is its error.
struct Companion {
  std::shared_ptr<const Scene> scene;
  double share = 1.0;
};

Companion companion_of(const std::shared_ptr<const Scene>& scene) {
  constexpr double kWider = 30.0;
  constexpr double kNearlyStable = 0.95;
  const SceneIntegrator& integrator = scene->run.integrator;
  const double dt = integrator.record->step(integrator.description.get());
  double factor = kWider;
  Companion companion{nullptr, kShareOfDifference};
  if (dt > 0.0) {
    const bool stable = 2.0 * dt <= kNearlyStable * Engine(scene, {}).stable_step();
    factor = stable ? 2.0 : 0.5;
    // Of second order at least: the longer step has four times the error.
    companion.share = stable ? 1.0 / 3.0 : 4.0 / 3.0;
  }
  auto description = integrator.record->make_description();
  for (const Parameter& row : integrator.record->parameters) {
    ParameterValue value = row.read(integrator.description.get());
    const bool turned = dt > 0.0 ? row.key == "dt" : row.key.ends_with("tolerance");
    if (turned) value = std::get<double>(value) * factor;
    row.assign(description.get(), std::move(value));
  }
  auto other = std::make_shared<Scene>(*scene);
  other->run.integrator.description = std::move(description);
  companion.scene = std::move(other);
  return companion;
}

}  // namespace

void estimate_errors(const ChosenIntegrator& chosen, const RunOptions& options, RunResult& result) {
  const double accuracy = *chosen.scene->run.accuracy;
  result.accuracy = AccuracyResult{accuracy, chosen.text, chosen.companion_text, chosen.pilot_cost};
  result.accuracy->scheme = chosen.scene->run.integrator.record;
  if (chosen.companion) result.accuracy->companion_scheme = chosen.companion->run.integrator.record;
  result.warnings.insert(result.warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
  if (result.status != RunStatus::finished) return;
  if (chosen.companion == nullptr) {
    result.warnings.emplace_back("no error was estimated: nothing cheaper than the run will do");
    return;
  }
  TrialLimits limits;
  limits.stop = options.stop;
  const std::uint64_t cost = result.force_evaluations + result.jacobian_columns;
  limits.cost = static_cast<std::uint64_t>(kMostForCompanion * static_cast<double>(cost));
  const TrialRun companion = try_run(chosen.companion, limits);
  result.accuracy->companion_cost = companion.cost();
  if (!companion.finished()) {
    result.warnings.push_back(
        companion.end == TrialRun::End::over_budget
            ? fmt::format("no error was estimated: a cheaper run took more than {} of this one",
                          kMostForCompanion)
            : "no error was estimated: the cheaper run did not end" +
                  (companion.why.empty() ? std::string() : ": " + companion.why));
    return;
  }
  add_errors(result, companion.result, chosen.share);
  warn_of_large_errors(result, companion.result, chosen, result.warnings);
}

RunResult run_to_accuracy(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options) {
  if (!scene->run.accuracy) return run(scene, options);
  const ChosenIntegrator chosen = choose_integrator(scene, registry, options.stop);
  if (chosen.interrupted) {
    RunResult result;
    result.status = RunStatus::interrupted;
    return result;
  }
  RunResult result = run(chosen.scene, options);
  estimate_errors(chosen, options, result);
  return result;
}

RunResult run_with_errors(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options) {
  if (scene->run.accuracy) return run_to_accuracy(scene, registry, options);
  RunResult result = run(scene, options);
  if (result.status != RunStatus::finished) return result;
  const Companion companion = companion_of(scene);
  TrialLimits limits;
  limits.stop = options.stop;
  const TrialRun other = try_run(companion.scene, limits);
  if (other.finished()) add_errors(result, other.result, companion.share);
  return result;
}

}  // namespace tomlin
