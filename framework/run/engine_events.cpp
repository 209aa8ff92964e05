#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <boost/math/tools/toms748_solve.hpp>
#include <fmt/format.h>

#include "framework/run/engine.hpp"
#include "framework/run/observables.hpp"
#include "framework/run/time_scale.hpp"
#include "framework/run/wells.hpp"
#include "framework/scene/motion_slope.hpp"

/// What the run loop does about events: those that are told of, those that change a force, and the
/// end of a run that goes on until it is steady.
namespace tomlin {
namespace {

/// Unit roundoff of forces in each number type.
double precision_of(const std::string& number_type) {
  return number_type == "float" ? 1.2e-7 : 2.3e-16;
}

/// Halvings, at most, of a bracket of an event.
constexpr std::uintmax_t kMostTries = 100;

double cubic(double theta, double h, double y0, double slope0, double y1, double slope1) {
  const double rest = 1.0 - theta;
  const double change = y1 - y0;
  const double bend = rest * (h * slope0 - change) - theta * (h * slope1 - change);
  return y0 + theta * (change + rest * bend);
}

}  // namespace

/// Drivers whose spring tells what the pulled point does, round bodies, and bodies that turn.
void Engine::list_watches() {
  const double precision = precision_of(scene_->run.number_type);
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const Drive& drive = *drivers_[k].drive;
    if (!drags(*drivers_[k].drive) || !(drive.stiffness > 0.0)) continue;
    double period = 0.0;
    for (int d = 0; d < model_.dimension(); ++d) {
      if (drive.velocity[d] != 0.0) period = std::max(period, model_.origin().unit[d]);
    }
    driver_watches_.emplace_back(
        k, drive, period, precision,
        path_ == nullptr ? DriverWatch::Slips::looked_for : DriverWatch::Slips::told);
  }
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Model::Body& body = model_.bodies()[b];
    const BodySlot<double>& slot = body.bound.slot;
    if (!body.rotates() || (slot.mapped && !slot.rigid) || body.prescribed()) continue;
    body_watches_.emplace_back(b, body.rolling_radius);
  }
  readings_.resize(body_watches_.size());
  end_readings_ = between_readings_ = readings_;
  emit_ = [this](const Event& event) { record(event); };
  heat_ = [this] { return heat_so_far(); };
}

/// Of springs; what is prescribed is no force.
std::optional<std::size_t> Engine::body_pulled_by(std::size_t driver) const {
  for (const Model::Force& force : model_.forces()) {
    if (force.name == drivers_[driver].name) return force.bodies.front();
  }
  return {};
}

void Engine::find_wells() {
  if (path_ != nullptr) return;
  for (DriverWatch& watch : driver_watches_) {
    if (!watch.watches_slips()) continue;
    const auto body = body_pulled_by(watch.driver());
    if (!body) continue;
    const auto way =
        way_to_well(model_, *body, drivers_[watch.driver()], watch.period(), plan_.duration);
    if (way) watch.set_wells(*way);
  }
}

void Engine::list_triggers() {
  for (std::size_t f = 0; f < model_.forces().size(); ++f) {
    const Passing* passing = model_.forces()[f].bound->waits_for();
    if (passing == nullptr) continue;
    const SceneForce& force = scene_->forces.at(static_cast<std::size_t>(
        std::find_if(scene_->forces.begin(), scene_->forces.end(),
                     [&](const SceneForce& one) { return one.name == model_.forces()[f].name; }) -
        scene_->forces.begin()));
    const std::string key = "force." + force.name + ".reverse.when";
    triggers_.push_back(
        {f, Instant(model_, passing->when, key, force.place_of("reverse")), nullptr});
  }
  trigger_rates_.assign(model_.system().view.rates + 2 * kGroup, 0.0);
  trigger_turns_.assign(model_.bodies().size(), 0.0);
}

bool Engine::waiting() const {
  return std::any_of(triggers_.begin(), triggers_.end(), [this](const Trigger& trigger) {
    return model_.forces()[trigger.force].bound->waits();
  });
}

/// Sides are told apart: 0 above the upper value, 1 below the lower one.
double Engine::beyond(const Trigger& trigger, int side) const {
  const Passing& passing = *model_.forces()[trigger.force].bound->waits_for();
  const auto& value = side == 0 ? passing.above : passing.below;
  if (!value) return -1.0;
  const double by = trigger.instant.above(model_, instant_, *value);
  return side == 0 ? by : -by;
}

void Engine::read_triggers(const DoubleDouble& time, const double* position, const double* velocity,
                           const double* integrals) {
  instant_ = {time, position, velocity, trigger_rates_.data(), trigger_turns_.data()};
  bool rates = false;
  for (const Trigger& trigger : triggers_) {
    rates = rates || trigger.instant.needs_rates();
    if (!trigger.instant.needs_turns()) continue;
    const std::size_t body = trigger.instant.index();
    trigger_turns_[body] = turns_of(body, position);
  }
  if (rates) model_.evaluate_at(time, position, velocity, integrals, trigger_rates_.data());
}

/// What is beyond its value from the start has to come back before it can pass it.
void Engine::start_triggers() {
  if (triggers_.empty()) return;
  const SystemView<double>& view = model_.system().view;
  read_triggers(DoubleDouble(0.0), view.position, view.velocity, view.integrals);
  for (const Trigger& trigger : triggers_) {
    const Model::Force& force = model_.forces()[trigger.force];
    for (int side = 0; side < 2; ++side) {
      trigger.beyond[side] = beyond(trigger, side) > 0.0 ? 1 : 0;
      if (trigger.beyond[side] == 0) continue;
      warnings_.push_back(fmt::format(
          "force.{}.reverse: {} is {} its value at the start; the driver turns when it passes it",
          force.name, force.bound->waits_for()->when, side == 0 ? "above" : "below"));
    }
  }
}

/// The first event within the step that has just been taken.
std::optional<Engine::Passed> Engine::first_passed(const DoubleDouble& begin, double h,
                                                   double since) {
  const SystemView<double>& view = model_.system().view;
  const DoubleDouble end = begin + h;
  read_triggers(end, view.position, view.velocity, view.integrals);
  std::vector<std::pair<std::size_t, int>> candidates;
  for (std::size_t t = 0; t < triggers_.size(); ++t) {
    const Trigger& trigger = triggers_[t];
    if (!model_.forces()[trigger.force].bound->waits()) continue;
    for (int side = 0; side < 2; ++side) {
      const bool now_beyond = beyond(trigger, side) > 0.0;
      if (now_beyond && trigger.beyond[side] == 0) candidates.emplace_back(t, side);
      trigger.beyond[side] = now_beyond ? 1 : 0;
    }
  }
  if (candidates.empty()) return std::nullopt;
  integrator_->finish_dense_from(since + h);
  Passed first;
  for (const auto& [t, side] : candidates) {
    const auto above = [&, side = side, t = t](double theta) {
      integrator_->interpolate(theta, dense_position_.data(), dense_velocity_.data(),
                               dense_integrals_.data());
      read_triggers(begin + theta * h, dense_position_.data(), dense_velocity_.data(),
                    dense_integrals_.data());
      return beyond(triggers_[t], side);
    };
    double theta = 1.0;
    const double at_start = above(0.0);
    const double at_end = above(1.0);
    if (at_start < 0.0 && at_end > 0.0) {
      std::uintmax_t tries = kMostTries;
      const auto bracket = boost::math::tools::toms748_solve(
          above, 0.0, 1.0, at_start, at_end, boost::math::tools::eps_tolerance<double>(), tries);
      theta = 0.5 * (bracket.first + bracket.second);
    } else if (at_start >= 0.0) {
      theta = 0.0;
    }
    if (t == candidates.front().first || theta < first.theta) first = {t, theta};
  }
  return first;
}

/// The force changes here and now; the step that has come this far was taken with the old one.
void Engine::fire(const Trigger& trigger) {
  const Model::Force& force = model_.forces()[trigger.force];
  force.bound->passed(now());
  const SystemView<double>& view = model_.system().view;
  read_triggers(now(), view.position, view.velocity, view.integrals);
  // It has passed its value, whatever rounding says; it can again when it has come back.
  const Passing& passing = *force.bound->waits_for();
  const int side = !passing.below                                                ? 0
                   : !passing.above                                              ? 1
                   : std::abs(beyond(trigger, 0)) < std::abs(beyond(trigger, 1)) ? 0
                                                                                 : 1;
  trigger.beyond[side] = 1;
  anchor_here();
  set_directions();
  forget_pulls();
  integrator_->forces_changed();
  for (DriverWatch& watch : driver_watches_) {
    if (drivers_[watch.driver()].name == force.name) watch.turned();
  }
  Event event;
  event.kind = EventKind::driver_reversal;
  event.time = time();
  event.duration = event.size = event.energy_lost = event.peak_force =
      std::numeric_limits<double>::quiet_NaN();
  event_name_ = force.name;
  record(event);
}

void Engine::record(Event event) {
  event.name = event_name_;
  ++event_counts_[static_cast<std::size_t>(event.kind)];
  if (event.kind == EventKind::slip && event.time >= from_.time && event.time <= to_.time) {
    ++*slips_within_;
  }
  if (event.kind == EventKind::slip && static_forces_.any_open()) {
    for (const DriverWatch& watch : driver_watches_) {
      const std::size_t k = watch.driver();
      if (drivers_[k].name != event.name) continue;
      // Once a driver has turned back its force is along another direction.
      if (path_ == nullptr && along_[k] > 0.0) {
        static_forces_.settle(k, watch.highest_peak() / along_[k]);
      } else {
        static_forces_.settle(k);
      }
    }
  }
  if (options_.sink) options_.sink->event(event);
}

/// Of the whole scene, but for a constant: what was put in and is stored no more.
double Engine::heat_so_far() {
  const SystemView<double>& view = model_.system().view;
  double work = 0.0;
  for (const Model::Driver& driver : drivers_) {
    work += view.integrals[driver.first_rate + model_.dimension()];
    // The kinetic energy below is that of what is free.
    for (const Model::Body& body : model_.bodies()) {
      if (!body.prescribed() || body.bound.name != driver.name) continue;
      const auto apart = static_cast<std::size_t>(driver.first_rate) +
                         2 * static_cast<std::size_t>(model_.dimension()) + 1;
      if (accelerates(*body.motion) && view.inertial && path_ == nullptr) {
        work -= view.integrals[apart];
      }
    }
  }
  for (const Model::Force& force : model_.forces()) {
    // With the ledger: what an energy that changes with time puts in.
    if (force.traits.conservative && force.heat_rate != kNoRate) {
      work -= view.integrals[force.heat_rate];
    }
  }
  return work - model_.kinetic_energy(view.velocity) -
         model_.potential_energy(seen_, view.position, view.velocity, view.integrals);
}

/// Hardly ever is there a cell along y.
double Engine::height_of(double y) const {
  return model_.origin().cells[1] == 0 ? y : static_cast<double>(model_.placed(1, y));
}

/// Without velocities (null) heights and turns alone.
void Engine::read_bodies(const double* position, const double* velocity,
                         std::vector<Reading>& readings) {
  for (std::size_t k = 0; k < body_watches_.size(); ++k) {
    const std::size_t b = body_watches_[k].body();
    const BodySlot<double>& slot = model_.bodies()[b].bound.slot;
    Reading& reading = readings[k];
    if (slot.rigid) {
      reading.height = height_of(position[slot.centre + 1]);
      reading.turns = model_.rotation(b, position);
      if (velocity == nullptr) continue;
      reading.rise = velocity[slot.centre + 1];
      reading.spin = velocity[slot.centre + kRotation];
    } else if (body_watches_[k].watches_hops()) {
      double mean[3];
      observe_.mean(slot, position, 2, mean);
      reading.height = height_of(mean[1]);
      if (velocity == nullptr) continue;
      observe_.mean(slot, velocity, 2, mean);
      reading.rise = mean[1];
    }
  }
}

void Engine::interpolate_readings(double theta, double h) {
  for (std::size_t k = 0; k < body_watches_.size(); ++k) {
    const Reading& a = readings_[k];
    const Reading& b = end_readings_[k];
    between_readings_[k].height = cubic(theta, h, a.height, a.rise, b.height, b.rise);
    between_readings_[k].turns = cubic(theta, h, a.turns, a.spin, b.turns, b.spin);
  }
}

/// Drivers may have turned round.
void Engine::set_directions() {
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    const std::vector<double>& velocity = drivers_[k].drive->velocity;
    double along = 0.0;
    for (int d = 0; d < model_.dimension(); ++d)
      along += velocity[d] * direction_[k * model_.dimension() + d];
    along_[k] = (along < 0.0 ? -1.0 : 1.0) / speed_[k];
  }
}

/// Signals of one moment, for those who wait for something to happen.
void Engine::watch(double at, const double* signals, const std::vector<Reading>& readings) {
  for (DriverWatch& watch : driver_watches_) {
    const std::size_t driver = watch.driver();
    event_name_ = drivers_[driver].name;
    watch.add(at, pull_of(driver, signals) * along_[driver], emit_, heat_);
  }
  for (std::size_t k = 0; k < body_watches_.size(); ++k) {
    BodyWatch& watch = body_watches_[k];
    const Model::Body& body = model_.bodies()[watch.body()];
    event_name_ = body.bound.name;
    if (watch.watches_hops()) watch.add_height(at, readings[k].height, emit_);
    if (body.bound.slot.rigid) watch.add_turns(at, readings[k].turns, emit_);
  }
}

/// The end is one more moment. What is going on then counts as far as it got.
void Engine::finish_events() {
  const SystemView<double>& view = model_.system().view;
  note_slipping();
  seen_ = now();  // a run that resumes at its end has taken no step
  signals_from_rates(final_rates_.data());
  read_bodies(view.position, nullptr, readings_);
  watch(time(), signals_.data(), readings_);
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    if (before_slip_[k]) static_forces_.include(k, pull_of(k, signals_.data()));
  }
  for (DriverWatch& watch : driver_watches_) {
    event_name_ = drivers_[watch.driver()].name;
    watch.finish(time(), emit_);
  }
  for (BodyWatch& watch : body_watches_) {
    event_name_ = model_.bodies()[watch.body()].bound.name;
    watch.add_turns(time(), turns_of(watch.body(), view.position), emit_);
    watch.finish(time(), emit_);
  }
}

/// The observable must be one of the scene's.
void Engine::start_until() {
  const UntilSettings& until = *scene_->run.until;
  const auto place = until.places.find("steady");
  observable(result(), until.steady, place == until.places.end() ? until.place : place->second);
  const auto slowest = model_.slowest_time();
  slowest_time_ = slowest.value_or(0.0);
  for (const TimeDependence& change : time_dependences(model_)) {
    slowest_time_ = std::max(slowest_time_, slowest_cycle(change, plan_.duration));
  }
  model_.anchor(DoubleDouble(0.0));
  if (slowest) return;
  warnings_.push_back(
      fmt::format("run.until: the slowest internal time of so many coordinates is not known, only "
                  "how {} has changed so far",
                  until.steady));
}

/// The window has been one period of the driver: is the run steady, or what is the next one?
void Engine::end_period() {
  period_over_ = false;
  const SystemView<double>& view = model_.system().view;
  model_.evaluate_at(now(), view.position, view.velocity, view.integrals, final_rates_.data());
  const UntilSettings& until = *scene_->run.until;
  const double value = observable(result(), until.steady).value_or(0.0);
  steadiness_.add(value);
  const double ahead = plan_.duration / plan_.period - steadiness_.periods();
  if (const auto distance = steadiness_.distance(slowest_time_ / plan_.period, ahead)) {
    steadiness_.kept_distance() = value != 0.0 ? *distance / std::abs(value) : *distance;
    if (steadiness_.kept_distance() <= until.tolerance) {
      steadiness_.reach();
      ended_ = true;
      return;
    }
  }
  const double next = (steadiness_.periods() + 1.0) * plan_.period;
  if (next > plan_.duration * (1.0 + 1e-9)) return;  // the last period of the run
  from_.time = to_.time;
  to_.time = next;
  *to_.reached = 0;
  std::copy(to_.integrals, to_.integrals + model_.system().view.rates, from_.integrals);
  std::copy(to_.centre, to_.centre + 2 * model_.bodies().size() * model_.dimension(), from_.centre);
  std::copy(to_.turns, to_.turns + model_.bodies().size(), from_.turns);
  *from_.stored = *to_.stored;
  extremes_.start();
}

void Engine::warn_of_unsteadiness() {
  if (plan_.period == 0.0 || steadiness_.reached()) return;
  const UntilSettings& until = *scene_->run.until;
  const double least = Steadiness::least_periods(slowest_time_ / plan_.period);
  std::string why =
      fmt::format("it still changes by a part of {:.2g}", steadiness_.kept_distance());
  if (steadiness_.periods() < least) {
    why = fmt::format("that takes {:g} periods at least", least);
    if (least > static_cast<double>(Steadiness::kWindows)) {
      why += fmt::format(", since the slowest internal time of the scene is {:.3g}", slowest_time_);
    }
  }
  warnings_.push_back(fmt::format("{} is not steady to {:g} by time {:g}: {}", until.steady,
                                  until.tolerance, plan_.duration, why));
}

SteadyResult Engine::steady() const {
  SteadyResult result;
  result.path = scene_->run.until->steady;
  result.reached = steadiness_.reached();
  result.periods = static_cast<std::uint64_t>(steadiness_.periods());
  if (steadiness_.periods() >= Steadiness::least_periods(slowest_time_ / plan_.period)) {
    result.change = steadiness_.kept_distance();
  }
  return result;
}

}  // namespace tomlin
