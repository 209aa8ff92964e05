#pragma once

#include "framework/core/records/registry.hpp"

/// The explicit midpoint scheme of second order, fixed step: the baseline of the explicit schemes.
///
/// For x' = v, v' = a(t, x, v):
///   x_2 = x + h/2 v,  v_2 = v + h/2 a(t, x, v)
///   x <- x + h v_2
///   v <- v + h a(t + h/2, x_2, v_2)
/// All explicit schemes of second order with two evaluations share one stability region; of them
/// the midpoint rule integrates what runs along (mean forces, work) with half the error of Heun's
/// trapezoidal rule, from one set of rates.
///
/// Order 2 for any smooth force, velocity-dependent ones included; two evaluations per step; stable
/// on the negative real axis to 2. No stretch of the imaginary axis is: an undamped oscillation
/// grows by the factor 1 + (h omega)^4/8 in a step, so scenes need friction.
/// Running integrals: midpoint rule. Dense output: cubic Hermite, error O(h^4), below the scheme's.
/// Source: C. Runge, Math. Ann. 46 (1895) 167, doi:10.1007/BF01446807; Hairer, Norsett, Wanner,
/// Solving Ordinary Differential Equations I, doi:10.1007/978-3-540-78862-1, section II.1.
namespace tomlin {

IntegratorRecord midpoint_record();

}  // namespace tomlin
