#include "framework/cli/crash_note.hpp"

#include <csignal>
#include <cstddef>

#include <fmt/format.h>
#include <unistd.h>

namespace tomlin {
namespace {

// A signal handler reaches nothing but globals, and allocates nothing.
char g_note[4096] = {};
std::size_t g_length = 0;

extern "C" void tell_and_crash(int signal) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, g_note, g_length);
  std::raise(signal);  // what it did before there was a note
}

}  // namespace

void tell_of_plugins_in_a_crash(const std::vector<std::string>& paths) {
  if (paths.empty()) return;
  const std::string note =
      fmt::format("tomlin: error: a crash, which may come from the code of a plugin: {}\n",
                  fmt::join(paths, ", "));
  g_length = note.copy(g_note, sizeof g_note);
  struct sigaction action = {};
  action.sa_handler = &tell_and_crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) sigaction(signal, &action, nullptr);
}

}  // namespace tomlin
