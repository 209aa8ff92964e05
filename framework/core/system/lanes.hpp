#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/core/system/stage.hpp"

/// Replicas in lanes: runs of one structure, each with numbers of its own, side by side in the
/// vectors of an array. Number k of replica w stands at [k * width + w]. A kernel over replicas is
/// called as a kernel of one run is, on a stage whose arrays hold all replicas; it leaves out the
/// padding that the arrays of one run have. Each replica gets the bits that it gets alone.
namespace tomlin {

/// How one kernel call is made over replicas. The numbers are those of a run that is bound, and are
/// read off it again whenever its parameters have changed.
struct LaneForm {
  Kernel<double> kernel = nullptr;                    ///< gets LaneArguments; null: there is none
  std::vector<std::span<const double>> numbers = {};  ///< one after the other, as the kernel has it
  std::vector<std::int64_t> structure = {};  ///< indices, which all replicas of a batch have alike
  std::size_t scratch = 0;                   ///< numbers of each replica that the kernel writes
  bool follows_time = false;  ///< its numbers change where the run anchors its forces
};

/// What a kernel over replicas gets.
struct LaneArguments {
  const void* single = nullptr;     ///< the arguments of one run of the same structure
  const double* numbers = nullptr;  ///< [number * width + replica]
  double* scratch = nullptr;        ///< likewise
  std::size_t width = 0;            ///< replicas, a multiple of kGroup
  bool set = false;                 ///< write the forces; else add to what is there
  // Where a number of one run stands among the numbers without padding.
  const std::size_t* coordinate = nullptr;
  const std::size_t* mapped = nullptr;
  const std::size_t* rate = nullptr;
};

}  // namespace tomlin
