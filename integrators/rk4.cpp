#include "integrators/rk4.hpp"

#include "integrators/fixed_step.hpp"
#include "integrators/rk4_kernels.hpp"

TOMLIN_DECLARE_TABLES(Rk4Kernels, FixedStepTable)

namespace tomlin {
IntegratorRecord rk4_record() {
  IntegratorRecord record = fixed_step_record<Rk4Tableau, kernels::Rk4Kernels>();
  record.summary = "classical Runge-Kutta scheme of fourth order with a fixed step";
  record.equation = "y' = f: y + h/6 (k1 + 2 k2 + 2 k3 + k4)";
  record.source =
      "W. Kutta, Z. Math. Phys. 46 (1901) 435; E. Hairer, S. P. Norsett and G. Wanner, "
      "Solving Ordinary Differential Equations I (Springer, 1993), "
      "doi:10.1007/978-3-540-78862-1, section II.1";
  record.example = R"(# A harmonic oscillator: one particle on a spring that does not move.
[[body]]
type = "point"
position = [1.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.0]
start = [0.0]

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
