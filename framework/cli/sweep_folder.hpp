#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "framework/output/run_folder.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

/// The folder of a sweep, as `sweep` and `merge` use it.
namespace tomlin {

inline constexpr std::array kSweepFiles = {kSweepSummaryFile, kSweepTableFile, kSweepArraysFile,
                                           kSweepJournalFile, kSceneFile};
inline constexpr std::array kSweepResults = {kSweepSummaryFile, kSweepTableFile, kSweepArraysFile};

/// With the checkpoints of points, while the sweep goes on.
inline constexpr const char* kPointsFolder = "sweep.points";

/// A sweep that was begun with the same input is gone on with. Throws InputError where the folder
/// is of another one.
Occupied occupied_by_sweep(const std::filesystem::path& folder, const SweepPlan& plan, bool force);

/// Owns the folder. Throws InputError where results would replace what the scene reads.
void own_sweep_folder(RunFolder& folder, const SweepPlan& plan, bool force, bool quiet);

/// Removes all that a sweep, or a run, has left in a folder that is owned.
void remove_sweep(RunFolder& folder);

bool holds_all_results(const RunFolder& folder);
/// "DIR/: sweep.json, sweep.csv"
std::string where_the_sweep_is(const RunFolder& folder);

/// Removes what a sweep has left of its points, without `traces` only checkpoints, and the folder
/// if it is empty then; nothing that others have put there.
void remove_points(const std::filesystem::path& folder, bool traces = true);

/// The table and the arrays of a sweep all of whose points have a row.
SweepCounts write_sweep_results(const RunFolder& folder, const SweepPlan& plan,
                                const SweepJournal& journal);

}  // namespace tomlin
