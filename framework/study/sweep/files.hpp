#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "framework/core/text/fault_code.hpp"
#include "framework/study/sweep/part.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

/// The results of a sweep, made once every point has a row. They depend on the rows alone, and take
/// the same memory for any number of points but for the order of those of a refinement (RowOrder).
/// A file appears complete or not at all.
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

/// Counts of the rows of a sweep, or of a part of it, and of their warnings.
struct SweepCounts {
  struct Warned {
    std::size_t points = 0;
    std::size_t first = 0;  ///< row of the first of them
  };
  std::array<std::size_t, kSweepStatuses> by_status = {};
  std::map<FaultCode, Warned> warnings;
  std::size_t first_without_numbers = 0;  ///< row of the first that failed or was refused, where
  std::size_t point_without_numbers = 0;  ///< there is one, its point
  std::string reason;                     ///< and its reason

  /// The status of the whole: `refused` where every point is.
  SweepStatus status() const {
    const std::size_t others = of(SweepStatus::finished) + of(SweepStatus::failed);
    return others == 0 ? SweepStatus::refused : SweepStatus::finished;
  }
  std::size_t of(SweepStatus status) const { return by_status[static_cast<std::size_t>(status)]; }
};

/// Counts the rows of a part, all of whose points must have a row. Throws DamagedFile.
SweepCounts count_rows(const SweepPlan& plan, const SweepJournal& journal, SweepPart part = {});

/// Comma-separated values: a row per point in the order of the axes with the values of the axes,
/// the columns of the plan, status and reason. Numbers have 17 significant digits, undefined ones
/// are empty. Throws OutputError, DamagedFile.
void write_sweep_table(const std::filesystem::path& file, const SweepPlan& plan,
                       const SweepJournal& journal);

/// netCDF-4: an HDF5 file with a dimension for each axis, called like it, whose values are the
/// variable of that name; zipped axes share a dimension `point` (the next ones point_2, ...), along
/// which each is a variable. Columns, status and reason are variables over all dimensions. With a
/// refinement, points make no grid: all axes and columns are variables along `point`. Throws
/// OutputError, DamagedFile.
void write_sweep_arrays(const std::filesystem::path& file, const SweepPlan& plan,
                        const SweepJournal& journal);

}  // namespace tomlin
