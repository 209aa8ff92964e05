#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "framework/core/text/words.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// Outcome of a bisection between two neighbours, or of the search for them in a line.
enum class BisectionStatus {
  found,   ///< an interval as narrow as it was to be
  smooth,  ///< the difference fell below half of what it was: there is no jump
  failed,  ///< a point inside, or an end, has no number; it is the interval that was left then
  none,    ///< of a line: no neighbours on either side of the level, or no difference
};

constexpr auto word_table(BisectionStatus) {
  using enum BisectionStatus;
  return std::to_array<Word<BisectionStatus>>(
      {{found, "found"}, {smooth, "smooth"}, {failed, "failed"}, {none, "none"}});
}

/// Bisection of one interval.
struct Bisection {
  /// A number of the observable at a point; the refined axis has this value there.
  struct End {
    std::size_t point = 0;
    double at = 0.0;
    double number = 0.0;
  };
  std::optional<BisectionStatus> status;  ///< none: it goes on
  std::size_t first = 0;                  ///< point of the line
  std::array<End, 2> ends = {};           ///< unless the status is none
  std::size_t left = 0;                   ///< the point of the dimensions where it began
  double difference = 0.0;                ///< of its numbers then
  std::size_t rounds = 0;                 ///< points inside, of which so many
  std::size_t round = 0;                  ///< have been looked at
};

/// Adds points to a plan whose grid has rows: those of a refinement, round by round. Which they are
/// depends on rows alone, and each on rows of its own line, whoever has run them and when.
///
/// With a level, each pair of neighbours is bisected of which one observable is below and the other
/// one is not. Between two with points that have no number it has failed. Where a line has no such
/// pair and its first or last point has no number, the level may be crossed next to that point: the
/// search goes there, and stays at the crossing if it meets one. Without a level the first pair of
/// the largest difference in each line is bisected, and that half of it which has the larger one.
class SweepBisection {
 public:
  /// The plan must have a refinement. Plan and journal must outlive the object.
  SweepBisection(SweepPlan& plan, const SweepJournal& journal) : plan_(plan), journal_(journal) {}

  /// Once all points so far have a row. False: none are missing, and all bisections have ended.
  /// Throws DamagedFile.
  bool add_points();

  /// In the order of the points.
  const std::vector<Bisection>& all() const { return bisections_; }

 private:
  double observed_at(std::size_t point) const;
  void begin();
  void begin_in_line(std::size_t first);
  void go_on(Bisection& bisection);

  SweepPlan& plan_;
  const SweepJournal& journal_;
  bool has_begun_ = false;
  std::vector<Bisection> bisections_;
};

}  // namespace tomlin
