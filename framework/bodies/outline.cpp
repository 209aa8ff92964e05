#include "framework/bodies/outline.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Point = std::vector<double>;

double norm(const Point& x) {
  double largest = 0.0;
  for (const double component : x) largest = std::max(largest, abs(component));
  if (!(largest > 0.0)) return 0.0;
  double square = 0.0;
  for (const double component : x) {
    const double share = component / largest;
    square = fma(share, share, square);
  }
  return largest * sqrt(square);
}

Point difference(const Point& one, const Point& other) {
  Point result(one.size());
  for (std::size_t d = 0; d < one.size(); ++d) result[d] = one[d] - other[d];
  return result;
}

/// From a point to the nearest one between `from` and `to`, which differ.
double distance_from_edge(const Point& point, const Point& from, const Point& to) {
  const double length = distance_between(from, to);
  double along = 0.0;
  for (std::size_t d = 0; d < point.size(); ++d) {
    along = fma((point[d] - from[d]) / length, (to[d] - from[d]) / length, along);
  }
  along = std::clamp(along, 0.0, 1.0);
  Point nearest(point.size());
  for (std::size_t d = 0; d < point.size(); ++d) {
    nearest[d] = fma(along, to[d] - from[d], from[d]);
  }
  return distance_between(point, nearest);
}

}  // namespace

std::string rolling_example(const std::string& comment, const std::string& body) {
  return "# " + comment + "\n[[body]]\n" + body + R"(particle_mass = 0.125
coordinates = "rigid"

[[force]]
type = "driving_spring"
stiffness = 2.0
velocity = [0.1, 0.0]

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.0125
period = 1.0
decay = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
}

std::vector<Complaint> complaints_without_plane(const char* body, int dimension) {
  if (dimension >= 2) return {};
  return {{.key = "centre",
           .why = fmt::format("{} needs two dimensions", body),
           .admissible = "two or three coordinates",
           .code = FaultCode::scene_wrong_count}};
}

BodyGeometry placed_in_plane(const std::vector<PlanePoint>& points, double angle,
                             const SpaceVector& centre, int dimension) {
  double sine = 0.0;
  double cosine = 1.0;
  sincos_turns(angle / kTau, sine, cosine);
  BodyGeometry geometry;
  geometry.anchor = centre.components;
  geometry.relative.assign(points.size(), Point(static_cast<std::size_t>(dimension), 0.0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = points[i];
    geometry.relative[i][0] = fma(cosine, x, -(sine * y));
    geometry.relative[i][1] = fma(sine, x, cosine * y);
  }
  return geometry;
}

double distance_between(const std::vector<double>& one, const std::vector<double>& other) {
  return norm(difference(one, other));
}

void roll_along_particles(BodyGeometry& geometry) {
  const std::vector<Point>& points = geometry.relative;
  const std::size_t count = points.size();
  Point centre(points.front().size(), 0.0);
  for (const Point& point : points) {
    for (std::size_t d = 0; d < centre.size(); ++d) {
      centre[d] += point[d] / static_cast<double>(count);
    }
  }
  double radius = 0.0;
  double farthest = 0.0;
  double nearest = distance_between(centre, points.front());
  for (std::size_t i = 0; i < count; ++i) {
    const Point& next = points[(i + 1) % count];
    radius += distance_between(points[i], next) / kTau;
    farthest = std::max(farthest, distance_between(centre, points[i]));
    nearest = std::min(nearest, distance_from_edge(centre, points[i], next));
  }
  geometry.rolling_radius = radius;
  geometry.rolling_rise = farthest - nearest;
}

}  // namespace tomlin
