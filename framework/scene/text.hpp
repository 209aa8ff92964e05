#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/text/utf8.hpp"

/// Text for messages.
namespace tomlin {

inline constexpr std::size_t kLongestShownValue = 60;     ///< bytes of a value in a message
inline constexpr std::size_t kLongestShownMessage = 300;  ///< of another library's message
inline constexpr std::size_t kMostShownNames = 30;        ///< of what is admissible

/// On one line, at most so many bytes, "..." where something was cut. Always UTF-8.
std::string shortened(std::string_view text, std::size_t most_bytes);

/// Returns a TOML string with escapes, in double quotes.
std::string quoted_text(std::string_view text);

/// A key as TOML writes it: bare, or quoted where it must be.
std::string key_text(std::string_view key);

/// "a, b, c"; the tail of a long list is left out.
std::string listed(const std::vector<std::string>& names);

/// Each word in double quotes.
std::vector<std::string> in_quotes(const std::vector<std::string>& words);

/// [A-Za-z_][A-Za-z0-9_-]*: the name of a body or a force.
bool is_component_name(std::string_view name);

}  // namespace tomlin
