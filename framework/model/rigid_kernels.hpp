#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/elements/lane_kernels.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/stage.hpp"

namespace tomlin {

/// A body that moves as one. Its coordinates are the centre and, in the plane, the rotation in
/// turns; the rotation is counter-clockwise positive.
template <class Real>
struct RigidArguments {
  BodySlot<Real> body;
  const Real* reference = nullptr;  ///< particles about the centre, unrotated: [axis * stride + i]
  Real* arm = nullptr;              ///< the same, rotated; written by `place`, read by `gather`
  bool velocities = false;          ///< some force reads the particles' velocities
  /// Of a prescribed body: where its coordinates and velocities stand; null for a rigid body, whose
  /// coordinates are part of the state.
  const Real* coordinates = nullptr;
  const Real* speeds = nullptr;
  std::ptrdiff_t rate = kNoRate;  ///< where the force and the power of a prescribed body go
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
        {&react<Real, 1>, &react<Real, 2>, &react<Real, 3>}};
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
