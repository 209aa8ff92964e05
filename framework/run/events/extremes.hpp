#pragma once

#include <cstddef>

#include "framework/core/system/state_layout.hpp"

namespace tomlin {

/// Largest and smallest values of a few signals that are known at the ends of steps. Between them
/// the parabola through three neighbours gives the height of a peak, so that extremes do not depend
/// on where steps happen to end (error of third order in the step).
class Extremes {
 public:
  static void declare(StateLayout& layout, std::size_t signals);
  void attach(RunState& state, std::size_t signals);
  void start();
  /// Values jump here: none lies between two that have been added.
  void break_off() { flags_[kSeen] = 0; }

  /// Values at a time; those outside [from, to] only serve as neighbours.
  void add(double time, const double* values, bool inside);
  /// Adds a block of `count` points at equal distances, [point][signal]; the window begins and ends
  /// outside of it.
  void add_block(const double* times, const double* values, std::size_t count, bool inside);
  /// Values that no step ends on: at the window's edges, at peaks within a step.
  void include(const double* values);
  void include(std::size_t signal, double value);

  bool any(std::size_t signal) const { return high_[signal] >= low_[signal]; }
  double high(std::size_t signal) const { return high_[signal]; }
  double low(std::size_t signal) const { return low_[signal]; }

 private:
  double vertex(std::size_t signal, double time, double value) const;

  std::size_t signals_ = 0;
  double* high_ = nullptr;
  double* low_ = nullptr;
  double* last_ = nullptr;      ///< values one step ago
  double* previous_ = nullptr;  ///< and two
  double* times_ = nullptr;     ///< of last, of previous
  std::int64_t* flags_ = nullptr;
  enum { kSeen, kLastInside };
};

/// Local extremes of the cubic through values at 0, 1/3, 2/3 and 1, in the order of theta.
struct CubicExtremes {
  int count = 0;
  double theta[2] = {};  ///< in [0, 1]
  double value[2] = {};
  bool is_maximum[2] = {};
};
CubicExtremes cubic_extremes(double y0, double y1, double y2, double y3);

/// Height of the parabola through (t0, y0), (t1, y1), (t2, y2) at its vertex.
double parabola_vertex(double t0, double y0, double t1, double y1, double t2, double y2);

}  // namespace tomlin
