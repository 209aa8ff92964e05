#include "framework/plot/stored_run.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/scene/document.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLargestSummary = std::size_t{8} << 20;  // bytes

/// Of "a/b/" too; "." by what it is called.
std::string name_of(const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::absolute(folder, error).lexically_normal();
  const fs::path last = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
  return last.empty() ? folder.string() : last.string();
}

std::string written(const Node& node) {
  if (const auto* text = node.as<std::string>()) return *text;
  if (const auto* number = node.as<double>()) return fmt::format("{}", *number);
  if (const auto* integer = node.as<std::int64_t>()) {
    return fmt::format("{}", static_cast<double>(*integer));
  }
  return "";
}

/// Nothing where there is no such scene: figures can do without.
std::map<std::string, std::string> written_parameters(const SceneDocument& scene) {
  std::map<std::string, std::string> result;
  const Table* document = scene.contents();
  const Node* parameters = document == nullptr ? nullptr : document->find("parameters");
  const Table* table = parameters == nullptr ? nullptr : parameters->as<Table>();
  if (table == nullptr) return result;
  for (const Entry& entry : table->entries) result[entry.key] = written(entry.value);
  return result;
}

/// Numbers below this node, the components of lists by the names of axes.
void add_results(std::map<std::string, double>& results, const std::string& path,
                 const Json& node) {
  if (node.is_number()) {
    results[path] = node.get<double>();
  } else if (node.is_null()) {
    results[path] = std::numeric_limits<double>::quiet_NaN();
  } else if (node.is_object()) {
    for (const auto& [key, value] : node.items()) {
      add_results(results, fmt::format("{}.{}", path, key), value);
    }
  } else if (node.is_array() && node.size() <= std::size(kAxisNames)) {
    for (std::size_t k = 0; k < node.size(); ++k) {
      add_results(results, fmt::format("{}.{}", path, kAxisNames[k]), node[k]);
    }
  }
}

/// Of the scene: what it is called, not what came out.
bool is_result(const std::string& key) {
  static constexpr std::string_view kOther[] = {"program",    "scene",    "integrator",
                                                "parameters", "warnings", "warning_codes",
                                                "left_out",   "plugins",  "references"};
  return std::find(std::begin(kOther), std::end(kOther), key) == std::end(kOther);
}

}  // namespace

bool holds_run(const std::string& folder) {
  std::error_code error;
  return fs::is_regular_file(fs::path(folder) / kSummaryFile, error);
}

std::string result_name(const StoredRun& run, const std::string& path) {
  if (run.results.contains(path)) return path;
  std::string name;
  for (const char* family : {"drivers.", "bodies.", "observers.", "forces."}) {
    if (!run.results.contains(family + path)) continue;
    if (!name.empty()) return "";
    name = family + path;
  }
  return name;
}

std::string file_of(const StoredRun& run, const char* name) {
  return (fs::path(run.folder) / name).string();
}

StoredRun read_stored_run(const std::string& folder) {
  StoredRun run;
  run.folder = folder;
  run.name = name_of(folder);
  const std::string file = file_of(run, kSummaryFile);
  const TextFile summary = read_text_file(file, kLargestSummary);
  if (summary.too_large) {
    refuse_input(FaultCode::file_invalid, file, "", "this is too large for the summary of a run");
  }
  if (!summary.why.empty()) refuse_input(FaultCode::file_cannot_read, file, "", summary.why);
  const Json json = Json::parse(summary.text, nullptr, false);
  if (!json.is_object()) {
    refuse_input(FaultCode::file_invalid, file, "", "this is not the summary of a run");
  }
  const auto status = json.find("status");
  if (status == json.end() || !status->is_string()) {
    refuse_input(FaultCode::file_invalid, file, "", "there is no status in it");
  }
  run.status = status->get<std::string>();
  const auto parameters = json.find("parameters");
  if (parameters != json.end() && parameters->is_object()) {
    for (const auto& [name, value] : parameters->items()) {
      if (value.is_number()) run.parameters.emplace_back(name, value.get<double>());
    }
  }
  for (const auto& [key, value] : json.items()) {
    if (is_result(key)) add_results(run.results, key, value);
  }
  const auto system = Json::json_pointer("/scene/units");
  if (json.contains(system) && json[system].is_string()) {
    run.system = value_named<UnitSystem>(json[system].get<std::string>()).value_or(run.system);
  }
  const auto axes = Json::json_pointer("/scene/axes");
  if (json.contains(axes) && json[axes].is_object()) {
    for (const auto& [key, unit] : json[axes].items()) {
      if (unit.is_string()) run.units[key] = unit.get<std::string>();
    }
  }
  run.scene = std::make_shared<SceneDocument>(file_of(run, kSceneFile));
  run.written = written_parameters(*run.scene);
  return run;
}

}  // namespace tomlin
