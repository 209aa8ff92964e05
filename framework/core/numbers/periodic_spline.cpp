#include "framework/core/numbers/periodic_spline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/numbers/constants.hpp"

namespace tomlin {
namespace {

/// Coefficients of the periodic cubic spline through `values`, divided by 6, which they become.
/// From one to the next it is `step`.
void make_coefficients(double* values, std::size_t count, std::size_t step) {
  const double pole = std::sqrt(3.0) - 2.0;
  const auto at = [&](std::size_t k) -> double& { return values[k % count * step]; };
  // The sums over all periods are geometric ones of those over one.
  double power = 1.0;
  double first = 0.0;
  for (std::size_t k = 0; k < count; ++k, power *= pole) first += power * at(count - k);
  at(0) = first / (1.0 - power);
  for (std::size_t k = 1; k < count; ++k) at(k) += pole * at(k - 1);
  power = 1.0;
  double last = 0.0;
  for (std::size_t k = 0; k < count; ++k, power *= pole) last += power * at(count - 1 + k);
  at(count - 1) = -pole * last / (1.0 - power);
  for (std::size_t k = count - 1; k-- > 0;) at(k) = pole * (at(k + 1) - at(k));
}

/// Weights of the values on a circle of `count` points in the trigonometric interpolation, or in
/// its derivative by the circle, `shift` spacings behind a point: entry k, that of the point k
/// spacings before that.
std::vector<double> trigonometric_weights(std::size_t count, double shift, bool derivative) {
  std::vector<double> weights(count);
  const auto points = static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = (static_cast<double>(k) + shift) / points;
    double weight = derivative ? 0.0 : 1.0;
    for (std::size_t wave = 1; 2 * wave <= count; ++wave) {
      const auto q = static_cast<double>(wave);
      const double part = 2 * wave == count ? 1.0 : 2.0;
      double sine = 0.0;
      double cosine = 0.0;
      sincos_turns(q * turn, sine, cosine);
      weight += part * (derivative ? -kTau * q * sine : cosine);
    }
    weights[k] = weight / points;
  }
  return weights;
}

/// Every value becomes the sum over the circle, which `step` leads along, of weights times values.
void apply(const std::vector<double>& weights, double* values, std::size_t step) {
  const std::size_t count = weights.size();
  std::vector<double> circle(count);
  for (std::size_t k = 0; k < count; ++k) circle[k] = values[k * step];
  for (std::size_t k = 0; k < count; ++k) {
    double sum = 0.0;
    for (std::size_t j = 0; j < count; ++j) sum += weights[(k + count - j) % count] * circle[j];
    values[k * step] = sum;
  }
}

enum class Quantity { value, slope_u, slope_v };

/// The largest difference between the spline and the trigonometric interpolation, as far behind
/// each point of the grid.
template <int axes>
double largest_difference(const PeriodicSpline& spline, Quantity quantity, double shift_u,
                          double shift_v) {
  const std::size_t rows = spline.rows();
  const std::size_t columns = spline.columns();
  std::vector<double> expected = spline.values();
  const auto along_u = trigonometric_weights(rows, shift_u, quantity == Quantity::slope_u);
  for (std::size_t n = 0; n < columns; ++n) apply(along_u, expected.data() + n, columns);
  if constexpr (axes == 2) {
    const auto along_v = trigonometric_weights(columns, shift_v, quantity == Quantity::slope_v);
    for (std::size_t m = 0; m < rows; ++m) apply(along_v, expected.data() + m * columns, 1);
  }
  double largest = 0.0;
  for (std::size_t m = 0; m < rows; ++m) {
    for (std::size_t n = 0; n < columns; ++n) {
      Vec<double, axes> periods;
      periods[0] = (static_cast<double>(m) + shift_u) / static_cast<double>(rows);
      if constexpr (axes == 2) {
        periods[1] = (static_cast<double>(n) + shift_v) / static_cast<double>(columns);
      }
      const SplinePoint<double, axes> point(periods, spline.table());
      const double found = quantity == Quantity::value
                               ? point.value()
                               : point.gradient()[quantity == Quantity::slope_v];
      largest = std::max(largest, std::abs(found - expected[m * columns + n]));
    }
  }
  return largest;
}

}  // namespace

PeriodicSpline::PeriodicSpline(std::size_t columns, std::vector<double> values)
    : columns_(columns), values_(std::move(values)) {
  const std::size_t rows = this->rows();
  std::vector<double> coefficients = values_;
  for (std::size_t n = 0; n < columns; ++n) {
    make_coefficients(coefficients.data() + n, rows, columns);
  }
  for (std::size_t m = 0; m < rows; ++m) {
    make_coefficients(coefficients.data() + m * columns, columns, 1);
  }
  table_ = {static_cast<double>(rows), static_cast<double>(columns)};
  table_.reserve(kSplineHead + (rows + 3) * (columns + 3));
  for (std::size_t m = 0; m < rows + 3; ++m) {
    for (std::size_t n = 0; n < columns + 3; ++n) {
      // The first is that before the first point.
      const std::size_t row = (m + rows - 1) % rows;
      const std::size_t column = (n + columns - 1) % columns;
      table_.push_back(coefficients[row * columns + column]);
    }
  }
  curvatures_ = bounds_on_curvatures();
}

std::array<double, 3> PeriodicSpline::bounds_on_curvatures() const {
  // Between points a second derivative is a mean of the nearest second differences.
  const std::size_t rows = this->rows();
  const std::size_t columns = columns_;
  const std::size_t stride = columns + 3;
  const auto at = [&](std::size_t m, std::size_t n) {
    return table_[kSplineHead + m * stride + n];
  };
  std::array<double, 3> most{};
  const auto note = [&most](int which, double difference) {
    most[which] = std::max(most[which], std::abs(difference));
  };
  for (std::size_t m = 0; m <= rows; ++m) {
    for (std::size_t n = 0; n < stride; ++n) {
      note(0, at(m, n) - 2.0 * at(m + 1, n) + at(m + 2, n));
      if (n <= columns) note(1, at(m, n) - 2.0 * at(m, n + 1) + at(m, n + 2));
      if (n + 1 < stride) note(2, at(m + 1, n + 1) - at(m + 1, n) - at(m, n + 1) + at(m, n));
    }
  }
  const auto u = static_cast<double>(rows);
  const auto v = static_cast<double>(columns);
  constexpr double kUnit = 36.0;
  return {kUnit * u * u * most[0], kUnit * v * v * most[1], kUnit * u * v * most[2]};
}

PeriodicSpline::Error PeriodicSpline::error() const {
  constexpr double kMiddle = 0.5;
  constexpr double kQuarter = 0.25;
  if (columns_ == 1) {
    return {largest_difference<1>(*this, Quantity::value, kMiddle, 0.0),
            largest_difference<1>(*this, Quantity::slope_u, kQuarter, 0.0), 0.0};
  }
  return {largest_difference<2>(*this, Quantity::value, kMiddle, kMiddle),
          largest_difference<2>(*this, Quantity::slope_u, kQuarter, kMiddle),
          largest_difference<2>(*this, Quantity::slope_v, kMiddle, kQuarter)};
}

}  // namespace tomlin
