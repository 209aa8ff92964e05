#pragma once

#include <cmath>
#include <cstddef>

#include "framework/core/aligned.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

/// Dense output of schemes without one of their own: the cubic through value and slope at both
/// ends of a step, for positions, velocities and running integrals alike. Error O(h^4).
class HermiteOutput {
 public:
  /// Work space: room for hermite_size() numbers.
  void place(double* memory, std::size_t dofs, std::size_t rates) {
    position_ = memory;
    velocity_ = position_ + dofs;
    acceleration_ = velocity_ + dofs;
    integrals_ = acceleration_ + dofs;
    rates_ = integrals_ + rates;
  }

  void keep_start(const SystemView<double>& system) {
    copy(system.position, system.dofs, position_);
    copy(system.velocity, system.dofs, velocity_);
    copy(system.integrals, system.rates, integrals_);
    dofs_ = system.dofs;
    rate_count_ = system.rates;
  }

  /// Slopes at the start, before the arrays are used for the end.
  void keep_first(const double* acceleration, const double* rates) {
    copy(acceleration, dofs_, acceleration_);
    copy(rates, rate_count_, rates_);
  }

  void interpolate(double theta, double h, const SystemView<double>& end,
                   const double* end_acceleration, const double* end_rates, double* position,
                   double* velocity, double* integrals) const {
    cubic(theta, h, dofs_, position_, velocity_, end.position, end.velocity, position);
    cubic(theta, h, dofs_, velocity_, acceleration_, end.velocity, end_acceleration, velocity);
    cubic(theta, h, rate_count_, integrals_, rates_, end.integrals, end_rates, integrals);
  }

 private:
  static void copy(const double* from, std::size_t n, double* to) {
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i];
  }

  /// y(theta) = y0 + theta (dy + (1 - theta) ((h y0' - dy) (1 - theta) - (h y1' - dy) theta)).
  static void cubic(double theta, double h, std::size_t n, const double* y0, const double* slope0,
                    const double* y1, const double* slope1, double* y) {
    const double rest = 1.0 - theta;
    for (std::size_t i = 0; i < n; ++i) {
      const double change = y1[i] - y0[i];
      const double bend = rest * (h * slope0[i] - change) - theta * (h * slope1[i] - change);
      y[i] = theta == 1.0 ? y1[i] : std::fma(theta, std::fma(rest, bend, change), y0[i]);
    }
  }

  double* position_ = nullptr;
  double* velocity_ = nullptr;
  double* acceleration_ = nullptr;
  double* integrals_ = nullptr;
  double* rates_ = nullptr;
  std::size_t dofs_ = 0;
  std::size_t rate_count_ = 0;
};

constexpr std::size_t hermite_size(std::size_t dofs, std::size_t rates) {
  return 3 * dofs + 2 * rates;
}

}  // namespace tomlin
