#pragma once

#include <cstddef>

namespace tomlin {

/// A part has some of the points of a sweep; by default all. Each part has one of every `of`
/// successive points, so that expensive points, which are neighbours as a rule, are spread over the
/// parts; it is another one each time, since in a grid every so many points have the same value of
/// an axis. Whole lines are shared out instead of points where these continue from their neighbour.
struct SweepPart {
  std::size_t index = 0;  ///< 0 to of - 1
  std::size_t of = 1;     ///< parts
  std::size_t line = 1;   ///< points that stay together, see SweepPlan

  bool has(std::size_t point) const {
    const std::size_t k = point / line;
    return (k + k / of) % of == index;
  }
  /// How many of so many points belong to it.
  std::size_t size(std::size_t points) const {
    const std::size_t lines = points / line;
    const std::size_t whole = lines / of;
    const std::size_t at = (index + of - whole % of) % of;  // among the last ones
    return (whole + (at < lines % of ? 1 : 0)) * line;
  }
};

}  // namespace tomlin
