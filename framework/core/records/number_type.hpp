#pragma once

#include <array>

#include "framework/core/text/words.hpp"

namespace tomlin {

/// The numbers that the state of a run is held in.
enum class NumberType { double_precision, quadruple_precision };

constexpr auto word_table(NumberType) {
  using enum NumberType;
  return std::to_array<Word<NumberType>>(
      {{double_precision, "double"}, {quadruple_precision, "quadruple"}});
}

}  // namespace tomlin
