#pragma once

#include <cstdint>
#include <limits>

#include "framework/core/records/parameter.hpp"

/// Conditions that count without end: `reverse` with both limits and without `times`.
namespace tomlin {

/// `times` of such a condition.
inline constexpr std::int64_t kWithoutEnd = std::numeric_limits<std::int64_t>::max();

/// Its limits count alternately, as long as the run lasts: a body that swings about a limit passes
/// it more than once, and the driver would turn its back on the other limit.
inline bool alternates(const Passing& passing) {
  return passing.above && passing.below && passing.times == kWithoutEnd;
}

}  // namespace tomlin
