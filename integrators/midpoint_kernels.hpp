#pragma once

#include "integrators/fixed_step_kernels.hpp"

namespace tomlin {

struct MidpointTableau {
  static constexpr const char* name = "midpoint";
  static constexpr int order = 2;
  static constexpr int stages = 2;
  static constexpr TableauRow<2> a[2] = {{}, {{1}, 2}};
  static constexpr TableauRow<2> b = {{0, 1}};
};

inline namespace TOMLIN_TARGET {
struct MidpointKernels : FixedStepKernels<MidpointTableau> {};
}  // namespace TOMLIN_TARGET

}  // namespace tomlin
