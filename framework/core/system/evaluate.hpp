#pragma once

#include "framework/core/numbers/target.hpp"
#include "framework/core/system/system.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

/// All forces of a system at one stage.
template <class Real>
TOMLIN_INLINE void evaluate(const SystemView<Real>& system, const Stage<Real>& stage) {
  for (std::size_t k = 0; k < system.operation_count; ++k) {
    system.operations[k].run(system.operations[k].arguments, stage);
  }
}

/// All operators over a time, one after the other. Returns their heat.
template <class Real>
TOMLIN_INLINE Real apply_flows(const SystemView<Real>& system, FlowStage<Real> stage, Real h,
                               bool backwards) {
  Real heat(0.0);
  for (std::size_t k = 0; k < system.flow_count; ++k) {
    const Flow<Real>& flow = system.flows[backwards ? system.flow_count - 1 - k : k];
    stage.key = flow.key;
    heat = heat + flow.run(flow.arguments, stage, h);
  }
  return heat;
}

/// The operators as forces, added to those of a stage. Returns the power that they take.
template <class Real>
TOMLIN_INLINE Real add_drags(const SystemView<Real>& system, const Stage<Real>& stage) {
  Real power(0.0);
  for (std::size_t k = 0; k < system.flow_count; ++k) {
    const Flow<Real>& flow = system.flows[k];
    if (flow.drag != nullptr) power = power + flow.drag(flow.arguments, stage);
  }
  return power;
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
