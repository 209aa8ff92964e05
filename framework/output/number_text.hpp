#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

namespace tomlin {

/// Characters of the longest number, "-1.2345678901234567e-308".
inline constexpr std::size_t kLongestNumber = 24;

/// Appends a number with 17 significant digits, which read back as the same bits, as "%.17g" has it
/// in the C locale. (fmt's "{:.17g}" gives the same text in twice the time.)
inline void append_number(std::string& text, double number) {
  constexpr int kDigits = 17;
  const std::size_t before = text.size();
  text.resize(before + kLongestNumber);
  const auto end = std::to_chars(text.data() + before, text.data() + before + kLongestNumber,
                                 number, std::chars_format::general, kDigits)
                       .ptr;
  text.resize(static_cast<std::size_t>(end - text.data()));
}

/// A cell of comma-separated values in quotes.
inline std::string quoted_cell(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace tomlin
