#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/scene/scene.hpp"
#include "tests/framework/scene/test_components.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/text.hpp"

/// Valid scenes over the test components, and ways to spoil them.
namespace tomlin::test {

inline constexpr const char* kRing = R"([scene]
name = "a ring"
[parameters]
N = 8
R = 1.0
k = "2 * R"

[[body]]
name = "ring"
type = "loop"
count = "N"
radius = "R"
particle_mass = "1 / N"
centre = [0.0, "R"]
[[force]]
type = "bonds"
body = "ring"
pairs = "all"
[[force]]
name = "driver"
type = "pull"
body = "ring"
stiffness = "k"
velocity = [1e-3, 0.0]
[run]
duration = 1e4
integrator = { type = "euler", dt = 1e-4 }

[measure]
from = 1.0
to = 10.0
in = "time"
[output]
every = 1.0
)";

inline constexpr const char* kDots = R"([run]
duration = 1
integrator = { type = "euler", dt = 0.1 }
[[body]]
name = "one"
type = "dot"
particle_mass = 1
position = [0.0]
[[body]]
name = "two"
type = "dot"
particle_mass = 1
position = [0.0]
)";

inline constexpr const char* kRow = R"([run]
duration = 1
integrator = { type = "euler", dt = 0.1 }
[[body]]
type = "row"
count = 3
particle_mass = 1
)";

inline std::shared_ptr<const Scene> parsed(std::string_view text,
                                           const std::vector<Setting>& settings = {}) {
  static const Registry registry = components();
  return parse_scene(text, "ring.toml", registry, settings);
}

/// The error lines; empty when the scene is valid.
inline std::string faults_of(std::string_view text, const std::vector<Setting>& settings = {}) {
  try {
    (void)parsed(text, settings);
  } catch (const InputError& error) {
    return std::string(error.what()) + "\n";
  }
  return "";
}

/// Returns the faults without wording, see brief().
inline std::vector<std::string> briefs_of(std::string_view text,
                                          const std::vector<Setting>& settings = {}) {
  return briefs_of([&] { (void)parsed(text, settings); });
}

inline std::string replaced(const std::string& old_text, const std::string& new_text) {
  return replaced(kRing, old_text, new_text);
}

inline std::string replaced_all(std::string scene, const std::string& old_text,
                                const std::string& new_text) {
  std::string result;
  for (auto at = scene.find(old_text); at != std::string::npos; at = scene.find(old_text)) {
    result += scene.substr(0, at) + new_text;
    scene = scene.substr(at + old_text.size());
  }
  return result + scene;
}

}  // namespace tomlin::test
