#pragma once

#include <array>

#include "framework/core/text/words.hpp"

namespace tomlin {

/// Parts of a body that may move.
enum class Coordinates {
  particles,   ///< every particle
  rigid,       ///< the body as a whole
  fixed,       ///< nothing
  prescribed,  ///< the body as a whole, by its motion
};

constexpr auto word_table(Coordinates) {
  using enum Coordinates;
  return std::to_array<Word<Coordinates>>(
      {{particles, "particles"}, {rigid, "rigid"}, {fixed, "fixed"}, {prescribed, "prescribed"}});
}

/// Whether forces move it.
constexpr bool follows_forces(Coordinates coordinates) {
  switch (coordinates) {
    case Coordinates::particles:
    case Coordinates::rigid:
      return true;
    case Coordinates::fixed:
    case Coordinates::prescribed:
      return false;
  }
  return false;
}

}  // namespace tomlin
