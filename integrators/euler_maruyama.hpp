#pragma once

#include "framework/core/records/registry.hpp"

/// The scheme of Euler and Maruyama for Langevin dynamics without inertia: the baseline.
///
///   x <- x + h F(x, t)/c + sqrt(2 T h/c) z,  z a normal number of each coordinate and step
///
/// Averages, and each path against the exact one (the noise does not depend on the position), are
/// of first order: a harmonic oscillator of relaxation rate lambda has the variance of positions
/// T/k / (1 - h lambda/2), which is warned of where it is wrong by a tenth. Drift and diffusion of
/// free particles are exact. Stable below h lambda = 2.
///
/// Positions are the state. The velocities that are written are F/c, without noise. Running
/// integrals: trapezoidal rule. Dense output: cubic Hermite.
///
/// For overdamped scenes. Refused: noise on rigid bodies whose friction is not centred on their
/// centre of mass. Without noise: Euler's scheme.
/// Source: G. Maruyama, Rend. Circ. Mat. Palermo 4 (1955) 48, doi:10.1007/BF02846028; P. E. Kloeden
/// and E. Platen, Numerical Solution of Stochastic Differential Equations (1992),
/// doi:10.1007/978-3-662-12616-5, section 9.1.
namespace tomlin {

IntegratorRecord euler_maruyama_record();

}  // namespace tomlin
