#include "framework/run/guard/trial.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "framework/model/stability.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/guard/start_checks.hpp"

namespace tomlin {
namespace {

/// Looks at the clock come ever more rarely, so that they do not count.
constexpr std::uint64_t kMostBetweenLooks = 4096;

}  // namespace

Trial try_out(const std::shared_ptr<const Scene>& scene, double seconds, InstructionSet set) {
  const RunSettings& run = scene->run;
  const double dt = run.integrator.record->step(run.integrator.description.get());
  RunOptions options;
  options.instruction_set = set;
  Engine engine(scene, options);
  RunContext& context = engine.context();
  const RunOutcome& outcome = context.outcome;
  if (outcome.thrown) throw *outcome.thrown;

  Trial trial;
  trial.layout = engine.layout();
  trial.stable_step = dt > 0.0 ? stable_step_of(context.model, context.scheme)
                               : std::numeric_limits<double>::infinity();
  trial.step_is_stable = is_stable(std::min(dt, run.duration), trial.stable_step);
  if (!trial.step_is_stable) return trial;

  const auto started = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  };
  std::uint64_t next = 1;
  while (!engine.done() && elapsed() < seconds) {
    engine.advance(next);
    next = std::min(2 * next, kMostBetweenLooks);
  }
  if (outcome.thrown) throw *outcome.thrown;
  trial.seconds = elapsed();
  trial.time = engine.time();
  if (outcome.failure) trial.failure = outcome.failure->code;
  trial.finished = engine.done() && !trial.failure;
  trial.evaluations = context.model.system().evaluations;
  trial.steps = engine.steps();
  return trial;
}

std::optional<RunLayout> layout_of(const std::shared_ptr<const Scene>& scene) {
  Engine engine(scene, options_to_bind());
  if (engine.context().outcome.failure) return std::nullopt;
  return engine.layout();
}

}  // namespace tomlin
