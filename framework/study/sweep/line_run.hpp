#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "framework/model/final_state.hpp"
#include "framework/output/store_file.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "framework/study/sweep/worker.hpp"

namespace tomlin {

/// How far the points of a line have come, each of which starts where the one before it has ended:
/// the next one, and the state that it starts from. It is written to a file when points have taken
/// as long as checkpoints are apart, and when the sweep is stopped; what is lost is computed again.
class LineEnd {
 public:
  /// The line begins with the point `first` and resumes at the point `most` or before it. Without a
  /// folder nothing is written.
  LineEnd(const SweepPlan& plan, std::size_t first, std::size_t most,
          const std::filesystem::path& folder);

  /// The next point; the first one where no earlier process has left anything.
  std::size_t next() const { return next_; }
  /// The state that it starts from; null: the scene's start.
  const FinalState* before() const { return next_ == first_ ? nullptr : &state_; }

  /// The next point has ended so; a state that is not known: it has not finished.
  void pass(FinalState state);
  /// Writes the file; called when the line is stopped.
  void write() { store_.write(); }
  /// Removes the file; called when the line ends.
  void remove() const { store_.remove(); }

 private:
  std::size_t first_;
  std::size_t next_;
  FinalState state_;
  StoreFile store_;
};

/// Runs points of one line, each from where the one before it has ended; first those before them
/// whose end is not known any more, whose rows are there already. A point whose neighbour has not
/// finished is refused. False where it was stopped.
bool run_line(const SweepPlan& plan, const std::vector<std::size_t>& points, PointSource& source,
              const WorkerOptions& options);

}  // namespace tomlin
