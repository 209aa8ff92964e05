#pragma once

#include "framework/core/records/registry.hpp"

/// The embedded Runge-Kutta pair 5(4) of Dormand and Prince, with step control and dense output.
///
/// Seven stages, the last of which is the next step's first (six evaluations per accepted step).
/// The fifth-order solution is carried on. A step is accepted when
///   err = sqrt(mean_i (e_i / (absolute_tolerance + relative_tolerance * max(|y0_i|, |y1_i|)))^2)
/// over all coordinates, velocities and variables that forces own is at most 1, e being the
/// difference to the fourth-order solution, positions relative to the scene's origin. Velocities
/// count times the scene's time, angles in rad times its length (natural_units.hpp), so that a
/// scene in other units takes the same steps. The next step is
///   h <- h * clip(0.9 err^(-0.17) err_old^0.04, 0.2, 10)     (a PI controller).
/// Running integrals get the weights of the fifth-order solution but no say in the error.
///
/// Order 5 for any smooth force, velocity-dependent ones included. Stable on the negative real
/// axis to 3.3. Dense output: the continuous extension of order 4.
/// Source: J. R. Dormand and P. J. Prince (1980), doi:10.1016/0771-050X(80)90013-3; control and
/// dense output: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
/// doi:10.1007/978-3-540-78862-1, sections II.4 to II.6.
namespace tomlin {

IntegratorRecord dopri5_record();

}  // namespace tomlin
