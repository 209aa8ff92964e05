#pragma once

#include "framework/core/numbers/math.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

/// The angle of the vector (x, y) in turns, within (-1/2, 1/2]; 0 for the null vector. Two steps
/// of refinement on a rough guess, with the same bits everywhere (libm's atan2 has not).
inline double angle_turns(double y, double x) {
  const double ax = abs(x);
  const double ay = abs(y);
  const double large = max(ax, ay);
  if (!(large > 0.0)) return 0.0;
  // A guess to 1e-3: atan(t) ~ t / (1 + 0.28 t^2) within the first octant.
  const double t = min(ax, ay) / large;
  double turns = t / (1.0 + 0.28 * t * t) * 0.15915494309189535;
  if (ay > ax) turns = 0.25 - turns;
  if (x < 0.0) turns = 0.5 - turns;
  if (y < 0.0) turns = -turns;
  for (int pass = 0; pass < 3; ++pass) {
    double s;
    double c;
    sincos_turns(turns, s, c);
    // tan of what is missing; its cube settles the rest.
    const double missing = fma(y, c, -(x * s)) / fma(x, c, y * s);
    turns = turns + (missing - missing * missing * missing / 3.0) * 0.15915494309189535;
  }
  return turns > 0.5 ? turns - 1.0 : (turns <= -0.5 ? turns + 1.0 : turns);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
