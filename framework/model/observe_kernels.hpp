#pragma once

#include <cstddef>

#include "framework/core/numbers/angle.hpp"
#include "framework/core/numbers/pack.hpp"
#include "framework/core/system/stage.hpp"

namespace tomlin {

/// How the particles of a body started in the plane of two axes, about its centre; padded with
/// zeros.
struct PlanarShape {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* mass = nullptr;
  int axis_x = 0;
  int axis_y = 1;
};

struct ObserveTable {
  /// Weighted sums of a body's numbers, one per axis.
  void (*mean)(const BodySlot<double>& slot, const double* numbers, int axes,
               double* result) = nullptr;
  /// The rotation, in turns within (-1/2, 1/2], that brings a shape closest to where its particles
  /// are now, in the sense of least squares.
  double (*rotation)(const BodySlot<double>& slot, const PlanarShape& shape,
                     const double* position) = nullptr;
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

  TOMLIN_FLATTEN static double rotation(const BodySlot<double>& slot, const PlanarShape& shape,
                                        const double* position) {
    double middle[3];
    mean(slot, position, shape.axis_y + 1, middle);
    const double* x = position + slot.offset + shape.axis_x * slot.stride;
    const double* y = position + slot.offset + shape.axis_y * slot.stride;
    Pack along(0.0);
    Pack across(0.0);
    for (std::size_t i = 0; i < slot.count; i += kGroup) {
      const Pack rx = Pack::load(x + i) - Pack(middle[shape.axis_x]);
      const Pack ry = Pack::load(y + i) - Pack(middle[shape.axis_y]);
      const Pack arm_x = Pack::load(shape.x + i);
      const Pack arm_y = Pack::load(shape.y + i);
      const Pack mass = Pack::load(shape.mass + i);
      along += mass * fma(arm_x, rx, arm_y * ry);
      across += mass * fma(arm_x, ry, -(arm_y * rx));
    }
    return angle_turns(sum(across), sum(along));
  }

  template <class Real>
  static constexpr ObserveTable kernels() {
    return {&mean, &rotation};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
