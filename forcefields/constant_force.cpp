#include "forcefields/constant_force.hpp"

#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_KERNELS(ConstantForce)

namespace tomlin {

ForceRecord constant_force_record() {
  using Description = ConstantForceDescription;
  ForceRecord record = site_force<ConstantForce, kernels::ConstantForce>();
  record.name = "constant_force";
  record.summary = "the same constant force on every particle of a body";
  record.equation = "F = force, per particle";
  record.source =
      "V. Ambegaokar and B. I. Halperin, Phys. Rev. Lett. 22 (1969) 1364, "
      "doi:10.1103/PhysRevLett.22.1364, the tilted washboard, with a substrate";
  record.parameters = {
      parameter("force", &Description::force, dimension::force, "on each particle, per axis")};
  record.example = R"(# A falling particle.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [-1.0]

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
