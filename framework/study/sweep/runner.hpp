#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <vector>

#include "framework/study/sweep/part.hpp"
#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// The points of a part that are still to be run, in their order. Safe to call from several
/// threads.
class SweepQueue {
 public:
  SweepQueue(const SweepPlan& plan, const SweepRows& rows, SweepPart part = {})
      : plan_(plan), rows_(rows), part_(part) {}

  /// Takes up to so many points, and all others of the last one's line; none: the queue is empty.
  std::vector<std::size_t> take(std::size_t most);

 private:
  std::mutex mutex_;
  const SweepPlan& plan_;
  const SweepRows& rows_;
  SweepPart part_;
  std::size_t next_ = 0;
};

/// Progress of a sweep in this process.
struct SweepProgress {
  std::size_t points = 0;                             ///< of the part that is run
  std::size_t before = 0;                             ///< that had a row when it began
  std::array<std::size_t, kSweepStatuses> done = {};  ///< since then, by status
  std::size_t traces_left = 0;                        ///< of those that were asked for
  double seconds = 0.0;

  std::size_t done_here() const;
  std::size_t with_row() const { return before + done_here(); }
  bool complete() const { return with_row() == points; }
};

struct SweepOptions {
  std::size_t threads = 1;
  SweepPart part = {};  ///< the points that are run
  /// Called when all points have a row, to add some to the plan; false: none are missing.
  std::function<bool()> add_points = {};
  const std::atomic<bool>* stop = nullptr;  ///< set by a signal: rows so far are kept
  /// A folder for the checkpoints of points that take long, NUMBER.store, of lines, NUMBER.line,
  /// and for traces, NUMBER/; none: points start again.
  std::filesystem::path folder = {};
  /// Points of which all results of a run are left there as well.
  std::vector<std::size_t> traced = {};
  /// Called from the thread that called run_sweep(), twice a second.
  std::function<void(const SweepProgress&)> on_progress = {};
  /// Runs the points without a row and keeps their rows, in place of the threads of this process.
  /// It gets what was done before and returns that with what it has added.
  using RunPoints = std::function<SweepProgress(const SweepPlan&, SweepRows&, const SweepOptions&,
                                                const SweepProgress&)>;
  RunPoints run_points = {};
};

/// Returns the progress with the points and rows that there are now, after what has been done.
SweepProgress progress_before(const SweepPlan& plan, const SweepRows& rows,
                              const SweepOptions& options, const SweepProgress& so_far = {});

/// Runs every point of the part that has no row, and keeps what it gives. A point that is stopped
/// leaves no row. Throws what SweepRows throws, once all threads have ended.
SweepProgress run_sweep(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options);

}  // namespace tomlin
