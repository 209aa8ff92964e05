#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"

/// The signals of a run that observers look at after every step: the force of each driver along
/// each axis, then the speed of each body's centre.
namespace tomlin {

class Signals {
 public:
  explicit Signals(const Model& model);

  std::size_t count() const { return speed_of(model_.bodies().size()); }
  std::size_t force_of(std::size_t driver, std::size_t axis) const { return driver * axes_ + axis; }
  std::size_t speed_of(std::size_t body) const { return drivers().size() * axes_ + body; }
  const std::vector<Model::Driver>& drivers() const { return drivers_; }

  /// Writes the forces of drivers among `signals`, from rates.
  void write_forces(const double* rates, double* signals) const {
    for (const Model::Driver& driver : drivers_) {
      const double* force = rates + driver.first_rate;
      for (std::size_t d = 0; d < axes_; ++d) *signals++ = force[d];
    }
  }
  /// Writes the speeds of bodies among `signals`, from velocities at a time.
  void write_speeds(const double* velocity, double time, double* signals) const;

  /// Power of a driver: its velocity at the start of the run times its force.
  double power(std::size_t driver, const double* signals) const {
    double power = 0.0;
    for (std::size_t s = driver * axes_; s < (driver + 1) * axes_; ++s) {
      power += start_velocity_[s] * signals[s];
    }
    return power;
  }
  /// Its force along its present pull: along(driver) power(driver, signals).
  double along(std::size_t driver) const { return along_[driver]; }
  double start_velocity(std::size_t driver, std::size_t axis) const {
    return start_velocity_[driver * axes_ + axis];
  }
  /// Drivers may have turned round.
  void set_directions();

 private:
  const Model& model_;
  const std::vector<Model::Driver>& drivers_;
  std::size_t axes_;
  std::vector<double> start_velocity_;  ///< [driver * dimension + axis]
  std::vector<double> speed_;           ///< of each driver's pull
  std::vector<double> along_;
};

/// Signals at the starts of successive steps of the grid, or of one step.
struct SignalBlock {
  std::size_t count = 0;
  const double* times = nullptr;
  const double* signals = nullptr;  ///< [step][signal]
  std::size_t width = 0;            ///< signals of one step
  // States and all rates are given only for a single point on a line.
  const double* positions = nullptr;
  const double* velocities = nullptr;
  const double* rates = nullptr;  ///< [step][rate]
  std::size_t rate_width = 0;

  const double* at(std::size_t step) const { return signals + step * width; }
  bool has_states() const { return positions != nullptr; }
  /// Returns the block of one step.
  SignalBlock step(std::size_t k) const {
    SignalBlock one = *this;
    one.count = 1;
    one.times += k;
    one.signals = at(k);
    if (!has_states()) return one;
    one.positions += k;
    one.velocities += k;
    one.rates += k * rate_width;
    return one;
  }
};

/// Signals over a step, or a part of it: at its ends and at thirds between, through which a cubic
/// goes. The dense output tells more where there is one.
class SignalSpan {
 public:
  SignalSpan(Model& model, const Signals& signals, Integrator<double>& integrator);
  /// From now on forces within a step are evaluated at the state of the dense output: where no
  /// error estimate controls them, its polynomial through rates is beyond the largest force.
  void evaluate_forces() { evaluates_ = true; }

  double from = 0.0;
  double to = 0.0;
  std::array<double, 4> times = {};
  std::array<std::vector<double>, 4> at;  ///< signals at these times
  bool is_dense = false;

  double time(double theta) const { return from + (to - from) * theta; }
  /// All signals at a part of the step, at its time, from the dense output. False where there is
  /// none.
  bool read_dense(double theta, double time, std::vector<double>& into) const;
  /// The value of a function of the signals at its extreme near theta, on the dense output: the
  /// vertex of the parabola through three points, and of one through three nearer ones.
  template <class Function>
  double extreme_near(double theta, Function function) const;

 private:
  void evaluate(double theta) const;

  Model& model_;
  const Signals& signals_;
  Integrator<double>& integrator_;
  bool evaluates_ = false;
  mutable AlignedVector<double> position_;  // aligned: kernels read them
  mutable AlignedVector<double> velocity_;
  mutable AlignedVector<double> integrals_;
  mutable AlignedVector<double> rates_;
  mutable std::vector<double> within_;
};

template <class Function>
double SignalSpan::extreme_near(double theta, Function function) const {
  constexpr double kFirstReach = 1.0 / 12.0;
  constexpr double kReachFactor = 0.25;
  constexpr int kPasses = 2;
  const auto value = [&](double part) {
    read_dense(part, time(part), within_);
    return function(within_.data());
  };
  double reach = kFirstReach;
  for (int pass = 0; pass < kPasses; ++pass, reach *= kReachFactor) {
    const double middle = std::clamp(theta, reach, 1.0 - reach);
    const double before = value(middle - reach);
    const double here = value(middle);
    const double after = value(middle + reach);
    const double bend = after - 2.0 * here + before;
    if (bend == 0.0) break;
    theta = middle - std::clamp(0.5 * (after - before) / bend, -1.0, 1.0) * reach;
  }
  return value(theta);
}

/// An extreme of a cubic is looked at on the dense output where it comes as near to the largest so
/// far, in parts of what the signal changes by in the step: the cubic may be off by that.
inline constexpr double kNearLargest = 0.1;

}  // namespace tomlin
