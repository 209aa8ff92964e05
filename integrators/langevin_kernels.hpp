#pragma once

#include <type_traits>

#include "framework/core/elements/lane_kernels.hpp"
#include "integrators/composition_kernels.hpp"
#include "integrators/velocity_verlet_kernels.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

/// A step of the velocity Verlet scheme with all operators in the middle of its drift: kick h/2,
/// drift h/2, operators h, drift h/2, kick h/2. Kinetic energies within a step are the mean of
/// those before and after the operators: both have the temperature of equilibrium, and the mean has
/// the heat that flows in a step from the right side and from the left. Linear friction by its
/// exact flow, or by the midpoint rule.
template <bool midpoint>
struct LangevinKernels : CompositionKernels<VerletScheme> {
  using Verlet = CompositionKernels<VerletScheme>;

  /// Moves by h v, as far as the step has come. False when something moved too far.
  template <class Real>
  TOMLIN_INLINE static bool move(const SystemView<Real>& s, const CompositionArrays<Real>& w,
                                 Real h, bool first) {
    using Group = Packed<Real>;
    auto valid = first_lanes_of<Group>(kGroup);
    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      const Group way = Group(h) * Group::load(w.velocity + i);
      const Group so_far = first ? way : Group::load(w.move + i) + way;
      valid = valid & (abs(so_far) <= Group::load(s.largest_move + i));
      so_far.store(w.move + i);
      (Group::load(s.position + i) + so_far).store(w.position + i);
    }
    return all(valid);
  }

  template <class Real>
  TOMLIN_INLINE static Real kinetic_energy(const CompositionArrays<Real>& w,
                                           const KineticIntegral& body) {
    using Group = Packed<Real>;
    Group total(Real(0.0));
    for (std::size_t i = body.first; i < body.first + body.length; i += kGroup) {
      const Group v = Group::load(w.velocity + i);
      total += v * v * Group::load(w.mass + i);
    }
    return Real(0.5) * sum(total);
  }

  /// Kinetic energies of eight replicas, from `lane` on, by the same rule of sums.
  TOMLIN_INLINE static Pack kinetic_energy_in_lanes(const CompositionArrays<double>& w,
                                                    const KineticIntegral& body, std::size_t lane) {
    if (body.length == w.lanes) {
      const Pack v = Pack::load(w.velocity + body.first + lane);
      return Pack(0.5) * (v * v * Pack::load(w.mass + body.first + lane));
    }
    LaneSum total;
    const std::size_t* index = w.indices + body.first / w.lanes;
    for (std::size_t i = body.first + lane; i < body.first + body.length; i += w.lanes) {
      const Pack v = Pack::load(w.velocity + i);
      total.add(*index++, v * v * Pack::load(w.mass + i));
    }
    return Pack(0.5) * total.total(body.length / w.lanes);
  }

  /// Half of the kinetic energies at this moment: the first of two, or added to it.
  template <class Real>
  TOMLIN_INLINE static void keep_energies(const SystemView<Real>& s,
                                          const CompositionArrays<Real>& w, bool first) {
    for (std::size_t k = 0; k < s.kinetic_count; ++k) {
      if constexpr (std::is_same_v<Real, double>) {
        for (std::size_t lane = 0; lane < w.lanes; lane += kGroup) {
          put_lanes(first, w.half_step_energy + k * w.lanes + lane,
                    Pack(0.5) * kinetic_energy_in_lanes(w, s.kinetic[k], lane));
        }
      }
      if (w.lanes > 0) continue;
      const Real half = Real(0.5) * kinetic_energy(w, s.kinetic[k]);
      w.half_step_energy[k] = first ? half : w.half_step_energy[k] + half;
    }
  }

  template <class Real>
  TOMLIN_INLINE static void add_energies(const SystemView<Real>& s,
                                         const CompositionArrays<Real>& w, Real h) {
    for (std::size_t k = 0; k < s.kinetic_count; ++k) {
      const auto rate = static_cast<std::size_t>(s.kinetic[k].rate);
      if constexpr (std::is_same_v<Real, double>) {
        for (std::size_t lane = 0; lane < w.lanes; lane += kGroup) {
          const Pack energy = Pack::load(w.half_step_energy + k * w.lanes + lane);
          put_lanes(false, s.integrals + rate + lane, Pack(h) * energy);
        }
      }
      if (w.lanes > 0) continue;
      s.integrals[rate] = s.integrals[rate] + h * w.half_step_energy[k];
    }
  }

  template <class Real>
  TOMLIN_FLATTEN static bool step(const SystemView<Real>& system,
                                  const CompositionArrays<Real>& arrays, double start,
                                  double length) {
    using Group = Packed<Real>;
    const SystemView<Real> s = system;
    const CompositionArrays<Real> w = arrays;
    const Real h(length);
    const Real half = Real(0.5) * h;

    Verlet::copy<Real>(s.velocity, s.dofs, w.velocity);
    Verlet::copy<Real>(s.integrals, s.own, w.own_after);
    Verlet::kick<Real>(s, w.force, half, w.velocity);
    if (!move(s, w, half, true)) return false;
    FlowStage<Real> middle;
    middle.position = w.position;
    middle.inverse_mass = s.inverse_mass;
    middle.velocity = w.velocity;
    middle.own = w.own_after;
    middle.step = w.step;
    middle.heat = s.friction_rate != kNoRate;
    middle.midpoint = midpoint;
    keep_energies(s, w, true);
    Real heat(0.0);
    if (s.flow_count > 1 && s.flows_overlap) {
      // They may act on the same velocities: a symmetric composition.
      heat = apply_flows(s, middle, half, false);
      middle.part = 1;
      heat = heat + apply_flows(s, middle, half, true);
    } else {
      heat = apply_flows(s, middle, h, false);
    }
    keep_energies(s, w, false);
    if (!move(s, w, half, false)) return false;
    // Own variables are operators', or follow from the time alone.
    for (std::size_t i = 0; i < s.own; i += kGroup) {
      fma(Group(h), Group::load(w.rates + i), Group::load(w.own_after + i)).store(w.own + i);
    }
    if (!Verlet::stage(s, w, w.end_rates, Real(start) + h)) return false;

    for (std::size_t i = 0; i < s.dofs; i += kGroup) {
      (Group::load(s.position + i) + Group::load(w.move + i)).store(s.position + i);
    }
    Verlet::copy<Real>(s.force, s.dofs, w.force);
    Verlet::kick<Real>(s, w.force, half, w.velocity);
    Verlet::copy<Real>(w.velocity, s.dofs, s.velocity);
    Verlet::copy<Real>(w.own_after, s.own, s.integrals);
    Verlet::add_integrals(s, w, h);
    if (s.friction_rate != kNoRate) {
      s.integrals[s.friction_rate] = s.integrals[s.friction_rate] + heat;
    }
    add_energies(s, w, h);
    return true;
  }

  template <class Real>
  static constexpr CompositionTable<Real> kernels() {
    return {&Verlet::first<Real>, &step<Real>, &Verlet::slopes<Real>};
  }
};

struct BaoabKernels : LangevinKernels<false> {};
struct GjfKernels : LangevinKernels<true> {};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
