#pragma once

#include <cstddef>

#include "framework/core/evaluate.hpp"
#include "framework/core/pack.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

/// Scratch of one rk4 step: arrays of `dofs` and of `rates` numbers.
struct Rk4Arrays {
  double* acceleration[4] = {};
  double* rates[4] = {};
  double* stage_position = nullptr;
  double* stage_velocity = nullptr;
  double* stage_own = nullptr;
  bool first_known = false;  ///< acceleration[0] and rates[0] hold the start of this step already
};

struct Rk4Table {
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<double>& system, const Rk4Arrays& arrays, double since,
               double h) = nullptr;
  void (*first)(const SystemView<double>& system, const Rk4Arrays& arrays, double since) = nullptr;
  std::size_t (*point_block)(const SystemView<double>& system, std::size_t first, double h,
                             std::size_t most, double* rates, double* velocities) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct Rk4Kernels {
  /// Forces to accelerations, and the next stage from them: x + a_x * v_stage, v + a_v * a.
  TOMLIN_INLINE static void pass(const SystemView<double>& s, const Rk4Arrays& w, int stage,
                                 double step_v, double step_x) {
    const double* force = s.force;
    const double* inverse_mass = s.inverse_mass;
    const double* x = s.position;
    const double* v = s.velocity;
    double* acceleration = w.acceleration[stage];
    double* stage_x = w.stage_position;
    double* stage_v = w.stage_velocity;
    const Pack hv(step_v);
    const Pack hx(step_x);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Pack a = Pack::load(force + i) * Pack::load(inverse_mass + i);
      a.store(acceleration + i);
      // The position of the next stage uses the velocity of this one, still in stage_v.
      const Pack v_here = stage == 0 ? Pack::load(v + i) : Pack::load(stage_v + i);
      fma(hx, v_here, Pack::load(x + i)).store(stage_x + i);
      fma(hv, a, Pack::load(v + i)).store(stage_v + i);
    }
    const double* rates = w.rates[stage];
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(hv, Pack::load(rates + i), Pack::load(s.integrals + i)).store(w.stage_own + i);
    }
  }

  TOMLIN_FLATTEN static void first(const SystemView<double>& s, const Rk4Arrays& w, double since) {
    evaluate(s, stage_of(s, static_cast<const double*>(s.position),
                         static_cast<const double*>(s.velocity),
                         static_cast<const double*>(s.integrals), w.rates[0], since));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Pack::load(s.force + i) * Pack::load(s.inverse_mass + i)).store(w.acceleration[0] + i);
    }
  }

  TOMLIN_INLINE static void later(const SystemView<double>& s, const Rk4Arrays& w, int stage,
                                  double elapsed) {
    evaluate(s, stage_of(s, static_cast<const double*>(w.stage_position),
                         static_cast<const double*>(w.stage_velocity),
                         static_cast<const double*>(w.stage_own), w.rates[stage], elapsed));
  }

  TOMLIN_FLATTEN static bool step(const SystemView<double>& system, const Rk4Arrays& arrays,
                                  double since, double h) {
    const SystemView<double> s = system;
    const Rk4Arrays w = arrays;
    const double half = 0.5 * h;
    if (w.first_known) {
      // The pass turns forces into accelerations; here those are known, so only the stage is due.
      for (std::size_t i = 0; i < s.dofs; i += kGroup) {
        const Pack v = Pack::load(s.velocity + i);
        fma(Pack(half), v, Pack::load(s.position + i)).store(w.stage_position + i);
        fma(Pack(half), Pack::load(w.acceleration[0] + i), v).store(w.stage_velocity + i);
      }
      for (std::size_t i = 0; i < s.own; i += kGroup) {
        fma(Pack(half), Pack::load(w.rates[0] + i), Pack::load(s.integrals + i))
            .store(w.stage_own + i);
      }
    } else {
      evaluate(s, stage_of(s, static_cast<const double*>(s.position),
                           static_cast<const double*>(s.velocity),
                           static_cast<const double*>(s.integrals), w.rates[0], since));
      pass(s, w, 0, half, half);
    }
    later(s, w, 1, since + half);
    pass(s, w, 1, half, half);
    later(s, w, 2, since + half);
    pass(s, w, 2, h, h);
    later(s, w, 3, since + h);

    const Pack sixth(h / 6.0);
    const Pack sixth_square(h * h / 6.0);
    const Pack whole(h);
    const Pack two(2.0);
    // First see whether the step is sound, so that a failed one leaves the state as it was.
    PackMask sound = first_lanes(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Pack a1 = Pack::load(w.acceleration[0] + i);
      const Pack a23 = Pack::load(w.acceleration[1] + i) + Pack::load(w.acceleration[2] + i);
      const Pack a4 = Pack::load(s.force + i) * Pack::load(s.inverse_mass + i);
      const Pack v = Pack::load(s.velocity + i);
      const Pack move = fma(sixth_square, a1 + a23, whole * v);
      const Pack change = fma(two, a23, a1 + a4);
      // A NaN in either fails the comparison; inf - inf and 0 * inf give one.
      sound = sound & (abs(move) <= Pack::load(s.largest_move + i)) &
              (abs(change) < Pack(__builtin_inf()));
      move.store(w.stage_position + i);
      change.store(w.stage_velocity + i);
    }
    if (!all(sound)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Pack::load(s.position + i) + Pack::load(w.stage_position + i)).store(s.position + i);
      fma(sixth, Pack::load(w.stage_velocity + i), Pack::load(s.velocity + i))
          .store(s.velocity + i);
    }
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Pack g23 = Pack::load(w.rates[1] + i) + Pack::load(w.rates[2] + i);
      const Pack g = fma(two, g23, Pack::load(w.rates[0] + i) + Pack::load(w.rates[3] + i));
      fma(sixth, g, Pack::load(s.integrals + i)).store(s.integrals + i);
    }
    return true;
  }

  /// Steps of a single particle on a line with the state held in registers. The same operations in
  /// the same order as `step`, so that the bits are the same too.
  TOMLIN_FLATTEN static std::size_t point_block(const SystemView<double>& system, std::size_t first,
                                                double h, std::size_t most, double* rates,
                                                double* velocities) {
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
      const double since = static_cast<double>(first + taken) * h;
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

  static constexpr Rk4Table kernels() { return {&step, &first, &point_block}; }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
