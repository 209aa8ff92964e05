#include "forcefields/harmonic_bonds.hpp"

#include "framework/core/elements/bonds.hpp"

TOMLIN_DECLARE_KERNELS(HarmonicBonds)

namespace tomlin {
namespace {

using Description = HarmonicBondsDescription;

}  // namespace

ForceRecord harmonic_bonds_record() {
  ForceRecord record;
  record.name = "harmonic_bonds";
  record.summary = "linear springs between the particles of a body, or of two";
  record.equation = "V = stiffness/2 * (r_ij - r0_ij)^2, each pair once";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eq. (3)";
  record.element = Element::pair;
  record.traits = {.conservative = true, .internal = true};
  record.most_bodies = 2;
  record.make_description = &make_description<Description>;
  record.parameters = {
      bonded_pairs<Description>(),
      parameter("stiffness", &Description::stiffness, dimension::stiffness, "of each bond")
          .in(non_negative),
      bond_rest_lengths<Description>()};
  record.complaints = &bond_complaints<Description>;
  record.pairs = &bond_count<Description>;
  record.bind = on_bonds<HarmonicBonds, kernels::HarmonicBonds, kRankPairs>();
  record.example = R"(# Three particles on a line, stretched and let go.
[[body]]
type = "chain"
count = 3
spacing = 1.1
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 4.0
rest_lengths = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
