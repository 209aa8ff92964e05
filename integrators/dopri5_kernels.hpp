#pragma once

#include "integrators/coefficient.hpp"
#include "integrators/embedded_kernels.hpp"

namespace tomlin {

/// Coefficients of the pair; the scheme is autonomous in its stages, so times are c[s] h.
struct Dopri5Tableau {
  static constexpr int end = 6;
  static constexpr bool two_errors = false;
  static constexpr Coefficient c[7] = {{0}, {1, 5}, {3, 10}, {4, 5}, {8, 9}, {1}, {1}};
  static constexpr Coefficient a[7][6] = {
      {},
      {{1, 5}},
      {{3, 40}, {9, 40}},
      {{44, 45}, {-56, 15}, {32, 9}},
      {{19372, 6561}, {-25360, 2187}, {64448, 6561}, {-212, 729}},
      {{9017, 3168}, {-355, 33}, {46732, 5247}, {49, 176}, {-5103, 18656}},
      {{35, 384}, {0}, {500, 1113}, {125, 192}, {-2187, 6784}, {11, 84}}};
  /// Fifth-order weights less fourth-order ones.
  static constexpr Coefficient error[7] = {{71, 57600},      {0},       {-71, 16695}, {71, 1920},
                                           {-17253, 339200}, {22, 525}, {-1, 40}};
  /// Coefficients of the continuous extension, which is for observers, in double.
  static constexpr double dense[7] = {
      -12715105075.0 / 11282082432.0,  0.0,
      87487479700.0 / 32700410799.0,   -10690763975.0 / 1880347072.0,
      701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
      69997945.0 / 29380423.0};
};

inline namespace TOMLIN_TARGET {

struct Dopri5Kernels : EmbeddedKernels<Dopri5Tableau> {
  using Tableau = Dopri5Tableau;

  template <class Real>
  TOMLIN_INLINE static double weighted_slopes(const EmbeddedStep<Real>& s, std::size_t i) {
    double sum = 0.0;
    for (int j = 0; j < 7; ++j) {
      sum = fma(Tableau::dense[j], static_cast<double>(s.slope[j][i]), sum);
    }
    return sum;
  }

  /// y0 + theta (change + (1 - theta) (bend + theta (twist + (1 - theta) quartic))).
  template <class Real>
  TOMLIN_FLATTEN static void extension(const EmbeddedStep<Real>& step, double theta, double* y) {
    const EmbeddedStep<Real> s = step;
    const double rest = 1.0 - theta;
    for (std::size_t i = 0; i < s.count; ++i) {
      const auto y0 = static_cast<double>(s.start[i]);
      const auto y1 = static_cast<double>(s.end[i]);
      const double change = y1 - y0;
      const double bend = s.length * static_cast<double>(s.slope[0][i]) - change;
      const double twist = change - s.length * static_cast<double>(s.slope[6][i]) - bend;
      const double inner = fma(rest, s.length * weighted_slopes(s, i), twist);
      const double within = fma(theta, fma(rest, fma(theta, inner, bend), change), y0);
      y[i] = theta == 1.0 ? y1 : within;
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static void extension_slope(const EmbeddedStep<Real>& step, double theta,
                                             double* slope) {
    const EmbeddedStep<Real> s = step;
    const double rest = 1.0 - theta;
    const double bending = rest - theta;
    const double twisting = theta * (2.0 - 3.0 * theta);
    const double quartic = 2.0 * theta * rest * (rest - theta);
    for (std::size_t i = 0; i < s.count; ++i) {
      const double change = static_cast<double>(s.end[i]) - static_cast<double>(s.start[i]);
      const double bend = s.length * static_cast<double>(s.slope[0][i]) - change;
      const double twist = change - s.length * static_cast<double>(s.slope[6][i]) - bend;
      slope[i] = (change + bending * bend + twisting * twist +
                  quartic * (s.length * weighted_slopes(s, i))) /
                 s.length;
    }
  }

  template <class Real>
  static constexpr EmbeddedTable<Real> kernels() {
    return EmbeddedKernels<Dopri5Tableau>::with_control<Real>(
        {&first<Real>, &attempt<Real>, nullptr, &extension<Real>, &extension_slope<Real>,
         &extension_slope<Real>});
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
