#include "forcefields/harmonic_bonds.hpp"

#include "framework/core/elements/bonds.hpp"

TOMLIN_DECLARE_KERNELS(HarmonicBonds)

namespace tomlin {

ForceRecord harmonic_bonds_record() {
  using Description = HarmonicBondsDescription;
  ForceRecord record = bond_force<HarmonicBonds, kernels::HarmonicBonds>();
  record.name = "harmonic_bonds";
  record.summary = "linear springs between the particles of a body, or of two";
  record.equation = "V = stiffness/2 * (r_ij - r0_ij)^2, each pair once";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eq. (3)";
  record.parameters = {
      bonded_pairs<Description>(),
      parameter("stiffness", &Description::stiffness, dimension::stiffness, "of each bond")
          .in(non_negative),
      bond_rest_lengths<Description>()};
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
