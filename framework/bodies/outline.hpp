#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/body.hpp"

/// Common parts of bodies in the x-y plane: their angle to the axes, and closed outlines.
///
/// A closed outline of perimeter P rolls without sliding over a plane when its point of contact
/// moves along the plane as it moves along the outline, so that one turn advances the body by P. A
/// body's rolling radius is therefore P / (2 pi), and `rolling`, -R dphi/dx over a window, is 1
/// where it rolls without sliding through whole turns. Within a turn a body that is not round rolls
/// unevenly, and its centre rises and sinks by the difference of the largest and the smallest
/// distance of the outline from it; this is no hop.
namespace tomlin {

using PlanePoint = std::array<double, 2>;

/// Range of angles in the plane, in rad: a turn either way, over which they keep their digits.
inline constexpr Interval kWithinOneTurn{
    .low = -kTau, .high = kTau, .low_open = false, .high_open = false};

/// A fault where a scene has no plane; `body` is "an ellipse", say.
std::vector<Complaint> complaints_without_plane(const char* body, int dimension);

/// Particles at these points of the plane, turned counter-clockwise by `angle` (rad) about the
/// origin and moved to `centre`. Without an angle they keep their bits.
BodyGeometry placed_in_plane(const std::vector<PlanePoint>& points, double angle,
                             const SpaceVector& centre, int dimension);

/// The distance of two points of as many coordinates, of any size.
double distance_between(const std::vector<double>& one, const std::vector<double>& other);

/// Makes a body roll along the polygon through its particles, in their order.
void roll_along_particles(BodyGeometry& geometry);

/// A scene in which a rigid body with these lines rolls over a corrugated substrate.
std::string rolling_example(const std::string& comment, const std::string& body);

/// The record of a body of `count` particles along a closed outline about `centre`, members of its
/// description; but for its texts, `complaints` and `build`.
template <class D>
BodyRecord closed_body_record(std::vector<Parameter> own) {
  BodyRecord record = body_record<D>(std::move(own));
  record.dimension = [](const void* description) {
    return static_cast<int>(static_cast<const D*>(description)->centre.components.size());
  };
  record.count = [](const void* description) -> std::int64_t {
    return static_cast<const D*>(description)->count;
  };
  record.ends = [](const void*, int) { return BodyEnds{.closed = true}; };
  return record;
}

}  // namespace tomlin
