#pragma once

#include <cstddef>
#include <string_view>

/// Text that comes from elsewhere is UTF-8 or none.
namespace tomlin {

/// Some editors put this mark before a text; it is no part of it.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Length of the longest start of the text that is UTF-8.
std::size_t valid_utf8_prefix(std::string_view text);

inline bool is_utf8(std::string_view text) { return valid_utf8_prefix(text) == text.size(); }

inline bool is_utf8_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

}  // namespace tomlin
