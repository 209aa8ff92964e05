#include "framework/run/engine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/run/diagnose.hpp"
#include "framework/run/number_type.hpp"

namespace tomlin {
namespace {

constexpr double kTau = 6.283185307179586476925286766559;
/// A remainder of the run below this part of a step is no step.
constexpr double kNoStep = 1e-9;
/// Steps between looks at the origin, at rotations and at signals. A particle moves less than a
/// period in a step, so the origin is never left far behind.
constexpr std::int64_t kHousekeepingEvery = 16;
/// A flexible body that would turn more than this between such looks is looked at after every step.
constexpr double kMuchTurning = 0.05;
constexpr std::chrono::milliseconds kReportEvery{200};
constexpr std::uint64_t kSamplesBetweenLooks = 100'000;
/// How far past the end of the run a window may reach through rounding alone.
constexpr double kWindowSlack = 1e-9;

/// Tolerances that floats can keep: ten units in the last place.
constexpr double kFinestOfFloat = 1e-6;

/// Doubles count no further without gaps.
constexpr double kMostSteps = 9007199254740992.0;
/// A table of a hundred terabytes.
constexpr double kMostSamples = 1e12;

/// "position 8, clock 2, ...": numbers mean something only where the same fields are kept.
std::string fields_of(const StateLayout& layout) {
  std::string fields;
  for (const auto* group : {&layout.reals(), &layout.integers(), &layout.raw()}) {
    for (const StateLayout::Field& field : *group) {
      fields += fmt::format("{}{} {}", fields.empty() ? "" : ", ", field.name, field.count);
    }
  }
  return fields;
}

double norm(const std::vector<double>& v) {
  double squares = 0.0;
  for (const double x : v) squares = std::fma(x, x, squares);
  return std::sqrt(squares);
}

}  // namespace

Engine::Engine(std::shared_ptr<const Scene> scene, const RunOptions& options)
    : scene_(std::move(scene)),
      options_(options),
      model_(scene_, options.instruction_set),
      scheme_(*scene_->run.integrator.record),
      observe_(model_.observe()),
      duration_(scene_->run.duration) {
  const void* description = scene_->run.integrator.description.get();
  dt_ = scheme_.step(description);
  ledger_ = scene_->run.ledger;
  integrator_ = integrator_in(scene_->run.number_type, model_, description, scheme_);
  list_signals();
  list_watches();
  list_triggers();
  resolve_window();

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
  refuse_endless();
  if (dt_ > 0.0) {
    full_steps_ = static_cast<std::int64_t>(duration_ / dt_);
    const auto remains = [&](std::int64_t steps) {
      return static_cast<double>(DoubleDouble(duration_) -
                                 two_prod(static_cast<double>(steps), dt_));
    };
    while (remains(full_steps_) < -kNoStep * dt_) --full_steps_;
    while (remains(full_steps_ + 1) >= -kNoStep * dt_) ++full_steps_;
  }
  sampling_ = options_.sink != nullptr && scene_->output.every.has_value();
  counts_[kRotationEvery] = 1;
  extremes_.start();
  first_maximum_.start();
  for (DriverWatch& watch : driver_watches_) watch.start();
  for (BodyWatch& watch : body_watches_) watch.start();
  if (options_.perturbation) {
    model_.start(&*options_.perturbation);
  } else {
    model_.start();
  }
  started_ = std::chrono::steady_clock::now();
  last_report_ = started_;
  last_checkpoint_ = started_;
  warn_of_idle_velocities();
  warn_of_fine_tolerance();
  bound_unwatched_steps();
  check_step();
  model_.anchor(DoubleDouble(0.0));
  start_triggers();
  if (period_ > 0.0) start_until();
  if (options_.sink) begin_sink();
  if (failure_) return;
  if (options_.resume_from) {
    resume(*options_.resume_from);
  } else {
    observe_start();
    keep_checkpoint();
  }
}

/// Counts must stay exact, and a signal must get through between samples.
void Engine::refuse_endless() const {
  const auto place = [](const std::map<std::string, Place>& places, const char* key,
                        const Place& table) {
    const auto found = places.find(key);
    return found == places.end() ? table : found->second;
  };
  if (dt_ > 0.0 && !(duration_ / dt_ <= kMostSteps)) {
    throw InputError(
        {{place(scene_->run.integrator.places, "dt", scene_->run.place), "run.integrator.dt",
          fmt::format("{}", dt_), fmt::format("the run would take {:.3g} steps", duration_ / dt_),
          fmt::format("at most {:g} steps", kMostSteps), ""}});
  }
  if (scene_->output.every && !(duration_ / *scene_->output.every <= kMostSamples)) {
    throw InputError(
        {{place(scene_->output.places, "every", scene_->output.place), "output.every",
          fmt::format("{}", *scene_->output.every),
          fmt::format("the run would leave {:.3g} samples", duration_ / *scene_->output.every),
          fmt::format("at most {:g} samples", kMostSamples), ""}});
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
  first_maximum_.declare(layout, drivers_.size());
  layout.add_integers("events.counts", kEventKinds);
  layout.add_reals("events.drivers", driver_watches_.size() * DriverWatch::kReals);
  layout.add_integers("events.drivers", driver_watches_.size() * DriverWatch::kIntegers);
  layout.add_reals("events.bodies", body_watches_.size() * BodyWatch::kReals);
  layout.add_integers("events.bodies", body_watches_.size() * BodyWatch::kIntegers);
  layout.add_integers("events.beyond", 2 * triggers_.size());
  if (period_ > 0.0) layout.add_reals("until", kSteadyNumbers);
}

void Engine::attach() {
  // The integrator first: what it steps follows the model's origin.
  integrator_->attach(state_);
  model_.attach(state_);
  extremes_.attach(state_);
  first_maximum_.attach(state_);
  clock_ = state_.reals("clock");
  counts_ = state_.integers("counts");
  last_turns_ = state_.reals("last_turns");
  turn_wraps_ = state_.integers("turn_wraps");
  event_counts_ = state_.integers("events.counts");
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
  if (period_ > 0.0) steady_ = state_.reals("until");
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
  plain_left_ = 0;
  ended_ = interrupted_ = false;
  time_before_ = time();
  steps_before_ = steps();
  anchor_here();
  set_directions();
  if (period_ > 0.0) {
    // After the run's last period its window stays.
    const double last = std::nearbyint(duration_ / period_) - 1.0;
    const double before = std::min(steady_[kPeriods], last);
    from_.time = before * period_;
    to_.time = (before + 1.0) * period_;
  }
}

/// Forces count their time from where a run at this point does, whatever came before.
void Engine::anchor_here() {
  if (dt_ == 0.0) {
    model_.anchor(now());
  } else {
    const std::int64_t anchor = counts_[kGridSteps] / kHousekeepingEvery * kHousekeepingEvery;
    model_.anchor(two_prod(static_cast<double>(anchor), dt_));
  }
}

void Engine::list_signals() {
  for (const Model::Driver& driver : model_.drivers()) {
    drivers_.push_back(driver);
    const Drive* drive = driver.drive;
    drags_.push_back(drive != nullptr && drive->steady && norm(drive->velocity) > 0.0);
    direction_.insert(direction_.end(), drive->velocity.begin(), drive->velocity.end());
    speed_.push_back(norm(drive->velocity));
    along_.push_back(1.0 / speed_.back());
  }
  signal_count_ = drivers_.size() * model_.dimension() + model_.bodies().size();
  signals_.assign(signal_count_, 0.0);
  for (std::vector<double>& signals : between_) signals.assign(signal_count_, 0.0);
  pulls_.assign(drivers_.size(), 0.0);
}

void Engine::resolve_window() {
  const MeasureSettings& m = scene_->measure;
  double unit = 1.0;
  if (m.unit == MeasureSettings::Unit::driver_periods || scene_->run.until) {
    const auto fault = [&](const std::string& key, const std::string& why,
                           const std::string& admissible) {
      const auto found = m.places.find(key);
      throw InputError({{found == m.places.end() ? m.place : found->second, "measure." + key, "",
                         why, admissible, ""}});
    };
    std::vector<std::size_t> candidates;
    for (std::size_t k = 0; k < drivers_.size(); ++k) {
      if (drags_[k] && (m.driver.empty() || drivers_[k].name == m.driver)) {
        candidates.push_back(k);
      }
    }
    if (candidates.empty()) {
      fault(m.driver.empty() ? "in" : "driver", "there is no moving driver to count periods of",
            "\"time\", or the name of a driver with a velocity");
    }
    if (candidates.size() > 1) {
      fault("in", "several drivers move: say whose periods are meant", "driver = NAME");
    }
    const std::vector<double>& velocity = drivers_[candidates.front()].drive->velocity;
    if (m.period) {
      unit = *m.period / norm(velocity);
    } else {
      double period = 0.0;
      int along = -1;
      for (int d = 0; d < model_.dimension(); ++d) {
        if (velocity[d] == 0.0) continue;
        for (const SceneForce& force : scene_->forces) {
          const double declared = force.record->period(force.description.get(), d);
          if (declared <= 0.0) continue;
          if (period > 0.0 && declared != period) {
            fault("in", "the forces declare several periods: say which is meant",
                  "period = a length");
          }
          period = declared;
          along = d;
        }
      }
      if (along < 0) {
        fault("in", "no force declares a period along the driver's way", "period = a length");
      }
      unit = period / std::abs(velocity[along]);
    }
  }
  if (scene_->run.until) {
    period_ = unit;
    const double whole = std::floor(duration_ / period_ * (1.0 + kWindowSlack));
    if (whole < 1.0) {
      throw InputError({{scene_->run.until->place, "run.until", "",
                         fmt::format("the run ends at time {:g}, before the first period of the "
                                     "driver is over at {:g}",
                                     duration_, period_),
                         "a later max, or a longer duration", ""}});
    }
    duration_ = whole * period_;
    to_.time = period_;
    return;
  }
  from_.time = m.from * unit;
  to_.time = m.to ? *m.to * unit : duration_;
  if (to_.time > duration_ * (1.0 + kWindowSlack) || from_.time >= duration_) {
    const auto found = m.places.find(to_.time > duration_ ? "to" : "from");
    throw InputError(
        {{found == m.places.end() ? m.place : found->second,
          to_.time > duration_ ? "measure.to" : "measure.from", "",
          fmt::format("the window reaches to time {:g}, past the end of the run at {:g}",
                      std::max(to_.time, from_.time), duration_),
          "a window within the run, or a longer run.duration", ""}});
  }
  to_.time = std::min(to_.time, duration_);
}

/// Where nothing is free there is no error for an adaptive scheme to control, yet forces on what is
/// prescribed change along its way: parts of a period, or of the run where there is none.
void Engine::bound_unwatched_steps() {
  const SystemView<double>& view = model_.system().view;
  if (dt_ > 0.0 || view.coordinates > 0 || view.own_count > 0) return;
  constexpr double kPartOfPeriod = 0.02;
  constexpr double kPartOfRun = 1e-3;
  longest_unwatched_ = kPartOfRun * duration_;
  double period = std::numeric_limits<double>::infinity();
  for (int d = 0; d < model_.dimension(); ++d) {
    if (model_.origin().unit[d] > 0.0) period = std::min(period, model_.origin().unit[d]);
  }
  for (const Model::Body& body : model_.bodies()) {
    if (!body.prescribed()) continue;
    double reach = 0.0;
    for (const auto& arm : body.arms) reach = std::max(reach, norm(arm));
    double speed = reach * std::abs(body.motion->angular_velocity.constant);
    for (const TimeFunction& function : body.motion->velocity) {
      speed += std::abs(function.constant);
    }
    if (!(speed > 0.0)) continue;
    const double scale = std::isfinite(period) ? period : std::max(reach, speed * duration_);
    longest_unwatched_ = std::min(longest_unwatched_, kPartOfPeriod * scale / speed);
  }
}

/// An adaptive scheme that is asked for more digits than its numbers have.
void Engine::warn_of_fine_tolerance() {
  if (scheme_.tolerance == nullptr || scene_->run.number_type != "float") return;
  const double asked = scheme_.tolerance(scene_->run.integrator.description.get());
  if (asked >= kFinestOfFloat) return;
  warnings_.push_back(fmt::format(
      "floats carry no tolerance of {:g}: below about {:g} steps follow their rounding and get "
      "very short",
      asked, kFinestOfFloat));
}

/// Without inertia velocities follow from forces, whatever the scene says of them at the start.
void Engine::warn_of_idle_velocities() {
  if (model_.system().view.inertial) return;
  for (const SceneBody& body : scene_->bodies) {
    const PerParticleVector& given = body.record->common(body.description.get()).velocity;
    const bool any = std::any_of(given.values.begin(), given.values.end(), [](const auto& vector) {
      return std::any_of(vector.components.begin(), vector.components.end(),
                         [](double v) { return v != 0.0; });
    });
    if (!any) continue;
    warnings_.push_back(
        fmt::format("body.{}.velocity means nothing without inertia: velocities follow from forces",
                    body.name));
  }
}

/// A step beyond the stability limit is refused before it is taken.
void Engine::check_step() {
  if (dt_ == 0.0) return;
  stable_step_ = model_.stable_step(scheme_);
  const double longest = std::min(dt_, duration_);
  if (longest <= stable_step_ * (1.0 + kNoStep)) return;
  if (scene_->run.allow_unstable) {
    warnings_.push_back(fmt::format("dt = {:g} is beyond the stability limit of {}, about {:.4g}",
                                    dt_, scheme_.name, stable_step_));
    return;
  }
  fail(StepFault::not_finite_or_too_far, dt_);
  failure_->what = fmt::format("dt = {:g} is beyond the stability limit of {}, about {:.4g}", dt_,
                               scheme_.name, stable_step_);
  failure_->force = model_.stiffest_force();
  failure_->cause =
      "the stiffest force allows no longer step; take a smaller dt, or insist with "
      "run.allow_unstable = true";
}

void Engine::fail(StepFault fault, double h) {
  failure_ = diagnose(model_, scheme_, fault, static_cast<std::uint64_t>(counts_[kSteps]), now(), h,
                      stable_step_);
}

/// Columns of the table, and whose positions come with them.
void Engine::begin_sink() {
  RunLayout layout;
  layout.dimension = model_.dimension();
  layout.box = scene_->box.lengths;
  layout.periodic = scene_->box.periodic;
  layout.events = !driver_watches_.empty() || !body_watches_.empty() || !triggers_.empty();
  layout.state = fields_of(state_.layout());
  if (sampling_) {
    static const char* const axes[] = {"x", "y", "z"};
    std::vector<SampleColumn>& columns = layout.columns;
    const auto per_axis = [&](const std::string& name, const char* unit) {
      for (int d = 0; d < model_.dimension(); ++d) columns.push_back({name + "." + axes[d], unit});
    };
    columns.push_back({"time", "time"});
    for (const auto& driver : drivers_) per_axis(driver.name + ".force", "force");
    for (const auto& driver : drivers_) {
      if (driver.drive->steady) per_axis(driver.name + ".position", "length");
    }
    for (const Model::Body& body : model_.bodies()) {
      per_axis(body.bound.name + ".centre_of_mass", "length");
      per_axis(body.bound.name + ".velocity", "length/time");
      if (body.rotates()) columns.push_back({body.bound.name + ".rotation", "rad"});
    }
    if (scene_->output.trajectory) {
      for (const Model::Body& body : model_.bodies()) {
        layout.bodies.push_back({body.bound.name, body.bound.mass});
      }
    }
  }
  sample_values_.assign(layout.row(), 0.0);
  options_.sink->begin(layout);
}

void Engine::observe_start() {
  const SystemView<double>& view = model_.system().view;
  if (sampling_) {
    sample(0.0, view.position, view.velocity, view.integrals);
    counts_[kNextSample] = 1;
  }
  if (from_.time == 0.0) {
    keep_moment(from_, 0.0, view.position, view.velocity, view.integrals);
  }
}

/// What was computed ahead is computed again by whoever goes on from these numbers.
void Engine::keep_checkpoint() {
  if (options_.sink == nullptr) return;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations) -
                          static_cast<std::int64_t>(integrator_->evaluations_ahead());
  options_.sink->checkpoint(state_);
}

double Engine::next_dense() const {
  double next = std::numeric_limits<double>::infinity();
  if (sampling_) {
    const double at = static_cast<double>(counts_[kNextSample]) * *scene_->output.every;
    // The last sample may miss the end of the run by rounding.
    next = std::abs(at - duration_) <= kNoStep * *scene_->output.every ? duration_ : at;
  }
  if (*from_.reached == 0) return std::min(next, from_.time);
  return *to_.reached != 0 ? next : std::min(next, to_.time);
}

/// One step with everything that may go with it: samples, edges of the window, looks at the origin.
/// Every step that is not plain takes this path, and any event would split a step here.
bool Engine::take(double since, double h, const DoubleDouble& end, bool to_grid, bool watched) {
  const DoubleDouble begin = now();
  const bool waits = watched && waiting();
  const double due = next_dense();
  // What falls on the end of a fixed step needs no interpolation.
  const bool dense = dt_ == 0.0 || waits || due < static_cast<double>(end);
  if (waits) before_.copy_numbers(state_);
  read_bodies(model_.system().view.position, dt_ == 0.0 ? model_.system().view.velocity : nullptr,
              readings_);
  signals_from_velocity(model_.system().view.velocity, static_cast<double>(begin));
  const StepReport report = integrator_->step_from(since, h, dense);
  if (report.fault != StepFault::none) {
    fail(report.fault, h);
    return false;
  }
  if (!own_variables_are_finite()) {
    fail(StepFault::not_finite_or_too_far, h);
    return false;
  }
  const DoubleDouble arrived = dt_ == 0.0 && report.taken < h ? begin + report.taken : end;
  if (waits) {
    const double length = dt_ == 0.0 ? report.taken : h;
    if (const auto passed = first_passed(begin, length, since)) {
      return take_to(*passed, begin, length, since, arrived, to_grid);
    }
  }
  seen_ = arrived;
  signals_from_rates(integrator_->first_rates());
  if (dt_ > 0.0 || !look_between(static_cast<double>(begin), static_cast<double>(arrived))) {
    look(static_cast<double>(begin));
  }

  clock_[0] = arrived.hi;
  clock_[1] = arrived.lo;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  ++counts_[kSteps];
  if (to_grid) ++counts_[kGridSteps];
  // Anchored afresh before any evaluation that belongs to the next step.
  double next_since = 0.0;
  if (dt_ == 0.0) {
    model_.anchor(arrived);
  } else {
    next_since = since_anchor();
  }
  if (due <= static_cast<double>(arrived)) serve_dense(due, begin, arrived, next_since);
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
  return now() - two_prod(static_cast<double>(counts_[kGridSteps]), dt_);
}

/// How far the next grid step starts after the anchor, which is set every few steps of the grid.
double Engine::since_anchor() {
  const std::int64_t since = counts_[kGridSteps] % kHousekeepingEvery;
  if (since == 0) model_.anchor(two_prod(static_cast<double>(counts_[kGridSteps]), dt_));
  return static_cast<double>(since) * dt_;
}

/// Of the grid: how many steps end before the next sample or edge of the window is due.
std::int64_t Engine::plain_steps() const {
  const double due = next_dense();
  std::int64_t plain = full_steps_ - counts_[kGridSteps];
  if (!(due < duration_)) return plain - 1;  // the last may end on a sample
  auto before = static_cast<std::int64_t>(due / dt_) - counts_[kGridSteps];
  // Rounding of the quotient: the step that ends at or past the time is the one that is not plain.
  while (before > 0 && due <= static_cast<double>(counts_[kGridSteps] + before) * dt_) --before;
  return std::min(plain - 1, before);
}

/// Times on the grid are products, not sums: step n ends at (n + 1) dt however many there were.
void Engine::step_fixed(std::uint64_t most) {
  if (counts_[kGridSteps] == full_steps_) {
    // What remains is shorter than a step, or nothing.
    const double rest = static_cast<double>(DoubleDouble(duration_) - now());
    if (rest <= kNoStep * dt_ && (counts_[kSteps] > 0 || rest <= 0.0)) {
      ended_ = true;
    } else {
      take(since_anchor() + static_cast<double>(into_step()), rest, DoubleDouble(duration_), false);
    }
    return;
  }
  const DoubleDouble into = into_step();
  if (static_cast<double>(into) != 0.0) {
    // An event has split this step of the grid: the rest of it.
    const DoubleDouble grid = two_prod(static_cast<double>(counts_[kGridSteps] + 1), dt_);
    const bool at_end = std::abs(static_cast<double>(grid - duration_)) <= kNoStep * dt_;
    const DoubleDouble end = at_end ? DoubleDouble(duration_) : grid;
    take(since_anchor() + static_cast<double>(into), static_cast<double>(end - now()), end, true);
    return;
  }
  if (waiting()) {
    plain_left_ = 0;
  } else if (plain_left_ == 0) {
    plain_left_ = std::max<std::int64_t>(0, plain_steps());
  }
  if (plain_left_ == 0 || counts_[kRotationEvery] == 1) {
    const DoubleDouble grid = two_prod(static_cast<double>(counts_[kGridSteps] + 1), dt_);
    const bool at_end = std::abs(static_cast<double>(grid - duration_)) <= kNoStep * dt_;
    take(since_anchor(), dt_, at_end ? DoubleDouble(duration_) : grid, true);
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
        static_cast<std::size_t>(first), dt_, static_cast<std::size_t>(most), block_rates_.data(),
        block_velocities_.data()));
    if (taken < most) fault = StepFault::not_finite_or_too_far;
    const std::size_t rates = model_.system().view.rates;
    seen_ = two_prod(static_cast<double>(counts_[kGridSteps] + taken), dt_);
    for (std::int64_t k = 0; k < taken; ++k) {
      signals_[drivers_.size()] = std::abs(block_velocities_[k]);
      signals_from_rates(block_rates_.data() + k * rates);
      look(static_cast<double>(counts_[kGridSteps] + k) * dt_);
    }
  } else {
    double after = since;
    for (; taken < most; ++taken) {
      signals_from_velocity(model_.system().view.velocity,
                            static_cast<double>(counts_[kGridSteps] + taken) * dt_);
      read_bodies(model_.system().view.position, nullptr, readings_);
      fault = integrator_->step_from(after, dt_, false).fault;
      if (fault == StepFault::none && !own_variables_are_finite()) {
        fault = StepFault::not_finite_or_too_far;
      }
      if (fault != StepFault::none) break;
      seen_ = two_prod(static_cast<double>(counts_[kGridSteps] + taken + 1), dt_);
      signals_from_rates(integrator_->first_rates());
      look(static_cast<double>(counts_[kGridSteps] + taken) * dt_);
      after = static_cast<double>(first + taken + 1) * dt_;
    }
  }
  counts_[kGridSteps] += taken;
  counts_[kSteps] += taken;
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  plain_left_ -= taken;
  const DoubleDouble time = two_prod(static_cast<double>(counts_[kGridSteps]), dt_);
  clock_[0] = time.hi;
  clock_[1] = time.lo;
  if (fault != StepFault::none) {
    fail(fault, dt_);
    return;
  }
  if (!housekeeping_due()) return;
  // How far drivers have come counts for the origin: they are looked at where `take` leaves them.
  since_anchor();
  housekeeping();
}

/// Long steps hide extremes: those of the cubic through the dense output at thirds of the step are
/// as good as the dense output. signals_ holds the values at its start. False: no dense rates.
bool Engine::look_between(double from, double to) {
  between_[0] = signals_;
  for (int k = 1; k <= 3; ++k) {
    if (!integrator_->between(k / 3.0, dense_velocity_.data(), dense_rates_.data())) return false;
    signals_from_rates(dense_rates_.data());
    signals_from_velocity(dense_velocity_.data(), from + (to - from) * k / 3.0);
    between_[k] = signals_;
  }
  if (!body_watches_.empty()) {
    read_bodies(model_.system().view.position, model_.system().view.velocity, end_readings_);
  }
  for (int k = 0; k < 3; ++k) {
    interpolate_readings(k / 3.0, to - from);
    watch(from + (to - from) * k / 3.0, between_[k].data(), between_readings_);
  }
  // Of a step across an edge of the window only what lies within counts.
  const auto inside = [&](double theta) {
    const double at = from + (to - from) * theta;
    return at >= from_.time && at <= to_.time;
  };
  if (to > from_.time && from < to_.time) {
    for (const int k : {0, 3}) {
      if (inside(k / 3.0)) extremes_.include(between_[k].data());
    }
    for (std::size_t s = 0; s < signal_count_; ++s) {
      const CubicExtremes found =
          cubic_extremes(between_[0][s], between_[1][s], between_[2][s], between_[3][s]);
      for (int e = 0; e < found.count; ++e) {
        if (inside(found.place[e])) extremes_.include(s, found.value[e]);
      }
    }
  }
  if (!first_maximum_.searching()) return true;
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const CubicExtremes found =
        cubic_extremes(pull_of(k, between_[0].data()), pull_of(k, between_[1].data()),
                       pull_of(k, between_[2].data()), pull_of(k, between_[3].data()));
    for (int e = 0; e < found.count; ++e) {
      if (found.is_maximum[e]) first_maximum_.settle(k, found.value[e]);
    }
  }
  return true;
}

/// Extremes see the values at the start of a step.
void Engine::look(double at) {
  watch(at, signals_.data(), readings_);
  extremes_.add(at, signals_.data(), at >= from_.time && at <= to_.time);
  if (!first_maximum_.searching()) return;
  for (std::size_t k = 0; k < drivers_.size(); ++k) pulls_[k] = pull_of(k, signals_.data());
  first_maximum_.add(at, pulls_.data());
}

void Engine::step_adaptive() {
  const double rest = static_cast<double>(DoubleDouble(duration_) - now());
  if (rest <= 0.0) {
    ended_ = true;
    return;
  }
  if (longest_unwatched_ < rest) {
    take(0.0, longest_unwatched_, now() + longest_unwatched_, false);
    return;
  }
  take(0.0, rest, DoubleDouble(duration_), false);
}

void Engine::advance(std::uint64_t steps) {
  const auto target = static_cast<std::uint64_t>(counts_[kSteps]) + steps;
  while (!done() && static_cast<std::uint64_t>(counts_[kSteps]) < target) {
    if (dt_ > 0.0) {
      step_fixed(target - static_cast<std::uint64_t>(counts_[kSteps]));
    } else {
      step_adaptive();
    }
  }
}

/// Driver forces.
void Engine::signals_from_rates(const double* rates) {
  const int axes = model_.dimension();
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const double* force = rates + drivers_[k].first_rate;
    for (int d = 0; d < axes; ++d) signals_[k * axes + d] = force[d];
  }
}

/// Speeds of centres.
void Engine::signals_from_velocity(const double* velocity, double at) {
  const int axes = model_.dimension();
  double* speed = signals_.data() + drivers_.size() * axes;
  for (const Model::Body& body : model_.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    double v[3] = {0.0, 0.0, 0.0};
    if (slot.rigid) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.centre + d];
    } else if (body.prescribed()) {
      for (int d = 0; d < axes; ++d) v[d] = body.motion->velocity[d](at);
    } else if (slot.count == 1 && !slot.mapped) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.offset + d * slot.stride];
    } else if (!slot.mapped) {
      observe_.mean(slot, velocity, axes, v);
    }
    double square = 0.0;
    for (int d = 0; d < axes; ++d) square += v[d] * v[d];
    *speed++ = std::sqrt(square);
  }
}

void Engine::serve_dense(double due, const DoubleDouble& from, const DoubleDouble& to,
                         double next_since) {
  // The end of the step itself needs no interpolation, and so no evaluation.
  if (due < static_cast<double>(to)) integrator_->finish_dense_from(next_since);
  const double length = static_cast<double>(to - from);
  std::uint64_t served = 0;
  for (double at = due; at <= static_cast<double>(to); at = next_dense()) {
    // A signal gets through between samples of a very long step, which is then left unfinished.
    if (++served % kSamplesBetweenLooks == 0 && stopped()) {
      within_step_ = true;
      return;
    }
    if (dt_ > 0.0 && at == static_cast<double>(to)) {
      const SystemView<double>& view = model_.system().view;
      serve_point(at, view.position, view.velocity, view.integrals);
      continue;
    }
    const double theta =
        std::clamp(static_cast<double>(DoubleDouble(at) - from) / length, 0.0, 1.0);
    integrator_->interpolate(theta, dense_position_.data(), dense_velocity_.data(),
                             dense_integrals_.data());
    serve_point(at, dense_position_.data(), dense_velocity_.data(), dense_integrals_.data());
  }
}

void Engine::serve_point(double at, const double* x, const double* v, const double* z) {
  if (*from_.reached == 0 && at >= from_.time) keep_moment(from_, at, x, v, z);
  if (*from_.reached != 0 && *to_.reached == 0 && at >= to_.time) {
    keep_moment(to_, at, x, v, z);
    period_over_ = period_ > 0.0;
  }
  if (sampling_ &&
      static_cast<double>(counts_[kNextSample]) * *scene_->output.every <= at * (1.0 + kNoStep)) {
    sample(at, x, v, z);
    ++counts_[kNextSample];
  }
}

void Engine::sample(double at, const double* position, const double* velocity,
                    const double* integrals) {
  model_.evaluate_at(DoubleDouble(at), position, velocity, integrals, dense_rates_.data());
  std::size_t column = 0;
  const int axes = model_.dimension();
  sample_values_[column++] = at;
  for (const auto& driver : drivers_) {
    for (int d = 0; d < axes; ++d) sample_values_[column++] = dense_rates_[driver.first_rate + d];
  }
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    if (!drivers_[k].drive->steady) continue;
    for (int d = 0; d < axes; ++d) {
      sample_values_[column++] = static_cast<double>(model_.pulled_end(k, DoubleDouble(at), d));
    }
  }
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    double numbers[3];
    model_.centre(b, position, numbers);
    for (int d = 0; d < axes; ++d) {
      sample_values_[column++] = static_cast<double>(model_.placed(d, numbers[d]));
    }
    model_.centre_velocity(b, velocity, numbers);
    for (int d = 0; d < axes; ++d) sample_values_[column++] = numbers[d];
    if (model_.bodies()[b].rotates()) sample_values_[column++] = kTau * turns_of(b, position);
  }
  if (scene_->output.trajectory) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      column = model_.place_particles(b, position, sample_values_.data() + column) -
               sample_values_.data();
    }
  }
  options_.sink->sample(sample_values_);
}

void Engine::keep_moment(Moment& moment, double at, const double* position, const double* velocity,
                         const double* integrals) {
  *moment.reached = 1;
  model_.evaluate_at(DoubleDouble(at), position, velocity, integrals, dense_rates_.data());
  std::copy(integrals, integrals + model_.system().view.rates, moment.integrals);
  const int axes = model_.dimension();
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    double centre[3];
    model_.centre(b, position, centre);
    for (int d = 0; d < axes; ++d) {
      const DoubleDouble place = model_.placed(d, centre[d]);
      moment.centre[2 * (b * axes + d)] = place.hi;
      moment.centre[2 * (b * axes + d) + 1] = place.lo;
    }
    moment.turns[b] = turns_of(b, position);
  }
  if (ledger_) {
    *moment.stored = model_.kinetic_energy(velocity) +
                     model_.potential_energy(DoubleDouble(at), position, velocity, integrals);
  }
  // The signals of the step's start have been used; this is scratch until the next.
  signals_from_rates(dense_rates_.data());
  signals_from_velocity(velocity, at);
  extremes_.include(signals_.data());
}

double Engine::turns_of(std::size_t b, const double* position) const {
  const double turns = model_.rotation(b, position);
  const Model::Body& body = model_.bodies()[b];
  if (body.bound.slot.mapped || !body.rotates()) return turns;
  const double unwrapped = turns + static_cast<double>(turn_wraps_[b]);
  return unwrapped - std::nearbyint(unwrapped - last_turns_[b]);
}

/// Flexible bodies have no rotation coordinate: whole turns are counted by looking often enough.
void Engine::track_rotation() {
  const std::int64_t looked = counts_[kRotationEvery];
  counts_[kRotationEvery] = kHousekeepingEvery;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Model::Body& body = model_.bodies()[b];
    if (body.bound.slot.mapped || !body.rotates()) continue;
    const double turns = model_.rotation(b, model_.system().view.position);
    const double change = turns + static_cast<double>(turn_wraps_[b]) - last_turns_[b];
    const double wraps = std::nearbyint(change);
    turn_wraps_[b] -= static_cast<std::int64_t>(wraps);
    last_turns_[b] = turns + static_cast<double>(turn_wraps_[b]);
    for (BodyWatch& watch : body_watches_) {
      if (watch.body() != b) continue;
      event_name_ = body.bound.name;
      watch.add_turns(time(), last_turns_[b], emit_);
    }
    const double a_step = std::abs(change - wraps) / static_cast<double>(looked);
    if (a_step * kHousekeepingEvery > kMuchTurning) counts_[kRotationEvery] = 1;
  }
}

/// Every few steps; of the grid where there is one, so that an event does not shift them.
bool Engine::housekeeping_due() const {
  if (dt_ == 0.0) return counts_[kSteps] % kHousekeepingEvery == 0;
  return counts_[kGridSteps] % kHousekeepingEvery == 0 && static_cast<double>(into_step()) == 0.0;
}

void Engine::housekeeping() {
  track_rotation();
  if (!housekeeping_due()) return;
  if (model_.rebase_if_due()) integrator_->rebased();
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
        {time(), duration_, steps(), elapsed.count(), time_before_, steps_before_});
  }
  const std::chrono::duration<double> since = moment - last_checkpoint_;
  if (since.count() >= scene_->run.checkpoint_every) {
    keep_checkpoint();
    last_checkpoint_ = std::chrono::steady_clock::now();
  }
}

bool Engine::stopped() const {
  return options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
}

RunResult Engine::run() {
  while (!done()) advance(1024);
  finish();
  return result();
}

/// What is known at the end: the window may close there, and the final forces are read off.
void Engine::finish() {
  const SystemView<double>& view = model_.system().view;
  if (!failure_ && !interrupted_ && *from_.reached != 0 && *to_.reached == 0) {
    keep_moment(to_, to_.time, view.position, view.velocity, view.integrals);
  }
  model_.evaluate_at(now(), view.position, view.velocity, view.integrals, final_rates_.data());
  if (!failure_ && !interrupted_) {
    finish_events();
    warn_of_unsteadiness();
  }
  if (!ledger_) return;
  kinetic_energy_ = model_.kinetic_energy(view.velocity);
  potential_energy_ = model_.potential_energy(now(), view.position, view.velocity, view.integrals);
}

/// Over the window, each term from its own integral; what does not balance is the integrator's.
EnergyResult Engine::energy(bool window) const {
  EnergyResult energy;
  energy.kinetic = kinetic_energy_;
  energy.potential = potential_energy_;
  if (!window) return energy;
  const auto over_window = [&](std::ptrdiff_t rate) {
    return to_.integrals[rate] - from_.integrals[rate];
  };
  double work = 0.0;
  for (const Model::Driver& driver : drivers_) {
    work += over_window(driver.first_rate + model_.dimension());
  }
  double heat = 0.0;
  for (const Model::Force& force : model_.forces()) {
    if (force.heat_rate != kNoRate) heat += over_window(force.heat_rate);
  }
  if (model_.friction_rate() != kNoRate) heat += over_window(model_.friction_rate());
  energy.work_in = work;
  energy.heat_out = heat;
  energy.stored_change = *to_.stored - *from_.stored;
  energy.numerical_work = *energy.stored_change + heat - work;
  return energy;
}

RunResult Engine::result() {
  RunResult result;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started_;
  result.status = failure_       ? RunStatus::failed
                  : interrupted_ ? RunStatus::interrupted
                                 : RunStatus::finished;
  result.failure = failure_;
  result.end_time = time();
  result.steps = static_cast<std::uint64_t>(counts_[kSteps]);
  result.refused_steps = integrator_->refused_steps();
  result.force_evaluations = model_.system().evaluations;
  result.events = event_counts();
  if (period_ > 0.0) result.steady = steady();
  result.window_from = from_.time;
  result.window_to = to_.time;
  result.warnings = warnings_;
  for (const Model::LeftOut& left : model_.left_out()) {
    result.left_out.emplace_back(left.force, left.why);
  }
  result.wall_seconds = elapsed.count();
  if (elapsed.count() > 0.0) {
    result.steps_per_second = static_cast<double>(result.steps - steps_before_) / elapsed.count();
  }
  result.instruction_set = options_.instruction_set;

  const int axes = model_.dimension();
  const bool window = *from_.reached != 0 && *to_.reached != 0;
  const double length = to_.time - from_.time;
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const Model::Driver& from = drivers_[k];
    DriverResult driver;
    driver.name = from.name;
    for (int d = 0; d < axes; ++d) {
      const std::size_t rate = from.first_rate + d;
      driver.final_force.push_back(final_rates_[rate]);
      if (!window) continue;
      driver.mean_force.push_back((to_.integrals[rate] - from_.integrals[rate]) / length);
      driver.max_force.push_back(extremes_.high(k * axes + d));
      driver.min_force.push_back(extremes_.low(k * axes + d));
    }
    const double speed = norm(from.drive->velocity);
    if (drags_[k] && first_maximum_.found(k)) driver.static_force = first_maximum_.value(k) / speed;
    if (window) {
      const std::size_t power = from.first_rate + axes;
      driver.work = to_.integrals[power] - from_.integrals[power];
      if (from.drive->steady) driver.distance = speed * length;
      if (from.drive->steady && speed > 0.0)
        driver.work_per_distance = *driver.work / *driver.distance;
    }
    result.drivers.push_back(std::move(driver));
  }
  if (ledger_) result.energy = energy(window);
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Model::Body& from = model_.bodies()[b];
    const SystemView<double>& view = model_.system().view;
    BodyResult body;
    body.name = from.bound.name;
    double numbers[3];
    model_.centre(b, view.position, numbers);
    for (int d = 0; d < axes; ++d) {
      body.centre_of_mass.push_back(static_cast<double>(model_.placed(d, numbers[d])));
    }
    model_.centre_velocity(b, view.velocity, numbers);
    body.velocity.assign(numbers, numbers + axes);
    if (from.rotates()) body.rotation = kTau * turns_of(b, view.position);
    if (window) {
      for (int d = 0; d < axes; ++d) {
        const DoubleDouble moved = to_.place(b * axes + d) - from_.place(b * axes + d);
        body.mean_velocity.push_back(static_cast<double>(moved) / length);
      }
      body.max_speed = extremes_.high(drivers_.size() * axes + b);
      if (from.rotates()) {
        body.turns = to_.turns[b] - from_.turns[b];
        const double moved = static_cast<double>(to_.place(b * axes) - from_.place(b * axes));
        if (from.rolling_radius > 0.0 && moved != 0.0) {
          body.rolling = from.rolling_radius * kTau * (0.0 - *body.turns) / moved;
        }
      }
    }
    result.bodies.push_back(std::move(body));
  }
  return result;
}

}  // namespace tomlin
