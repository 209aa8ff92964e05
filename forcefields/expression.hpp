#pragma once

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/registry.hpp"

/// A force given as a formula in the scene.
///
///   energy = "V0/N * exp(-lambda/R * y^2) * cos(2*pi*x/a)"    V of one element; F = -dV/dx
///   force  = ["-k * x", "-k * y - xi * vy"]                    or the force itself, per particle
///
/// What the energy names tells what it is over, and it is summed over all of these:
///
///   x, y, z      each particle of the body
///   xc, yc, zc   the centre of mass of the body, once; shared out by mass
///   r            each pair: of the body ("all", "neighbours" or a list), or between two bodies
///   theta        each angle between neighbouring bonds, 0 to pi
///
/// each also over the time t and the scene's parameters. A `force` is over x, y, z, vx, vy, vz and
/// t. An energy of particles and a `force` may differ between the particles of the body:
///
///   energy = "V0 * (1 + 0.2*normal(7, i)) * cos(2*pi*(x/a + random(3, i)))"
///
/// is over the index i of the particle (0 to count - 1) and the count of particles, unless these
/// are parameters of the scene, and over random(seed, n) and normal(seed, n), whose arguments may
/// not depend on positions, velocities or the time. What follows from i alone is computed once, in
/// double precision, and is a number of the particle from then on: quenched disorder. Forces and
/// second derivatives are exact: the formula is differentiated, not its values.
///
/// Conventions: angles in radians; a pair's energy counts once; positions are the scene's own,
/// however far away. With a declared period they are reduced to it first, and keep their digits.
/// Valid where the formula and its derivatives are finite: elsewhere the run does not start, or
/// fails, with the formula, the column and the particle. At a kink (abs, min, max, floor, sign,
/// step) the derivative is that of one side. An energy that changes with time does work, and the
/// ledger counts it so; what a `force` does is heat taken out (negative where energy is put in).
namespace tomlin {

struct ExpressionDescription {
  Formula energy;
  FormulaList force;
  PairSelection pairs{.kind = PairSelection::Kind::all, .list = {}};
  AngleSelection angles;
  WordOrNumbers period;
};

ForceRecord expression_record();

}  // namespace tomlin
