#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/scheme.hpp"
#include "integrators/brownian_kernels.hpp"
#include "integrators/first_same_as_last.hpp"
#include "integrators/spread_arrays.hpp"

TOMLIN_DECLARE_TABLES(BrownianKernels, BrownianTable)

/// Schemes without inertia that displace coordinates by noise, one evaluation a step.
namespace tomlin {

struct BrownianDescription {
  double dt = 0.0;
};

/// Noise of a step: the mean of the normal numbers of this step and the next, or those of this one.
enum class BrownianNoise { of_the_step, averaged };

template <class Real>
class Brownian : public FirstSameAsLast<Real> {
 public:
  Brownian(const std::string& name, BrownianNoise noise, System<Real>& system)
      : Base(name, ".slope", ".rates", true, system),
        noise_(noise),
        kernels_(kernels::BrownianKernels.on<Real>(system.set)),
        memory_(8, 5 * system.view.dofs + 2 * system.view.rates + system.view.own) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    arrays_.move = memory_.take(n);
    arrays_.position = memory_.take(n);
    displacements_ = memory_.take(n);
    this_step_ = memory_.take(n);
    next_step_ = memory_.take(n);
    arrays_.end_rates = memory_.take(m);
    start_rates_ = memory_.take(m);
    arrays_.own = memory_.take(system.view.own);
    arrays_.noise = displacements_;
  }

  void attach(RunState& state) override {
    Base::attach(state);
    arrays_.slope = first_;
    arrays_.rates = first_rates_;
  }

  StepReport step_from(double since, double h, bool dense) override {
    const SystemView<Real>& s = system_.view;
    if (*started_ == 0) {
      kernels_.first(s, arrays_, since);
      std::copy(arrays_.slope, arrays_.slope + s.dofs, s.velocity);
      system_.evaluations += 1;
      *started_ = 1;
    }
    if (dense) {
      hermite_.keep_start(s);
      hermite_.keep_first(arrays_.slope, arrays_.rates);
    }
    std::copy(arrays_.rates, arrays_.rates + s.rates, start_rates_);
    draw(static_cast<std::uint64_t>(*step_));
    last_ = h;
    system_.evaluations += 1;
    if (!kernels_.step(s, arrays_, since, h)) return {0.0, StepFault::not_finite_or_too_far};
    std::copy(arrays_.end_rates, arrays_.end_rates + s.rates, arrays_.rates);
    ++*step_;
    return {h, StepFault::none};
  }

  void put_lane(const LaneLayout& layout, std::size_t lane, RunState& run) override {
    Base::put_lane(layout, lane, run);
    known_ = kNone;
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

  void fill(std::uint64_t step, Real* numbers) {
    for (std::size_t k = 0; k < system_.view.noise_count; ++k) {
      const Noise<Real>& noise = system_.view.noises[k];
      noise.fill(noise.arguments, noise.key, step, numbers);
    }
  }

  void draw(std::uint64_t step) {
    if (system_.view.noise_count == 0) return;
    if (noise_ == BrownianNoise::of_the_step) {
      fill(step, displacements_);
      return;
    }
    if (known_ == step) {
      std::swap(this_step_, next_step_);
    } else {
      fill(step, this_step_);
    }
    fill(step + 1, next_step_);
    known_ = step + 1;
    for (std::size_t i = 0; i < system_.view.dofs; ++i) {
      displacements_[i] = Real(0.5) * (this_step_[i] + next_step_[i]);
    }
  }

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  BrownianNoise noise_;
  const BrownianTable<Real>& kernels_;
  SpreadArrays<Real> memory_;
  BrownianArrays<Real> arrays_;
  Real* displacements_ = nullptr;
  Real* this_step_ = nullptr;
  Real* next_step_ = nullptr;
  std::uint64_t known_ = kNone;  ///< the step whose numbers next_step_ has
};

template <class Scheme, class Real>
std::unique_ptr<Integrator<Real>> bind_brownian(const void*, System<Real>& system) {
  return std::make_unique<Brownian<Real>>(Scheme::name, Scheme::noise, system);
}

/// Relative error of Euler steps, `relaxed` below 2: the variance is T/k / (1 - relaxed/2).
inline double euler_variance_error(double relaxed) { return 0.5 * relaxed / (1.0 - 0.5 * relaxed); }

/// The record of one of them, which has a name and its noise, but for what only a reader needs.
template <class Scheme>
IntegratorRecord brownian_record() {
  using Description = BrownianDescription;
  IntegratorRecord record;
  record.name = Scheme::name;
  record.order = 1;
  record.evaluations_per_step = 1;
  record.with_inertia = false;
  record.takes_noise = true;
  record.in_lanes = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.growth = [](std::complex<double> z) { return std::abs(1.0 + z); };
  if (Scheme::noise == BrownianNoise::of_the_step) record.variance_error = &euler_variance_error;
  record.step = [](const void* d) { return static_cast<const Description*>(d)->dt; };
  record.complaints = [](const void*) { return std::vector<Complaint>(); };
  record.bind = {&bind_brownian<Scheme, double>, &bind_brownian<Scheme, Quad>};
  record.example =
      std::string(R"(# A particle without inertia drifts over a corrugation in a thermal bath.
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [0.5]

[[force]]
type = "langevin"
coefficient = 1.0
temperature = 0.2

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
dynamics = "overdamped"
duration = 100.0
integrator = { type = ")") +
      Scheme::name + R"(", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
