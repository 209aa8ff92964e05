#include "integrators/dop853.hpp"

#include <cmath>
#include <memory>

#include "framework/core/elements/kernel_tables.hpp"
#include "integrators/dop853_kernels.hpp"
#include "integrators/embedded.hpp"
#include "integrators/embedded_lanes.hpp"

TOMLIN_DECLARE_TABLES(Dop853Kernels, EmbeddedTable)

namespace tomlin {
namespace {

using Tableau = Dop853Tableau;

// The constants of Hairer and Wanner's code.
constexpr StepControl kControl = {
    .exponent = 1.0 / 8.0, .beta = 0.0, .least_factor = 1.0 / 3.0, .most_factor = 6.0};

/// The stages run on y' = z y with h = 1.
double growth(std::complex<double> z) {
  std::complex<double> slope[Tableau::end];
  std::complex<double> y = 1.0;
  for (int stage = 0; stage <= Tableau::end; ++stage) {
    y = 1.0;
    for (int j = 0; j < stage; ++j) y += Tableau::a[stage][j].as<double>() * slope[j];
    if (stage < Tableau::end) slope[stage] = z * y;
  }
  return std::abs(y);
}

template <class Real>
EmbeddedScheme<Real> scheme_on(InstructionSet set) {
  return {"dop853", Tableau::end, Tableau::slopes - Tableau::end - 1, kControl,
          kernels::Dop853Kernels.on<Real>(set)};
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

IntegratorRecord dop853_record() {
  IntegratorRecord record;
  record.name = "dop853";
  record.summary = "embedded Runge-Kutta pair 8(5,3) of Dormand and Prince, adaptive, dense output";
  record.equation = "y' = f: y + h sum b_i k_i, twelve stages, error from embedded orders 5 and 3";
  record.source =
      "E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I "
      "(Springer, 1993), doi:10.1007/978-3-540-78862-1, sections II.5 and II.10";
  record.order = 8;
  record.evaluations_per_step = Tableau::end;
  describe_adaptive(record, 1e-9);
  record.growth = &growth;
  record.bind = {&bind<double>, &bind<Quad>};
  record.adaptive_lanes = &lanes;
  record.example = R"(# A tip that sticks and slips, to twelve digits.
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
integrator = { type = "dop853", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }

[measure]
from = 1.0
to = 3.0
in = "driver_periods"
)";
  return record;
}

}  // namespace tomlin
