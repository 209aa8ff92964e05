#pragma once

#include <deque>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/assembled_forces.hpp"
#include "framework/model/prescribed_bodies.hpp"

namespace tomlin {

/// Arrays over all coordinates of a scene: inverse masses, how far they may move in one step, what
/// their errors are held against, and the arrays that one evaluation of the forces writes.
template <class Real>
class CoordinateArrays {
 public:
  /// Masses and limits; what is held has no inverse mass. The view gets the arrays, the bodies how
  /// they respond.
  CoordinateArrays(const AssemblyPlan& plan, AssembledBodies<Real>& bodies, SystemView<Real>& view);
  CoordinateArrays(const CoordinateArrays&) = delete;
  CoordinateArrays& operator=(const CoordinateArrays&) = delete;

  /// A bond may not turn over in one step: half the shortest bond of a body bounds its particles.
  void bound_moves(const std::vector<AssembledForce<Real>>& forces,
                   const std::vector<AssembledBody<Real>>& bodies, int dimension);
  /// Errors are held against the scene's own length and time: see
  /// framework/core/system/tolerance.hpp.
  void scale_tolerances(const Scene& scene, const std::vector<AssembledBody<Real>>& bodies,
                        const PrescribedBodies<Real>& prescribed, SystemView<Real>& view);
  /// Places what never moves, relative to an origin.
  void place_fixed(const AssemblyPlan& plan, const std::vector<AssembledBody<Real>>& bodies,
                   const Origin& origin);

  AlignedVector<Real> inverse_mass;

 private:
  void place_rotor(AssembledBody<Real>& body);

  AlignedVector<Real> largest_move_;
  AlignedVector<Real> tolerance_scale_;
  AlignedVector<Real> force_;
  AlignedVector<Real> mapped_position_;
  AlignedVector<Real> mapped_velocity_;
  AlignedVector<Real> mapped_force_;
};

}  // namespace tomlin
