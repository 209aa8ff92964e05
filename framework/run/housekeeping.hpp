#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>

#include "framework/run/context.hpp"
#include "framework/run/results/observation.hpp"

namespace tomlin {

/// Work between blocks of steps: the origin follows, rotations are looked at, noise is added,
/// progress is reported, checkpoints are kept, and a run that is asked to stop does.
class Housekeeping {
 public:
  Housekeeping(RunContext& run, Observation& observation);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// The model is placed.
  void start();
  /// The run resumes from a checkpoint.
  void resumed();

  /// Called at the end of each block of steps, after what observes it.
  void call_after_blocks(std::function<void()> action) { after_blocks_ = std::move(action); }

  /// After a step.
  void after_step() {
    if (run_.block_ends()) {
      after_block();
    } else if (observation_.rotations().is_needed_at_every_step()) {
      follow_rotations();
    }
  }
  void after_block();
  /// The last step was left before all of its samples were served: there is no checkpoint of it.
  void stop_within_step();
  void keep_checkpoint();
  /// Keeps the end where runs follow whose results are compared with this one's: this run need not
  /// be repeated when those are stopped.
  void keep_end();

  double seconds() const;
  /// Since the run began or was resumed.
  std::uint64_t steps() const;

 private:
  bool has_more_than_numbers() const;
  using Clock = std::chrono::steady_clock;
  void follow();
  void follow_rotations();
  void look_at_clock();
  void disturb();

  RunContext& run_;
  Observation& observation_;
  std::function<void()> after_blocks_;
  double time_before_ = 0.0;       ///< where a resumed run went on from
  std::int64_t steps_before_ = 0;  ///< taken before that
  double* disturbed_ = nullptr;    ///< of a run that is disturbed: when last
  double disturb_every_ = 0.0;     ///< at the earliest; 0: never again after the start
  Clock::time_point started_;
  Clock::time_point last_report_;
  Clock::time_point last_checkpoint_;
  Clock::time_point last_look_;
  int looks_apart_ = 1;  ///< blocks between looks at the clock
  int blocks_to_look_ = 1;
};

}  // namespace tomlin
