#pragma once

#include "framework/core/records/registry.hpp"

/// The BAOAB splitting of Langevin dynamics: friction and noise by their exact flow in the middle
/// of a velocity Verlet step.
///
/// One step of h, with forces F that do not depend on velocities:
///   v <- v + h/2 F(x, t)/m                      B
///   x <- x + h/2 v                              A
///   friction and noise, exactly, over h         O    (framework/model/friction_kernels.hpp)
///   x <- x + h/2 v                              A
///   v <- v + h/2 F(x, t + h)/m                  B    the evaluation is the next step's first
///
/// Of a harmonic oscillator of angular frequency omega the positions have exactly the variance
/// T/(m omega^2), and the velocities before and after O exactly T/m; those at the ends of steps
/// have T/m (1 - (h omega)^2/4). Averages of positions in other potentials are of fourth order
/// where friction is strong, else of second. A free particle diffuses, and a dragged one drifts,
/// faster than is right by (h gamma/2) coth(h gamma/2) - 1, gamma = c/m: 0.08 at h gamma = 1. `gjf`
/// has both exact. Without noise of second order, and symmetric; the heat is exact.
///
/// One evaluation a step. Stable up to h omega = 2 at any friction. Running integrals: trapezoidal
/// rule. Dense output: cubic Hermite.
///
/// Refused: forces that depend on velocity but are neither linear friction nor hand out an
/// operator, forces with variables of their own that hand out none, dynamics without inertia.
/// Source: B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34,
/// doi:10.1093/amrx/abs010.
namespace tomlin {

IntegratorRecord baoab_record();

}  // namespace tomlin
