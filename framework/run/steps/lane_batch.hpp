#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/model/lane_system.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/steps/run_in_lanes.hpp"

namespace tomlin {

/// Why runs of a scene take all their steps by themselves; empty: they may be in a batch, unless
/// what is asked of them needs every step.
std::string why_not_in_lanes(const Model& model);

/// Runs of one structure and scheme that take their plain steps together, in the lanes of vectors.
/// All else a run does by itself, on its own numbers: its start, edges of the window, samples, the
/// moving origin, a step that fails, its end. Results have the bits of single runs.
///
/// Fixed steps, of the same length in all lanes, are at the same step between two anchors of the
/// forces, kBlock steps apart, though not at the same time. When one fails, nothing of it is kept,
/// and each run goes on by itself to its next anchor: the one whose step it was fails there.
/// Adaptive steps are anchored each at its start; an attempt is refused or accepted by each lane.
class LaneBatch {
 public:
  /// Takes runs like `like`, which is no part of it and outlives it; at most `most` at a time.
  LaneBatch(Engine& like, std::size_t most);

  bool fits(Engine& run) const;
  bool is_empty() const { return runs_ == 0; }
  std::size_t room() const { return lanes_.size() - runs_; }
  /// Fewer runs are faster one by one: a vector of eight takes as long as about two of them.
  static constexpr std::size_t kFewestRuns = 3;
  /// At most half the lanes are taken, and a narrower batch would have fewer; or so few runs are
  /// left that each is faster by itself.
  bool is_sparse() const {
    return runs_ < kFewestRuns || (2 * runs_ <= system_.width() && system_.width() > kGroup);
  }
  /// Takes a run that fits, and which outlives its part in the batch.
  void add(Engine& engine);
  /// Gives the runs back as they are, each at the end of a step.
  void release();
  /// Until a run ends; returns those that have, which are no part of the batch any longer.
  std::vector<Engine*> advance();

  /// Steps that were taken in lanes, of all runs.
  std::uint64_t steps() const { return steps_; }

  /// How many lanes are worth it: vectors of small scenes are taken several at a time.
  static std::size_t good_width(Engine& like);

 private:
  struct Lane {
    Engine* engine = nullptr;
    RunInLanes* run = nullptr;      ///< the engine's
    std::int64_t left = 0;          ///< steps until the run has something to do
    std::int64_t taken = 0;         ///< that the run does not know of
    std::uint64_t evaluations = 0;  ///< of those
    bool is_alone = false;          ///< it takes the next step by itself
    bool within_step = false;       ///< an attempt was refused
    unsigned attempted = 0;         ///< evaluations of this step
    DoubleDouble now;
    // Only adaptive steps use this.
    double next_time = 0.0;  ///< they end before this time
  };

  bool serve(std::size_t lane);
  bool bring_back(std::size_t lane);
  void put(std::size_t lane, RunContext& run);
  void take_blocks();
  std::int64_t take_steps();
  bool take_in_registers();
  void keep_start(std::size_t step);
  void keep_rates(std::size_t step);
  void show_steps(std::size_t lane, std::size_t count);
  void take_attempts();
  bool may_attempt(std::size_t lane);
  void follow_time();
  void fill_empty_lanes();

  Engine& like_;
  LaneSystem system_;
  std::unique_ptr<Integrator<double>> integrator_;  ///< of fixed steps
  LaneBlock lane_block_ = nullptr;                  ///< takes a block of them in registers
  // Single particles on a line: a block of steps, and the steps of one run.
  AlignedVector<double> row_memory_;
  LaneRows rows_;
  AlignedVector<double> shown_;
  bool watches_steps_ = false;  ///< one of the runs does
  std::unique_ptr<AdaptiveLanes> adaptive_;
  double dt_;
  std::vector<Lane> lanes_;
  std::size_t runs_ = 0;
  std::uint64_t steps_ = 0;
  bool all_filled_ = false;     ///< lanes without a run have numbers that stay finite
  AlignedVector<double> grid_;  ///< [lane] of the system: steps of the grid
  std::vector<double> most_;    ///< likewise: the longest step
  std::vector<AdaptiveLanes::Attempt> attempts_;
  RunState state_;  ///< of the fixed scheme's own numbers
};

}  // namespace tomlin
