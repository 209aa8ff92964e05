#include "framework/cli/print_result.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "framework/cli/exit_status.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"

namespace tomlin {

int print_result(const std::string& given) {
  const std::string text = printable(given);
  const bool printed =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  // A reader that went away, as `head` does, has seen what it wanted.
  if (printed || errno == EPIPE) return kExitDone;
  const std::string reason = std::generic_category().message(errno);
  print_error_line(to_string(Fault(FaultCode::file_cannot_write, {"tomlin"}, "", "",
                                   "cannot write to standard output: " + reason)));
  return kExitFailed;
}

}  // namespace tomlin
