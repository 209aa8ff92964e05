#pragma once

#include "integrators/fixed_step_kernels.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

struct Rk4Kernels : FixedStepPasses {
  template <class Real>
  TOMLIN_INLINE static void add_integrals(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
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
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system,
                                  const FixedStepArrays<Real>& arrays, double start,
                                  double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const FixedStepArrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    const Real half = Real(0.5) * h;
    leave_start(s, w, since, half);
    later(s, w, 1, since + half);
    pass(s, w, 1, half, half);
    later(s, w, 2, since + half);
    pass(s, w, 2, h, h);
    later(s, w, 3, since + h);

    const Real sixth = h / Real(6.0);
    const Group sixth_square(h * h / Real(6.0));
    const Group whole(h);
    const Group two(Real(2.0));
    // First see whether the step is valid, so that a failed one leaves the state as it was.
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
  TOMLIN_FLATTEN static bool drift(const SystemView<Real>& system,
                                   const FixedStepArrays<Real>& arrays, double start,
                                   double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const FixedStepArrays<Real> w = arrays;
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
    drift_by_moves(s, w);
    add_integrals(s, w, sixth);
    slopes_at_end(s, w, since + h);
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
    const double half = 0.5 * h;
    const double sixth = h / 6.0;
    const double sixth_square = h * h / 6.0;
    double x = s.position[0];
    double v = s.velocity[0];
    double stage_rates[3][kGroup];

    std::size_t taken = 0;
    for (; taken < most; ++taken) {
      const double since = start + static_cast<double>(first + taken) * h;
      double* first_rates = starts.rates + taken * s.rates;
      starts.positions[taken] = x;
      starts.velocities[taken] = v;
      const double a1 = particle.acceleration(x, v, since, first_rates);
      const double x2 = fma(half, v, x);
      const double v2 = fma(half, a1, v);
      const double a2 = particle.acceleration(x2, v2, since + half, stage_rates[0]);
      const double x3 = fma(half, v2, x);
      const double v3 = fma(half, a2, v);
      const double a3 = particle.acceleration(x3, v3, since + half, stage_rates[1]);
      const double x4 = fma(h, v3, x);
      const double v4 = fma(h, a3, v);
      const double a4 = particle.acceleration(x4, v4, since + h, stage_rates[2]);
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
  static constexpr FixedStepTable<Real> kernels() {
    FixedStepTable<Real> table = {&step<Real>, &drift<Real>, &first<Real>, nullptr};
    if constexpr (std::is_same_v<Real, double>) table.point_block = &point_block;
    return table;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
