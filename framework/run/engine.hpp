#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/run/guard/energy_balance.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

struct RunContext;

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

  RunContext& context();
  Model& model();
  RunState& state();
  Integrator<double>& integrator();
  /// The stability limit of the scheme's step, at the current state.
  double stable_step() const;
  /// The energy balance as sampled without a ledger, after run(); see energy_balance.hpp.
  std::optional<SampledWork> sampled_work() const;
  /// Layout of the data for a sink that wants samples.
  RunLayout layout() const;
  /// Final state of a run that has finished, for another to start from.
  FinalState final_state();
  /// The exception that the code of a plugin has thrown, if any.
  const std::optional<PluginError>& thrown() const;

  /// Go on from the numbers of another engine of the same scene: state().to_bytes(). Throws
  /// std::invalid_argument when they are not.
  void resume(const std::vector<std::byte>& numbers);

  /// Take up to this many steps (fewer at the end of the run, or when one fails) with everything
  /// that a run does along the way. For benchmarks and tests.
  void advance(std::uint64_t steps);
  /// For a batch that takes steps of several runs together (lane_batch.hpp): how many there are
  /// before this run has to do anything itself, in whole blocks of kBlock; 0: step_alone().
  std::int64_t steps_for_lanes();
  /// Counts steps that a batch has taken up to a time, with so many evaluations; the state is
  /// the one after. True where the origin has moved, and with it the state.
  bool count_steps(std::int64_t steps, const DoubleDouble& time, std::uint64_t evaluations);
  /// Steps have to be shown to watch() before count_steps(), those of a block together, from the
  /// first of them on: of a single particle on a line.
  bool watches_steps() const;
  void watch(std::int64_t first, std::size_t count, const PointStarts<double>& starts);
  /// An adaptive step that would end at this time or later is taken by the run itself, outside of
  /// the batch.
  double next_time() const;
  /// Why the run takes all its steps by itself; empty: it may be in a batch.
  std::string why_not_in_lanes() const;
  /// One step, or what is left of a block, up to so many steps: one after the other they make the
  /// run that run() is.
  void step_alone(std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
  /// The result of a run whose steps have all been taken.
  RunResult end();
  bool done() const;
  bool failed() const;
  double time() const;
  std::uint64_t steps() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tomlin
