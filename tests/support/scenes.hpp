#pragma once

#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "framework/model/stability.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/tables.hpp"

/// Scenes for tests, with every component of this version or with a registry of the test's own.
namespace tomlin::test {

inline const Registry& standard() {
  static const Registry registry = standard_registry();
  return registry;
}

inline std::shared_ptr<const Scene> scene_of(std::string_view text,
                                             const std::vector<Setting>& settings = {}) {
  return parse_scene(text, "test.toml", standard(), settings);
}

inline RunResult run_text(std::string_view text, const std::vector<Setting>& settings = {},
                          const RunOptions& options = {}) {
  return run(scene_of(text, settings), options);
}

inline RunOptions watched_by(RunSink& sink) {
  RunOptions options;
  options.sink = &sink;
  return options;
}

/// A number as a setting, to the last digit.
inline std::string digits(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

inline std::string fixed_step(double dt) { return "{ type = \"rk4\", dt = " + digits(dt) + " }"; }

inline std::string verlet(double dt) {
  return "{ type = \"velocity_verlet\", dt = " + digits(dt) + " }";
}

inline std::string adaptive(double tolerance, const std::string& type = "dopri5") {
  return "{ type = \"" + type + "\", absolute_tolerance = " + digits(tolerance) +
         ", relative_tolerance = " + digits(tolerance) + " }";
}

/// An adaptive scheme held to steps of h: the tolerance is too wide to have a say.
inline std::string adaptive_of(const std::string& type, double h) {
  return "{ type = \"" + type +
         "\", absolute_tolerance = 1e30, relative_tolerance = 0.0, initial_step = " + digits(h) +
         ", largest_step = " + digits(h) + " }";
}

inline std::string adaptive_held_to(double h) { return adaptive_of("dopri5", h); }

/// Any scheme, at steps of h.
inline std::string held_to(const std::string& type, double h) {
  if (standard().integrator(type)->adaptive) return adaptive_of(type, h);
  return "{ type = \"" + type + "\", dt = " + digits(h) + " }";
}

inline const ResultGroup& driver_of(const RunResult& result, std::string_view name) {
  for (const ResultGroup& driver : result.family("drivers")) {
    if (driver.name == name) return driver;
  }
  throw std::logic_error("no driver " + std::string(name));
}

inline const ResultGroup& body_of(const RunResult& result, std::string_view name) {
  for (const ResultGroup& body : result.family("bodies")) {
    if (body.name == name) return body;
  }
  throw std::logic_error("no body " + std::string(name));
}

/// Returns the standard error of an observable; nothing where the result lists it without one.
inline std::optional<double> stated_error(const RunResult& result, const std::string& path) {
  for (const ErrorEstimate& one : result.errors) {
    if (one.path == path) return one.error;
  }
  throw std::logic_error("no error of " + path);
}

/// The faults that a scene is refused with, as one text; empty when it is not.
inline std::string refusal(std::string_view text, const Registry& registry = standard()) {
  try {
    Engine engine(parse_scene(text, "test.toml", registry), {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Returns a refusal without wording: a brief() for each fault, in lines.
inline std::string brief_refusal(std::string_view text, const Registry& registry = standard()) {
  const auto faults =
      briefs_of([&] { Engine engine(parse_scene(text, "test.toml", registry), {}); });
  return fmt::format("{}", fmt::join(faults, "\n"));
}

/// Keeps what an observables table would hold.
class KeptSamples : public RunSink {
 public:
  void begin(const RunLayout& layout) override {
    for (const SampleColumn& column : layout.columns) names.push_back(column.name);
  }
  void sample(const std::vector<double>& values) override { rows.push_back(values); }
  void event(const Event& event) override {
    events.push_back(event);
    events.back().name = *event_names.emplace(event.name).first;
  }

  std::vector<Event> of(EventKind kind) const {
    std::vector<Event> found;
    for (const Event& event : events) {
      if (event.kind == kind) found.push_back(event);
    }
    return found;
  }

  std::size_t column(const std::string& name) const {
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == name) return k;
    }
    throw std::logic_error("no column " + name);
  }

  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
  std::vector<Event> events;
  std::set<std::string> event_names;  ///< what their names refer to
};

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

inline bool same_bits(const ResultValue& a, const ResultValue& b) {
  return a.size() == b.size() && std::memcmp(a.begin(), b.begin(), a.size() * sizeof(double)) == 0;
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

/// The stability limit of the scheme's step, at the engine's state.
inline double stable_step_of(Engine& engine) {
  return stable_step_of(engine.model(), engine.context().scheme);
}

inline FinalState final_state_of(Engine& engine) {
  return engine.model().final_state(engine.context().clock.now());
}

/// All numbers of one field of a run's state.
inline std::vector<double> field_of(Engine& engine, const std::string& name) {
  for (const auto& field : engine.state().layout().reals()) {
    if (field.name != name) continue;
    const double* from = engine.state().reals(name);
    return std::vector<double>(from, from + field.count);
  }
  throw std::logic_error("no field " + name);
}

inline std::vector<std::int64_t> integers_of(Engine& engine, const std::string& name) {
  for (const auto& field : engine.state().layout().integers()) {
    if (field.name != name) continue;
    const std::int64_t* from = engine.state().integers(name);
    return std::vector<std::int64_t>(from, from + field.count);
  }
  throw std::logic_error("no field " + name);
}

/// State of the equations of motion: it may not depend on who observes it.
struct Motion {
  std::vector<double> position, velocity, integrals, clock;
  std::vector<std::int64_t> cells, turns;

  explicit Motion(Engine& engine)
      : position(field_of(engine, "position")),
        velocity(field_of(engine, "velocity")),
        integrals(field_of(engine, "integrals")),
        clock(field_of(engine, "clock")),
        cells(integers_of(engine, "origin_cells")),
        turns(integers_of(engine, "whole_turns")) {}

  friend bool operator==(const Motion& a, const Motion& b) {
    return same_bits(a.position, b.position) && same_bits(a.velocity, b.velocity) &&
           same_bits(a.integrals, b.integrals) && same_bits(a.clock, b.clock) &&
           a.cells == b.cells && a.turns == b.turns;
  }
};

inline Motion motion_at_end(std::string_view text, const std::vector<Setting>& settings = {},
                            const RunOptions& options = {}) {
  Engine engine(scene_of(text, settings), options);
  engine.run();
  return Motion(engine);
}

}  // namespace tomlin::test
