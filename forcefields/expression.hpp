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
/// t. Forces and second derivatives are exact: the formula is differentiated, not its values.
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
