#pragma once

#include "framework/core/system.hpp"
#include "framework/core/target.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

/// All forces of a system at one stage.
template <class Real>
TOMLIN_INLINE void evaluate(const SystemView<Real>& system, const Stage<Real>& stage) {
  for (std::size_t k = 0; k < system.operation_count; ++k) {
    system.operations[k].run(system.operations[k].arguments, stage);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
