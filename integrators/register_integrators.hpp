#pragma once

#include "framework/core/records/registry.hpp"
#include "framework/core/system/lane_block.hpp"

namespace tomlin {

/// Schemes that may be compiled together with forces, IntegratorRecord::lane_block.
struct SchemesWithForces {
  LaneBlockFinder rk4 = nullptr;
  LaneBlockFinder midpoint = nullptr;
};

/// Registers every integrator of this folder.
void register_integrators(Registry& registry, const SchemesWithForces& compiled = {});

}  // namespace tomlin
