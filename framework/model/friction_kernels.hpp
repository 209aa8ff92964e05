#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/normal_numbers.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/compensated.hpp"
#include "framework/core/system/flow.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/stage.hpp"

/// Friction as a matrix G on a body's generalised velocities u: the drag is -G u, the heat u.G u.
///
/// Free particles: G is diagonal, their friction coefficients c_i. A body that moves as one, with
/// C = sum c_i, S = sum c_i arm_i, J = sum c_i arm_i^2 and turns as the angle's coordinate
/// (tau = 2 pi), in the plane:
///
///       |    C          0      -tau S_y  |
///   G = |    0          C       tau S_x  |        S turns with the body; J does not
///       | -tau S_y   tau S_x    tau^2 J  |
///
/// With noise of temperature T, an energy, velocities are an Ornstein-Uhlenbeck process: a velocity
/// (a mode, where centre and rotation are coupled) of which a flow keeps the part k receives a
/// normal number of variance T/m (1 - k^2), m its mass, so that T is kept whatever the step and the
/// rule that k follows. Source: D. T. Gillespie, Phys. Rev. E 54 (1996) 2084,
/// doi:10.1103/PhysRevE.54.2084.
namespace tomlin {

template <class Real>
struct FrictionArguments {
  BodySlot<Real> body;
  int axes = 0;

  // Free particles: arrays over their coordinates, from the first on; zero where held.
  std::size_t length = 0;
  const Real* coefficient = nullptr;
  const Real* inverse_mass = nullptr;
  Real* keep = nullptr;  ///< scratch: exp(-h c/m) for the last h, in two parts
  Real* loss = nullptr;
  Real* known_h = nullptr;
  const Real* temperature = nullptr;  ///< null: no noise
  Real* spread = nullptr;             ///< scratch: its size for the last h

  // A body that moves as one.
  bool rotates = false;
  bool free[3] = {};    ///< centre's axes; the rotation's freedom is `rotates`
  Real total{};         ///< C
  Real moment[2] = {};  ///< S, unrotated
  Real second{};        ///< tau^2 J
  Real mass{};
  Real inertia{};                ///< tau^2 I
  Real bath{};                   ///< temperature; 0: no noise
  Real* heat_of_body = nullptr;  ///< left by the mobility, for the ledger; null without one

  RandomKey key;            ///< of the noise
  Real* normals = nullptr;  ///< scratch: as long as the particles' arrays, or a group
};

/// All coordinates of free particles, for the heat of dynamics without inertia.
template <class Real>
struct DriftHeatArguments {
  std::size_t dofs = 0;
  const Real* mobility = nullptr;  ///< inverse friction; zero for bodies that move as one
  const Real* heat_of_bodies = nullptr;
  std::size_t bodies = 0;
  std::ptrdiff_t rate = kNoRate;
};

template <class Real>
struct FrictionTable {
  // As operators, see flow.hpp.
  Real (*flow_of_particles)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  Real (*flow_of_body)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  Real (*drag_of_particles)(const void* arguments, const Stage<Real>& stage) = nullptr;
  Real (*drag_of_body)(const void* arguments, const Stage<Real>& stage) = nullptr;
  /// Without inertia: generalised forces -> velocities of a body that moves as one, in place.
  Kernel<Real> mobility = nullptr;
  Kernel<Real> drift_heat = nullptr;
  /// The body's part of Noise.
  void (*fill)(const void* arguments, const RandomKey& key, std::uint64_t step,
               Real* numbers) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct FrictionKernels {
  /// S at the body's present rotation.
  template <class Real>
  TOMLIN_INLINE static void turned_moment(const FrictionArguments<Real>& a, Real turns, Real& x,
                                          Real& y) {
    Real s;
    Real c;
    sincos_turns(turns, s, c);
    x = c * a.moment[0] - s * a.moment[1];
    y = s * a.moment[0] + c * a.moment[1];
  }

  /// Solves G u = f for the free coordinates, others get zero.
  template <class Real>
  TOMLIN_FLATTEN static void mobility(const void* arguments, const Stage<Real>& stage) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* f = stage.force + a.body.centre;
    Real u[3] = {Real(0.0), Real(0.0), Real(0.0)};
    Real coupling[3] = {Real(0.0), Real(0.0), Real(0.0)};
    if (a.axes == 2 && a.rotates) {
      Real sx;
      Real sy;
      turned_moment(a, stage.position[a.body.centre + 2], sx, sy);
      coupling[0] = -(tau<Real>() * sy);
      coupling[1] = tau<Real>() * sx;
      // Eliminate the centre first.
      Real pivot = a.second;
      Real due = f[2];
      for (int d = 0; d < 2; ++d) {
        if (!a.free[d]) continue;
        const Real share = coupling[d] / a.total;
        pivot = fnma(share, coupling[d], pivot);
        due = fnma(share, f[d], due);
      }
      u[2] = due / pivot;
    }
    const Real w = u[2];
    for (int d = 0; d < a.axes; ++d) {
      if (a.free[d]) u[d] = fnma(coupling[d], w, f[d]) / a.total;
    }
    Real heat(0.0);
    for (int k = 0; k < 3; ++k) heat = fma(f[k], u[k], heat);
    if (a.heat_of_body) *a.heat_of_body = heat;
    three_lanes(u[0], u[1], u[2]).store(f);
  }

  template <class Real>
  TOMLIN_FLATTEN static void drift_heat(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const auto a = *static_cast<const DriftHeatArguments<Real>*>(arguments);
    Group total(Real(0.0));
    for (std::size_t i = 0; i < a.dofs; i += kGroup) {
      const Group f = Group::load(stage.force + i);
      total = fma(f * Group::load(a.mobility + i), f, total);
    }
    Real heat = sum(total);
    for (std::size_t b = 0; b < a.bodies; ++b) heat += a.heat_of_bodies[b];
    stage.rates[a.rate] = heat;
  }

  /// exp(-h rate), or that of the midpoint rule, as keep + loss keep: for slow decay keep is 1 and
  /// loss exp(-h rate) - 1 to its last digit (a factor near one, rounded, would be off by the same
  /// part in every step); for fast decay loss is 0.
  template <class Real>
  struct Decay {
    Real keep;
    Real loss;

    TOMLIN_INLINE Decay(Real rate, Real h, bool midpoint) : keep(Real(1.0)), loss(Real(0.0)) {
      const Real x = h * rate;
      if (midpoint) {
        const Real half = Real(0.5) * x;
        if (half < Real(0.35)) {
          loss = -(x / (Real(1.0) + half));
        } else {
          keep = (Real(1.0) - half) / (Real(1.0) + half);
        }
        return;
      }
      if (!(x < Real(0.35))) {
        keep = exp(-x);
        return;
      }
      // -x (1 - x/2 (1 - x/3 (1 - ...))), to the digits of each type.
      constexpr int kTerms = sizeof(Real) == sizeof(float) ? 9 : sizeof(Real) == 8 ? 16 : 30;
      Real sum(1.0);
      for (int n = kTerms; n >= 2; --n) sum = fnma(x / Real(n), sum, Real(1.0));
      loss = -(x * sum);
    }

    /// exp(-h rate) - 1.
    TOMLIN_INLINE Real change() const { return fma(loss, keep, keep - Real(1.0)); }

    /// Size of the noise of variance 1 - exp(-2 h rate).
    TOMLIN_INLINE Real spread() const { return sqrt(-(change() * (Real(2.0) + change()))); }
  };

  /// v <- (keep + loss keep) v, of a group.
  template <class Real>
  TOMLIN_INLINE static void decay(Real* v, Real* rest, std::size_t i, const Packed<Real>& keep,
                                  const Packed<Real>& loss) {
    using Group = Packed<Real>;
    (keep * Group::load(v + i)).store(v + i);
    if (rest != nullptr) (keep * Group::load(rest + i)).store(rest + i);
    add_scaled(v, rest, i, loss, Group::load(v + i));
  }

  /// Kinetic energy that coordinates have lost, of the numbers as they were and are.
  template <class T>
  TOMLIN_INLINE static T lost(const T& mass, const T& before, const T& rest_before, const T& after,
                              const T& rest_after) {
    const T change = (before - after) + (rest_before - rest_after);
    return T(Scalar<T>(0.5)) * mass * change * (before + after);
  }

  /// v <- v exp(-h c/m), and noise.
  template <class Real>
  TOMLIN_FLATTEN static Real flow_of_particles(const void* arguments, const FlowStage<Real>& stage,
                                               Real h) {
    using Group = Packed<Real>;
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = stage.velocity + a.body.offset;
    Real* rest = stage.velocity_rest == nullptr ? nullptr : stage.velocity_rest + a.body.offset;
    const bool heats = stage.heat;
    if (!(*a.known_h == h)) {
      for (std::size_t i = 0; i < a.length; ++i) {
        const Decay<Real> decay(a.coefficient[i] * a.inverse_mass[i], h, stage.midpoint);
        a.keep[i] = decay.keep;
        a.loss[i] = decay.loss;
        if (a.temperature == nullptr) continue;
        a.spread[i] = decay.spread() * sqrt(a.temperature[i] * a.inverse_mass[i]);
      }
      *a.known_h = h;
    }
    if (a.temperature != nullptr) {
      fill_normals(stage.key, {stage.step, stage.part, 0, 0}, a.length, a.body.count, a.normals);
    }
    const Group none(Real(0.0));
    Group heat = none;
    for (std::size_t i = 0; i < a.length; i += kGroup) {
      const Group before = Group::load(v + i);
      const Group rest_before = rest == nullptr ? none : Group::load(rest + i);
      decay(v, rest, i, Group::load(a.keep + i), Group::load(a.loss + i));
      if (a.temperature != nullptr) {
        add_scaled(v, rest, i, Group::load(a.spread + i), Group::load(a.normals + i));
      }
      if (!heats) continue;
      // What is held has no inverse mass, and loses nothing.
      const Group inverse = Group::load(a.inverse_mass + i);
      const Group mass = Group(Real(1.0)) / select(none < inverse, inverse, Group(Real(1.0)));
      heat += lost(mass, before, rest_before, Group::load(v + i),
                   rest == nullptr ? none : Group::load(rest + i));
    }
    return heats ? sum(heat) : Real(0.0);
  }

  /// As it moves freely but for friction, its rotation at rest. With S = 0 each axis decays alone.
  /// Else, along the free part q of the coupling between centre and rotation, in coordinates
  /// sqrt(M) u_q and sqrt(I) w, friction is a symmetric matrix (a b, b d) with two modes, each with
  /// noise of its own.
  template <class Real>
  TOMLIN_FLATTEN static Real flow_of_body(const void* arguments, const FlowStage<Real>& stage,
                                          Real h) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = stage.velocity + a.body.centre;
    Real* rest = stage.velocity_rest == nullptr ? nullptr : stage.velocity_rest + a.body.centre;
    Real before[3];
    Real rest_before[3];
    for (int k = 0; k < 3; ++k) {
      before[k] = v[k];
      rest_before[k] = rest == nullptr ? Real(0.0) : rest[k];
    }
    const bool planar = a.axes == 2;
    const Decay<Real> centre(a.total / a.mass, h, stage.midpoint);
    const bool noisy = a.bath > Real(0.0);
    if (noisy) fill_normals(stage.key, {stage.step, stage.part, 0, 0}, kGroup, 3, a.normals);
    const Real* z = a.normals;
    const Real speed = noisy ? sqrt(a.bath / a.mass) : Real(0.0);
    Real q[2] = {Real(0.0), Real(0.0)};
    if (a.rotates && (a.moment[0] != Real(0.0) || a.moment[1] != Real(0.0))) {
      Real sx;
      Real sy;
      turned_moment(a, stage.position[a.body.centre + 2], sx, sy);
      if (a.free[0]) q[0] = -(tau<Real>() * sy);
      if (a.free[1]) q[1] = tau<Real>() * sx;
    }
    const Real coupling = sqrt(fma(q[0], q[0], q[1] * q[1]));
    if (coupling > Real(0.0)) {
      for (Real& part : q) part = part / coupling;
      const Real along_centre = a.total / a.mass;
      const Real along_rotation = a.second / a.inertia;
      const Real b = coupling / sqrt(a.mass * a.inertia);
      const Real half = Real(0.5) * (along_centre - along_rotation);
      const Real radius = sqrt(fma(half, half, b * b));
      // Directions of the modes, by that part which does not cancel.
      const Real large = sqrt(Real(0.5) * (Real(1.0) + abs(half) / radius));
      const Real small = b / (Real(2.0) * radius * large);
      const Real cosine = half < Real(0.0) ? small : large;
      const Real sine = half < Real(0.0) ? large : small;
      const Real fast = Real(0.5) * (along_centre + along_rotation) + radius;
      const Real slow = fnma(b, b, along_centre * along_rotation) / fast;
      const Real to_centre = sqrt(a.inertia / a.mass);
      const Real u = fma(q[0], v[0], q[1] * v[1]);
      const Real w = to_centre * v[2];
      const Decay<Real> of_fast(fast, h, stage.midpoint);
      const Decay<Real> of_slow(max(slow, Real(0.0)), h, stage.midpoint);
      Real fast_change = of_fast.change() * fma(cosine, u, sine * w);
      Real slow_change = of_slow.change() * fnma(sine, u, cosine * w);
      if (noisy) {
        fast_change = fma(speed * of_fast.spread(), z[0], fast_change);
        slow_change = fma(speed * of_slow.spread(), z[1], slow_change);
      }
      const Real along = fnma(sine, slow_change, cosine * fast_change);
      Real change[3];
      for (int d = 0; d < 2; ++d) {
        change[d] = fma(q[d], along, centre.change() * fnma(q[d], u, v[d]));
      }
      change[2] = fma(sine, fast_change, cosine * slow_change) / to_centre;
      if (noisy && a.free[0] && a.free[1]) {
        const Real across = speed * centre.spread() * z[2];
        change[0] = fnma(q[1], across, change[0]);
        change[1] = fma(q[0], across, change[1]);
      }
      add_move(v, rest, 0, three_lanes(change[0], change[1], change[2]));
    } else {
      const Decay<Real> turning(a.rotates ? a.second / a.inertia : Real(0.0), h, stage.midpoint);
      decay(v, rest, 0, three_lanes(centre.keep, centre.keep, planar ? turning.keep : centre.keep),
            three_lanes(centre.loss, centre.loss, planar ? turning.loss : centre.loss));
      if (noisy) {
        const Real along = speed * centre.spread();
        const Real turn = a.rotates ? sqrt(a.bath / a.inertia) * turning.spread() : Real(0.0);
        const Real third = planar ? turn : a.free[2] ? along : Real(0.0);
        add_move(v, rest, 0,
                 three_lanes(a.free[0] ? along * z[0] : Real(0.0),
                             a.free[1] ? along * z[1] : Real(0.0), third * z[2]));
      }
    }
    Real heat(0.0);
    if (!stage.heat) return heat;
    for (int k = 0; k < 3; ++k) {
      heat += lost(planar && k == 2 ? a.inertia : a.mass, before[k], rest_before[k], v[k],
                   rest == nullptr ? Real(0.0) : rest[k]);
    }
    return heat;
  }

  /// force -= G v; returns v.G v.
  template <class Real>
  TOMLIN_INLINE static Real add_drag(const FrictionArguments<Real>& a, const Real* position,
                                     const Real* v, Real* force) {
    Real sx(0.0);
    Real sy(0.0);
    const Real w = a.axes == 2 && a.rotates ? v[2] : Real(0.0);
    if (a.axes == 2 && a.rotates) turned_moment(a, position[a.body.centre + 2], sx, sy);
    const Real coupling[3] = {-(tau<Real>() * sy), tau<Real>() * sx, Real(0.0)};
    Real heat(0.0);
    Real torque(0.0);
    for (int d = 0; d < a.axes; ++d) {
      const Real part = fma(coupling[d], w, a.total * v[d]);
      torque = fma(coupling[d], v[d], torque);
      force[d] = force[d] - part;
      heat = fma(part, v[d], heat);
    }
    if (a.axes == 2 && a.rotates) {
      torque = fma(a.second, w, torque);
      force[2] = force[2] - torque;
      heat = fma(torque, w, heat);
    }
    return heat;
  }

  template <class Real>
  TOMLIN_FLATTEN static Real drag_of_body(const void* arguments, const Stage<Real>& stage) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    return add_drag(a, stage.position, stage.velocity + a.body.centre, stage.force + a.body.centre);
  }

  template <class Real>
  TOMLIN_FLATTEN static Real drag_of_particles(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    const Real* v = stage.velocity + a.body.offset;
    Real* f = stage.force + a.body.offset;
    Group heat(Real(0.0));
    for (std::size_t i = 0; i < a.length; i += kGroup) {
      const Group here = Group::load(v + i);
      const Group drag = Group::load(a.coefficient + i) * here;
      (Group::load(f + i) - drag).store(f + i);
      heat = fma(drag, here, heat);
    }
    return sum(heat);
  }

  template <class Real>
  TOMLIN_FLATTEN static void fill(const void* arguments, const RandomKey& key, std::uint64_t step,
                                  Real* numbers) {
    const FrictionArguments<Real>& a = *static_cast<const FrictionArguments<Real>*>(arguments);
    const RandomPlace place{step, 0, 0, 0};
    if (a.body.rigid) {
      fill_normals(key, place, kGroup, 3, numbers + a.body.centre);
    } else {
      fill_normals(key, place, a.length, a.body.count, numbers + a.body.offset);
    }
  }

  template <class Real>
  static constexpr FrictionTable<Real> kernels() {
    return {&flow_of_particles<Real>,
            &flow_of_body<Real>,
            &drag_of_particles<Real>,
            &drag_of_body<Real>,
            &mobility<Real>,
            &drift_heat<Real>,
            &fill<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
