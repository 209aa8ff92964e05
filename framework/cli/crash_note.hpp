#pragma once

#include <string>
#include <vector>

namespace tomlin {

/// A crash of the process, a stack that overflows or a failed assertion says on standard error that
/// the code of these libraries was loaded, then takes its course; and where something calls `exit`
/// before program_is_over(), the process ends with kExitFailed, whatever status was given. Signal
/// handlers of the whole process: for the program, not the library.
void tell_of_plugins_in_a_crash(const std::vector<std::string>& paths);

/// From now on `exit` is the program's own.
void program_is_over();

}  // namespace tomlin
