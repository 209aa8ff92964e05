#pragma once

#include <cstddef>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/compensated.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/system.hpp"
#include "framework/core/system/tolerance.hpp"

/// The kernels of embedded explicit Runge-Kutta pairs, made from a tableau.
namespace tomlin {

/// Of all pairs: stages, the evaluation at the end of a step, those for dense output alone.
inline constexpr int kMostSlopes = 16;

/// Work space of one step. Slopes of positions are the stage velocities.
template <class Real>
struct EmbeddedArrays {
  Real* velocity[kMostSlopes] = {};  ///< [0] is a copy of the start's
  /// [0] holds the start's before a step; unused without inertia.
  Real* acceleration[kMostSlopes] = {};
  Real* rates[kMostSlopes] = {};
  Real* position = nullptr;   ///< of the stage, at the end of the step the new one
  Real* integrals = nullptr;  ///< the same for integrals (own variables at stages)
  // What the new numbers lack, where that is kept (compensated.hpp).
  Real* position_rest = nullptr;
  Real* velocity_rest = nullptr;
  Real* integrals_rest = nullptr;
};

struct EmbeddedTrial {
  double error = 0.0;  ///< weighted root mean square; NaN when the step left the finite numbers
  bool within_moves = true;
  unsigned evaluations = 0;
};

/// One kind of numbers over the last step: where they started, where they are, and the slopes of
/// all stages; with the rests, where those are kept.
template <class Real>
struct EmbeddedStep {
  double length = 0.0;
  std::size_t count = 0;
  const Real* start = nullptr;
  const Real* start_rest = nullptr;
  const Real* end = nullptr;
  const Real* end_rest = nullptr;
  const Real* slope[kMostSlopes] = {};
};

template <class Real>
struct EmbeddedTable {
  void (*first)(const SystemView<Real>& system, const EmbeddedArrays<Real>& arrays,
                double since) = nullptr;
  EmbeddedTrial (*attempt)(const SystemView<Real>& system, const EmbeddedArrays<Real>& arrays,
                           double since, double h, double absolute_tolerance,
                           double relative_tolerance) = nullptr;
  /// Slopes for dense output alone, of a system that stands at the start of the step; null where
  /// there are none.
  void (*extra)(const SystemView<Real>& start, const EmbeddedArrays<Real>& arrays, double since,
                double h) = nullptr;
  /// The continuous extension at a fraction of the step, and its derivative with respect to time.
  void (*extension)(const EmbeddedStep<Real>& step, double theta, double* y) = nullptr;
  void (*extension_slope)(const EmbeddedStep<Real>& step, double theta, double* slope) = nullptr;
  /// The same derivative from what every step has, extra slopes or not.
  void (*slope_within)(const EmbeddedStep<Real>& step, double theta, double* slope) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// Rounded once, at the end: all bodies have a say in the step, and their order in the scene none.
template <class Group>
class OrderFreeSum {
 public:
  TOMLIN_INLINE explicit OrderFreeSum(const Group& zero) : high_(zero), low_(zero) {}
  TOMLIN_INLINE void add(const Group& x) {
    const Group total = high_ + x;
    const Group part = total - high_;
    low_ = low_ + ((high_ - (total - part)) + (x - part));
    high_ = total;
  }
  TOMLIN_INLINE Group total() const { return high_ + low_; }

 private:
  Group high_;
  Group low_;
};

/// A row of coefficients times h times slopes, smallest index first; zeros are left out.
template <class Row, int n, class Real>
class Combination {
 public:
  TOMLIN_INLINE explicit Combination(Real h) { fill<0>(h); }
  TOMLIN_INLINE Packed<Real> of(Real* const* slope, std::size_t i) const {
    return add<1>(weight_[0] * Packed<Real>::load(slope[0] + i), slope, i);
  }

 private:
  template <int j>
  TOMLIN_INLINE void fill(Real h) {
    if constexpr (j < n) {
      constexpr Real coefficient = Row::at(j).template as<Real>();
      weight_[j] = Packed<Real>(h * coefficient);
      fill<j + 1>(h);
    }
  }
  template <int j>
  TOMLIN_INLINE Packed<Real> add(Packed<Real> total, Real* const* slope, std::size_t i) const {
    if constexpr (j == n) {
      return total;
    } else {
      if constexpr (!Row::at(j).zero()) {
        total = fma(weight_[j], Packed<Real>::load(slope[j] + i), total);
      }
      return add<j + 1>(total, slope, i);
    }
  }

  Packed<Real> weight_[n];
};

/// A Tableau gives
///   end           the stage that is evaluated at the end of a step, and is the next step's first
///   c[], a[][]    times and rows of stages; row `end` holds the weights of the solution
///   error[]       weights of the solution less those of the embedded one
///   two_errors    false: error[] includes the stage at the end. True: it does not, and a second
///                 solution, of weights third[] and third order, has a say in the estimate.
template <class Tableau>
struct EmbeddedKernels {
  static constexpr int kEnd = Tableau::end;

  template <int stage>
  struct StageRow {
    static constexpr auto at(int j) { return Tableau::a[stage][j]; }
  };
  struct ErrorRow {
    static constexpr auto at(int j) { return Tableau::error[j]; }
  };
  struct ThirdRow {
    static constexpr auto at(int j) { return Tableau::a[kEnd][j] - Tableau::third[j]; }
  };

  /// Slopes at the start; without inertia they are the velocity.
  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                   double since) {
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), w.rates[0], Real(since)));
    put_slopes(s, s.inertial ? w.acceleration[0] : s.velocity);
  }

  template <class Real>
  TOMLIN_INLINE static void put_slopes(const SystemView<Real>& s, Real* slope) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(slope + i);
    }
  }

  /// start + change, and at the end of the step what the sum leaves out, where that is kept.
  template <bool ends, class Real>
  TOMLIN_INLINE static void put_sum(const Real* start, const Real* start_rest,
                                    const Packed<Real>& change, std::size_t i, Real* result,
                                    Real* result_rest) {
    using Group = Packed<Real>;
    if constexpr (ends && kCompensated<Real>) {
      Group::load(start + i).store(result + i);
      Group::load(start_rest + i).store(result_rest + i);
      add_move(result, result_rest, i, change);
    } else {
      (Group::load(start + i) + change).store(result + i);
    }
  }

  /// The state at a stage.
  template <int stage, bool inertial, class Real>
  TOMLIN_INLINE static void put_stage(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                      Real h) {
    constexpr bool ends = stage == kEnd;
    const Combination<StageRow<stage>, stage, Real> combined(h);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      put_sum<ends, Real>(s.position, s.position_rest, combined.of(w.velocity, i), i, w.position,
                          w.position_rest);
      if constexpr (inertial) {
        put_sum<ends, Real>(s.velocity, s.velocity_rest, combined.of(w.acceleration, i), i,
                            w.velocity[stage], w.velocity_rest);
      }
    }
    const std::size_t needed = ends ? s.rates : s.own;
    for (std::size_t i = 0; i < needed; i += kGroup) {
      put_sum<ends, Real>(s.integrals, s.integrals_rest, combined.of(w.rates, i), i, w.integrals,
                          w.integrals_rest);
    }
  }

  template <int stage, bool inertial, class Real>
  TOMLIN_INLINE static void evaluate_stage(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                           Real since, Real h) {
    constexpr Real time = Tableau::c[stage].template as<Real>();
    evaluate(s, stage_of(s, static_cast<const Real*>(w.position),
                         static_cast<const Real*>(w.velocity[inertial ? stage : 0]),
                         static_cast<const Real*>(w.integrals), w.rates[stage], since + time * h));
    put_slopes(s, inertial ? w.acceleration[stage] : w.velocity[stage]);
  }

  /// Stages from `stage` up to and without `past`.
  template <int stage, int past, bool inertial, class Real>
  TOMLIN_INLINE static void advance(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                    Real since, Real h) {
    if constexpr (stage < past) {
      put_stage<stage, inertial>(s, w, h);
      evaluate_stage<stage, inertial>(s, w, since, h);
      advance<stage + 1, past, inertial>(s, w, since, h);
    }
  }

  template <class Group>
  TOMLIN_INLINE static Group weighted(Group error, Group before, Group after, Group scale,
                                      Group absolute, Group relative, Group smallest) {
    const Group size = max(abs(before), abs(after)) * scale;
    // The smallest number keeps a coordinate that is exactly zero from giving 0/0.
    return error * scale / (fma(relative, size, absolute) + smallest);
  }

  /// Sum of the weighted squares of h times a row, over all that tolerances apply to. Both
  /// tolerances are pure numbers.
  template <class Row, int n, bool inertial, class Real>
  TOMLIN_INLINE static double squares(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                      Real h, double absolute_tolerance,
                                      double relative_tolerance) {
    using Group = Packed<Real>;
    const Combination<Row, n, Real> combined(h);
    const Group absolute{Real(absolute_tolerance)};
    const Group relative{Real(relative_tolerance)};
    const Group smallest{Real(sizeof(Real) < sizeof(double) ? 1e-37 : 1e-300)};
    const Real* position_scale = s.tolerance_scale;
    const Real* velocity_scale = s.tolerance_scale + s.dofs;
    const Real* own_scale = s.tolerance_scale + 3 * s.dofs;
    OrderFreeSum<Group> sums(Group(Real(0.0)));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group ex = weighted(combined.of(w.velocity, i), Group::load(s.position + i),
                                Group::load(w.position + i), Group::load(position_scale + i),
                                absolute, relative, smallest);
      if constexpr (inertial) {
        const Group ev = weighted(combined.of(w.acceleration, i), Group::load(s.velocity + i),
                                  Group::load(w.velocity[kEnd] + i),
                                  Group::load(velocity_scale + i), absolute, relative, smallest);
        sums.add(fma(ex, ex, ev * ev));
      } else {
        sums.add(ex * ex);
      }
    }
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      const Group e = weighted(combined.of(w.rates, i), Group::load(s.integrals + i),
                               Group::load(w.integrals + i), Group::load(own_scale + i), absolute,
                               relative, smallest);
      sums.add(e * e);
    }
    return static_cast<double>(sum(sums.total()));
  }

  template <class Real>
  TOMLIN_INLINE static bool within_moves(const SystemView<Real>& s, const EmbeddedArrays<Real>& w) {
    using Group = Packed<Real>;
    auto within = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group move = abs(Group::load(w.position + i) - Group::load(s.position + i));
      within = within & (move <= Group::load(s.largest_move + i));
    }
    return all(within);
  }

  template <class Real>
  TOMLIN_INLINE static bool finite(const Real* x, std::size_t n) {
    using Group = Packed<Real>;
    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < n; i += kGroup) {
      sound = sound & (abs(Group::load(x + i)) < Group(Real(__builtin_inf())));
    }
    return all(sound);
  }

  template <bool inertial, class Real>
  TOMLIN_INLINE static EmbeddedTrial attempt_of(const SystemView<Real>& s,
                                                const EmbeddedArrays<Real>& w, Real since, Real h,
                                                double absolute, double relative) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Group::load(s.velocity + i).store(w.velocity[0] + i);
    }
    advance<1, kEnd, inertial>(s, w, since, h);
    put_stage<kEnd, inertial>(s, w, h);
    const double numbers = (inertial ? 2.0 : 1.0) * static_cast<double>(s.coordinates) +
                           static_cast<double>(s.own_count);
    const double count = numbers > 0.0 ? numbers : 1.0;

    if constexpr (!Tableau::two_errors) {
      evaluate_stage<kEnd, inertial>(s, w, since, h);
      const double total = squares<ErrorRow, kEnd + 1, inertial>(s, w, h, absolute, relative);
      return {sqrt(total / count), within_moves(s, w), kEnd};
    } else {
      // The estimate of higher order, weighed down where it is far below the one of lower order.
      const double fine = squares<ErrorRow, kEnd, inertial>(s, w, h, absolute, relative);
      const double coarse = squares<ThirdRow, kEnd, inertial>(s, w, h, absolute, relative);
      const double both = fma(0.01, coarse, fine);
      const double error = both == 0.0 ? 0.0 : fine / sqrt(count * both);
      const bool within = within_moves(s, w);
      if (!(error <= 1.0 && within)) return {error, within, kEnd - 1};
      evaluate_stage<kEnd, inertial>(s, w, since, h);
      const Real* slope = inertial ? w.acceleration[kEnd] : w.velocity[kEnd];
      return {error, finite(slope, s.dofs), kEnd};
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static EmbeddedTrial attempt(const SystemView<Real>& system,
                                              const EmbeddedArrays<Real>& arrays, double since,
                                              double h, double absolute, double relative) {
    const SystemView<Real> s = system;
    const EmbeddedArrays<Real> w = arrays;
    if (s.inertial) return attempt_of<true, Real>(s, w, Real(since), Real(h), absolute, relative);
    return attempt_of<false, Real>(s, w, Real(since), Real(h), absolute, relative);
  }

  template <class Real>
  TOMLIN_INLINE static double observed(const Real* x, const Real* rest, std::size_t i) {
    return rest ? static_cast<double>(x[i]) + static_cast<double>(rest[i])
                : static_cast<double>(x[i]);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
