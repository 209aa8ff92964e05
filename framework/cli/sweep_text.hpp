#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "framework/cli/recorded_sweep.hpp"
#include "framework/study/sweep/part.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

/// Output of `tomlin sweep` besides its tables.
namespace tomlin {

/// "37 %, 370 of 1000 points, 2 failed, 0:12 elapsed, 0:20 remaining, 31 points/s"
std::string sweep_progress_text(const SweepProgress& progress);

/// The result for people; `where` says where the files are.
std::string sweep_text(const SweepPlan& plan, const RecordedSweep& sweep, const std::string& where);

/// The result of `tomlin merge`. `first_missing` is the first point without a row, if any.
std::string merge_text(const SweepPlan& plan, const RecordedSweep& merged,
                       std::size_t first_missing, const std::string& where);

/// sweep.json; nothing but `performance` depends on how the sweep came to its end.
std::string sweep_json(const SweepPlan& plan, const RecordedSweep& sweep, std::size_t threads);

/// For --dry-run: points, and what they cost by a trial of one of them.
std::string sweep_plan_text(const SweepPlan& plan, std::size_t threads,
                            const std::optional<SweepPart>& shard);

}  // namespace tomlin
