#pragma once

#include <cstddef>
#include <span>

#include "framework/core/system/system.hpp"

/// Steps of single particles on a line, replicas in lanes, that are taken in registers. That needs
/// one kernel for the scheme and all forces: see framework/point_lanes.hpp.
namespace tomlin {

/// Row k is the start of step k: of states [step][replica], of rates [step][rate][replica]. Row 0
/// of the states is there beforehand, and one more row than steps is written.
struct LaneRows {
  double* positions = nullptr;
  double* velocities = nullptr;
  double* rates = nullptr;
  double* integrals = nullptr;  ///< [rate][replica]; as they are after the last step
};

/// So many steps of h from the anchor, in all lanes. False: one of them has failed.
using LaneBlock = bool (*)(const SystemView<double>& lanes, double h, std::size_t steps,
                           const LaneRows& rows);

/// Block for a run of one particle on a line with these kernels over lanes; null if there is none.
using LaneBlockFinder = LaneBlock (*)(const System<double>& run,
                                      std::span<const Kernel<double>> forces);

}  // namespace tomlin
