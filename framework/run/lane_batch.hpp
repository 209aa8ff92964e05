#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/model/lane_system.hpp"
#include "framework/run/engine.hpp"

namespace tomlin {

/// Runs of one structure and scheme that take their plain steps together, in the lanes of vectors.
/// All else a run does by itself, on its own numbers: its start, edges of the window, samples, the
/// moving origin, a step that fails, its end. Results have the bits of single runs.
///
/// Fixed steps, of the same length in all lanes, are at the same place between two anchors of the
/// forces, kBlock steps apart, though not at the same time. When one fails, nothing of it is kept,
/// and each run goes on by itself to its next anchor: the one whose step it was fails there.
/// Adaptive steps are anchored each at its start; an attempt is refused or accepted by each lane.
class LaneBatch {
 public:
  /// Of runs like this one, which is no part of it and outlives it; at most so many at a time.
  LaneBatch(Engine& like, std::size_t most);

  bool fits(Engine& run) const;
  bool is_full() const { return runs_ == lanes_.size(); }
  bool is_empty() const { return runs_ == 0; }
  /// Takes a run that fits, and which outlives its part in the batch.
  void add(Engine& run);
  /// Until a run ends; returns those that have, which are no part of the batch any longer.
  std::vector<Engine*> advance();

  /// How many lanes are worth it: vectors of small scenes are taken several at a time.
  static std::size_t good_width(Engine& like);

 private:
  struct Lane {
    Engine* run = nullptr;
    std::int64_t left = 0;          ///< steps until the run has something to do
    std::int64_t taken = 0;         ///< that the run does not know of
    std::uint64_t evaluations = 0;  ///< of those
    bool is_anchored = false;       ///< its parameters are those of its next step
    bool is_alone = false;          ///< it takes the next step by itself
    bool within_step = false;       ///< an attempt was refused
    unsigned attempted = 0;         ///< evaluations of this step
    DoubleDouble now;
    // Of adaptive steps.
    double due = 0.0;   ///< they end before this time
    double idle = 0.0;  ///< and begin before this one
  };

  bool serve(std::size_t lane);
  void put(std::size_t lane, Engine& run);
  void take_blocks();
  void take_attempts();
  bool may_attempt(std::size_t lane);
  void follow_time(std::size_t lane);
  void fill_empty_lanes();

  Engine& like_;
  LaneSystem system_;
  std::unique_ptr<Integrator<double>> integrator_;  ///< of fixed steps
  std::unique_ptr<AdaptiveLanes> adaptive_;
  double dt_;
  std::vector<Lane> lanes_;
  std::size_t runs_ = 0;
  bool all_filled_ = false;   ///< lanes without a run have numbers that stay sound
  std::vector<double> most_;  ///< [lane] of the system: the longest step
  std::vector<AdaptiveLanes::Attempt> attempts_;
  RunState state_;  ///< of the fixed scheme's own numbers
};

}  // namespace tomlin
