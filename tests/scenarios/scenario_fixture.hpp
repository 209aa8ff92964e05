#pragma once

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/tables.hpp"

/// Runs the scenes that are shipped, and scenes given as text.
namespace tomlin::test {

inline constexpr double kPi = 3.141592653589793;

inline const Registry& registry() {
  static const Registry components = standard_registry();
  return components;
}

/// All digits, as a setting takes them.
inline std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

/// A run that does not finish is no result to test.
inline RunResult finished(RunResult result) {
  if (result.status == RunStatus::finished) return result;
  throw std::runtime_error(result.failure ? to_string(*result.failure) : "the run was interrupted");
}

/// `scene` is relative to scenarios/.
inline RunResult run_shipped(const std::string& scene, const std::vector<Setting>& settings = {},
                             RunSink* sink = nullptr) {
  RunOptions options;
  options.sink = sink;
  const std::string file = std::string(paths::source) + "/scenarios/" + scene;
  return finished(run(read_scene(file, registry(), settings), options));
}

inline RunResult run_text(std::string_view text, const std::vector<Setting>& settings = {}) {
  return finished(run(parse_scene(text, "scene.toml", registry(), settings)));
}

/// Returns the value of a resolved parameter of a shipped scene.
inline double parameter_of(const std::string& scene, const std::string& name,
                           const std::vector<Setting>& settings = {}) {
  const auto read =
      read_scene(std::string(paths::source) + "/scenarios/" + scene, registry(), settings);
  for (const auto& [key, value] : read->parameters) {
    if (key == name) return value;
  }
  throw std::logic_error(scene + " has no parameter " + name);
}

inline double mean_force(const RunResult& result) { return result.driver(0)["mean_force"].at(0); }

/// Slope of log |y| over log x by least squares.
inline double fitted_power(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double lx = std::log(x[i]);
    const double ly = std::log(std::abs(y[i]));
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace tomlin::test
