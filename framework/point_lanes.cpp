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
  constexpr std::size_t kRates = 2;  // force and power of the spring
  if (run.view.used_rates != kRates) return nullptr;
  const auto on = [&](const KernelTables& tables) -> const LaneKernels& {
    return tables.on<double>(run.set).lanes;
  };
  const Kernel<double> spring = on(kernels::DrivingSpring).centre[0];
  const Kernel<double> damping = on(kernels::ViscousDamping).site[0];
  const Kernel<double> substrate = on(kernels::SinusoidalSubstrate).site[0];
  const auto are = [&](std::initializer_list<Kernel<double>> these) {
    return std::equal(forces.begin(), forces.end(), these.begin(), these.end());
  };
  if (are({spring, damping, substrate})) return blocks.spring_first;
  if (are({damping, spring, substrate})) return blocks.damping_first;
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
