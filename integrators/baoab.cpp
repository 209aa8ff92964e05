#include "integrators/baoab.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "integrators/composition.hpp"
#include "integrators/langevin_kernels.hpp"

TOMLIN_DECLARE_TABLES(BaoabKernels, CompositionTable)

namespace tomlin {
namespace {

using Description = CompositionDescription;

/// Friction only ever helps.
double stable_step(double frequency, double) {
  return frequency > 0.0 ? 2.0 / frequency : std::numeric_limits<double>::infinity();
}

/// The speed under a steady force, and the diffusion coefficient, are right but for the factor
/// (h gamma/2) coth(h gamma/2).
double drag_error(double damped) {
  const double half = 0.5 * damped;
  return half > 0.0 ? half / std::tanh(half) - 1.0 : 0.0;
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  const auto& table = kernels::BaoabKernels.on<Real>(system.set);
  return std::make_unique<Composition<Real>>(CompositionScheme<Real>{"baoab", 1, table}, system);
}

}  // namespace

IntegratorRecord baoab_record() {
  IntegratorRecord record;
  record.name = "baoab";
  record.summary =
      "BAOAB splitting of Langevin dynamics: friction and noise exact, in the middle of a Verlet "
      "step";
  record.equation = "kick h/2, drift h/2, friction and noise h, drift h/2, kick h/2";
  record.source =
      "B. Leimkuhler and C. Matthews, Appl. Math. Res. Express 2013, 34, doi:10.1093/amrx/abs010";
  record.order = 2;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.splits_friction = true;
  record.takes_noise = true;
  record.half_step_velocities = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &stable_step;
  record.drag_error = &drag_error;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
  record.example = R"(# A particle drifts over a corrugation in a thermal bath.
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
integrator = { type = "baoab", dt = 5e-2 }
)";
  return record;
}

}  // namespace tomlin
