#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/table_index.hpp"
#include "framework/core/numbers/vec.hpp"

/// A periodic function of one or two variables from its values on a grid: the interpolating cubic
/// spline, on two axes the product of such splines (bicubic). It is twice continuously
/// differentiable.
///
///   f(u, v) = sum_kl c_kl B(M u - k) B(N v - l),   f(m/M, n/N) = value[m][n]
///
///   u, v  the position in periods
///   M, N  rows and columns of the grid
///   B     cubic B-spline: B(0) = 2/3, B(+-1) = 1/6, 0 from +-2 on
///   c     coefficients, periodic; from the values by a recursive filter along each axis
///
/// Source: M. Unser, IEEE Signal Process. Mag. 16(6) (1999) 22, doi:10.1109/79.799930, box 2, here
/// with the sums of its filter over all periods.
/// Valid at any point. Of a smooth function the error falls with the fourth power of the spacing
/// of the grid, that of its slopes with the third.
namespace tomlin {

class PeriodicSpline {
 public:
  /// Takes values row by row, at least one; a single column stands for a function of u alone.
  PeriodicSpline(std::size_t columns, std::vector<double> values);

  std::size_t rows() const { return values_.size() / columns_; }
  std::size_t columns() const { return columns_; }
  const std::vector<double>& values() const { return values_; }

  /// Table for SplinePoint: rows, columns, then the coefficients divided by 36, three more on each
  /// axis than the grid has points: those for the cell (m, n) stand from (m, n) on.
  const double* table() const { return table_.data(); }

  /// Bounds on |d2f/du2|, |d2f/dv2| and |d2f/dudv|.
  const std::array<double, 3>& curvatures() const { return curvatures_; }

  /// The largest differences from the trigonometric interpolation of the same values, which is
  /// exact for functions without finer waves than the grid shows.
  struct Error {
    double value = 0.0;
    double slope_u = 0.0;  ///< of df/du
    double slope_v = 0.0;
  };
  /// Looked for where those of a wave are largest: of the value in the middle between points of
  /// the grid, of a slope a quarter of the way. Takes rows columns (rows + columns) operations.
  Error error() const;

 private:
  std::array<double, 3> bounds_on_curvatures() const;

  std::size_t columns_;
  std::vector<double> values_;
  std::vector<double> table_;
  std::array<double, 3> curvatures_{};
};

inline constexpr int kSplineHead = 2;  ///< numbers of the table before the coefficients

inline namespace TOMLIN_TARGET {

/// A point of a spline, from the table of that: on one axis u, or on both.
template <class T, int axes>
class SplinePoint {
 public:
  TOMLIN_INLINE SplinePoint(const Vec<T, axes>& periods, const double* table) : table_(table) {
    for (int axis = 0; axis < axes; ++axis) {
      const T cells(static_cast<Scalar<T>>(table[axis]));
      const T position = (periods[axis] - floor(periods[axis])) * cells;
      // Rounding may make a whole period of what is just below.
      first_[axis] = min(floor(position), cells - T(1.0));
      const T f = position - first_[axis];
      const T g = T(1.0) - f;
      T* w = weight_[axis];
      w[0] = g * (g * g);
      w[1] = fma(f * f, fma(T(3.0), f, T(-6.0)), T(4.0));
      w[2] = fma(g * g, fma(T(3.0), g, T(-6.0)), T(4.0));
      w[3] = f * (f * f);
      T* s = slope_[axis];
      s[0] = T(-3.0) * (g * g);
      s[1] = f * fma(T(9.0), f, T(-12.0));
      s[2] = -(g * fma(T(9.0), g, T(-12.0)));
      s[3] = T(3.0) * (f * f);
    }
  }

  TOMLIN_INLINE T value() const { return products(weight_[0], weight_[axes - 1])[0]; }

  /// df/du and df/dv.
  TOMLIN_INLINE Vec<T, axes> gradient() const {
    Vec<T, axes> slopes = products(slope_[0], slope_[axes - 1]);
    for (int axis = 0; axis < axes; ++axis) {
      slopes[axis] = T(static_cast<Scalar<T>>(table_[axis])) * slopes[axis];
    }
    return slopes;
  }

 private:
  /// Sums of the coefficients times weights, `along` in place of those on each axis in turn.
  TOMLIN_INLINE Vec<T, axes> products(const T* along_u, const T* along_v) const {
    const double stride = table_[1] + 3.0;
    T index = first_[0] * T(static_cast<Scalar<T>>(stride));
    if constexpr (axes == 2) index = index + first_[1];
    const TableIndex<T> cell(index);
    Vec<T, axes> sum;
    for (int axis = 0; axis < axes; ++axis) sum[axis] = T(0.0);
    for (int m = 0; m < 4; ++m) {
      const double* row = table_ + kSplineHead + m * static_cast<std::ptrdiff_t>(stride);
      if constexpr (axes == 1) {
        sum[0] = fma(along_u[m], T(6.0) * cell.of(row), sum[0]);
      } else {
        T even(0.0);
        T odd(0.0);
        for (int n = 0; n < 4; ++n) {
          const T coefficient = cell.of(row + n);
          even = fma(weight_[1][n], coefficient, even);
          odd = fma(along_v[n], coefficient, odd);
        }
        sum[0] = fma(along_u[m], even, sum[0]);
        sum[1] = fma(weight_[0][m], odd, sum[1]);
      }
    }
    return sum;
  }

  const double* table_;
  Vec<T, axes> first_;  ///< of the cell: row, column
  T weight_[axes][4];   ///< 6 B
  T slope_[axes][4];    ///< its derivative by cells
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
