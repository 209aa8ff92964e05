#pragma once

#include "integrators/fixed_step_kernels.hpp"

namespace tomlin {

struct Rk4Tableau {
  static constexpr const char* name = "rk4";
  static constexpr int order = 4;
  static constexpr int stages = 4;
  static constexpr TableauRow<4> a[4] = {{}, {{1}, 2}, {{0, 1}, 2}, {{0, 0, 1}}};
  static constexpr TableauRow<4> b = {{1, 2, 2, 1}, 6};
};

inline namespace TOMLIN_TARGET {
struct Rk4Kernels : FixedStepKernels<Rk4Tableau> {};
}  // namespace TOMLIN_TARGET

}  // namespace tomlin
