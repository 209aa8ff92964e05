#pragma once

#include "framework/core/text/fault.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// A failure as a message with its position in the scene: at the key of the integrator that it
/// names, "dt" or "most_steps", where it names one; else the scene as a whole.
Fault fault_of(const RunFailure& failure, const Scene& scene);

}  // namespace tomlin
