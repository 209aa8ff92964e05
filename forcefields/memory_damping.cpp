#include "forcefields/memory_damping.hpp"

#include "framework/core/elements/own_state_force.hpp"

TOMLIN_DECLARE_KERNELS(MemoryDamping)

namespace tomlin {

ForceRecord memory_damping_record() {
  using Description = MemoryDampingDescription;
  ForceRecord record = own_state_force<MemoryDamping, kernels::MemoryDamping>();
  record.name = "memory_damping";
  record.summary = "drag that remembers: generalised Langevin friction without noise";
  record.equation =
      "F = -integral_0^t K(t-s) v(s) ds, K(t) = coefficient/memory_time * exp(-t/memory_time), "
      "per particle";
  record.source =
      "R. Zwanzig, J. Stat. Phys. 9, 215 (1973), doi:10.1007/BF01008729; H. Mori, Prog. Theor. "
      "Phys. 33, 423 (1965), doi:10.1143/PTP.33.423";
  record.parameters = {
      parameter("coefficient", &Description::coefficient, dimension::friction,
                "mass/time, per particle: the drag on what is much slower than the memory")
          .in(non_negative),
      parameter("memory_time", &Description::memory_time, dimension::time,
                "of the exponential kernel; several of these forces make a Prony series")
          .in(positive)};
  record.example = R"(# A particle that coasts to rest overshoots: the memory pulls it back.
[[body]]
type = "point"
position = [0.0]
velocity = [1.0]
particle_mass = 1.0

[[force]]
type = "memory_damping"
coefficient = 2.0
memory_time = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
