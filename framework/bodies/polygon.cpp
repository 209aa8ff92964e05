#include "framework/bodies/polygon.hpp"

#include <cstddef>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = PolygonDescription;

std::vector<Complaint> complaints(const Description& d, int dimension) {
  std::vector<Complaint> found = complaints_without_plane("a polygon", dimension);
  if (d.count % d.corners != 0) {
    const std::int64_t below = d.count / d.corners * d.corners;
    const std::string nearest = below > 0 ? fmt::format("{} or {}", below, below + d.corners)
                                          : fmt::format("{}", d.corners);
    found.push_back({.key = "count",
                     .why = fmt::format("no multiple of the {} corners", d.corners),
                     .admissible = nearest + " or another multiple",
                     .code = FaultCode::scene_wrong_count});
  }
  return found;
}

PlanePoint corner(const Description& d, std::int64_t k) {
  double sine = 0.0;
  double cosine = 1.0;
  sincos_turns(static_cast<double>(k % d.corners) / static_cast<double>(d.corners), sine, cosine);
  return {d.radius * cosine, d.radius * sine};
}

BodyGeometry build(const Description& d, int dimension) {
  const std::int64_t on_edge = d.count / d.corners;
  std::vector<PlanePoint> points;
  points.reserve(static_cast<std::size_t>(d.count));
  for (std::int64_t k = 0; k < d.corners; ++k) {
    const PlanePoint from = corner(d, k);
    const PlanePoint to = corner(d, k + 1);
    for (std::int64_t j = 0; j < on_edge; ++j) {
      const double part = static_cast<double>(j) / static_cast<double>(on_edge);
      const double rest = static_cast<double>(on_edge - j) / static_cast<double>(on_edge);
      points.push_back({fma(rest, from[0], part * to[0]), fma(rest, from[1], part * to[1])});
    }
  }
  BodyGeometry geometry = placed_in_plane(points, d.orientation, d.centre, dimension);
  double sine = 0.0;
  double cosine = 1.0;
  const auto corners = static_cast<double>(d.corners);
  sincos_turns(0.5 / corners, sine, cosine);
  geometry.rolling_radius = d.radius * (2.0 * corners * sine / kTau);
  geometry.rolling_rise = d.radius * (1.0 - cosine);
  return geometry;
}

}  // namespace

BodyRecord polygon_record() {
  constexpr Interval kCorners{.low = 3.0, .low_open = false};
  auto record = closed_body_record<Description>(
      {parameter("corners", &Description::corners, dimension::none, "number of corners")
           .in(kCorners),
       parameter("count", &Description::count, dimension::none,
                 "number of particles, a multiple of corners: one at each corner, the others "
                 "equally spaced along the edges")
           .in(positive),
       parameter("radius", &Description::radius, dimension::length, "of the circumscribed circle")
           .in(positive),
       parameter("centre", &Description::centre, dimension::length, "of the polygon"),
       parameter("orientation", &Description::orientation, dimension::none,
                 "angle from x to the first corner, in rad, counter-clockwise")
           .in(kWithinOneTurn)
           .by_default(0.0)});
  record.name = "polygon";
  record.summary =
      "particles along the edges of a regular polygon in the x-y plane; rolls by its perimeter per "
      "revolution";
  record.equation =
      "x_{km+j} = centre + R(orientation) ((m - j) X_k + j X_{k+1}) / m, corners X_k = radius "
      "(cos(2 "
      "pi k/corners), sin(2 pi k/corners)), m = count/corners";
  record.source = "H. S. M. Coxeter, Regular Polytopes (Dover, 1973), ISBN 978-0-486-61480-9";
  record.complaints = of_description<&complaints>;
  record.build = of_description<&build>;
  record.example =
      rolling_example("A rigid hexagon pulled over a corrugated substrate.", R"(type = "polygon"
corners = 6
count = 12
radius = 1.0
centre = [0.0, 1.0]
)");
  return record;
}

}  // namespace tomlin
