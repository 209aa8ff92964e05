#pragma once

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/paths.hpp"

/// Runs the program as a user does.
namespace tomlin::test {

struct Ended {
  int status = -1;  ///< exit status; 128 plus the signal's number when killed
  std::string out;
  std::string err;
};

struct Conditions {
  std::string standard_output = {};           ///< a file instead of a capture, e.g. /dev/full
  long largest_file = -1;                     ///< bytes; beyond it writing fails
  long most_memory = -1;                      ///< bytes of address space
  long most_seconds = -1;                     ///< of the processor's time
  std::function<void(pid_t)> then = {};       ///< called while the program runs
  std::vector<std::string> environment = {};  ///< more of it: "NAME=VALUE"
  std::vector<int> closed = {};               ///< standard streams that the program has not got
  std::vector<int> ignored = {};              ///< signals
};

inline Ended run_program(const std::filesystem::path& folder,
                         const std::vector<std::string>& arguments,
                         const Conditions& conditions = {}) {
  const TemporaryFolder capture;
  const std::string out = (capture / "out").string();
  const std::string err = (capture / "err").string();
  write(out, "");  // there even when the program is killed before it begins
  write(err, "");
  const std::string target = conditions.standard_output.empty() ? out : conditions.standard_output;
  std::vector<std::string> words = {paths::program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    const int input = ::open("/dev/null", O_RDONLY);
    const int output = ::open(target.c_str(), O_WRONLY | O_CREAT, 0600);
    const int errors = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(input, 0);
    ::dup2(output, 1);
    ::dup2(errors, 2);
    for (const int stream : conditions.closed) ::close(stream);
    for (const int signal : conditions.ignored) std::signal(signal, SIG_IGN);
    for (const std::string& entry : conditions.environment) {
      ::putenv(const_cast<char*>(entry.c_str()));  // NOLINT: this process ends here
    }
    const auto limit = [](auto resource, long most) {
      const rlimit both = {static_cast<rlim_t>(most), static_cast<rlim_t>(most)};
      if (most >= 0) ::setrlimit(resource, &both);
    };
    limit(RLIMIT_FSIZE, conditions.largest_file);
    limit(RLIMIT_AS, conditions.most_memory);
    limit(RLIMIT_CPU, conditions.most_seconds);
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  if (conditions.then) conditions.then(child);
  int state = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (::waitpid(child, &state, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &state, 0);
      throw std::runtime_error("the program did not end");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  Ended ended;
  ended.status = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
  if (conditions.standard_output.empty()) ended.out = content(out);
  ended.err = content(err);
  return ended;
}

/// Waits until a file is there; false when it takes too long.
inline bool appears(const std::filesystem::path& file) {
  for (int k = 0; k < 10000; ++k) {
    if (std::filesystem::exists(file)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace tomlin::test
