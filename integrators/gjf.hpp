#pragma once

#include "framework/core/records/registry.hpp"

/// The scheme of Gronbech-Jensen and Farago for Langevin dynamics: drift and diffusion are exact at
/// any step.
///
/// With b = 1/(1 + h gamma/2), a = (1 - h gamma/2) b, gamma = c/m, and a normal number z:
///   x <- x + b h v + b h^2/(2m) F(x, t) + b h/(2m) beta,   beta = sqrt(2 c T h) z
///   v <- a v + h/(2m) (a F(x, t) + F(x', t + h)) + b/m beta
/// taken as the splitting that it is: kick h/2, drift h/2, v <- a v + b/m beta, drift h/2, kick
/// h/2; baoab with friction by the implicit midpoint rule. The evaluation at the end is the next
/// step's first. Bodies that move as one take their friction matrix by the same rule.
///
/// Of a free particle the diffusion coefficient T/c and of a dragged one the drift F/c are exact;
/// of a harmonic oscillator the variance of positions, T/(m omega^2). Velocities before and after
/// the middle of a step have exactly T/m, those at the ends of steps T/m (1 - (h omega)^2/4). All
/// for any h gamma, and h omega below 2. Correlations in time are of second order: at h gamma > 2
/// velocities change their sign from step to step (a < 0). Nothing that is reported is wrong by
/// that: the displacements after a velocity v add up to h v (1 + a)/(2 (1 - a)) = v/gamma, as is
/// right, and means, variances and heat follow from displacements and from velocities of one time.
///
/// One evaluation a step. Running integrals: trapezoidal rule. Dense output: cubic Hermite.
///
/// Refused: what baoab refuses.
/// Source: N. Gronbech-Jensen and O. Farago, Mol. Phys. 111 (2013) 983,
/// doi:10.1080/00268976.2012.760055.
namespace tomlin {

IntegratorRecord gjf_record();

}  // namespace tomlin
