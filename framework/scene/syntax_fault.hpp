#pragma once

#include <string>
#include <string_view>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"

namespace tomlin {

/// What is wrong with text that is no TOML, in the words of a scene: the TOML library stopped at
/// `at` with `message`. The fault stands where the mistake was made (at the quote that is not
/// closed, not at the end of its line), and says how the line would be right.
Fault explain_syntax(std::string_view text, const std::string& file, const TextPlace& at,
                     std::string_view message);

/// What is wrong with a character beyond ASCII, the first of `rest`, outside of strings and
/// comments.
Fault explain_character(std::string_view rest, const std::string& file, const TextPlace& at);

}  // namespace tomlin
