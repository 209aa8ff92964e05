#include "framework/output/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/records/integrator.hpp"
#include "framework/output/checksum.hpp"
#include "framework/output/references.hpp"
#include "framework/output/this_machine.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/engine_units.hpp"
#include "framework/scene/language.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

// JSON knows neither nan nor inf.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json number(const std::optional<double>& x) { return x ? number(*x) : Json(); }

/// A vector at the end of the run is always a list, whatever its numbers; one of a window that the
/// run has not reached is null.
Json value_entry(const ResultValue& value) {
  const ResultQuantity& quantity = value.quantity();
  if (quantity.shape == Shape::vector && value.has_value()) {
    Json list = Json::array();
    for (std::size_t k = 0; k < value.count(); ++k) list.push_back(number(value.finite(k)));
    return list;
  }
  const std::optional<double> x = value.finite(0);
  if (!x) return {};
  return quantity.shape == Shape::count ? Json(static_cast<std::uint64_t>(*x)) : Json(*x);
}

Json group_entry(const ResultGroup& group) {
  Json entry = Json::object();
  for (const ResultValue& value : group.values) {
    entry[value.quantity().key] = value_entry(value);
  }
  return entry;
}

/// "force", "on" and "body" of "force.on.body"; none of a group of the whole run.
std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  while (!name.empty()) {
    const std::size_t dot = std::min(name.find('.'), name.size());
    parts.emplace_back(name.substr(0, dot));
    name.remove_prefix(std::min(dot + 1, name.size()));
  }
  return parts;
}

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json failure_entry(const RunFailure& failure) {
  Json entry;
  entry["code"] = id_of(failure.code);
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

Json determined_entry(const DeterminedResult& found) {
  return {{"value", number(found.value)},
          {"spread", number(found.spread)},
          {"digits", number(found.digits)},
          {"min", number(found.min)},
          {"max", number(found.max)}};
}

/// Version of the layout of a summary: another one when a key goes or means something else.
constexpr int kSummaryFormat = 1;

Json program_entry() {
  return {{"name", "tomlin"}, {"version", TOMLIN_VERSION}, {"format", kSummaryFormat}};
}

/// The hash is that of `scene.toml`, however the scene got its values.
Json scene_entry(const Scene& scene) {
  const auto bytes = std::as_bytes(std::span<const char>(scene.effective_toml));
  Json entry = {{"name", text_or_null(scene.name)},
                {"xxh3_64", fmt::format("{:016x}", checksum_of(bytes, 0))}};
  if (scene.units != UnitSystem::reduced) entry["units"] = to_string(scene.units);
  static const TableLayout axes = axes_layout();
  for (const Parameter& row : axes.rows) {
    const auto unit = std::get<std::string>(row.read(&scene.axes));
    if (!unit.empty()) entry["axes"][row.key] = unit;
  }
  return entry;
}

Json value_entry(const std::optional<Node>& node) {
  if (!node) return {};
  if (const auto* x = node->as<double>()) return number(*x);
  if (const auto* n = node->as<std::int64_t>()) return *n;
  if (const auto* flag = node->as<bool>()) return *flag;
  if (const auto* text = node->as<std::string>()) return *text;
  return {};
}

/// The integrator has all of its keys, those left to their defaults too; with an accuracy it is the
/// one that was chosen.
Json integrator_entry(const Scene& scene, const RunResult& result) {
  const auto value_of = [&](const Parameter& row) {
    return in_scene_units(row.read(scene.run.integrator.description.get()),
                          scene_unit(scene.units, row.dimension));
  };
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
      entry[row.key] = value_entry(to_node(value_of(row)));
    } else {
      entry[row.key] = row.standard ? value_entry(to_node(*row.standard)) : Json();
    }
  }
  return entry;
}

/// All that may differ between two runs of a scene to the same results.
Json performance_entry(const Scene& scene, const RunResult& result) {
  const Machine machine = this_machine();
  Json entry;
  for (const ResultGroup& group : groups_of_run(result)) {
    if (group.family == "performance") entry = group_entry(group);
  }
  entry["scene_file"] = scene.file;
  entry["instruction_set"] = to_string(result.instruction_set);
  entry["processor"] = text_or_null(machine.processor);
  entry["system"] = text_or_null(machine.system);
  return entry;
}

Json references_entry(const Scene& scene, const RunResult& result) {
  Json list = Json::array();
  for (const CitedWork& one : references(scene, result.accuracy ? &*result.accuracy : nullptr)) {
    list.push_back({{"source", one.work}, {"for", one.used_for}});
  }
  return list;
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

  for (const ResultGroup& group : groups_of_run(result)) {
    if (group.family != "performance") summary[group.family] = group_entry(group);
  }
  for (const char* family : {"drivers", "bodies"}) summary[family] = Json::object();
  for (const ResultGroup& group : result.groups) {
    Json* entry = &summary[group.family];
    for (const std::string& part : parts_of(group.name)) entry = &(*entry)[part];
    *entry = group_entry(group);
  }
  if (result.steady) {
    summary["until"] = {{"steady", result.steady->path},
                        {"reached", result.steady->reached},
                        {"periods", result.steady->periods},
                        {"change", number(result.steady->change)}};
  }

  if (result.until_error) {
    summary["until"] = {{"of", result.until_error->path},
                        {"asked", number(result.until_error->asked)},
                        {"reached", result.until_error->reached},
                        {"error", number(result.until_error->error)}};
  }

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

  summary["warnings"] = texts_of(result.warnings);
  summary["warning_codes"] = codes_of(result.warnings);
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
