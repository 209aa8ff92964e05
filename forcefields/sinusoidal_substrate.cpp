#include "forcefields/sinusoidal_substrate.hpp"

#include "framework/core/elements/site_force.hpp"
#include "framework/core/text/fault_code.hpp"

TOMLIN_DECLARE_KERNELS(SinusoidalSubstrate)

namespace tomlin {
namespace {

using Description = SinusoidalSubstrateDescription;

std::vector<Complaint> complaints(const Description& d, const SceneOutline& scene) {
  if (scene.dimension == 1 && d.decay != 0.0) {
    Complaint complaint{"decay", "there is no y for it to act along in one dimension", "0"};
    complaint.code = FaultCode::component_unsuitable;
    return {complaint};
  }
  return {};
}

}  // namespace

ForceRecord sinusoidal_substrate_record() {
  ForceRecord record =
      site_force<SinusoidalSubstrate, kernels::SinusoidalSubstrate, kRankTranscendental>();
  record.name = "sinusoidal_substrate";
  record.summary = "a corrugated substrate that each particle feels";
  record.equation =
      "V = amplitude * exp(-decay * y^2) * cos(2 pi (x - offset) / period), per particle";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eqs. (8) and (9); L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85, "
      "doi:10.1002/zamm.19280080202, decay = 0; G. A. Tomlinson, Philos. Mag. 7 (1929) 905, "
      "doi:10.1080/14786440608564819, decay = 0";
  record.parameters = {
      parameter("amplitude", &Description::amplitude, dimension::energy,
                "corrugation amplitude per particle; x = 0 is a maximum when positive"),
      parameter("period", &Description::period, dimension::length, "lattice period")
          .in(positive)
          .one_for_all_particles(),
      parameter("decay", &Description::decay, dimension::inverse_area,
                "decay of the corrugation with height, exp(-decay * y^2)")
          .in(non_negative)
          .by_default(0.0),
      parameter("offset", &Description::offset, dimension::length,
                "where the lattice has its zero along x")
          .by_default(0.0)};
  record.complaints = of_description<&complaints>;
  record.example = R"(# A particle released near the top of a corrugation swings about the minimum.
[[body]]
type = "point"
position = [0.1]
particle_mass = 1.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
