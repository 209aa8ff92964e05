#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/framework/cli/program_runner.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/text.hpp"

/// Fixture of tests of the program: a folder with a scene in it.
namespace tomlin::test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

inline constexpr const char* kTip = R"([scene]
name = "a tip"

[parameters]
v = 1e-2
two_v = "2 * v"

[[body]]
name = "tip"
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = ["v"]

[[force]]
type = "viscous_damping"
coefficient = 2.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 300.0
integrator = { type = "rk4", dt = 1e-2 }

[measure]
from = 1.0
to = 2.0
in = "driver_periods"

[output]
every = 0.7
)";

/// The words of a command line with more behind them.
inline std::vector<std::string> plus(std::vector<std::string> words,
                                     const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
}

/// Returns what the program has left, after a check of its exit status.
inline Ended expect_status(int status, Ended ended, int line = __builtin_LINE()) {
  EXPECT_EQ(ended.status, status) << "line " << line << ": " << ended.err;
  return ended;
}

/// Among the errors is this one, abridged, and they have the parts in them.
inline void expect_error(const Ended& ended, const std::string& error,
                         const std::vector<std::string>& parts = {}) {
  EXPECT_TRUE(contains(abridged(ended.err), error)) << error << "\n" << ended.err;
  expect_parts(ended.err, parts);
}

/// Sends the signal to the program once the file is there.
inline std::function<void(pid_t)> signal_at(const fs::path& file, int signal) {
  return [file, signal](pid_t child) {
    EXPECT_TRUE(appears(file));
    ::kill(child, signal);
  };
}

/// Sends the signal to the program after this time.
inline std::function<void(pid_t)> signal_after(std::chrono::duration<double> wait, int signal) {
  return [wait, signal](pid_t child) {
    std::this_thread::sleep_for(wait);
    ::kill(child, signal);
  };
}

/// A folder with the tip's scene in it.
class Cli : public testing::Test {
 protected:
  void SetUp() override { write(folder_ / "tip.toml", kTip); }

  Ended tomlin(const std::vector<std::string>& arguments, const Conditions& conditions = {}) {
    return run_program(folder_.path(), arguments, conditions);
  }
  std::string file(const std::string& path) { return content(folder_.path() / path); }
  Json summary(const std::string& folder) { return Json::parse(file(folder + "/summary.json")); }
  Json sweep_summary(const std::string& folder) {
    return Json::parse(file(folder + "/sweep.json"));
  }
  /// The files of a sweep that follow from its scene and its rows.
  std::string results(const std::string& folder) {
    return file(folder + "/sweep.csv") + file(folder + "/sweep.h5") + file(folder + "/scene.toml");
  }
  /// The summary without what depends on the machine and the moment.
  Json comparable_summary(const std::string& folder) {
    Json all = summary(folder);
    all.erase("performance");
    return all;
  }
  bool exists(const std::string& path) { return fs::exists(folder_.path() / path); }

  /// Exit status 2, on standard error just these lines, abridged, with the parts in them, nothing
  /// on standard output, nothing made.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& errors,
                      const std::vector<std::string>& parts = {}) {
    const auto before = all_files();
    const Ended ended = tomlin(arguments);
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(abridged(ended.err), errors) << ended.err;
    expect_parts(ended.err, parts);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(all_files(), before);
  }

  std::vector<std::string> all_files() {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  TemporaryFolder folder_;
};

inline std::ptrdiff_t lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace tomlin::test
