#pragma once

#include "framework/core/records/registry.hpp"

/// A splitting of second order that takes stiff bonds and friction exactly: neither limits the
/// step.
///
/// One step of h, with F the forces, K the bonds linearised about a body's shape and gamma its
/// friction rate, in the frame of each body:
///   v <- v + h1 phi (F + K u)/m       the kick: what the linear part leaves of all forces
///   exact flow of h of             u'' = -K u/m - gamma u', and of the frame
///   v <- v + h2 phi (F + K u)/m       the evaluation is the next step's first
/// u are the displacements from the shape. The frame moves with the centre of mass; in the plane it
/// turns with the body: from the least-squares rotation, at the angular momentum after the first
/// kick. What turning adds in the frame, the centrifugal and the Coriolis acceleration, stands
/// around the exact flow in two halves. For any fixed choice of frame and of K this is a symmetric
/// composition for the full equations, as the kick takes the difference: order 2. On a line bonds
/// are linear and the kick is free of them.
///
/// h1 + h2 = h, h/2 each without friction. With friction they are divided such that a steady force
/// drags at its terminal speed F/(m gamma), at every step's end and however strong the friction is,
/// and what rests under it has no velocity (modal_flow.hpp). Heat is that of the exact flow under
/// the forces at the start of the step.
///
/// phi = sin(h omega)/(h omega) of each mode of the bonds (1 for the motion as a whole) keeps kicks
/// from driving modes that turn several times in a step: no resonance at h omega = pi, 2 pi, ...,
/// and displacements stay within those at rest, which go as 1/K. A stiff ring goes to the rigid
/// one.
///
/// One evaluation per step. Stable up to h omega = 2 of all other forces, at any bonds and any
/// friction. Other running integrals: trapezoidal rule. Dense output: cubic Hermite, which does not
/// show vibrations faster than the step; from h gamma = 1 on its counterpart with friction.
///
/// In the plane the modes are those of a body's shape at the start. Bodies whose bonds do not
/// determine their shape are refused: chains, rings of springs between neighbours, what buckles.
/// Every few steps the shape is looked at: where bonds do more than their linear part, the kicks'
/// filter loses some of it, and a run fails when that is a hundredth of the forces on the body.
///
/// Refused: rigid bodies and bodies held along an axis; bonded bodies in space or of more than 256
/// coordinates (modes are a full matrix); friction that is not in proportion to the masses within
/// a body; forces that depend on velocity otherwise or have variables of their own; dynamics
/// without inertia; other number types than double.
/// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, doi:10.1007/3-540-30666-8,
/// sections XIII.1 and XIII.2; B. Garcia-Archilla, J. M. Sanz-Serna, R. D. Skeel, SIAM J. Sci.
/// Comput. 20 (1998) 930, doi:10.1137/S1064827596313851.
namespace tomlin {

IntegratorRecord exponential_verlet_record();

}  // namespace tomlin
