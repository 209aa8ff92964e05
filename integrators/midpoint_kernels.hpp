#pragma once

#include "integrators/fixed_step_kernels.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

struct MidpointKernels : FixedStepPasses {
  template <class Real>
  TOMLIN_INLINE static void add_integrals(const SystemView<Real>& s, const FixedStepArrays<Real>& w,
                                          Real h) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      add_scaled(s.integrals, s.integrals_rest, i, Group(h), Group::load(w.rates[1] + i));
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

    // First see whether the step is valid, so that a failed one leaves the state as it was.
    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      const Group move = Group(h) * Group::load(w.stage_velocity + i);
      // A NaN in either fails the comparison.
      sound = sound & (abs(move) <= Group::load(s.largest_move + i)) &
              (abs(a) < Group(Real(__builtin_inf())));
      move.store(w.stage_position + i);
      a.store(w.acceleration[1] + i);
    }
    if (!all(sound)) return false;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      add_move(s.position, s.position_rest, i, Group::load(w.stage_position + i));
      add_scaled(s.velocity, s.velocity_rest, i, Group(h), Group::load(w.acceleration[1] + i));
    }
    add_integrals(s, w, h);
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

    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group v = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      const Group move = Group(h) * v;
      sound = sound & (abs(move) <= Group::load(s.largest_move + i));
      move.store(w.stage_position + i);
    }
    if (!all(sound)) return false;
    drift_by_moves(s, w);
    add_integrals(s, w, h);
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
    double x = s.position[0];
    double v = s.velocity[0];
    double middle_rates[kGroup];

    std::size_t taken = 0;
    for (; taken < most; ++taken) {
      const double since = start + static_cast<double>(first + taken) * h;
      starts.positions[taken] = x;
      starts.velocities[taken] = v;
      const double a1 = particle.acceleration(x, v, since, starts.rates + taken * s.rates);
      const double v2 = fma(half, a1, v);
      const double a2 = particle.acceleration(fma(half, v, x), v2, since + half, middle_rates);
      const double move = h * v2;
      if (!(abs(move) <= largest_move && abs(a2) < __builtin_inf())) break;
      x += move;
      v = fma(h, a2, v);
      for (std::size_t k = 0; k < s.used_rates; ++k) {
        s.integrals[k] = fma(h, middle_rates[k], s.integrals[k]);
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
