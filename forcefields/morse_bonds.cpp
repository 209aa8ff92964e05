#include "forcefields/morse_bonds.hpp"

#include "framework/core/elements/bonds.hpp"

TOMLIN_DECLARE_KERNELS(MorseBonds)

namespace tomlin {

ForceRecord morse_bonds_record() {
  using Description = MorseBondsDescription;
  constexpr Dimension kInverseLength{.length = -1};
  ForceRecord record = bond_force<MorseBonds, kernels::MorseBonds, kRankTranscendental>();
  record.name = "morse_bonds";
  record.summary = "bonds that break, between the particles of a body, or of two";
  record.equation = "V = depth * (1 - exp(-inverse_width * (r_ij - r0_ij)))^2, each pair once";
  record.source = "P. M. Morse, Phys. Rev. 34, 57 (1929), doi:10.1103/PhysRev.34.57, eq. (4)";
  record.parameters = {
      bonded_pairs<Description>(),
      parameter("depth", &Description::depth, dimension::energy, "that it takes to break a bond")
          .in(non_negative),
      parameter("inverse_width", &Description::inverse_width, kInverseLength,
                "of the well; a bond's stiffness at rest is 2 depth inverse_width^2")
          .in(positive),
      bond_rest_lengths<Description>()};
  record.example =
      R"(# A molecule, stretched and let go: its period is longer than that of small swings.
[[body]]
type = "chain"
count = 2
spacing = 1.4
particle_mass = 1.0

[[force]]
type = "morse_bonds"
pairs = "neighbours"
depth = 1.0
inverse_width = 1.5
rest_lengths = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
