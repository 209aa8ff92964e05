#include "integrators/rk4.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "framework/core/instruction_set.hpp"
#include "framework/core/integrator.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/scheme.hpp"
#include "integrators/hermite.hpp"
#include "integrators/rk4_kernels.hpp"

TOMLIN_DECLARE_TABLES(Rk4Kernels, Rk4Table)

namespace tomlin {
namespace {

using Description = Rk4Description;

/// What both forms of the scheme hold.
template <class Real>
class Rk4Base : public Integrator<Real> {
 public:
  explicit Rk4Base(System<Real>& system)
      : Integrator<Real>(system),
        kernels_(kernels::Rk4Kernels.on<Real>(system.set)),
        hermite_(system.view.dofs, system.view.rates) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    memory_.assign(7 * (n + kGap) + 5 * (m + kGap) + system.view.own + kGap, Real(0.0));
    next_ = memory_.data();
    for (Real*& a : arrays_.acceleration) a = take(n);
    arrays_.stage_position = take(n);
    arrays_.stage_velocity = take(n);
    for (Real*& g : arrays_.rates) g = take(m);
    arrays_.stage_own = take(system.view.own);
  }

 protected:
  /// Between arrays, to keep them off powers of two.
  static constexpr std::size_t kGap = 3 * kGroup;

  Real* take(std::size_t count) { return std::exchange(next_, next_ + count + kGap); }

  const Rk4Table<Real>& kernels_;
  Rk4Arrays<Real> arrays_;
  HermiteOutput<Real> hermite_;
  double last_ = 0.0;

 private:
  AlignedVector<Real> memory_;
  Real* next_ = nullptr;
};

template <class Real>
class Rk4 : public Rk4Base<Real> {
 public:
  using Rk4Base<Real>::Rk4Base;

  StepReport step_from(double since, double h, bool dense) override {
    system_.evaluations += arrays_.first_known ? 3 : 4;
    if (dense) hermite_.keep_start(system_.view);
    last_ = h;
    if (!one_step(since, h, dense)) return {0.0, StepFault::not_finite_or_too_far};
    arrays_.first_known = false;
    return {h, StepFault::none};
  }

  bool has_point_block() const override {
    return kernels_.point_block != nullptr && system_.view.point_force_count > 0;
  }

  std::size_t point_block(std::size_t first, double h, std::size_t most, Real* rates,
                          Real* velocities) override {
    std::size_t taken = 0;
    if (arrays_.first_known && most > 0) {
      // After a sample the first evaluation is there already; either path has the same bits.
      velocities[0] = system_.view.velocity[0];
      std::copy(arrays_.rates[0], arrays_.rates[0] + system_.view.rates, rates);
      if (step_from(static_cast<double>(first) * h, h, false).fault != StepFault::none) return 0;
      taken = 1;
    }
    const std::size_t more =
        kernels_.point_block(system_.view, 0.0, first + taken, h, most - taken,
                             rates + taken * system_.view.rates, velocities + taken);
    system_.evaluations += 4 * more;
    return taken + more;
  }

  const Real* first_rates() const override { return arrays_.rates[0]; }

  void finish_dense_from(double since) override {
    hermite_.keep_first(arrays_.acceleration[0], arrays_.rates[0]);
    kernels_.first(system_.view, arrays_, since);
    system_.evaluations += 1;
    arrays_.first_known = true;
  }

  void rebased() override { arrays_.first_known = false; }
  std::uint64_t evaluations_ahead() const override { return arrays_.first_known ? 1 : 0; }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    hermite_.interpolate(theta, last_, system_.view, arrays_.acceleration[0], arrays_.rates[0],
                         position, velocity, integrals);
  }

 private:
  /// A particle alone takes the same step in registers, unless its accelerations are wanted after.
  bool one_step(double since, double h, bool dense) {
    if (dense || arrays_.first_known || !has_point_block()) {
      return kernels_.step(system_.view, arrays_, since, h);
    }
    Real start_velocity;
    return kernels_.point_block(system_.view, since, 0, h, 1, arrays_.rates[0], &start_velocity) ==
           1;
  }

  using Base = Rk4Base<Real>;
  using Base::arrays_;
  using Base::hermite_;
  using Base::kernels_;
  using Base::last_;
  using Integrator<Real>::system_;
};

/// Without inertia. The velocity is the slope at the end of a step, which is the next one's first:
/// it is part of the state.
template <class Real>
class Rk4Drift : public Rk4Base<Real> {
 public:
  explicit Rk4Drift(System<Real>& system)
      : Rk4Base<Real>(system), start_rates_(Base::take(system.view.rates)) {}

  void declare(StateLayout& layout) override {
    layout.add_numbers<Real>("rk4.first_slope", system_.view.dofs);
    layout.add_numbers<Real>("rk4.first_rates", system_.view.rates);
    layout.add_integers("rk4.started", 1);
  }

  void attach(RunState& state) override {
    arrays_.acceleration[0] = state.numbers<Real>("rk4.first_slope");
    arrays_.rates[0] = state.numbers<Real>("rk4.first_rates");
    started_ = state.integers("rk4.started");
  }

  StepReport step_from(double since, double h, bool dense) override {
    if (*started_ == 0) {
      kernels_.first(system_.view, arrays_, since);
      std::copy(arrays_.acceleration[0], arrays_.acceleration[0] + system_.view.dofs,
                system_.view.velocity);
      system_.evaluations += 1;
      *started_ = 1;
    }
    if (dense) {
      hermite_.keep_start(system_.view);
      hermite_.keep_first(arrays_.acceleration[0], arrays_.rates[0]);
    }
    std::copy(arrays_.rates[0], arrays_.rates[0] + system_.view.rates, start_rates_);
    system_.evaluations += 4;
    last_ = h;
    const bool sound = kernels_.drift(system_.view, arrays_, since, h);
    if (!sound) return {0.0, StepFault::not_finite_or_too_far};
    return {h, StepFault::none};
  }

  const Real* first_rates() const override { return start_rates_; }
  void forces_changed() override { *started_ = 0; }

  void finish_dense_from(double) override {}

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    hermite_.interpolate(theta, last_, system_.view, arrays_.acceleration[0], arrays_.rates[0],
                         position, velocity, integrals);
  }

 private:
  using Base = Rk4Base<Real>;
  using Base::arrays_;
  using Base::hermite_;
  using Base::kernels_;
  using Base::last_;
  using Integrator<Real>::system_;

  Real* start_rates_;
  std::int64_t* started_ = nullptr;
};

double growth(std::complex<double> z) {
  return std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void*, System<Real>& system) {
  if (!system.view.inertial) return std::make_unique<Rk4Drift<Real>>(system);
  return std::make_unique<Rk4<Real>>(system);
}

}  // namespace

IntegratorRecord rk4_record() {
  IntegratorRecord record;
  record.name = "rk4";
  record.summary = "classical Runge-Kutta scheme of fourth order with a fixed step";
  record.equation = "y' = f: y + h/6 (k1 + 2 k2 + 2 k3 + k4)";
  record.source =
      "W. Kutta (1901); Hairer, Norsett, Wanner, Solving Ordinary Differential "
      "Equations I, section II.1, doi:10.1007/978-3-540-78862-1";
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
