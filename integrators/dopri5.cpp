#include "integrators/dopri5.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/core/integrator.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/math.hpp"
#include "framework/core/scheme.hpp"
#include "integrators/dopri5_kernels.hpp"

TOMLIN_DECLARE_TABLES(Dopri5Kernels, Dopri5Table)

namespace tomlin {
namespace {

using Description = Dopri5Description;
using Tableau = Dopri5Tableau;

// The PI controller of Hairer and Wanner's code, with their constants.
constexpr double kSafety = 0.9;
constexpr double kBeta = 0.04;
constexpr double kExponent = 0.2 - 0.75 * kBeta;
constexpr double kLeastFactor = 0.2;
constexpr double kMostFactor = 10.0;
constexpr double kLeastOldError = 1e-4;
/// A remainder below this part of a step is taken along with it.
constexpr double kStretch = 1.01;

template <class Real>
class Dopri5 : public Integrator<Real> {
 public:
  Dopri5(const Description& description, System<Real>& system)
      : Integrator<Real>(system),
        d_(description),
        kernels_(kernels::Dopri5Kernels.on<Real>(system.set)) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    memory_.assign(21 * (n + kGap) + 11 * (m + kGap), Real(0.0));
    Real* next = memory_.data();
    const auto take = [&next](std::size_t count) {
      return std::exchange(next, next + count + kGap);
    };
    for (Real*& v : arrays_.velocity) v = take(n);
    for (int s = 1; s < Tableau::stages; ++s) arrays_.acceleration[s] = take(n);
    for (int s = 1; s < Tableau::stages; ++s) arrays_.rates[s] = take(m);
    arrays_.position = take(n);
    arrays_.integrals = take(m);
    start_position_ = take(n);
    start_acceleration_ = take(n);
    start_integrals_ = take(m);
    start_rates_ = take(m);
    if (kCompensated<Real>) {
      arrays_.position_rest = take(n);
      arrays_.velocity_rest = take(n);
      arrays_.integrals_rest = take(m);
      start_position_rest_ = take(n);
      start_integrals_rest_ = take(m);
    }
  }

  void declare(StateLayout& layout) override {
    layout.add_numbers<Real>("dopri5.first_acceleration", system_.view.dofs);
    layout.add_numbers<Real>("dopri5.first_rates", system_.view.rates);
    layout.add_reals("dopri5.control", 2);
    layout.add_integers("dopri5.counts", 3);
  }

  void attach(RunState& state) override {
    arrays_.acceleration[0] = state.numbers<Real>("dopri5.first_acceleration");
    arrays_.rates[0] = state.numbers<Real>("dopri5.first_rates");
    control_ = state.reals("dopri5.control");
    counts_ = state.integers("dopri5.counts");
  }

  StepReport step_from(double since, double h, bool) override {
    if (counts_[kStarted] != kYes) start(since, h);
    double next = control_[kNext];
    double last_error = control_[kOldError];
    bool refused = false;
    for (;;) {
      next = std::min(next, d_.largest_step);
      const bool ends = kStretch * next >= h && h <= d_.largest_step;
      const double trial_step = ends ? h : next;
      if (counts_[kTaken] + counts_[kRefused] >= d_.most_steps) {
        return {0.0, StepFault::too_many_steps};
      }
      const Dopri5Trial trial = kernels_.attempt(system_.view, arrays_, since, trial_step,
                                                 d_.absolute_tolerance, d_.relative_tolerance);
      system_.evaluations += Tableau::stages - 1;
      if (trial.error <= 1.0 && trial.within_moves) {
        double factor = kSafety;
        if (trial.error > 0.0) {
          factor *= pow(trial.error, -kExponent) * pow(last_error, kBeta);
        } else {
          factor = kMostFactor;
        }
        factor = std::clamp(factor, kLeastFactor, refused ? 1.0 : kMostFactor);
        // A step cut short by the end of the run says nothing against a longer one.
        next =
            std::max(trial_step * factor, ends && !refused ? std::min(next, d_.largest_step) : 0.0);
        control_[kNext] = next;
        control_[kOldError] = std::max(trial.error, kLeastOldError);
        accept(trial_step);
        ++counts_[kTaken];
        return {trial_step, StepFault::none};
      }
      ++counts_[kRefused];
      refused = true;
      double factor = kLeastFactor;
      if (trial.error > 1.0 && std::isfinite(trial.error)) {
        factor = std::max(kLeastFactor, kSafety * pow(trial.error, -kExponent));
      }
      next = trial_step * std::min(factor, kSafety);
      if (!(next >= d_.smallest_step)) {
        const bool sound = trial.within_moves && std::isfinite(trial.error);
        return {0.0, sound ? StepFault::step_too_small : StepFault::not_finite_or_too_far};
      }
    }
  }

  const Real* first_rates() const override { return start_rates_; }
  void forces_changed() override {
    if (counts_[kStarted] == kYes) counts_[kStarted] = kAnew;
  }

  void finish_dense_from(double) override {}

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    kernels_.extension(positions(), theta, position);
    velocity_within(theta, velocity);
    kernels_.extension(integrals_of_step(system_.view.rates), theta, integrals);
  }

  bool between(double theta, double* velocity, double* rates) const override {
    velocity_within(theta, velocity);
    kernels_.extension_slope(integrals_of_step(system_.view.used_rates), theta, rates);
    return true;
  }

  std::uint64_t refused_steps() const override {
    return static_cast<std::uint64_t>(counts_[kRefused]);
  }

 private:
  static constexpr std::size_t kGap = 3 * kGroup;
  enum { kNext, kOldError };
  enum { kStarted, kTaken, kRefused };
  /// Whether the first stage of the next step is known. kAnew: all but that.
  enum { kNo, kYes, kAnew };

  void start(double since, double h) {
    kernels_.first(system_.view, arrays_, since);
    system_.evaluations += 1;
    const bool anew = std::exchange(counts_[kStarted], kYes) == kAnew;
    if (anew) return;
    control_[kNext] = d_.initial_step > 0.0 ? d_.initial_step : std::min(h, guessed_step());
    control_[kOldError] = kLeastOldError;
  }

  /// A step over which the state changes by about a hundredth of its size, and by an Euler step no
  /// more than the tolerance allows (Hairer, Norsett, Wanner, section II.4).
  double guessed_step() const {
    const SystemView<Real>& s = system_.view;
    // Sums that do not depend on the order of bodies, as in the error estimate.
    DoubleDouble sizes;
    DoubleDouble slopes;
    for (std::size_t i = 0; i < s.dofs; ++i) {
      const auto scale = static_cast<double>(s.tolerance_scale[i]);
      const double x = static_cast<double>(s.position[i]) * scale;
      const double v = static_cast<double>(s.velocity[i]) * scale;
      const double a = static_cast<double>(arrays_.acceleration[0][i]) * scale;
      const double weight_x = d_.absolute_tolerance + d_.relative_tolerance * std::abs(x) + 1e-300;
      const double weight_v = d_.absolute_tolerance + d_.relative_tolerance * std::abs(v) + 1e-300;
      sizes += x / weight_x * (x / weight_x) + v / weight_v * (v / weight_v);
      slopes += v / weight_x * (v / weight_x) + a / weight_v * (a / weight_v);
    }
    const double size = std::sqrt(static_cast<double>(sizes));
    const double slope = std::sqrt(static_cast<double>(slopes));
    const double guess = size < 1e-5 || slope < 1e-5 ? 1e-6 : 0.01 * size / slope;
    return std::clamp(guess, std::max(d_.smallest_step, 1e-10), d_.largest_step);
  }

  void accept(double h) {
    SystemView<Real>& s = system_.view;
    copy(s.position, s.dofs, start_position_);
    copy(s.integrals, s.rates, start_integrals_);
    copy(arrays_.acceleration[0], s.dofs, start_acceleration_);
    copy(arrays_.rates[0], s.rates, start_rates_);
    copy(arrays_.position, s.dofs, s.position);
    copy(arrays_.velocity[6], s.dofs, s.velocity);
    copy(arrays_.integrals, s.rates, s.integrals);
    copy(arrays_.acceleration[6], s.dofs, arrays_.acceleration[0]);
    copy(arrays_.rates[6], s.rates, arrays_.rates[0]);
    if (kCompensated<Real>) {
      copy(s.position_rest, s.dofs, start_position_rest_);
      copy(s.integrals_rest, s.rates, start_integrals_rest_);
      copy(arrays_.position_rest, s.dofs, s.position_rest);
      if (s.inertial) copy(arrays_.velocity_rest, s.dofs, s.velocity_rest);
      copy(arrays_.integrals_rest, s.rates, s.integrals_rest);
    }
    last_ = h;
  }

  static void copy(const Real* from, std::size_t n, Real* to) {
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i];
  }

  // The last step, for its continuous extension. Its last stage is kept as the next one's first.

  Dopri5Step<Real> positions() const {
    const SystemView<Real>& s = system_.view;
    Dopri5Step<Real> step = {
        last_, s.dofs, start_position_, start_position_rest_, s.position, s.position_rest, {}};
    for (int j = 0; j < 7; ++j) step.slope[j] = arrays_.velocity[j];
    return step;
  }

  Dopri5Step<Real> velocities() const {
    const SystemView<Real>& s = system_.view;
    Dopri5Step<Real> step = {last_,           s.dofs, arrays_.velocity[0], nullptr, s.velocity,
                             s.velocity_rest, {}};
    for (int j = 1; j < 6; ++j) step.slope[j] = arrays_.acceleration[j];
    step.slope[0] = start_acceleration_;
    step.slope[6] = arrays_.acceleration[0];
    return step;
  }

  Dopri5Step<Real> integrals_of_step(std::size_t count) const {
    const SystemView<Real>& s = system_.view;
    Dopri5Step<Real> step = {
        last_, count, start_integrals_, start_integrals_rest_, s.integrals, s.integrals_rest, {}};
    for (int j = 1; j < 6; ++j) step.slope[j] = arrays_.rates[j];
    step.slope[0] = start_rates_;
    step.slope[6] = arrays_.rates[0];
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

  Description d_;
  using Integrator<Real>::system_;
  const Dopri5Table<Real>& kernels_;
  AlignedVector<Real> memory_;
  Dopri5Arrays<Real> arrays_;
  double* control_ = nullptr;
  std::int64_t* counts_ = nullptr;
  Real* start_position_ = nullptr;
  Real* start_acceleration_ = nullptr;
  Real* start_integrals_ = nullptr;
  Real* start_rates_ = nullptr;
  Real* start_position_rest_ = nullptr;
  Real* start_integrals_rest_ = nullptr;
  double last_ = 0.0;
};

double growth(std::complex<double> z) {
  return std::abs(
      1.0 +
      z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0 * (1.0 + z / 5.0))))));
}

double step(const void*) { return 0.0; }

/// Where one of the two tolerances is zero, the other rules.
double tolerance(const void* description) {
  const auto& d = *static_cast<const Description*>(description);
  return std::max(d.absolute_tolerance, d.relative_tolerance);
}

std::int64_t most_steps(const void* description) {
  return static_cast<const Description*>(description)->most_steps;
}

std::vector<Complaint> complaints(const void* description) {
  const auto& d = *static_cast<const Description*>(description);
  std::vector<Complaint> found;
  if (d.absolute_tolerance == 0.0 && d.relative_tolerance == 0.0) {
    found.push_back({"absolute_tolerance", "one of the two tolerances must not be 0", "> 0"});
  }
  if (d.smallest_step > d.largest_step) {
    found.push_back({"smallest_step", "above largest_step", "<= largest_step"});
  }
  if (d.initial_step > 0.0 && d.initial_step < d.smallest_step) {
    found.push_back({"initial_step", "below smallest_step", ">= smallest_step"});
  }
  return found;
}

template <class Real>
std::unique_ptr<Integrator<Real>> bind(const void* description, System<Real>& system) {
  return std::make_unique<Dopri5<Real>>(*static_cast<const Description*>(description), system);
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
  record.adaptive = true;
  record.evaluations_per_step = 6;
  record.make_description = &make_description<Description>;
  record.parameters = {
      parameter("absolute_tolerance", &Description::absolute_tolerance, dimension::none,
                "largest error per step, in units of each coordinate and velocity")
          .in(non_negative)
          .by_default(1e-9),
      parameter("relative_tolerance", &Description::relative_tolerance, dimension::none,
                "largest error per step, relative to each coordinate and velocity")
          .in(non_negative)
          .by_default(1e-9),
      parameter("initial_step", &Description::initial_step, dimension::time,
                "the first step to try; 0: guessed")
          .in(non_negative)
          .by_default(0.0),
      parameter("smallest_step", &Description::smallest_step, dimension::time,
                "a run that needs less fails")
          .in(positive)
          .by_default(1e-12),
      parameter("largest_step", &Description::largest_step, dimension::time, "never step further")
          .in(positive)
          .by_default(1e12),
      parameter("most_steps", &Description::most_steps, dimension::none,
                "a run that needs more fails")
          .in(positive)
          .by_default(std::int64_t{1'000'000'000})};
  record.growth = &growth;
  record.step = &step;
  record.tolerance = &tolerance;
  record.most_steps = &most_steps;
  record.complaints = &complaints;
  record.bind = {&bind<double>, &bind<float>, &bind<Quad>};
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
