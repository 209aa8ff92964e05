#pragma once

#include <cstddef>
#include <string_view>

/// Classes of ASCII characters. Those of the C library depend on the locale.
namespace tomlin {

inline bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80U; }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_letter_or_underscore(char c) { return is_letter(c) || c == '_'; }
inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
inline bool is_space(char c) { return is_blank(c) || c == '\r'; }
inline char in_lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
/// The text without these characters at its ends, by default the white space of a line.
inline std::string_view trimmed(std::string_view text, std::string_view characters = " \t\r") {
  const std::size_t begin = text.find_first_not_of(characters);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(characters) - begin + 1);
}

}  // namespace tomlin
