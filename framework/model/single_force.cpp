#include "framework/model/single_force.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/numbers/constants.hpp"
#include "framework/model/force_twin.hpp"

namespace tomlin {
namespace {

/// Distance of a body's farthest particle from its centre, in the plane.
double farthest_arm(const Model::Body& body) {
  double farthest = 0.0;
  for (const std::array<double, 3>& arm : body.arms) {
    farthest = std::max(farthest, std::hypot(arm[0], arm[1]));
  }
  return farthest;
}

/// The force as the record has it, whether the scene declares it a driver or not.
SceneForce as_force(SceneForce force) {
  force.driver = false;
  return force;
}

/// The scene with all bodies at rest that the force does not act on: their motion is no part of the
/// force's state.
Scene with_others_at_rest(Scene scene, std::size_t force) {
  const std::vector<std::size_t>& own = scene.forces[force].bodies;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (!scene.bodies[b].motion || std::count(own.begin(), own.end(), b) > 0) continue;
    scene.bodies[b].motion = Motion{};
    scene.bodies[b].motion->velocity.resize(static_cast<std::size_t>(scene.dimension));
  }
  return scene;
}

}  // namespace

IntegratorRecord without_demands(IntegratorRecord scheme) {
  scheme.without_inertia = scheme.with_inertia = scheme.takes_noise = true;
  scheme.splits_friction = scheme.splits_bonds = false;
  scheme.needs_tangent = scheme.conservative_only = scheme.follows_equilibria = false;
  scheme.bind = {};  // it takes no steps
  return scheme;
}

std::shared_ptr<const Scene> with_forces(const Scene& scene, std::vector<SceneForce> forces,
                                         const IntegratorRecord& scheme) {
  auto with = std::make_shared<Scene>(scene);
  with->forces = std::move(forces);
  for (SceneForce& force : with->forces) force.active.reset();
  with->run.dynamics = Dynamics::inertial;
  with->run.integrator.record = &scheme;
  with->run.number_type = NumberType::double_precision;
  with->run.ledger = false;
  // Both need noise, which may be another force's.
  with->run.repeats = 1;
  with->run.until.reset();
  with->run.locations.erase("until");
  return with;
}

SingleForce::SingleForce(const Scene& scene, std::size_t force)
    : scheme_(without_demands(*scene.run.integrator.record)),
      model_(with_forces(with_others_at_rest(scene, force), {as_force(scene.forces[force])},
                         scheme_)) {
  StateLayout layout;
  model_.declare(layout);
  state_ = RunState(layout);
  model_.attach(state_);
  model_.start();
  rates_.assign(model_.system().view.rates + 2 * kGroup, 0.0);
  start_of_own_.assign(own(), own() + own_count());
  restart();
  list_variables();
}

void SingleForce::restart() {
  const auto& view = model_.system().view;
  // Kernels may read a group past the end.
  position_.assign(view.dofs + 2 * kGroup, 0.0);
  velocity_.assign(view.dofs + 2 * kGroup, 0.0);
  std::copy(view.position, view.position + view.dofs, position_.begin());
  std::copy(view.velocity, view.velocity + view.dofs, velocity_.begin());
  stop_rotors<double>(model_.bodies(), velocity_.data());
  std::copy(start_of_own_.begin(), start_of_own_.end(), own());
}

void SingleForce::list_variables() {
  const double* inverse_mass = model_.system().view.inverse_mass;
  const auto add = [&](std::size_t at, std::size_t body, int axis, double unit) {
    if (inverse_mass[at] > 0.0) variables_.push_back({at, body, axis, unit});
  };
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const Model::Body& body = model_.bodies()[b];
    const auto& slot = body.bound.slot;
    if (slot.rigid) {
      for (int d = 0; d < model_.dimension(); ++d) add(slot.centre + d, b, d, 1.0);
      // The rotations of a rotor are no gradient's: what acts on its particles is checked.
      const double reach = body.rotates() && !body.rotor ? farthest_arm(body) : 0.0;
      if (reach > 0.0) add(slot.centre + model_.dimension(), b, -1, 1.0 / (kTau * reach));
    } else if (!slot.mapped) {
      for (int d = 0; d < model_.dimension(); ++d) {
        for (std::size_t i = 0; i < slot.count; ++i) {
          add(slot.offset + d * slot.stride + i, b, d, 1.0);
        }
      }
    }
  }
}

const double* SingleForce::forces(double time) {
  place_velocities(model_.bodies(), model_.dimension(), position_.data(), velocity_.data(),
                   model_.system().view.mapped_velocity);
  model_.evaluate_at(DoubleDouble(time), position_.data(), velocity_.data(),
                     state_.reals("integrals"), rates_.data());
  return model_.system().view.force;
}

double SingleForce::energy(double time) {
  return model_.potential_energy(DoubleDouble(time), position_.data(), velocity_.data(),
                                 state_.reals("integrals"));
}

SingleForce::Wrench SingleForce::wrench(std::size_t b) {
  const auto& slot = model_.bodies()[b].bound.slot;
  const auto& view = model_.system().view;
  Wrench total;
  const auto act = [&](const std::array<double, 3>& x, const std::array<double, 3>& f) {
    for (int a = 0; a < 3; ++a) {
      const int next = (a + 1) % 3;
      const int last = (a + 2) % 3;
      total.force[a] += f[a];
      total.torque[a] += x[next] * f[last] - x[last] * f[next];
    }
  };
  std::array<double, 3> x{};
  std::array<double, 3> f{};
  if (slot.rigid && model_.dimension() != 3) {
    for (int d = 0; d < model_.dimension(); ++d) {
      x[d] = position_[slot.centre + d];
      f[d] = view.force[slot.centre + d];
    }
    act(x, f);
    total.torque[2] += view.force[slot.centre + model_.dimension()] / kTau;
    return total;
  }
  const double* const from = slot.mapped ? view.mapped_position : position_.data();
  const double* const acting = slot.mapped ? view.mapped_force : view.force;
  for (std::size_t i = 0; i < slot.count; ++i) {
    for (int d = 0; d < model_.dimension(); ++d) {
      const std::size_t at = slot.offset + d * slot.stride + i;
      x[d] = from[at];
      f[d] = acting[at];
    }
    act(x, f);
  }
  if (!slot.rigid) return total;
  // The rest acts on its centre; a rotor's coordinates of rotation have no torques.
  for (std::size_t d = 0; d < 3; ++d) {
    x[d] = position_[slot.centre + d];
    f[d] = view.force[slot.centre + d] - total.force[d];
  }
  act(x, f);
  return total;
}

}  // namespace tomlin
