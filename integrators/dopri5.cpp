#include "integrators/dopri5.hpp"

#include <cmath>
#include <memory>

#include "framework/core/elements/kernel_tables.hpp"
#include "integrators/dopri5_kernels.hpp"
#include "integrators/embedded.hpp"
#include "integrators/embedded_lanes.hpp"

TOMLIN_DECLARE_TABLES(Dopri5Kernels, EmbeddedTable)

namespace tomlin {
namespace {

// The PI controller of Hairer and Wanner's code, with their constants.
constexpr double kBeta = 0.04;
constexpr StepControl kControl = {
    .exponent = 0.2 - 0.75 * kBeta, .beta = kBeta, .least_factor = 0.2, .most_factor = 10.0};

double growth(std::complex<double> z) {
  return std::abs(
      1.0 +
      z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0 * (1.0 + z / 5.0))))));
}

template <class Real>
EmbeddedScheme<Real> scheme_on(InstructionSet set) {
  return {"dopri5", Dopri5Tableau::end, 0, kControl, kernels::Dopri5Kernels.on<Real>(set)};
}

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void* description, System<Real>& system) {
  return std::make_unique<EmbeddedPair<Real>>(
      scheme_on<Real>(system.set), *static_cast<const AdaptiveDescription*>(description), system);
}

std::unique_ptr<AdaptiveLanes> lanes(const LaneLayout& layout, System<double>& system) {
  return std::make_unique<EmbeddedPairLanes>(scheme_on<double>(system.set), layout, system);
}

}  // namespace

IntegratorRecord dopri5_record() {
  IntegratorRecord record;
  record.name = "dopri5";
  record.summary = "embedded Runge-Kutta pair 5(4) of Dormand and Prince, adaptive, dense output";
  record.equation = "y' = f: y + h sum b_i k_i, seven stages, error from the embedded order 4";
  record.source =
      "J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19, "
      "doi:10.1016/0771-050X(80)90013-3";
  record.order = 5;
  record.evaluations_per_step = Dopri5Tableau::end;
  describe_adaptive(record, 1e-9);
  record.growth = &growth;
  record.bind = {&bind<double>, &bind<Quad>};
  record.adaptive_lanes = &lanes;
  record.example = R"(# A tip that sticks and slips.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.01]

[[force]]
type = "viscous_damping"
coefficient = 2.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 300.0
integrator = { type = "dopri5", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }

[measure]
from = 1.0
to = 3.0
in = "driver_periods"
)";
  return record;
}

}  // namespace tomlin
