#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/scheme.hpp"
#include "integrators/composition_kernels.hpp"
#include "integrators/first_same_as_last.hpp"
#include "integrators/spread_arrays.hpp"

namespace tomlin {

struct CompositionDescription {
  double dt = 0.0;
};

/// Name of a composition, its evaluations per step, its kernels on the scene's set.
template <class Real>
struct CompositionScheme {
  std::string name;
  unsigned drifts = 0;
  const CompositionTable<Real>& kernels;
};

/// Symmetric compositions of kicks and drifts (composition_kernels.hpp). The last forces of a step
/// are the next one's first, so that a step takes as many evaluations as drifts.
template <class Real>
class Composition : public FirstSameAsLast<Real> {
 public:
  Composition(const CompositionScheme<Real>& scheme, System<Real>& system)
      : Base(scheme.name, ".force", ".rates", true, system),
        drifts_(scheme.drifts),
        kernels_(scheme.kernels),
        memory_(13, 5 * system.view.dofs + 7 * system.view.rates + system.view.kinetic_count) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    arrays_.move = memory_.take(n);
    arrays_.position = memory_.take(n);
    arrays_.velocity = memory_.take(n);
    acceleration_ = memory_.take(n);
    arrays_.end_rates = memory_.take(m);
    arrays_.stage_rates = memory_.take(m);
    arrays_.inner_rates = memory_.take(m);
    arrays_.own = memory_.take(m);
    start_rates_ = memory_.take(m);
    arrays_.own_after = memory_.take(m);
    slopes_ = memory_.take(m);
    mass_ = memory_.take(n);
    for (std::size_t i = 0; i < n; ++i) know_mass(i);
    arrays_.mass = mass_;
    arrays_.half_step_energy = memory_.take(system.view.kinetic_count);  // of any number: the last
  }

  void attach(RunState& state) override {
    Base::attach(state);
    arrays_.force = first_;
    arrays_.rates = first_rates_;
  }

  StepReport step_from(double since, double h, bool dense) override {
    if (*started_ == 0) {
      kernels_.first(system_.view, arrays_, since);
      system_.evaluations += 1;
      *started_ = 1;
    }
    std::copy(arrays_.rates, arrays_.rates + system_.view.rates, start_rates_);
    if (dense) {
      kernels_.slopes(system_.view, arrays_, acceleration_, slopes_);
      hermite_.keep_start(system_.view);
      hermite_.keep_first(acceleration_, slopes_);
    }
    last_ = h;
    arrays_.step = static_cast<std::uint64_t>(*step_);
    system_.evaluations += drifts_;
    if (!kernels_.step(system_.view, arrays_, since, h)) {
      return {0.0, StepFault::not_finite_or_too_far};
    }
    std::copy(arrays_.end_rates, arrays_.end_rates + system_.view.rates, arrays_.rates);
    ++*step_;
    return {h, StepFault::none};
  }

  void put_lane(const LaneLayout& layout, std::size_t lane, RunState& run) override {
    if constexpr (std::is_same_v<Real, double>) {
      if (arrays_.lanes == 0) begin_lanes(layout);
      Base::put_lane(layout, lane, run);
      for (std::size_t i = lane; i < system_.view.dofs; i += layout.width) know_mass(i);
    }
  }

  void finish_dense_from(double) override {
    kernels_.slopes(system_.view, arrays_, acceleration_, slopes_);
  }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    hermite_.interpolate(theta, last_, system_.view, acceleration_, slopes_, position, velocity,
                         integrals);
  }

 private:
  using Base = FirstSameAsLast<Real>;
  using Base::first_;
  using Base::first_rates_;
  using Base::hermite_;
  using Base::last_;
  using Base::start_rates_;
  using Base::started_;
  using Base::step_;
  using Base::system_;

  void begin_lanes(const LaneLayout& layout) {
    energies_.assign(system_.view.kinetic_count * layout.width, Real(0.0));
    arrays_.lanes = layout.width;
    arrays_.indices = layout.coordinates.from.data();
    arrays_.half_step_energy = energies_.data();
  }

  void know_mass(std::size_t i) {
    const Real inverse = system_.view.inverse_mass[i];
    mass_[i] = inverse > Real(0.0) ? Real(1.0) / inverse : Real(0.0);
  }

  unsigned drifts_;
  const CompositionTable<Real>& kernels_;
  SpreadArrays<Real> memory_;
  CompositionArrays<Real> arrays_;
  AlignedVector<Real> energies_;
  Real* mass_ = nullptr;
  Real* acceleration_ = nullptr;
  Real* slopes_ = nullptr;  ///< rates for dense output, the operators' among them
};

template <class Scheme, const TablesByType<CompositionTable>& tables, class Real>
std::unique_ptr<Integrator<Real>> bind_composition(const void*, System<Real>& system) {
  return std::make_unique<Composition<Real>>(
      CompositionScheme<Real>{Scheme::name, Scheme::drifts, tables.template on<Real>(system.set)},
      system);
}

/// The record of a scheme with its compiled kernels, but for its order, what it takes, and what
/// only a reader needs. The scheme has a name, its drifts, and `longest`: times the angular
/// frequency of an oscillator, the longest stable step at any friction.
template <class Scheme, const TablesByType<CompositionTable>& tables>
IntegratorRecord composition_record() {
  using Description = CompositionDescription;
  IntegratorRecord record;
  record.name = Scheme::name;
  record.evaluations_per_step = Scheme::drifts;
  record.without_inertia = false;
  record.in_lanes = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = [](double frequency, double) {
    return frequency > 0.0 ? Scheme::longest / frequency : std::numeric_limits<double>::infinity();
  };
  record.step = [](const void* d) { return static_cast<const Description*>(d)->dt; };
  record.complaints = [](const void*) { return std::vector<Complaint>(); };
  record.bind = {&bind_composition<Scheme, tables, double>,
                 &bind_composition<Scheme, tables, Quad>};
  return record;
}

/// Relative error of Verlet steps with the exact flow of friction: under a steady force F their
/// steady speed is (h F/2m) coth(h gamma/2), where F/(m gamma) is right.
inline double verlet_drag_error(double damped) {
  const double half = 0.5 * damped;
  return half > 0.0 ? half / std::tanh(half) - 1.0 : 0.0;
}

}  // namespace tomlin
