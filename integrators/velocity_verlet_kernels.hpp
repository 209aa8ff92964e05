#pragma once

#include <cstddef>

#include "framework/core/compensated.hpp"
#include "framework/core/evaluate.hpp"
#include "framework/core/number_types.hpp"
#include "framework/core/system.hpp"

namespace tomlin {

template <class Real>
struct VerletArrays {
  Real* force = nullptr;  ///< at the start of a step, afterwards at its end; friction left out
  Real* rates = nullptr;  ///< the same
  Real* end_rates = nullptr;
  Real* position = nullptr;  ///< at the end of the step that is tried
  Real* velocity = nullptr;
  Real* velocity_rest = nullptr;  ///< null unless compensated
  Real* own = nullptr;
};

template <class Real>
struct VerletTable {
  void (*first)(const SystemView<Real>& system, const VerletArrays<Real>& arrays,
                double since) = nullptr;
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<Real>& system, const VerletArrays<Real>& arrays, double since,
               double h) = nullptr;
  /// Accelerations at the present state, friction included, into `acceleration`.
  void (*accelerations)(const SystemView<Real>& system, const VerletArrays<Real>& arrays,
                        Real* acceleration) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct VelocityVerletKernels {
  /// v <- v + h a.
  template <class Real>
  TOMLIN_INLINE static void kick(const SystemView<Real>& s, const Real* force, Real h, Real* v,
                                 Real* v_rest) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(force + i) * Group::load(s.inverse_mass + i);
      add_scaled(v, v_rest, i, Group(h), a);
    }
  }

  template <class Real>
  TOMLIN_INLINE static void damp(const SystemView<Real>& s, const Real* position, Real h, Real* v,
                                 Real* v_rest) {
    for (std::size_t k = 0; k < s.friction_count; ++k) {
      s.friction[k].flow(s.friction[k].arguments, position, v, v_rest, h);
    }
  }

  /// The heat at a state, among the rates.
  template <class Real>
  TOMLIN_INLINE static void add_heat(const SystemView<Real>& s, const Real* position,
                                     const Real* velocity, Real* rates) {
    if (s.friction_rate == kNoRate) return;
    Real heat(0.0);
    for (std::size_t k = 0; k < s.friction_count; ++k) {
      // The force array is free between evaluations.
      heat = heat + s.friction[k].drag(s.friction[k].arguments, position, velocity, s.force);
    }
    rates[s.friction_rate] = heat;
  }

  template <class Real>
  TOMLIN_INLINE static void copy(const Real* from, std::size_t n, Real* to) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < n; i += kGroup) Group::load(from + i).store(to + i);
  }

  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const VerletArrays<Real>& w,
                                   double since) {
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), w.rates, Real(since)));
    copy<Real>(s.force, s.dofs, w.force);
    add_heat<Real>(s, s.position, s.velocity, w.rates);
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system, const VerletArrays<Real>& arrays,
                                  double start, double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const VerletArrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    const Real half = Real(0.5) * h;

    copy<Real>(s.velocity, s.dofs, w.velocity);
    if (kCompensated<Real>) copy<Real>(s.velocity_rest, s.dofs, w.velocity_rest);
    damp<Real>(s, s.position, half, w.velocity, w.velocity_rest);
    kick<Real>(s, w.force, half, w.velocity, w.velocity_rest);
    auto sound = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group move = Group(h) * Group::load(w.velocity + i);
      sound = sound & (abs(move) <= Group::load(s.largest_move + i));
      (Group::load(s.position + i) + move).store(w.position + i);
    }
    if (!all(sound)) return false;
    // Own variables here follow from the time alone: their rates are known at both ends.
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(h), Group::load(w.rates + i), Group::load(s.integrals + i)).store(w.own + i);
    }
    evaluate(s,
             stage_of(s, static_cast<const Real*>(w.position), static_cast<const Real*>(w.velocity),
                      static_cast<const Real*>(w.own), w.end_rates, since + h));
    // A force that is no number must not enter the state.
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      sound = sound & (abs(a) < Group(Real(__builtin_inf())));
    }
    if (!all(sound)) return false;

    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      add_move(s.position, s.position_rest, i, Group(h) * Group::load(w.velocity + i));
    }
    copy<Real>(s.force, s.dofs, w.force);
    kick<Real>(s, w.force, half, w.velocity, w.velocity_rest);
    damp<Real>(s, s.position, half, w.velocity, w.velocity_rest);
    copy<Real>(w.velocity, s.dofs, s.velocity);
    if (kCompensated<Real>) copy<Real>(w.velocity_rest, s.dofs, s.velocity_rest);
    add_heat<Real>(s, s.position, s.velocity, w.end_rates);
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Group rates = Group::load(w.rates + i) + Group::load(w.end_rates + i);
      add_scaled(s.integrals, s.integrals_rest, i, Group(half), rates);
    }
    return true;
  }

  template <class Real>
  TOMLIN_FLATTEN static void accelerations(const SystemView<Real>& s, const VerletArrays<Real>& w,
                                           Real* acceleration) {
    using Group = Packed<Real>;
    copy<Real>(w.force, s.dofs, s.force);
    for (std::size_t k = 0; k < s.friction_count; ++k) {
      s.friction[k].drag(s.friction[k].arguments, s.position, s.velocity, s.force);
    }
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(acceleration + i);
    }
  }

  template <class Real>
  static constexpr VerletTable<Real> kernels() {
    return {&first<Real>, &step<Real>, &accelerations<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
