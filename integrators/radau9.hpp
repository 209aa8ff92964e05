#pragma once

#include "framework/core/records/registry.hpp"

/// The five-stage Radau IIA scheme of order 9, implicit and L-stable, with step control and dense
/// output: for motion that is slow beside its own relaxation, where an explicit scheme steps as far
/// as it is stable and no further.
///
///   Y_i = y + h sum_j a_ij f(t + c_j h, Y_j),   i = 1 ... 5;   y(t + h) = Y_5
///   M dq'/dt = F(q, q', t)                      with inertia: y = (q, q')
///   G q' = F(q, t)                              without: y = q
///
/// Solved by simplified Newton iterations. The matrix of all stages falls apart into the modes of
/// a^-1, one real and two pairs of complex ones mu; eliminating the velocities leaves
///   (mu/h)^2 M + (mu/h) G + K
/// for each, K and G being the stiffness and friction of the forces
/// (framework/core/system/tangent.hpp), exact and taken anew for each attempt at three quarters of
/// the step, where the last step's polynomial leads. That polynomial is the first guess, too.
/// Iterations end when what is left, by their rate of convergence, is below 1 % of the tolerance.
///
/// A step is accepted when
///   err = sqrt(mean_i (e_i / (absolute_tolerance + relative_tolerance * max(|y0_i|, |y1_i|)))^2)
/// over all coordinates and velocities is at most 1, e being the difference to an embedded scheme
/// of order 5, damped in stiff modes by the real mode's matrix; positions relative to the scene's
/// origin, velocities times the scene's time, angles in rad times its length. The next step follows
/// from this error and the last one's (Gustafsson's predictive controller), with safety factor
/// 0.75, from 0.2 to 4 times as long.
///
/// Running integrals are quadratures of order 9. Where a scene slides smoothly and slowly, a
/// driver's mean force is what is left of large parts that cancel, and so is its work: what
/// friction dissipates. Errors of both are held against that, step by step: against the tolerance
/// times the larger of what is dissipated in the step and what it would be if all moved with the
/// driver. The error is estimated from how fast the polynomial through the six known values of a
/// rate falls off (its parts along P_2 to P_5), iterations go on until the integrals no longer
/// change by more than a tenth of that, and errors that are rounding of coordinates are let pass
/// and added up. Where these are more than 1e-4 of the work the run warns.
///
/// Cost: five evaluations an iteration, two or three iterations a step, and one evaluation and
/// Tangent::columns() for K and G. Order 9 where the motion is smooth on the scale of a step; in
/// stiff modes 5 or 6 (stage order 5). Where forces are not linear, a tolerance wider than the
/// motion leaves iterations, and integrals with them, unfinished. Stable for every step that is
/// stable in truth; modes much faster than a step are at rest after it. Dense output: the
/// collocation polynomial, error O(h^6) within a step. Stiff bonds that turn while the body rolls
/// keep steps short through the iterations (about stiffness^(-0.3)): coordinates = "rigid" is the
/// better way to those. Needs forces with known derivatives, in double. Refused: forces that depend
/// on velocity and are not linear friction, forces with variables of their own, more than 600
/// coordinates in which each meets each (chains may be as long as one likes).
///
/// Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II,
/// doi:10.1007/978-3-642-05221-7, sections IV.5 and IV.8; E. Hairer and G. Wanner, J. Comput. Appl.
/// Math. 111 (1999) 93, doi:10.1016/S0377-0427(99)00134-X.
namespace tomlin {

IntegratorRecord radau9_record();

}  // namespace tomlin
