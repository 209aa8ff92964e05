#pragma once

#include <cstddef>
#include <utility>

#include "framework/core/system/aligned.hpp"

namespace tomlin {

/// Scratch arrays of a scheme in one block of memory, with gaps that keep them off powers of two.
template <class Real>
class SpreadArrays {
 public:
  /// Zeros, for so many arrays that have so many numbers together.
  SpreadArrays(std::size_t arrays, std::size_t numbers)
      : memory_(numbers + arrays * kGap, Real(0.0)), next_(memory_.data()) {}
  SpreadArrays(const SpreadArrays&) = delete;
  SpreadArrays& operator=(const SpreadArrays&) = delete;

  Real* take(std::size_t count) { return std::exchange(next_, next_ + count + kGap); }

 private:
  static constexpr std::size_t kGap = 3 * kGroup;

  AlignedVector<Real> memory_;
  Real* next_;
};

}  // namespace tomlin
