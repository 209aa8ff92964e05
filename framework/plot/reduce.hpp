#pragma once

#include <cstddef>
#include <vector>

namespace tomlin {

struct Point {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const Point&, const Point&) = default;
};

using Polyline = std::vector<Point>;

/// What a panel shows, and on how many points of the screen.
struct Window {
  double x_from = 0.0;
  double x_to = 1.0;
  double y_from = 0.0;
  double y_to = 1.0;
  double width = 1.0;   ///< in points of the screen
  double height = 1.0;  ///< likewise
  bool log_x = false;   ///< a logarithmic axis: all numbers along it are positive
  bool log_y = false;
};

inline constexpr std::size_t kFewPoints = 1000;   ///< a curve of so many is left alone
inline constexpr std::size_t kMostPoints = 6000;  ///< no curve gets more

/// A curve, in the pieces it is given in, as the eye sees it: in a few thousand points however long
/// it is, and in other pieces where parts of it would lie on what is drawn already. Every point is
/// one of the curve's, in its order, and its extremes along x and y are among them.
std::vector<Polyline> reduced(const std::vector<Polyline>& curve, const Window& window);

}  // namespace tomlin
