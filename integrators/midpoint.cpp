#include "integrators/midpoint.hpp"

#include "integrators/fixed_step.hpp"
#include "integrators/midpoint_kernels.hpp"

TOMLIN_DECLARE_TABLES(MidpointKernels, FixedStepTable)

namespace tomlin {
IntegratorRecord midpoint_record() {
  IntegratorRecord record = fixed_step_record<MidpointTableau, kernels::MidpointKernels>();
  record.summary = "explicit midpoint scheme of second order with a fixed step";
  record.equation = "y' = f: y + h f(t + h/2, y + h/2 f(t, y))";
  record.source =
      "C. Runge, Math. Ann. 46 (1895) 167, doi:10.1007/BF01446807; E. Hairer, S. P. Norsett "
      "and G. Wanner, Solving Ordinary Differential Equations I (Springer, 1993), "
      "doi:10.1007/978-3-540-78862-1, section II.1";
  record.example = R"(# A particle on a spring that does not move, damped.
[[body]]
type = "point"
position = [1.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.0]
start = [0.0]

[[force]]
type = "viscous_damping"
coefficient = 0.5

[run]
duration = 10.0
integrator = { type = "midpoint", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
