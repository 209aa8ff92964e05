#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/system/stage.hpp"

/// Replicas in lanes: runs of one structure, each with numbers of its own, side by side in the
/// vectors of an array. Number k of replica w stands at [k * width + w]. A kernel over replicas is
/// called as a kernel of one run is, on a stage whose arrays hold all replicas; it leaves out the
/// padding that the arrays of one run have. Each replica gets the bits that it gets alone.
namespace tomlin {

/// A number of a call that follows from the time t that forces are anchored at: velocity * t -
/// shift, computed in twice double precision, then rounded.
struct LaneTravel {
  std::size_t number = 0;  ///< which of the call's
  const double* velocity = nullptr;
  const DoubleDouble* shift = nullptr;
};

/// How one kernel call is made over replicas. The numbers are those of a run that is bound, and are
/// read off it again whenever its parameters have changed.
struct LaneForm {
  Kernel<double> kernel = nullptr;                    ///< gets LaneArguments; null: there is none
  std::vector<std::span<const double>> numbers = {};  ///< one after the other, as the kernel has it
  std::vector<std::int64_t> structure = {};  ///< indices, which all replicas of a batch have alike
  std::size_t scratch = 0;                   ///< numbers of each replica that the kernel writes
  bool follows_time = false;  ///< its first numbers change where the run anchors its forces
  std::vector<LaneTravel> travels = {};  ///< all that change; empty: they are read off the run
};

/// Numbers of one run without their padding: where each of them stands.
struct LaneMap {
  std::vector<std::size_t> from;

  void put(const double* single, std::size_t lane, std::size_t width, double* lanes) const {
    for (std::size_t k = 0; k < from.size(); ++k) lanes[k * width + lane] = single[from[k]];
  }
  void get(const double* lanes, std::size_t lane, std::size_t width, double* single) const {
    for (std::size_t k = 0; k < from.size(); ++k) single[from[k]] = lanes[k * width + lane];
  }
};

/// Arrangement of the numbers of replicas in their arrays.
struct LaneLayout {
  std::size_t width = 0;
  LaneMap coordinates;
  LaneMap rates;
};

}  // namespace tomlin
