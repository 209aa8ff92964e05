#pragma once

#include <string>
#include <string_view>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"

namespace tomlin {

/// The fault of a text that is no TOML: the TOML library stopped at `at` with `message`. The fault
/// has the library's sentence, the line as its value, and what would be right where the text shows
/// it.
Fault explain_syntax(std::string_view text, const std::string& file, const TextPosition& at,
                     std::string_view message);

}  // namespace tomlin
