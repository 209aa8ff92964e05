#include "framework/point_lanes.hpp"

#include <algorithm>
#include <initializer_list>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/point_lanes_kernels.hpp"

TOMLIN_DECLARE_KERNELS(DrivingSpring)
TOMLIN_DECLARE_KERNELS(SinusoidalSubstrate)
TOMLIN_DECLARE_KERNELS(ViscousDamping)
TOMLIN_DECLARE_DOUBLE_TABLES(PointLanes, PointLanesTable)

namespace tomlin {
namespace {

LaneBlock block_of(const System<double>& run, std::span<const Kernel<double>> forces,
                   const TipBlocks& blocks) {
  // Force and power of the spring; with a ledger those of the damper, too.
  const bool has_heat = forces.size() == 4;
  if (run.view.used_rates != (has_heat ? 4 : 2)) return nullptr;
  const auto on = [&](const KernelTables& tables) -> const LaneKernels& {
    return tables.on<double>(run.set).lanes;
  };
  const Kernel<double> spring = on(kernels::DrivingSpring).centre[0];
  const Kernel<double> damping = on(kernels::ViscousDamping).site[0];
  const Kernel<double> substrate = on(kernels::SinusoidalSubstrate).site[0];
  const auto are = [&](std::initializer_list<Kernel<double>> these) {
    return std::equal(forces.begin(), forces.end(), these.begin(), these.end());
  };
  const Kernel<double> heat = on(kernels::ViscousDamping).heat[0];
  if (are({spring, damping, substrate})) return blocks.spring_first;
  if (are({damping, spring, substrate})) return blocks.damping_first;
  if (are({spring, damping, substrate, heat})) return blocks.spring_first_with_heat;
  if (are({damping, spring, substrate, heat})) return blocks.damping_first_with_heat;
  return nullptr;
}

}  // namespace

LaneBlock rk4_block_of(const System<double>& run, std::span<const Kernel<double>> forces) {
  return block_of(run, forces, kernels::PointLanes.on(run.set).rk4);
}
LaneBlock midpoint_block_of(const System<double>& run, std::span<const Kernel<double>> forces) {
  return block_of(run, forces, kernels::PointLanes.on(run.set).midpoint);
}

}  // namespace tomlin
