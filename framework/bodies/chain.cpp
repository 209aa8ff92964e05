#include "framework/bodies/chain.hpp"

namespace tomlin {
namespace {

using Description = ChainDescription;

int axis_index(const Description& d) { return static_cast<int>(d.axis); }

int dimension_of(const void* description) {
  return static_cast<int>(static_cast<const Description*>(description)->origin.components.size());
}

std::int64_t count(const void* description) {
  return static_cast<const Description*>(description)->count;
}

std::vector<Complaint> complaints(const void* description, int dimension) {
  const auto& d = *static_cast<const Description*>(description);
  if (axis_index(d) >= dimension) {
    return {{.key = "axis",
             .why = "the scene has no such axis",
             .admissible = dimension == 1 ? "\"x\"" : "\"x\" or \"y\"",
             .code = FaultCode::scene_unknown_choice}};
  }
  return {};
}

BodyEnds ends(const void* description, int) {
  return {.open_along = axis_index(*static_cast<const Description*>(description))};
}

BodyGeometry build(const void* description, int dimension) {
  const auto& d = *static_cast<const Description*>(description);
  BodyGeometry geometry;
  geometry.anchor = d.origin.components;
  geometry.anchor.resize(dimension, 0.0);
  geometry.relative.assign(d.count, std::vector<double>(dimension, 0.0));
  for (std::int64_t i = 0; i < d.count; ++i) {
    geometry.relative[i][axis_index(d)] = static_cast<double>(i) * d.spacing;
  }
  return geometry;
}

}  // namespace

BodyRecord chain_record() {
  BodyRecord record;
  record.name = "chain";
  record.summary =
      "equally spaced particles on a straight line; its ends are open unless a periodic [box] "
      "joins them";
  record.equation = "x_i = origin + i * spacing along the axis, i = 0 .. count - 1";
  record.source =
      "O. M. Braun and Y. S. Kivshar, The Frenkel-Kontorova Model (Springer, 2004), "
      "doi:10.1007/978-3-662-10331-9, chapter 1; T. A. Kontorova and Y. I. Frenkel, Zh. Eksp."
      " Teor. Fiz. 8 (1938) 89";
  record.make_description = &make_description<Description>;
  record.parameters = with_body_parameters<Description>(
      {parameter("count", &Description::count, dimension::none, "number of particles").in(positive),
       parameter("spacing", &Description::spacing, dimension::length, "from one to the next")
           .in(positive),
       parameter("origin", &Description::origin, dimension::length,
                 "of the first particle; zeros by default")
           .or_absent(),
       parameter("axis", &Description::axis, dimension::none, "along which it lies")
           .by_default(Axis::x)});
  record.common = &body_part<Description>;
  record.dimension = &dimension_of;
  record.count = &count;
  record.complaints = &complaints;
  record.ends = &ends;
  record.build = &build;
  record.example = R"(# Four bonded particles, the first moving.
[[body]]
type = "chain"
count = 4
spacing = 1.0
velocity = [[0.1], [0.0], [0.0], [0.0]]
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 1.0

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
