#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"
#include "tests/support/paths.hpp"

/// Fixture of tests of resumed runs: the files of a folder, and how two folders compare.
namespace tomlin::test {

/// A tip whose driver turns round, with samples, positions, events and a ledger: a run of fifty
/// steps that keeps a checkpoint every sixteen of them.
inline constexpr const char* kShortRun = R"([[body]]
name = "tip"
type = "point"
position = [0.0]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.5]
reverse = { when = "bodies.tip.centre_of_mass.x", above = 0.2 }

[[force]]
type = "viscous_damping"
coefficient = 1.0

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0

[run]
duration = 1.5
integrator = { type = "rk4", dt = 3e-2 }
ledger = true
checkpoint_every = 1e-9

[output]
every = 0.1
trajectory = true
)";

/// That run, so long that it is stopped in its course.
inline std::string long_run() { return replaced(kShortRun, "duration = 1.5", "duration = 1e6"); }

/// The scene with the particles of a file in place of its point.
inline std::string from_a_file(const std::string& scene, const std::string& file) {
  return replaced(scene, "type = \"point\"\nposition = [0.0]",
                  "type = \"particles\"\nfile = \"" + file + "\"");
}

/// Returns an environment in which waiting for the disk costs nothing: a run that is killed, unlike
/// a power cut, does not depend on it.
inline std::vector<std::string> impatient() {
  return {std::string("LD_PRELOAD=") + paths::failing_calls,
          // The library comes before that of the sanitizer.
          "ASAN_OPTIONS=verify_asan_link_order=0"};
}

/// The file's text, without how long the run took.
inline std::string comparable(const std::filesystem::path& file) {
  if (file.filename() != "summary.json") return content(file);
  Json summary = Json::parse(content(file));
  summary.erase("performance");
  return summary.dump();
}

/// All files of a folder, by name.
inline std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename().string()] = comparable(entry.path());
  }
  return files;
}

/// The names of the files that differ, or are in one folder only.
inline std::string differing(const std::filesystem::path& a, const std::filesystem::path& b) {
  auto left = files_of(a);
  auto right = files_of(b);
  std::string names;
  for (const auto& [name, text] : left) {
    const auto found = right.find(name);
    if (found == right.end() || found->second != text) names += name + " ";
    if (found != right.end()) right.erase(found);
  }
  for (const auto& [name, text] : right) names += name + " ";
  return names;
}

}  // namespace tomlin::test
