#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// `[run] accuracy`: the program picks the integrator, and says how large the errors are.
///
/// A pilot, three stick-slip cycles where there is a driver, is run with every integrator that the
/// scene admits, from coarse to fine, and held against a far finer run. Cost is counted in
/// evaluations of all forces and columns of Jacobians, never in seconds, so that the same scene
/// gets the same integrator everywhere. The cheapest setting whose error after the pilot's first
/// cycle is a tenth of what is asked for becomes the companion; the run itself takes the cheapest
/// one that costs at least 1/0.6 of that and has at most a tenth of its error.
///
/// With e the error of the run and E, at least 3 e, that of its companion, their results differ by
/// at least 2 e: half the difference is the estimate, of every observable, and errs on the safe
/// side wherever the companion is worse than that. Where the pilot found no such pair, the whole
/// difference is.
namespace tomlin {

/// What the companion may cost, as a part of the run.
inline constexpr double kMostForCompanion = 0.6;

struct ChosenIntegrator {
  std::shared_ptr<const Scene> scene;      ///< with it; otherwise as it was asked for
  std::shared_ptr<const Scene> companion;  ///< the same, cheaper; null: nothing cheaper will do
  std::string text;                        ///< the integrator as a line of a scene
  std::string companion_text;
  double share = 1.0;            ///< of the difference to the companion that is the error
  double length = 1.0;           ///< of the scene: its shortest period where it has one
  std::uint64_t pilot_cost = 0;  ///< evaluations and columns
  bool interrupted = false;      ///< `stop` was set meanwhile; nothing else counts then
  std::vector<std::string> warnings;
};

/// For a scene with an accuracy. Throws InputError for what every integrator refuses.
ChosenIntegrator choose_integrator(const std::shared_ptr<const Scene>& scene,
                                   const Registry& registry,
                                   const std::atomic<bool>* stop = nullptr);

/// Runs the companion of a finished run, and adds errors, the choice and warnings to the result.
void estimate_errors(const ChosenIntegrator& chosen, const RunOptions& options, RunResult& result);

/// All of it: choose, run, estimate. A scene without an accuracy is simply run.
RunResult run_to_accuracy(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options = {});

/// The same with errors for a scene that has an integrator, too: its companion takes tolerances
/// thirty times as wide, or steps twice as long (half as long where that is not stable).
RunResult run_with_errors(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options = {});

}  // namespace tomlin
