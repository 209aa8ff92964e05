#include <algorithm>
#include <cmath>

#include "framework/model/properties/slopes.hpp"

/// Forces against velocities: what they take out, and where the ledger puts it.
namespace tomlin::properties {
namespace {

/// Speeds in parts of the usual one, a length per unit of time.
constexpr double kSpeeds[] = {1.0, 1e-3, 1e3};
/// Speeds of a geometric sequence, for bounds that are reached in between or at rest only.
constexpr double kFastest = 1e3;
constexpr double kSlowest = 1e-9;
constexpr double kSpeedRatio = 0.125;
/// Differences in time, in parts of a unit of time: in quadruple precision, and the longest in
/// double precision.
constexpr double kQuadTimeDifference = 1e-12;
constexpr double kLongestTimeDifference = 1e-3;

State at_speed(const State& state, double factor) {
  State fast = state;
  for (double& v : fast.v) v *= factor;
  return fast;
}

State still(const State& state) { return at_speed(state, 0.0); }

struct Power {
  double sum = 0.0;
  double size = 0.0;
};

Power power_of(const std::vector<double>& forces, const State& state) {
  Power power;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    power.sum += forces[i] * state.v[i];
    power.size += std::abs(forces[i] * state.v[i]);
  }
  return power;
}

class Coefficients : public FrictionSink {
 public:
  explicit Coefficients(const Model& model) {
    for (const Model::Body& body : model.bodies()) {
      of_particle.emplace_back(body.bound.slot.count, 0.0);
    }
  }
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    of_particle[body][particle] += coefficient;
  }
  std::vector<std::vector<double>> of_particle;
};

Coefficients coefficients_of(ForceUnderTest& e) {
  Coefficients coefficients(e.alone().model());
  e.force().friction->friction(coefficients);
  return coefficients;
}

/// Whether energies change with time: by a driver's work, or by heat that is taken out.
bool time_goes_on(const ForceUnderTest& e) {
  const Traits& traits = e.traits();
  return traits.does_work || (traits.conservative && traits.depends_on_time);
}

/// Velocities are made for a unit of time, laws of time for the run's.
double unit_of_time(ForceUnderTest& e) {
  return time_goes_on(e) ? std::min(1.0, e.alone().model().scene().run.duration) : 1.0;
}

/// The energy a time `h` on along the velocities, with the force's own variables; time itself goes
/// on only where a driver accounts for what that does.
template <class Real>
class Later {
 public:
  Later(ForceUnderTest& e, ForceTwin<Real>& twin, const State& state)
      : e_(e), twin_(twin), state_(state), own_rates_(state.own.size(), Real(0.0)) {
    e.put(state, twin);
    twin.evaluate(state.time);
    for (std::size_t k = 0; k < own_rates_.size(); ++k) own_rates_[k] = twin.rate(k);
  }
  Real operator()(const Real& h) {
    for (std::size_t i = 0; i < e_.count(); ++i) {
      twin_.position(e_.variable(i).at) = Real(state_.x[i]) + h * Real(state_.v[i]);
    }
    for (std::size_t k = 0; k < own_rates_.size(); ++k) {
      twin_.own(k) = Real(state_.own[k]) + h * own_rates_[k];
    }
    twin_.evaluate(state_.time, time_goes_on(e_) ? static_cast<double>(h) : 0.0);
    return twin_.energy();
  }

 private:
  ForceUnderTest& e_;
  ForceTwin<Real>& twin_;
  const State& state_;
  std::vector<Real> own_rates_;
};

struct Gain {
  double value = 0.0;
  double error = 0.0;
};

/// d/dt of the stored energy: in quadruple precision where there are some.
Gain gain_at(ForceUnderTest& e, ForceTwin<double>& twin, const State& state, double size) {
  if (e.exact() != nullptr) {
    Later<Quad> later(e, *e.exact(), state);
    // Steps of time that a double holds exactly.
    const double h = std::ldexp(
        1.0, static_cast<int>(std::floor(std::log2(kQuadTimeDifference * unit_of_time(e)))));
    const Quad near = (later(Quad(h)) - later(Quad(-h))) / Quad(2.0 * h);
    const Quad far = (later(Quad(2.0 * h)) - later(Quad(-2.0 * h))) / Quad(4.0 * h);
    const double energy = std::abs(static_cast<double>(later(Quad(0.0))));
    return {static_cast<double>((Quad(4.0) * near - far) / Quad(3.0)), kExactRounding * energy / h};
  }
  // Positions are rounded, and those of rigid bodies' particles one by one: the energy follows.
  const double noise =
      e.terms(state).size * e.reach(state) + e.change_of(state, [&](const State& at) {
        e.put(at, twin);
        twin.evaluate(at.time);
        return twin.energy();
      });
  Later<double> later(e, twin, state);
  double slope[3] = {};
  double h = kLongestTimeDifference * unit_of_time(e);
  double energy = 0.0;
  for (double& s : slope) {
    const double after = later(h);
    s = (after - later(-h)) / (2.0 * h);
    energy = std::max(energy, std::abs(after));
    h *= 0.5;
  }
  const double first = (4.0 * slope[1] - slope[0]) / 3.0;
  const double second = (4.0 * slope[2] - slope[1]) / 3.0;
  const double rounding = kRounding * (energy + size + noise) / (2.0 * h);
  return {(16.0 * second - first) / 15.0,
          kErrorPerDifference * std::abs(second - first) + rounding};
}

}  // namespace

bool dissipative(ForceUnderTest& e, const State& state) {
  for (const double speed : kSpeeds) {
    const State moving = at_speed(state, speed);
    const Power power = power_of(e.forces(moving), moving);
    const double positive = power.sum < 0.0 ? 0.0 : power.sum;
    e.note(positive, 0.0, power.size, kRounding * power.size, moving);
  }
  return true;
}

bool coefficients_are_positive(ForceUnderTest& e) {
  for (const auto& of_body : coefficients_of(e).of_particle) {
    for (const double coefficient : of_body) {
      if (!(coefficient >= 0.0)) e.contradict(coefficient, 0.0);
    }
  }
  return true;
}

/// Coefficients times velocities, on particles or, for bodies that move as one, on their centre.
bool friction(ForceUnderTest& e, const State& state) {
  const Coefficients coefficients = coefficients_of(e);
  const auto coefficient_of = [&](const Variable& variable) {
    const auto& of_body = coefficients.of_particle[variable.body];
    const BodySlot<double>& slot = e.alone().model().bodies()[variable.body].bound.slot;
    if (!slot.rigid) return of_body[(variable.at - slot.offset) % slot.stride];
    double sum = 0.0;
    for (const double coefficient : of_body) sum += coefficient;
    return sum;
  };
  const std::vector<double> at_rest = e.forces(still(state));
  for (const double speed : kSpeeds) {
    State moving = at_speed(state, speed);
    for (std::size_t i = 0; i < e.count(); ++i) {
      if (e.variable(i).axis < 0) moving.v[i] = 0.0;
    }
    std::vector<double> drag = e.forces(moving);
    const double size = e.largest(drag) + e.largest(at_rest);
    std::vector<double> expected(e.count());
    for (std::size_t i = 0; i < e.count(); ++i) {
      drag[i] -= at_rest[i];
      // A rotation is dragged along by a centre of friction that is not that of mass.
      expected[i] = e.variable(i).axis < 0 ? drag[i] : -coefficient_of(e.variable(i)) * moving.v[i];
    }
    e.note(drag, expected, size, kRounding * size * static_cast<double>(e.count()), moving);
  }
  return true;
}

/// Between rest and slower and slower motion, where friction is usually at its stiffest.
bool friction_bound(ForceUnderTest& e, const State& state) {
  const double bound = e.force().friction->friction_bound();
  const Model& model = e.alone().model();
  const double root = std::sqrt(static_cast<double>(model.dimension()));  // |v| over a component
  const std::vector<double> at_rest = e.forces(still(state));
  for (double speed = kFastest; speed > kSlowest; speed *= kSpeedRatio) {
    State moving = at_speed(state, speed);
    double largest = 0.0;  // that the bound allows
    for (std::size_t i = 0; i < e.count(); ++i) {
      const Variable& variable = e.variable(i);
      if (variable.axis < 0) moving.v[i] = 0.0;
      const BodySlot<double>& slot = model.bodies()[variable.body].bound.slot;
      const double particles = slot.rigid ? static_cast<double>(slot.count) : 1.0;
      largest = std::max(largest, bound * particles * root * std::abs(moving.v[i]));
    }
    const std::vector<double> forces = e.forces(moving);
    double change = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < e.count(); ++i) {
      if (e.variable(i).axis < 0) continue;
      change = std::max(change, std::abs(forces[i] - at_rest[i]));
      size = std::max(size, std::abs(forces[i]) + std::abs(at_rest[i]));
    }
    e.note(std::max(0.0, change - largest), 0.0, size,
           kRounding * size * static_cast<double>(e.count()), moving);
  }
  return true;
}

bool takes_part_in_balance(ForceUnderTest& e) {
  return !e.on_prescribed() && (e.traits().conservative || e.traits().does_work ||
                                e.traits().depends_on_velocity || e.twin().heat().has_value());
}

/// -F.v = dU/dt + heat - power in. Only for forces that take part in the ledger: those with an
/// energy, with heat or what velocities make of it, or with a support. Prescribed bodies do work
/// of their own.
bool balance(ForceUnderTest& e, const State& state) {
  if (state.kind == StateKind::contact) return false;
  ForceTwin<double>& twin = e.twin();
  const std::vector<double> forces = e.forces(state);
  double work = 0.0;
  if (e.traits().does_work && e.alone().force().first_rate != kNoRate) {
    const auto at = static_cast<std::size_t>(e.alone().force().first_rate);
    work = e.alone().rates()[at + static_cast<std::size_t>(e.alone().model().dimension())];
  }
  const double sensitivity = e.sensitivity(state);
  if (!std::isfinite(e.largest(forces)) || !std::isfinite(sensitivity)) return false;
  const Power taken = power_of(forces, state);
  const auto heat_at = [&](const State& at) {
    e.put(at, twin);
    twin.evaluate(at.time);
    return twin.heat().value_or(0.0);
  };
  const double heat = heat_at(state);
  const double noise = e.change_of(state, heat_at);
  double speed = 0.0;
  for (std::size_t i = 0; i < e.count(); ++i) {
    speed += std::abs(state.v[i]) / e.variable(i).unit;
  }
  const double size = taken.size + std::abs(work) + std::abs(heat);
  const Gain gain = gain_at(e, twin, state, size);
  double drive = 0.0;  // speed of a support, whose position is rounded too
  if (const Drive* pulled = e.force().driving->drive()) {
    for (const double v : pulled->velocity) drive += std::abs(v);
  }
  const double allowed = kRounding * (size + noise + sensitivity * (speed + drive)) + gain.error +
                         kSmallest * (1.0 + speed);
  e.note(-taken.sum, gain.value + heat - work, size, allowed, state);
  return true;
}

}  // namespace tomlin::properties
