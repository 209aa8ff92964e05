#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "framework/run/steps/lane_batch.hpp"
#include "framework/study/sweep/point_run.hpp"
#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// Hands out points, one line after the other, and takes their rows.
class PointSource {
 public:
  virtual ~PointSource() = default;
  /// The next point, or all of the next line that have no row; empty: there are no more.
  virtual std::vector<std::size_t> take() = 0;
  virtual void keep(std::size_t point, const SweepRow& row) = 0;

 protected:
  PointSource() = default;
};

struct WorkerOptions {
  const std::atomic<bool>* stop = nullptr;
  std::filesystem::path checkpoints = {};  ///< a folder; none: points start again
  std::size_t most_at_once = 1;            ///< points in lanes: a fair share of all
};

/// Runs points in one thread: those of a line one after the other (run_line()), where they continue
/// from their neighbour. Otherwise those of one structure, scheme and step are taken in lanes
/// (LaneBatch), and what ends is replaced by the next; the others are run one by one. Rows do not
/// depend on it.
class SweepWorker {
 public:
  SweepWorker(const SweepPlan& plan, PointSource& source, WorkerOptions options)
      : plan_(plan), source_(source), options_(std::move(options)) {}

  /// Runs points until there are no more, or it is stopped: checkpoints are then written.
  void work();

 private:
  using Runs = std::vector<std::unique_ptr<PointRun>>;

  bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }
  bool fetch();
  Runs gather(const LaneBatch& batch, std::size_t most);
  void run_first();
  void run_batch(std::unique_ptr<PointRun> first, Runs runs);
  void keep(const PointRun& run, const std::optional<SweepRow>& row);

  const SweepPlan& plan_;
  PointSource& source_;
  WorkerOptions options_;
  std::deque<std::unique_ptr<PointRun>> waiting_;  ///< bound, for a batch of their structure
};

}  // namespace tomlin
