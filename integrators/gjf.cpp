#include "integrators/gjf.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "integrators/composition.hpp"
#include "integrators/langevin_kernels.hpp"

TOMLIN_DECLARE_TABLES(GjfKernels, CompositionTable)

namespace tomlin {
namespace {

using Description = CompositionDescription;

/// Friction only ever helps.
double stable_step(double frequency, double) {
  return frequency > 0.0 ? 2.0 / frequency : std::numeric_limits<double>::infinity();
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  const auto& table = kernels::GjfKernels.on<Real>(system.set);
  return std::make_unique<Composition<Real>>(CompositionScheme<Real>{"gjf", 1, table}, system);
}

}  // namespace

IntegratorRecord gjf_record() {
  IntegratorRecord record;
  record.name = "gjf";
  record.summary =
      "scheme of Gronbech-Jensen and Farago for Langevin dynamics: exact drift and diffusion";
  record.equation =
      "kick h/2, drift h/2, v <- a v + b/m sqrt(2 c T h) z, drift h/2, kick h/2; a = (1 - h c/2m) "
      "b, b = "
      "1/(1 + h c/2m)";
  record.source =
      "N. Gronbech-Jensen and O. Farago, Mol. Phys. 111 (2013) 983, "
      "doi:10.1080/00268976.2012.760055";
  record.order = 2;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.splits_friction = true;
  record.takes_noise = true;
  record.half_step_velocities = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &stable_step;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
  record.example = R"(# A particle drifts over a corrugation in a thermal bath, with long steps.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [0.5]

[[force]]
type = "langevin"
coefficient = 0.5
temperature = 0.2

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 100.0
integrator = { type = "gjf", dt = 5e-2 }
)";
  return record;
}

}  // namespace tomlin
