#include "forcefields/langevin.hpp"

#include "forcefields/viscous_damping.hpp"
#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_KERNELS(ViscousDamping)

namespace tomlin {
namespace {

Traits traits_at_temperature(const ViscousDampingDescription& d) {
  Traits traits = traits_of_sites<ViscousDamping>();
  traits.stochastic = d.temperature > 0.0 && d.coefficient > 0.0;
  return traits;
}

}  // namespace

ForceRecord langevin_record() {
  using Description = ViscousDampingDescription;
  ForceRecord record = site_force<ViscousDamping, kernels::ViscousDamping>();
  record.name = "langevin";
  record.summary = "Langevin thermostat: drag on each particle and the noise that belongs to it";
  record.equation =
      "F = -coefficient * v + sqrt(2 * coefficient * temperature) * xi(t), per particle, xi white "
      "noise";
  record.source =
      "P. Langevin, C. R. Acad. Sci. (Paris) 146 (1908) 530; R. Kubo, Rep. Prog. Phys. 29 (1966) "
      "255, doi:10.1088/0034-4885/29/1/306";
  record.traits_of = of_description<&traits_at_temperature>;
  record.parameters = {parameter("coefficient", &Description::coefficient, dimension::friction,
                                 "mass/time, per particle (not the rate, which is 1/time)")
                           .in(non_negative),
                       parameter("temperature", &Description::temperature, dimension::temperature,
                                 "k_B T in reduced units, an energy; K in metal units")
                           .in(non_negative)};
  record.example = R"(# A tip in a thermal bath, pulled over a corrugated surface.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.01]

[[force]]
type = "langevin"
coefficient = 0.5
temperature = 0.1

[[force]]
type = "sinusoidal_substrate"
amplitude = 1.0
period = 1.0

[run]
duration = 100.0
integrator = { type = "baoab", dt = 2e-2 }
)";
  return record;
}

}  // namespace tomlin
