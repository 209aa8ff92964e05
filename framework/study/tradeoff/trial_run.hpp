#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "framework/run/run.hpp"

/// Runs of a study: quiet, within limits, and without exceptions for what the scene refuses.
namespace tomlin {

struct TrialLimits {
  double seconds = std::numeric_limits<double>::infinity();  ///< of the machine's time
  /// Evaluations of all forces and columns of Jacobians.
  std::uint64_t cost = std::numeric_limits<std::uint64_t>::max();
  const std::atomic<bool>* stop = nullptr;        ///< set by a signal
  std::optional<Perturbation> perturbation = {};  ///< noise on the start
  const FinalState* start_from = nullptr;         ///< see RunOptions
  std::vector<std::string> observables = {};      ///< likewise
  bool all_observables = false;                   ///< likewise
  RunStore* store = nullptr;                      ///< where it keeps its checkpoints, if anywhere,
  std::string name = {};                          ///< and under which name
};

struct TrialRun {
  enum class End { finished, over_budget, failed, refused, interrupted } end = End::finished;
  RunResult result;       ///< of as much as there was; empty when refused
  std::string why;        ///< when failed or refused: one line
  double duration = 0.0;  ///< what the scene asked for
  double seconds = 0.0;   ///< of the machine, without what binding takes

  bool finished() const { return end == End::finished; }
  /// Evaluations of all forces; columns of Jacobians count as one each.
  std::uint64_t cost() const { return result.force_evaluations + result.jacobian_columns; }
  /// Part of the run that was done.
  double part() const { return duration > 0.0 ? result.end_time / duration : 0.0; }
};

/// Runs a scene without a sink and without its `perturb`. A run that takes longer than the limit
/// is stopped, a few dozen steps later; all steps are those of run().
TrialRun try_run(const std::shared_ptr<const Scene>& scene, const TrialLimits& limits = {});

/// Returns the results that a scene has, none of them measured: binds the scene and takes no step.
/// Throws InputError for what a run would refuse.
RunResult result_at_start(const std::shared_ptr<const Scene>& scene);

}  // namespace tomlin
