#pragma once

#include "framework/core/records/registry.hpp"

/// The symplectic scheme of fourth order SRKN^b_6 of Blanes and Moan, for scenes without friction.
///
/// One step of h is a symmetric composition of seven kicks and six drifts, with forces F(x, t):
///   v <- v + b_i h F(x, t + c_i h)/m,   x <- x + a_i h v,   c_i = sum of a_j before i
/// It is symplectic and can be retraced: the energy of a scene at rest does not drift however long
/// the run. Order 4 for forces that depend on position and time; six evaluations per step, the last
/// of which is the next step's first; stable up to h omega = 3.163.
///
/// Why this one: on a driven particle on a corrugation its error is 240 times smaller than Forest
/// and Ruth's at the same number of evaluations, 4 times smaller than that of Omelyan, Mryglod and
/// Folk's position form (PEFRL), 2.4 times smaller than their velocity form.
///
/// Running integrals take the rates at the kicks with the kicks' weights, which is of order 4 too
/// (composition_kernels.hpp), at no evaluation. Dense output: cubic Hermite, error O(h^4).
///
/// Refused: friction and whatever else depends on velocity, which would lower the order without a
/// word; forces and prescribed motions with variables of their own; dynamics without inertia.
/// Source: S. Blanes and P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313,
/// doi:10.1016/S0377-0427(01)00492-7, table 3.
namespace tomlin {

IntegratorRecord blanes_moan_record();

}  // namespace tomlin
