#pragma once

#include <cstdint>

#include "framework/core/records/integrator.hpp"

/// Follows the equilibrium of a scene as its drivers move: dynamics without inertia and without
/// friction, the limit of slow driving.
///
///   F(q, t) = 0, stable: K = -dF/dq positive definite (but for zero modes)
///
/// The pairs (q, t) form a curve, smooth also where it turns back in time: there, at a fold, the
/// equilibrium ends. A step goes along the tangent and corrects five points of it by Newton's
/// method on planes across the tangent (pseudo-arclength, Keller). Between them goes Hermite's
/// polynomial of degree 9, and running integrals are taken along the curve, int F (dt/ds) ds, by
/// Clenshaw and Curtis' rule of nine points: both keep their order right up to the fold. The error
/// of a step is a hundredth of how far the last point lies from where the ones before it foretell
/// it.
///
/// Where the curve turns back in time, or K gets a negative eigenvalue (a bifurcation), the scene
/// slips: from a first displacement along the way of instability it follows G dq/dt = F(q) at a
/// fixed position of the drivers, with its own friction matrix G if that reaches all coordinates,
/// else with one in proportion to mass, until it rests. The energy lost is that before less that
/// after. The start of a run is relaxed in the same way, and is no slip. If it rests where it is
/// unstable it is displaced by 1e-4 of the allowed move of a coordinate, along the way that the
/// drivers are going to push it, with a thousandth of that in random directions (always the same).
///
/// Where stability is lost at a bifurcation the scene goes to the side that the force along the
/// direction of instability points to, also where that is as small as 1e-14 of the typical
/// stiffness. Below that rounding would decide: both sides are tried, and if they lead to different
/// equilibria it is a tie. Then the scene takes the side to which friction points when its drivers
/// move slowly. The same is said of an unstable rest from which only the random part of a
/// displacement leads away.
///
/// A disturbed run follows the equilibrium under a small steady force besides, which is random but
/// the same in all of the run: F(q, t) + f = 0. It would displace the run's first equilibrium by
/// about the disturbance, and leaves a symmetric instability, or a nearly symmetric one, to the
/// side that it prefers. Rates and energies are those without it. Scenes with
/// free rotations have no such force, so that only exact ties are resolved to both sides there.
///
/// Zero modes (curvature below 1e-12 of a typical one) stay as they are: the
/// scene does not move along them.
/// Source: H. B. Keller (1977); E. L. Allgower and K. Georg, Introduction to Numerical Continuation
/// Methods, SIAM (2003), doi:10.1137/1.9780898719154.
namespace tomlin {

struct ContinuationDescription {
  double tolerance = 0.0;
  double largest_step = 0.0;
  std::int64_t most_steps = 0;
};

IntegratorRecord continuation_record();

}  // namespace tomlin
