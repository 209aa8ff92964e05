#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "framework/output/store_file.hpp"
#include "framework/run/engine.hpp"
#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// The run of one point of a sweep.
class PointRun : private RunSink {
 public:
  /// With a folder for checkpoints, a run that is stopped or takes longer than `[run]
  /// checkpoint_every` leaves there what the next one resumes from. Throws InputError where the
  /// point is refused.
  PointRun(const SweepPlan& plan, std::size_t point, const std::atomic<bool>* stop = nullptr,
           const std::filesystem::path& checkpoints = {});

  std::size_t point() const { return point_; }
  /// Sets where it starts and where its end goes, as in RunOptions. It is called first.
  void connect(const FinalState* start_from, FinalState* final_state) {
    options_.start_from = start_from;
    options_.final_state = final_state;
  }
  /// The whole run, with all that the scene says; a run that fails or is refused on the way has a
  /// row. No row: it was stopped. Throws std::bad_alloc: another time, or in fewer threads, there
  /// may be the memory.
  std::optional<SweepRow> run();

  /// The run as a batch takes it: bound, and at its start or where its checkpoint is. None where
  /// the scene has more than one run made.
  Engine* engine();
  /// The row, after the last step.
  std::optional<SweepRow> end();

  /// Called once the row is kept.
  void remove_checkpoint() const;

 private:
  void begin(const RunLayout& layout) override { (void)layout; }
  void sample(const std::vector<double>& row) override { (void)row; }
  void checkpoint(const RunState& state) override;
  bool wants_samples() const override { return false; }

  template <class Act>
  auto resumed(Act act);
  template <class Act>
  std::optional<SweepRow> row_unless_refused(Act act);
  std::optional<SweepRow> row_of(const RunResult& result);

  const SweepPlan& plan_;
  std::size_t point_;
  std::shared_ptr<const Scene> scene_;
  RunOptions options_;
  /// It holds the checkpoints of the run, the choice of its integrator, and runs beside it.
  std::optional<StoreFile> store_;
  std::vector<std::byte> state_;  ///< that an earlier process has reached; empty: none
  std::unique_ptr<Engine> engine_;
};

/// The row of a point that the scene refuses.
SweepRow row_of_refused(const SweepPlan& plan, const InputError& error);

}  // namespace tomlin
