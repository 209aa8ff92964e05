#include "framework/model/switched_force.hpp"

#include <limits>

#include "framework/core/numbers/quad.hpp"

namespace tomlin {

template <class Real>
SwitchedForce<Real>::SwitchedForce(std::unique_ptr<BoundForce<Real>> force, double from,
                                   std::optional<double> until)
    : force_(std::move(force)), from_(from), until_(until) {
  auto* const end = dynamic_cast<PulledEnd*>(force_.get());
  if (end != nullptr && from_ > 0.0) end->rests_at_first();
}

template <class Real>
double SwitchedForce<Real>::next_switch() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (control_ == nullptr || is_over()) return kNever;
  return is_active() ? until_.value_or(kNever) : from_;
}

template <class Real>
void SwitchedForce<Real>::switch_over() {
  control_[kPhase] = is_active() ? kOver : kActive;
}

template <class Real>
std::vector<Pass<Real>> SwitchedForce<Real>::passes() {
  std::vector<Pass<Real>> all = force_->passes();
  for (Pass<Real>& pass : all) {
    const Gate& own = gate(pass.add, pass.arguments);
    // A closed gate writes nothing, not even zeros: another kernel has to set.
    pass.set = nullptr;
    pass.add = &run_gate;
    pass.arguments = &own;
    pass.lanes = {};
  }
  return all;
}

template <class Real>
void SwitchedForce<Real>::place_rates(std::ptrdiff_t first) {
  first_rate_ = first;
  force_->place_rates(first);
}

template <class Real>
void SwitchedForce<Real>::place_own(std::size_t first) {
  first_own_ = first;
  force_->place_own(first);
}

template <class Real>
Real SwitchedForce<Real>::energy(const Stage<Real>& stage) const {
  const bool counts = is_active() || as_operator_;
  const Real zero = control_ == nullptr ? Real(0.0) : Real(control_[kZero]);
  return counts ? zero + force_->energy(stage) : zero;
}

template <class Real>
bool SwitchedForce<Real>::heat(std::ptrdiff_t rate, Operation<Real>& operation) {
  if (!force_->heat(rate, operation)) return false;
  gates_.push_back({this,
                    operation.run,
                    operation.arguments,
                    {{static_cast<std::size_t>(rate), std::size_t{1}}}});
  operation = {&run_gate, &gates_.back()};
  return true;
}

template <class Real>
bool SwitchedForce<Real>::flow(Flow<Real>& flow) {
  if (!force_->flow(flow)) return false;
  flow = gated(flow);
  return true;
}

template <class Real>
Flow<Real> SwitchedForce<Real>::gated(const Flow<Real>& flow) {
  flows_.push_back({this, flow});
  return {&run_flow, flow.drag == nullptr ? nullptr : &run_drag, &flows_.back(), flow.key};
}

template <class Real>
void SwitchedForce<Real>::attach_control(double* control) {
  control_ = control;
  if (force_->control_count() > 0) force_->attach_control(control + kCount);
}

template <class Real>
void SwitchedForce<Real>::start_control() {
  force_->start_control();
  if (control_ == nullptr) return;
  control_[kPhase] = from_ > 0.0 ? kBefore : kActive;
  control_[kZero] = 0.0;
}

template <class Real>
void SwitchedForce<Real>::run_gate(const void* gate, const Stage<Real>& stage) {
  const auto& own = *static_cast<const Gate*>(gate);
  if (own.force->is_active()) {
    own.run(own.arguments, stage);
    return;
  }
  for (const auto& [first, count] : own.rates) {
    for (std::size_t k = first; k < first + count; ++k) stage.rates[k] = Real(0.0);
  }
}

template <class Real>
Real SwitchedForce<Real>::run_flow(const void* gated, const FlowStage<Real>& stage, Real h) {
  const auto& own = *static_cast<const GatedFlow*>(gated);
  return own.force->is_active() ? own.flow.run(own.flow.arguments, stage, h) : Real(0.0);
}

template <class Real>
Real SwitchedForce<Real>::run_drag(const void* gated, const Stage<Real>& stage) {
  const auto& own = *static_cast<const GatedFlow*>(gated);
  if (own.force->is_active()) return own.flow.drag(own.flow.arguments, stage);
  for (std::size_t k = 0; k < own.force->own_count(); ++k) {
    stage.rates[own.force->first_own_ + k] = Real(0.0);
  }
  return Real(0.0);
}

/// Returns the same gate for the same kernel and arguments, by which passes are identified.
template <class Real>
auto SwitchedForce<Real>::gate(Kernel<Real> run, const void* arguments) -> const Gate& {
  for (const Gate& known : gates_) {
    if (known.run == run && known.arguments == arguments) return known;
  }
  Gate& added = gates_.emplace_back();
  added.force = this;
  added.run = run;
  added.arguments = arguments;
  if (force_->rate_count() > 0) {
    added.rates.emplace_back(static_cast<std::size_t>(first_rate_), force_->rate_count());
  }
  if (force_->own_count() > 0) added.rates.emplace_back(first_own_, force_->own_count());
  return added;
}

template class SwitchedForce<double>;
template class SwitchedForce<Quad>;

}  // namespace tomlin
