#pragma once

#include "framework/core/records/registry.hpp"

/// Friction and the noise of its bath: the Langevin thermostat.
///
///   F = -c v + sqrt(2 c T) xi(t),  <xi_i(t) xi_j(t')> = delta_ij delta(t - t'), per particle, axis
///
///   c  coefficient  mass/time, per particle (not the rate c/m), as of viscous_damping
///   T  temperature  an energy: Boltzmann's constant times the temperature
///
/// One operator with the friction of other forces on the body (framework/model/
/// friction_kernels.hpp): with inertia velocities are an Ornstein-Uhlenbeck process; a rigid body's
/// centre and rotation get the same temperature by virtual work. Without inertia schemes displace
/// coordinates by sqrt(2 T h/c) times normal numbers. Other friction on the body belongs to a bath
/// of temperature 0. Random numbers depend on the scene's seed and stream, the force's name, and
/// the step: the same bits on every instruction set and after every resumption.
///
/// With temperature 0 it is viscous_damping, and any integrator takes it; else those for noise
/// alone. One thermostat for each body; its particles need one temperature where it is rigid.
/// Source: P. Langevin, C. R. Acad. Sci. (Paris) 146 (1908) 530; R. Kubo, Rep. Prog. Phys. 29
/// (1966) 255, doi:10.1088/0034-4885/29/1/306, the fluctuation-dissipation theorem.
namespace tomlin {

ForceRecord langevin_record();

}  // namespace tomlin
