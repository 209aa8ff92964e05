#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/system.hpp"

namespace tomlin {

/// Arrays that a step without inertia needs beside the state.
template <class Real>
struct BrownianArrays {
  Real* slope = nullptr;  ///< velocities by the forces alone, at the start and afterwards the end
  Real* rates = nullptr;  ///< at the start
  Real* end_rates = nullptr;
  Real* move = nullptr;
  Real* position = nullptr;
  Real* own = nullptr;
  const Real* noise = nullptr;  ///< normal numbers of the step
};

template <class Real>
struct BrownianTable {
  void (*first)(const SystemView<Real>& system, const BrownianArrays<Real>& arrays,
                double since) = nullptr;
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<Real>& system, const BrownianArrays<Real>& arrays, double since,
               double h) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// x <- x + h u(x, t) + sqrt(2 T h/c) z, with u = F/c and the numbers z that a scheme gives. The
/// heat that the bath takes is the Stratonovich integral of the force along the way, F of the
/// potential and of drivers, by the trapezoidal rule (K. Sekimoto, Stochastic Energetics (2010),
/// doi:10.1007/978-3-642-05411-2).
struct BrownianKernels {
  template <class Real>
  TOMLIN_INLINE static bool keep_slopes(const SystemView<Real>& s, Real* slope) {
    using Group = Packed<Real>;
    auto finite = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group u = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      finite = finite & (abs(u) < Group(Real(__builtin_inf())));
      u.store(slope + i);
    }
    return all(finite);
  }

  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const BrownianArrays<Real>& w,
                                   double since) {
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), w.rates, Real(since)));
    keep_slopes(s, w.slope);
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system,
                                  const BrownianArrays<Real>& arrays, double start, double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const BrownianArrays<Real> w = arrays;
    const Real h(length);
    const Group root(sqrt(h));
    auto valid = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      Group move = Group(h) * Group::load(w.slope + i);
      if (s.noise_count > 0) {
        move = fma(root * Group::load(s.noise_scale + i), Group::load(w.noise + i), move);
      }
      valid = valid & (abs(move) <= Group::load(s.largest_move + i));
      move.store(w.move + i);
      (Group::load(s.position + i) + move).store(w.position + i);
    }
    if (!all(valid)) return false;
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(h), Group::load(w.rates + i), Group::load(s.integrals + i)).store(w.own + i);
    }
    evaluate(s,
             stage_of(s, static_cast<const Real*>(w.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(w.own), w.end_rates, Real(start) + h));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group u = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      valid = valid & (abs(u) < Group(Real(__builtin_inf())));
    }
    if (!all(valid)) return false;

    const Real half = Real(0.5) * h;
    Group along(Real(0.0));
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group before = Group::load(w.slope + i);
      const Group after = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      const Group move = Group::load(w.move + i);
      if (s.noise_count > 0) {
        along = fma(Group::load(s.friction + i) * (before + after), move, along);
      }
      (Group::load(s.position + i) + move).store(s.position + i);
      after.store(w.slope + i);
      after.store(s.velocity + i);
    }
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Group rates = Group::load(w.rates + i) + Group::load(w.end_rates + i);
      fma(Group(half), rates, Group::load(s.integrals + i)).store(s.integrals + i);
    }
    if (s.noise_count > 0 && s.friction_rate != kNoRate) {
      const Real by_rates = half * (w.rates[s.friction_rate] + w.end_rates[s.friction_rate]);
      Real& heat = s.integrals[s.friction_rate];
      heat = heat + (Real(0.5) * sum(along) - by_rates);
    }
    return true;
  }

  template <class Real>
  static constexpr BrownianTable<Real> kernels() {
    return {&first<Real>, &step<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
