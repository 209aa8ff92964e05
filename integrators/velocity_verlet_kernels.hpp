#pragma once

#include "integrators/composition_kernels.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

struct VerletScheme {
  static constexpr int drifts = 1;
  template <class Real>
  static constexpr Real kick[2] = {Real(0.5), Real(0.5)};
  template <class Real>
  static constexpr Real drift[1] = {Real(1.0)};
  template <class Real>
  static constexpr Real time[1] = {Real(1.0)};
};

struct VelocityVerletKernels : CompositionKernels<VerletScheme> {};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
