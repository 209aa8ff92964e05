#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "framework/model/model.hpp"

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

/// Of a body's particles, from its centre.
inline double reach_of(const Model::Body& body) {
  double reach = 0.0;
  for (const auto& arm : body.arms) reach = std::max(reach, norm(arm));
  return reach;
}

/// The fastest that any particle of a prescribed body is along its way, looked at now and then.
inline double fastest_of(const Model::Body& body, double duration) {
  constexpr int kLooks = 1000;
  const double reach = reach_of(body);
  double fastest = 0.0;
  for (int k = 0; k <= kLooks; ++k) {
    const double at = duration * k / kLooks;
    double speed = reach * std::abs(body.motion->angular_velocity(at));
    for (const TimeFunction& function : body.motion->velocity) speed += std::abs(function(at));
    if (std::isfinite(speed)) fastest = std::max(fastest, speed);
  }
  return fastest;
}

}  // namespace tomlin::engine_parts
