#include "integrators/velocity_verlet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "framework/core/integrator.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/scheme.hpp"
#include "integrators/hermite.hpp"
#include "integrators/velocity_verlet_kernels.hpp"

TOMLIN_DECLARE_TABLES(VelocityVerletKernels, VerletTable)

namespace tomlin {
namespace {

using Description = VelocityVerletDescription;

template <class Real>
class VelocityVerlet : public Integrator<Real> {
 public:
  explicit VelocityVerlet(System<Real>& system)
      : Integrator<Real>(system),
        kernels_(kernels::VelocityVerletKernels.on<Real>(system.set)),
        hermite_(system.view.dofs, system.view.rates) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    memory_.assign(4 * (n + kGap) + 3 * (m + kGap), Real(0.0));
    Real* next = memory_.data();
    const auto take = [&next](std::size_t count) {
      return std::exchange(next, next + count + kGap);
    };
    arrays_.position = take(n);
    arrays_.velocity = take(n);
    acceleration_ = take(n);
    Real* rest = take(n);
    if (kCompensated<Real>) arrays_.velocity_rest = rest;
    arrays_.end_rates = take(m);
    arrays_.own = take(m);
    start_rates_ = take(m);
  }

  void declare(StateLayout& layout) override {
    layout.add_numbers<Real>("velocity_verlet.force", system_.view.dofs);
    layout.add_numbers<Real>("velocity_verlet.rates", system_.view.rates);
    layout.add_integers("velocity_verlet.started", 1);
  }

  void attach(RunState& state) override {
    arrays_.force = state.numbers<Real>("velocity_verlet.force");
    arrays_.rates = state.numbers<Real>("velocity_verlet.rates");
    started_ = state.integers("velocity_verlet.started");
  }

  StepReport step_from(double since, double h, bool dense) override {
    if (*started_ == 0) {
      kernels_.first(system_.view, arrays_, since);
      system_.evaluations += 1;
      *started_ = 1;
    }
    std::copy(arrays_.rates, arrays_.rates + system_.view.rates, start_rates_);
    if (dense) {
      kernels_.accelerations(system_.view, arrays_, acceleration_);
      hermite_.keep_start(system_.view);
      hermite_.keep_first(acceleration_, start_rates_);
    }
    last_ = h;
    system_.evaluations += 1;
    if (!kernels_.step(system_.view, arrays_, since, h)) {
      return {0.0, StepFault::not_finite_or_too_far};
    }
    std::copy(arrays_.end_rates, arrays_.end_rates + system_.view.rates, arrays_.rates);
    return {h, StepFault::none};
  }

  const Real* first_rates() const override { return start_rates_; }
  void forces_changed() override { *started_ = 0; }

  void finish_dense_from(double) override {
    kernels_.accelerations(system_.view, arrays_, acceleration_);
  }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    hermite_.interpolate(theta, last_, system_.view, acceleration_, arrays_.rates, position,
                         velocity, integrals);
  }

 private:
  /// Between arrays, to keep them off powers of two.
  static constexpr std::size_t kGap = 3 * kGroup;
  using Integrator<Real>::system_;

  const VerletTable<Real>& kernels_;
  HermiteOutput<Real> hermite_;
  AlignedVector<Real> memory_;
  VerletArrays<Real> arrays_;
  Real* acceleration_ = nullptr;
  Real* start_rates_ = nullptr;
  std::int64_t* started_ = nullptr;
  double last_ = 0.0;
};

/// Friction only ever helps: its flow is exact.
double stable_step(double frequency, double) {
  return frequency > 0.0 ? 2.0 / frequency : std::numeric_limits<double>::infinity();
}

/// Under a steady force F the scheme's own steady speed is (h F/2m) coth(h gamma/2), where F/(m
/// gamma) is right.
double drag_error(double damped) {
  const double half = 0.5 * damped;
  return half > 0.0 ? half / std::tanh(half) - 1.0 : 0.0;
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  return std::make_unique<VelocityVerlet<Real>>(system);
}

}  // namespace

IntegratorRecord velocity_verlet_record() {
  IntegratorRecord record;
  record.name = "velocity_verlet";
  record.summary = "velocity Verlet scheme of second order with the exact flow of friction";
  record.equation = "friction h/2, kick h/2, drift h, kick h/2, friction h/2";
  record.source =
      "Swope, Andersen, Berens, Wilson, J. Chem. Phys. 76 (1982) 637, doi:10.1063/1.442716; "
      "friction by splitting";
  record.order = 2;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.splits_friction = true;
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
