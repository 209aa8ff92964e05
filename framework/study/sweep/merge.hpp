#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

/// Parts of one sweep, each with a journal of its own, are made one record by record.
namespace tomlin {

/// A point whose rows in two journals differ, which the same program never gives.
struct RowConflict {
  std::size_t point = 0;
  std::size_t one = 0;    ///< journal
  std::size_t other = 0;  ///< likewise
  std::string what;       ///< "driver.mean_force.x = 0.1 and 0.2"
};

/// The first of these points. Throws DamagedFile.
std::optional<RowConflict> find_conflict(const SweepPlan& plan,
                                         const std::deque<SweepJournal>& journals);

/// Keeps all rows of the journals that `into` does not have, until it is stopped. Their number.
/// Throws DamagedFile, OutputError.
std::size_t merge_rows(const SweepPlan& plan, const std::deque<SweepJournal>& journals,
                       SweepJournal& into, const std::atomic<bool>& stop);

}  // namespace tomlin
