#include "framework/bodies/point.hpp"

namespace tomlin {
namespace {

using Description = PointDescription;

int dimension_of(const void* description) {
  return static_cast<int>(static_cast<const Description*>(description)->position.components.size());
}

std::int64_t count(const void*) { return 1; }

std::vector<Complaint> complaints(const void*, int) { return {}; }

BodyGeometry build(const void* description, int dimension) {
  BodyGeometry geometry;
  geometry.anchor = static_cast<const Description*>(description)->position.components;
  geometry.relative.assign(1, std::vector<double>(dimension, 0.0));
  return geometry;
}

}  // namespace

BodyRecord point_record() {
  BodyRecord record;
  record.name = "point";
  record.summary = "one particle";
  record.equation = "x_0 = position";
  record.source =
      "L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85, doi:10.1002/zamm.19280080202; G. A. "
      "Tomlinson, Philos. Mag. 7 (1929) 905, doi:10.1080/14786440608564819";
  record.make_description = &make_description<Description>;
  record.parameters = with_body_parameters<Description>(
      {parameter("position", &Description::position, dimension::length, "where it starts")});
  record.common = &body_part<Description>;
  record.dimension = &dimension_of;
  record.count = &count;
  record.complaints = &complaints;
  record.build = &build;
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
