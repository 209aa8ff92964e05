#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "framework/core/records/bound_force.hpp"

namespace tomlin {

/// The times of a force or an operator that is active from a time on, until another one,
/// `active = { from, until }`; before and after it does nothing. Its own variables stay what they
/// are meanwhile.
///
/// Its potential energy is counted from what it is when it becomes active, and stays what it was
/// when it ceases to be: energy(t) is continuous, so that switching is no work, and the energy
/// ledger closes. Curvatures and the Hessian are those of the active force: a step that is stable
/// is so at all times.
template <class Real>
class ForceSwitch {
 public:
  /// Numbers of its control: whether it is active, and its energy at the last switch, below zero.
  enum { kPhase, kZero, kCount };

  /// Without `until` the force stays active; it outlives the switch.
  ForceSwitch(BoundForce<Real>& force, double from, std::optional<double> until);
  ForceSwitch(const ForceSwitch&) = delete;
  ForceSwitch& operator=(const ForceSwitch&) = delete;

  /// When it becomes active, or ceases to be, the next time; infinite: never.
  double next_switch() const;
  /// It does now.
  void switch_over();
  /// Its energy is larger by this from now on.
  void shift_energy(double by) { control_[kZero] += by; }
  bool is_active() const { return control_ == nullptr || control_[kPhase] == kActive; }
  bool is_over() const { return control_ != nullptr && control_[kPhase] == kOver; }
  /// It is taken by its flow alone: what it stores does not change while it is not active.
  void is_taken_as_operator() { as_operator_ = true; }

  /// Rates of its running integrals and own variables are zero while it is off; these set indices.
  void place_rates(std::size_t first, std::size_t count) { rates_ = {first, count}; }
  void place_own(std::size_t first, std::size_t count) { own_ = {first, count}; }
  void attach_control(double* control) { control_ = control; }
  void start_control();

  // These functions return what the force does while it is active, and nothing at other times.

  std::vector<Pass<Real>> gated(std::vector<Pass<Real>> passes);
  Operation<Real> gated(const Operation<Real>& heat, std::size_t rate);
  Flow<Real> gated(const Flow<Real>& flow);
  Real energy(const Stage<Real>& stage) const;

 private:
  /// Values of kPhase.
  static constexpr double kBefore = 0.0;
  static constexpr double kActive = 1.0;
  static constexpr double kOver = 2.0;

  struct Range {
    std::size_t first = 0;
    std::size_t count = 0;
    void clear(Real* numbers) const;
  };
  /// A kernel call of the force, where it is active.
  struct Gate {
    const ForceSwitch* force = nullptr;
    Kernel<Real> run = nullptr;
    const void* arguments = nullptr;
    std::vector<Range> rates;  ///< else zero
  };
  struct GatedFlow {
    const ForceSwitch* force = nullptr;
    Flow<Real> flow;
  };
  static void run_gate(const void* gate, const Stage<Real>& stage);
  static Real run_flow(const void* gated, const FlowStage<Real>& stage, Real h);
  static Real run_drag(const void* gated, const Stage<Real>& stage);
  const Gate& gate(Kernel<Real> run, const void* arguments);

  BoundForce<Real>& force_;
  double from_;
  std::optional<double> until_;
  double* control_ = nullptr;
  bool as_operator_ = false;
  Range rates_;
  Range own_;
  std::deque<Gate> gates_;  // kernels hold pointers into these
  std::deque<GatedFlow> flows_;
};

}  // namespace tomlin
