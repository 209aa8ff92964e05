#pragma once

#include <cstddef>

#include "framework/core/compensated.hpp"
#include "framework/core/evaluate.hpp"
#include "framework/core/number_types.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

/// A coefficient, exact in every number type.
struct Coefficient {
  double numerator = 0.0;
  double denominator = 1.0;

  template <class Real>
  constexpr Real as() const {
    return Real(numerator) / Real(denominator);
  }
};

/// Coefficients of the pair; the scheme is autonomous in its stages, so times are c[s] h.
struct Dopri5Tableau {
  static constexpr int stages = 7;
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
  /// Of the continuous extension, which is for observers, in double.
  static constexpr double dense[7] = {
      -12715105075.0 / 11282082432.0,  0.0,
      87487479700.0 / 32700410799.0,   -10690763975.0 / 1880347072.0,
      701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
      69997945.0 / 29380423.0};
};

/// Work space of one step. Slopes of positions are the stage velocities.
template <class Real>
struct Dopri5Arrays {
  Real* velocity[7] = {};      ///< [0] is a copy of the start's
  Real* acceleration[7] = {};  ///< [0] holds the start's before a step; unused without inertia
  Real* rates[7] = {};
  Real* position = nullptr;   ///< of the stage, at the end of the step the new one
  Real* integrals = nullptr;  ///< the same for integrals (own variables at stages)
  // What the new numbers lack, where that is kept (compensated.hpp).
  Real* position_rest = nullptr;
  Real* velocity_rest = nullptr;
  Real* integrals_rest = nullptr;
};

struct Dopri5Trial {
  double error = 0.0;  ///< weighted root mean square; NaN when the step left the finite numbers
  bool within_moves = true;
};

/// One kind of numbers over the last step: where they started, where they are, and the slopes of
/// the seven stages; with the rests, where those are kept.
template <class Real>
struct Dopri5Step {
  double length = 0.0;
  std::size_t count = 0;
  const Real* start = nullptr;
  const Real* start_rest = nullptr;
  const Real* end = nullptr;
  const Real* end_rest = nullptr;
  const Real* slope[7] = {};
};

template <class Real>
struct Dopri5Table {
  void (*first)(const SystemView<Real>& system, const Dopri5Arrays<Real>& arrays,
                double since) = nullptr;
  Dopri5Trial (*attempt)(const SystemView<Real>& system, const Dopri5Arrays<Real>& arrays,
                         double since, double h, double absolute_tolerance,
                         double relative_tolerance) = nullptr;
  /// The continuous extension at a fraction of the step, and its derivative with respect to time.
  void (*extension)(const Dopri5Step<Real>& step, double theta, double* y) = nullptr;
  void (*extension_slope)(const Dopri5Step<Real>& step, double theta, double* slope) = nullptr;
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

struct Dopri5Kernels {
  using Tableau = Dopri5Tableau;

  /// Slopes at the start; without inertia they are the velocity.
  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const Dopri5Arrays<Real>& w,
                                   double since) {
    using Group = Packed<Real>;
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), w.rates[0], Real(since)));
    Real* slope = s.inertial ? w.acceleration[0] : s.velocity;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(slope + i);
    }
  }

  /// Sum of h * weight[j] * slope[j] for j < n, smallest index first.
  template <int n, class Real>
  TOMLIN_INLINE static Packed<Real> combined(const Packed<Real> (&weight)[7], Real* const* slope,
                                             std::size_t i) {
    using Group = Packed<Real>;
    Group total = weight[0] * Group::load(slope[0] + i);
    for (int j = 1; j < n; ++j) total = fma(weight[j], Group::load(slope[j] + i), total);
    return total;
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

  template <int stage, bool inertial, class Real>
  TOMLIN_INLINE static void advance(const SystemView<Real>& s, const Dopri5Arrays<Real>& w,
                                    Real since, Real h) {
    using Group = Packed<Real>;
    constexpr bool ends = stage == Tableau::stages - 1;
    Group weight[7];
    for (int j = 0; j < stage; ++j) weight[j] = Group(h * Tableau::a[stage][j].as<Real>());
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      put_sum<ends, Real>(s.position, s.position_rest, combined<stage, Real>(weight, w.velocity, i),
                          i, w.position, w.position_rest);
      if constexpr (inertial) {
        put_sum<ends, Real>(s.velocity, s.velocity_rest,
                            combined<stage, Real>(weight, w.acceleration, i), i, w.velocity[stage],
                            w.velocity_rest);
      }
    }
    const std::size_t needed = ends ? s.rates : s.own;
    for (std::size_t i = 0; i < needed; i += kGroup) {
      put_sum<ends, Real>(s.integrals, s.integrals_rest, combined<stage, Real>(weight, w.rates, i),
                          i, w.integrals, w.integrals_rest);
    }
    evaluate(s, stage_of(s, static_cast<const Real*>(w.position),
                         static_cast<const Real*>(w.velocity[inertial ? stage : 0]),
                         static_cast<const Real*>(w.integrals), w.rates[stage],
                         since + Tableau::c[stage].as<Real>() * h));
    Real* slope = inertial ? w.acceleration[stage] : w.velocity[stage];
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(slope + i);
    }
  }

  template <class Group>
  TOMLIN_INLINE static Group weighted(Group error, Group before, Group after, Group scale,
                                      Group absolute, Group relative, Group smallest) {
    const Group size = max(abs(before), abs(after)) * scale;
    // The smallest number keeps a coordinate that is exactly zero from giving 0/0.
    return error * scale / (fma(relative, size, absolute) + smallest);
  }

  template <bool inertial, class Real>
  TOMLIN_INLINE static Dopri5Trial attempt_of(const SystemView<Real>& s,
                                              const Dopri5Arrays<Real>& w, Real since, Real h,
                                              double absolute_tolerance,
                                              double relative_tolerance) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Group::load(s.velocity + i).store(w.velocity[0] + i);
    }
    advance<1, inertial>(s, w, since, h);
    advance<2, inertial>(s, w, since, h);
    advance<3, inertial>(s, w, since, h);
    advance<4, inertial>(s, w, since, h);
    advance<5, inertial>(s, w, since, h);
    advance<6, inertial>(s, w, since, h);

    Group weight[7];
    for (int j = 0; j < 7; ++j) weight[j] = Group(h * Tableau::error[j].as<Real>());
    const Group absolute{Real(absolute_tolerance)};
    const Group relative{Real(relative_tolerance)};
    const Group smallest{Real(sizeof(Real) < sizeof(double) ? 1e-37 : 1e-300)};
    auto within = first_lanes_of<Group>(kGroup);
    OrderFreeSum<Group> squares(Group(Real(0.0)));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group scale = Group::load(s.tolerance_scale + i);
      const Group x0 = Group::load(s.position + i);
      const Group x1 = Group::load(w.position + i);
      const Group ex = weighted(combined<7, Real>(weight, w.velocity, i), x0, x1, scale, absolute,
                                relative, smallest);
      if constexpr (inertial) {
        const Group ev =
            weighted(combined<7, Real>(weight, w.acceleration, i), Group::load(s.velocity + i),
                     Group::load(w.velocity[6] + i), scale, absolute, relative, smallest);
        squares.add(fma(ex, ex, ev * ev));
      } else {
        squares.add(ex * ex);
      }
      within = within & (abs(x1 - x0) <= Group::load(s.largest_move + i));
    }
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      const Group e =
          weighted(combined<7, Real>(weight, w.rates, i), Group::load(s.integrals + i),
                   Group::load(w.integrals + i), Group(Real(1.0)), absolute, relative, smallest);
      squares.add(e * e);
    }
    const double count = (inertial ? 2.0 : 1.0) * static_cast<double>(s.coordinates) +
                         static_cast<double>(s.own_count);
    const auto total = static_cast<double>(sum(squares.total()));
    return {sqrt(total / (count > 0.0 ? count : 1.0)), all(within)};
  }

  template <class Real>
  TOMLIN_FLATTEN static Dopri5Trial attempt(const SystemView<Real>& system,
                                            const Dopri5Arrays<Real>& arrays, double since,
                                            double h, double absolute_tolerance,
                                            double relative_tolerance) {
    const SystemView<Real> s = system;
    const Dopri5Arrays<Real> w = arrays;
    if (s.inertial) {
      return attempt_of<true, Real>(s, w, Real(since), Real(h), absolute_tolerance,
                                    relative_tolerance);
    }
    return attempt_of<false, Real>(s, w, Real(since), Real(h), absolute_tolerance,
                                   relative_tolerance);
  }

  template <class Real>
  TOMLIN_INLINE static double observed(const Real* x, const Real* rest, std::size_t i) {
    return rest ? static_cast<double>(x[i]) + static_cast<double>(rest[i])
                : static_cast<double>(x[i]);
  }

  template <class Real>
  TOMLIN_INLINE static double weighted_slopes(const Dopri5Step<Real>& s, std::size_t i) {
    double sum = 0.0;
    for (int j = 0; j < 7; ++j) {
      sum = fma(Tableau::dense[j], static_cast<double>(s.slope[j][i]), sum);
    }
    return sum;
  }

  /// y0 + theta (change + (1 - theta) (bend + theta (twist + (1 - theta) quartic))).
  template <class Real>
  TOMLIN_FLATTEN static void extension(const Dopri5Step<Real>& step, double theta, double* y) {
    const Dopri5Step<Real> s = step;
    const double rest = 1.0 - theta;
    for (std::size_t i = 0; i < s.count; ++i) {
      const double y0 = observed(s.start, s.start_rest, i);
      const double y1 = observed(s.end, s.end_rest, i);
      const double change = y1 - y0;
      const double bend = s.length * static_cast<double>(s.slope[0][i]) - change;
      const double twist = change - s.length * static_cast<double>(s.slope[6][i]) - bend;
      const double inner = fma(rest, s.length * weighted_slopes(s, i), twist);
      const double within = fma(theta, fma(rest, fma(theta, inner, bend), change), y0);
      y[i] = theta == 1.0 ? y1 : within;
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static void extension_slope(const Dopri5Step<Real>& step, double theta,
                                             double* slope) {
    const Dopri5Step<Real> s = step;
    const double rest = 1.0 - theta;
    const double bending = rest - theta;
    const double twisting = theta * (2.0 - 3.0 * theta);
    const double quartic = 2.0 * theta * rest * (rest - theta);
    for (std::size_t i = 0; i < s.count; ++i) {
      const double change = observed(s.end, s.end_rest, i) - observed(s.start, s.start_rest, i);
      const double bend = s.length * static_cast<double>(s.slope[0][i]) - change;
      const double twist = change - s.length * static_cast<double>(s.slope[6][i]) - bend;
      slope[i] = (change + bending * bend + twisting * twist +
                  quartic * (s.length * weighted_slopes(s, i))) /
                 s.length;
    }
  }

  template <class Real>
  static constexpr Dopri5Table<Real> kernels() {
    return {&first<Real>, &attempt<Real>, &extension<Real>, &extension_slope<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
