#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

/// What the parts of the run loop share.
namespace tomlin::engine_parts {

inline constexpr double kTau = 6.283185307179586476925286766559;
/// A remainder of the run below this part of a step is no step.
inline constexpr double kNoStep = 1e-9;
/// Steps between looks at the origin, at rotations and at signals. A particle moves less than a
/// period in a step, so the origin is never left far behind.
inline constexpr std::int64_t kHousekeepingEvery = 16;

inline double norm(const std::vector<double>& v) {
  double squares = 0.0;
  for (const double x : v) squares = std::fma(x, x, squares);
  return std::sqrt(squares);
}

}  // namespace tomlin::engine_parts
