#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/elements/lane_kernels.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/rotation_vector.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/stage.hpp"

namespace tomlin {

/// A body that moves as one. Its coordinates are the centre and, in the plane, the rotation in
/// turns; the rotation is counter-clockwise positive. One that rotates in space, a rotor, has after
/// its centre the vector p by which its principal axes are rotated from an orientation that follows
/// them now and then (rotation_vector.hpp); its velocity is dp/dt.
template <class Real>
struct RigidArguments {
  BodySlot<Real> body;
  const Real* reference = nullptr;  ///< particles about the centre, unrotated: [axis * stride + i]
  Real* arm = nullptr;              ///< the same, rotated; written by `place`, read by `gather`
  bool velocities = false;          ///< some force reads the particles' velocities
  /// Coordinates and velocities of a prescribed body; null for a rigid body, whose
  /// coordinates are part of the state.
  const Real* coordinates = nullptr;
  const Real* speeds = nullptr;
  std::ptrdiff_t rate = kNoRate;  ///< where the force and the power of a prescribed body go
  // The rest is for a rotor, whose `reference` is along its principal axes.
  const Real* axes = nullptr;    ///< [axis of space][principal axis], at p = 0
  Real* turned = nullptr;        ///< the same at p; written by `place`, read by `gather`
  Real moments[3] = {};          ///< of inertia; 0 along a rod
  Real inverse_moments[3] = {};  ///< 0 along a rod
  Real masses[3] = {};           ///< of the coordinates p: forces on them are mass times d2p/dt2
};

template <class Real>
struct RigidTable {
  /// For dimensions 1 to 3. Coordinates -> particles.
  Kernel<Real> place[3] = {};
  /// Forces on particles -> force and torque (virtual work), set or added to what is there.
  Kernel<Real> gather_set[3] = {};
  Kernel<Real> gather_add[3] = {};
  /// Forces on particles -> the force that keeps up a prescribed motion, and its power.
  Kernel<Real> react[3] = {};
  /// Kernels of a rotor: its torque is along the principal axes.
  Kernel<Real> place_rotor = nullptr;
  Kernel<Real> gather_rotor_set = nullptr;
  Kernel<Real> gather_rotor_add = nullptr;
  /// After all torques: Euler's equations, as forces on p.
  Kernel<Real> rotate = nullptr;
  /// `place` and `gather` over replicas (framework/core/system/lanes.hpp): numbers are the
  /// reference; the scratch, rotated arms [axis][particle], is the same for both.
  Kernel<double> place_lanes[3] = {};
  Kernel<double> gather_lanes[3] = {};
};

inline namespace TOMLIN_TARGET {

struct RigidKernels {
  /// x_i = c + R(phi) r_i,  v_i = c' + omega (-arm_y, arm_x); without rotation but in the plane.
  template <class Real, int D>
  TOMLIN_FLATTEN static void place(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const Real* q = a.coordinates ? a.coordinates : stage.position + a.body.centre;
    const Real* u = a.speeds ? a.speeds : stage.velocity + a.body.centre;
    const std::size_t stride = a.body.stride;
    Real* x = stage.mapped_position + a.body.offset;
    Real* v = stage.mapped_velocity + a.body.offset;
    if constexpr (D == 2) {
      Real sine;
      Real cosine;
      sincos_turns(q[2], sine, cosine);
      const Group s(sine);
      const Group c(cosine);
      const Group centre_x(q[0]);
      const Group centre_y(q[1]);
      const Group velocity_x(u[0]);
      const Group velocity_y(u[1]);
      const Group omega(tau<Real>() * u[2]);
      for (std::size_t i = 0; i < a.body.count; i += kGroup) {
        const Group rx = Group::load(a.reference + i);
        const Group ry = Group::load(a.reference + stride + i);
        const Group ax = fma(c, rx, -(s * ry));
        const Group ay = fma(s, rx, c * ry);
        ax.store(a.arm + i);
        ay.store(a.arm + stride + i);
        (centre_x + ax).store(x + i);
        (centre_y + ay).store(x + stride + i);
        if (a.velocities) {
          fma(-omega, ay, velocity_x).store(v + i);
          fma(omega, ax, velocity_y).store(v + stride + i);
        }
      }
    } else {
      for (int d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < a.body.count; i += kGroup) {
          (Group(q[d]) + Group::load(a.reference + d * stride + i)).store(x + d * stride + i);
          if (a.velocities) Group(u[d]).store(v + d * stride + i);
        }
      }
    }
  }

  /// The coordinate counts turns, so its generalised force is 2 pi times the torque.
  template <class Real, int D, bool set>
  TOMLIN_FLATTEN static void gather(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const std::size_t stride = a.body.stride;
    const Real* f = stage.mapped_force + a.body.offset;
    Group force[3] = {Group(Real(0.0)), Group(Real(0.0)), Group(Real(0.0))};
    Group torque(Real(0.0));
    for (std::size_t i = 0; i < a.body.count; i += kGroup) {
      for (int d = 0; d < D; ++d) force[d] += Group::load(f + d * stride + i);
      if constexpr (D == 2) {
        torque = fma(Group::load(a.arm + i), Group::load(f + stride + i), torque);
        torque = fma(-Group::load(a.arm + stride + i), Group::load(f + i), torque);
      }
    }
    // Written whole: a group stored in parts would stall the load that takes it whole.
    const Real third = D == 2 ? tau<Real>() * sum(torque) : sum(force[2]);
    const Group total = three_lanes(sum(force[0]), D > 1 ? sum(force[1]) : Real(0.0), third);
    Real* generalised = stage.force + a.body.centre;
    (set ? total : Group::load(generalised) + total).store(generalised);
  }

  /// x_i = c + R r_i,  v_i = c' + (R w) x (R r_i), R the principal axes now.
  template <class Real>
  TOMLIN_FLATTEN static void place_rotor(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const Real* q = stage.position + a.body.centre;
    const Real* u = stage.velocity + a.body.centre;
    const Vec<Real, 3> p = {{q[3], q[4], q[5]}};
    const Vec<Real, 3> w = angular_velocity(p, {{u[3], u[4], u[5]}});
    Real m[9];
    rotate_axes(a.axes, p, m);
    Vec<Group, 3> spin;
    for (int d = 0; d < 3; ++d) {
      spin[d] = Group(m[3 * d] * w[0] + m[3 * d + 1] * w[1] + m[3 * d + 2] * w[2]);
    }
    for (int k = 0; k < 9; ++k) a.turned[k] = m[k];
    const std::size_t stride = a.body.stride;
    Real* x = stage.mapped_position + a.body.offset;
    Real* v = stage.mapped_velocity + a.body.offset;
    for (std::size_t i = 0; i < a.body.count; i += kGroup) {
      Vec<Group, 3> r;
      Vec<Group, 3> arm;
      for (int d = 0; d < 3; ++d) r[d] = Group::load(a.reference + d * stride + i);
      for (int d = 0; d < 3; ++d) {
        arm[d] =
            fma(Group(m[3 * d + 2]), r[2], fma(Group(m[3 * d + 1]), r[1], Group(m[3 * d]) * r[0]));
        arm[d].store(a.arm + d * stride + i);
        (Group(q[d]) + arm[d]).store(x + d * stride + i);
      }
      if (!a.velocities) continue;
      const Vec<Group, 3> turning = cross(spin, arm);
      for (int d = 0; d < 3; ++d) (Group(u[d]) + turning[d]).store(v + d * stride + i);
    }
  }

  template <class Real, bool set>
  TOMLIN_FLATTEN static void gather_rotor(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const std::size_t stride = a.body.stride;
    const Real* f = stage.mapped_force + a.body.offset;
    Vec<Group, 3> force;
    Vec<Group, 3> torque;
    for (int d = 0; d < 3; ++d) force[d] = torque[d] = Group(Real(0.0));
    for (std::size_t i = 0; i < a.body.count; i += kGroup) {
      Vec<Group, 3> arm;
      Vec<Group, 3> here;
      for (int d = 0; d < 3; ++d) {
        arm[d] = Group::load(a.arm + d * stride + i);
        here[d] = Group::load(f + d * stride + i);
      }
      force += here;
      torque += cross(arm, here);
    }
    Real* generalised = stage.force + a.body.centre;
    const Vec<Real, 3> total = {{sum(torque[0]), sum(torque[1]), sum(torque[2])}};
    const Real* m = a.turned;
    for (int k = 0; k < 3; ++k) {
      const Real along = m[k] * total[0] + m[3 + k] * total[1] + m[6 + k] * total[2];
      generalised[k] = set ? sum(force[k]) : generalised[k] + sum(force[k]);
      generalised[3 + k] = set ? along : generalised[3 + k] + along;
    }
    if (!set) return;
    for (std::size_t k = 6; k < kGroup; ++k) generalised[k] = Real(0.0);
  }

  /// I dw/dt = torque - w x I w along the principal axes.
  template <class Real>
  TOMLIN_FLATTEN static void rotate(const void* arguments, const Stage<Real>& stage) {
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const Real* q = stage.position + a.body.centre + 3;
    const Real* velocity = stage.velocity + a.body.centre + 3;
    Real* f = stage.force + a.body.centre + 3;
    const Vec<Real, 3> p = {{q[0], q[1], q[2]}};
    const Vec<Real, 3> u = {{velocity[0], velocity[1], velocity[2]}};
    const Vec<Real, 3> w = angular_velocity(p, u);
    const Vec<Real, 3> momentum = {{a.moments[0] * w[0], a.moments[1] * w[1], a.moments[2] * w[2]}};
    const Vec<Real, 3> gyroscopic = cross(w, momentum);
    Vec<Real, 3> angular;
    for (int k = 0; k < 3; ++k) angular[k] = a.inverse_moments[k] * (f[k] - gyroscopic[k]);
    const Vec<Real, 3> acceleration = acceleration_of_vector(p, u, angular);
    for (int k = 0; k < 3; ++k) f[k] = a.masses[k] * acceleration[k];
  }

  template <class Real, int D>
  TOMLIN_FLATTEN static void react(const void* arguments, const Stage<Real>& stage) {
    using Group = Packed<Real>;
    const RigidArguments<Real> a = *static_cast<const RigidArguments<Real>*>(arguments);
    const std::size_t stride = a.body.stride;
    const Real* f = stage.mapped_force + a.body.offset;
    const Real* v = stage.mapped_velocity + a.body.offset;
    Group power(Real(0.0));
    for (int d = 0; d < D; ++d) {
      Group force(Real(0.0));
      for (std::size_t i = 0; i < a.body.count; i += kGroup) {
        const Group here = Group::load(f + d * stride + i);
        force += here;
        power = fma(here, Group::load(v + d * stride + i), power);
      }
      stage.rates[a.rate + d] = Real(0.0) - sum(force);
    }
    stage.rates[a.rate + D] = Real(0.0) - sum(power);
  }

  template <int D>
  TOMLIN_FLATTEN static void place_lanes(const void* arguments, const Stage<double>& stage) {
    const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
    const auto& a = *static_cast<const RigidArguments<double>*>(l.single);
    const bool velocities = a.velocities;
    const std::size_t count = a.body.count;
    const std::size_t stride = a.body.stride;
    const std::size_t w = l.width;
    for (std::size_t lane = 0; lane < w; lane += kGroup) {
      const std::size_t centre = l.coordinate[a.body.centre] * w + lane;
      const std::size_t first = l.mapped[a.body.offset] * w + lane;
      const double* q = stage.position + centre;
      const double* u = stage.velocity + centre;
      double* x = stage.mapped_position + first;
      double* v = stage.mapped_velocity + first;
      const double* reference = l.numbers + lane;
      if constexpr (D == 2) {
        double* arm = l.scratch + lane;
        Pack s;
        Pack c;
        sincos_turns(Pack::load(q + 2 * w), s, c);
        const Pack centre_x = Pack::load(q);
        const Pack centre_y = Pack::load(q + w);
        const Pack velocity_x = Pack::load(u);
        const Pack velocity_y = Pack::load(u + w);
        const Pack omega = tau<Pack>() * Pack::load(u + 2 * w);
        for (std::size_t i = 0; i < count; ++i) {
          const Pack rx = Pack::load(reference + i * w);
          const Pack ry = Pack::load(reference + (stride + i) * w);
          const Pack ax = fma(c, rx, -(s * ry));
          const Pack ay = fma(s, rx, c * ry);
          ax.store(arm + i * w);
          ay.store(arm + (count + i) * w);
          (centre_x + ax).store(x + i * w);
          (centre_y + ay).store(x + (count + i) * w);
          if (velocities) {
            fma(-omega, ay, velocity_x).store(v + i * w);
            fma(omega, ax, velocity_y).store(v + (count + i) * w);
          }
        }
      } else {
        for (std::size_t d = 0; d < D; ++d) {
          const Pack to = Pack::load(q + d * w);
          for (std::size_t i = 0; i < count; ++i) {
            (to + Pack::load(reference + (d * stride + i) * w)).store(x + (d * count + i) * w);
            if (velocities) Pack::load(u + d * w).store(v + (d * count + i) * w);
          }
        }
      }
    }
  }

  template <int D>
  TOMLIN_FLATTEN static void gather_lanes(const void* arguments, const Stage<double>& stage) {
    const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
    const auto& a = *static_cast<const RigidArguments<double>*>(l.single);
    const std::size_t count = a.body.count;
    const std::size_t w = l.width;
    for (std::size_t lane = 0; lane < w; lane += kGroup) {
      const double* f = stage.mapped_force + l.mapped[a.body.offset] * w + lane;
      double* generalised = stage.force + l.coordinate[a.body.centre] * w + lane;
      const double* arm = l.scratch + lane;
      LaneSum force[D];
      LaneSum torque;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t d = 0; d < D; ++d) force[d].add(i, Pack::load(f + (d * count + i) * w));
        if constexpr (D == 2) {
          torque.add_product(i, Pack::load(arm + i * w), Pack::load(f + (count + i) * w));
          torque.add_product(i, -Pack::load(arm + (count + i) * w), Pack::load(f + i * w));
        }
      }
      for (std::size_t d = 0; d < D; ++d) {
        put_lanes(l.set, generalised + d * w, force[d].total(kGroup));
      }
      if constexpr (D == 2) {
        put_lanes(l.set, generalised + 2 * w, tau<Pack>() * torque.total(kGroup));
      }
    }
  }

  template <class Real>
  static constexpr RigidTable<Real> kernels() {
    RigidTable<Real> table = {
        {&place<Real, 1>, &place<Real, 2>, &place<Real, 3>},
        {&gather<Real, 1, true>, &gather<Real, 2, true>, &gather<Real, 3, true>},
        {&gather<Real, 1, false>, &gather<Real, 2, false>, &gather<Real, 3, false>},
        {&react<Real, 1>, &react<Real, 2>, &react<Real, 3>},
        &place_rotor<Real>,
        &gather_rotor<Real, true>,
        &gather_rotor<Real, false>,
        &rotate<Real>};
    if constexpr (std::is_same_v<Real, double>) {
      for (int d = 0; d < 3; ++d) table.place_lanes[d] = kPlaceLanes[d];
      for (int d = 0; d < 3; ++d) table.gather_lanes[d] = kGatherLanes[d];
    }
    return table;
  }

 private:
  static constexpr Kernel<double> kPlaceLanes[] = {&place_lanes<1>, &place_lanes<2>,
                                                   &place_lanes<3>};
  static constexpr Kernel<double> kGatherLanes[] = {&gather_lanes<1>, &gather_lanes<2>,
                                                    &gather_lanes<3>};
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
