#pragma once

#include <string>
#include <string_view>

namespace tomlin {

/// Text for a terminal, whoever wrote it: what would control one, as escape sequences do, or turn
/// the direction of what follows is written out as "\u001B"; what is no UTF-8 becomes "?". Line
/// breaks and tabs stay. JSON means the same as before.
std::string printable(std::string_view text);

/// A line on standard error.
void print_error_line(std::string_view text);

/// Writes a command's result to standard output; kExitFailed when that does not take it.
int print_result(const std::string& text);

}  // namespace tomlin
