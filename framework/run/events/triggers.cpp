#include "framework/run/events/triggers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/math/tools/toms748_solve.hpp>
#include <fmt/format.h>

#include "framework/scene/passing.hpp"

namespace tomlin {
namespace {

/// Halvings, at most, of a bracket of an event.
constexpr std::uintmax_t kMostTries = 100;

}  // namespace

Triggers::Triggers(RunContext& run, const Rotations& rotations) : run_(run), rotations_(rotations) {
  const Model& model = run.model;
  const std::vector<SceneForce>& scene_forces = run.scene->forces;
  for (std::size_t f = 0; f < model.forces().size(); ++f) {
    const Model::Force& bound = model.forces()[f];
    const Passing* passing = bound.control->waits_for();
    if (passing == nullptr) continue;
    const auto force = std::find_if(scene_forces.begin(), scene_forces.end(),
                                    [&](const SceneForce& one) { return one.name == bound.name; });
    const std::string key = "force." + force->name + ".reverse.when";
    triggers_.push_back(
        {f, Instant(model, passing->when, key, force->location_of("reverse")), nullptr});
  }
  if (!any()) return;
  stochastic_ = has_noise(*run.scene);
  const SystemView<double>& view = model.system().view;
  rates_.assign(view.rates + 2 * kGroup, 0.0);
  turns_.assign(model.bodies().size(), 0.0);
  position_.assign(view.dofs + 2 * kGroup, 0.0);
  velocity_.assign(view.dofs + 2 * kGroup, 0.0);
  integrals_.assign(view.rates + 2 * kGroup, 0.0);
}

void Triggers::declare(StateLayout& layout) const {
  layout.add_integers("events.beyond", 2 * triggers_.size());
}

void Triggers::attach(RunState& state) {
  std::int64_t* beyond = state.integers("events.beyond");
  for (Trigger& trigger : triggers_) trigger.beyond = std::exchange(beyond, beyond + 2);
  if (any()) run_.may_go_back();
}

bool Triggers::waiting() const {
  return std::any_of(triggers_.begin(), triggers_.end(),
                     [this](const Trigger& one) { return force_of(one).control->waits(); });
}

/// Side 0 is above the upper value, 1 below the lower one.
double Triggers::beyond(const Trigger& trigger, int side) const {
  const Passing& passing = *force_of(trigger).control->waits_for();
  const auto& value = side == 0 ? passing.above : passing.below;
  if (!value) return -1.0;
  const double by = trigger.instant.above(run_.model, instant_, *value);
  return side == 0 ? by : -by;
}

void Triggers::read(const DoubleDouble& time, const double* position, const double* velocity,
                    const double* integrals) {
  instant_ = {time, position, velocity, rates_.data(), turns_.data()};
  bool rates = false;
  for (const Trigger& trigger : triggers_) {
    rates = rates || trigger.instant.needs_rates();
    if (!trigger.instant.needs_turns()) continue;
    const std::size_t body = trigger.instant.index();
    turns_[body] = rotations_.turns_of(body, position);
  }
  if (rates) run_.model.evaluate_at(time, position, velocity, integrals, rates_.data());
}

/// The limit that the driver moves away from comes second, of limits that count alternately: a body
/// that swings back through it would reverse the driver for good. -1: that is not known.
int Triggers::side_behind(const Trigger& trigger) const {
  const Model::Force& force = force_of(trigger);
  const Passing& passing = *force.control->waits_for();
  const Drive* drive = force.drive();
  if (!alternates(passing) || drive == nullptr || passing.when.size() < 2) return -1;
  const std::size_t dot = passing.when.size() - 2;
  const int axis = passing.when.back() - 'x';
  if (passing.when[dot] != '.' || axis < 0 || axis >= run_.model.dimension()) return -1;
  const double velocity = drive->velocity[static_cast<std::size_t>(axis)];
  return velocity == 0.0 ? -1 : velocity > 0.0 ? 1 : 0;
}

void Triggers::start() {
  if (!any()) return;
  const SystemView<double>& view = run_.model.system().view;
  read(DoubleDouble(0.0), view.position, view.velocity, view.integrals);
  for (const Trigger& trigger : triggers_) {
    const Model::Force& force = force_of(trigger);
    for (int side = 0; side < 2; ++side) {
      if (side == side_behind(trigger)) {
        trigger.beyond[side] = kWaits;
        continue;
      }
      trigger.beyond[side] = beyond(trigger, side) > 0.0 ? kBeyond : kNotBeyond;
      if (trigger.beyond[side] == kNotBeyond) continue;
      const std::string key = fmt::format("force.{}.reverse", force.name);
      run_.outcome.warnings.push_back(
          {FaultCode::run_reverse_passed,
           fmt::format("{}: {} is {} its value at the start; the driver reverses when it passes it",
                       key, force.control->waits_for()->when, side == 0 ? "above" : "below"),
           key});
    }
  }
}

std::optional<Triggers::Passed> Triggers::first_passed(const DoubleDouble& begin, double h,
                                                       double since) {
  const SystemView<double>& view = run_.model.system().view;
  read(begin + h, view.position, view.velocity, view.integrals);
  std::vector<std::pair<std::size_t, int>> candidates;
  for (std::size_t t = 0; t < triggers_.size(); ++t) {
    const Trigger& trigger = triggers_[t];
    if (!force_of(trigger).control->waits()) continue;
    for (int side = 0; side < 2; ++side) {
      if (trigger.beyond[side] == kWaits) continue;
      const bool now_beyond = beyond(trigger, side) > 0.0;
      if (now_beyond && trigger.beyond[side] == kNotBeyond) candidates.emplace_back(t, side);
      trigger.beyond[side] = now_beyond ? kBeyond : kNotBeyond;
    }
  }
  if (candidates.empty()) return std::nullopt;
  // Between steps noise has no path: what happens takes effect at the end.
  if (stochastic_) return Passed{candidates.front().first, 1.0};
  run_.integrator->finish_dense_from(since + h);
  Passed first;
  for (const auto& [t, side] : candidates) {
    const double theta = theta_of(triggers_[t], side, begin, h);
    if (t == candidates.front().first || theta < first.theta) first = {t, theta};
  }
  return first;
}

/// The part of the step at which it passes its value.
double Triggers::theta_of(const Trigger& trigger, int side, const DoubleDouble& begin, double h) {
  const auto above = [&](double theta) {
    run_.integrator->interpolate(theta, position_.data(), velocity_.data(), integrals_.data());
    read(begin + theta * h, position_.data(), velocity_.data(), integrals_.data());
    return beyond(trigger, side);
  };
  const double at_start = above(0.0);
  const double at_end = above(1.0);
  if (at_start < 0.0 && at_end > 0.0) {
    std::uintmax_t tries = kMostTries;
    const auto bracket = boost::math::tools::toms748_solve(
        above, 0.0, 1.0, at_start, at_end, boost::math::tools::eps_tolerance<double>(), tries);
    return 0.5 * (bracket.first + bracket.second);
  }
  return at_start >= 0.0 ? 0.0 : 1.0;
}

const std::string& Triggers::fire(const Passed& passed) {
  const Trigger& trigger = triggers_[passed.trigger];
  const Model::Force& force = force_of(trigger);
  force.control->passed(run_.clock.now());
  const SystemView<double>& view = run_.model.system().view;
  read(run_.clock.now(), view.position, view.velocity, view.integrals);
  // It has passed its value, whatever rounding says; it can again when it has come back.
  const Passing& passing = *force.control->waits_for();
  const bool first_waits = trigger.beyond[0] == kWaits;
  const bool nearer_first = std::abs(beyond(trigger, 0)) < std::abs(beyond(trigger, 1));
  const int side = !passing.below                                ? 0
                   : !passing.above || first_waits               ? 1
                   : trigger.beyond[1] == kWaits || nearer_first ? 0
                                                                 : 1;
  trigger.beyond[side] = kBeyond;
  if (!alternates(passing)) return force.name;
  trigger.beyond[side] = kWaits;
  const int other = 1 - side;
  if (trigger.beyond[other] == kWaits) {
    trigger.beyond[other] = beyond(trigger, other) > 0.0 ? kBeyond : kNotBeyond;
  }
  return force.name;
}

}  // namespace tomlin
