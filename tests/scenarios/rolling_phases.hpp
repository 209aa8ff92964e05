#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/scenarios/trace.hpp"

/// Properties of a friction trace: phases of rolling and of dragging, kinks.
namespace tomlin::test {

/// A stretch of a trace in which a ring rolls, or is dragged, all the time.
struct Phase {
  bool rolls = false;     ///< -R dphi/dx above 1/2; rolling without slip is 1, dragging 0
  std::size_t from = 0;   ///< sample at which it begins
  std::size_t to = 0;     ///< and that at which it ends
  double length = 0.0;    ///< that the driver moves meanwhile
  double advance = 0.0;   ///< of the centre
  double rotation = 0.0;  ///< counter-clockwise positive
  double slope = 0.0;     ///< mean of |dF/dX|, force over position of the driver
};

/// The phases of one period, in order, from where the ring first sets out to roll in the last two
/// periods of a trace; one phase, from the start of these two, where it never does, or never stops.
inline std::vector<Phase> phases_of_a_period(const Trace& trace, double radius, int periods) {
  const auto& x = trace["ring.centre_of_mass.x"];
  const auto& rotation = trace["ring.rotation"];
  const auto& driver = trace["driver.position.x"];
  const auto& force = trace["driver.force.x"];
  const std::size_t period = (x.size() - 1) / static_cast<std::size_t>(periods);
  const auto rolls = [&](std::size_t n) {
    return -radius * (rotation[n + 1] - rotation[n]) > 0.5 * std::abs(x[n + 1] - x[n]);
  };

  std::size_t start = x.size() - 1 - 2 * period;
  for (std::size_t n = start + 1; n < start + period; ++n) {
    if (!rolls(n) || rolls(n - 1)) continue;
    start = n;
    break;
  }
  std::vector<Phase> phases;
  for (std::size_t n = start; n < start + period; ++n) {
    if (phases.empty() || rolls(n) != phases.back().rolls) phases.push_back({rolls(n), n, n});
    phases.back().to = n + 1;
    phases.back().slope += std::abs(force[n + 1] - force[n]);
  }
  for (Phase& phase : phases) {
    phase.length = driver[phase.to] - driver[phase.from];
    phase.advance = x[phase.to] - x[phase.from];
    phase.rotation = rotation[phase.to] - rotation[phase.from];
    phase.slope /= phase.length;
  }
  return phases;
}

/// Largest factor by which the slope |dF/dX| changes within `window` of X, evenly sampled. The
/// steeper of the two slopes must be at least half the mean slope: where a smooth curve turns
/// round, its slope passes through 0, and that is no kink.
inline double sharpest_kink(const std::vector<double>& position, const std::vector<double>& force,
                            double window) {
  std::vector<double> slope;
  double mean = 0.0;
  for (std::size_t n = 1; n < position.size(); ++n) {
    slope.push_back(std::abs((force[n] - force[n - 1]) / (position[n] - position[n - 1])));
    mean += slope.back() / static_cast<double>(position.size() - 1);
  }
  const auto apart = static_cast<std::size_t>(std::lround(window / (position[1] - position[0])));
  double sharpest = 1.0;
  for (std::size_t n = 0; n + apart < slope.size(); ++n) {
    const auto [flat, steep] = std::minmax(slope[n], slope[n + apart]);
    if (steep >= 0.5 * mean) sharpest = std::max(sharpest, steep / flat);
  }
  return sharpest;
}

}  // namespace tomlin::test
