#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/model/lane_system.hpp"
#include "framework/run/engine.hpp"

namespace tomlin {

/// Runs of one structure, scheme and step that take their plain steps together, in the lanes of
/// vectors. All else a run does by itself, on its own numbers: its start, edges of the window,
/// samples, the moving origin, a step that fails, its end. Results have the bits of single runs.
///
/// Lanes are at the same place between two anchors of the forces, kBlock steps apart, though not at
/// the same time. When a step fails, nothing of it is kept, and each run goes on by itself to its
/// next anchor: the one whose step it was fails there.
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
  static std::size_t good_width(const Engine& like);

 private:
  struct Lane {
    Engine* run = nullptr;
    std::int64_t left = 0;          ///< steps until the run has something to do
    std::int64_t taken = 0;         ///< that the run does not know of
    std::uint64_t evaluations = 0;  ///< of the system when it knew of all
    bool anchored = false;          ///< its parameters are those of its next step
    bool alone = false;             ///< a step has failed: it takes the next one by itself
  };

  bool serve(std::size_t lane);
  void take_blocks(std::int64_t steps);
  void follow_time();
  void fill_empty_lanes();

  Engine& like_;
  LaneSystem system_;
  std::unique_ptr<Integrator<double>> integrator_;
  double dt_;
  std::vector<Lane> lanes_;
  std::size_t runs_ = 0;
  bool all_filled_ = false;  ///< lanes without a run have numbers that stay sound
};

}  // namespace tomlin
