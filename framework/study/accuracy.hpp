#pragma once

#include <memory>

#include "framework/core/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/study/pilot.hpp"

/// `[run] accuracy`: how large the errors of a run are whose integrator the pilot has picked
/// (pilot.hpp).
///
/// With e the error of the run and E, at least 3 e, that of its companion, their results differ by
/// at least 2 e: half the difference is the estimate, of every observable, and errs on the safe
/// side wherever the companion is worse than that. Where the pilot found no such pair, the whole
/// difference is.
namespace tomlin {

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
