#include "framework/cli/diagnostics.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

bool is_command(std::string_view example) { return example.starts_with("tomlin "); }

/// "scene" of "scene.unknown_key".
std::string_view group_of(const FaultKind& kind) { return kind.id.substr(0, kind.id.find('.')); }

}  // namespace

Json faults_json(const std::vector<Fault>& faults) {
  const auto text = [](const std::string& given) { return given.empty() ? Json() : Json(given); };
  const auto position = [](int given) { return given > 0 ? Json(given) : Json(); };
  Json list = Json::array();
  for (const Fault& fault : faults) {
    list.push_back(Json{{"code", id_of(fault.code)},
                        {"file", fault.location.file},
                        {"line", position(fault.location.line)},
                        {"column", position(fault.location.column)},
                        {"key", text(fault.key)},
                        {"value", text(fault.value)},
                        {"why", fault.why},
                        {"admissible", text(fault.admissible)},
                        {"did_you_mean", text(fault.nearest)}});
  }
  return list;
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string diagnostic_text(const FaultKind& kind) {
  return fmt::format("{} ({})\n\nmeaning\n  {}\n\nexample\n  {}\n\ncure\n  {}\n", kind.id,
                     to_string(kind.severity), kind.meaning, kind.example, kind.cure);
}

Json diagnostic_json(const FaultKind& kind) {
  return {
      {"name", kind.id},         {"kind", "diagnostic"},    {"severity", to_string(kind.severity)},
      {"meaning", kind.meaning}, {"example", kind.example}, {"cure", kind.cure}};
}

std::string diagnostics_text() {
  std::size_t width = 0;
  for (const FaultKind& kind : fault_kinds()) width = std::max(width, kind.id.size());
  std::string text = "diagnostics\n";
  for (const FaultKind& kind : fault_kinds()) {
    fmt::format_to(std::back_inserter(text), "  {:<{}}  {:<7}  {}\n", kind.id, width,
                   to_string(kind.severity), kind.meaning);
  }
  return text + "\n`tomlin describe CODE` shows one with an example and a cure.\n";
}

Json diagnostics_json() {
  Json list = Json::array();
  for (const FaultKind& kind : fault_kinds()) list.push_back(diagnostic_json(kind));
  return {{"name", "diagnostics"}, {"kind", "diagnostics"}, {"codes", std::move(list)}};
}

std::string diagnostic_section(const FaultKind& kind) {
  return fmt::format("### {}\n\n{}{}\n\n- Example: {}\n- Cure: {}\n\n", kind.id,
                     kind.severity == Severity::warning ? "*Warning.* " : "", kind.meaning,
                     is_command(kind.example) ? fmt::format("`{}`", kind.example) : kind.example,
                     kind.cure);
}

std::string diagnostics_section() {
  std::string text;
  std::string_view group;
  for (const FaultKind& kind : fault_kinds()) {
    if (group_of(kind) != group) {
      group = group_of(kind);
      text += fmt::format("## {}\n\n", group);
    }
    text += diagnostic_section(kind);
  }
  text.pop_back();
  return text;
}

}  // namespace tomlin
