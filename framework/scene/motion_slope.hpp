#pragma once

#include "framework/scene/motion.hpp"

namespace tomlin {

/// The derivative of a number that may change with time, exactly; that of the piece which t is on
/// where there is a kink or a jump (abs, min, max, floor, sign, step). NaN where it has no finite
/// value.
double slope_of(const TimeFunction& function, double t);

/// Whether the body is ever accelerated.
inline bool accelerates(const Motion& motion) {
  for (const TimeFunction& function : motion.velocity) {
    if (!function.is_constant()) return true;
  }
  return !motion.angular_velocity.is_constant();
}

}  // namespace tomlin
