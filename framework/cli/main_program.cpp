#include "framework/cli/main_program.hpp"

#include <exception>
#include <initializer_list>
#include <new>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "framework/cli/command_line.hpp"
#include "framework/cli/crash_note.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/output/output_file.hpp"
#include "framework/plugin/load.hpp"

namespace tomlin {
namespace {

/// Opens something that cannot be written to under the numbers of standard input, output and error
/// that are closed (`>&-`), so that no file of a run is mistaken for one of them.
void occupy_closed_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest free number is this one. Reading is all that it allows.
    ::open("/dev/null", O_RDONLY);
  }
}

int end_with(int status, const std::string& message) {
  print_error_line(message);
  return status;
}

int end_with(int status, FaultCode code, const std::string& why) {
  return end_with(status, to_string(Fault(code, {"tomlin"}, "", "", why)));
}

/// A plugin may have thrown what nobody else has said anything about.
std::string or_a_plugin() {
  if (loaded_plugins().empty()) return "";
  return fmt::format("; it may come from the code of a plugin: {}",
                     fmt::join(loaded_plugins(), ", "));
}

FaultCode code_of_unexpected() {
  return loaded_plugins().empty() ? FaultCode::program_internal_error : FaultCode::plugin_error;
}

int guarded_program(int argc, const char* const* argv) {
  try {
    return parse_command_line(argc, argv)();
  } catch (const InputError& error) {
    return end_with(kExitBadInput, error.what());
  } catch (const PluginError& error) {
    return end_with(kExitFailed, FaultCode::plugin_error, error.what());
  } catch (const OutputError& error) {
    return end_with(kExitFailed, FaultCode::file_cannot_write, error.what() + or_a_plugin());
  } catch (const std::bad_alloc&) {
    return end_with(kExitBadInput, FaultCode::scene_too_large,
                    "this takes more memory than there is" + or_a_plugin());
  } catch (const std::length_error&) {
    return end_with(kExitBadInput, FaultCode::scene_too_large,
                    "this takes more memory than there is" + or_a_plugin());
  } catch (const std::exception& error) {
    return end_with(kExitFailed, code_of_unexpected(), error.what() + or_a_plugin());
  } catch (...) {
    return end_with(kExitFailed, code_of_unexpected(),
                    "an exception that is not a std::exception" + or_a_plugin());
  }
}

}  // namespace

int program(int argc, const char* const* argv) noexcept {
  occupy_closed_standard_streams();
  int status = kExitFailed;
  try {
    status = guarded_program(argc, argv);
  } catch (...) {  // not even a message can be put together
  }
  program_is_over();
  return status;
}

}  // namespace tomlin
