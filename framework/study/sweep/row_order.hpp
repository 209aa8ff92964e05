#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// The points of a sweep in the order of the rows of its results: that of the axes, in which an
/// added point lies between its neighbours. Without a refinement it is that of their numbers, and
/// takes no memory.
class RowOrder {
 public:
  explicit RowOrder(const SweepPlan& plan);

  std::size_t size() const { return plan_.refinement() ? points_.size() : plan_.points(); }
  std::size_t point(std::size_t row) const { return plan_.refinement() ? points_[row] : row; }
  /// Successive rows. Throws DamagedFile.
  void read(const SweepJournal& journal, std::size_t first, std::span<SweepRow> rows) const;

 private:
  const SweepPlan& plan_;
  std::vector<std::size_t> points_;
};

}  // namespace tomlin
