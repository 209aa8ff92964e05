#include "framework/bodies/ring.hpp"

#include "framework/bodies/outline.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = RingDescription;

std::vector<Complaint> complaints(const Description&, int dimension) {
  return complaints_without_plane("a ring", dimension);
}

BodyGeometry build(const Description& d, int dimension) {
  BodyGeometry geometry;
  geometry.anchor = d.centre.components;
  geometry.relative.assign(d.count, std::vector<double>(dimension, 0.0));
  for (std::int64_t i = 0; i < d.count; ++i) {
    double sine = 0.0;
    double cosine = 1.0;
    sincos_turns(static_cast<double>(i) / static_cast<double>(d.count), sine, cosine);
    geometry.relative[i][0] = d.radius * cosine;
    geometry.relative[i][1] = d.radius * sine;
  }
  geometry.rolling_radius = d.radius;
  return geometry;
}

}  // namespace

BodyRecord ring_record() {
  auto record = closed_body_record<Description>(
      {parameter("count", &Description::count, dimension::none, "number of particles").in(positive),
       parameter("radius", &Description::radius, dimension::length, "of the circle").in(positive),
       parameter("centre", &Description::centre, dimension::length, "of the circle")});
  record.name = "ring";
  record.summary = "particles on a circle in the x-y plane";
  record.equation = "x_i = centre + radius * (cos(2 pi i/count), sin(2 pi i/count))";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eqs. (2) and (14)";
  record.complaints = of_description<&complaints>;
  record.build = of_description<&build>;
  record.example =
      rolling_example("A rigid ring pulled over a corrugated substrate.", R"(type = "ring"
count = 8
radius = 1.0
centre = [0.0, 1.0]
)");
  return record;
}

}  // namespace tomlin
