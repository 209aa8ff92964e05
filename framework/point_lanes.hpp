#pragma once

#include "framework/core/system/lane_block.hpp"

namespace tomlin {

// See IntegratorRecord::lane_block.
LaneBlock rk4_block_of(const System<double>& run, std::span<const Kernel<double>> forces);
LaneBlock midpoint_block_of(const System<double>& run, std::span<const Kernel<double>> forces);

}  // namespace tomlin
