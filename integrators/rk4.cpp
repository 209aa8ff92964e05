#include "integrators/rk4.hpp"

#include <cmath>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "integrators/fixed_step.hpp"
#include "integrators/rk4_kernels.hpp"

TOMLIN_DECLARE_TABLES(Rk4Kernels, FixedStepTable)

namespace tomlin {
namespace {

using Description = FixedStepDescription;

double growth(std::complex<double> z) {
  return std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  return make_fixed_step<Real>({"rk4", 4, kernels::Rk4Kernels.on<Real>(system.set)}, system);
}

}  // namespace

IntegratorRecord rk4_record() {
  IntegratorRecord record;
  record.name = "rk4";
  record.summary = "classical Runge-Kutta scheme of fourth order with a fixed step";
  record.equation = "y' = f: y + h/6 (k1 + 2 k2 + 2 k3 + k4)";
  record.source =
      "W. Kutta, Z. Math. Phys. 46 (1901) 435; E. Hairer, S. P. Norsett and G. Wanner, "
      "Solving Ordinary Differential Equations I (Springer, 1993), "
      "doi:10.1007/978-3-540-78862-1, section II.1";
  record.order = 4;
  record.evaluations_per_step = 4;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.growth = &growth;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
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
