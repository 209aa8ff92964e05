#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "framework/core/numbers/math.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/core/system/tolerance.hpp"
#include "integrators/adaptive.hpp"
#include "integrators/embedded_kernels.hpp"
#include "integrators/spread_arrays.hpp"

/// Adaptive schemes around the kernels of an embedded pair: step control, failure, dense output.
namespace tomlin {

inline constexpr double kLeastOldError = 1e-4;

/// The next step after an attempt that was accepted; `factor`: see EmbeddedTable::accepted_factor.
inline double next_after(const StepControl& law, double step, double error, double factor,
                         bool refused) {
  if (!(error > 0.0)) factor = law.most_factor;
  return step * std::clamp(factor, law.least_factor, refused ? 1.0 : law.most_factor);
}

/// The next attempt after one that was refused; `factor`: see EmbeddedTable::refused_factor.
inline double next_after_refusal(const StepControl& law, double step, double error, double factor) {
  const bool is_known = error > 1.0 && std::isfinite(error);
  const double wanted = is_known ? std::max(law.least_factor, factor) : law.least_factor;
  return step * std::min(wanted, kSafetyOfStep);
}

template <class Real>
struct EmbeddedScheme {
  std::string name;
  int end = 0;    ///< the stage at the end of a step
  int extra = 0;  ///< evaluations for dense output alone, in a step that is looked into
  StepControl control;
  const EmbeddedTable<Real>& kernels;
};

template <class Real>
class EmbeddedPair : public Integrator<Real>, public ErrorControl, public DenseRates {
 public:
  EmbeddedPair(const EmbeddedScheme<Real>& scheme, const AdaptiveDescription& description,
               System<Real>& system)
      : Integrator<Real>(system),
        d_(description),
        time_(static_cast<double>(tolerance_scales(system.view).time)),
        name_(scheme.name),
        end_(scheme.end),
        slopes_(scheme.end + 1 + scheme.extra),
        control_law_(scheme.control),
        kernels_(scheme.kernels),
        memory_(static_cast<std::size_t>(3 * slopes_ + 8),
                static_cast<std::size_t>(2 * slopes_ + 4) * system.view.dofs +
                    static_cast<std::size_t>(slopes_ + 4) * system.view.rates) {
    d_.absolute_tolerance /= static_cast<double>(tolerance_scales(system.view).length);
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    for (int s = 0; s < slopes_; ++s) arrays_.velocity[s] = memory_.take(n);
    for (int s = 1; s < slopes_; ++s) arrays_.acceleration[s] = memory_.take(n);
    for (int s = 1; s < slopes_; ++s) arrays_.rates[s] = memory_.take(m);
    arrays_.position = memory_.take(n);
    arrays_.integrals = memory_.take(m);
    start_position_ = memory_.take(n);
    start_acceleration_ = memory_.take(n);
    start_integrals_ = memory_.take(m);
    start_rates_ = memory_.take(m);
  }

  void declare(StateLayout& layout) override {
    layout.add_numbers<Real>(name_ + ".first_acceleration", system_.view.dofs);
    layout.add_numbers<Real>(name_ + ".first_rates", system_.view.rates);
    layout.add_reals(name_ + ".control", 2);
    layout.add_integers(name_ + ".counts", 3);
  }

  void attach(RunState& state) override {
    arrays_.acceleration[0] = state.numbers<Real>(name_ + ".first_acceleration");
    arrays_.rates[0] = state.numbers<Real>(name_ + ".first_rates");
    control_ = state.reals(name_ + ".control");
    counts_ = state.integers(name_ + ".counts");
  }

  StepReport step_from(double since, double h, bool) override {
    if (counts_[kStarted] != kYes) start(since, h);
    const StepControl& law = control_law_;
    double next = control_[kNext];
    double last_error = control_[kOldError];
    bool refused = false;
    for (;;) {
      next = std::min(next, d_.largest_step);
      const bool ends = kStretchOfStep * next >= h && h <= d_.largest_step;
      const double trial_step = ends ? h : next;
      if (counts_[kTaken] + counts_[kRefused] >= d_.most_steps) {
        return {0.0, StepFault::too_many_steps};
      }
      const EmbeddedTrial trial = kernels_.attempt(system_.view, arrays_, since, trial_step,
                                                   d_.absolute_tolerance, d_.relative_tolerance);
      system_.evaluations += trial.evaluations;
      if (trial.error <= 1.0 && trial.within_moves) {
        // A step cut short by the end of the run says nothing against a longer one.
        const double factor = kernels_.accepted_factor(law, trial.error, last_error);
        next = std::max(next_after(law, trial_step, trial.error, factor, refused),
                        ends && !refused ? next : 0.0);
        control_[kNext] = next;
        control_[kOldError] = std::max(trial.error, kLeastOldError);
        accept(trial_step);
        ++counts_[kTaken];
        return {trial_step, StepFault::none};
      }
      ++counts_[kRefused];
      refused = true;
      next = next_after_refusal(law, trial_step, trial.error,
                                kernels_.refused_factor(law, trial.error));
      if (!(next >= d_.smallest_step)) {
        const bool valid = trial.within_moves && std::isfinite(trial.error);
        return {0.0, valid ? StepFault::step_too_small : StepFault::not_finite_or_too_far};
      }
    }
  }

  const Real* first_rates() const override { return start_rates_; }
  void forces_changed() override {
    if (counts_[kStarted] == kYes) counts_[kStarted] = kRefresh;
  }
  bool is_started() const override { return counts_[kStarted] == kYes; }
  Capabilities<Real> capabilities() override {
    return {.error_control = this, .dense_rates = this};
  }

  void finish_dense_from(double since) override {
    if (kernels_.extra == nullptr || extra_known_) return;
    SystemView<Real> start = system_.view;
    start.position = start_position_;
    start.velocity = arrays_.velocity[0];
    start.integrals = start_integrals_;
    EmbeddedArrays<Real> step = arrays_;
    step.acceleration[0] = start_acceleration_;
    step.acceleration[end_] = arrays_.acceleration[0];
    step.rates[0] = start_rates_;
    step.rates[end_] = arrays_.rates[0];
    kernels_.extra(start, step, since - last_, last_);
    system_.evaluations += static_cast<unsigned>(slopes_ - end_ - 1);
    extra_known_ = true;
  }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    kernels_.extension(positions(), theta, position);
    velocity_within(theta, velocity);
    kernels_.extension(integrals_of_step(system_.view.rates), theta, integrals);
  }

  void between(double theta, double* velocity, double* rates) const override {
    if (system_.view.inertial && kernels_.extra == nullptr) {
      kernels_.extension(velocities(), theta, velocity);
    } else {
      kernels_.slope_within(positions(), theta, velocity);
    }
    kernels_.slope_within(integrals_of_step(system_.view.used_rates), theta, rates);
  }

  std::uint64_t refused_steps() const override {
    return static_cast<std::uint64_t>(counts_[kRefused]);
  }

 private:
  enum { kNext, kOldError };
  enum { kStarted, kTaken, kRefused };
  /// Whether the first stage of the next step is known. kRefresh: all but that.
  enum { kNo, kYes, kRefresh };

  void start(double since, double h) {
    kernels_.first(system_.view, arrays_, since);
    system_.evaluations += 1;
    const bool anew = std::exchange(counts_[kStarted], kYes) == kRefresh;
    if (anew) return;
    control_[kNext] = d_.initial_step > 0.0 ? d_.initial_step : std::min(h, guessed_step());
    control_[kOldError] = kLeastOldError;
  }

  /// A step over which the state changes by about a hundredth of its size, and by an Euler step no
  /// more than the tolerance allows (Hairer, Norsett, Wanner, section II.4).
  double guessed_step() const {
    const SystemView<Real>& s = system_.view;
    const ToleranceScales<Real> scales = tolerance_scales(s);
    // Sums that do not depend on the order of bodies, as in the error estimate.
    DoubleDouble sizes;
    DoubleDouble slopes;
    for (std::size_t i = 0; i < s.dofs; ++i) {
      const auto scale = static_cast<double>(scales.velocity[i]);  // all in the scene's own units
      const double x = static_cast<double>(s.position[i]) * static_cast<double>(scales.position[i]);
      const double v = static_cast<double>(s.velocity[i]) * scale;
      const double a = static_cast<double>(arrays_.acceleration[0][i]) * scale * time_;
      const double weight_x = d_.absolute_tolerance + d_.relative_tolerance * std::abs(x) + 1e-300;
      const double weight_v = d_.absolute_tolerance + d_.relative_tolerance * std::abs(v) + 1e-300;
      sizes += x / weight_x * (x / weight_x);
      slopes += v / weight_x * (v / weight_x);
      if (!s.inertial) continue;
      sizes += v / weight_v * (v / weight_v);
      slopes += a / weight_v * (a / weight_v);
    }
    const double size = std::sqrt(static_cast<double>(sizes));
    const double slope = std::sqrt(static_cast<double>(slopes));
    const double guess = (size < 1e-5 || slope < 1e-5 ? 1e-6 : 0.01 * size / slope) * time_;
    const double least = std::max(d_.smallest_step, 1e-10 * time_);
    return std::min(std::max(guess, least), d_.largest_step);
  }

  void accept(double h) {
    SystemView<Real>& s = system_.view;
    copy(s.position, s.dofs, start_position_);
    copy(s.integrals, s.rates, start_integrals_);
    copy(arrays_.acceleration[0], s.dofs, start_acceleration_);
    copy(arrays_.rates[0], s.rates, start_rates_);
    copy(arrays_.position, s.dofs, s.position);
    copy(arrays_.velocity[end_], s.dofs, s.velocity);
    copy(arrays_.integrals, s.rates, s.integrals);
    copy(arrays_.acceleration[end_], s.dofs, arrays_.acceleration[0]);
    copy(arrays_.rates[end_], s.rates, arrays_.rates[0]);
    last_ = h;
    extra_known_ = false;
  }

  static void copy(const Real* from, std::size_t n, Real* to) {
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i];
  }

  // The last step, for its continuous extension. Its last stage is kept as the next one's first.

  EmbeddedStep<Real> positions() const {
    const SystemView<Real>& s = system_.view;
    EmbeddedStep<Real> step = {last_, s.dofs, start_position_, s.position, {}};
    for (int j = 0; j < slopes_; ++j) step.slope[j] = arrays_.velocity[j];
    return step;
  }

  EmbeddedStep<Real> velocities() const {
    const SystemView<Real>& s = system_.view;
    EmbeddedStep<Real> step = {last_, s.dofs, arrays_.velocity[0], s.velocity, {}};
    for (int j = 1; j < slopes_; ++j) step.slope[j] = arrays_.acceleration[j];
    step.slope[0] = start_acceleration_;
    step.slope[end_] = arrays_.acceleration[0];
    return step;
  }

  EmbeddedStep<Real> integrals_of_step(std::size_t count) const {
    const SystemView<Real>& s = system_.view;
    EmbeddedStep<Real> step = {last_, count, start_integrals_, s.integrals, {}};
    for (int j = 1; j < slopes_; ++j) step.slope[j] = arrays_.rates[j];
    step.slope[0] = start_rates_;
    step.slope[end_] = arrays_.rates[0];
    return step;
  }

  /// Without inertia velocities are the slope of positions.
  void velocity_within(double theta, double* velocity) const {
    if (system_.view.inertial) {
      kernels_.extension(velocities(), theta, velocity);
    } else {
      kernels_.extension_slope(positions(), theta, velocity);
    }
  }

  AdaptiveDescription
      d_;        ///< but for the absolute tolerance, which is a part of the scene's length
  double time_;  ///< of the scene
  std::string name_;
  int end_;
  int slopes_;
  StepControl control_law_;
  using Integrator<Real>::system_;
  const EmbeddedTable<Real>& kernels_;
  SpreadArrays<Real> memory_;
  EmbeddedArrays<Real> arrays_;
  double* control_ = nullptr;
  std::int64_t* counts_ = nullptr;
  Real* start_position_ = nullptr;
  Real* start_acceleration_ = nullptr;
  Real* start_integrals_ = nullptr;
  Real* start_rates_ = nullptr;
  double last_ = 0.0;
  bool extra_known_ = false;
};

}  // namespace tomlin
