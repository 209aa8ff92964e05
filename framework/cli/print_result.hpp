#pragma once

#include <string>

namespace tomlin {

/// Writes a command's result to standard output; kExitFailed when that does not take it.
int print_result(const std::string& text);

}  // namespace tomlin
