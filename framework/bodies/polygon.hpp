#pragma once

#include "framework/core/records/body.hpp"

/// Particles along the edges of a regular polygon in the x-y plane, one at each corner, and equally
/// spaced. With c corners X_k = radius (cos(2 pi k/c), sin(2 pi k/c)) and m = count/c particles an
/// edge,
///
///   x_{km+j} = centre + R(orientation) ((m - j) X_k + j X_{k+1}) / m,   k = 0 .. c - 1, j = 0 .. m
///   - 1
///
/// A polygon with a particle at each corner alone has those of a ring. With equal masses its centre
/// is the centre of mass for every count. One turn without sliding advances it by the perimeter,
/// 2 c radius sin(pi/c): see framework/bodies/outline.hpp for what rolling means then.
namespace tomlin {

struct PolygonDescription : BodyDescription {
  std::int64_t corners = 0;
  std::int64_t count = 0;
  double radius = 0.0;  ///< of the circumscribed circle
  SpaceVector centre;
  double orientation = 0.0;  ///< of the first corner against x, rad, counter-clockwise
};

BodyRecord polygon_record();

}  // namespace tomlin
