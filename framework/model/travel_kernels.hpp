#pragma once

#include <cstddef>

#include "framework/core/numbers/pack.hpp"
#include "framework/core/system/stage.hpp"

namespace tomlin {

/// How far drivers have come in the replicas of a batch, LaneTravel in core/system/lanes.hpp.
struct TravelArguments {
  std::size_t width = 0;
  std::size_t count = 0;
  const double* time_high = nullptr;  ///< [lane], in twice double precision
  const double* time_low = nullptr;
  const double* velocity = nullptr;  ///< [travel * width + lane]
  const double* shift_high = nullptr;
  const double* shift_low = nullptr;
  double* const* travel = nullptr;  ///< [travel]: where its lanes stand
};

struct TravelTable {
  void (*travel)(const TravelArguments& arguments) = nullptr;
  /// count * unit in each lane, exactly.
  void (*products)(const double* count, double unit, std::size_t width, double* high,
                   double* low) = nullptr;
};

inline namespace TOMLIN_TARGET {

/// The operations of DoubleDouble, in the same order.
struct TravelKernels {
  struct Pair {
    Pack hi;
    Pack lo;
  };
  TOMLIN_INLINE static Pair two_sum(const Pack& a, const Pack& b) {
    const Pack s = a + b;
    const Pack b_part = s - a;
    return {s, (a - (s - b_part)) + (b - b_part)};
  }
  TOMLIN_INLINE static Pair fast_two_sum(const Pack& a, const Pack& b) {
    const Pack s = a + b;
    return {s, b - (s - a)};
  }
  TOMLIN_INLINE static Pair two_prod(const Pack& a, const Pack& b) {
    const Pack p = a * b;
    return {p, fma(a, b, -p)};
  }

  TOMLIN_FLATTEN static void travel(const TravelArguments& arguments) {
    const TravelArguments a = arguments;
    for (std::size_t k = 0; k < a.count; ++k) {
      double* const to = a.travel[k];
      for (std::size_t lane = 0; lane < a.width; lane += kGroup) {
        const std::size_t i = k * a.width + lane;
        const Pack velocity = Pack::load(a.velocity + i);
        const Pair p = two_prod(Pack::load(a.time_high + lane), velocity);
        const Pair way = fast_two_sum(p.hi, fma(Pack::load(a.time_low + lane), velocity, p.lo));
        const Pair s = two_sum(way.hi, -Pack::load(a.shift_high + i));
        const Pair t = two_sum(way.lo, -Pack::load(a.shift_low + i));
        const Pair u = fast_two_sum(s.hi, s.lo + t.hi);
        const Pair rest = fast_two_sum(u.hi, u.lo + t.lo);
        (rest.hi + rest.lo).store(to + lane);
      }
    }
  }

  TOMLIN_FLATTEN static void products(const double* count, double unit, std::size_t width,
                                      double* high, double* low) {
    for (std::size_t lane = 0; lane < width; lane += kGroup) {
      const Pair product = two_prod(Pack::load(count + lane), Pack(unit));
      product.hi.store(high + lane);
      product.lo.store(low + lane);
    }
  }

  template <class Real>
  static constexpr TravelTable kernels() {
    return {&travel, &products};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
