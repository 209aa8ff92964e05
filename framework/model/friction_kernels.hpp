#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/normal_numbers.hpp"
#include "framework/core/numbers/number_types.hpp"
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
///
/// The normal numbers of particles are those of {step, part} (normal_numbers.hpp), one for each
/// axis and particle. A single particle, which would leave most of them unused, takes those of
/// {step / n, part} for n steps, one after the other: n = 16 on a line, else 8.
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
  // A single particle has numbers that several steps share; for each part of a step.
  std::size_t together = 1;  ///< so many steps: kGroup, or twice that
  Real* drawn = nullptr;     ///< scratch: [part][kMostDrawn]
  std::uint64_t* drawn_for = nullptr;
};

/// Number of flows of a step, each of which draws its own noise.
inline constexpr std::size_t kNoiseParts = 2;
/// Numbers of three axes, eight steps of each.
inline constexpr std::size_t kMostDrawn = 3 * kGroup;

/// The friction of a body in lanes (lanes.hpp). The rows are the body's coordinates, row r of
/// replica w stands at [r * width + w].
struct FrictionLanes {
  std::size_t width = 0;
  std::size_t first = 0;  ///< of its rows among all coordinates
  std::size_t rows = 0;
  bool noisy = false;
  std::size_t together = 1;                               ///< as in FrictionArguments
  const FrictionArguments<double>* const* run = nullptr;  ///< of each replica
  // These follow from the above for replicas that are new.
  bool* any_new = nullptr;
  unsigned char* is_new = nullptr;  ///< of each replica
  std::uint64_t* ahead = nullptr;   ///< where it is new: its step; then by how much that is ahead
  double* keep = nullptr;
  double* loss = nullptr;
  double* spread = nullptr;
  /// Numbers of steps: [part][step modulo together + 1][row], so that the last step's remain.
  double* normals = nullptr;
  std::uint64_t* next = nullptr;  ///< [part][replica]: the step that has none yet
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
  // Functions of operators, see flow.hpp.
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
  // Functions over replicas, in double precision.
  Real (*particles_in_lanes)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  Real (*body_in_lanes)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  void (*fill_in_lanes)(const void* arguments, const RandomKey& key, std::uint64_t step,
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
      Real residual = f[2];
      for (int d = 0; d < 2; ++d) {
        if (!a.free[d]) continue;
        const Real share = coupling[d] / a.total;
        pivot = fnma(share, coupling[d], pivot);
        residual = fnma(share, f[d], residual);
      }
      u[2] = residual / pivot;
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
      constexpr int kTerms = sizeof(Real) == sizeof(double) ? 16 : 30;
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
  TOMLIN_INLINE static void decay(Real* v, std::size_t i, const Packed<Real>& keep,
                                  const Packed<Real>& loss) {
    using Group = Packed<Real>;
    const Group kept = keep * Group::load(v + i);
    fma(loss, kept, kept).store(v + i);
  }

  /// Kinetic energy that coordinates have lost, of the numbers as they were and are.
  template <class T>
  TOMLIN_INLINE static T lost(const T& mass, const T& before, const T& after) {
    return T(Scalar<T>(0.5)) * mass * (before - after) * (before + after);
  }

  /// Computes the part of velocities kept over h, and the size of their noise, unless it is known.
  template <class Real>
  TOMLIN_INLINE static void know(const FrictionArguments<Real>& a, Real h, bool midpoint) {
    if (*a.known_h == h) return;
    for (std::size_t i = 0; i < a.length; ++i) {
      const Decay<Real> decay(a.coefficient[i] * a.inverse_mass[i], h, midpoint);
      a.keep[i] = decay.keep;
      a.loss[i] = decay.loss;
      if (a.temperature == nullptr) continue;
      a.spread[i] = decay.spread() * sqrt(a.temperature[i] * a.inverse_mass[i]);
    }
    *a.known_h = h;
  }

  /// Index of the numbers that this step of a single particle shares with others.
  template <class Real>
  TOMLIN_INLINE static std::uint64_t shared_block(const FrictionArguments<Real>& a,
                                                  std::uint64_t step) {
    return a.together == kGroup ? step / kGroup : step / (2 * kGroup);
  }

  /// Returns the numbers that this step of a single particle shares, axis d of the first step at
  /// [d * kGroup].
  template <class Real>
  TOMLIN_INLINE static const Real* drawn_with(const FrictionArguments<Real>& a,
                                              const RandomKey& key, std::uint64_t step,
                                              std::uint64_t part) {
    Real* const drawn = a.drawn + part * kMostDrawn;
    const std::uint64_t block = shared_block(a, step);
    if (a.drawn_for[part] != block) {
      a.drawn_for[part] = block;
      fill_normals(key, {block, part, 0, 0}, std::max<std::size_t>(a.length, 2 * kGroup), kGroup,
                   drawn);
    }
    return drawn;
  }

  /// The numbers of a step, in the order of the particles' arrays.
  template <class Real>
  TOMLIN_INLINE static void draw(const FrictionArguments<Real>& a, const RandomKey& key,
                                 std::uint64_t step, std::uint64_t part, Real* numbers) {
    if (a.together == 1) {
      fill_normals(key, {step, part, 0, 0}, a.length, a.body.count, numbers);
      return;
    }
    const Real* const drawn = drawn_with(a, key, step, part) + (step & (a.together - 1));
    for (std::size_t at = 0; at < a.length; at += kGroup) numbers[at] = drawn[at];
  }

  /// v <- v exp(-h c/m), and noise.
  template <class Real>
  TOMLIN_FLATTEN static Real flow_of_particles(const void* arguments, const FlowStage<Real>& stage,
                                               Real h) {
    using Group = Packed<Real>;
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = stage.velocity + a.body.offset;
    const bool heats = stage.heat;
    know(a, h, stage.midpoint);
    if (a.temperature != nullptr) draw(a, stage.key, stage.step, stage.part, a.normals);
    const Group none(Real(0.0));
    Group heat = none;
    for (std::size_t i = 0; i < a.length; i += kGroup) {
      const Group before = Group::load(v + i);
      decay(v, i, Group::load(a.keep + i), Group::load(a.loss + i));
      if (a.temperature != nullptr) {
        fma(Group::load(a.spread + i), Group::load(a.normals + i), Group::load(v + i)).store(v + i);
      }
      if (!heats) continue;
      // A held coordinate has no inverse mass, and loses nothing.
      const Group inverse = Group::load(a.inverse_mass + i);
      const Group mass = Group(Real(1.0)) / select(none < inverse, inverse, Group(Real(1.0)));
      heat += lost(mass, before, Group::load(v + i));
    }
    return heats ? sum(heat) : Real(0.0);
  }

  /// A body moves freely but for friction, its rotation at rest. With S = 0 each axis decays alone.
  /// Else, along the free part q of the coupling between centre and rotation, in coordinates
  /// sqrt(M) u_q and sqrt(I) w, friction is a symmetric matrix (a b, b d) with two modes, each with
  /// noise of its own.
  template <class Real>
  TOMLIN_FLATTEN static Real flow_of_body(const void* arguments, const FlowStage<Real>& stage,
                                          Real h) {
    const FrictionArguments<Real> a = *static_cast<const FrictionArguments<Real>*>(arguments);
    Real* v = stage.velocity + a.body.centre;
    const Real before[3] = {v[0], v[1], v[2]};
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
      for (int k = 0; k < 3; ++k) v[k] = v[k] + change[k];
    } else {
      const Decay<Real> turning(a.rotates ? a.second / a.inertia : Real(0.0), h, stage.midpoint);
      decay(v, 0, three_lanes(centre.keep, centre.keep, planar ? turning.keep : centre.keep),
            three_lanes(centre.loss, centre.loss, planar ? turning.loss : centre.loss));
      if (noisy) {
        const Real along = speed * centre.spread();
        const Real turn = a.rotates ? sqrt(a.bath / a.inertia) * turning.spread() : Real(0.0);
        const Real third = planar ? turn : a.free[2] ? along : Real(0.0);
        const Real noise[3] = {a.free[0] ? along * z[0] : Real(0.0),
                               a.free[1] ? along * z[1] : Real(0.0), third * z[2]};
        for (int k = 0; k < 3; ++k) v[k] = v[k] + noise[k];
      }
    }
    Real heat(0.0);
    if (!stage.heat) return heat;
    for (int k = 0; k < 3; ++k) {
      heat += lost(planar && k == 2 ? a.inertia : a.mass, before[k], v[k]);
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
    if (a.body.rigid) {
      fill_normals(key, {step, 0, 0, 0}, kGroup, 3, numbers + a.body.centre);
    } else {
      draw(a, key, step, 0, numbers + a.body.offset);
    }
  }

  // ---- in lanes

  /// Index of a row in the particles' arrays of one run.
  TOMLIN_INLINE static std::size_t at_row(const FrictionArguments<double>& a, std::size_t row) {
    return row / a.body.count * a.body.stride + row % a.body.count;
  }

  /// Replicas that are new begin with this step. With friction, over h.
  TOMLIN_INLINE static void take_new(const FrictionLanes& l, std::uint64_t step, double h,
                                     bool midpoint) {
    if (!*l.any_new) return;
    for (std::size_t w = 0; w < l.width; ++w) {
      if (l.is_new[w] == 0) continue;
      l.is_new[w] = 0;
      l.ahead[w] -= step;
      for (std::size_t part = 0; part < kNoiseParts; ++part) l.next[part * l.width + w] = 0;
      if (!(h > 0.0)) continue;
      const FrictionArguments<double>& a = *l.run[w];
      know(a, h, midpoint);
      for (std::size_t r = 0; r < l.rows; ++r) {
        l.keep[r * l.width + w] = a.keep[at_row(a, r)];
        l.loss[r * l.width + w] = a.loss[at_row(a, r)];
        if (l.noisy) l.spread[r * l.width + w] = a.spread[at_row(a, r)];
      }
    }
    *l.any_new = false;
  }

  /// Numbers of replica w, which stands at step `own`, from there on; the first are put at index
  /// `at`. Returns of how many steps.
  TOMLIN_INLINE static std::size_t draw_one(const FrictionLanes& l, std::size_t w,
                                            std::uint64_t own, std::uint64_t part, std::size_t at,
                                            double* normals) {
    const FrictionArguments<double>& a = *l.run[w];
    const std::size_t length = l.rows * l.width;
    if (l.together == 1) {
      draw(a, a.key, own, part, a.normals);
      double* const to = normals + at * length + w;
      for (std::size_t r = 0; r < l.rows; ++r) to[r * l.width] = a.normals[at_row(a, r)];
      return 1;
    }
    const double* const drawn = drawn_with(a, a.key, own, part);
    const std::size_t from = own & (l.together - 1);
    for (std::size_t k = from; k < l.together; ++k) {
      double* const to = normals + at * length + w;
      for (std::size_t r = 0; r < l.rows; ++r) to[r * l.width] = drawn[r * kGroup + k];
      at = at < l.together ? at + 1 : 0;
    }
    return l.together - from;
  }

  /// Works like drawn_with() for single particles on a line or in the plane, eight of them at once:
  /// the scalar work of all first, whose latencies hide each other, then that of vectors.
  TOMLIN_INLINE static void prepare(const FrictionLanes& l, std::uint64_t step, std::uint64_t part,
                                    const std::uint64_t* next) {
    for (std::size_t from = 0; from < l.width; from += kGroup) {
      double* drawn[kGroup];
      std::size_t count = 0;
      for (std::size_t w = from; w < from + kGroup; ++w) {
        const FrictionArguments<double>& a = *l.run[w];
        const std::uint64_t block = shared_block(a, step + l.ahead[w]);
        if (next[w] > step || a.drawn_for[part] == block) continue;
        double* const to = a.drawn + part * kMostDrawn;
        // Lanes without a run repeat one, which may be at another step: draw_one() sees to it.
        if (std::find(drawn, drawn + count, to) != drawn + count) continue;
        a.drawn_for[part] = block;
        uniform_pairs(a.key, {block, part, 0, 0}, kGroup, to, to + kGroup);
        drawn[count++] = to;
      }
      for (std::size_t k = 0; k < count; ++k) {
        Pack z;
        Pack other;
        box_muller(drawn[k], drawn[k] + kGroup, z, other);
        z.store(drawn[k]);
        other.store(drawn[k] + kGroup);
      }
    }
  }

  /// The numbers of a step, [row][replica].
  TOMLIN_INLINE static const double* draw_in_lanes(const FrictionLanes& l, std::uint64_t step,
                                                   std::uint64_t part) {
    const std::size_t kept = l.together + 1;
    const std::size_t at = step % kept;
    std::uint64_t* const next = l.next + part * l.width;
    double* const normals = l.normals + part * kept * l.rows * l.width;
    bool needed = false;
    for (std::size_t w = 0; w < l.width; ++w) needed |= next[w] <= step;
    if (needed && l.together > 1 && l.rows <= 2) prepare(l, step, part, next);
    for (std::size_t w = 0; needed && w < l.width; ++w) {
      if (next[w] > step) continue;
      next[w] = step + draw_one(l, w, step + l.ahead[w], part, at, normals);
    }
    return normals + at * l.rows * l.width;
  }

  TOMLIN_FLATTEN static double particles_in_lanes(const void* arguments,
                                                  const FlowStage<double>& stage, double h) {
    const FrictionLanes l = *static_cast<const FrictionLanes*>(arguments);
    take_new(l, stage.step, h, stage.midpoint);
    const double* const normals = l.noisy ? draw_in_lanes(l, stage.step, stage.part) : nullptr;
    double* const v = stage.velocity + l.first * l.width;
    for (std::size_t i = 0; i < l.rows * l.width; i += kGroup) {
      decay<double>(v, i, Pack::load(l.keep + i), Pack::load(l.loss + i));
      if (normals == nullptr) continue;
      fma(Pack::load(l.spread + i), Pack::load(normals + i), Pack::load(v + i)).store(v + i);
    }
    return 0.0;
  }

  /// One after the other, as each is alone.
  TOMLIN_FLATTEN static double body_in_lanes(const void* arguments, const FlowStage<double>& stage,
                                             double h) {
    const FrictionLanes l = *static_cast<const FrictionLanes*>(arguments);
    take_new(l, stage.step, 0.0, false);
    for (std::size_t w = 0; w < l.width; ++w) {
      FrictionArguments<double> a = *l.run[w];
      a.body.centre = 0;
      alignas(64) double position[kGroup] = {};
      alignas(64) double velocity[kGroup] = {};
      for (std::size_t r = 0; r < l.rows; ++r) {
        position[r] = stage.position[(l.first + r) * l.width + w];
        velocity[r] = stage.velocity[(l.first + r) * l.width + w];
      }
      FlowStage<double> one = stage;
      one.position = position;
      one.velocity = velocity;
      one.key = a.key;
      one.step = stage.step + l.ahead[w];
      flow_of_body<double>(&a, one, h);
      for (std::size_t r = 0; r < l.rows; ++r) {
        stage.velocity[(l.first + r) * l.width + w] = velocity[r];
      }
    }
    return 0.0;
  }

  TOMLIN_FLATTEN static void fill_in_lanes(const void* arguments, const RandomKey&,
                                           std::uint64_t step, double* numbers) {
    const FrictionLanes l = *static_cast<const FrictionLanes*>(arguments);
    take_new(l, step, 0.0, false);
    const double* const normals = draw_in_lanes(l, step, 0);
    std::copy(normals, normals + l.rows * l.width, numbers + l.first * l.width);
  }

  template <class Real>
  static constexpr FrictionTable<Real> kernels() {
    FrictionTable<Real> table = {&flow_of_particles<Real>,
                                 &flow_of_body<Real>,
                                 &drag_of_particles<Real>,
                                 &drag_of_body<Real>,
                                 &mobility<Real>,
                                 &drift_heat<Real>,
                                 &fill<Real>};
    if constexpr (std::is_same_v<Real, double>) {
      table.particles_in_lanes = &particles_in_lanes;
      table.body_in_lanes = &body_in_lanes;
      table.fill_in_lanes = &fill_in_lanes;
    }
    return table;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
