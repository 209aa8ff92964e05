#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>

#include "framework/run/engine.hpp"
#include "framework/study/sweep/point_checkpoint.hpp"
#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// The run of one point of a sweep.
class PointRun {
 public:
  /// With a folder for checkpoints, a run that is stopped or takes longer than `[run]
  /// checkpoint_every` leaves there what the next one resumes from. Throws InputError where the
  /// point is refused.
  PointRun(const SweepPlan& plan, std::size_t point, const std::atomic<bool>* stop = nullptr,
           const std::filesystem::path& checkpoints = {});

  std::size_t point() const { return point_; }
  /// Before anything else: where it starts and where its end goes, as in RunOptions.
  void connect(const FinalState* start_from, FinalState* final_state) {
    options_.start_from = start_from;
    options_.final_state = final_state;
  }
  /// The whole run, with all that the scene says. No row: it was stopped.
  std::optional<SweepRow> run();

  /// The run as a batch takes it: bound, and at its start or where its checkpoint is. None where
  /// the scene has more than one run made.
  Engine* engine();
  /// After its last step.
  std::optional<SweepRow> end();

  /// Once the row is kept.
  void remove_checkpoint() const;

 private:
  template <class Act>
  auto resumed(Act act);
  template <class Act>
  std::optional<SweepRow> row_unless_refused(Act act);
  std::optional<SweepRow> row_of(const RunResult& result);

  const SweepPlan& plan_;
  std::size_t point_;
  std::shared_ptr<const Scene> scene_;
  RunOptions options_;
  std::filesystem::path file_;  ///< of its checkpoint; empty: none
  std::optional<PointCheckpoint> checkpoint_;
  std::unique_ptr<Engine> engine_;
};

/// The row of a point that the scene refuses.
SweepRow row_of_refused(const SweepPlan& plan, const InputError& error);

/// The row of a point, run by itself; nothing when it was stopped. What a scene refuses and how a
/// run fails is in the row. A checkpoint of the point stays. Throws std::bad_alloc: another time,
/// or in fewer threads, there may be the memory.
std::optional<SweepRow> run_point(const SweepPlan& plan, std::size_t point,
                                  const std::atomic<bool>* stop = nullptr,
                                  const std::filesystem::path& checkpoints = {});

}  // namespace tomlin
