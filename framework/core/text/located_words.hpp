#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace tomlin {

/// A word of a text, and where it stands: its line and its number in the line, both from 1.
/// Messages have these and never the word: a scene of somebody else's may name any file.
struct LocatedWord {
  std::string_view word;
  std::size_t line = 0;
  std::size_t column = 0;
};

/// The words of a table in a text, without comments from # to the end of a line. They point into
/// the text.
std::vector<LocatedWord> words_of_lines(std::string_view text);

}  // namespace tomlin
