#pragma once

/// Classes of ASCII characters. Those of the C library depend on the locale.
namespace tomlin {

inline bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80U; }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_letter_or_underscore(char c) { return is_letter(c) || c == '_'; }
inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
inline bool is_space(char c) { return is_blank(c) || c == '\r'; }

}  // namespace tomlin
