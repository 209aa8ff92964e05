#pragma once

#include <array>

#include "framework/core/text/words.hpp"

namespace tomlin {

/// Names of the axes of space in scenes, results and messages.
inline constexpr const char* kAxisNames[] = {"x", "y", "z"};

/// The values are the indices of the axes.
enum class Axis { x, y, z };

constexpr auto word_table(Axis) {
  return std::to_array<Word<Axis>>(
      {{Axis::x, kAxisNames[0]}, {Axis::y, kAxisNames[1]}, {Axis::z, kAxisNames[2]}});
}

}  // namespace tomlin
