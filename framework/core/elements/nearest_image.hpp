#pragma once

#include "framework/core/numbers/inverse_trigonometry.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

/// The way to the nearest image in a periodic box of this length, or of a length for each lane.
template <class T, class Real>
TOMLIN_INLINE T nearest_image(const T& apart, const Real& box) {
  return apart - T(box) * floor(apart / T(box) + T(Scalar<T>(0.5)));
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
