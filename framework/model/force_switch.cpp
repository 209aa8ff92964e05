#include "framework/model/force_switch.hpp"

#include <limits>

#include "framework/core/numbers/quad.hpp"

namespace tomlin {

template <class Real>
ForceSwitch<Real>::ForceSwitch(BoundForce<Real>& force, double from, std::optional<double> until)
    : force_(force), from_(from), until_(until) {
  auto* const end = dynamic_cast<PulledEnd*>(&force);
  if (end != nullptr && from_ > 0.0) end->rests_at_first();
}

template <class Real>
double ForceSwitch<Real>::next_switch() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (control_ == nullptr || is_over()) return kNever;
  return is_active() ? until_.value_or(kNever) : from_;
}

template <class Real>
void ForceSwitch<Real>::switch_over() {
  control_[kPhase] = is_active() ? kOver : kActive;
}

template <class Real>
std::vector<Pass<Real>> ForceSwitch<Real>::gated(std::vector<Pass<Real>> passes) {
  for (Pass<Real>& pass : passes) {
    const Gate& own = gate(pass.add, pass.arguments);
    // A closed gate writes nothing, not even zeros: another kernel has to set.
    pass.set = nullptr;
    pass.add = &run_gate;
    pass.arguments = &own;
    pass.lanes = {};
    pass.point = {};
  }
  return passes;
}

template <class Real>
Operation<Real> ForceSwitch<Real>::gated(const Operation<Real>& heat, std::size_t rate) {
  gates_.push_back({this, heat.run, heat.arguments, {{rate, 1}}});
  return {&run_gate, &gates_.back()};
}

template <class Real>
Flow<Real> ForceSwitch<Real>::gated(const Flow<Real>& flow) {
  flows_.push_back({this, flow});
  return {&run_flow, flow.drag == nullptr ? nullptr : &run_drag, &flows_.back(), flow.key};
}

template <class Real>
Real ForceSwitch<Real>::energy(const Stage<Real>& stage) const {
  const bool counts = is_active() || as_operator_;
  const Real zero = control_ == nullptr ? Real(0.0) : Real(control_[kZero]);
  return counts ? zero + force_.energy(stage) : zero;
}

template <class Real>
void ForceSwitch<Real>::start_control() {
  if (control_ == nullptr) return;
  control_[kPhase] = from_ > 0.0 ? kBefore : kActive;
  control_[kZero] = 0.0;
}

template <class Real>
void ForceSwitch<Real>::Range::clear(Real* numbers) const {
  for (std::size_t k = first; k < first + count; ++k) numbers[k] = Real(0.0);
}

template <class Real>
void ForceSwitch<Real>::run_gate(const void* gate, const Stage<Real>& stage) {
  const auto& own = *static_cast<const Gate*>(gate);
  if (own.force->is_active()) {
    own.run(own.arguments, stage);
    return;
  }
  for (const Range& range : own.rates) range.clear(stage.rates);
}

template <class Real>
Real ForceSwitch<Real>::run_flow(const void* gated, const FlowStage<Real>& stage, Real h) {
  const auto& own = *static_cast<const GatedFlow*>(gated);
  return own.force->is_active() ? own.flow.run(own.flow.arguments, stage, h) : Real(0.0);
}

template <class Real>
Real ForceSwitch<Real>::run_drag(const void* gated, const Stage<Real>& stage) {
  const auto& own = *static_cast<const GatedFlow*>(gated);
  if (own.force->is_active()) return own.flow.drag(own.flow.arguments, stage);
  own.force->own_.clear(stage.rates);
  return Real(0.0);
}

/// Returns the same gate for the same kernel and arguments, by which passes are identified.
template <class Real>
auto ForceSwitch<Real>::gate(Kernel<Real> run, const void* arguments) -> const Gate& {
  for (const Gate& known : gates_) {
    if (known.run == run && known.arguments == arguments) return known;
  }
  return gates_.emplace_back(Gate{this, run, arguments, {rates_, own_}});
}

template class ForceSwitch<double>;
template class ForceSwitch<Quad>;

}  // namespace tomlin
