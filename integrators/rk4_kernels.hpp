#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/compensated.hpp"
#include "framework/core/evaluate.hpp"
#include "framework/core/number_types.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

/// Scratch of one rk4 step: arrays of `dofs` and of `rates` numbers.
template <class Real>
struct Rk4Arrays {
  Real* acceleration[4] = {};  ///< without inertia velocities, the slopes of positions
  Real* rates[4] = {};
  Real* stage_position = nullptr;
  Real* stage_velocity = nullptr;
  Real* stage_own = nullptr;
  bool first_known = false;  ///< acceleration[0] and rates[0] hold the start of this step already
};

template <class Real>
struct Rk4Table {
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<Real>& system, const Rk4Arrays<Real>& arrays, double since,
               double h) = nullptr;
  /// The same without inertia. The slopes at the start are known beforehand; those at the end are
  /// left in their place.
  bool (*drift)(const SystemView<Real>& system, const Rk4Arrays<Real>& arrays, double since,
                double h) = nullptr;
  void (*first)(const SystemView<Real>& system, const Rk4Arrays<Real>& arrays,
                double since) = nullptr;
  /// Step k starts at start + (first + k) h.
  /// Null where there is none.
  std::size_t (*point_block)(const SystemView<Real>& system, double start, std::size_t first,
                             double h, std::size_t most, Real* rates, Real* velocities) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct Rk4Kernels {
  /// Forces to accelerations, and the next stage from them: x + a_x * v_stage, v + a_v * a.
  template <class Real>
  TOMLIN_INLINE static void pass(const SystemView<Real>& s, const Rk4Arrays<Real>& w, int stage,
                                 Real step_v, Real step_x) {
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
  TOMLIN_INLINE static void drift_pass(const SystemView<Real>& s, const Rk4Arrays<Real>& w,
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
  TOMLIN_INLINE static void own_pass(const SystemView<Real>& s, const Rk4Arrays<Real>& w, int stage,
                                     Real step) {
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
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const Rk4Arrays<Real>& w,
                                   double since) {
    at_state(s, w.rates[0], Real(since));
    slopes(s, w.acceleration[0]);
  }

  template <class Real>
  TOMLIN_INLINE static void later(const SystemView<Real>& s, const Rk4Arrays<Real>& w, int stage,
                                  Real elapsed) {
    evaluate(s, stage_of(s, static_cast<const Real*>(w.stage_position),
                         static_cast<const Real*>(w.stage_velocity),
                         static_cast<const Real*>(w.stage_own), w.rates[stage], elapsed));
  }

  template <class Real>
  TOMLIN_INLINE static void add_integrals(const SystemView<Real>& s, const Rk4Arrays<Real>& w,
                                          Real sixth) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Group g23 = Group::load(w.rates[1] + i) + Group::load(w.rates[2] + i);
      const Group g =
          fma(Group(Real(2.0)), g23, Group::load(w.rates[0] + i) + Group::load(w.rates[3] + i));
      add_scaled(s.integrals, s.integrals_rest, i, Group(sixth), g);
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system, const Rk4Arrays<Real>& arrays,
                                  double start, double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const Rk4Arrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    const Real half = Real(0.5) * h;
    if (w.first_known) {
      // The pass turns forces into accelerations; here those are known, so only the stage is due.
      for (std::size_t i = 0; i < s.dofs; i += kGroup) {
        const Group v = Group::load(s.velocity + i);
        fma(Group(half), v, Group::load(s.position + i)).store(w.stage_position + i);
        fma(Group(half), Group::load(w.acceleration[0] + i), v).store(w.stage_velocity + i);
      }
      own_pass(s, w, 0, half);
    } else {
      at_state(s, w.rates[0], since);
      pass(s, w, 0, half, half);
    }
    later(s, w, 1, since + half);
    pass(s, w, 1, half, half);
    later(s, w, 2, since + half);
    pass(s, w, 2, h, h);
    later(s, w, 3, since + h);

    const Real sixth = h / Real(6.0);
    const Group sixth_square(h * h / Real(6.0));
    const Group whole(h);
    const Group two(Real(2.0));
    // First see whether the step is sound, so that a failed one leaves the state as it was.
    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a1 = Group::load(w.acceleration[0] + i);
      const Group a23 = Group::load(w.acceleration[1] + i) + Group::load(w.acceleration[2] + i);
      const Group a4 = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      const Group v = Group::load(s.velocity + i);
      const Group move = fma(sixth_square, a1 + a23, whole * v);
      const Group change = fma(two, a23, a1 + a4);
      // A NaN in either fails the comparison; inf - inf and 0 * inf give one.
      sound = sound & (abs(move) <= Group::load(s.largest_move + i)) &
              (abs(change) < Group(Real(__builtin_inf())));
      move.store(w.stage_position + i);
      change.store(w.stage_velocity + i);
    }
    if (!all(sound)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      add_move(s.position, s.position_rest, i, Group::load(w.stage_position + i));
      add_scaled(s.velocity, s.velocity_rest, i, Group(sixth), Group::load(w.stage_velocity + i));
    }
    add_integrals(s, w, sixth);
    return true;
  }

  template <class Real>
  TOMLIN_FLATTEN static bool drift(const SystemView<Real>& system, const Rk4Arrays<Real>& arrays,
                                   double start, double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const Rk4Arrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    const Real half = Real(0.5) * h;
    drift_pass(s, w, 0, half);
    later(s, w, 1, since + half);
    slopes(s, w.acceleration[1]);
    drift_pass(s, w, 1, half);
    later(s, w, 2, since + half);
    slopes(s, w.acceleration[2]);
    drift_pass(s, w, 2, h);
    later(s, w, 3, since + h);

    const Real sixth = h / Real(6.0);
    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group v23 = Group::load(w.acceleration[1] + i) + Group::load(w.acceleration[2] + i);
      const Group v4 = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      const Group move =
          Group(sixth) * fma(Group(Real(2.0)), v23, Group::load(w.acceleration[0] + i) + v4);
      sound = sound & (abs(move) <= Group::load(s.largest_move + i));
      move.store(w.stage_position + i);
    }
    if (!all(sound)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      add_move(s.position, s.position_rest, i, Group::load(w.stage_position + i));
    }
    add_integrals(s, w, sixth);
    at_state(s, w.rates[0], since + h);
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
                                                double* rates, double* velocities) {
    const SystemView<double> s = system;
    const PointForce<double>* const forces = s.point_forces;
    const std::size_t count = s.point_force_count;
    const double inverse_mass = s.inverse_mass[0];
    const double largest_move = s.largest_move[0];
    const double half = 0.5 * h;
    const double sixth = h / 6.0;
    const double sixth_square = h * h / 6.0;
    double x = s.position[0];
    double v = s.velocity[0];
    double stage_rates[3][kGroup];

    const auto acceleration = [&](double at, double velocity, double elapsed,
                                  double* into) TOMLIN_INLINE_LAMBDA {
      PointResult<double> part =
          forces[0].run(forces[0].parameters, at, velocity, forces[0].start, elapsed);
      double force = part.force;
      if (forces[0].rate != kNoRate) {
        into[forces[0].rate] = part.force;
        into[forces[0].rate + 1] = part.power;
      }
      for (std::size_t k = 1; k < count; ++k) {
        part = forces[k].run(forces[k].parameters, at, velocity, forces[k].start, elapsed);
        force += part.force;
        if (forces[k].rate != kNoRate) {
          into[forces[k].rate] = part.force;
          into[forces[k].rate + 1] = part.power;
        }
      }
      return force * inverse_mass;
    };

    std::size_t taken = 0;
    for (; taken < most; ++taken) {
      const double since = start + static_cast<double>(first + taken) * h;
      double* first_rates = rates + taken * s.rates;
      velocities[taken] = v;
      const double a1 = acceleration(x, v, since, first_rates);
      const double x2 = fma(half, v, x);
      const double v2 = fma(half, a1, v);
      const double a2 = acceleration(x2, v2, since + half, stage_rates[0]);
      const double x3 = fma(half, v2, x);
      const double v3 = fma(half, a2, v);
      const double a3 = acceleration(x3, v3, since + half, stage_rates[1]);
      const double x4 = fma(h, v3, x);
      const double v4 = fma(h, a3, v);
      const double a4 = acceleration(x4, v4, since + h, stage_rates[2]);
      const double a23 = a2 + a3;
      const double move = fma(sixth_square, a1 + a23, h * v);
      const double change = fma(2.0, a23, a1 + a4);
      if (!(abs(move) <= largest_move && abs(change) < __builtin_inf())) break;
      x += move;
      v = fma(sixth, change, v);
      for (std::size_t k = 0; k < s.used_rates; ++k) {
        const double g23 = stage_rates[0][k] + stage_rates[1][k];
        const double g = fma(2.0, g23, first_rates[k] + stage_rates[2][k]);
        s.integrals[k] = fma(sixth, g, s.integrals[k]);
      }
    }
    s.position[0] = x;
    s.velocity[0] = v;
    return taken;
  }

  template <class Real>
  static constexpr Rk4Table<Real> kernels() {
    Rk4Table<Real> table = {&step<Real>, &drift<Real>, &first<Real>, nullptr};
    if constexpr (std::is_same_v<Real, double>) table.point_block = &point_block;
    return table;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
