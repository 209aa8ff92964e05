#pragma once

#include <cstddef>

#include "framework/core/pack.hpp"
#include "framework/core/stage.hpp"

namespace tomlin {

struct ObserveTable {
  /// Weighted sums of a body's numbers, one per axis.
  void (*mean)(const BodySlot<double>& slot, const double* numbers, int axes,
               double* result) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct ObserveKernels {
  TOMLIN_FLATTEN static void mean(const BodySlot<double>& slot, const double* numbers, int axes,
                                  double* result) {
    for (int d = 0; d < axes; ++d) {
      const double* from = numbers + slot.offset + d * slot.stride;
      Pack total(0.0);
      for (std::size_t i = 0; i < slot.count; i += kGroup) {
        total += Pack::load(slot.share + i) * Pack::load(from + i);
      }
      result[d] = sum(total);
    }
  }

  template <class Real>
  static constexpr ObserveTable kernels() {
    return {&mean};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
