#include "framework/run/engine.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/quad.hpp"
#include "framework/run/bond_watch.hpp"
#include "framework/run/diagnose.hpp"
#include "framework/run/disturbance.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/run/number_type.hpp"
#include "framework/run/start_checks.hpp"
#include "framework/run/watched_integrals.hpp"

namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

constexpr std::uint64_t kBatch = 64 * kHousekeepingEvery;
constexpr std::chrono::milliseconds kReportEvery{200};
/// Coordinates: a second engine, which samples the energy balance, takes as much memory again.
constexpr std::size_t kMostForASecondEngine = 100'000;

}  // namespace

Engine::Engine(const std::shared_ptr<const Scene>& scene, const RunOptions& options) try
    : scene_(scene),
      options_(options),
      model_(scene_, options.instruction_set),
      scheme_(*scene_->run.integrator.record),
      observe_(model_.observe()) {
  const void* description = scene_->run.integrator.description.get();
  const SceneIntegrator& from = scene_->run.integrator;
  ledger_ = scene_->run.ledger;
  integrator_ = bound_by(from, "integrator", [&] {
    return integrator_in(scene_->run.number_type, model_, description, scheme_);
  });
  if (!scheme_.library.empty()) {
    integrator_ = guarded(std::move(integrator_), model_.system(), "integrator " + scheme_.name,
                          scheme_.library);
  }
  path_ = integrator_->path();
  list_signals();
  integrator_->watch(watched_integrals(model_), along_with_drivers(model_));
  list_watches();
  list_triggers();
  bind_observers();
  plan_ = plan_run(model_);
  from_.time = plan_.window_from;
  to_.time = plan_.window_to;

  if (options_.watches_energy && !ledger_ && path_ == nullptr &&
      model_.system().view.dofs <= kMostForASecondEngine) {
    balance_ = std::make_unique<EnergyBalance>(scene_, options_);
    balance_->start(plan_.period > 0.0 ? 0.0 : from_.time,
                    plan_.period > 0.0 ? plan_.duration : to_.time, plan_.dt);
  }

  StateLayout layout;
  declare(layout);
  state_ = RunState(layout, 1);
  if (!triggers_.empty()) before_ = state_;
  attach();

  const SystemView<double>& view = model_.system().view;
  dense_position_.assign(view.dofs + 2 * kGroup, 0.0);
  dense_velocity_.assign(view.dofs + 2 * kGroup, 0.0);
  dense_integrals_.assign(view.rates + 2 * kGroup, 0.0);
  dense_rates_.assign(view.rates + 2 * kGroup, 0.0);
  final_rates_.assign(view.rates + 2 * kGroup, 0.0);
  if (integrator_->has_point_block()) {
    block_rates_.assign(kHousekeepingEvery * view.rates, 0.0);
    block_velocities_.assign(kHousekeepingEvery, 0.0);
  }
  const bool wanted = options_.sink != nullptr && options_.sink->wants_samples();
  sampling_ = (wanted || !watchers_.empty()) && scene_->output.every.has_value();
  counts_[kRotationEvery] = 1;
  extremes_.start();
  static_forces_.start();
  for (DriverWatch& watch : driver_watches_) watch.start();
  for (BodyWatch& watch : body_watches_) watch.start();
  started_ = std::chrono::steady_clock::now();
  last_report_ = started_;
  last_checkpoint_ = started_;
  // Whoever keeps what the run leaves hears of a failure, too.
  if (!attempt([this] { begin(); }) && !sink_has_begun_) begin_sink();
} catch (const PluginError& error) {
  // Before the run has begun, of which something could be left.
  Fault fault;
  fault.place.file = scene->file;
  fault.why = error.what();
  throw InputError({std::move(fault)});
}

/// From the scene's start, or a checkpoint, to just before the first step.
void Engine::begin() {
  if (options_.perturbation) {
    const Perturbation& noise = *options_.perturbation;
    model_.start(&noise);
    if (path_ != nullptr) path_->disturb(noise.size, noise.seed, noise.stream);
    disturb_every_ = path_ != nullptr ? 0.0 : memory_of_disturbances(model_);
  } else {
    model_.start();
  }
  StartFindings findings = check_start(model_, plan_);
  stable_step_ = findings.stable_step;
  longest_unwatched_ = findings.longest_step;
  failure_ = std::move(findings.failure);
  std::move(findings.warnings.begin(), findings.warnings.end(), std::back_inserter(warnings_));
  model_.anchor(DoubleDouble(0.0));
  if (path_ != nullptr) settle();
  start_triggers();
  if (plan_.period > 0.0) start_until();
  begin_sink();
  if (failure_) return;
  find_wells();
  if (balance_) balance_->prepare();
  if (options_.resume_from) {
    resume(*options_.resume_from);
  } else {
    observe_start();
    note_tie();
    keep_checkpoint();
  }
}

void Engine::declare(StateLayout& layout) {
  const std::size_t bodies = model_.bodies().size();
  model_.declare(layout);
  integrator_->declare(layout);
  layout.add_reals("clock", 2);
  layout.add_integers("counts", kCounts);
  layout.add_reals("last_turns", bodies);
  layout.add_integers("turn_wraps", bodies);
  for (const char* edge : {"window.from", "window.to"}) {
    const std::string name = edge;
    layout.add_integers(name, 1);
    layout.add_reals(name + ".integrals", model_.system().view.rates);
    layout.add_reals(name + ".centre", 2 * bodies * model_.dimension());
    layout.add_reals(name + ".turns", bodies);
    layout.add_reals(name + ".stored", 1);
  }
  extremes_.declare(layout, signal_count_);
  static_forces_.declare(layout, drivers_.size());
  layout.add_integers("events.counts", kEventKinds);
  layout.add_integers("events.slips_within", 1);
  if (path_ != nullptr) {
    layout.add_reals("events.peaks", drivers_.size());
    layout.add_reals("events.tie", 2);
  }
  layout.add_reals("events.drivers", driver_watches_.size() * DriverWatch::kReals);
  layout.add_integers("events.drivers", driver_watches_.size() * DriverWatch::kIntegers);
  layout.add_reals("events.bodies", body_watches_.size() * BodyWatch::kReals);
  layout.add_integers("events.bodies", body_watches_.size() * BodyWatch::kIntegers);
  layout.add_integers("events.beyond", 2 * triggers_.size());
  if (plan_.period > 0.0) layout.add_reals("until", Steadiness::kNumbers);
  if (has_images(model_)) layout.add_integers("long_bonds", model_.forces().size());
  if (options_.perturbation) layout.add_reals("disturbed", 1);
  if (balance_) {
    layout.add_reals("energy_balance", EnergyBalance::reals());
    layout.add_integers("energy_balance", EnergyBalance::integers());
  }
  if (!watchers_.empty()) {
    layout.add_reals("observed.sums", 2 * observed_numbers());
    layout.add_integers("observed.count", 1);
  }
}

void Engine::attach() {
  // The integrator first: what it steps follows the model's origin.
  integrator_->attach(state_);
  model_.attach(state_);
  extremes_.attach(state_);
  static_forces_.attach(state_);
  clock_ = state_.reals("clock");
  counts_ = state_.integers("counts");
  last_turns_ = state_.reals("last_turns");
  turn_wraps_ = state_.integers("turn_wraps");
  event_counts_ = state_.integers("events.counts");
  slips_within_ = state_.integers("events.slips_within");
  if (path_ != nullptr) {
    peaks_ = state_.reals("events.peaks");
    tie_ = state_.reals("events.tie");
  }
  const auto attach_watches = [this](const char* field, auto& watches) {
    double* reals = state_.reals(field);
    std::int64_t* integers = state_.integers(field);
    for (auto& watch : watches) {
      watch.attach(std::exchange(reals, reals + watch.kReals),
                   std::exchange(integers, integers + watch.kIntegers));
    }
  };
  attach_watches("events.drivers", driver_watches_);
  attach_watches("events.bodies", body_watches_);
  std::int64_t* beyond = state_.integers("events.beyond");
  for (Trigger& trigger : triggers_) trigger.beyond = std::exchange(beyond, beyond + 2);
  if (plan_.period > 0.0) steadiness_.attach(state_.reals("until"));
  if (has_images(model_)) long_bonds_ = state_.integers("long_bonds");
  if (options_.perturbation) disturbed_ = state_.reals("disturbed");
  if (balance_) {
    balance_->attach(state_.reals("energy_balance"), state_.integers("energy_balance"));
  }
  if (!watchers_.empty()) {
    observed_sums_ = state_.reals("observed.sums");
    observed_count_ = state_.integers("observed.count");
  }
  for (Moment* moment : {&from_, &to_}) {
    const std::string name = moment == &from_ ? "window.from" : "window.to";
    moment->reached = state_.integers(name);
    moment->integrals = state_.reals(name + ".integrals");
    moment->centre = state_.reals(name + ".centre");
    moment->turns = state_.reals(name + ".turns");
    moment->stored = state_.reals(name + ".stored");
  }
}

void Engine::resume(const std::vector<std::byte>& numbers) {
  state_.from_bytes(numbers);
  attach();
  integrator_->rebased();  // nothing computed ahead is known here
  model_.system().evaluations = static_cast<std::uint64_t>(counts_[kEvaluations]);
  model_.system().columns = static_cast<std::uint64_t>(counts_[kColumns]);
  plain_left_ = 0;
  ended_ = interrupted_ = false;
  time_before_ = time();
  steps_before_ = steps();
  anchor_here();
  set_directions();
  if (plan_.period > 0.0) {
    // After the run's last period its window stays.
    const double last = std::nearbyint(plan_.duration / plan_.period) - 1.0;
    const double before = std::min(steadiness_.periods(), last);
    from_.time = before * plan_.period;
    to_.time = (before + 1.0) * plan_.period;
  }
}

/// Go on from where another engine is, of the same scene but for what is observed and kept of it.
/// Of running integrals, which it has others of, forces' own variables come first; the rest counts
/// from here on.
void Engine::take_up(RunState& other) {
  const auto copy = [](const auto& fields, const auto& from, auto numbers_of, auto own_part) {
    for (const StateLayout::Field& field : fields) {
      const auto same = std::find_if(from.begin(), from.end(), [&](const StateLayout::Field& one) {
        return one.name == field.name;
      });
      if (same == from.end()) continue;
      const auto [source, target] = numbers_of(field.name);
      if (field.name.find("integrals") == std::string::npos) {
        if (same->count == field.count) std::copy_n(source, field.count, target);
      } else if (!field.name.starts_with("window.")) {
        std::fill_n(target, field.count, std::decay_t<decltype(*target)>{});
        std::copy_n(source, own_part, target);
      }
    }
  };
  const std::size_t own = model_.system().view.own_count;
  const StateLayout& layout = state_.layout();
  copy(
      layout.reals(), other.layout().reals(),
      [&](const std::string& name) { return std::pair(other.reals(name), state_.reals(name)); },
      own);
  copy(
      layout.integers(), other.layout().integers(),
      [&](const std::string& name) {
        return std::pair(other.integers(name), state_.integers(name));
      },
      own);
  const std::size_t number = scene_->run.number_type == "float" ? sizeof(float) : sizeof(Quad);
  copy(
      layout.raw(), other.layout().raw(),
      [&](const std::string& name) {
        return std::pair(other.numbers<std::byte>(name), state_.numbers<std::byte>(name));
      },
      own * number);
  model_.attach(state_);
  integrator_->rebased();
  integrator_->forces_changed();
  plain_left_ = 0;
  ended_ = interrupted_ = false;
  anchor_here();
  set_directions();
}

/// Forces count their time from where a run at this point does, whatever came before.
void Engine::anchor_here() {
  if (plan_.dt == 0.0) {
    model_.anchor(now());
  } else {
    const std::int64_t anchor = counts_[kGridSteps] / kHousekeepingEvery * kHousekeepingEvery;
    model_.anchor(two_prod(static_cast<double>(anchor), plan_.dt));
  }
}

void Engine::fail(StepFault fault, double h) {
  if (failure_) return;  // the cause is known
  failure_ = diagnose(model_, scheme_, fault, static_cast<std::uint64_t>(counts_[kSteps]), now(), h,
                      stable_step_);
}

/// At the start of a step, or near it where a plugin throws between steps.
void Engine::fail(const PluginError& error) {
  if (!thrown_) thrown_ = error;
  if (failure_) return;
  RunFailure failure;
  failure.step = static_cast<std::uint64_t>(counts_[kSteps]);
  failure.time = time();
  constexpr std::string_view kForce = "force ";
  if (error.component().starts_with(kForce)) {
    failure.force = error.component().substr(kForce.size());
  }
  failure.what = error.what();
  failure.cause = "the code of the plugin";
  failure_ = std::move(failure);
}

/// What the functions of a plugin's records throw is not told apart by record.
void Engine::fail_by_record(const std::string& said) {
  std::vector<std::string> paths;
  for (const Library& library : scene_->libraries) paths.push_back(library.path);
  fail(PluginError("a function of a record", fmt::format("{}", fmt::join(paths, " or ")), said));
}

/// One step of the scheme; code of a plugin may be in it.
StepReport Engine::step_from(double since, double h, bool dense) {
  StepReport report{0.0, StepFault::not_finite_or_too_far};
  attempt([&] { report = integrator_->step_from(since, h, dense); });
  return report;
}

/// What was computed ahead is computed again by whoever goes on from these numbers.
void Engine::keep_checkpoint() {
  if (options_.sink == nullptr) return;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations) -
                          static_cast<std::int64_t>(integrator_->evaluations_ahead());
  counts_[kColumns] = static_cast<std::int64_t>(model_.system().columns);
  options_.sink->checkpoint(state_);
}

/// Where runs follow whose results this one's is compared with, it need not be repeated when those
/// are stopped. What a run until it is steady, and a path of equilibria, know at their end is not
/// all in the numbers: they go on from the checkpoint before.
void Engine::keep_end() {
  const bool more_follow = scene_->run.perturb || scene_->run.accuracy;
  if (options_.sink == nullptr || !more_follow || failed() || interrupted_) return;
  if (path_ != nullptr || plan_.period > 0.0) return;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  counts_[kColumns] = static_cast<std::int64_t>(model_.system().columns);
  options_.sink->checkpoint(state_);
}

/// One step with everything that may go with it: samples, edges of the window, looks at the origin.
/// Every step that is not plain takes this path, and any event would split a step here.
bool Engine::take(double since, double h, const DoubleDouble& end, bool to_grid, bool watched) {
  const DoubleDouble begin = now();
  const bool waits = watched && waiting();
  const double due = next_dense();
  // What falls on the end of a fixed step needs no interpolation.
  const bool dense = plan_.dt == 0.0 || waits || due < static_cast<double>(end);
  if (waits) before_.copy_numbers(state_);
  read_bodies(model_.system().view.position,
              plan_.dt == 0.0 ? model_.system().view.velocity : nullptr, readings_);
  signals_from_velocity(model_.system().view.velocity, static_cast<double>(begin));
  const StepReport report = step_from(since, h, dense);
  if (report.fault != StepFault::none) {
    fail(report.fault, h);
    return false;
  }
  if (!own_variables_are_finite()) {
    fail(StepFault::not_finite_or_too_far, h);
    return false;
  }
  const DoubleDouble arrived = plan_.dt == 0.0 && report.taken < h ? begin + report.taken : end;
  if (waits) {
    const double length = plan_.dt == 0.0 ? report.taken : h;
    if (const auto passed = first_passed(begin, length, since)) {
      return take_to(*passed, begin, length, since, arrived, to_grid);
    }
  }
  seen_ = arrived;
  signals_from_rates(integrator_->first_rates());
  if (path_ != nullptr) {
    look_along_path(static_cast<double>(begin), static_cast<double>(arrived));
  } else if (plan_.dt > 0.0 ||
             !look_between(static_cast<double>(begin), static_cast<double>(arrived))) {
    look(static_cast<double>(begin));
  }

  clock_[0] = arrived.hi;
  clock_[1] = arrived.lo;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  counts_[kColumns] = static_cast<std::int64_t>(model_.system().columns);
  ++counts_[kSteps];
  if (to_grid) ++counts_[kGridSteps];
  // Anchored afresh before any evaluation that belongs to the next step.
  double next_since = 0.0;
  if (plan_.dt == 0.0) {
    model_.anchor(arrived);
  } else {
    next_since = since_anchor();
  }
  if (due <= static_cast<double>(arrived)) serve_dense(due, begin, arrived, next_since);
  if (path_ != nullptr && path_->ends() && !slip()) return false;
  if (period_over_) end_period();
  if (housekeeping_due() || counts_[kRotationEvery] == 1) housekeeping();
  if (within_step_) interrupted_ = ended_ = true;
  return true;
}

/// Back to the start of the step, and to the event alone: what is left of a step of the grid is a
/// step of its own. An event at either end of a step splits nothing.
bool Engine::take_to(const Passed& passed, const DoubleDouble& begin, double length, double since,
                     const DoubleDouble& arrived, bool to_grid) {
  state_.copy_numbers(before_);
  model_.attach(state_);
  anchor_here();
  integrator_->rebased();
  const Trigger& trigger = triggers_[passed.trigger];
  if (passed.theta <= kNoStep) {
    fire(trigger);
    return true;
  }
  const bool split = passed.theta < 1.0 - kNoStep;
  const DoubleDouble end = split ? begin + passed.theta * length : arrived;
  const double part = split ? passed.theta * length : length;
  if (!take(since, part, end, to_grid && !split, false)) return false;
  // An adaptive scheme may have stopped before.
  if (static_cast<double>(now() - end) == 0.0) fire(trigger);
  return true;
}

/// Schemes watch the coordinates; forces' own variables and prescribed ways are watched here.
bool Engine::own_variables_are_finite() const {
  const SystemView<double>& view = model_.system().view;
  return std::all_of(view.integrals, view.integrals + view.own_count,
                     [](double x) { return std::isfinite(x); });
}

/// How far a step of the grid has been taken when an event has split it; 0 on the grid.
DoubleDouble Engine::into_step() const {
  return now() - two_prod(static_cast<double>(counts_[kGridSteps]), plan_.dt);
}

/// How far the next grid step starts after the anchor, which is set every few steps of the grid.
double Engine::since_anchor() {
  const std::int64_t since = counts_[kGridSteps] % kHousekeepingEvery;
  if (since == 0) model_.anchor(two_prod(static_cast<double>(counts_[kGridSteps]), plan_.dt));
  return static_cast<double>(since) * plan_.dt;
}

/// Of the grid: how many steps end before the next sample or edge of the window is due.
std::int64_t Engine::plain_steps() const {
  const double due = next_dense();
  std::int64_t plain = plan_.whole_steps - counts_[kGridSteps];
  if (!(due < plan_.duration)) return plain - 1;  // the last may end on a sample
  auto before = static_cast<std::int64_t>(due / plan_.dt) - counts_[kGridSteps];
  // Rounding of the quotient: the step that ends at or past the time is the one that is not plain.
  while (before > 0 && due <= static_cast<double>(counts_[kGridSteps] + before) * plan_.dt)
    --before;
  return std::min(plain - 1, before);
}

/// Times on the grid are products, not sums: step n ends at (n + 1) dt however many there were.
void Engine::step_fixed(std::uint64_t most) {
  if (counts_[kGridSteps] == plan_.whole_steps) {
    // What remains is shorter than a step, or nothing.
    const double rest = static_cast<double>(DoubleDouble(plan_.duration) - now());
    if (rest <= kNoStep * plan_.dt && (counts_[kSteps] > 0 || rest <= 0.0)) {
      ended_ = true;
    } else {
      take(since_anchor() + static_cast<double>(into_step()), rest, DoubleDouble(plan_.duration),
           false);
    }
    return;
  }
  const DoubleDouble into = into_step();
  if (static_cast<double>(into) != 0.0) {
    // An event has split this step of the grid: the rest of it.
    const DoubleDouble grid = two_prod(static_cast<double>(counts_[kGridSteps] + 1), plan_.dt);
    const bool at_end = std::abs(static_cast<double>(grid - plan_.duration)) <= kNoStep * plan_.dt;
    const DoubleDouble end = at_end ? DoubleDouble(plan_.duration) : grid;
    take(since_anchor() + static_cast<double>(into), static_cast<double>(end - now()), end, true);
    return;
  }
  if (waiting()) {
    plain_left_ = 0;
  } else if (plain_left_ == 0) {
    plain_left_ = std::max<std::int64_t>(0, plain_steps());
  }
  if (plain_left_ == 0 || counts_[kRotationEvery] == 1) {
    const DoubleDouble grid = two_prod(static_cast<double>(counts_[kGridSteps] + 1), plan_.dt);
    const bool at_end = std::abs(static_cast<double>(grid - plan_.duration)) <= kNoStep * plan_.dt;
    take(since_anchor(), plan_.dt, at_end ? DoubleDouble(plan_.duration) : grid, true);
    if (plain_left_ > 0) --plain_left_;
    return;
  }
  const std::int64_t to_anchor = kHousekeepingEvery - counts_[kGridSteps] % kHousekeepingEvery;
  plain_block(std::min({to_anchor, plain_left_, static_cast<std::int64_t>(most)}));
}

/// Steps of the grid with nothing to serve between them.
void Engine::plain_block(std::int64_t most) {
  const double since = since_anchor();
  const std::int64_t first = counts_[kGridSteps] % kHousekeepingEvery;
  std::int64_t taken = 0;
  StepFault fault = StepFault::none;
  if (integrator_->has_point_block()) {
    taken = static_cast<std::int64_t>(integrator_->point_block(
        static_cast<std::size_t>(first), plan_.dt, static_cast<std::size_t>(most),
        block_rates_.data(), block_velocities_.data()));
    if (taken < most) fault = StepFault::not_finite_or_too_far;
    const std::size_t rates = model_.system().view.rates;
    seen_ = two_prod(static_cast<double>(counts_[kGridSteps] + taken), plan_.dt);
    for (std::int64_t k = 0; k < taken; ++k) {
      signals_[drivers_.size()] = std::abs(block_velocities_[k]);
      signals_from_rates(block_rates_.data() + k * rates);
      look(static_cast<double>(counts_[kGridSteps] + k) * plan_.dt);
    }
  } else {
    double after = since;
    for (; taken < most; ++taken) {
      signals_from_velocity(model_.system().view.velocity,
                            static_cast<double>(counts_[kGridSteps] + taken) * plan_.dt);
      read_bodies(model_.system().view.position, nullptr, readings_);
      fault = step_from(after, plan_.dt, false).fault;
      if (fault == StepFault::none && !own_variables_are_finite()) {
        fault = StepFault::not_finite_or_too_far;
      }
      if (fault != StepFault::none) break;
      seen_ = two_prod(static_cast<double>(counts_[kGridSteps] + taken + 1), plan_.dt);
      signals_from_rates(integrator_->first_rates());
      look(static_cast<double>(counts_[kGridSteps] + taken) * plan_.dt);
      after = static_cast<double>(first + taken + 1) * plan_.dt;
    }
  }
  counts_[kGridSteps] += taken;
  counts_[kSteps] += taken;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  counts_[kColumns] = static_cast<std::int64_t>(model_.system().columns);
  plain_left_ -= taken;
  const DoubleDouble time = two_prod(static_cast<double>(counts_[kGridSteps]), plan_.dt);
  clock_[0] = time.hi;
  clock_[1] = time.lo;
  if (fault != StepFault::none) {
    fail(fault, plan_.dt);
    return;
  }
  if (!housekeeping_due()) return;
  // How far drivers have come counts for the origin: they are looked at where `take` leaves them.
  since_anchor();
  housekeeping();
}

/// Looked at every quarter of a million steps: a run of an adaptive scheme that will be out of
/// steps long before its end need not go on for hours.
bool Engine::foresees_too_many_steps() {
  constexpr std::int64_t kEvery = 1 << 18;
  constexpr double kSurely = 10.0;  // paces change
  const std::int64_t taken = counts_[kSteps];
  if (scheme_.most_steps == nullptr || taken == 0 || taken % kEvery != 0) return false;
  const auto most =
      static_cast<double>(scheme_.most_steps(scene_->run.integrator.description.get()));
  const double foreseen = static_cast<double>(taken) * (plan_.duration / time());
  if (foreseen <= kSurely * most) return false;
  fail(StepFault::too_many_steps, 0.0);
  failure_->what = fmt::format(
      "at its pace the run would take {:.2g} steps, and most_steps allows "
      "{:g}",
      foreseen, most);
  return true;
}

void Engine::step_adaptive() {
  const double rest = static_cast<double>(DoubleDouble(plan_.duration) - now());
  if (rest <= 0.0) {
    ended_ = true;
    return;
  }
  if (foresees_too_many_steps()) return;
  if (longest_unwatched_ < rest) {
    take(0.0, longest_unwatched_, now() + longest_unwatched_, false);
    return;
  }
  take(0.0, rest, DoubleDouble(plan_.duration), false);
}

bool Engine::too_dear() const {
  const System<double>& system = model_.system();
  return system.evaluations + system.columns > options_.most_cost;
}

void Engine::advance(std::uint64_t steps) {
  const auto target = static_cast<std::uint64_t>(counts_[kSteps]) + steps;
  while (!done() && static_cast<std::uint64_t>(counts_[kSteps]) < target) {
    std::uint64_t most = target - static_cast<std::uint64_t>(counts_[kSteps]);
    if (balance_) most = std::min(most, balance_->look(*this));
    if (plan_.dt > 0.0) {
      step_fixed(most);
    } else {
      step_adaptive();
      // Its steps may be few and dear.
      if (too_dear() && !done()) interrupted_ = ended_ = true;
    }
  }
}

/// Every few steps; of the grid where there is one, so that an event does not shift them.
bool Engine::housekeeping_due() const {
  if (plan_.dt == 0.0) return counts_[kSteps] % kHousekeepingEvery == 0;
  return counts_[kGridSteps] % kHousekeepingEvery == 0 && static_cast<double>(into_step()) == 0.0;
}

void Engine::housekeeping() {
  track_rotation();
  if (!housekeeping_due()) return;
  if (model_.rebase_if_due()) integrator_->rebased();
  if (disturb_every_ > 0.0 && time() >= *disturbed_ + disturb_every_) disturb();
  if (stopped()) {
    interrupted_ = ended_ = true;
    if (!within_step_) keep_checkpoint();
    return;
  }
  if (!options_.on_progress && options_.sink == nullptr) return;
  const auto moment = std::chrono::steady_clock::now();
  if (options_.on_progress && moment - last_report_ >= kReportEvery) {
    last_report_ = moment;
    const std::chrono::duration<double> elapsed = moment - started_;
    options_.on_progress(
        {time(), plan_.duration, steps(), elapsed.count(), time_before_, steps_before_});
  }
  const std::chrono::duration<double> since = moment - last_checkpoint_;
  if (since.count() >= scene_->run.checkpoint_every) {
    keep_checkpoint();
    last_checkpoint_ = std::chrono::steady_clock::now();
  }
}

/// At the present state, whose particles of rigid bodies are placed first.
void Engine::watch_bonds() {
  if (long_bonds_ == nullptr) return;
  const SystemView<double>& view = model_.system().view;
  model_.evaluate_at(now(), view.position, view.velocity, view.integrals, final_rates_.data());
  note_long_bonds(model_,
                  stage_of(view, static_cast<const double*>(view.position),
                           static_cast<const double*>(view.velocity),
                           static_cast<const double*>(view.integrals), final_rates_.data(), 0.0),
                  long_bonds_);
}

bool Engine::stopped() const {
  if (too_dear()) return true;
  return options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
}

RunResult Engine::run() {
  // Where batches end blocks of steps do, and some of what is watched is looked at there: at the
  // same steps whether the run began here or goes on from a checkpoint.
  attempt([this] {
    while (!done()) {
      advance(kBatch - steps() % kBatch);
      if (!interrupted_) watch_bonds();
    }
    if (balance_) balance_->look(*this);
  });
  keep_end();
  finish();
  return result();
}

}  // namespace tomlin
