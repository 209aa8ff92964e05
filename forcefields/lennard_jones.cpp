#include "forcefields/lennard_jones.hpp"

#include "framework/core/elements/cutoff_pairs.hpp"

TOMLIN_DECLARE_TABLES(LennardJones, CutoffPairTable)
TOMLIN_DECLARE_TABLES(LennardJonesSmooth, CutoffPairTable)

namespace tomlin {
namespace {

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const LennardJonesDescription& d,
                                       const Binding<Real>& binding) {
  return d.at_cutoff == AtCutoff::smooth
             ? bind_within_cutoff<LennardJonesSmooth, kernels::LennardJonesSmooth, kRankPairs>(
                   d, binding)
             : bind_within_cutoff<LennardJones, kernels::LennardJones, kRankPairs>(d, binding);
}

/// An energy that jumps is none whose gradient the force is.
Traits traits_of_potential(const LennardJonesDescription& d) {
  return {.conservative = d.at_cutoff != AtCutoff::cut, .internal = true};
}

std::vector<Complaint> complaints(const LennardJonesDescription& d, const SceneOutline& scene) {
  return cutoff_complaints("cutoff", d.cutoff, scene);
}

}  // namespace

ForceRecord lennard_jones_record() {
  using Description = LennardJonesDescription;
  ForceRecord record = record_of<Description>();
  record.name = "lennard_jones";
  record.summary =
      "attraction and repulsion of all pairs within a cutoff, in a body or between two";
  record.equation =
      "V = 4 * epsilon * ((sigma/r)^12 - (sigma/r)^6) for r < cutoff, less what at_cutoff says";
  record.source =
      "J. E. Jones, Proc. R. Soc. Lond. A 106, 463 (1924), doi:10.1098/rspa.1924.0082; the shifted "
      "force: S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134, 081102 (2011), doi:10.1063/1.3558787";
  record.element = Element::pair;
  record.traits = {.conservative = true, .internal = true};
  record.traits_of = of_description<&traits_of_potential>;
  record.most_bodies = 2;
  record.complaints = of_description<&complaints>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<float>>,
                 of_description<&bind<Quad>>};
  record.parameters = {
      parameter("epsilon", &Description::epsilon, dimension::energy, "depth of the well")
          .in(non_negative),
      parameter("sigma", &Description::sigma, dimension::length,
                "where the energy passes zero; the well is at 2^(1/6) times this")
          .in(positive),
      parameter("cutoff", &Description::cutoff, dimension::length,
                "pairs further apart than this do not interact; half a periodic box allows for "
                "1.15 times this")
          .in(positive),
      parameter("at_cutoff", &Description::at_cutoff, dimension::none,
                "\"cut\": energy and force end abruptly; \"shift\": a constant makes the energy "
                "zero there; \"smooth\": a linear term makes the force zero there, too")
          .by_default(AtCutoff::smooth)};
  record.example = R"(# Seven particles in a plane, drawn together.
[[body]]
type = "flake"
shape = "hexagon"
size = 2
lattice = "hexagonal"
lattice_constant = 1.2
centre = [0.0, 0.0]
particle_mass = 1.0

[[force]]
type = "lennard_jones"
epsilon = 1.0
sigma = 1.0
cutoff = 3.0

[run]
duration = 2.0
integrator = { type = "velocity_verlet", dt = 1e-3 }
)";
  return record;
}

}  // namespace tomlin
