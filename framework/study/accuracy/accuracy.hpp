#pragma once

#include <memory>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/study/accuracy/pilot.hpp"

/// Runs that do all that a scene says, and how large the errors of a run are whose integrator the
/// pilot has picked (pilot.hpp).
///
/// Two companions run the whole scene with the same integrator, one setting coarser and two: with
/// tolerances ten and a hundred times as wide, or steps twice and four times as long. Of the same
/// scheme, they err as the run does, only more, in every observable. The stated error is a share of
/// the larger difference (pilot.hpp): one difference alone is small by chance now and then, where
/// an error changes its sign between two settings. Where an integrator of another family is as
/// accurate at the cost of a companion, it runs the scene, too: what one family loses in every
/// setting is seen by the other alone. Its difference counts where it contradicts the run.
namespace tomlin {

/// Does what the scene says: with `[run] accuracy`, picks its integrator, runs, and estimates the
/// errors of all results. Otherwise one run, as run_as_bound(). Throws InputError for what only
/// shows when the scene is bound; everything later is in the result.
RunResult run(const std::shared_ptr<const Scene>& scene, const RunOptions& options = {});

/// Runs the companions of a finished run, and adds errors, the choice and warnings to the result.
void estimate_errors(const ChosenIntegrator& chosen, const RunOptions& options, RunResult& result);

/// run() with errors for a scene that has an integrator, too.
RunResult run_with_errors(const std::shared_ptr<const Scene>& scene,
                          const RunOptions& options = {});

}  // namespace tomlin
