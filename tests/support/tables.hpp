#pragma once

#include <cstddef>
#include <string>

namespace tomlin::test {

/// Returns a part of a scene that is written with a table in a line: " | " stands for a new line.
inline std::string tables(std::string text) {
  for (std::size_t at = 0; (at = text.find(" | ", at)) != std::string::npos;) {
    text.replace(at, 3, "\n");
  }
  return text;
}

}  // namespace tomlin::test
