#include "forcefields/coulomb_friction.hpp"

#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_KERNELS(CoulombFriction)

namespace tomlin {

ForceRecord coulomb_friction_record() {
  using Description = CoulombFrictionDescription;
  ForceRecord record = site_force<CoulombFriction, kernels::CoulombFriction>();
  record.name = "coulomb_friction";
  record.summary = "dry friction of constant magnitude, against each particle's velocity";
  record.equation = "F = -force * v / sqrt(|v|^2 + width^2), per particle";
  record.source =
      "E. Pennestri, V. Rossi, P. Salvini and P. P. Valentini, Nonlinear Dyn. 83 (2016) 1785,"
      " doi:10.1007/s11071-015-2485-3, a review of laws that regularise it";
  record.parameters = {
      parameter("force", &Description::force, dimension::force,
                "the kinetic friction force of a particle")
          .in(non_negative),
      parameter("width", &Description::width, dimension::velocity,
                "regularises the law at rest: below this velocity the friction is viscous, with "
                "the coefficient force/width; nothing sticks entirely. Steps in which the velocity "
                "changes by more than the width leave schemes of any order at about the first "
                "where the motion reverses")
          .in(positive)};
  record.example = R"(# A block slides to rest, after the time mass * velocity / force = 2.
[[body]]
type = "point"
position = [0.0]
velocity = [1.0]
particle_mass = 1.0

[[force]]
type = "coulomb_friction"
force = 0.5
width = 1e-2

[run]
duration = 4.0
integrator = { type = "rk4", dt = 1e-3 }
)";
  return record;
}

}  // namespace tomlin
