#include "integrators/blanes_moan.hpp"

#include <limits>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "integrators/blanes_moan_kernels.hpp"
#include "integrators/composition.hpp"

TOMLIN_DECLARE_TABLES(BlanesMoanKernels, CompositionTable)

namespace tomlin {
namespace {

using Description = CompositionDescription;

/// Where half the trace of a step's matrix for a harmonic oscillator first leaves [-1, 1].
double stable_step(double frequency, double) {
  constexpr double kLimit = 3.163;
  return frequency > 0.0 ? kLimit / frequency : std::numeric_limits<double>::infinity();
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  const auto& table = kernels::BlanesMoanKernels.on<Real>(system.set);
  return std::make_unique<Composition<Real>>(
      CompositionScheme<Real>{"blanes_moan", BlanesMoanScheme::drifts, table}, system);
}

}  // namespace

IntegratorRecord blanes_moan_record() {
  IntegratorRecord record;
  record.name = "blanes_moan";
  record.summary = "symplectic scheme of fourth order for scenes without friction";
  record.equation = "kick b_1 h, drift a_1 h, kick b_2 h, ..., drift a_6 h, kick b_7 h";
  record.source =
      "S. Blanes and P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313, "
      "doi:10.1016/S0377-0427(01)00492-7, table 3, SRKN^b_6";
  record.order = 4;
  record.evaluations_per_step = 6;
  record.without_inertia = false;
  record.conservative_only = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &stable_step;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
  record.example = R"(# A particle that swings in a trough of the corrugation, for ever.
[[body]]
type = "point"
position = [0.3]
particle_mass = 1.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 100.0
ledger = true
integrator = { type = "blanes_moan", dt = 0.2 }
)";
  return record;
}

}  // namespace tomlin
