#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/random.hpp"

/// Normal numbers, with the same bits on every instruction set: they depend on their key and their
/// counter alone (random.hpp).
///
///   z = sqrt(-2 log u) cos(2 pi w),  z' = sqrt(-2 log u) sin(2 pi w)
///
/// u, w uniform in (0, 1), to 53 digits: |z| < 8.6. In quadruple precision they are those of
/// double. Source: G. E. P. Box and M. E. Muller, Ann. Math. Stat. 29 (1958) 610,
/// doi:10.1214/aoms/1177706645.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// z and z' of eight pairs u, w.
TOMLIN_INLINE void box_muller(const double* u, const double* w, Pack& z, Pack& other) {
  const Pack size = sqrt(Pack(-2.0) * log(Pack::load(u)));
  Pack sine(0.0);
  Pack cosine(0.0);
  sincos_turns(Pack::load(w), sine, cosine);
  z = size * cosine;
  other = size * sine;
}

/// `length` numbers, a multiple of a group, of mean 0 and variance 1. In each group only the first
/// `used` are wanted: the others are some numbers. The blocks of a counter count in its c.
template <class Real>
TOMLIN_INLINE void fill_normals(const RandomKey& key, RandomCounter counter, std::size_t length,
                                std::size_t used, Real* numbers) {
  constexpr std::size_t kAtOnce = kLanes;       // a group
  constexpr std::size_t kBlocks = kAtOnce / 2;  // for two groups of numbers
  alignas(64) double radius[kAtOnce];
  alignas(64) double angle[kAtOnce];
  if (used < kAtOnce) {
    std::fill(radius, radius + kAtOnce, 0.5);
    std::fill(angle, angle + kAtOnce, 0.5);
  }
  const auto put = [numbers](std::size_t from, const Pack& values) {
    if constexpr (std::is_same_v<Real, double>) {
      values.store_unaligned(numbers + from);
    } else {
      alignas(64) double part[kAtOnce];
      values.store(part);
      for (std::size_t k = 0; k < kAtOnce; ++k) numbers[from + k] = Real(part[k]);
    }
  };
  for (std::size_t i = 0; i < length; i += 2 * kAtOnce, counter.c += kBlocks) {
    uniform_pairs(key, counter, std::min(used, kAtOnce), radius, angle);
    Pack z;
    Pack other;
    box_muller(radius, angle, z, other);
    put(i, z);
    if (i + kAtOnce < length) put(i + kAtOnce, other);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
