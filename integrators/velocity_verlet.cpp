#include "integrators/velocity_verlet.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "integrators/composition.hpp"
#include "integrators/velocity_verlet_kernels.hpp"

TOMLIN_DECLARE_TABLES(VelocityVerletKernels, CompositionTable)

namespace tomlin {
namespace {

using Description = CompositionDescription;

/// Friction only ever helps: its flow is exact.
double stable_step(double frequency, double) {
  return frequency > 0.0 ? 2.0 / frequency : std::numeric_limits<double>::infinity();
}

/// Under a steady force F the scheme's own steady speed is (h F/2m) coth(h gamma/2), where
/// F/(m gamma) is right.
double drag_error(double damped) {
  const double half = 0.5 * damped;
  return half > 0.0 ? half / std::tanh(half) - 1.0 : 0.0;
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  const auto& table = kernels::VelocityVerletKernels.on<Real>(system.set);
  return std::make_unique<Composition<Real>>(
      CompositionScheme<Real>{"velocity_verlet", VerletScheme::drifts, table}, system);
}

}  // namespace

IntegratorRecord velocity_verlet_record() {
  IntegratorRecord record;
  record.name = "velocity_verlet";
  record.summary = "velocity Verlet scheme of second order with the exact flow of friction";
  record.equation = "friction h/2, kick h/2, drift h, kick h/2, friction h/2";
  record.source =
      "W. C. Swope, H. C. Andersen, P. H. Berens and K. R. Wilson, J. Chem. Phys. 76 (1982) "
      "637, doi:10.1063/1.442716; R. I. McLachlan and G. R. W. Quispel, Acta Numerica 11 "
      "(2002) 341, doi:10.1017/S0962492902000053, friction by splitting";
  record.order = 2;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.splits_friction = true;
  record.takes_noise = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &stable_step;
  record.drag_error = &drag_error;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
  record.example = R"(# A chain of three, stretched and let go.
[[body]]
type = "chain"
count = 3
spacing = 1.1
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 4.0
rest_lengths = 1.0

[[force]]
type = "viscous_damping"
coefficient = 0.1

[run]
duration = 10.0
integrator = { type = "velocity_verlet", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
