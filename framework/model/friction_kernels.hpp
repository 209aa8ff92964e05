#pragma once

#include <cstddef>

#include "framework/core/compensated.hpp"
#include "framework/core/kernel_arguments.hpp"
#include "framework/core/math.hpp"
#include "framework/core/number_types.hpp"
#include "framework/core/stage.hpp"

/// Friction as a matrix G on a body's generalised velocities u: the drag is -G u, the heat u.G u.
///
/// Free particles: G is diagonal, their friction coefficients c_i. A body that moves as one, with
/// C = sum c_i, S = sum c_i arm_i, J = sum c_i arm_i^2 and turns as the angle's coordinate
/// (tau = 2 pi), in the plane:
///
///       |    C          0      -tau S_y  |
///   G = |    0          C       tau S_x  |        S turns with the body; J does not
///       | -tau S_y   tau S_x    tau^2 J  |
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

  // A body that moves as one.
  bool rotates = false;
  bool free[3] = {};    ///< centre's axes; the rotation's freedom is `rotates`
  Real total{};         ///< C
  Real moment[2] = {};  ///< S, unrotated
  Real second{};        ///< tau^2 J
  Real mass{};
  Real inertia{};                ///< tau^2 I
  Real* heat_of_body = nullptr;  ///< left by the mobility, for the ledger; null without one
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
  void (*flow_of_particles)(const void* arguments, const Real* position, Real* velocity, Real* rest,
                            Real h) = nullptr;
  void (*flow_of_body)(const void* arguments, const Real* position, Real* velocity, Real* rest,
                       Real h) = nullptr;
  Real (*drag_of_particles)(const void* arguments, const Real* position, const Real* velocity,
                            Real* force) = nullptr;
  Real (*drag_of_body)(const void* arguments, const Real* position, const Real* velocity,
                       Real* force) = nullptr;
  /// Without inertia: generalised forces -> velocities of a body that moves as one, in place.
  Kernel<Real> mobility = nullptr;
  Kernel<Real> drift_heat = nullptr;
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

  /// Solves (diagonal + scale G) u = f for the free coordinates, others get zero.
  template <class Real>
  TOMLIN_INLINE static void solve(const FrictionArguments<Real>& a, Real turns,
                                  const Real* diagonal, Real diagonal_of_rotation, Real scale,
                                  const Real* f, Real* u) {
    Real sx(0.0);
    Real sy(0.0);
    if (a.axes == 2 && a.rotates) turned_moment(a, turns, sx, sy);
    const Real coupling[3] = {-(tau<Real>() * sy) * scale, tau<Real>() * sx * scale, Real(0.0)};
    Real w(0.0);
    if (a.axes == 2 && a.rotates) {
      // Eliminate the centre first.
      Real pivot = fma(scale, a.second, diagonal_of_rotation);
      Real due = f[2];
      for (int d = 0; d < 2; ++d) {
        if (!a.free[d]) continue;
        const Real share = coupling[d] / fma(scale, a.total, diagonal[d]);
        pivot = fnma(share, coupling[d], pivot);
        due = fnma(share, f[d], due);
      }
      w = due / pivot;
    }
    for (int d = 0; d < a.axes; ++d) {
      u[d] = a.free[d] ? fnma(coupling[d], w, f[d]) / fma(scale, a.total, diagonal[d]) : Real(0.0);
    }
    if (a.axes == 2) u[2] = w;
  }

  template <class Real>
  TOMLIN_FLATTEN static void mobility(const void* arguments, const Stage<Real>& stage) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* f = stage.force + a.body.centre;
    const Real none[3] = {Real(0.0), Real(0.0), Real(0.0)};
    Real u[3] = {Real(0.0), Real(0.0), Real(0.0)};
    solve(a, a.axes == 2 ? stage.position[a.body.centre + 2] : Real(0.0), none, Real(0.0),
          Real(1.0), f, u);
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

  /// exp(-h rate) as keep + loss keep: for slow decay keep is 1 and loss exp(-h rate) - 1 to its
  /// last digit (a factor near one, rounded, would be off by the same part in every step); for fast
  /// decay loss is 0.
  template <class Real>
  struct Decay {
    Real keep;
    Real loss;

    TOMLIN_INLINE Decay(Real rate, Real h) : keep(Real(1.0)), loss(Real(0.0)) {
      const Real x = h * rate;
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

  /// Exact: v <- v exp(-h c/m).
  template <class Real>
  TOMLIN_FLATTEN static void flow_of_particles(const void* arguments, const Real*, Real* velocity,
                                               Real* velocity_rest, Real h) {
    using Group = Packed<Real>;
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = velocity + a.body.offset;
    Real* rest = velocity_rest == nullptr ? nullptr : velocity_rest + a.body.offset;
    if (!(*a.known_h == h)) {
      for (std::size_t i = 0; i < a.length; ++i) {
        const Decay<Real> decay(a.coefficient[i] * a.inverse_mass[i], h);
        a.keep[i] = decay.keep;
        a.loss[i] = decay.loss;
      }
      *a.known_h = h;
    }
    for (std::size_t i = 0; i < a.length; i += kGroup) {
      decay(v, rest, i, Group::load(a.keep + i), Group::load(a.loss + i));
    }
  }

  /// Exact where friction is centred on the mass (S = 0); otherwise by the implicit midpoint rule,
  /// which is of second order, as the schemes are that split.
  template <class Real>
  TOMLIN_FLATTEN static void flow_of_body(const void* arguments, const Real* position,
                                          Real* velocity, Real* velocity_rest, Real h) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = velocity + a.body.centre;
    Real* rest = velocity_rest == nullptr ? nullptr : velocity_rest + a.body.centre;
    if (a.rotates && (a.moment[0] != Real(0.0) || a.moment[1] != Real(0.0))) {
      Real drag[3] = {Real(0.0), Real(0.0), Real(0.0)};
      Real change[3] = {Real(0.0), Real(0.0), Real(0.0)};
      add_drag(a, position, v, drag);
      for (Real& part : drag) part = part * h;
      const Real masses[3] = {a.mass, a.mass, a.mass};
      solve(a, position[a.body.centre + 2], masses, a.inertia, Real(0.5) * h, drag, change);
      add_move(v, rest, 0, three_lanes(change[0], change[1], change[2]));
      return;
    }
    const Decay<Real> centre(a.total / a.mass, h);
    const Decay<Real> turning(a.rotates ? a.second / a.inertia : Real(0.0), h);
    const bool planar = a.axes == 2;
    decay(v, rest, 0, three_lanes(centre.keep, centre.keep, planar ? turning.keep : centre.keep),
          three_lanes(centre.loss, centre.loss, planar ? turning.loss : centre.loss));
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
  TOMLIN_FLATTEN static Real drag_of_body(const void* arguments, const Real* position,
                                          const Real* velocity, Real* force) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    return add_drag(a, position, velocity + a.body.centre, force + a.body.centre);
  }

  template <class Real>
  TOMLIN_FLATTEN static Real drag_of_particles(const void* arguments, const Real*,
                                               const Real* velocity, Real* force) {
    using Group = Packed<Real>;
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    const Real* v = velocity + a.body.offset;
    Real* f = force + a.body.offset;
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
  static constexpr FrictionTable<Real> kernels() {
    return {&flow_of_particles<Real>, &flow_of_body<Real>, &drag_of_particles<Real>,
            &drag_of_body<Real>,      &mobility<Real>,     &drift_heat<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
