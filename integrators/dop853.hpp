#pragma once

#include "framework/core/records/registry.hpp"

/// The embedded Runge-Kutta pair 8(5,3) of Dormand and Prince, as Hairer, Norsett and Wanner have
/// it: for tight tolerances.
///
/// Twelve stages and one evaluation at the end of an accepted step, which is the next one's first:
/// twelve evaluations per accepted step, eleven per refused one. The eighth-order solution is
/// carried on. With the weighted norms (dopri5.hpp) e5 and e3 of its differences to embedded
/// solutions of order 5 and 3, a step is accepted when
///   err = e5^2 / sqrt(e5^2 + 0.01 e3^2)
/// is at most 1, which falls as h^8. The next step is
///   h <- h * clip(0.9 err^(-1/8), 1/3, 6).
///
/// Order 8 for any smooth force, velocity-dependent ones included. Stable on the negative real axis
/// to 6.39. Dense output: the continuous extension of order 7, three evaluations more in a step
/// that is looked into. Extremes between the ends of steps come from stages, error O(h^6), at none.
/// Quadruple numbers: conditions of order hold to 1e-27.
/// Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
/// doi:10.1007/978-3-540-78862-1, sections II.5, II.6 and II.10, with the code dop853;
/// P. J. Prince and J. R. Dormand, J. Comput. Appl. Math. 7 (1981) 67,
/// doi:10.1016/0771-050X(81)90010-3.
namespace tomlin {

IntegratorRecord dop853_record();

}  // namespace tomlin
