#include "framework/model/coordinate_arrays.hpp"

#include <algorithm>
#include <limits>

#include "framework/core/numbers/math.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

/// No limit on a move, though still a finite one: infinity would let an infinite move pass.
constexpr double kUnbounded = std::numeric_limits<double>::max();

}  // namespace

template <class Real>
CoordinateArrays<Real>::CoordinateArrays(const AssemblyPlan& plan, AssembledBodies<Real>& bodies,
                                         SystemView<Real>& view)
    : inverse_mass(bodies.dofs, Real(0.0)),
      largest_move_(bodies.dofs, Real(kUnbounded)),
      force_(bodies.dofs + 2 * kGroup, Real(0.0)),
      mapped_position_(bodies.mapped_size + 2 * kGroup, Real(0.0)),
      mapped_velocity_(bodies.mapped_size + 2 * kGroup, Real(0.0)),
      mapped_force_(bodies.mapped_size + 2 * kGroup, Real(0.0)) {
  const int dimension = plan.dimension();
  const auto& unit = plan.origin.unit;
  for (AssembledBody<Real>& body : bodies.all) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (slot.rigid) {
      for (int d = 0; d < dimension; ++d) {
        if (unit[d] > 0.0) largest_move_[slot.centre + d] = Real(unit[d]);
        if (body.held[d]) continue;
        inverse_mass[slot.centre + d] = Real(1.0) / Real(body.total_mass);
        body.response[d] = 1.0 / body.total_mass;
        ++view.coordinates;
      }
      if (body.rotor) {
        place_rotor(body);
        view.coordinates += static_cast<std::size_t>(body.free_rotations);
      }
      if (dimension != 2) continue;
      largest_move_[slot.centre + kRotation] = Real(0.5);
      // A body without extent (one particle) has no rotation to speak of: it stays put.
      if (!(body.inertia > 0.0) || body.rotation_held) continue;
      inverse_mass[slot.centre + kRotation] =
          Real(1.0) / (tau<Real>() * tau<Real>() * Real(body.inertia));
      body.response_of_rotation = 1.0 / body.inertia;
      ++view.coordinates;
    } else if (!slot.mapped) {
      for (int d = 0; d < dimension; ++d) {
        if (!body.held[d]) view.coordinates += slot.count;
        for (std::size_t i = 0; i < slot.count; ++i) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          if (!body.held[d]) inverse_mass[at] = Real(1.0) / Real(body.bound.mass[i]);
          if (unit[d] > 0.0) largest_move_[at] = Real(unit[d]);
        }
      }
    }
  }
  view.dofs = bodies.dofs;
  view.inertial = plan.inertial;
  view.inverse_mass = inverse_mass.data();
  view.largest_move = largest_move_.data();
  view.force = force_.data();
  view.mapped_position = mapped_position_.data();
  view.mapped_velocity = mapped_velocity_.data();
  view.mapped_force = mapped_force_.data();
  place_fixed(plan, bodies.all, plan.origin);
}

template <class Real>
void CoordinateArrays<Real>::place_rotor(AssembledBody<Real>& body) {
  const double most = *std::max_element(body.moments.begin(), body.moments.end());
  double least = most;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t at = body.bound.slot.centre + 3 + k;
    largest_move_[at] = Real(kLargestRotation);
    if (body.free_rotations == 1 && !body.rotation_free[k]) continue;
    const double moment = body.moments[k] > 0.0 ? body.moments[k] : most;
    inverse_mass[at] = Real(1.0) / Real(moment);
    least = std::min(least, moment);
  }
  body.response_of_rotation = 1.0 / least;
}

template <class Real>
void CoordinateArrays<Real>::bound_moves(const std::vector<AssembledForce<Real>>& forces,
                                         const std::vector<AssembledBody<Real>>& bodies,
                                         int dimension) {
  for (const AssembledForce<Real>& force : forces) {
    const double shortest = force.diagnosis->shortest_bond();
    if (!(shortest > 0.0)) continue;
    for (const std::size_t b : force.bodies) {
      const BodySlot<Real>& slot = bodies[b].bound.slot;
      if (slot.mapped) continue;
      for (std::size_t i = 0; i < slot.stride * dimension; ++i) {
        Real& limit = largest_move_[slot.offset + i];
        limit = std::min(limit, Real(0.5 * shortest));
      }
    }
  }
}

template <class Real>
void CoordinateArrays<Real>::scale_tolerances(const Scene& scene,
                                              const std::vector<AssembledBody<Real>>& bodies,
                                              const PrescribedBodies<Real>& prescribed,
                                              SystemView<Real>& view) {
  const NaturalUnits units = natural_units(scene);
  const Real per_length = Real(1.0 / units.length);
  const Real time = Real(units.time);
  tolerance_scale_.assign(size_of_tolerance_scales(view), per_length);
  Real* scales = tolerance_scale_.data();
  Real* velocity = scales + view.dofs;
  Real* in_units = velocity + view.dofs;
  Real* own = in_units + view.dofs;
  std::fill(velocity, in_units, per_length * time);
  std::fill(in_units, own, Real(1.0));
  std::fill(own, own + view.own, per_length * time);
  for (const AssembledBody<Real>& body : bodies) {
    for (std::size_t d = 3; body.rotor && d < 6; ++d) {
      const std::size_t at = body.bound.slot.centre + d;
      scales[at] = Real(1.0);
      in_units[at] = Real(units.length);
      velocity[at] = time;
    }
    if (!body.bound.slot.rigid || scene.dimension != 2) continue;
    const std::size_t at = body.bound.slot.centre + kRotation;
    scales[at] = tau<Real>();
    in_units[at] = tau<Real>() * Real(units.length);
    velocity[at] = tau<Real>() * time;
  }
  for (const auto& steered : prescribed.steered()) {
    for (int k = 0; k < 4; ++k) {
      if (steered.own[k] >= 0) own[steered.own[k]] = k < 3 ? per_length : tau<Real>();
    }
  }
  own[view.own] = Real(units.length);
  own[view.own + 1] = time;
  view.tolerance_scale = tolerance_scale_.data();
}

template <class Real>
void CoordinateArrays<Real>::place_fixed(const AssemblyPlan& plan,
                                         const std::vector<AssembledBody<Real>>& bodies,
                                         const Origin& origin) {
  for (const AssembledBody<Real>& body : bodies) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (!slot.mapped || slot.rigid || body.prescribed()) continue;
    const BodyGeometry& geometry = (*plan.geometry)[body.bound.index];
    for (int d = 0; d < plan.dimension(); ++d) {
      const double anchor = relative_to(origin, d, geometry.anchor[d]);
      for (std::size_t i = 0; i < slot.count; ++i) {
        mapped_position_[slot.offset + d * slot.stride + i] =
            Real(anchor + geometry.relative[i][d]);
      }
    }
  }
}

template class CoordinateArrays<double>;
template class CoordinateArrays<Quad>;

}  // namespace tomlin
