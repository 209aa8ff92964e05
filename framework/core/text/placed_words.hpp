#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace tomlin {

/// A word of a text and the line, from 1, in which it stands.
struct PlacedWord {
  std::string_view word;
  std::size_t line = 0;
};

/// The words of a table in a text, without comments from # to the end of a line. They point into
/// the text.
std::vector<PlacedWord> words_of_lines(std::string_view text);

}  // namespace tomlin
