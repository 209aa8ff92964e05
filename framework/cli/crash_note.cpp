#include "framework/cli/crash_note.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/cli/exit_status.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault_code.hpp"

namespace tomlin {
namespace {

/// A note that a signal handler can write: those reach nothing but globals, and allocate nothing.
struct Note {
  char text[4096] = {};
  std::size_t length = 0;

  void say(const std::string& words) {
    const std::string line = printable(words);
    length = line.copy(text, sizeof text - 1);
    text[length++] = '\n';
  }
  void write() const {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, length);
  }
};

Note g_crash;
Note g_exit;
std::atomic<pid_t> g_running = 0;  ///< the process that is not over yet
static_assert(std::atomic<pid_t>::is_always_lock_free);

/// Signal handlers run on this stack, since the program's own may have overflowed.
alignas(16) unsigned char g_stack[std::size_t{1} << 16];

extern "C" void tell_and_crash(int signal) {
  g_crash.write();
  std::raise(signal);  // what it did before there was a note
}

/// Handlers of `exit` run in it, whoever called it. A child that a library has forked may exit.
extern "C" void refuse_to_exit() {
  if (g_running != ::getpid()) return;
  g_exit.write();
  ::_exit(kExitFailed);
}

}  // namespace

void tell_of_plugins_in_a_crash(const std::vector<std::string>& paths) {
  if (paths.empty()) return;
  const std::string names = fmt::format("{}", fmt::join(paths, ", "));
  const std::string end = fmt::format("{} [{}]", names, id_of(FaultCode::plugin_error));
  g_crash.say("tomlin: error: a crash, which may come from the code of a plugin: " + end);
  g_exit.say(
      "tomlin: error: the program was left by exit(), which only the code of a plugin calls: " +
      end);
  stack_t stack = {};
  stack.ss_sp = g_stack;
  stack.ss_size = sizeof g_stack;
  ::sigaltstack(&stack, nullptr);
  struct sigaction action = {};
  action.sa_handler = &tell_and_crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    sigaction(signal, &action, nullptr);
  }
  static bool registered = false;
  if (!std::exchange(registered, true)) std::atexit(&refuse_to_exit);
  g_running = ::getpid();
}

void program_is_over() { g_running = 0; }

}  // namespace tomlin
