#include "framework/run/context.hpp"

#include <atomic>
#include <utility>

#include <fmt/format.h>

#include "framework/run/guard/diagnose.hpp"
#include "framework/run/guard/watched_integrals.hpp"
#include "framework/run/steps/integrator_in_type.hpp"

namespace tomlin {

void RunClock::declare(StateLayout& layout) {
  layout.add_reals("clock", 2);
  layout.add_integers("counts", kCounts);
}

void RunClock::attach(RunState& state) {
  time_ = state.reals("clock");
  counts_ = state.integers("counts");
}

void RunClock::set(const DoubleDouble& time) {
  time_[0] = time.hi;
  time_[1] = time.lo;
}

void RunClock::add(std::int64_t steps, std::int64_t grid_steps) {
  counts_[kSteps] += steps;
  counts_[kGridSteps] += grid_steps;
}

void RunClock::keep_cost(const System<double>& system, std::uint64_t ahead) {
  counts_[kEvaluations] = static_cast<std::int64_t>(system.evaluations - ahead);
  counts_[kColumns] = static_cast<std::int64_t>(system.columns);
}

RunContext::RunContext(const std::shared_ptr<const Scene>& scene_of_run,
                       const RunOptions& options_of_run)
    : scene(scene_of_run),
      options(options_of_run),
      model(scene, options.instruction_set, options.team),
      scheme(*scene->run.integrator.record) {
  const SceneIntegrator& from = scene->run.integrator;
  integrator = bound_by(from, "integrator", [&] {
    return integrator_in(scene->run.number_type, model, from.description.get(), scheme);
  });
  const Capabilities<double> capabilities = integrator->capabilities();
  path = capabilities.path;
  if (ErrorControl* const control = capabilities.error_control) {
    control->watch(watched_integrals(model), along_with_drivers(model));
  }
}

void RunContext::anchor_here() {
  if (plan.dt == 0.0) {
    model.anchor(clock.now());
  } else {
    const std::int64_t anchor = clock.grid_steps() / kBlock * kBlock;
    model.anchor(two_prod(static_cast<double>(anchor), plan.dt));
  }
}

double RunContext::since_anchor() {
  const std::int64_t since = clock.grid_steps() % kBlock;
  if (since == 0) model.anchor(two_prod(static_cast<double>(clock.grid_steps()), plan.dt));
  return static_cast<double>(since) * plan.dt;
}

void RunContext::may_go_back() {
  if (before_.empty()) before_ = state;
}

void RunContext::go_back() {
  state.copy_numbers(before_);
  model.attach(state);
  anchor_here();
  integrator->rebased();
}

DoubleDouble RunContext::into_step() const {
  return clock.now() - two_prod(static_cast<double>(clock.grid_steps()), plan.dt);
}

/// Blocks are those of the grid where there is one, so that an event does not shift them.
bool RunContext::block_ends() const {
  if (plan.dt == 0.0) return clock.steps() % kBlock == 0;
  return clock.grid_steps() % kBlock == 0 && static_cast<double>(into_step()) == 0.0;
}

bool RunContext::too_expensive() const {
  const System<double>& system = model.system();
  return system.evaluations + system.columns > options.most_cost;
}

bool RunContext::stopped() const {
  if (too_expensive()) return true;
  return options.stop != nullptr && options.stop->load(std::memory_order_relaxed);
}

double RunContext::tolerance() const {
  return scheme.tolerance ? scheme.tolerance(scene->run.integrator.description.get()) : 0.0;
}

StepReport RunContext::step_from(double since, double h, bool dense) {
  StepReport report{0.0, StepFault::not_finite_or_too_far};
  attempt([&] { report = integrator->step_from(since, h, dense); });
  return report;
}

void RunContext::fail(StepFault fault, double h) {
  if (outcome.failure) return;  // the cause is known
  outcome.failure = diagnose(model, scheme, fault, static_cast<std::uint64_t>(clock.steps()),
                             clock.now(), h, stable_step);
}

/// At the start of a step, or near it where a plugin throws between steps.
void RunContext::fail(const PluginError& error) {
  const OwnArithmetic restored(arithmetic_);
  if (!outcome.thrown) outcome.thrown = error;
  if (outcome.failure) return;
  RunFailure failure;
  failure.code = FaultCode::plugin_error;
  failure.step = static_cast<std::uint64_t>(clock.steps());
  failure.time = clock.time();
  constexpr std::string_view kForce = "force ";
  if (error.component().starts_with(kForce) &&
      error.component().find(" or ") == std::string::npos) {
    failure.force = error.component().substr(kForce.size());
  }
  failure.what = error.what();
  failure.cause = "the code of the plugin";
  outcome.failure = std::move(failure);
}

void RunContext::check_arithmetic() const {
  if (!uses_plugins_ || OwnArithmetic::mode() == arithmetic_) return;
  { const OwnArithmetic restored(arithmetic_); }
  throw thrown_by_plugins(*scene, "it has changed the mode of floating-point arithmetic");
}

}  // namespace tomlin
