#pragma once

#include "framework/core/records/registry.hpp"

/// The velocity Verlet scheme, of second order, with friction and all that forces hand out as
/// operators (framework/core/system/flow.hpp).
///
/// One step of h, with forces F that do not depend on velocities and friction G:
///   v <- exp(-h/2 G/m) v            the exact flow of friction alone
///   v <- v + h/2 F(x, t)/m
///   x <- x + h v
///   v <- v + h/2 F(x, t + h)/m      the evaluation is the next step's first
///   v <- exp(-h/2 G/m) v
/// The composition is symmetric, hence of second order with friction too; without friction it is
/// symplectic, and the energy error stays bounded. One evaluation per step; stable up to h omega =
/// 2 at any friction. (A kick with the friction of the old velocity, the common shortcut, is of
/// first order.) Running integrals: trapezoidal rule; the operators' heat is theirs, exact. Dense
/// output: cubic Hermite.
///
/// Friction far stronger than inertia, c h/m >> 1, is stable but not accurate: between kicks the
/// velocity has died out. Overdamped dynamics, or a smaller h, is for that.
///
/// Refused: forces that depend on velocity but are neither linear friction nor hand out an
/// operator, forces with variables of their own that hand out none, dynamics without inertia.
/// Source: Swope, Andersen, Berens, Wilson, J. Chem. Phys. 76 (1982) 637, doi:10.1063/1.442716;
/// splitting: Leimkuhler and Matthews, Molecular Dynamics, doi:10.1007/978-3-319-16375-8,
/// chapter 7.
namespace tomlin {

IntegratorRecord velocity_verlet_record();

}  // namespace tomlin
