#include "forcefields/viscous_damping.hpp"

#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_KERNELS(ViscousDamping)

namespace tomlin {

ForceRecord viscous_damping_record() {
  using Description = ViscousDampingDescription;
  ForceRecord record = site_force<ViscousDamping, kernels::ViscousDamping>();
  record.name = "viscous_damping";
  record.summary = "drag proportional to each particle's velocity";
  record.equation = "F = -coefficient * v, per particle";
  record.source =
      "A. Sircar and P. K. Patra, A simple generalization of Prandtl-Tomlinson model to study"
      " nanoscale rolling friction, J. Appl. Phys. 127 (2020), doi:10.48550/arXiv.1912.00232,"
      " eq. (7) with the sign of eq. (10)";
  record.parameters = {parameter("coefficient", &Description::coefficient, dimension::friction,
                                 "mass/time, per particle (not the rate, which is 1/time)")
                           .in(non_negative)};
  record.example = R"(# A particle coasts to rest.
[[body]]
type = "point"
position = [0.0]
velocity = [1.0]
particle_mass = 1.0

[[force]]
type = "viscous_damping"
coefficient = 0.5

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
