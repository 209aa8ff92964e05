#include "forcefields/tersoff.hpp"

#include <array>

#include "framework/core/elements/bond_order.hpp"

TOMLIN_DECLARE_TABLES(Tersoff, BondOrderTable)

namespace tomlin {
namespace {

/// A set of numbers with its paper.
struct NamedSet {
  const char* name;
  const char* source;
  TersoffNumbers numbers;
};

const std::array<NamedSet, 3>& named_sets() {
  static const std::array<NamedSet, 3> kSets = {
      {{"lindsay_broido_2010",
        "carbon in graphene and nanotubes, Phys. Rev. B 81, 205441 (2010)",
        {3.0, 1.0, 0.0, 38049.0, 4.3484, -0.930, 0.72751, 1.5724e-7, 2.2119, 430.0, 1.95, 0.15,
         3.4879, 1393.6}},
       {"tersoff_1989_carbon",
        "carbon, Phys. Rev. B 39, 5566 (1989)",
        {3.0, 1.0, 0.0, 38049.0, 4.3484, -0.57058, 0.72751, 1.5724e-7, 2.2119, 346.74, 1.95, 0.15,
         3.4879, 1393.6}},
       {"tersoff_1989_silicon",
        "silicon, Phys. Rev. B 39, 5566 (1989)",
        {3.0, 1.0, 0.0, 100390.0, 16.217, -0.59825, 0.78734, 1.1e-6, 1.7322, 471.18, 2.85, 0.15,
         2.4799, 1830.8}}}};
  return kSets;
}

std::vector<std::string> names_of_sets() {
  std::vector<std::string> names;
  for (const NamedSet& set : named_sets()) names.emplace_back(set.name);
  return names;
}

std::string list_of_sets() {
  std::string list;
  for (const NamedSet& set : named_sets()) {
    list += fmt::format("{}\"{}\" ({})", list.empty() ? "" : "; ", set.name, set.source);
  }
  return list;
}

std::vector<Complaint> complaints(const TersoffDescription& d, const SceneOutline& scene) {
  std::vector<Complaint> found =
      cutoff_complaints("parameters", Tersoff::reach(d), scene, Search::in_stages);
  if (scene.dimension != 3) {
    found.push_back({.key = "parameters",
                     .why = "the potential is one of three dimensions",
                     .admissible = "a scene in three dimensions",
                     .code = FaultCode::component_unsuitable});
  }
  return found;
}

}  // namespace

const TersoffNumbers& numbers_of(const TersoffDescription& description) {
  for (const NamedSet& set : named_sets()) {
    if (description.parameters == set.name) return set.numbers;
  }
  return named_sets().front().numbers;
}

ForceRecord tersoff_record() {
  using Description = TersoffDescription;
  ForceRecord record = record_of<Description>();
  record.name = "tersoff";
  record.summary = "covalent bonds whose strength depends on their surroundings, by Tersoff";
  record.equation =
      "V = 1/2 sum_ij f_C(r_ij) (A exp(-lambda1 r_ij) - b_ij B exp(-lambda2 r_ij)), b_ij = (1 + "
      "(beta zeta_ij)^n)^(-1/(2 n))";
  record.source =
      "J. Tersoff, Phys. Rev. B 39, 5566 (1989), doi:10.1103/PhysRevB.39.5566, eqs. (1) and (2); "
      "L. Lindsay and D. A. Broido, Phys. Rev. B 81, 205441 (2010), "
      "doi:10.1103/PhysRevB.81.205441";
  record.element = Element::surroundings;
  record.traits = {.conservative = true, .internal = true};
  record.complaints = of_description<&complaints>;
  record.bind = on_bond_orders<Tersoff, kernels::Tersoff>();
  record.parameters = {parameter("parameters", &Description::parameters, dimension::none,
                                 "name of a published set, in eV and Angstrom: " + list_of_sets())
                           .one_of(names_of_sets())};
  record.example =
      R"(# An equilateral triangle of carbon, in eV and Angstrom, released from a stretched state. The
# particles' mass is in eV ps^2/Angstrom^2.
[[body]]
type = "particles"
positions = [[0.0, 0.0, 0.0], [1.6, 0.0, 0.0], [0.8, 1.3856406460551018, 0.0]]
particle_mass = 1.2448e-3

[[force]]
type = "tersoff"
parameters = "lindsay_broido_2010"

[run]
duration = 0.1
integrator = { type = "velocity_verlet", dt = 2e-4 }
)";
  return record;
}

}  // namespace tomlin
