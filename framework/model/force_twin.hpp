#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>

#include "framework/core/aligned.hpp"
#include "framework/core/state_layout.hpp"
#include "framework/model/assembly.hpp"

namespace tomlin {

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
    controls_ = RunState(layout, 1);
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
    assembly_.start_controls();
    assembly_.rebase(origin_);
    has_heat_ = bound().heat(static_cast<std::ptrdiff_t>(heat_rate_), heat_);
  }

  const SystemView<Real>& view() const { return assembly_.system().view; }
  BoundForce<Real>& bound() const { return *assembly_.forces().front().bound; }
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
    const Stage<Real> here = stage();
    for (std::size_t k = 0; k < view().operation_count; ++k) {
      view().operations[k].run(view().operations[k].arguments, here);
    }
  }
  /// After evaluate(): rigid bodies place their particles in it.
  Real energy() const { return bound().energy(stage()); }
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
