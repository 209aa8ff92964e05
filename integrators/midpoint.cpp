#include "integrators/midpoint.hpp"

#include <cmath>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "integrators/fixed_step.hpp"
#include "integrators/midpoint_kernels.hpp"

TOMLIN_DECLARE_TABLES(MidpointKernels, FixedStepTable)

namespace tomlin {
namespace {

using Description = FixedStepDescription;

double growth(std::complex<double> z) { return std::abs(1.0 + z * (1.0 + z / 2.0)); }

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  return make_fixed_step<Real>({"midpoint", 2, kernels::MidpointKernels.on<Real>(system.set)},
                               system);
}

}  // namespace

IntegratorRecord midpoint_record() {
  IntegratorRecord record;
  record.name = "midpoint";
  record.summary = "explicit midpoint scheme of second order with a fixed step";
  record.equation = "y' = f: y + h f(t + h/2, y + h/2 f(t, y))";
  record.source =
      "C. Runge, Math. Ann. 46 (1895) 167, doi:10.1007/BF01446807; E. Hairer, S. P. Norsett "
      "and G. Wanner, Solving Ordinary Differential Equations I (Springer, 1993), "
      "doi:10.1007/978-3-540-78862-1, section II.1";
  record.order = 2;
  record.evaluations_per_step = 2;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.growth = &growth;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
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
