#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "framework/model/model.hpp"
#include "framework/run/context.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

class RunInLanes;

/// One run: its parts, and the loop over its steps. Kept apart from run() so that tests and
/// benchmarks can take single steps.
class Engine {
 public:
  /// Binds the scene, and takes the model to its start or to a checkpoint. Throws InputError.
  Engine(const std::shared_ptr<const Scene>& scene, const RunOptions& options);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  RunResult run();
  /// Takes up to this many steps (fewer at the end of the run, or when one fails) with everything
  /// that a run does along the way: one part after the other makes the run that run() is.
  void advance(std::uint64_t steps);
  /// The result of a run whose steps have all been taken.
  RunResult end();
  /// Go on from the numbers of another engine of the same scene: state().to_bytes(). Throws
  /// std::invalid_argument when they are not.
  void resume(const std::vector<std::byte>& numbers);

  bool done() const;
  double time() const;
  std::uint64_t steps() const;
  Model& model();
  RunState& state();
  /// Scheme, plan, clock and outcome.
  RunContext& context();
  /// Layout of the data for a sink that wants samples.
  RunLayout layout() const;
  /// For a batch that takes steps of several runs together (lane_batch.hpp).
  RunInLanes& in_lanes();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tomlin
