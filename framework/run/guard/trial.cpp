#include "framework/run/guard/trial.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "framework/run/context.hpp"
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
  if (engine.thrown()) throw *engine.thrown();

  Trial trial;
  trial.layout = engine.layout();
  trial.stable_step = dt > 0.0 ? engine.stable_step() : std::numeric_limits<double>::infinity();
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
  if (engine.thrown()) throw *engine.thrown();
  trial.seconds = elapsed();
  trial.time = engine.time();
  if (const auto& failure = engine.context().outcome.failure) trial.failure = failure->code;
  trial.finished = engine.done() && !trial.failure;
  trial.evaluations = engine.model().system().evaluations;
  trial.steps = engine.steps();
  return trial;
}

std::optional<RunLayout> layout_of(const std::shared_ptr<const Scene>& scene) {
  const Engine engine(scene, options_to_bind());
  if (engine.thrown() || engine.failed()) return std::nullopt;
  return engine.layout();
}

}  // namespace tomlin
