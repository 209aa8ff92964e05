#include "framework/run/events/extremes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tomlin {

double parabola_vertex(double t0, double y0, double t1, double y1, double t2, double y2) {
  const double left = (y1 - y0) / (t1 - t0);
  const double right = (y2 - y1) / (t2 - t1);
  const double curvature = (right - left) / (t2 - t0);
  if (curvature == 0.0) return y1;
  // Slope at t1, and from there down to the vertex.
  const double slope = (left * (t2 - t1) + right * (t1 - t0)) / (t2 - t0);
  return y1 - 0.25 * slope * slope / curvature;
}

CubicExtremes cubic_extremes(double y0, double y1, double y2, double y3) {
  // y0 + u (c1 + u (c2 + u c3)) with u = 3 theta, by divided differences.
  const double d1 = y1 - y0;
  const double d2 = (y2 - 2.0 * y1 + y0) / 2.0;
  const double c3 = (y3 - 3.0 * y2 + 3.0 * y1 - y0) / 6.0;
  const double c2 = d2 - 3.0 * c3;
  const double c1 = d1 - d2 + 2.0 * c3;
  CubicExtremes found;
  const auto keep = [&](double u) {
    if (!(u > 0.0 && u < 3.0)) return;
    const double bend = 2.0 * c2 + 6.0 * c3 * u;
    if (bend == 0.0) return;
    found.theta[found.count] = u / 3.0;
    found.value[found.count] = y0 + u * (c1 + u * (c2 + u * c3));
    found.is_maximum[found.count] = bend < 0.0;
    ++found.count;
  };
  // Roots of c1 + 2 c2 u + 3 c3 u^2, the stable way round.
  const double root = c2 * c2 - 3.0 * c3 * c1;
  if (!(root > 0.0)) return found;
  const double q = -(c2 + std::copysign(std::sqrt(root), c2));
  double first = c3 != 0.0 ? q / (3.0 * c3) : -1.0;
  double second = q != 0.0 ? c1 / q : -1.0;
  if (second < first) std::swap(first, second);
  keep(first);
  keep(second);
  return found;
}

void Extremes::declare(StateLayout& layout, std::size_t signals) {
  layout.add_reals("extremes.high", signals);
  layout.add_reals("extremes.low", signals);
  layout.add_reals("extremes.last", signals);
  layout.add_reals("extremes.previous", signals);
  layout.add_reals("extremes.times", 2);
  layout.add_integers("extremes.flags", 2);
}

void Extremes::attach(RunState& state, std::size_t signals) {
  signals_ = signals;
  high_ = state.reals("extremes.high");
  low_ = state.reals("extremes.low");
  last_ = state.reals("extremes.last");
  previous_ = state.reals("extremes.previous");
  times_ = state.reals("extremes.times");
  flags_ = state.integers("extremes.flags");
}

void Extremes::start() {
  for (std::size_t k = 0; k < signals_; ++k) {
    high_[k] = -std::numeric_limits<double>::max();
    low_[k] = std::numeric_limits<double>::max();
  }
}

double Extremes::vertex(std::size_t k, double time, double value) const {
  return parabola_vertex(times_[1], previous_[k], times_[0], last_[k], time, value);
}

void Extremes::add(double time, const double* values, bool inside) {
  const bool two = flags_[kSeen] >= 2 && flags_[kLastInside] != 0;
  for (std::size_t k = 0; k < signals_; ++k) {
    const double y = values[k];
    if (two) {
      if (last_[k] > previous_[k] && last_[k] >= y) {
        const double peak = vertex(k, time, y);
        if (peak > high_[k]) high_[k] = peak;
      } else if (last_[k] < previous_[k] && last_[k] <= y) {
        const double trough = vertex(k, time, y);
        if (trough < low_[k]) low_[k] = trough;
      }
    }
    if (inside) {
      if (y > high_[k]) high_[k] = y;
      if (y < low_[k]) low_[k] = y;
    }
    previous_[k] = last_[k];
    last_[k] = y;
  }
  times_[1] = times_[0];
  times_[0] = time;
  flags_[kSeen] += flags_[kSeen] < 2 ? 1 : 0;
  flags_[kLastInside] = inside ? 1 : 0;
}

/// A parabola through three neighbours at equal distances rises above the largest of them by no
/// more than an eighth of what they differ by: mostly none of a block's comes near the extremes.
void Extremes::add_block(const double* times, const double* values, std::size_t count,
                         bool inside) {
  constexpr double kRiseOfParabola = 0.25;  // an eighth, and room for rounding
  constexpr std::size_t kBefore = 2;
  if (count <= kBefore || !inside) {
    for (std::size_t n = 0; n < count; ++n) add(times[n], values + n * signals_, inside);
    return;
  }
  for (std::size_t n = 0; n < kBefore; ++n) add(times[n], values + n * signals_, inside);
  bool near = false;
  for (std::size_t k = 0; k < signals_; ++k) {
    double high = values[k];
    double low = values[k];
    for (std::size_t n = 1; n < count; ++n) {
      high = std::max(high, values[n * signals_ + k]);
      low = std::min(low, values[n * signals_ + k]);
    }
    const double rise = kRiseOfParabola * (high - low);
    near = near || !(high + rise < high_[k] && low - rise > low_[k]);
  }
  if (near) {
    for (std::size_t n = kBefore; n < count; ++n) add(times[n], values + n * signals_, inside);
    return;
  }
  for (std::size_t n = count - kBefore; n < count; ++n) {
    std::copy_n(last_, signals_, previous_);
    std::copy_n(values + n * signals_, signals_, last_);
    times_[1] = times_[0];
    times_[0] = times[n];
  }
}

void Extremes::include(const double* values) {
  for (std::size_t k = 0; k < signals_; ++k) {
    if (values[k] > high_[k]) high_[k] = values[k];
    if (values[k] < low_[k]) low_[k] = values[k];
  }
}

void Extremes::include(std::size_t k, double value) {
  if (value > high_[k]) high_[k] = value;
  if (value < low_[k]) low_[k] = value;
}

}  // namespace tomlin
