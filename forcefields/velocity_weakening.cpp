#include "forcefields/velocity_weakening.hpp"

#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_KERNELS(VelocityWeakening)

namespace tomlin {

ForceRecord velocity_weakening_record() {
  using Description = VelocityWeakeningDescription;
  ForceRecord record = site_force<VelocityWeakening, kernels::VelocityWeakening>();
  record.name = "velocity_weakening";
  record.summary = "dry friction that becomes weaker with each particle's speed";
  record.equation =
      "F = -force * (v / u) / (1 + u / weakening_velocity), u = sqrt(|v|^2 + width^2), per "
      "particle";
  record.source =
      "J. M. Carlson and J. S. Langer, Phys. Rev. A 40 (1989) 6470,"
      " doi:10.1103/PhysRevA.40.6470, the friction law phi, regularised at rest";
  record.parameters = {
      parameter("force", &Description::force, dimension::force,
                "the friction of a particle that slides far slower than weakening_velocity")
          .in(non_negative),
      parameter("weakening_velocity", &Description::weakening_velocity, dimension::velocity,
                "at this speed friction has halved")
          .in(positive),
      parameter("width", &Description::width, dimension::velocity,
                "regularises the law at rest: below this velocity the friction is viscous; far "
                "below weakening_velocity. Steps in which the velocity changes by more than the "
                "width leave schemes of any order at about the first where the motion reverses")
          .in(positive)};
  record.example = R"(# A block, pulled by a spring, sticks and slips.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.1]

[[force]]
type = "velocity_weakening"
force = 1.0
weakening_velocity = 0.5
width = 1e-2

[run]
duration = 60.0
integrator = { type = "rk4", dt = 2e-3 }
)";
  return record;
}

}  // namespace tomlin
