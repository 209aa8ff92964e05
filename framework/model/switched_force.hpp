#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/pulled_end.hpp"

namespace tomlin {

/// A force or an operator that is active from a time on, until another one, `active = { from,
/// until }`; before and after it does nothing. Its own variables stay what they are meanwhile.
///
/// Its potential energy is counted from what it is when it becomes active, and stays what it was
/// when it ceases to be: energy(t) is continuous, so that switching is no work, and the energy
/// ledger closes. Curvatures and the Hessian are those of the active force: a step that is stable
/// is so at all times.
template <class Real>
class SwitchedForce final : public BoundForce<Real> {
 public:
  /// Without `until` it stays active.
  SwitchedForce(std::unique_ptr<BoundForce<Real>> force, double from, std::optional<double> until);

  BoundForce<Real>& inner() { return *force_; }

  /// When it becomes active, or ceases to be, the next time; infinite: never.
  double next_switch() const;
  /// It does now.
  void switch_over();
  /// Its energy is larger by this from now on.
  void shift_energy(double by) { control_[kZero] += by; }
  bool is_active() const { return control_ == nullptr || control_[kPhase] == kActive; }
  bool is_over() const { return control_ != nullptr && control_[kPhase] == kOver; }
  /// Returns this flow where the force is active, and none where it is not.
  Flow<Real> gated(const Flow<Real>& flow);
  /// It is taken by its flow alone: what it stores does not change while it is not active.
  void is_taken_as_operator() { as_operator_ = true; }

  std::vector<Pass<Real>> passes() override;
  std::size_t rate_count() const override { return force_->rate_count(); }
  void place_rates(std::ptrdiff_t first) override;
  bool depends_on_time() const override { return force_->depends_on_time(); }
  void begin_step(const DoubleDouble& time) override { force_->begin_step(time); }
  void rebase(const Origin& origin) override { force_->rebase(origin); }
  Real energy(const Stage<Real>& stage) const override;
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    force_->hessian(stage, sink);
  }
  double curvature_bound() const override { return force_->curvature_bound(); }
  double curvature_bound_along(int axis) const override {
    return force_->curvature_bound_along(axis);
  }
  const Drive* drive() const override { return force_->drive(); }
  double shortest_bond() const override { return force_->shortest_bond(); }
  std::string bond_beyond_half_box(const Stage<Real>& stage) const override {
    return force_->bond_beyond_half_box(stage);
  }
  std::string why_not_finite(const Stage<Real>& stage) const override {
    return is_active() ? force_->why_not_finite(stage) : std::string();
  }
  std::string note() const override { return force_->note(); }
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override;
  bool flow(Flow<Real>& flow) override;
  bool is_friction() const override { return force_->is_friction(); }
  void friction(FrictionSink& sink) const override { force_->friction(sink); }
  double friction_bound() const override { return force_->friction_bound(); }
  std::size_t own_count() const override { return force_->own_count(); }
  void place_own(std::size_t first) override;
  void start_own(Real* own) const override { force_->start_own(own); }
  const Passing* waits_for() const override { return force_->waits_for(); }
  std::size_t control_count() const override { return kCount + force_->control_count(); }
  void attach_control(double* control) override;
  void start_control() override;
  bool waits() const override { return is_active() && force_->waits(); }
  void passed(const DoubleDouble& time) override { force_->passed(time); }

 private:
  /// Numbers of the control: whether it is active, and its energy at the last switch, below zero.
  enum { kPhase, kZero, kCount };
  /// Values of kPhase.
  static constexpr double kBefore = 0.0;
  static constexpr double kActive = 1.0;
  static constexpr double kOver = 2.0;

  /// A kernel call of the force, where it is active.
  struct Gate {
    const SwitchedForce* force = nullptr;
    Kernel<Real> run = nullptr;
    const void* arguments = nullptr;
    std::vector<std::pair<std::size_t, std::size_t>> rates;  ///< else zero: first, count
  };
  struct GatedFlow {
    const SwitchedForce* force = nullptr;
    Flow<Real> flow;
  };
  static void run_gate(const void* gate, const Stage<Real>& stage);
  static Real run_flow(const void* gated, const FlowStage<Real>& stage, Real h);
  static Real run_drag(const void* gated, const Stage<Real>& stage);
  const Gate& gate(Kernel<Real> run, const void* arguments);

  std::unique_ptr<BoundForce<Real>> force_;
  double from_;
  std::optional<double> until_;
  double* control_ = nullptr;
  bool as_operator_ = false;
  std::ptrdiff_t first_rate_ = 0;
  std::size_t first_own_ = 0;
  std::deque<Gate> gates_;  // kernels hold pointers into these
  std::deque<GatedFlow> flows_;
};

/// The support of a force that has one, and may be switched; else null.
template <class Real>
PulledEnd* pulled_end_of(BoundForce<Real>* force) {
  if (auto* const switched = dynamic_cast<SwitchedForce<Real>*>(force)) force = &switched->inner();
  return dynamic_cast<PulledEnd*>(force);
}

}  // namespace tomlin
