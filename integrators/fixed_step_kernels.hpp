#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/lane_block.hpp"
#include "framework/core/system/system.hpp"
#include "integrators/tableau_rows.hpp"

/// The kernels of explicit Runge-Kutta schemes with a fixed step, made from a tableau.
///
/// For x' = v, v' = a(t, x, v), with v_1 = v and a_s = a(t + c_s h, x_s, v_s):
///   x_s = x + c_s h v + h^2 sum_j (a^2)_sj a_j,  v_s = v + h sum_j a_sj a_j
///   x <- x + h v + h^2 sum_j (b a)_j a_j,        v <- v + h sum_j b_j a_j
/// the tableau with the stage velocities inserted (Nystroem's form). Where a row has the stage
/// before it alone, x_s = x + a_s,s-1 h v_s-1 instead, whose velocity is at hand.
namespace tomlin {

/// Most stages of any scheme.
inline constexpr int kMostFixedStages = 4;

/// Scratch of one step: arrays of `dofs` and of `rates` numbers.
template <class Real>
struct FixedStepArrays {
  /// [0] to [stages - 2]; without inertia velocities, the slopes of positions.
  Real* acceleration[kMostFixedStages] = {};
  Real* rates[kMostFixedStages] = {};
  Real* stage_position = nullptr;
  Real* stage_velocity = nullptr;
  Real* stage_own = nullptr;
  bool first_known = false;  ///< acceleration[0] and rates[0] hold the start of this step already
};

template <class Real>
struct FixedStepTable {
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<Real>& system, const FixedStepArrays<Real>& arrays, double since,
               double h) = nullptr;
  /// Steps without inertia. The slopes at the start are known beforehand; those at the end are
  /// left in their place.
  bool (*drift)(const SystemView<Real>& system, const FixedStepArrays<Real>& arrays, double since,
                double h) = nullptr;
  void (*first)(const SystemView<Real>& system, const FixedStepArrays<Real>& arrays,
                double since) = nullptr;
  /// Step k starts at start + (first + k) h.
  /// Null where there is none.
  std::size_t (*point_block)(const SystemView<Real>& system, double start, std::size_t first,
                             double h, std::size_t most, const PointStarts<Real>& starts) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// A single particle on a line, whose forces come back in registers.
struct PointParticle {
  const PointForce<double>* forces;
  std::size_t count;
  double inverse_mass;

  TOMLIN_INLINE explicit PointParticle(const SystemView<double>& s)
      : forces(s.point_forces), count(s.point_force_count), inverse_mass(s.inverse_mass[0]) {}

  TOMLIN_INLINE double acceleration(double at, double velocity, double elapsed,
                                    double* rates) const {
    PointResult<double> part =
        forces[0].run(forces[0].parameters, at, velocity, forces[0].start, elapsed);
    double force = part.force;
    if (forces[0].rate != kNoRate) {
      rates[forces[0].rate] = part.force;
      rates[forces[0].rate + 1] = part.power;
    }
    for (std::size_t k = 1; k < count; ++k) {
      part = forces[k].run(forces[k].parameters, at, velocity, forces[k].start, elapsed);
      force += part.force;
      if (forces[k].rate != kNoRate) {
        rates[forces[k].rate] = part.force;
        rates[forces[k].rate + 1] = part.power;
      }
    }
    return force * inverse_mass;
  }
};

template <class Tableau>
struct FixedStepKernels {
  static constexpr int kStages = Tableau::stages;
  static_assert(kStages <= kMostFixedStages);
  template <int stage>
  using Row = RowSum<FixedRow<Tableau, stage>>;
  template <int stage, class Real>
  using Steps = RowSteps<Tableau, stage, Real>;

  /// Evaluates the start of a step.
  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                   double since) {
    at_state(s, w.rates[0], Real(since));
    slopes(s, w.acceleration[0]);
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system,
                                  const FixedStepArrays<Real>& arrays, double start,
                                  double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const FixedStepArrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    if (w.first_known) {
      put_stage<1, true>(s, w, h);
    } else {
      at_state(s, w.rates[0], since);
      put_stage<1, false>(s, w, h);
    }
    later_stages<1, true>(s, w, since, h);

    const Steps<kStages, Real> steps(h);
    // First see whether the step is valid, so that a failed one leaves the state as it was.
    auto valid = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const auto acceleration = slopes_at<kStages - 1>(s, w, i);
      const Group move =
          steps.move(Group::load(s.velocity + i), Group::load(w.stage_velocity + i), acceleration);
      const Group change = Row<kStages>::of(acceleration);
      // A NaN in either fails the comparison; inf - inf and 0 * inf give one.
      valid = valid & (abs(move) <= Group::load(s.largest_move + i)) &
              (abs(change) < Group(Real(__builtin_inf())));
      move.store(w.stage_position + i);
      change.store(w.stage_velocity + i);
    }
    if (!all(valid)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.position + i) + Group::load(w.stage_position + i)).store(s.position + i);
      fma(Group(steps.slope), Group::load(w.stage_velocity + i), Group::load(s.velocity + i))
          .store(s.velocity + i);
    }
    add_integrals(s, w, steps.slope);
    return true;
  }

  /// Without inertia. The slopes at the new positions are the velocities, and the next step's
  /// first.
  template <class Real>
  TOMLIN_FLATTEN static bool drift(const SystemView<Real>& system,
                                   const FixedStepArrays<Real>& arrays, double start,
                                   double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const FixedStepArrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    put_drift_stage<1>(s, w, h);
    later_stages<1, false>(s, w, since, h);

    const Steps<kStages, Real> steps(h);
    auto valid = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group move = Group(steps.slope) * Row<kStages>::of(slopes_at<kStages - 1>(s, w, i));
      valid = valid & (abs(move) <= Group::load(s.largest_move + i));
      move.store(w.stage_position + i);
    }
    if (!all(valid)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.position + i) + Group::load(w.stage_position + i)).store(s.position + i);
    }
    add_integrals(s, w, steps.slope);
    at_state(s, w.rates[0], since + steps.time);
    slopes(s, w.acceleration[0]);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Group::load(w.acceleration[0] + i).store(s.velocity + i);
    }
    return true;
  }

  /// Steps of a single particle on a line with the state held in registers. The same operations in
  /// the same order as `step`, so that the bits are the same too.
  TOMLIN_FLATTEN static std::size_t point_block(const SystemView<double>& system, double start,
                                                std::size_t first, double h, std::size_t most,
                                                const PointStarts<double>& starts) {
    const SystemView<double> s = system;
    const PointParticle particle(s);
    const double largest_move = s.largest_move[0];
    double x = s.position[0];
    double v = s.velocity[0];
    double stage_rates[kMostFixedStages][kGroup];

    std::size_t taken = 0;
    for (; taken < most; ++taken) {
      const double since = start + static_cast<double>(first + taken) * h;
      double* first_rates = starts.rates + taken * s.rates;
      starts.positions[taken] = x;
      starts.velocities[taken] = v;
      const auto step = point_step(particle, x, v, since, h, first_rates, stage_rates);
      if (!step.valid(largest_move)) break;
      x += step.move;
      v = fma(step.slope, step.change, v);
      for (std::size_t k = 0; k < s.used_rates; ++k) {
        s.integrals[k] = fma(step.slope, point_rate(k, first_rates, stage_rates), s.integrals[k]);
      }
    }
    s.position[0] = x;
    s.velocity[0] = v;
    return taken;
  }

  /// Advances replicas in lanes; see LaneBlock. Eight particles at a time are a Replicas.
  template <class Replicas>
  TOMLIN_FLATTEN static bool lane_block(const SystemView<double>& system, double h,
                                        std::size_t count, const LaneRows& rows) {
    const SystemView<double> s = system;
    const LaneRows to = rows;
    const Replicas replicas(s);
    auto valid = first_lanes_of<Pack>(kGroup);
    for (std::size_t taken = 0; taken < count; ++taken) {
      const double since = static_cast<double>(taken) * h;
      for (std::size_t lane = 0; lane < s.dofs; lane += kGroup) {
        double* const x = to.positions + taken * s.dofs + lane;
        double* const v = to.velocities + taken * s.dofs + lane;
        const Pack at = Pack::load(x);
        const Pack velocity = Pack::load(v);
        Pack rates[kMostFixedStages][Replicas::kRates];
        const auto step =
            point_step(replicas.particle(s, lane), at, velocity, since, h, rates[0], rates);
        valid = valid & step.valid(Pack::load(s.largest_move + lane));
        (at + step.move).store(x + s.dofs);
        fma(step.slope, step.change, velocity).store(v + s.dofs);
        for (std::size_t k = 0; k < Replicas::kRates; ++k) {
          rates[0][k].store(to.rates + taken * s.rates + k * s.dofs + lane);
          double* const integral = to.integrals + k * s.dofs + lane;
          fma(step.slope, point_rate(k, rates[0], rates), Pack::load(integral)).store(integral);
        }
      }
    }
    return all(valid);
  }

  template <class Real>
  static constexpr FixedStepTable<Real> kernels() {
    FixedStepTable<Real> table = {&step<Real>, &drift<Real>, &first<Real>, nullptr};
    if constexpr (std::is_same_v<Real, double>) table.point_block = &point_block;
    return table;
  }

 private:
  /// Slopes of stage j, in group i: `last` from the forces that it left, others as they are kept.
  template <int last, class Real>
  TOMLIN_INLINE static auto slopes_at(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                      std::size_t i) {
    using Group = Packed<Real>;
    return [&s, &w, i](auto j) TOMLIN_INLINE_LAMBDA {
      if constexpr (decltype(j)::value == last) {
        return Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      } else {
        return Group::load(w.acceleration[j] + i);
      }
    };
  }

  template <class Real>
  TOMLIN_INLINE static void slopes(const SystemView<Real>& s, Real* slope) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(slope + i);
    }
  }

  template <class Real>
  TOMLIN_INLINE static void at_state(const SystemView<Real>& s, Real* rates, Real elapsed) {
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), rates, elapsed));
  }

  /// The state at a stage; the accelerations of the one before, from its forces unless `known`.
  template <int stage, bool known, class Real>
  TOMLIN_INLINE static void put_stage(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                      Real h) {
    using Group = Packed<Real>;
    constexpr int last = known ? kStages : stage - 1;
    const Steps<stage, Real> steps(h);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = slopes_at<last>(s, w, i)(std::integral_constant<int, stage - 1>());
      if constexpr (!known) a.store(w.acceleration[stage - 1] + i);
      const auto acceleration = [&](auto j) TOMLIN_INLINE_LAMBDA {
        if constexpr (decltype(j)::value == stage - 1) {
          return a;
        } else {
          return Group::load(w.acceleration[j] + i);
        }
      };
      const Group v = Group::load(s.velocity + i);
      // That of the stage before is still in its place.
      const Group velocity = stage == 1 ? v : Group::load(w.stage_velocity + i);
      steps.position(Group::load(s.position + i), v, velocity, acceleration)
          .store(w.stage_position + i);
      fma(Group(steps.slope), Row<stage>::of(acceleration), v).store(w.stage_velocity + i);
    }
    put_own<stage>(s, w, steps.slope);
  }

  /// The state at a stage without inertia.
  template <int stage, class Real>
  TOMLIN_INLINE static void put_drift_stage(const SystemView<Real>& s,
                                            const FixedStepArrays<Real>& w, Real h) {
    using Group = Packed<Real>;
    const Steps<stage, Real> steps(h);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      fma(Group(steps.slope), Row<stage>::of(slopes_at<kStages>(s, w, i)),
          Group::load(s.position + i))
          .store(w.stage_position + i);
    }
    put_own<stage>(s, w, steps.slope);
  }

  /// Internal variables at a stage.
  template <int stage, class Real>
  TOMLIN_INLINE static void put_own(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                    Real step) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(step), Row<stage>::of(rates_at(w, i)), Group::load(s.integrals + i))
          .store(w.stage_own + i);
    }
  }

  template <class Real>
  TOMLIN_INLINE static auto rates_at(const FixedStepArrays<Real>& w, std::size_t i) {
    return [&w, i](auto j) TOMLIN_INLINE_LAMBDA { return Packed<Real>::load(w.rates[j] + i); };
  }

  template <class Real>
  TOMLIN_INLINE static void add_integrals(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                          Real step) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      fma(Group(step), Row<kStages>::of(rates_at(w, i)), Group::load(s.integrals + i))
          .store(s.integrals + i);
    }
  }

  /// Evaluates the stages from `stage` on, each but the last followed by the state at the next.
  template <int stage, bool inertial, class Real>
  TOMLIN_INLINE static void later_stages(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                         Real since, Real h) {
    if constexpr (stage < kStages) {
      evaluate(s, stage_of(s, static_cast<const Real*>(w.stage_position),
                           static_cast<const Real*>(w.stage_velocity),
                           static_cast<const Real*>(w.stage_own), w.rates[stage],
                           since + Steps<stage, Real>(h).time));
      if constexpr (stage + 1 < kStages) {
        if constexpr (inertial) {
          put_stage<stage + 1, false>(s, w, h);
        } else {
          slopes(s, w.acceleration[stage]);
          put_drift_stage<stage + 1>(s, w, h);
        }
      }
      later_stages<stage + 1, inertial>(s, w, since, h);
    }
  }

  /// By how much a step changes position and, over `slope`, velocity.
  template <class Number>
  struct PointStep {
    Number move, change, slope;

    TOMLIN_INLINE auto valid(const Number& largest_move) const {
      return (abs(move) <= largest_move) & (abs(change) < Number(__builtin_inf()));
    }
  };

  /// A step of a particle in registers. `rates` are those of the later stages.
  template <class Particle, class Number, class Rates>
  TOMLIN_INLINE static PointStep<Number> point_step(const Particle& particle, const Number& x,
                                                    const Number& v, double since, double h,
                                                    Number* first_rates, Rates& rates) {
    const Steps<kStages, double> steps(h);
    Number a[kStages];
    a[0] = particle.acceleration(x, v, since, first_rates);
    const Number last_v = point_stages<1>(particle, x, v, v, since, h, a, rates);
    const auto acceleration = [&](auto j) TOMLIN_INLINE_LAMBDA { return a[j]; };
    return {steps.move(v, last_v, acceleration), Row<kStages>::of(acceleration),
            Number(steps.slope)};
  }

  /// Weighted sum of the rates of an integral over the step.
  template <class Number, class Rates>
  TOMLIN_INLINE static Number point_rate(std::size_t k, const Number* first_rates,
                                         const Rates& rates) {
    return Row<kStages>::of(
        [&](auto j) TOMLIN_INLINE_LAMBDA { return j == 0 ? first_rates[k] : rates[j][k]; });
  }

  /// Accelerations of the stages from `stage` on; returns the velocity at the last.
  template <int stage, class Particle, class Number, class Rates>
  TOMLIN_INLINE static Number point_stages(const Particle& particle, const Number& x,
                                           const Number& v, const Number& velocity, double since,
                                           double h, Number (&a)[kStages], Rates& rates) {
    if constexpr (stage == kStages) {
      return velocity;
    } else {
      const Steps<stage, double> steps(h);
      const auto acceleration = [&](auto j) TOMLIN_INLINE_LAMBDA { return a[j]; };
      const Number stage_x = steps.position(x, v, velocity, acceleration);
      const Number stage_v = fma(Number(steps.slope), Row<stage>::of(acceleration), v);
      a[stage] = particle.acceleration(stage_x, stage_v, since + steps.time, rates[stage]);
      return point_stages<stage + 1>(particle, x, v, stage_v, since, h, a, rates);
    }
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
