#pragma once

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// Registers every integrator of this folder.
void register_integrators(Registry& registry);

}  // namespace tomlin
