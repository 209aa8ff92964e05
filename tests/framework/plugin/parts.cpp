#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/plugin/plugin.hpp"

// User-defined components that are no forces: a body, an integrator and an observer.
namespace tomlin {
namespace {

/// Whether the environment variable FAULT asks for this; throws where it asks for an exception.
bool asked_for(const char* fault) {
  const char* wish = std::getenv("FAULT");
  return wish != nullptr && std::string(wish) == fault;
}
void fail_if_asked(const char* fault) {
  if (asked_for(fault)) throw std::length_error("no " + std::string(fault) + ", as planned");
}

// ---- a body: two particles along x

struct DumbbellDescription : BodyDescription {
  SpaceVector centre;
  double length = 0.0;
};

int dimension_of(const void* description) {
  const auto& d = *static_cast<const DumbbellDescription*>(description);
  return static_cast<int>(d.centre.components.size());
}

std::int64_t two(const void*) { return 2; }

std::vector<Complaint> no_body_complaints(const void*, int) { return {}; }

BodyGeometry build_dumbbell(const void* description, int dimension) {
  const auto& d = *static_cast<const DumbbellDescription*>(description);
  BodyGeometry geometry;
  geometry.anchor = d.centre.components;
  geometry.relative.assign(asked_for("three") ? 3 : 2,
                           std::vector<double>(static_cast<std::size_t>(dimension), 0.0));
  geometry.relative[0][0] = -0.5 * d.length;
  geometry.relative[1][0] = 0.5 * d.length;
  return geometry;
}

std::vector<IndexPair> bonded(const void*, const std::array<double, 3>&) {
  return {{0, asked_for("neighbours") ? 2 : 1}};
}

BodyRecord dumbbell_record() {
  BodyRecord record;
  record.name = "dumbbell";
  record.summary = "two particles along x";
  record.equation = "x_0 = centre - length/2, x_1 = centre + length/2";
  record.source = "geometry";
  record.make_description = &make_description<DumbbellDescription>;
  record.parameters = with_body_parameters<DumbbellDescription>(
      {parameter("centre", &DumbbellDescription::centre, dimension::length, "halfway between them"),
       parameter("length", &DumbbellDescription::length, dimension::length, "between them")
           .in(positive)});
  record.common = &body_part<DumbbellDescription>;
  record.dimension = &dimension_of;
  record.count = &two;
  record.complaints = &no_body_complaints;
  record.neighbours = &bonded;
  record.build = &build_dumbbell;
  record.example = "see the tests";
  return record;
}

// ---- an integrator: symplectic Euler

struct EulerDescription {
  double dt = 0.0;
};

class SymplecticEuler final : public Integrator<double>, public ErrorControl {
 public:
  explicit SymplecticEuler(System<double>& system)
      : Integrator<double>(system), rates_(system.view.rates + 2 * kGroup, 0.0) {}

  StepReport step_from(double since, double h, bool dense) override {
    SystemView<double>& view = system_.view;
    if (dense) keep_start();
    const Stage<double> stage =
        stage_of(view, view.position, view.velocity, view.integrals, rates_.data(), since);
    for (std::size_t k = 0; k < view.operation_count; ++k) {
      view.operations[k].run(view.operations[k].arguments, stage);
    }
    ++system_.evaluations;
    for (std::size_t i = 0; i < view.dofs; ++i) {
      view.velocity[i] += h * view.inverse_mass[i] * view.force[i];
      const double move = h * view.velocity[i];
      if (!(std::abs(move) <= view.largest_move[i])) {
        return {0.0, StepFault::not_finite_or_too_far};
      }
      view.position[i] += move;
    }
    for (std::size_t i = 0; i < view.rates; ++i) view.integrals[i] += h * rates_[i];
    return {h, StepFault::none};
  }
  const double* first_rates() const override {
    fail_if_asked("first_rates");
    return rates_.data();
  }
  void finish_dense_from(double since) override {
    fail_if_asked("finish_dense_from");
    (void)since;
  }
  Capabilities<double> capabilities() override { return {.error_control = this}; }
  std::uint64_t refused_steps() const override {
    fail_if_asked("refused_steps");
    return 0;
  }
  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    fail_if_asked("interpolate");
    const SystemView<double>& view = system_.view;
    const auto between = [theta](const std::vector<double>& from, const double* to, double* at) {
      for (std::size_t i = 0; i < from.size(); ++i) at[i] = from[i] + theta * (to[i] - from[i]);
    };
    between(position_, view.position, position);
    between(velocity_, view.velocity, velocity);
    between(integrals_, view.integrals, integrals);
  }

 private:
  void keep_start() {
    const SystemView<double>& view = system_.view;
    position_.assign(view.position, view.position + view.dofs);
    velocity_.assign(view.velocity, view.velocity + view.dofs);
    integrals_.assign(view.integrals, view.integrals + view.rates);
  }

  AlignedVector<double> rates_;
  std::vector<double> position_;
  std::vector<double> velocity_;
  std::vector<double> integrals_;
};

double euler_step(const void* description) {
  return static_cast<const EulerDescription*>(description)->dt;
}

double euler_stable_step(double frequency, double damping_rate) {
  fail_if_asked("stable_step");
  return 2.0 / (frequency + damping_rate);
}

std::vector<Complaint> no_scheme_complaints(const void*) { return {}; }

std::unique_ptr<Integrator<double>> bind_euler(const void*, System<double>& system) {
  if (asked_for("nothing_bound")) return nullptr;
  return std::make_unique<SymplecticEuler>(system);
}

IntegratorRecord euler_record() {
  IntegratorRecord record;
  record.name = "symplectic_euler";
  record.summary = "first order, with the velocity first";
  record.equation = "v += h F(x)/m, x += h v";
  record.source = "E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, section I.1.2";
  record.order = 1;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.make_description = &make_description<EulerDescription>;
  record.parameters = {
      parameter("dt", &EulerDescription::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &euler_stable_step;
  record.step = &euler_step;
  record.complaints = &no_scheme_complaints;
  record.bind = {&bind_euler};
  record.example = "see the tests";
  return record;
}

// ---- an observer: the way between two particles

struct DistanceDescription {
  std::int64_t first = 0;
  std::int64_t second = 1;
};

std::vector<Complaint> distance_complaints(const void* description, const SceneOutline& scene) {
  const auto& d = *static_cast<const DistanceDescription*>(description);
  const std::int64_t count = scene.bodies.front().count;
  std::vector<Complaint> found;
  if (d.first >= count) found.push_back({"first", "there is no such particle", "below the count"});
  if (d.second >= count) {
    found.push_back({"second", "there is no such particle", "below the count"});
  }
  return found;
}

std::vector<ObservedNumber> distance_columns(const void*, const SceneOutline&) {
  return {{"length", "length"}, {"growth", "length/time"}, {"speed", "length/time"}};
}

void observe_distance(const void* description, const ObservedMoment& moment,
                      std::span<double> numbers) {
  const auto& d = *static_cast<const DistanceDescription*>(description);
  const ObservedBody& body = moment.bodies.front();
  const auto axes = static_cast<std::size_t>(moment.dimension);
  double square = 0.0;
  double rate = 0.0;
  double speed = 0.0;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const std::size_t from = static_cast<std::size_t>(d.first) * axes + axis;
    const std::size_t to = static_cast<std::size_t>(d.second) * axes + axis;
    const double way = body.position[to] - body.position[from];
    square += way * way;
    const double apart = body.velocity[to] - body.velocity[from];
    rate += way * apart;
    speed += apart * apart;
  }
  numbers[0] = std::sqrt(square);
  numbers[1] = rate / numbers[0];
  numbers[2] = std::sqrt(speed);
}

ObserverRecord distance_record() {
  ObserverRecord record;
  record.name = "particle_distance";
  record.summary = "the distance of two particles of a body";
  record.equation =
      "length = |x_second - x_first|, growth = d length / dt, speed = |v_second - v_first|";
  record.source = "geometry";
  record.make_description = &make_description<DistanceDescription>;
  record.parameters = {
      parameter("first", &DistanceDescription::first, dimension::none, "index of a particle")
          .in(non_negative)
          .by_default(std::int64_t{0}),
      parameter("second", &DistanceDescription::second, dimension::none, "index of another")
          .in(non_negative)
          .by_default(std::int64_t{1})};
  record.complaints = &distance_complaints;
  record.columns = &distance_columns;
  record.observe = &observe_distance;
  record.example = "see the tests";
  return record;
}

// ---- an observer that integrates and detects events: swings of the way between the first two
// particles

struct SwingDescription {
  double middle = 0.0;
};

double length_at(const ObservedMoment& moment) {
  const ObservedBody& body = moment.bodies.front();
  const auto axes = static_cast<std::size_t>(moment.dimension);
  double square = 0.0;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double way = body.position[axes + axis] - body.position[axis];
    square += way * way;
  }
  return std::sqrt(square);
}

std::vector<ObservedNumber> swing_columns(const void*, const SceneOutline&) {
  return {{"away", "length"}};
}

void observe_swing(const void* description, const ObservedMoment& moment,
                   std::span<double> numbers) {
  numbers[0] = length_at(moment) - static_cast<const SwingDescription*>(description)->middle;
}

std::vector<ObservedNumber> swing_integrals(const void*, const SceneOutline&) {
  return {{"square", "length^2*time"}};
}

void swing_integrands(const void* description, const ObservedMoment& moment,
                      std::span<double> values) {
  fail_if_asked("integrand");
  if (asked_for("infinite_integrand") && moment.time > 1.5) {
    values[0] = std::numeric_limits<double>::infinity();
    return;
  }
  const double away = length_at(moment) - static_cast<const SwingDescription*>(description)->middle;
  values[0] = away * away;
}

/// Internal state: looks, passages through the middle upwards, and where it was last.
enum SwingState : std::size_t { kLooks, kPassages, kLastAway, kLastTime, kSwingState };

std::size_t swing_state(const void*, const SceneOutline&) { return kSwingState; }

std::vector<std::string> swing_events(const void*) { return {"passage"}; }

void swing_step(const void* description, const ObservedMoment& moment, std::span<double> state,
                ObservedEvents& events) {
  const double away = length_at(moment) - static_cast<const SwingDescription*>(description)->middle;
  if (state[kLooks] > 0.0 && state[kLastAway] < 0.0 && away >= 0.0) {
    const double part = state[kLastAway] / (state[kLastAway] - away);
    ++state[kPassages];
    events.record(0, state[kLastTime] + part * (moment.time - state[kLastTime]),
                  std::numeric_limits<double>::quiet_NaN(), state[kPassages]);
  }
  ++state[kLooks];
  state[kLastAway] = away;
  state[kLastTime] = moment.time;
}

std::vector<ObservedNumber> swing_results(const void*, const SceneOutline&) {
  if (asked_for("clash")) return {{"mean_square", "length^2"}, {"looks", "1"}, {"mean_away", "1"}};
  return {{"mean_square", "length^2"}, {"looks", "1"}, {"passages", "1"}};
}

void swing_conclude(const void*, const ObservedWindow& window, std::span<double> numbers) {
  numbers[0] = window.integrals[0] / (window.to - window.from);
  numbers[1] = window.state[kLooks];
  numbers[2] = window.state[kPassages];
}

ObserverRecord swing_record() {
  ObserverRecord record;
  record.name = "particle_swings";
  record.summary = "how the distance of a body's first two particles swings";
  record.equation = "mean_square = mean of (|x_1 - x_0| - middle)^2";
  record.source = "geometry";
  record.make_description = &make_description<SwingDescription>;
  record.parameters = {
      parameter("middle", &SwingDescription::middle, dimension::length, "about which it swings")
          .in(positive)};
  record.columns = &swing_columns;
  record.observe = &observe_swing;
  record.integrals = &swing_integrals;
  record.integrands = &swing_integrands;
  record.state_size = &swing_state;
  record.events = &swing_events;
  record.step = &swing_step;
  record.results = &swing_results;
  record.conclude = &swing_conclude;
  record.example = "see the tests";
  return record;
}

}  // namespace
}  // namespace tomlin

TOMLIN_PLUGIN(registry) {
  registry.add(tomlin::dumbbell_record());
  registry.add(tomlin::euler_record());
  registry.add(tomlin::distance_record());
  registry.add(tomlin::swing_record());
}
