#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/scheme.hpp"
#include "integrators/first_same_as_last.hpp"
#include "integrators/fixed_step_kernels.hpp"
#include "integrators/hermite.hpp"
#include "integrators/spread_arrays.hpp"

/// Explicit Runge-Kutta schemes with a fixed step, around the kernels of one of them.
namespace tomlin {

struct FixedStepDescription {
  double dt = 0.0;
};

/// One of them: what it is called, its evaluations per step, its kernels on the scene's set.
template <class Real>
struct FixedStepScheme {
  std::string name;
  unsigned stages = 0;
  const FixedStepTable<Real>& kernels;
};

/// Common parts of both forms of the scheme.
template <class Real>
class FixedStepParts {
 public:
  FixedStepParts(const FixedStepScheme<Real>& scheme, const SystemView<Real>& view)
      : stages_(scheme.stages),
        kernels_(scheme.kernels),
        memory_(13, 7 * view.dofs + 5 * view.rates + view.own) {
    for (Real*& a : arrays_.acceleration) a = memory_.take(view.dofs);
    arrays_.stage_position = memory_.take(view.dofs);
    arrays_.stage_velocity = memory_.take(view.dofs);
    for (Real*& g : arrays_.rates) g = memory_.take(view.rates);
    arrays_.stage_own = memory_.take(view.own);
  }

 protected:
  unsigned stages_;
  const FixedStepTable<Real>& kernels_;
  FixedStepArrays<Real> arrays_;
  SpreadArrays<Real> memory_;
};

template <class Real>
class FixedStep : public Integrator<Real>, public PointBlocks<Real>, private FixedStepParts<Real> {
 public:
  FixedStep(const FixedStepScheme<Real>& scheme, System<Real>& system)
      : Integrator<Real>(system),
        FixedStepParts<Real>(scheme, system.view),
        hermite_(system.view.dofs, system.view.rates) {}

  StepReport step_from(double since, double h, bool dense) override {
    system_.evaluations += arrays_.first_known ? stages_ - 1 : stages_;
    if (dense) hermite_.keep_start(system_.view);
    last_ = h;
    if (!one_step(since, h, dense)) return {0.0, StepFault::not_finite_or_too_far};
    arrays_.first_known = false;
    return {h, StepFault::none};
  }

  Capabilities<Real> capabilities() override {
    return {.point_blocks = is_in_registers() ? this : nullptr};
  }

  std::size_t point_block(std::size_t first, double h, std::size_t most,
                          const PointStarts<Real>& starts) override {
    std::size_t taken = 0;
    if (arrays_.first_known && most > 0) {
      // After a sample the first evaluation is there already; either path has the same bits.
      starts.positions[0] = system_.view.position[0];
      starts.velocities[0] = system_.view.velocity[0];
      std::copy(arrays_.rates[0], arrays_.rates[0] + system_.view.rates, starts.rates);
      if (step_from(static_cast<double>(first) * h, h, false).fault != StepFault::none) return 0;
      taken = 1;
    }
    const std::size_t more = kernels_.point_block(system_.view, 0.0, first + taken, h, most - taken,
                                                  starts.from(taken, system_.view.rates));
    system_.evaluations += stages_ * more;
    return taken + more;
  }

  /// Rates that no operation writes any more are none.
  void forces_changed() override {
    rebased();
    const SystemView<Real>& view = system_.view;
    for (Real* rates : arrays_.rates) {
      if (rates) std::fill(rates + view.used_rates, rates + view.rates, Real(0.0));
    }
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
  bool is_in_registers() const {
    return kernels_.point_block != nullptr && system_.view.point_force_count > 0;
  }

  /// A particle alone takes the same step in registers, unless its accelerations are wanted after.
  bool one_step(double since, double h, bool dense) {
    if (dense || arrays_.first_known || !is_in_registers()) {
      return kernels_.step(system_.view, arrays_, since, h);
    }
    Real position;
    Real velocity;
    return kernels_.point_block(system_.view, since, 0, h, 1,
                                {arrays_.rates[0], &position, &velocity}) == 1;
  }

  using FixedStepParts<Real>::arrays_;
  using FixedStepParts<Real>::kernels_;
  using FixedStepParts<Real>::stages_;
  using Integrator<Real>::system_;

  HermiteOutput<Real> hermite_;
  double last_ = 0.0;
};

/// Without inertia. The velocity is the slope at the end of a step, which is the next one's first:
/// it is part of the state.
template <class Real>
class FixedStepDrift : public FirstSameAsLast<Real>, private FixedStepParts<Real> {
 public:
  FixedStepDrift(const FixedStepScheme<Real>& scheme, System<Real>& system)
      : Base(scheme.name, ".first_slope", ".first_rates", false, system),
        FixedStepParts<Real>(scheme, system.view) {
    start_rates_ = memory_.take(system.view.rates);
  }

  void attach(RunState& state) override {
    Base::attach(state);
    arrays_.acceleration[0] = first_;
    arrays_.rates[0] = first_rates_;
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
    system_.evaluations += stages_;
    last_ = h;
    const bool valid = kernels_.drift(system_.view, arrays_, since, h);
    if (!valid) return {0.0, StepFault::not_finite_or_too_far};
    return {h, StepFault::none};
  }

 private:
  using Base = FirstSameAsLast<Real>;
  using Base::first_;
  using Base::first_rates_;
  using Base::hermite_;
  using Base::last_;
  using Base::start_rates_;
  using Base::started_;
  using Base::system_;
  using FixedStepParts<Real>::arrays_;
  using FixedStepParts<Real>::kernels_;
  using FixedStepParts<Real>::memory_;
  using FixedStepParts<Real>::stages_;
};

template <class Real>
std::unique_ptr<Integrator<Real>> make_fixed_step(const FixedStepScheme<Real>& scheme,
                                                  System<Real>& system) {
  if (!system.view.inertial) return std::make_unique<FixedStepDrift<Real>>(scheme, system);
  return std::make_unique<FixedStep<Real>>(scheme, system);
}

template <class Tableau, const TablesByType<FixedStepTable>& tables, class Real>
std::unique_ptr<Integrator<Real>> bind_fixed_step(const void*, System<Real>& system) {
  return make_fixed_step<Real>({Tableau::name, Tableau::stages, tables.on<Real>(system.set)},
                               system);
}

/// The record of a tableau (explicit_tableau.hpp) with its compiled kernels, but for what only a
/// reader needs: summary, equation, source, example.
template <class Tableau, const TablesByType<FixedStepTable>& tables>
IntegratorRecord fixed_step_record() {
  using Description = FixedStepDescription;
  IntegratorRecord record;
  record.name = Tableau::name;
  record.order = Tableau::order;
  record.evaluations_per_step = Tableau::stages;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  // hypot would take longer than all else, and nothing here overflows.
  record.growth = [](std::complex<double> z) {
    return std::sqrt(std::norm(stability_function<Tableau>(z)));
  };
  record.in_lanes = true;
  record.step = [](const void* d) { return static_cast<const Description*>(d)->dt; };
  record.complaints = [](const void*) { return std::vector<Complaint>(); };
  record.bind = {&bind_fixed_step<Tableau, tables, double>,
                 &bind_fixed_step<Tableau, tables, Quad>};
  return record;
}

}  // namespace tomlin
