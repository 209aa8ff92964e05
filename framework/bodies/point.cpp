#include "framework/bodies/point.hpp"

namespace tomlin {
namespace {

using Description = PointDescription;

int dimension_of(const Description& d) { return static_cast<int>(d.position.components.size()); }

std::int64_t count(const Description&) { return 1; }

std::vector<Complaint> complaints(const Description&, int) { return {}; }

BodyGeometry build(const Description& d, int dimension) {
  BodyGeometry geometry;
  geometry.anchor = d.position.components;
  geometry.relative.assign(1, std::vector<double>(dimension, 0.0));
  return geometry;
}

}  // namespace

BodyRecord point_record() {
  auto record = body_record<Description>(
      {parameter("position", &Description::position, dimension::length, "where it starts")});
  record.name = "point";
  record.summary = "one particle";
  record.equation = "x_0 = position";
  record.source =
      "L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85, doi:10.1002/zamm.19280080202; G. A. "
      "Tomlinson, Philos. Mag. 7 (1929) 905, doi:10.1080/14786440608564819";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.build = of_description<&build>;
  record.example = R"(# A free particle.
[[body]]
type = "point"
position = [0.0]
velocity = [1.0]
particle_mass = 1.0

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
