#pragma once

#include <functional>

namespace tomlin {

/// Returns what the command line asks for: a command, or a text to be printed. Calling it returns
/// the exit status, and throws what the command throws. Throws InputError when the command line
/// does not ask for anything that can be done.
std::function<int()> parse_command_line(int argc, const char* const* argv);

}  // namespace tomlin
