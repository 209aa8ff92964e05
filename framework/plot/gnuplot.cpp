#include "framework/plot/gnuplot.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/core/text/fault.hpp"
#include "framework/scene/text.hpp"

extern char** environ;

namespace tomlin {
namespace {

std::string message(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail(const std::string& what) { throw GnuplotError("gnuplot: " + what); }

std::string program() {
  const char* other = std::getenv(kGnuplotVariable);
  return other == nullptr || *other == '\0' ? "gnuplot" : other;
}

[[noreturn]] void refuse(const std::string& name, int error) {
  Fault fault(FaultCode::plot_no_matplotlib);
  fault.place.file = "tomlin";
  fault.key = name;
  fault.why = "figures are drawn by gnuplot, which cannot be started: " + message(error);
  fault.admissible =
      fmt::format("gnuplot 5.4 in PATH (Debian: apt-get install gnuplot-nox), or its path in {}",
                  kGnuplotVariable);
  throw InputError({fault});
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

/// A file without a name, with this in it: unlike a pipe it never makes anybody wait.
TemporaryFile temporary_file(std::string_view text) {
  TemporaryFile file(std::tmpfile());
  if (!file) fail("no temporary file: " + message(errno));
  if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() ||
      std::fflush(file.get()) != 0) {
    fail("cannot write a temporary file: " + message(errno));
  }
  ::lseek(::fileno(file.get()), 0, SEEK_SET);
  return file;
}

/// The two ends of a pipe, closed at the latest when this goes.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) fail("no pipe: " + message(errno));
  }
  ~Pipe() {
    for (int end : {0, 1}) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write_end() { close(1); }

 private:
  void close(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  std::array<int, 2> ends_{};
};

std::string all_of(int descriptor) {
  std::string text;
  std::array<char, 1 << 16> block;
  for (;;) {
    const ssize_t count = ::read(descriptor, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("its output cannot be read: " + message(errno));
    if (count == 0) return text;
    text.append(block.data(), static_cast<std::size_t>(count));
  }
}

/// The environment without what would choose a terminal: the figure's script does.
std::vector<char*> environment() {
  constexpr std::string_view kTerminal = "GNUTERM=";
  std::vector<char*> kept;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (!std::string_view(*entry).starts_with(kTerminal)) kept.push_back(*entry);
  }
  kept.push_back(nullptr);
  return kept;
}

/// Starts the program with these as its standard streams.
pid_t spawned(const std::string& name, int input, int output, int errors) {
  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_adddup2(&streams, input, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, output, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, errors, STDERR_FILENO);
  std::string word = name;
  std::string defaults = "-d";  // no ~/.gnuplot: the same figure for everybody
  std::array<char*, 3> words = {word.data(), defaults.data(), nullptr};
  pid_t child = -1;
  const int error =
      ::posix_spawnp(&child, word.c_str(), &streams, nullptr, words.data(), environment().data());
  ::posix_spawn_file_actions_destroy(&streams);
  if (error != 0) refuse(name, error);
  return child;
}

int status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail("lost: " + message(errno));
  }
  return status;
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
  const TemporaryFile input = temporary_file(script);
  const TemporaryFile errors = temporary_file("");
  Pipe output;
  const pid_t child =
      spawned(program(), ::fileno(input.get()), output.write_end(), ::fileno(errors.get()));
  output.close_write_end();
  std::string picture = all_of(output.read_end());
  const int status = status_of(child);
  if (status == 0 && !picture.empty()) return picture;
  ::lseek(::fileno(errors.get()), 0, SEEK_SET);
  const std::string said = shortened(all_of(::fileno(errors.get())), kLongestShownMessage);
  const std::string how = WIFSIGNALED(status) ? fmt::format("killed by signal {}", WTERMSIG(status))
                          : status == 0       ? "drew nothing"
                                              : fmt::format("status {}", WEXITSTATUS(status));
  fail(said.empty() ? how : how + ": " + said);
}

}  // namespace tomlin
