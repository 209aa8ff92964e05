#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/rotation_vector.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/model/assembly.hpp"

namespace tomlin {

/// Velocities of all rigid bodies' particles, which a model places only where a force says that it
/// reads them: one that reads them in secret must not find the same zeros each time.
template <class Real>
void place_velocities(const std::vector<typename Assembly<Real>::Body>& bodies, int dimension,
                      const Real* position, const Real* velocity, Real* mapped_velocity) {
  for (const auto& body : bodies) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (!slot.rigid) continue;
    Real* const placed = mapped_velocity + slot.offset;
    for (int d = 0; d < dimension; ++d) {
      std::fill_n(placed + d * slot.stride, slot.count, velocity[slot.centre + d]);
    }
    if (body.rotor) {
      const RigidArguments<Real>& a = *body.rigid;
      const Real* p = position + slot.centre + 3;
      const Real* u = velocity + slot.centre + 3;
      const Vec<Real, 3> here = {{p[0], p[1], p[2]}};
      const Vec<Real, 3> w = angular_velocity<Real>(here, {{u[0], u[1], u[2]}});
      Real m[9];
      rotate_axes(a.axes, here, m);
      const auto turned = [&m](const Vec<Real, 3>& x) {
        Vec<Real, 3> y;
        for (int d = 0; d < 3; ++d)
          y[d] = m[3 * d] * x[0] + m[3 * d + 1] * x[1] + m[3 * d + 2] * x[2];
        return y;
      };
      for (std::size_t i = 0; i < slot.count; ++i) {
        const Vec<Real, 3> arm = {
            {a.reference[i], a.reference[slot.stride + i], a.reference[2 * slot.stride + i]}};
        const Vec<Real, 3> turning = cross(turned(w), turned(arm));
        for (int d = 0; d < 3; ++d) {
          Real& speed = placed[static_cast<std::size_t>(d) * slot.stride + i];
          speed = speed + turning[d];
        }
      }
    }
    if (dimension != 2) continue;
    Real sine;
    Real cosine;
    sincos_turns(position[slot.centre + kRotation], sine, cosine);
    const Real omega = tau<Real>() * velocity[slot.centre + kRotation];
    for (std::size_t i = 0; i < slot.count; ++i) {
      const Real x(body.arms[i][0]);
      const Real y(body.arms[i][1]);
      placed[i] = placed[i] - omega * (sine * x + cosine * y);
      placed[slot.stride + i] = placed[slot.stride + i] + omega * (cosine * x - sine * y);
    }
  }
}

/// Rotors do not spin where forces are verified: their coordinates of rotation are not varied, and
/// power is that of what is.
template <class Real>
void stop_rotors(const std::vector<typename Assembly<Real>::Body>& bodies, Real* velocity) {
  for (const auto& body : bodies) {
    if (body.rotor) std::fill_n(velocity + body.bound.slot.centre + 3, 3, Real(0.0));
  }
}

/// A scene of one force, bound once more: in another number type, on another instruction set, or
/// to be treated as no model is (a new origin, foreign numbers in the arrays). Coordinates stand
/// where the model has them.
template <class Real>
class ForceTwin {
 public:
  /// Throws InputError as binding does; the force must have been bound in `Real` at all.
  explicit ForceTwin(const AssemblyPlan& plan) : origin_(plan.origin), assembly_(plan) {
    StateLayout layout;
    assembly_.declare_controls(layout);
    controls_ = RunState(layout);
    assembly_.attach_controls(controls_);
    const SystemView<Real>& view = assembly_.system().view;
    heat_rate_ = view.rates;
    // Kernels may read a group past the end.
    for (auto* numbers : {&position_, &velocity_}) {
      numbers->assign(view.dofs + 2 * kGroup, Real(0.0));
    }
    for (auto* numbers : {&integrals_, &rates_}) {
      numbers->assign(view.rates + 3 * kGroup, Real(0.0));
    }
    assembly_.start(position_.data(), velocity_.data(), integrals_.data(), nullptr);
    stop_rotors<Real>(assembly_.bodies(), velocity_.data());
    assembly_.start_controls();
    assembly_.rebase(origin_);
    has_heat_ = force().heat(static_cast<std::ptrdiff_t>(heat_rate_), heat_);
  }

  const SystemView<Real>& view() const { return assembly_.system().view; }
  const typename Assembly<Real>::Force& force() const { return assembly_.forces().front(); }
  const typename Assembly<Real>::Body& body(std::size_t b) const { return assembly_.bodies()[b]; }
  const Origin& origin() const { return origin_; }

  Real& position(std::size_t at) { return position_[at]; }
  Real& velocity(std::size_t at) { return velocity_[at]; }
  Real& own(std::size_t k) { return integrals_[k]; }
  Real rate(std::size_t k) const { return rates_[k]; }
  Real force_at(std::size_t at) const { return view().force[at]; }

  /// Positions are the caller's to shift.
  void rebase(const Origin& origin) {
    origin_ = origin;
    assembly_.rebase(origin);
  }

  /// Forces and rates at the present numbers, `elapsed` after the start of a step.
  void evaluate(double start_of_step, double elapsed = 0.0) {
    assembly_.begin_step(DoubleDouble(start_of_step));
    elapsed_ = elapsed;
    place_velocities(assembly_.bodies(), assembly_.dimension(), position_.data(), velocity_.data(),
                     view().mapped_velocity);
    const Stage<Real> here = stage();
    for (std::size_t k = 0; k < view().operation_count; ++k) {
      view().operations[k].run(view().operations[k].arguments, here);
    }
  }
  /// After evaluate(): rigid bodies place their particles in it.
  Real energy() const { return force().bound->energy(stage()); }
  /// The power that the force takes out, by its own kernel; none without one.
  std::optional<Real> heat() {
    if (!has_heat_) return std::nullopt;
    heat_.run(heat_.arguments, stage());
    return rates_[heat_rate_];
  }
  Stage<Real> stage() const {
    return stage_of(view(), position_.data(), velocity_.data(), integrals_.data(), rates_.data(),
                    Real(elapsed_));
  }

 private:
  Origin origin_;
  Assembly<Real> assembly_;
  RunState controls_;
  AlignedVector<Real> position_, velocity_, integrals_;
  mutable AlignedVector<Real> rates_;
  Operation<Real> heat_;
  std::size_t heat_rate_ = 0;
  double elapsed_ = 0.0;
  bool has_heat_ = false;
};

}  // namespace tomlin
