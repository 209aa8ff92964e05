#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/system.hpp"

namespace tomlin {

/// Scratch of one step, and what is known of its start.
template <class Real>
struct CompositionArrays {
  Real* force = nullptr;  ///< at the start of a step, afterwards at its end; operators left out
  Real* rates = nullptr;  ///< the same
  Real* end_rates = nullptr;
  Real* stage_rates = nullptr;  ///< of a kick in between
  Real* inner_rates = nullptr;  ///< of those so far, weighted
  Real* move = nullptr;         ///< since the start of the step that is tried
  Real* position = nullptr;     ///< after it
  Real* velocity = nullptr;
  Real* own = nullptr;               ///< own variables at a stage
  Real* own_after = nullptr;         ///< those that operators change, after the last of their flows
  Real* half_step_energy = nullptr;  ///< kinetic, of each KineticIntegral; in lanes, of each lane
  const Real* mass = nullptr;        ///< zero where nothing moves
  std::uint64_t step = 0;            ///< number of the step
  // These are for replicas in lanes (lanes.hpp).
  std::size_t lanes = 0;                 ///< none: of one run
  const std::size_t* indices = nullptr;  ///< where coordinates stand in the arrays of one run
};

template <class Real>
struct CompositionTable {
  void (*first)(const SystemView<Real>& system, const CompositionArrays<Real>& arrays,
                double since) = nullptr;
  /// Returns whether every coordinate stayed finite and within its largest move.
  bool (*step)(const SystemView<Real>& system, const CompositionArrays<Real>& arrays, double since,
               double h) = nullptr;
  /// Accelerations and rates at the present state, operators included.
  void (*slopes)(const SystemView<Real>& system, const CompositionArrays<Real>& arrays,
                 Real* acceleration, Real* rates) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// A symmetric composition of kicks and drifts,
///   kick[0] h, drift[0] h, kick[1] h, ..., drift[n-1] h, kick[n] h,
/// between two halves of the operators' flow, the second back to front. A kick's forces are also
/// the rates of running integrals, with the kick's weight: an integral of g(x, t) is the momentum
/// of one more coordinate that the energy -y g(x, t) belongs to, taken at y = 0, so that it has the
/// order of the scheme.
template <class Scheme>
struct CompositionKernels {
  /// v <- v + h a.
  template <class Real>
  TOMLIN_INLINE static void kick(const SystemView<Real>& s, const Real* force, Real h, Real* v) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(force + i) * Group::load(s.inverse_mass + i);
      fma(Group(h), a, Group::load(v + i)).store(v + i);
    }
  }

  /// The operators' half of a step, part 0 or 1. Returns their heat.
  template <class Real>
  TOMLIN_INLINE static Real half_flow(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                      std::uint64_t part, Real half) {
    if (s.flow_count == 0) return Real(0.0);
    FlowStage<Real> stage;
    stage.position = s.position;
    stage.inverse_mass = s.inverse_mass;
    stage.velocity = w.velocity;
    stage.own = w.own_after;
    stage.step = w.step;
    stage.part = part;
    stage.heat = s.friction_rate != kNoRate;
    return apply_flows(s, stage, half, part == 1);
  }

  template <class Real>
  TOMLIN_INLINE static void copy(const Real* from, std::size_t n, Real* to) {
    using Group = Packed<Real>;
    for (std::size_t i = 0; i < n; i += kGroup) Group::load(from + i).store(to + i);
  }

  template <class Real>
  TOMLIN_FLATTEN static void first(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                   double since) {
    evaluate(s,
             stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                      static_cast<const Real*>(s.integrals), w.rates, Real(since)));
    copy<Real>(s.force, s.dofs, w.force);
  }

  /// The stage that the next kick belongs to. False when something moved too far.
  template <class Real>
  TOMLIN_INLINE static bool drift(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                  int k, Real h) {
    using Group = Packed<Real>;
    const Group part(h * Scheme::template drift<Real>[k]);
    auto valid = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group v = Group::load(w.velocity + i);
      const Group move = k == 0 ? part * v : fma(part, v, Group::load(w.move + i));
      valid = valid & (abs(move) <= Group::load(s.largest_move + i));
      move.store(w.move + i);
      (Group::load(s.position + i) + move).store(w.position + i);
    }
    // Own variables are operators', or follow from the time alone: those rates are known at both
    // ends.
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(h * Scheme::template time<Real>[k]), Group::load(w.rates + i),
          Group::load(w.own_after + i))
          .store(w.own + i);
    }
    return all(valid);
  }

  /// Forces at the stage. False when one is no number: it must not enter the state.
  template <class Real>
  TOMLIN_INLINE static bool stage(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                  Real* rates, Real elapsed) {
    using Group = Packed<Real>;
    evaluate(s,
             stage_of(s, static_cast<const Real*>(w.position), static_cast<const Real*>(w.velocity),
                      static_cast<const Real*>(w.own), rates, elapsed));
    auto finite = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group a = Group::load(s.force + i) * Group::load(s.inverse_mass + i);
      finite = finite & (abs(a) < Group(Real(__builtin_inf())));
    }
    return all(finite);
  }

  /// Weighted rates of the kicks between the first and the last.
  template <class Real>
  TOMLIN_INLINE static void keep_rates(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                       int k) {
    using Group = Packed<Real>;
    const Group weight(Scheme::template kick<Real>[k]);
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Group rates = Group::load(w.stage_rates + i);
      (k == 1 ? weight * rates : fma(weight, rates, Group::load(w.inner_rates + i)))
          .store(w.inner_rates + i);
    }
  }

  template <class Real>
  TOMLIN_INLINE static void add_integrals(const SystemView<Real>& s,
                                          const CompositionArrays<Real>& w, Real h) {
    using Group = Packed<Real>;
    const Group outer(h * Scheme::template kick<Real>[0]);
    for (std::size_t i = 0; i < s.rates; i += kGroup) {
      const Group rates = Group::load(w.rates + i) + Group::load(w.end_rates + i);
      if constexpr (Scheme::drifts == 1) {
        fma(outer, rates, Group::load(s.integrals + i)).store(s.integrals + i);
      } else {
        const Group inner = Group(h) * Group::load(w.inner_rates + i);
        (Group::load(s.integrals + i) + fma(outer, rates, inner)).store(s.integrals + i);
      }
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system,
                                  const CompositionArrays<Real>& arrays, double start,
                                  double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const CompositionArrays<Real> w = arrays;
    const Real since(start);
    const Real h(length);
    const Real half = Real(0.5) * h;
    const Real outer = h * Scheme::template kick<Real>[0];
    constexpr int last = Scheme::drifts - 1;

    copy<Real>(s.velocity, s.dofs, w.velocity);
    copy<Real>(s.integrals, s.own, w.own_after);
    Real heat = half_flow<Real>(s, w, 0, half);
    kick<Real>(s, w.force, outer, w.velocity);
    for (int k = 0; k < last; ++k) {
      if (!drift(s, w, k, h)) return false;
      const Real elapsed = since + h * Scheme::template time<Real>[k];
      if (!stage(s, w, w.stage_rates, elapsed)) return false;
      keep_rates(s, w, k + 1);
      kick<Real>(s, s.force, h * Scheme::template kick<Real>[k + 1], w.velocity);
    }
    if (!drift(s, w, last, h)) return false;
    if (!stage(s, w, w.end_rates, since + h)) return false;

    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.position + i) + Group::load(w.move + i)).store(s.position + i);
    }
    copy<Real>(s.force, s.dofs, w.force);
    kick<Real>(s, w.force, outer, w.velocity);
    heat = heat + half_flow<Real>(s, w, 1, half);
    copy<Real>(w.velocity, s.dofs, s.velocity);
    copy<Real>(w.own_after, s.own, s.integrals);
    add_integrals(s, w, h);
    if (s.friction_rate != kNoRate) {
      s.integrals[s.friction_rate] = s.integrals[s.friction_rate] + heat;
    }
    return true;
  }

  template <class Real>
  TOMLIN_FLATTEN static void slopes(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                    Real* acceleration, Real* rates) {
    using Group = Packed<Real>;
    copy<Real>(w.force, s.dofs, s.force);
    copy<Real>(w.rates, s.rates, rates);
    const Real power = add_drags(
        s, stage_of(s, static_cast<const Real*>(s.position), static_cast<const Real*>(s.velocity),
                    static_cast<const Real*>(s.integrals), rates, Real(0.0)));
    if (s.friction_rate != kNoRate) rates[s.friction_rate] = power;
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.force + i) * Group::load(s.inverse_mass + i)).store(acceleration + i);
    }
  }

  template <class Real>
  static constexpr CompositionTable<Real> kernels() {
    return {&first<Real>, &step<Real>, &slopes<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
