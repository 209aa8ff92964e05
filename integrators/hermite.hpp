#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/system.hpp"

namespace tomlin {

/// Dense output of schemes without one of their own: the cubic through value and slope at both
/// ends of a step, for positions, velocities and running integrals alike. Error O(h^4); without
/// inertia velocities are the slope of the positions' cubic, error O(h^3).
template <class Real>
class HermiteOutput {
 public:
  HermiteOutput(std::size_t dofs, std::size_t rates)
      : position_(dofs, 0.0),
        velocity_(dofs, 0.0),
        acceleration_(dofs, 0.0),
        integrals_(rates, 0.0),
        rates_(rates, 0.0) {}

  void keep_start(const SystemView<Real>& s) {
    copy(s.position, position_);
    copy(s.velocity, velocity_);
    copy(s.integrals, integrals_);
  }

  /// Slopes at the start, before the arrays are used for the end.
  void keep_first(const Real* acceleration, const Real* rates) {
    copy(acceleration, acceleration_);
    copy(rates, rates_);
  }

  const double* start_position() const { return position_.data(); }
  const double* start_velocity() const { return velocity_.data(); }

  void interpolate(double theta, double h, const SystemView<Real>& end,
                   const Real* end_acceleration, const Real* end_rates, double* position,
                   double* velocity, double* integrals) const {
    cubic(theta, h, position_, velocity_, end.position, end.velocity, position);
    if (end.inertial) {
      cubic(theta, h, velocity_, acceleration_, end.velocity, end_acceleration, velocity);
    } else {
      slope(theta, h, position_, velocity_, end.position, end.velocity, velocity);
    }
    cubic(theta, h, integrals_, rates_, end.integrals, end_rates, integrals);
    if (end.friction_rate == kNoRate || theta == 1.0) return;
    const auto heat = static_cast<std::size_t>(end.friction_rate);
    integrals[heat] = heat_at(theta, integrals_[heat], static_cast<double>(end.integrals[heat]),
                              h * rates_[heat], h * static_cast<double>(end_rates[heat]));
  }

 private:
  using Numbers = AlignedVector<double>;

  static void copy(const Real* from, Numbers& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<double>(from[i]);
  }

  /// y(theta) = y0 + theta (dy + (1 - theta) ((h y0' - dy) (1 - theta) - (h y1' - dy) theta)).
  static void cubic(double theta, double h, const Numbers& y0, const Numbers& slope0,
                    const Real* y1, const Real* slope1, double* y) {
    const double rest = 1.0 - theta;
    for (std::size_t i = 0; i < y0.size(); ++i) {
      const auto end = static_cast<double>(y1[i]);
      const double change = end - y0[i];
      const double bend =
          rest * (h * slope0[i] - change) - theta * (h * static_cast<double>(slope1[i]) - change);
      y[i] = theta == 1.0 ? end : std::fma(theta, std::fma(rest, bend, change), y0[i]);
    }
  }

  /// Its derivative with respect to time.
  static void slope(double theta, double h, const Numbers& y0, const Numbers& slope0,
                    const Real* y1, const Real* slope1, double* y) {
    const double rest = 1.0 - theta;
    for (std::size_t i = 0; i < y0.size(); ++i) {
      const double mean = (static_cast<double>(y1[i]) - y0[i]) / h;
      const auto last = static_cast<double>(slope1[i]);
      const double along = rest * (slope0[i] - mean) * (1.0 - 3.0 * theta) -
                           theta * (last - mean) * (2.0 - 3.0 * theta);
      y[i] = theta == 1.0 ? last : mean + along;
    }
  }

  /// The operators' heat, which a step adds as a whole: the cubic with slopes that let it rise all
  /// along, also where friction stops a flight within the step.
  static double heat_at(double theta, double start, double end, double first, double last) {
    const double gained = end - start;
    const double rest = 1.0 - theta;
    const double bend = rest * (std::min(first, 3.0 * gained) - gained) -
                        theta * (std::min(last, 3.0 * gained) - gained);
    return start + theta * (gained + rest * bend);
  }

  Numbers position_;
  Numbers velocity_;
  Numbers acceleration_;
  Numbers integrals_;
  Numbers rates_;
};

}  // namespace tomlin
