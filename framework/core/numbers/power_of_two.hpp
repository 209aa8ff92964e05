#pragma once

#include <cmath>

namespace tomlin {

/// The power of two next above a positive number: a unit in which it is a pure number, to be taken
/// out before a root is, so that the same in other units has the same bits.
inline double power_of_two_above(double x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, exponent);
}

}  // namespace tomlin
