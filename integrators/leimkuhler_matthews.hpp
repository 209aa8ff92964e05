#pragma once

#include "framework/core/records/registry.hpp"

/// The scheme of Leimkuhler and Matthews for Langevin dynamics without inertia: the limit of BAOAB
/// for strong friction.
///
///   x_n+1 = x_n + h F(x_n, t_n)/c + sqrt(2 T h/c) (z_n + z_n+1)/2
///
/// with normal numbers z_n of each coordinate and step, each used twice. Averages of positions at
/// rest are of second order, of a harmonic oscillator exact: T/k; with a current, as on a tilted
/// washboard, of first order (scenarios/thermal). Drift and diffusion of free particles are exact.
/// One evaluation a step; stable up to h lambda = 2, lambda the largest relaxation rate.
///
/// Positions are the state. The velocities that are written are F/c, without noise. Running
/// integrals: trapezoidal rule. Dense output: cubic Hermite.
///
/// For overdamped scenes. Refused: noise on rigid bodies whose friction is not centred on their
/// centre of mass. Without noise: Euler's scheme.
/// Source: B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34,
/// doi:10.1093/amrx/abs010; B. Leimkuhler, C. Matthews and M. V. Tretyakov, Proc. R. Soc. A 470
/// (2014) 20140120, doi:10.1098/rspa.2014.0120.
namespace tomlin {

IntegratorRecord leimkuhler_matthews_record();

}  // namespace tomlin
