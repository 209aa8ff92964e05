#include "framework/scene/settings.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kAdmissiblePaths =
    "a parameter's name, scene.KEY, box.KEY, run.KEY, measure.KEY, output.KEY, body.NAME.KEY, "
    "force.NAME.KEY, observer.NAME.KEY";

/// Not a table, and read before settings are.
constexpr const char* kPlugins = "plugins";
/// Not a part of what a run does.
constexpr const char* kSweep = "sweep";

bool holds(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> keys_of(const Table& table) {
  std::vector<std::string> keys;
  for (const Entry& entry : table.entries) keys.push_back(entry.key);
  return keys;
}

std::vector<std::string> parameter_names(const Table& document) {
  const Node* parameters = document.find("parameters");
  const Table* table = parameters ? parameters->as<Table>() : nullptr;
  return table ? keys_of(*table) : std::vector<std::string>();
}

/// One setting on its way into the document.
class Application {
 public:
  Application(const Setting& setting, std::uint32_t number, Table& document, FaultList& faults)
      : setting_(setting), document_(document), faults_(faults) {
    where_.setting = number;
  }

  void run() {
    for (const std::string* text : {&setting_.path, &setting_.value}) {
      if (valid_utf8_prefix(*text) < text->size()) {
        return refuse(FaultCode::scene_encoding, "not UTF-8 text");
      }
    }
    const auto parts = parts_of(setting_.path);
    if (holds(parts, "")) {
      return refuse(FaultCode::command_invalid_value, "not a path", kAdmissiblePaths);
    }
    if (parts.size() > static_cast<std::size_t>(kDeepestNesting)) {
      return refuse(FaultCode::scene_too_large, "nested too deeply",
                    fmt::format("at most {} levels", kDeepestNesting));
    }
    if (parts.size() == 1) return set_parameter(parts[0]);
    if (parts[0] == "parameters") {
      if (parts.size() == 2) return set_parameter(parts[1]);
      return refuse(FaultCode::scene_unknown_key, "a parameter has no keys below it",
                    kAdmissiblePaths);
    }
    if (parts[0] == "body" || parts[0] == "force" || parts[0] == "observer") {
      return set_in_component(parts);
    }
    set_in_section(parts);
  }

 private:
  void refuse(FaultCode code, std::string why, std::string admissible = "",
              std::string nearest = "") {
    // Neither path nor value need be fit to print as they are.
    Node value;
    value.where = where_;
    faults_.of_value(value, {code, shortened(setting_.path, kLongestShownValue), std::move(why),
                             std::move(admissible), std::move(nearest)});
  }

  void set_parameter(const std::string& name) {
    const auto names = parameter_names(document_);
    if (holds(names, name)) {
      return put(*document_.find("parameters")->as<Table>(), name);
    }
    if (name == kPlugins) {
      return refuse(FaultCode::command_invalid_value, "not set here",
                    "--plugin LIB, or the scene itself");
    }
    if (holds(top_level_keys(), name)) {
      return refuse(FaultCode::command_invalid_value, "a table, not a value", kAdmissiblePaths);
    }
    refuse(FaultCode::scene_unknown_key, "there is no such parameter",
           names.empty() ? kAdmissiblePaths : listed(names) + "; or a dotted path",
           nearest_name(name, names).value_or(""));
  }

  void set_in_section(const std::vector<std::string>& parts) {
    if (parts[0] == kSweep) {
      return refuse(FaultCode::command_invalid_value, "not set here",
                    "the options of tomlin sweep, or the scene itself");
    }
    std::vector<std::string> tables = top_level_keys();
    std::erase_if(tables,
                  [](const std::string& name) { return name == kPlugins || name == kSweep; });
    if (!holds(tables, parts[0])) {
      return refuse(FaultCode::scene_unknown_key, "there is no such table", listed(tables),
                    nearest_name(parts[0], tables).value_or(""));
    }
    set_below(document_, parts, 0);
    if (parts[0] == "run") replace_rival(parts[1]);
  }

  /// The last one set of an integrator and an accuracy is meant: removes the other.
  void replace_rival(const std::string& key) {
    Node* node = document_.find("run");
    Table* run = node ? node->as<Table>() : nullptr;
    if (run == nullptr) return;
    const char* rival = key == "accuracy" ? "integrator" : key == "integrator" ? "accuracy" : "";
    std::erase_if(run->entries, [&](const Entry& entry) { return entry.key == rival; });
  }

  void set_in_component(const std::vector<std::string>& parts) {
    if (parts.size() < 3) {
      return refuse(FaultCode::command_invalid_value, "not a path to a value", kAdmissiblePaths);
    }
    std::vector<std::string> names;
    Node* components = document_.find(parts[0]);
    if (List* list = components ? components->as<List>() : nullptr) {
      for (Node& component : *list) {
        Table* table = component.as<Table>();
        if (table == nullptr) continue;
        names.push_back(name_of(*table));
        if (names.back() == parts[1]) return set_below(*table, parts, 2);
      }
    }
    refuse(FaultCode::scene_unknown_name, "there is no " + parts[0] + " of that name",
           listed(names), nearest_name(parts[1], names).value_or(""));
  }

  /// Walk down tables from parts[next] on; what is absent is made.
  void set_below(Table& table, const std::vector<std::string>& parts, std::size_t next) {
    if (next + 1 == parts.size()) return put(table, parts[next]);
    if (table.find(parts[next]) == nullptr) table.set(parts[next], Node{Table{}, where_});
    Node* node = table.find(parts[next]);
    if (node->as<Table>() == nullptr) {
      return refuse(FaultCode::scene_unknown_key,
                    parts[next] + " is " + kind_of(*node) + ", which has no keys below it");
    }
    set_below(*node->as<Table>(), parts, next + 1);
  }

  void put(Table& table, const std::string& key) {
    Node value = parse_setting(setting_.value, where_.setting);
    const auto* text = value.as<std::string>();
    const bool plain = text != nullptr && *text == setting_.value;
    if (const auto fault = plain ? explain_setting(setting_.value) : std::nullopt) {
      // The usual reason: quotes inside of the option that the shell has taken for its own.
      const std::string whole = "the whole option in single quotes";
      return refuse(fault->code, fault->why,
                    fault->admissible.empty() ? whole : fault->admissible + "; " + whole);
    }
    table.set(key, std::move(value));
  }

  const Setting& setting_;
  Table& document_;
  FaultList& faults_;
  Extent where_;
};

}  // namespace

std::vector<std::string> parts_of(std::string_view path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::string name_of(const Table& component) {
  for (const char* key : {"name", "type"}) {
    const Node* node = component.find(key);
    if (node && node->as<std::string>()) return *node->as<std::string>();
  }
  return "";
}

void apply_settings(const std::vector<Setting>& settings, Table& document, FaultList& faults) {
  if (settings.size() > kMostSettings) {
    Extent last;
    last.setting = static_cast<std::uint32_t>(settings.size());
    faults.of_key(last, {FaultCode::scene_too_large, "",
                         fmt::format("{} settings are too many", settings.size()),
                         fmt::format("at most {}", kMostSettings)});
    faults.throw_if_any();
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    Application(settings[i], static_cast<std::uint32_t>(i + 1), document, faults).run();
  }
}

}  // namespace tomlin
