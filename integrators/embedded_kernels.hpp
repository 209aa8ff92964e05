#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/system.hpp"
#include "framework/core/system/tolerance.hpp"

/// The kernels of embedded explicit Runge-Kutta pairs, made from a tableau.
namespace tomlin {

/// Most slopes of any pair: stages, the evaluation at the end of a step, those for dense output.
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
};

struct EmbeddedTrial {
  double error = 0.0;  ///< weighted root mean square; NaN when the step left the finite numbers
  bool within_moves = true;
  unsigned evaluations = 0;
};

/// One kind of numbers over the last step: where they started, where they are, and the slopes of
/// all stages.
template <class Real>
struct EmbeddedStep {
  double length = 0.0;
  std::size_t count = 0;
  const Real* start = nullptr;
  const Real* end = nullptr;
  const Real* slope[kMostSlopes] = {};
};

/// The next step is h clip(0.9 err^-exponent err_old^beta, least_factor, most_factor).
struct StepControl {
  double exponent = 0.0;
  double beta = 0.0;
  double least_factor = 0.0;
  double most_factor = 0.0;
};

inline constexpr double kSafetyOfStep = 0.9;

/// An attempt over replicas in lanes (framework/core/system/lanes.hpp): arrays over lanes.
struct EmbeddedLanes {
  std::size_t width = 0;
  std::size_t coordinates = 0;  ///< of each replica
  std::size_t rates = 0;
  /// [coordinate]: its number in the arrays of one run, modulo kGroup: where its error is summed.
  const std::size_t* residue = nullptr;
  const double* position_scale = nullptr;  ///< [coordinate * width + lane]
  const double* velocity_scale = nullptr;
  const double* absolute_tolerance = nullptr;
  const double* relative_tolerance = nullptr;
  const double* numbers = nullptr;  ///< that the tolerances apply to
  const double* step = nullptr;
  double* elapsed = nullptr;       ///< scratch
  double* error = nullptr;         ///< as in EmbeddedTrial
  double* within_moves = nullptr;  ///< 1 or 0
  double* accepted = nullptr;      ///< likewise: error and moves allow the step
  double* evaluations = nullptr;
  StepControl law;
  const double* old_error = nullptr;
  double* accepted_factor = nullptr;  ///< as in EmbeddedTable
  double* refused_factor = nullptr;
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
  /// Computes this derivative from what every step has, extra slopes or not.
  void (*slope_within)(const EmbeddedStep<Real>& step, double theta, double* slope) = nullptr;
  /// Factors of the step after an attempt, before it is limited: after an accepted and after a
  /// rejected one.
  double (*accepted_factor)(const StepControl& law, double error, double old_error) = nullptr;
  double (*refused_factor)(const StepControl& law, double error) = nullptr;
  /// Over replicas in lanes: an attempt of each from its own state, with its own step; and the new
  /// state in the lanes that accept it.
  void (*attempt_in_lanes)(const SystemView<double>& system, const EmbeddedArrays<double>& arrays,
                           const EmbeddedLanes& lanes) = nullptr;
  void (*accept_in_lanes)(const SystemView<double>& system, const EmbeddedArrays<double>& arrays,
                          const EmbeddedLanes& lanes) = nullptr;
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
  /// With a step for each lane.
  TOMLIN_INLINE explicit Combination(const Packed<Real>& h) requires(
      !std::is_same_v<Real, Packed<Real>>) {
    fill<0>(h);
  }
  TOMLIN_INLINE Packed<Real> of(Real* const* slope, std::size_t i) const {
    return add<1>(weight_[0] * Packed<Real>::load(slope[0] + i), slope, i);
  }

 private:
  template <int j, class Step>
  TOMLIN_INLINE void fill(const Step& h) {
    if constexpr (j < n) {
      constexpr Real coefficient = Row::at(j).template as<Real>();
      weight_[j] = Packed<Real>(h * Step(coefficient));
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

  /// The state at a stage.
  template <int stage, bool inertial, class Real>
  TOMLIN_INLINE static void put_stage(const SystemView<Real>& s, const EmbeddedArrays<Real>& w,
                                      Real h) {
    using Group = Packed<Real>;
    const Combination<StageRow<stage>, stage, Real> combined(h);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.position + i) + combined.of(w.velocity, i)).store(w.position + i);
      if constexpr (inertial) {
        (Group::load(s.velocity + i) + combined.of(w.acceleration, i)).store(w.velocity[stage] + i);
      }
    }
    const std::size_t needed = stage == kEnd ? s.rates : s.own;
    for (std::size_t i = 0; i < needed; i += kGroup) {
      (Group::load(s.integrals + i) + combined.of(w.rates, i)).store(w.integrals + i);
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
    auto finite = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < n; i += kGroup) {
      finite = finite & (abs(Group::load(x + i)) < Group(Real(__builtin_inf())));
    }
    return all(finite);
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

  template <class T>
  TOMLIN_INLINE static T accepted_factor_of(const StepControl& law, const T& error,
                                            const T& old_error) {
    return T(kSafetyOfStep) * (pow(error, T(-law.exponent)) * pow(old_error, T(law.beta)));
  }
  template <class T>
  TOMLIN_INLINE static T refused_factor_of(const StepControl& law, const T& error) {
    return T(kSafetyOfStep) * pow(error, T(-law.exponent));
  }
  TOMLIN_FLATTEN static double accepted_factor(const StepControl& law, double error,
                                               double old_error) {
    return accepted_factor_of<double>(law, error, old_error);
  }
  TOMLIN_FLATTEN static double refused_factor(const StepControl& law, double error) {
    return refused_factor_of<double>(law, error);
  }

  // ---- over replicas in lanes: the same operations in the same order for each

  template <int stage, bool inertial>
  TOMLIN_INLINE static void put_stage_in_lanes(const SystemView<double>& s,
                                               const EmbeddedArrays<double>& w,
                                               const EmbeddedLanes& l) {
    constexpr bool ends = stage == kEnd;
    for (std::size_t lane = 0; lane < l.width; lane += kGroup) {
      const Combination<StageRow<stage>, stage, double> combined(Pack::load(l.step + lane));
      for (std::size_t k = 0; k < l.coordinates; ++k) {
        const std::size_t i = k * l.width + lane;
        (Pack::load(s.position + i) + combined.of(w.velocity, i)).store(w.position + i);
        if constexpr (inertial) {
          (Pack::load(s.velocity + i) + combined.of(w.acceleration, i))
              .store(w.velocity[stage] + i);
        }
      }
      for (std::size_t k = 0; ends && k < l.rates; ++k) {
        const std::size_t i = k * l.width + lane;
        (Pack::load(s.integrals + i) + combined.of(w.rates, i)).store(w.integrals + i);
      }
    }
  }

  template <int stage, bool inertial>
  TOMLIN_INLINE static void evaluate_stage_in_lanes(const SystemView<double>& s,
                                                    const EmbeddedArrays<double>& w,
                                                    const EmbeddedLanes& l) {
    constexpr double time = Tableau::c[stage].template as<double>();
    for (std::size_t lane = 0; lane < l.width; lane += kGroup) {
      (Pack(0.0) + Pack(time) * Pack::load(l.step + lane)).store(l.elapsed + lane);
    }
    Stage<double> at = stage_of(s, static_cast<const double*>(w.position),
                                static_cast<const double*>(w.velocity[inertial ? stage : 0]),
                                static_cast<const double*>(w.integrals), w.rates[stage], 0.0);
    at.elapsed_in_lanes = l.elapsed;
    evaluate(s, at);
    put_slopes(s, inertial ? w.acceleration[stage] : w.velocity[stage]);
  }

  template <int stage, bool inertial>
  TOMLIN_INLINE static void advance_in_lanes(const SystemView<double>& s,
                                             const EmbeddedArrays<double>& w,
                                             const EmbeddedLanes& l) {
    if constexpr (stage < kEnd) {
      put_stage_in_lanes<stage, inertial>(s, w, l);
      evaluate_stage_in_lanes<stage, inertial>(s, w, l);
      advance_in_lanes<stage + 1, inertial>(s, w, l);
    }
  }

  template <class Row, int n, bool inertial>
  TOMLIN_INLINE static Pack squares_in_lanes(const SystemView<double>& s,
                                             const EmbeddedArrays<double>& w,
                                             const EmbeddedLanes& l, std::size_t lane) {
    const Combination<Row, n, double> combined(Pack::load(l.step + lane));
    const Pack absolute = Pack::load(l.absolute_tolerance + lane);
    const Pack relative = Pack::load(l.relative_tolerance + lane);
    const Pack smallest(1e-300);
    const OrderFreeSum<Pack> zero(Pack(0.0));
    OrderFreeSum<Pack> sums[kGroup] = {zero, zero, zero, zero, zero, zero, zero, zero};
    for (std::size_t k = 0; k < l.coordinates; ++k) {
      const std::size_t i = k * l.width + lane;
      const Pack ex = weighted(combined.of(w.velocity, i), Pack::load(s.position + i),
                               Pack::load(w.position + i), Pack::load(l.position_scale + i),
                               absolute, relative, smallest);
      if constexpr (inertial) {
        const Pack ev = weighted(combined.of(w.acceleration, i), Pack::load(s.velocity + i),
                                 Pack::load(w.velocity[kEnd] + i), Pack::load(l.velocity_scale + i),
                                 absolute, relative, smallest);
        sums[l.residue[k]].add(fma(ex, ex, ev * ev));
      } else {
        sums[l.residue[k]].add(ex * ex);
      }
    }
    const Pack low = (sums[0].total() + sums[4].total()) + (sums[2].total() + sums[6].total());
    return low + ((sums[1].total() + sums[5].total()) + (sums[3].total() + sums[7].total()));
  }

  template <bool inertial>
  TOMLIN_INLINE static void attempt_in_lanes_of(const SystemView<double>& s,
                                                const EmbeddedArrays<double>& w,
                                                const EmbeddedLanes& l) {
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Pack::load(s.velocity + i).store(w.velocity[0] + i);
    }
    advance_in_lanes<1, inertial>(s, w, l);
    put_stage_in_lanes<kEnd, inertial>(s, w, l);
    if constexpr (!Tableau::two_errors) evaluate_stage_in_lanes<kEnd, inertial>(s, w, l);
    bool any_accepted = false;
    for (std::size_t lane = 0; lane < l.width; lane += kGroup) {
      const Pack count = Pack::load(l.numbers + lane);
      Pack error;
      if constexpr (!Tableau::two_errors) {
        error = sqrt(squares_in_lanes<ErrorRow, kEnd + 1, inertial>(s, w, l, lane) / count);
      } else {
        const Pack fine = squares_in_lanes<ErrorRow, kEnd, inertial>(s, w, l, lane);
        const Pack coarse = squares_in_lanes<ThirdRow, kEnd, inertial>(s, w, l, lane);
        const Pack both = fma(Pack(0.01), coarse, fine);
        error = select(both == Pack(0.0), Pack(0.0), fine / sqrt(count * both));
      }
      auto within = first_lanes_of<Pack>(kGroup);
      for (std::size_t k = 0; k < l.coordinates; ++k) {
        const std::size_t i = k * l.width + lane;
        const Pack move = abs(Pack::load(w.position + i) - Pack::load(s.position + i));
        within = within & (move <= Pack::load(s.largest_move + i));
      }
      const auto accepted = within & (error <= Pack(1.0));
      error.store(l.error + lane);
      accepted_factor_of<Pack>(l.law, error, Pack::load(l.old_error + lane))
          .store(l.accepted_factor + lane);
      if (!all(accepted)) refused_factor_of<Pack>(l.law, error).store(l.refused_factor + lane);
      select(within, Pack(1.0), Pack(0.0)).store(l.within_moves + lane);
      select(accepted, Pack(1.0), Pack(0.0)).store(l.accepted + lane);
      const Pack all_stages(static_cast<double>(kEnd));
      const Pack without_end(static_cast<double>(Tableau::two_errors ? kEnd - 1 : kEnd));
      select(accepted, all_stages, without_end).store(l.evaluations + lane);
      any_accepted = any_accepted || any(accepted);
    }
    if constexpr (Tableau::two_errors) {
      if (!any_accepted) return;
      evaluate_stage_in_lanes<kEnd, inertial>(s, w, l);
      const double* slope = inertial ? w.acceleration[kEnd] : w.velocity[kEnd];
      for (std::size_t lane = 0; lane < l.width; lane += kGroup) {
        auto finite = first_lanes_of<Pack>(kGroup);
        for (std::size_t k = 0; k < l.coordinates; ++k) {
          finite = finite & (abs(Pack::load(slope + k * l.width + lane)) < Pack(__builtin_inf()));
        }
        // They decide in a lane that has accepted, as moves do.
        const Pack accepts = Pack::load(l.accepted + lane);
        const auto was = accepts == Pack(1.0);
        const Pack still = select(finite, accepts, Pack(0.0));
        select(was, still, Pack::load(l.within_moves + lane)).store(l.within_moves + lane);
        still.store(l.accepted + lane);
      }
    }
  }

  TOMLIN_FLATTEN static void attempt_in_lanes(const SystemView<double>& system,
                                              const EmbeddedArrays<double>& arrays,
                                              const EmbeddedLanes& lanes) {
    const SystemView<double> s = system;
    const EmbeddedArrays<double> w = arrays;
    const EmbeddedLanes l = lanes;
    return s.inertial ? attempt_in_lanes_of<true>(s, w, l) : attempt_in_lanes_of<false>(s, w, l);
  }

  TOMLIN_FLATTEN static void accept_in_lanes(const SystemView<double>& s,
                                             const EmbeddedArrays<double>& w,
                                             const EmbeddedLanes& l) {
    for (std::size_t lane = 0; lane < l.width; lane += kGroup) {
      const auto accepted = Pack::load(l.accepted + lane) == Pack(1.0);
      const auto take = [&](const double* from, double* to, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
          const std::size_t i = k * l.width + lane;
          select(accepted, Pack::load(from + i), Pack::load(to + i)).store(to + i);
        }
      };
      take(w.position, s.position, l.coordinates);
      take(w.velocity[kEnd], s.velocity, l.coordinates);
      take(w.integrals, s.integrals, l.rates);
      take(w.acceleration[kEnd], w.acceleration[0], l.coordinates);
      take(w.rates[kEnd], w.rates[0], l.rates);
    }
  }

  template <class Real>
  static constexpr EmbeddedTable<Real> with_control(EmbeddedTable<Real> table) {
    table.accepted_factor = &accepted_factor;
    table.refused_factor = &refused_factor;
    if constexpr (std::is_same_v<Real, double>) {
      table.attempt_in_lanes = &attempt_in_lanes;
      table.accept_in_lanes = &accept_in_lanes;
    }
    return table;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
