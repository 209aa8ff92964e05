#pragma once

#include <cstddef>

#include "framework/core/evaluate.hpp"
#include "framework/core/pack.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

/// Coefficients of the pair; the scheme is autonomous in its stages, so times are c[s] h.
struct Dopri5Tableau {
  static constexpr int stages = 7;
  static constexpr double c[7] = {0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0};
  static constexpr double a[7][6] = {
      {},
      {1.0 / 5.0},
      {3.0 / 40.0, 9.0 / 40.0},
      {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
      {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
      {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
      {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
  /// Fifth-order weights less fourth-order ones.
  static constexpr double error[7] = {
      71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
      -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0};
  /// Of the continuous extension.
  static constexpr double dense[7] = {
      -12715105075.0 / 11282082432.0,  0.0,
      87487479700.0 / 32700410799.0,   -10690763975.0 / 1880347072.0,
      701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
      69997945.0 / 29380423.0};
};

/// Work space of one step. Slopes of positions are the stage velocities.
struct Dopri5Arrays {
  double* velocity[7] = {};      ///< [0] is a copy of the start's
  double* acceleration[7] = {};  ///< [0] holds the start's before a step
  double* rates[7] = {};
  double* position = nullptr;   ///< of the stage, at the end of the step the new one
  double* integrals = nullptr;  ///< the same for integrals (own variables at stages)
};

struct Dopri5Trial {
  double error = 0.0;  ///< weighted root mean square; NaN when the step left the finite numbers
  bool within_moves = true;
};

struct Dopri5Table {
  void (*first)(const SystemView<double>& system, const Dopri5Arrays& arrays,
                double since) = nullptr;
  Dopri5Trial (*attempt)(const SystemView<double>& system, const Dopri5Arrays& arrays, double since,
                         double h, double absolute_tolerance, double relative_tolerance) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// Rounded once, at the end: all bodies have a say in the step, and their order in the scene none.
class OrderFreeSum {
 public:
  TOMLIN_INLINE void add(const Pack& x) {
    const Pack total = high_ + x;
    const Pack part = total - high_;
    low_ += (high_ - (total - part)) + (x - part);
    high_ = total;
  }
  TOMLIN_INLINE Pack total() const { return high_ + low_; }

 private:
  Pack high_ = Pack(0.0);
  Pack low_ = Pack(0.0);
};

struct Dopri5Kernels {
  using Tableau = Dopri5Tableau;

  TOMLIN_FLATTEN static void first(const SystemView<double>& s, const Dopri5Arrays& w,
                                   double since) {
    evaluate(s, stage_of(s, static_cast<const double*>(s.position),
                         static_cast<const double*>(s.velocity),
                         static_cast<const double*>(s.integrals), w.rates[0], since));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Pack::load(s.force + i) * Pack::load(s.inverse_mass + i)).store(w.acceleration[0] + i);
    }
  }

  /// Sum of h * weight[j] * slope[j] for j < n, smallest index first.
  template <int n>
  TOMLIN_INLINE static Pack combined(const Pack (&weight)[7], double* const* slope, std::size_t i) {
    Pack total = weight[0] * Pack::load(slope[0] + i);
    for (int j = 1; j < n; ++j) total = fma(weight[j], Pack::load(slope[j] + i), total);
    return total;
  }

  template <int stage>
  TOMLIN_INLINE static void advance(const SystemView<double>& s, const Dopri5Arrays& w,
                                    double since, double h) {
    Pack weight[7];
    for (int j = 0; j < stage; ++j) weight[j] = Pack(h * Tableau::a[stage][j]);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Pack::load(s.position + i) + combined<stage>(weight, w.velocity, i)).store(w.position + i);
      (Pack::load(s.velocity + i) + combined<stage>(weight, w.acceleration, i))
          .store(w.velocity[stage] + i);
    }
    const std::size_t needed = stage == Tableau::stages - 1 ? s.rates : s.own;
    for (std::size_t i = 0; i < needed; i += kGroup) {
      (Pack::load(s.integrals + i) + combined<stage>(weight, w.rates, i)).store(w.integrals + i);
    }
    evaluate(s, stage_of(s, static_cast<const double*>(w.position),
                         static_cast<const double*>(w.velocity[stage]),
                         static_cast<const double*>(w.integrals), w.rates[stage],
                         since + Tableau::c[stage] * h));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Pack::load(s.force + i) * Pack::load(s.inverse_mass + i)).store(w.acceleration[stage] + i);
    }
  }

  TOMLIN_INLINE static Pack weighted(Pack error, Pack before, Pack after, Pack scale, Pack absolute,
                                     Pack relative) {
    const Pack size = max(abs(before), abs(after)) * scale;
    // The smallest number keeps a coordinate that is exactly zero from giving 0/0.
    return error * scale / (fma(relative, size, absolute) + Pack(1e-300));
  }

  TOMLIN_FLATTEN static Dopri5Trial attempt(const SystemView<double>& system,
                                            const Dopri5Arrays& arrays, double since, double h,
                                            double absolute_tolerance, double relative_tolerance) {
    const SystemView<double> s = system;
    const Dopri5Arrays w = arrays;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Pack::load(s.velocity + i).store(w.velocity[0] + i);
    }
    advance<1>(s, w, since, h);
    advance<2>(s, w, since, h);
    advance<3>(s, w, since, h);
    advance<4>(s, w, since, h);
    advance<5>(s, w, since, h);
    advance<6>(s, w, since, h);

    Pack weight[7];
    for (int j = 0; j < 7; ++j) weight[j] = Pack(h * Tableau::error[j]);
    const Pack absolute(absolute_tolerance);
    const Pack relative(relative_tolerance);
    PackMask within = first_lanes(kGroup);
    OrderFreeSum squares;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Pack scale = Pack::load(s.tolerance_scale + i);
      const Pack x0 = Pack::load(s.position + i);
      const Pack x1 = Pack::load(w.position + i);
      const Pack ex =
          weighted(combined<7>(weight, w.velocity, i), x0, x1, scale, absolute, relative);
      const Pack ev = weighted(combined<7>(weight, w.acceleration, i), Pack::load(s.velocity + i),
                               Pack::load(w.velocity[6] + i), scale, absolute, relative);
      squares.add(fma(ex, ex, ev * ev));
      within = within & (abs(x1 - x0) <= Pack::load(s.largest_move + i));
    }
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      const Pack e = weighted(combined<7>(weight, w.rates, i), Pack::load(s.integrals + i),
                              Pack::load(w.integrals + i), Pack(1.0), absolute, relative);
      squares.add(e * e);
    }
    const double count =
        2.0 * static_cast<double>(s.coordinates) + static_cast<double>(s.own_count);
    return {sqrt(sum(squares.total()) / (count > 0.0 ? count : 1.0)), all(within)};
  }

  static constexpr Dopri5Table kernels() { return {&first, &attempt}; }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
