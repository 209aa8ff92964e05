#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/run.hpp"
#include "framework/run/steps/run_plan.hpp"

namespace tomlin {

/// How far a run has come, in the run's state: time to the last digit, steps and cost.
class RunClock {
 public:
  static void declare(StateLayout& layout);
  void attach(RunState& state);

  DoubleDouble now() const { return {time_[0], time_[1]}; }
  double time() const { return time_[0] + time_[1]; }
  std::int64_t steps() const { return counts_[kSteps]; }
  /// Steps of the grid; a step that an event splits counts once it is over.
  std::int64_t grid_steps() const { return counts_[kGridSteps]; }
  std::uint64_t evaluations() const { return static_cast<std::uint64_t>(counts_[kEvaluations]); }
  std::uint64_t columns() const { return static_cast<std::uint64_t>(counts_[kColumns]); }

  void set(const DoubleDouble& time);
  void add(std::int64_t steps, std::int64_t grid_steps);
  /// Evaluations of all forces and columns of derivatives so far; `ahead` of them are lost where
  /// another run resumes from here, and made again.
  void keep_cost(const System<double>& system, std::uint64_t ahead = 0);

 private:
  enum { kSteps, kGridSteps, kEvaluations, kColumns, kCounts };
  double* time_ = nullptr;  ///< high and low part
  std::int64_t* counts_ = nullptr;
};

/// How a run has come out so far.
struct RunOutcome {
  bool ended = false;
  bool interrupted = false;
  std::optional<RunFailure> failure;
  std::optional<PluginError> thrown;  ///< what the code of a plugin has thrown
  std::vector<Warning> warnings;
  /// The energy balance of a complete run as sampled without a ledger, see energy_balance.hpp.
  std::optional<SampledWork> sampled_work;

  bool done() const { return ended || failure.has_value(); }
  /// All of it was run.
  bool complete() const { return !failure && !interrupted; }
  void interrupt() { interrupted = ended = true; }
  void warn(std::optional<Warning> warning) {
    if (warning) warnings.push_back(*std::move(warning));
  }
};

/// One run: what is run, and where it stands. All parts of the run share it.
struct RunContext {
  /// Binds the scene. Throws InputError.
  RunContext(const std::shared_ptr<const Scene>& scene_of_run, const RunOptions& options_of_run);

  /// Forces count their time from where a run at this point does, whatever came before.
  void anchor_here();
  /// How far the next step of the grid starts after the anchor, which is set every few steps.
  double since_anchor();
  /// How far a step of the grid has been taken when an event has split it; 0 on the grid.
  DoubleDouble into_step() const;
  /// The state at the start of a step that may be taken again, and back to it. Memory for it is
  /// made by may_go_back(), once the state is known.
  void may_go_back();
  void keep_state() { before_.copy_numbers(state); }
  void go_back();
  /// A block of kBlock steps is complete: what is looked at now and then is looked at here.
  bool block_ends() const;
  /// Evaluations and columns have come to more than is allowed.
  bool too_expensive() const;
  /// Or a signal has come.
  bool stopped() const;
  double tolerance() const;  ///< of an adaptive scheme; else 0

  /// Null where the steps of the scene are not taken in registers.
  PointBlocks<double>* point_blocks() const { return integrator->capabilities().point_blocks; }
  /// One step of the scheme; code of a plugin may be in it.
  StepReport step_from(double since, double h, bool dense);
  void fail(StepFault fault, double h);
  void fail(const PluginError& error);
  /// False where a plugin has thrown something, which ends the run as failed.
  template <class Action>
  bool attempt(Action action);
  /// The code of a plugin must leave the modes of rounding and of flushing to zero as they are.
  /// Changed modes are restored, and PluginError is thrown.
  void check_arithmetic() const;

  std::shared_ptr<const Scene> scene;
  RunOptions options;
  Model model;
  const IntegratorRecord& scheme;
  std::unique_ptr<Integrator<double>> integrator;
  EquilibriumPath* path = nullptr;  ///< of a quasistatic run
  RunPlan plan;
  double stable_step = 0.0;
  /// Longest step of an adaptive scheme, where it does not estimate the error itself.
  double longest_step = std::numeric_limits<double>::infinity();
  RunState state;
  RunClock clock;
  DoubleDouble seen;  ///< the time of the state while the last step is looked at
  RunOutcome outcome;

 private:
  RunState before_;
  bool uses_plugins_ = uses_plugins(*scene);
  OwnArithmetic::Mode arithmetic_ = OwnArithmetic::mode();
};

template <class Action>
bool RunContext::attempt(Action action) {
  try {
    action();
    check_arithmetic();
    return true;
  } catch (const PluginError& error) {
    fail(error);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (!uses_plugins_) throw;
    fail(thrown_by_plugins(*scene, error.what()));
  } catch (...) {
    if (!uses_plugins_) throw;
    fail(thrown_by_plugins(*scene, "an exception that is no std::exception"));
  }
  return false;
}

}  // namespace tomlin
