#include "framework/model/scales.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/force.hpp"
#include "framework/model/force_alone.hpp"

namespace tomlin {
namespace {

constexpr double kTau = 6.283185307179586476925286766559;
/// Places of a rigid shift over one period, and the difference that slopes are taken by: a
/// sinusoid's largest slope is met to 1e-4 and taken to 1e-5.
constexpr int kShifts = 200;
constexpr double kDifference = 1e-3;  // of the period
/// Numbers that are equal but for rounding.
constexpr double kEqual = 1e-9;
constexpr std::int64_t kLargestDenominator = 1000;

double period_of(const SceneForce& force, int axis) {
  return force.record->period(force.description.get(), axis);
}

bool acts_on(const Model::Force& force, std::size_t body) {
  return std::find(force.bodies.begin(), force.bodies.end(), body) != force.bodies.end();
}

/// Largest slope of the force on a body as it is moved along an axis over a period, its shape kept.
double largest_slope(ForceAlone& alone, std::size_t body, int axis, double period) {
  std::vector<std::pair<ForceAlone::Variable, double>> moved;
  for (const ForceAlone::Variable& variable : alone.variables()) {
    if (variable.body == body && variable.axis == axis) {
      moved.emplace_back(variable, alone.position(variable));
    }
  }
  const auto force_at = [&](double shift) {
    for (const auto& [variable, start] : moved) alone.position(variable) = start + shift;
    alone.forces(0.0);
    return alone.wrench(body).force[axis];
  };
  const double h = kDifference * period;
  double largest = 0.0;
  for (int k = 0; k < kShifts; ++k) {
    const double shift = period * k / kShifts;
    largest = std::max(largest, std::abs(force_at(shift + h) - force_at(shift - h)) / (2.0 * h));
  }
  alone.restart();
  return largest;
}

/// One substrate under one body, for each axis that a driver pulls it along.
void add_sliding(Scales& scales, Model& model, std::size_t substrate_in_scene,
                 const Model::Force& substrate) {
  const SceneForce& from = model.scene().forces[substrate_in_scene];
  for (const Model::Force& driver : model.forces()) {
    const Drive* drive = driver.bound->drive();
    if (drive == nullptr || !(drive->stiffness > 0.0)) continue;
    for (const std::size_t b : substrate.bodies) {
      if (!acts_on(driver, b)) continue;
      for (int axis = 0; axis < model.dimension(); ++axis) {
        const double period = period_of(from, axis);
        const double bound = substrate.bound->curvature_bound_along(axis);
        const double velocity = drive->velocity.empty() ? 0.0 : drive->velocity[axis];
        if (!(period > 0.0) || bound < 0.0 || velocity == 0.0) continue;
        const Model::Body& body = model.bodies()[b];
        Sliding sliding;
        sliding.body = body.bound.name;
        sliding.driver = driver.name;
        sliding.substrate = substrate.name;
        sliding.axis = axis;
        sliding.particles = body.bound.slot.count;
        sliding.period = period;
        sliding.stiffness = drive->stiffness;
        sliding.curvature = bound * static_cast<double>(body.bound.slot.count);
        ForceAlone alone(model.scene(), substrate_in_scene);
        sliding.curvature_as_placed = largest_slope(alone, b, axis, period);
        sliding.washboard_frequency = kTau * std::abs(velocity) / period;
        sliding.rolling_radius = body.rolling_radius;
        scales.sliding.push_back(std::move(sliding));
      }
    }
  }
}

/// The spacing of a body whose particles stand in equal steps along one axis; 0 for any other.
double spacing_along(const Model::Body& body, int axis) {
  const auto& start = body.bound.start;
  if (start.size() < 2) return 0.0;
  const double spacing = start[1][axis] - start[0][axis];
  for (std::size_t i = 1; i < start.size(); ++i) {
    for (std::size_t d = 0; d < start[i].size(); ++d) {
      const double step = start[i][d] - start[i - 1][d];
      const double due = static_cast<int>(d) == axis ? spacing : 0.0;
      const double size = std::abs(spacing) + kEqual * std::abs(start[i][d]);
      if (std::abs(step - due) > kEqual * size) return 0.0;
    }
  }
  return std::abs(spacing);
}

void add_misfits(Scales& scales, const Model& model, const SceneForce& from,
                 const Model::Force& substrate) {
  for (const std::size_t b : substrate.bodies) {
    for (int axis = 0; axis < model.dimension(); ++axis) {
      const double period = period_of(from, axis);
      const double spacing = spacing_along(model.bodies()[b], axis);
      if (!(period > 0.0) || !(spacing > 0.0)) continue;
      scales.misfits.push_back(
          {model.bodies()[b].bound.name, substrate.name, axis, spacing, period});
    }
  }
}

/// The damping is given in parts of the critical one.
Regime regime_of(double ratio) {
  if (!(ratio > 0.0)) return Regime::undamped;
  if (std::abs(ratio - 1.0) <= kEqual) return Regime::critically_damped;
  return ratio < 1.0 ? Regime::underdamped : Regime::overdamped;
}

Damping damping_of(const Scales& scales) {
  const ForceScale* fastest = nullptr;
  for (const ForceScale& force : scales.forces) {
    if (!(force.frequency > 0.0)) continue;
    const bool outer = fastest != nullptr && fastest->internal && !force.internal;
    const bool same = fastest != nullptr && fastest->internal == force.internal;
    if (fastest == nullptr || outer || (same && force.frequency > fastest->frequency)) {
      fastest = &force;
    }
  }
  Damping damping;
  damping.rate = scales.damping_rate;
  if (fastest == nullptr) return damping;
  damping.oscillator = fastest->force;
  damping.critical = 2.0 * fastest->frequency;
  damping.regime = regime_of(damping.rate / damping.critical);
  return damping;
}

double shortest_time_of(const Scales& scales) {
  double fastest = std::max({scales.frequency, scales.damping_rate, scales.relaxation_rate});
  for (const Sliding& sliding : scales.sliding) {
    fastest = std::max(fastest, sliding.washboard_frequency);
  }
  return fastest > 0.0 ? 1.0 / fastest : 0.0;
}

}  // namespace

const char* to_string(Regime regime) {
  switch (regime) {
    case Regime::undamped:
      return "undamped";
    case Regime::underdamped:
      return "underdamped";
    case Regime::critically_damped:
      return "critically damped";
    case Regime::overdamped:
      return "overdamped";
    case Regime::no_oscillation:
      return "no oscillation";
    case Regime::no_inertia:
      return "no inertia";
  }
  return "";
}

double Misfit::misfit() const { return ratio() - std::max(1.0, std::nearbyint(ratio())); }

/// The convergents of the continued fraction: no fraction with a smaller denominator is closer.
std::optional<Fraction> as_fraction(double ratio) {
  Fraction last{1, 0};
  Fraction now{0, 1};
  double rest = ratio;
  now.p = static_cast<std::int64_t>(std::floor(rest));
  while (now.q <= kLargestDenominator) {
    const double value = static_cast<double>(now.p) / static_cast<double>(now.q);
    if (std::abs(value - ratio) <= kEqual * ratio) return now;
    rest = 1.0 / (rest - std::floor(rest));
    if (!(rest < 1.0 / kEqual)) return std::nullopt;
    const auto whole = static_cast<std::int64_t>(std::floor(rest));
    const Fraction next{whole * now.p + last.p, whole * now.q + last.q};
    last = now;
    now = next;
  }
  return std::nullopt;
}

Scales scales_of(const std::shared_ptr<const Scene>& scene) {
  Model model(scene);
  StateLayout layout;
  model.declare(layout);
  RunState state(layout, 1);
  model.attach(state);
  model.start();

  Scales scales;
  const Model::Stiffness all = model.stiffness();
  scales.frequency = all.frequency;
  scales.damping_rate = all.damping_rate;
  scales.stiffest_force = model.stiffest_force();
  for (std::size_t k = 0; k < scene->forces.size(); ++k) {
    ForceAlone alone(*scene, k);
    if (!alone.built()) continue;
    const Model::Stiffness own = alone.model().stiffness();
    scales.forces.push_back(
        {alone.force().name, own.frequency, own.damping_rate, scene->forces[k].traits().internal});
    for (const Model::Force& force : model.forces()) {
      if (force.name != scene->forces[k].name) continue;
      add_sliding(scales, model, k, force);
      add_misfits(scales, model, scene->forces[k], force);
    }
  }
  scales.relaxation_rate = all.relaxation_rate;
  scales.damping = damping_of(scales);
  if (!model.system().view.inertial) {
    scales.damping = Damping();
    scales.damping.regime = Regime::no_inertia;
  }
  scales.shortest_time = shortest_time_of(scales);
  return scales;
}

}  // namespace tomlin
