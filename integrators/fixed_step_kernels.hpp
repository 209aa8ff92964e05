#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/compensated.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/system.hpp"

/// What the kernels of explicit Runge-Kutta schemes with a fixed step share: their scratch, their
/// table, the passes between evaluations, and the forces of a particle alone.
namespace tomlin {

/// Scratch of one step: arrays of `dofs` and of `rates` numbers.
template <class Real>
struct FixedStepArrays {
  Real* acceleration[4] = {};  ///< without inertia velocities, the slopes of positions
  Real* rates[4] = {};
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
  /// The same without inertia. The slopes at the start are known beforehand; those at the end are
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

struct FixedStepPasses {
  /// Forces to accelerations, and the next stage from them: x + a_x * v_stage, v + a_v * a.
  template <class Real>
  TOMLIN_INLINE static void pass(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                 int stage, Real step_v, Real step_x) {
    using Group = Packed<Real>;
    const Real* force = s.force;
    const Real* inverse_mass = s.inverse_mass;
    const Real* x = s.position;
    const Real* v = s.velocity;
    Real* acceleration = w.acceleration[stage];
    Real* stage_x = w.stage_position;
    Real* stage_v = w.stage_velocity;
    const Group hv(step_v);
    const Group hx(step_x);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(force + i) * Group::load(inverse_mass + i);
      a.store(acceleration + i);
      // The position of the next stage uses the velocity of this one, still in stage_v.
      const Group v_here = stage == 0 ? Group::load(v + i) : Group::load(stage_v + i);
      fma(hx, v_here, Group::load(x + i)).store(stage_x + i);
      fma(hv, a, Group::load(v + i)).store(stage_v + i);
    }
    own_pass(s, w, stage, step_v);
  }

  /// The same without inertia: forces to velocities, x + a_x * v.
  template <class Real>
  TOMLIN_INLINE static void drift_pass(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                       int stage, Real step) {
    using Group = Packed<Real>;
    const Group h(step);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group v = Group::load(w.acceleration[stage] + i);
      fma(h, v, Group::load(s.position + i)).store(w.stage_position + i);
    }
    own_pass(s, w, stage, step);
  }

  template <class Real>
  TOMLIN_INLINE static void own_pass(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                     int stage, Real step) {
    using Group = Packed<Real>;
    const Real* rates = w.rates[stage];
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(step), Group::load(rates + i), Group::load(s.integrals + i)).store(w.stage_own + i);
    }
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

  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                   double since) {
    at_state(s, w.rates[0], Real(since));
    slopes(s, w.acceleration[0]);
  }

  template <class Real>
  TOMLIN_INLINE static void later(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                  int stage, Real elapsed) {
    evaluate(s, stage_of(s, static_cast<const Real*>(w.stage_position),
                         static_cast<const Real*>(w.stage_velocity),
                         static_cast<const Real*>(w.stage_own), w.rates[stage], elapsed));
  }

  /// Evaluates the start of a step where that is needed, and makes the stage at x + h_stage v.
  template <class Real>
  TOMLIN_INLINE static void leave_start(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                        Real since, Real h_stage) {
    using Group = Packed<Real>;
    if (!w.first_known) {
      at_state(s, w.rates[0], since);
      pass(s, w, 0, h_stage, h_stage);
      return;
    }
    // The pass turns forces into accelerations; here those are known, so only the stage is needed.
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group v = Group::load(s.velocity + i);
      fma(Group(h_stage), v, Group::load(s.position + i)).store(w.stage_position + i);
      fma(Group(h_stage), Group::load(w.acceleration[0] + i), v).store(w.stage_velocity + i);
    }
    own_pass(s, w, 0, h_stage);
  }

  /// Ends a step without inertia: adds the moves that stand in stage_position. The slopes at the
  /// new positions are the velocities, and the next step's first.
  template <class Real>
  TOMLIN_INLINE static void drift_by_moves(const SystemView<Real>& s,
                                           const FixedStepArrays<Real>& w) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      add_move(s.position, s.position_rest, i, Group::load(w.stage_position + i));
    }
  }

  template <class Real>
  TOMLIN_INLINE static void slopes_at_end(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                          Real elapsed) {
    using Group = Packed<Real>;
    at_state(s, w.rates[0], elapsed);
    slopes(s, w.acceleration[0]);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Group::load(w.acceleration[0] + i).store(s.velocity + i);
    }
  }
};

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

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
