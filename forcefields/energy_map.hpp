#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/table_index.hpp"
#include "framework/core/numbers/vec.hpp"
#include "framework/core/records/parameter.hpp"

/// A periodic function of the place on a lattice, from its values on a grid: the interpolating
/// cubic spline, on two axes the product of such splines (bicubic). It is twice continuously
/// differentiable, so that forces and curvatures have no jumps.
///
///   V(u, v) = sum_kl c_kl B(M u - k) B(N v - l),   V(m/M, n/N) = value[m][n]
///
///   u, v  the place in lattice vectors
///   M, N  rows and columns of the grid
///   B     cubic B-spline: B(0) = 2/3, B(+-1) = 1/6, 0 from +-2 on
///   c     coefficients, periodic; from the values by a recursive filter along each axis
///
/// Source: M. Unser, IEEE Signal Process. Mag. 16(6) (1999) 22, doi:10.1109/79.799930, box 2, here
/// with the sums of its filter over all periods.
/// Valid for any place. Of a smooth function the error falls with the fourth power of the spacing
/// of the grid, that of its slopes with the third.
namespace tomlin {

class EnergyMap {
 public:
  /// Of a grid that has rows; a single column stands for a function of u alone.
  explicit EnergyMap(NumberTable values);

  const NumberTable& values() const { return values_; }

  /// What LatticeMap reads: rows, columns, then the coefficients divided by 36, three more on each
  /// axis than the grid has points: those for the cell (m, n) stand from (m, n) on.
  const double* table() const { return table_.data(); }

  /// Bounds on |d2V/du2|, |d2V/dv2| and |d2V/dudv|.
  std::array<double, 3> curvatures() const;

  /// The largest differences from the trigonometric interpolation of the same values, which is
  /// exact for functions without finer waves than the grid shows.
  struct Error {
    double energy = 0.0;
    double slope_u = 0.0;  ///< of dV/du
    double slope_v = 0.0;
  };
  /// Looked for where those of a wave are largest: of the energy in the middle between points of
  /// the grid, of a slope a quarter of the way. Takes rows columns (rows + columns) operations.
  Error error() const;

 private:
  NumberTable values_;
  std::vector<double> table_;
};

inline constexpr int kEnergyMapHead = 2;  ///< numbers before the coefficients

inline namespace TOMLIN_TARGET {

/// The spline at a place, as LatticeSum of lattice_substrate.hpp is a sum of waves.
template <class T, int phases>
struct LatticeMap {
  static constexpr int kTerms = 1;  ///< that depend on the height each by its own

  T scale;  ///< on the map's energies

  /// The cell and the splines in it.
  struct Waves {
    const double* table;
    Vec<T, phases> first;  ///< of the cell: row, column
    T weight[phases][4];   ///< 6 B
    T slope[phases][4];    ///< its derivative by cells

    TOMLIN_INLINE Waves(const Vec<T, phases>& turns, const double* numbers) : table(numbers) {
      for (int axis = 0; axis < phases; ++axis) {
        const T cells(static_cast<Scalar<T>>(table[axis]));
        const T place = (turns[axis] - floor(turns[axis])) * cells;
        // Rounding may make a whole period of what is just below.
        first[axis] = min(floor(place), cells - T(1.0));
        const T f = place - first[axis];
        const T g = T(1.0) - f;
        T* w = weight[axis];
        w[0] = g * (g * g);
        w[1] = fma(f * f, fma(T(3.0), f, T(-6.0)), T(4.0));
        w[2] = fma(g * g, fma(T(3.0), g, T(-6.0)), T(4.0));
        w[3] = f * (f * f);
        T* s = slope[axis];
        s[0] = T(-3.0) * (g * g);
        s[1] = f * fma(T(9.0), f, T(-12.0));
        s[2] = -(g * fma(T(9.0), g, T(-12.0)));
        s[3] = T(3.0) * (f * f);
      }
    }
  };

  TOMLIN_INLINE T energy(const Waves& w) const {
    return scale * products(w, w.weight[0], w.weight[phases - 1])[0];
  }

  /// -dV/du and -dV/dv.
  TOMLIN_INLINE Vec<T, phases> pull(const Waves& w) const {
    Vec<T, phases> pull = products(w, w.slope[0], w.slope[phases - 1]);
    for (int axis = 0; axis < phases; ++axis) {
      pull[axis] = -((scale * T(static_cast<Scalar<T>>(w.table[axis]))) * pull[axis]);
    }
    return pull;
  }

 private:
  /// Sums of the coefficients times weights, `along` in place of those on each axis in turn.
  TOMLIN_INLINE static Vec<T, phases> products(const Waves& w, const T* along_u, const T* along_v) {
    const double stride = w.table[1] + 3.0;
    T place = w.first[0] * T(static_cast<Scalar<T>>(stride));
    if constexpr (phases == 2) place = place + w.first[1];
    const TableIndex<T> cell(place);
    Vec<T, phases> sum;
    for (int axis = 0; axis < phases; ++axis) sum[axis] = T(0.0);
    for (int m = 0; m < 4; ++m) {
      const double* row = w.table + kEnergyMapHead + m * static_cast<std::ptrdiff_t>(stride);
      if constexpr (phases == 1) {
        sum[0] = fma(along_u[m], T(6.0) * cell.of(row), sum[0]);
      } else {
        T even(0.0);
        T odd(0.0);
        for (int n = 0; n < 4; ++n) {
          const T coefficient = cell.of(row + n);
          even = fma(w.weight[1][n], coefficient, even);
          odd = fma(along_v[n], coefficient, odd);
        }
        sum[0] = fma(along_u[m], even, sum[0]);
        sum[1] = fma(w.weight[0][m], odd, sum[1]);
      }
    }
    return sum;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
