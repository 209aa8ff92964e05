#include "framework/model/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/force.hpp"
#include "framework/model/single_force.hpp"

namespace tomlin {
namespace {

/// Positions of a rigid shift over one period, and the difference that slopes are taken by: a
/// sinusoid's largest slope is met to 1e-4 and taken to 1e-5.
constexpr int kShiftsOfPeriod = 200;
constexpr double kDifferenceOverPeriod = 1e-3;  // of the period
/// Part of a spring's stiffness that slopes may differ by, or a force may add, where the spring
/// counts as linear and alone: rounding of differences is far less, and s has four digits.
constexpr double kSlopeTolerance = 1e-6;

bool acts_on(const Model::Force& force, std::size_t body) {
  return std::find(force.bodies.begin(), force.bodies.end(), body) != force.bodies.end();
}

/// Slopes of the force on a body as it is moved along an axis over a period, its shape kept.
struct Slopes {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  double across = 0.0;  ///< the largest of a component along another axis

  double largest() const { return std::max(std::abs(least), std::abs(most)); }
  /// A linear spring that only pulls along the axis.
  bool linear() const {
    return most < 0.0 && most - least <= kSlopeTolerance * largest() &&
           across <= kSlopeTolerance * largest();
  }
};

Slopes slopes_of(SingleForce& alone, std::size_t body, int axis, double period) {
  std::vector<std::pair<SingleForce::Variable, double>> moved;
  for (const SingleForce::Variable& variable : alone.variables()) {
    if (variable.body == body && variable.axis == axis) {
      moved.emplace_back(variable, alone.position(variable));
    }
  }
  const auto force_at = [&](double shift) {
    for (const auto& [variable, start] : moved) alone.position(variable) = start + shift;
    alone.forces(0.0);
    return alone.wrench(body).force;
  };
  const double h = kDifferenceOverPeriod * period;
  Slopes slopes;
  for (int k = 0; k < kShiftsOfPeriod; ++k) {
    const double shift = period * (static_cast<double>(k) / kShiftsOfPeriod - 0.5);
    const auto ahead = force_at(shift + h);
    const auto behind = force_at(shift - h);
    for (int d = 0; d < 3; ++d) {
      const double slope = (ahead[d] - behind[d]) / (2.0 * h);
      if (d != axis) {
        slopes.across = std::max(slopes.across, std::abs(slope));
        continue;
      }
      slopes.least = std::min(slopes.least, slope);
      slopes.most = std::max(slopes.most, slope);
    }
  }
  alone.restart();
  return slopes;
}

/// Whether its position along an axis is one coordinate, which nothing but that moves.
bool is_one_coordinate(const Model::Body& body, int axis) {
  if (!follows_forces(body.bound.coordinates) || body.held[static_cast<std::size_t>(axis)])
    return false;
  if (body.has_free_rotation()) return false;
  return body.bound.slot.count == 1 || body.bound.slot.rigid;
}

/// Whether what pulls one body pulls the other, by forces between bodies that move.
bool are_coupled(const Model& model, std::size_t one, std::size_t other) {
  std::vector<bool> reached(model.bodies().size(), false);
  std::vector<std::size_t> rest = {one};
  reached[one] = true;
  while (!rest.empty()) {
    const std::size_t b = rest.back();
    rest.pop_back();
    if (!follows_forces(model.bodies()[b].bound.coordinates)) continue;
    for (const Model::Force& force : model.forces()) {
      if (!acts_on(force, b)) continue;
      for (const std::size_t next : force.bodies) {
        if (!reached[next]) rest.push_back(next);
        reached[next] = true;
      }
    }
  }
  return reached[other];
}

class Pull {
 public:
  Pull(Scales& scales, Model& model, std::size_t substrate_in_scene, const Model::Force& substrate)
      : scales_(scales), model_(model), index_(substrate_in_scene), substrate_(substrate) {}

  /// By one driver, of the bodies under the substrate, along one axis.
  void add(const Model::Force& driver, int axis) {
    const Drive& drive = *driver.drive();
    const SceneForce& from = model_.scene().forces[index_];
    const double period = from.period(axis);
    const double length =
        period > 0.0 ? period : from.record->origin_cell(from.description.get(), axis);
    const double bound = substrate_.curvature->curvature_bound_along(axis);
    const double velocity = drive.velocity.empty() ? 0.0 : drive.velocity[axis];
    const bool known = period > 0.0 && bound >= 0.0;
    if (!(length > 0.0) || velocity == 0.0) return;
    if (!(drive.stiffness_on(axis) > 0.0)) return;
    for (const std::size_t b : substrate_.bodies) {
      const Model::Body& body = model_.bodies()[b];
      Sliding sliding;
      sliding.body = body.bound.name;
      sliding.driver = driver.name;
      sliding.substrate = substrate_.name;
      sliding.axis = axis;
      sliding.particles = body.bound.slot.count;
      sliding.period = period;
      sliding.stiffness = sliding.driver_stiffness = drive.stiffness_on(axis);
      if (!acts_on(driver, b) && !(known && add_bond(sliding, driver, b))) continue;
      sliding.curvature = std::max(0.0, bound) * static_cast<double>(body.bound.slot.count);
      SingleForce alone(model_.scene(), index_);
      sliding.curvature_as_placed = slopes_of(alone, b, axis, length).largest();
      if (period > 0.0) sliding.washboard_frequency = kTau * std::abs(velocity) / period;
      sliding.rolling_radius = body.rolling_radius;
      (known ? scales_.sliding : scales_.sliding_as_placed).push_back(std::move(sliding));
    }
  }

 private:
  /// The bond by which the driver pulls a body that it does not act on. False where there is none
  /// in series with it; what then is known is added.
  bool add_bond(Sliding& sliding, const Model::Force& driver, std::size_t body) {
    const std::size_t driven = driver.bodies.front();
    if (!follows_forces(model_.bodies()[body].bound.coordinates)) return false;
    if (lies_on_substrate(driven, sliding.axis) || !are_coupled(model_, driven, body)) return false;
    if (const auto bond = bond_in_series(sliding, driver, driven, body)) {
      sliding.bond = bond->first;
      sliding.bond_stiffness = bond->second;
      sliding.stiffness = 1.0 / (1.0 / sliding.driver_stiffness + 1.0 / sliding.bond_stiffness);
      return true;
    }
    scales_.transmissions.push_back({driver.name, model_.bodies()[driven].bound.name,
                                     substrate_.name, sliding.body, sliding.axis});
    return false;
  }

  bool lies_on_substrate(std::size_t body, int axis) const {
    for (const Model::Force& force : model_.forces()) {
      if (!acts_on(force, body)) continue;
      for (const SceneForce& from : model_.scene().forces) {
        if (from.name == force.name && from.period(axis) > 0.0) return true;
      }
    }
    return false;
  }

  /// Name and stiffness of the only force between the two bodies, where it is a linear spring along
  /// the axis and nothing else holds either of them there.
  std::optional<std::pair<std::string, double>> bond_in_series(const Sliding& sliding,
                                                               const Model::Force& driver,
                                                               std::size_t driven,
                                                               std::size_t body) const {
    const Model::Body& pulled = model_.bodies()[body];
    if (!is_one_coordinate(model_.bodies()[driven], sliding.axis)) return std::nullopt;
    if (pulled.held[static_cast<std::size_t>(sliding.axis)]) return std::nullopt;
    if (pulled.has_free_rotation()) return std::nullopt;
    std::optional<std::pair<std::string, double>> bond;
    std::vector<double> others;
    const std::vector<SceneForce>& forces = model_.scene().forces;
    for (std::size_t k = 0; k < forces.size(); ++k) {
      if (k == index_ || forces[k].name == driver.name) continue;
      SingleForce alone(model_.scene(), k);
      if (!alone.built()) continue;
      const Traits traits = forces[k].traits();
      const bool on_driven = acts_on(alone.force(), driven);
      const bool on_pulled = acts_on(alone.force(), body);
      if (!on_driven && !on_pulled) continue;
      if (traits.internal && alone.force().bodies.size() == 1) continue;
      if (traits.depends_on_time || alone.own_count() > 0) return std::nullopt;
      const auto slopes = [&](std::size_t of) {
        return slopes_of(alone, of, sliding.axis, sliding.period);
      };
      if (on_driven && on_pulled) {
        const Slopes of_bond = slopes(body);
        if (bond || !traits.internal || !of_bond.linear()) return std::nullopt;
        bond = {alone.force().name, of_bond.largest()};
        continue;
      }
      others.push_back(slopes(on_driven ? driven : body).largest());
    }
    if (!bond) return std::nullopt;
    const double softest = std::min(bond->second, sliding.driver_stiffness);
    for (const double other : others) {
      if (!(other <= kSlopeTolerance * softest)) return std::nullopt;
    }
    return bond;
  }

  Scales& scales_;
  Model& model_;
  std::size_t index_;  ///< in the scene
  const Model::Force& substrate_;
};

}  // namespace

void add_sliding(Scales& scales, Model& model, std::size_t substrate_in_scene,
                 const Model::Force& substrate) {
  Pull pull(scales, model, substrate_in_scene, substrate);
  for (const Model::Force& driver : model.forces()) {
    const Drive* drive = driver.drive();
    if (drive == nullptr) continue;
    for (int axis = 0; axis < model.dimension(); ++axis) pull.add(driver, axis);
  }
}

}  // namespace tomlin
