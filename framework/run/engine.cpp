#include "framework/run/engine.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "framework/model/stability.hpp"
#include "framework/run/events/triggers.hpp"
#include "framework/run/guard/energy_balance.hpp"
#include "framework/run/guard/start_checks.hpp"
#include "framework/run/housekeeping.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/results/observation.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/run/steps/run_in_lanes.hpp"
#include "framework/run/steps/stepping.hpp"
#include "framework/run/window/until_error.hpp"
#include "framework/run/window/until_steady.hpp"

namespace tomlin {
namespace {

/// Steps between looks at what is looked at now and then.
constexpr std::uint64_t kBatch = 64 * kBlock;

}  // namespace

/// Parts of which a run is made.
struct Engine::Parts final : RunInLanes {
  Parts(const std::shared_ptr<const Scene>& scene, const RunOptions& options);

  void declare_state();
  void attach();
  void begin();
  void check_observables();
  void resume(const std::vector<std::byte>& numbers);
  void go_on();
  void advance(std::uint64_t steps);
  void take_some(std::uint64_t limit);
  void look_if_needed();
  RunResult end();

  RunContext& context() override { return run; }
  std::string why_not() const override;
  std::int64_t steps_for_lanes() override;
  double next_time() const override { return observation.next_time(); }
  void step_alone() override;
  bool watches_steps() const override { return observation.watches(); }
  void watch(std::int64_t first, std::size_t count, const PointStarts<double>& starts) override;
  bool count_steps(std::int64_t steps, const DoubleDouble& time,
                   std::uint64_t evaluations) override;

  void read_rates();
  RunResult measured();
  void finish();
  void read_end();
  RunResult result();
  std::uint64_t taken() const { return static_cast<std::uint64_t>(run.clock.steps()); }

  RunContext run;
  Observation observation;
  Triggers triggers;
  Housekeeping housekeeping;
  UncontrolledIntegrals uncontrolled;
  std::optional<UntilSteady> until;
  std::optional<UntilError> until_error;
  std::unique_ptr<Stepping> stepping;
  std::optional<EnergyBalance> balance;  ///< none where nothing is sampled
  AlignedVector<double> rates;           ///< when last read: at the end
};

Engine::Parts::Parts(const std::shared_ptr<const Scene>& scene, const RunOptions& options) try
    : run(scene, options),
      observation(run),
      triggers(run, observation.rotations()),
      housekeeping(run, observation),
      uncontrolled(run) {
  RunPlan& plan = run.plan;
  plan = plan_run(run.model);
  observation.window().set(plan.window_from, plan.window_to);
  if (triggers.any()) observation.events().expect(EventKind::driver_reversal);
  if (plan.period > 0.0) until.emplace(run, observation.window());
  if (scene->run.until && !until) {
    until_error.emplace(run, observation);
    housekeeping.call_after_blocks([this] { until_error->look(); });
  }
  const SystemView<double>& view = run.model.system().view;
  if (options.watches_energy && !scene->run.ledger && run.path == nullptr) {
    balance.emplace(run, until ? 0.0 : plan.window_from, until ? plan.duration : plan.window_to);
  }
  if (uncontrolled.any()) observation.evaluate_forces_within_steps();
  declare_state();
  attach();
  rates.assign(view.rates + 2 * kGroup, 0.0);
  stepping = stepping_of({run, observation, triggers, housekeeping, uncontrolled,
                          balance ? &*balance : nullptr, [this] {
                            const bool more =
                                until && until->end_period([this] { return measured(); });
                            if (more) observation.next_window();
                            return more;
                          }});
  observation.start();
  // Whoever keeps what the run leaves hears of a failure, too.
  if (!run.attempt([this] { begin(); })) observation.samples().begin_sink();
} catch (const PluginError& error) {
  // Before the run has begun, of which something could be left.
  refuse_input(FaultCode::plugin_error, scene->file, "", error.what());
} catch (const InputError&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  if (!uses_plugins(*scene)) throw;
  refuse_input(FaultCode::plugin_error, scene->file, "",
               thrown_by_plugins(*scene, error.what()).what());
}

/// From the scene's start, or a checkpoint, to just before the first step.
void Engine::Parts::begin() {
  const std::optional<Perturbation>& noise = run.options.perturbation;
  run.model.start(noise ? &*noise : nullptr, run.options.start_from);
  if (noise && run.path != nullptr) run.path->disturb(noise->size, noise->seed, noise->stream);
  housekeeping.start();
  uncontrolled.start();
  StartFindings findings = check_start(run.model, run.plan, run.options.checks_step);
  run.stable_step = findings.stable_step;
  run.longest_step = findings.longest_step;
  run.outcome.failure = std::move(findings.failure);
  std::move(findings.warnings.begin(), findings.warnings.end(),
            std::back_inserter(run.outcome.warnings));
  run.model.anchor(DoubleDouble(0.0));
  if (run.path != nullptr) {
    // The start of a run is an equilibrium.
    const StepFault fault = run.path->settle(run.plan.duration);
    if (fault != StepFault::none) run.fail(fault, 0.0);
  }
  triggers.start();
  if (until) until->start([this] { return result(); });
  if (until_error) until_error->start(result());
  check_observables();
  observation.samples().begin_sink();
  if (run.outcome.failure) return;
  observation.placed();
  if (balance) balance->prepare();
  if (run.options.resume_from != nullptr) {
    resume(*run.options.resume_from);
  } else {
    observation.look_at_start();
    housekeeping.keep_checkpoint();
  }
}

/// Checks that the scene's observables exist; the caller has checked those of the options.
void Engine::Parts::check_observables() {
  const MeasureSettings& measure = run.scene->measure;
  if (measure.observables.empty() || !run.options.observables.empty()) return;
  const SourceLocation& location = measure.location_of("observables");
  const RunResult asked = result();
  for (const std::string& path : measure.observables) {
    try {
      observable(asked, path, location);
    } catch (const InputError&) {
      // The nearest name is one of all.
      auto without = std::make_shared<Scene>(*run.scene);
      without->measure.observables.clear();
      observable(Parts(without, options_to_bind()).result(), path, location);
      throw;
    }
  }
}

void Engine::Parts::declare_state() {
  StateLayout layout;
  run.model.declare(layout);
  run.integrator->declare(layout);
  RunClock::declare(layout);
  observation.declare(layout);
  triggers.declare(layout);
  housekeeping.declare(layout);
  uncontrolled.declare(layout);
  if (until) until->declare(layout);
  // Its checkpoints are of no use to a run from the scene's start.
  if (run.options.start_from != nullptr) layout.add_integers("started_elsewhere", 1);
  if (balance) balance->declare(layout);
  run.state = RunState(layout);
}

void Engine::Parts::attach() {
  RunState& state = run.state;
  // The integrator first: what it steps follows the model's origin.
  run.integrator->attach(state);
  run.model.attach(state);
  run.clock.attach(state);
  observation.attach(state);
  triggers.attach(state);
  housekeeping.attach(state);
  uncontrolled.attach(state);
  if (until) until->attach(state);
  if (balance) balance->attach(state);
}

void Engine::Parts::resume(const std::vector<std::byte>& numbers) {
  run.state.from_bytes(numbers);
  attach();
  System<double>& system = run.model.system();
  system.evaluations = run.clock.evaluations();
  system.columns = run.clock.columns();
  go_on();
  housekeeping.resumed();
  if (until) until->set_window();
}

/// From numbers that are new; nothing that was computed ahead belongs to them.
void Engine::Parts::go_on() {
  run.integrator->rebased();
  run.outcome.ended = run.outcome.interrupted = false;
  stepping->state_changed();
  run.anchor_here();
  observation.signals().set_directions();
}

void Engine::Parts::advance(std::uint64_t steps) {
  const std::uint64_t target = taken() + std::min(steps, ~taken());
  run.attempt([this, target] {
    while (!run.outcome.done() && taken() < target) take_some(target - taken());
  });
}

/// One step, or up to so many of a block.
void Engine::Parts::take_some(std::uint64_t limit) {
  const std::uint64_t before = taken();
  std::uint64_t most = std::min(limit, kBatch - before % kBatch);
  if (balance) most = std::min(most, static_cast<std::uint64_t>(balance->look()));
  stepping->advance(most);
  if (taken() != before || run.outcome.done()) look_if_needed();
}

RunResult Engine::Parts::end() {
  run.attempt([this] {
    if (balance) balance->look();
  });
  housekeeping.keep_end();
  finish();
  return result();
}

/// Up to where advance() would look at something.
std::int64_t Engine::Parts::steps_for_lanes() {
  if (run.outcome.done()) return 0;
  auto most = static_cast<std::int64_t>(kBatch - taken() % kBatch);
  if (balance) most = std::min(most, balance->idle_steps());
  if (run.plan.dt > 0.0) most = most / kBlock * kBlock;
  const std::int64_t steps = std::min(stepping->steps_for_lanes(), most);
  if (steps > 0) {
    // A batch evaluates the start of the next step itself.
    run.model.system().evaluations -= run.integrator->evaluations_ahead();
    run.integrator->rebased();
  }
  return steps;
}

bool Engine::Parts::count_steps(std::int64_t steps, const DoubleDouble& time,
                                std::uint64_t evaluations) {
  run.model.system().evaluations += evaluations;
  const std::uint64_t rebased = run.model.rebases();
  run.attempt([&] {
    stepping->count_steps(steps, time);
    look_if_needed();
  });
  return run.model.rebases() != rebased;
}

void Engine::Parts::step_alone() {
  run.attempt([this] { take_some(kBatch); });
}

void Engine::Parts::watch(std::int64_t first, std::size_t count,
                          const PointStarts<double>& starts) {
  run.seen = two_prod(static_cast<double>(first + static_cast<std::int64_t>(count)), run.plan.dt);
  observation.point_block(first, count, starts);
}

std::string Engine::Parts::why_not() const {
  std::string reason = why_not_in_lanes(run.model);
  if (!reason.empty()) return reason;
  if (uncontrolled.any()) return "forces on what does not move need a control of the step";
  if (run.options.perturbation) return "noise is added to it";
  if (until_error) return "until looks at an error after every block of steps";
  const bool sees_steps = !watches_steps() || run.point_blocks() != nullptr;
  if (observation.looks_within_steps() || !sees_steps) {
    return "an observable needs every step: extremes, events, heat or an observer of a plugin";
  }
  return "";
}

/// Some of what is watched is looked at after whole batches: at the same steps whether the run
/// began here or resumes from a checkpoint.
void Engine::Parts::look_if_needed() {
  if (run.outcome.interrupted) return;
  if (run.outcome.done() || taken() % kBatch == 0) observation.look_at_batch_end();
}

void Engine::Parts::read_rates() {
  const SystemView<double>& view = run.model.system().view;
  run.model.evaluate_at(run.clock.now(), view.position, view.velocity, view.integrals,
                        rates.data());
}

/// Reads the results at the end: the window may close there, and the final forces are read off. All
/// are unknown where a plugin throws once more.
void Engine::Parts::finish() {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::fill(rates.begin(), rates.end(), kNothing);
  if (!run.attempt([this] { read_end(); })) std::fill(rates.begin(), rates.end(), kNothing);
}

void Engine::Parts::read_end() {
  const bool complete = run.outcome.complete();
  if (complete) observation.close_window();
  read_rates();
  observation.stopped(rates.data());
  if (!complete) return;
  if (until) until->finish();
  if (until_error) until_error->finish();
  observation.finish(rates.data());
  if (!balance) return;
  run.outcome.sampled_work = balance->found();
  if (const auto& found = run.outcome.sampled_work) {
    run.outcome.warn(doubt_of_balance(*found, true, run));
  }
}

/// In the window that has just ended.
RunResult Engine::Parts::measured() {
  read_rates();
  return result();
}

RunResult Engine::Parts::result() {
  const RunOutcome& outcome = run.outcome;
  const MeasureWindow& window = observation.window();
  RunResult result;
  run.attempt([&] {
    const ErrorControl* const control = run.integrator->capabilities().error_control;
    if (control) result.refused_steps = control->refused_steps();
  });
  result.status = outcome.failure       ? RunStatus::failed
                  : outcome.interrupted ? RunStatus::interrupted
                                        : RunStatus::finished;
  result.failure = outcome.failure;
  result.end_time = run.clock.time();
  result.steps = taken();
  result.force_evaluations = run.model.system().evaluations;
  result.jacobian_columns = run.model.system().columns;
  if (until) result.steady = until->result();
  if (until_error) result.until_error = until_error->result();
  result.window_from = window.from().time;
  result.window_to = window.to().time;
  result.warnings = outcome.warnings;
  for (const Model::LeftOut& left : run.model.left_out()) {
    result.left_out.emplace_back(left.force, left.why);
  }
  result.wall_seconds = housekeeping.seconds();
  if (result.wall_seconds > 0.0) {
    result.steps_per_second = static_cast<double>(housekeeping.steps()) / result.wall_seconds;
  }
  result.instruction_set = run.options.instruction_set;
  if (run.options.team != nullptr) result.threads = run.options.team->members;
  observation.write_results(rates.data(), result);
  return result;
}

Engine::Engine(const std::shared_ptr<const Scene>& scene, const RunOptions& options)
    : parts_(std::make_unique<Parts>(scene, options)) {}
Engine::~Engine() = default;

RunResult Engine::run() {
  parts_->advance(std::numeric_limits<std::uint64_t>::max());
  return parts_->end();
}
void Engine::advance(std::uint64_t steps) { parts_->advance(steps); }
RunResult Engine::end() { return parts_->end(); }
void Engine::resume(const std::vector<std::byte>& numbers) { parts_->resume(numbers); }
bool Engine::done() const { return parts_->run.outcome.done(); }
double Engine::time() const { return parts_->run.clock.time(); }
std::uint64_t Engine::steps() const { return parts_->taken(); }
Model& Engine::model() { return parts_->run.model; }
RunState& Engine::state() { return parts_->run.state; }
RunContext& Engine::context() { return parts_->run; }
RunLayout Engine::layout() const { return parts_->observation.samples().layout(); }
RunInLanes& Engine::in_lanes() { return *parts_; }

}  // namespace tomlin
