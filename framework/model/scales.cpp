#include "framework/model/scales.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "framework/core/records/force.hpp"
#include "framework/model/single_force.hpp"
#include "framework/model/sliding.hpp"
#include "framework/model/stability.hpp"

namespace tomlin {
namespace {

/// Numbers that are equal but for rounding.
constexpr double kEqualityTolerance = 1e-9;
constexpr std::int64_t kLargestDenominator = 1000;

/// The spacing of a body whose particles stand in equal steps along one axis; 0 for any other.
double spacing_along(const Model::Body& body, int axis) {
  const auto& start = body.bound.start;
  if (start.size() < 2) return 0.0;
  const double spacing = start[1][axis] - start[0][axis];
  for (std::size_t i = 1; i < start.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      const double step = start[i][d] - start[i - 1][d];
      const double expected = static_cast<int>(d) == axis ? spacing : 0.0;
      const double size = std::abs(spacing) + kEqualityTolerance * std::abs(start[i][d]);
      if (std::abs(step - expected) > kEqualityTolerance * size) return 0.0;
    }
  }
  return std::abs(spacing);
}

void add_misfits(Scales& scales, const Model& model, const SceneForce& from,
                 const Model::Force& substrate) {
  for (const std::size_t b : substrate.bodies) {
    for (int axis = 0; axis < model.dimension(); ++axis) {
      const double period = from.period(axis);
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
  if (std::abs(ratio - 1.0) <= kEqualityTolerance) return Regime::critically_damped;
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

/// The bound on the slope of a friction over the mass that it damps: of rigid bodies the mean of
/// their particles.
double rate_at_rest_of(const Model& model, const Model::Force& force) {
  const double bound = force.friction->friction_bound();
  double rate = 0.0;
  if (!(bound > 0.0) || !model.system().view.inertial) return rate;
  for (const std::size_t b : force.bodies) {
    const std::vector<double>& mass = model.bodies()[b].bound.mass;
    const BodySlot<double>& slot = model.bodies()[b].bound.slot;
    if (mass.empty() || (slot.mapped && !slot.rigid)) continue;
    double least = *std::min_element(mass.begin(), mass.end());
    if (slot.rigid) {
      least = std::accumulate(mass.begin(), mass.end(), 0.0) / static_cast<double>(mass.size());
    }
    rate = std::max(rate, bound / least);
  }
  return rate;
}

double shortest_time_of(const Scales& scales) {
  double fastest = std::max({scales.frequency, scales.damping_rate, scales.relaxation_rate});
  for (const Sliding& sliding : scales.sliding) {
    fastest = std::max(fastest, sliding.washboard_frequency);
  }
  for (const ForceScale& force : scales.forces) fastest = std::max(fastest, force.rate_at_rest);
  return fastest > 0.0 ? 1.0 / fastest : 0.0;
}

}  // namespace

double Misfit::misfit() const { return ratio() - std::max(1.0, std::nearbyint(ratio())); }

/// The convergents of the continued fraction: no fraction with a smaller denominator is closer.
std::optional<Fraction> as_fraction(double ratio) {
  Fraction last{1, 0};
  Fraction now{0, 1};
  double rest = ratio;
  now.p = static_cast<std::int64_t>(std::floor(rest));
  while (now.q <= kLargestDenominator) {
    const double value = static_cast<double>(now.p) / static_cast<double>(now.q);
    if (std::abs(value - ratio) <= kEqualityTolerance * ratio) return now;
    rest = 1.0 / (rest - std::floor(rest));
    if (!(rest < 1.0 / kEqualityTolerance)) return std::nullopt;
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
  RunState state(layout);
  model.attach(state);
  model.start();

  Scales scales;
  const Stiffness all = stiffness_of(model);
  scales.frequency = all.frequency;
  scales.damping_rate = all.damping_rate;
  scales.stiffest_force = stiffest_force_of(model);
  for (std::size_t k = 0; k < scene->forces.size(); ++k) {
    SingleForce alone(*scene, k);
    if (!alone.built()) continue;
    const Stiffness own = stiffness_of(alone.model());
    ForceScale scale{alone.force().name,
                     own.frequency,
                     own.damping_rate,
                     rate_at_rest_of(alone.model(), alone.force()),
                     false,
                     {}};
    if (scene->forces[k].traits().internal) {
      for (const std::size_t b : alone.force().bodies) {
        scale.between.push_back(scene->bodies[b].name);
      }
      scale.internal = scale.between.size() == 1;
      if (scale.internal) scale.between.clear();
    }
    scales.forces.push_back(std::move(scale));
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
