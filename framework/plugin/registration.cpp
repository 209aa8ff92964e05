#include "framework/plugin/registration.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cfenv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/plugin/entry.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLongestMessage = 1024;

/// Message of the system on loading, without the path in front, which the message has already.
std::string loader_message(const std::filesystem::path& library) {
  const char* said = ::dlerror();
  std::string message = said == nullptr ? "it cannot be loaded" : said;
  const std::string front = library.string() + ": ";
  if (message.starts_with(front)) message.erase(0, front.size());
  return message;
}

/// Rounding and flushing as they are now, whatever a library makes of them when it is loaded: one
/// that was linked for fast mathematics would change the program's own numbers.
class KeptArithmetic {
 public:
  KeptArithmetic() { std::fegetenv(&now_); }
  ~KeptArithmetic() { std::fesetenv(&now_); }
  KeptArithmetic(const KeptArithmetic&) = delete;
  KeptArithmetic& operator=(const KeptArithmetic&) = delete;

 private:
  std::fenv_t now_{};
};

/// Why the descriptions of components cannot be made; empty when they can.
template <class Records>
std::string description_fault(const Records& records) {
  for (const auto& record : records) {
    std::string why;
    try {
      with_defaults(*record);
      continue;
    } catch (const std::exception& error) {
      why = error.what();
    } catch (...) {
      why = "an exception that is no std::exception";
    }
    return fmt::format("the description of \"{}\" cannot be made: {}", record->name, why);
  }
  return "";
}

/// In the child: nobody waits for a core, and what it prints is printed again when it is loaded.
[[noreturn]] void register_and_leave(const std::filesystem::path& library, int answers) {
  const rlimit none = {0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::prctl(PR_SET_DUMPABLE, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTERM, SIGINT}) {
    std::signal(signal, SIG_DFL);
  }
  if (const int nowhere = ::open("/dev/null", O_RDWR); nowhere >= 0) {
    for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
  }
  Registry registry;
  std::string message;
  try {
    message = register_components(library, registry);
  } catch (const std::exception& error) {
    message = error.what();
  }
  // The first character says that an answer was given at all.
  message = "." + message.substr(0, kLongestMessage);
  const ssize_t written = ::write(answers, message.data(), message.size());
  ::_exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
}

/// Reads the child's answer until it ends or its time is up; empty where there is none.
std::string answer_of(int answers, std::chrono::steady_clock::time_point until) {
  std::string answer;
  std::array<char, 512> bytes{};
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        until - std::chrono::steady_clock::now());
    if (left.count() <= 0) return answer;
    pollfd waiting = {answers, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(left.count()) + 1);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return answer;
    const ssize_t got = ::read(answers, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return answer;
    answer.append(bytes.data(), static_cast<std::size_t>(got));
  }
}

/// Waits for the end of a child until its time is up, then kills it. Its state.
int end_of(pid_t child, std::chrono::steady_clock::time_point until, bool& killed) {
  constexpr timespec kPollInterval = {0, 1'000'000};
  int state = 0;
  while (true) {
    const pid_t ended = ::waitpid(child, &state, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) return state;
    if (std::chrono::steady_clock::now() >= until && !std::exchange(killed, true)) {
      ::kill(child, SIGKILL);
    }
    ::nanosleep(&kPollInterval, nullptr);
  }
}

}  // namespace

std::string register_components(const std::filesystem::path& library, Registry& registry) {
  const KeptArithmetic kept;
  // Absolute, so that no search path is used; now, so that what is missing shows.
  void* const handle = ::dlopen(std::filesystem::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return loader_message(library);
  void* const symbol = ::dlsym(handle, kPluginEntry);
  if (symbol == nullptr) return fmt::format("it has no {}: see TOMLIN_PLUGIN", kPluginEntry);
  const auto entry = reinterpret_cast<PluginEntry>(symbol);  // NOLINT: as POSIX has it
  std::array<char, kLongestMessage> message{};
  if (entry(&registry, message.data(), message.size()) != 0) {
    message.back() = '\0';
    return fmt::format("registering failed: {}", message.data());
  }
  bool is_empty = true;
  std::string why;
  for_each_kind(registry, [&](const auto& records) {
    is_empty = is_empty && records.empty();
    if (why.empty()) why = description_fault(records);
  });
  return is_empty ? "it registers no component" : why;
}

std::string probe_registration(const std::filesystem::path& library, double seconds) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
    return std::string("it cannot be tried out: ") + std::strerror(errno);
  }
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                         std::chrono::duration<double>(seconds));
  const pid_t child = ::fork();
  if (child == 0) register_and_leave(library, pipe[1]);
  const int error = errno;
  ::close(pipe[1]);
  if (child < 0) {
    ::close(pipe[0]);
    return std::string("it cannot be tried out: ") + std::strerror(error);
  }
  const std::string answer = answer_of(pipe[0], until);
  ::close(pipe[0]);
  bool killed = false;
  const int state = end_of(child, until, killed);
  if (!answer.empty()) return answer.substr(1);
  if (killed) return fmt::format("registering did not end within {:g} s", seconds);
  if (WIFSIGNALED(state)) {
    return fmt::format("it crashed while registering: {} (signal {})", ::strsignal(WTERMSIG(state)),
                       WTERMSIG(state));
  }
  return fmt::format("it left the program while registering, with status {}", WEXITSTATUS(state));
}

}  // namespace tomlin
