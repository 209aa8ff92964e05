#include "framework/bodies/chain.hpp"

namespace tomlin {
namespace {

using Description = ChainDescription;

int axis_index(const Description& d) { return static_cast<int>(d.axis); }

int dimension_of(const Description& d) { return static_cast<int>(d.origin.components.size()); }

std::int64_t count(const Description& d) { return d.count; }

std::vector<Complaint> complaints(const Description& d, int dimension) {
  if (axis_index(d) >= dimension) {
    return {{.key = "axis",
             .why = "the scene has no such axis",
             .admissible = dimension == 1 ? "\"x\"" : "\"x\" or \"y\"",
             .code = FaultCode::scene_unknown_choice}};
  }
  return {};
}

BodyEnds ends(const Description& d, int) { return {.open_along = axis_index(d)}; }

BodyGeometry build(const Description& d, int dimension) {
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
  auto record = body_record<Description>(
      {parameter("count", &Description::count, dimension::none, "number of particles").in(positive),
       parameter("spacing", &Description::spacing, dimension::length, "from one to the next")
           .in(positive),
       parameter("origin", &Description::origin, dimension::length,
                 "of the first particle; zeros by default")
           .or_absent(),
       parameter("axis", &Description::axis, dimension::none, "along which it lies")
           .by_default(Axis::x)});
  record.name = "chain";
  record.summary =
      "equally spaced particles on a straight line; its ends are open unless a periodic [box] "
      "joins them";
  record.equation = "x_i = origin + i * spacing along the axis, i = 0 .. count - 1";
  record.source =
      "O. M. Braun and Y. S. Kivshar, The Frenkel-Kontorova Model (Springer, 2004), "
      "doi:10.1007/978-3-662-10331-9, chapter 1; T. A. Kontorova and Y. I. Frenkel, Zh. Eksp."
      " Teor. Fiz. 8 (1938) 89";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.ends = of_description<&ends>;
  record.build = of_description<&build>;
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
