#pragma once

#include "framework/core/records/registry.hpp"

/// The classical Runge-Kutta scheme of fourth order, fixed step.
///
/// For x' = v, v' = a(t, x, v), with v_1 = v, a_s = a(t + c_s h, x_s, v_s):
///   x_2 = x + h/2 v,    v_2 = v + h/2 a_1
///   x_3 = x + h/2 v_2,  v_3 = v + h/2 a_2
///   x_4 = x + h v_3,    v_4 = v + h a_3
///   x <- x + h v + h^2/6 (a_1 + a_2 + a_3)
///   v <- v + h/6 (a_1 + 2 a_2 + 2 a_3 + a_4)
/// which is the usual tableau with the stage velocities written out.
///
/// Order 4 for any smooth force, velocity-dependent ones included; four evaluations per step;
/// stable on the imaginary axis up to h omega = 2 sqrt(2), on the negative real axis to 2.785.
/// Running integrals get the same weights. Dense output: cubic Hermite, error O(h^4).
/// Source: W. Kutta (1901); Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
/// doi:10.1007/978-3-540-78862-1, section II.1.
namespace tomlin {

IntegratorRecord rk4_record();

}  // namespace tomlin
