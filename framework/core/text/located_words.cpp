#include "framework/core/text/located_words.hpp"

#include <algorithm>

namespace tomlin {

std::vector<LocatedWord> words_of_lines(std::string_view text) {
  std::vector<LocatedWord> words;
  std::size_t line = 1;
  std::size_t column = 0;  // words of the line so far
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '\n') {
      ++line;
      column = 0;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      ++at;
    } else {
      const std::size_t end = std::min(text.find_first_of(" \t\r\n#", at), text.size());
      words.push_back({text.substr(at, end - at), line, ++column});
      at = end;
    }
  }
  return words;
}

}  // namespace tomlin
