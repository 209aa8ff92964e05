#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "framework/output/run_folder.hpp"
#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/part.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

/// `tomlin sweep`: a sweep with everything that it leaves in a folder.
namespace tomlin {

struct RecordedSweep {
  SweepProgress progress;
  std::optional<SweepCounts> counts;  ///< where all points, or all of a shard, have a row
  std::optional<SweepPart> shard;     ///< nothing where the results are those of the whole sweep
  std::vector<Bisection> bisections;
  SweepStatus status = SweepStatus::finished;  ///< `refused` where every point is
  bool over_before = false;  ///< there was nothing left to do, and nothing was touched
};

struct RecordedSweepOptions {
  std::size_t threads = 1;
  std::optional<SweepPart> shard = {};
  std::vector<std::size_t> traced = {};  ///< points whose full results are kept
  bool begins_anew = false;              ///< whatever the folder holds
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const SweepProgress&)> on_progress = {};
  SweepOptions::RunPoints run_points = {};
};

/// Runs what has no row yet. The folder is owned. Throws InputError, OutputError, DamagedFile.
RecordedSweep record_sweep(RunFolder& folder, SweepPlan& plan, const RecordedSweepOptions& options);

}  // namespace tomlin
