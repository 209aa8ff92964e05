#include "framework/output/summary.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/integrator.hpp"
#include "framework/output/checksum.hpp"
#include "framework/output/machine.hpp"
#include "framework/output/references.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

// JSON knows neither nan nor inf.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json number(const std::optional<double>& x) { return x ? number(*x) : Json(); }

Json count(const std::optional<std::uint64_t>& n) { return n ? Json(*n) : Json(); }

Json by_axis(const std::vector<double>& components) {
  if (components.empty()) return {};
  Json list = Json::array();
  for (const double x : components) list.push_back(number(x));
  return list;
}

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json failure_entry(const RunFailure& failure) {
  Json entry;
  entry["step"] = failure.step;
  entry["time"] = number(failure.time);
  entry["body"] = text_or_null(failure.body);
  entry["particle"] = failure.particle >= 0 ? Json(failure.particle) : Json();
  entry["axis"] = text_or_null(failure.axis);
  entry["force"] = text_or_null(failure.force);
  entry["what"] = failure.what;
  entry["cause"] = failure.cause;
  return entry;
}

Json driver_entry(const DriverResult& driver) {
  Json entry;
  entry["mean_force"] = by_axis(driver.mean_force);
  entry["final_force"] = by_axis(driver.final_force);
  entry["max_force"] = by_axis(driver.max_force);
  entry["min_force"] = by_axis(driver.min_force);
  entry["static_force"] = number(driver.static_force);
  entry["work"] = number(driver.work);
  entry["work_per_distance"] = number(driver.work_per_distance);
  entry["distance"] = number(driver.distance);
  return entry;
}

Json energy_entry(const EnergyResult& energy) {
  return {{"kinetic", number(energy.kinetic)},
          {"potential", number(energy.potential)},
          {"work_in", number(energy.work_in)},
          {"heat_out", number(energy.heat_out)},
          {"stored_change", number(energy.stored_change)},
          {"numerical_work", number(energy.numerical_work)}};
}

Json equilibrium_entry(const EquilibriumResult& equilibrium) {
  return {{"energy", number(equilibrium.energy)},
          {"neutral_directions", equilibrium.neutral_directions},
          {"smallest_curvature", number(equilibrium.smallest_curvature)},
          {"log_determinant", number(equilibrium.log_determinant)}};
}

Json determined_entry(const DeterminedResult& found) {
  return {{"value", number(found.value)},
          {"spread", number(found.spread)},
          {"digits", number(found.digits)},
          {"min", number(found.min)},
          {"max", number(found.max)}};
}

Json body_entry(const BodyResult& body, bool planar) {
  Json entry;
  entry["centre_of_mass"] = by_axis(body.centre_of_mass);
  entry["velocity"] = by_axis(body.velocity);
  if (planar) {
    entry["rotation"] = number(body.rotation);
    entry["turns"] = number(body.turns);
    entry["rolling"] = number(body.rolling);
  }
  entry["mean_velocity"] = by_axis(body.mean_velocity);
  entry["max_speed"] = number(body.max_speed);
  return entry;
}

/// Of the layout of a summary: another one when a key goes or means something else.
constexpr int kFormat = 1;

Json program_entry() {
  return {{"name", "tomlin"}, {"version", TOMLIN_VERSION}, {"format", kFormat}};
}

/// The hash is that of `scene.toml`, however the scene got its values.
Json scene_entry(const Scene& scene) {
  const auto bytes = std::as_bytes(std::span<const char>(scene.effective_toml));
  return {{"name", text_or_null(scene.name)},
          {"xxh3_64", fmt::format("{:016x}", checksum_of(bytes, 0))}};
}

Json value_entry(const std::optional<Node>& node) {
  if (!node) return {};
  if (const auto* x = node->as<double>()) return number(*x);
  if (const auto* n = node->as<std::int64_t>()) return *n;
  if (const auto* flag = node->as<bool>()) return *flag;
  if (const auto* text = node->as<std::string>()) return *text;
  return {};
}

/// With all of its keys, those left to their defaults too; with an accuracy the one that was taken.
Json integrator_entry(const Scene& scene, const RunResult& result) {
  const SceneIntegrator& asked = scene.run.integrator;
  const IntegratorRecord* scheme = result.accuracy      ? result.accuracy->scheme
                                   : scene.run.accuracy ? nullptr
                                                        : asked.record;
  if (scheme == nullptr) return {};
  const Node taken = parse_setting(result.accuracy ? result.accuracy->integrator : "", 1);
  const Table* given = taken.as<Table>();
  Json entry = {{"type", scheme->name}};
  for (const Parameter& row : scheme->parameters) {
    const Node* written = given ? given->find(row.key) : nullptr;
    if (written != nullptr) {
      entry[row.key] = value_entry(*written);
    } else if (!result.accuracy) {
      entry[row.key] = value_entry(to_node(row.read(asked.description.get())));
    } else {
      entry[row.key] = row.standard ? value_entry(to_node(*row.standard)) : Json();
    }
  }
  return entry;
}

/// All that may differ between two runs of a scene to the same results.
Json performance_entry(const Scene& scene, const RunResult& result) {
  const Machine machine = this_machine();
  return {{"wall_seconds", number(result.wall_seconds)},
          {"steps_per_second", number(result.steps_per_second)},
          {"scene_file", scene.file},
          {"instruction_set", std::string(to_string(result.instruction_set))},
          {"processor", text_or_null(machine.processor)},
          {"system", text_or_null(machine.system)}};
}

Json references_entry(const Scene& scene, const RunResult& result) {
  Json list = Json::array();
  for (const CitedWork& one : references(scene, result.accuracy ? &*result.accuracy : nullptr)) {
    list.push_back({{"source", one.work}, {"for", one.used_for}});
  }
  return list;
}

Json observer_entry(const ObserverResult& observer) {
  Json entry = Json::object();
  for (const ObserverResult::Number& one : observer.numbers) {
    entry[one.name] = number(one.value);
    entry["mean_" + one.name] = number(one.mean);
  }
  return entry;
}

}  // namespace

std::string summary_json(const Scene& scene, const RunResult& result) {
  Json summary;
  summary["status"] = to_string(result.status);
  if (result.failure) summary["failure"] = failure_entry(*result.failure);
  summary["program"] = program_entry();
  summary["scene"] = scene_entry(scene);
  summary["integrator"] = integrator_entry(scene, result);

  summary["parameters"] = Json::object();
  for (const auto& [name, value] : scene.parameters) summary["parameters"][name] = number(value);

  summary["time"] = {{"end", number(result.end_time)},
                     {"steps", result.steps},
                     {"force_evaluations", result.force_evaluations},
                     {"jacobian_columns", result.jacobian_columns},
                     {"refused_steps", result.refused_steps}};
  summary["window"] = {{"from", number(result.window_from)}, {"to", number(result.window_to)}};

  summary["drivers"] = Json::object();
  for (const DriverResult& driver : result.drivers) {
    summary["drivers"][driver.name] = driver_entry(driver);
  }
  summary["bodies"] = Json::object();
  for (const BodyResult& body : result.bodies) {
    summary["bodies"][body.name] = body_entry(body, scene.dimension == 2);
  }

  if (!result.observers.empty()) {
    summary["observers"] = Json::object();
    for (const ObserverResult& observer : result.observers) {
      summary["observers"][observer.name] = observer_entry(observer);
    }
  }

  summary["events"] = {{"slips", count(result.events.slips)},
                       {"hops", count(result.events.hops)},
                       {"turns", count(result.events.turns)},
                       {"reversals", count(result.events.reversals)},
                       {"driver_reversals", count(result.events.driver_reversals)},
                       {"ties", count(result.events.ties)}};
  if (result.steady) {
    summary["until"] = {{"steady", result.steady->path},
                        {"reached", result.steady->reached},
                        {"periods", result.steady->periods},
                        {"change", number(result.steady->change)}};
  }

  if (result.equilibrium) summary["equilibrium"] = equilibrium_entry(*result.equilibrium);
  if (result.energy) summary["energy"] = energy_entry(*result.energy);
  if (!result.determined.empty()) {
    summary["determined"] = Json::object();
    for (const DeterminedResult& found : result.determined) {
      summary["determined"][found.path] = determined_entry(found);
    }
  }

  if (result.accuracy) {
    const AccuracyResult& accuracy = *result.accuracy;
    summary["accuracy"] = {
        {"asked", number(accuracy.asked)},   {"integrator", accuracy.integrator},
        {"companion", accuracy.companion},   {"second_companion", accuracy.second_companion},
        {"pilot_cost", accuracy.pilot_cost}, {"companion_cost", accuracy.companion_cost}};
  }
  if (!result.errors.empty()) {
    summary["error"] = Json::object();
    for (const ErrorEstimate& one : result.errors) summary["error"][one.path] = number(one.error);
  }

  summary["warnings"] = result.warnings;
  summary["left_out"] = Json::array();
  for (const auto& [force, why] : result.left_out) {
    summary["left_out"].push_back({{"force", force}, {"why", why}});
  }
  summary["references"] = references_entry(scene, result);
  if (!scene.libraries.empty()) {
    summary["plugins"] = Json::array();
    for (const Library& library : scene.libraries) {
      summary["plugins"].push_back(
          {{"given", library.given}, {"path", library.path}, {"xxh3_128", library.hash}});
    }
  }
  summary["performance"] = performance_entry(scene, result);
  return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tomlin
