#pragma once

#include "framework/core/records/integrator.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

/// Finds where and why a step failed: the coordinate that moves furthest (or is NaN), the force
/// that acts most strongly on it, and the likely cause. The state is that before the step.
RunFailure diagnose(Model& model, const IntegratorRecord& scheme, StepFault fault,
                    std::uint64_t step, const DoubleDouble& time, double h, double stable_step);

}  // namespace tomlin
