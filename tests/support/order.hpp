#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

/// Orders of convergence read off measured errors.
namespace tomlin::test {

/// Slope of log(error) over log(step): least squares over the pairs whose error is above `floor`,
/// where rounding has not yet taken over. NaN with fewer than two of them.
inline double fitted_order(const std::vector<double>& step, const std::vector<double>& error,
                           double floor = 0.0) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t k = 0; k < step.size(); ++k) {
    if (!(error[k] > floor)) continue;
    const double x = std::log(step[k]);
    const double y = std::log(error[k]);
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  if (n < 2.0) return std::nan("");
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Returns infinity for lists of different lengths.
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

/// A two-sided window: an order that is too good is as suspicious as one that is too poor.
struct Window {
  double low = 0.0;
  double high = 0.0;
  bool holds(double x) const { return x >= low && x <= high; }
};

}  // namespace tomlin::test
