#pragma once

#include <string>
#include <vector>

namespace tomlin {

/// A crash of the process says on standard error that the code of these libraries was loaded, then
/// takes its course. Signal handlers of the whole process: for the program, not the library.
void tell_of_plugins_in_a_crash(const std::vector<std::string>& paths);

}  // namespace tomlin
