#pragma once

#include <cstddef>

#include "framework/core/math.hpp"
#include "framework/core/pack.hpp"
#include "framework/core/stage.hpp"

namespace tomlin {

/// A planar rigid body. Its coordinates are the centre x, y and the rotation in turns; the
/// rotation is counter-clockwise positive.
struct RigidArguments {
  BodySlot<double> body;
  const double* reference =
      nullptr;              ///< particles about the centre, unrotated: [axis * stride + i]
  double* arm = nullptr;    ///< the same, rotated; written by `place`, read by `gather`
  bool velocities = false;  ///< some force reads the particles' velocities
};

struct RigidTable {
  Kernel<double> place = nullptr;  ///< coordinates -> particles
  /// Forces on particles -> force and torque (virtual work), set or added to what is there.
  Kernel<double> gather_set = nullptr;
  Kernel<double> gather_add = nullptr;
};

inline namespace TOMLIN_TARGET {

struct RigidKernels {
  static constexpr double kTau = 6.283185307179586476925286766559;

  /// x_i = c + R(phi) r_i,  v_i = c' + omega (-arm_y, arm_x).
  TOMLIN_FLATTEN static void place(const void* arguments, const Stage<double>& stage) {
    const RigidArguments a = *static_cast<const RigidArguments*>(arguments);
    const double* q = stage.position + a.body.centre;
    const double* u = stage.velocity + a.body.centre;
    double sine;
    double cosine;
    sincos_turns(q[2], sine, cosine);
    const Pack s(sine);
    const Pack c(cosine);
    const Pack centre_x(q[0]);
    const Pack centre_y(q[1]);
    const Pack velocity_x(u[0]);
    const Pack velocity_y(u[1]);
    const Pack omega(kTau * u[2]);
    const std::size_t stride = a.body.stride;
    double* x = stage.mapped_position + a.body.offset;
    double* v = stage.mapped_velocity + a.body.offset;
    for (std::size_t i = 0; i < a.body.count; i += kGroup) {
      const Pack rx = Pack::load(a.reference + i);
      const Pack ry = Pack::load(a.reference + stride + i);
      const Pack ax = fma(c, rx, -(s * ry));
      const Pack ay = fma(s, rx, c * ry);
      ax.store(a.arm + i);
      ay.store(a.arm + stride + i);
      (centre_x + ax).store(x + i);
      (centre_y + ay).store(x + stride + i);
      if (a.velocities) {
        fma(-omega, ay, velocity_x).store(v + i);
        fma(omega, ax, velocity_y).store(v + stride + i);
      }
    }
  }

  /// The coordinate counts turns, so its generalised force is 2 pi times the torque.
  template <bool set>
  TOMLIN_FLATTEN static void gather(const void* arguments, const Stage<double>& stage) {
    const RigidArguments a = *static_cast<const RigidArguments*>(arguments);
    const std::size_t stride = a.body.stride;
    const double* f = stage.mapped_force + a.body.offset;
    Pack force_x(0.0);
    Pack force_y(0.0);
    Pack torque(0.0);
    for (std::size_t i = 0; i < a.body.count; i += kGroup) {
      const Pack fx = Pack::load(f + i);
      const Pack fy = Pack::load(f + stride + i);
      force_x += fx;
      force_y += fy;
      torque = fma(Pack::load(a.arm + i), fy, torque);
      torque = fma(-Pack::load(a.arm + stride + i), fx, torque);
    }
    // Written whole: a group stored in parts would stall the load that takes it whole.
    const Pack total = three_lanes(sum(force_x), sum(force_y), kTau * sum(torque));
    double* generalised = stage.force + a.body.centre;
    (set ? total : Pack::load(generalised) + total).store(generalised);
  }

  static constexpr RigidTable kernels() { return {&place, &gather<true>, &gather<false>}; }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
