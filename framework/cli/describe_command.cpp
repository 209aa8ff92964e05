#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/commands.hpp"
#include "framework/cli/component_text.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/core/body.hpp"
#include "framework/core/fault.hpp"
#include "framework/core/force.hpp"
#include "framework/core/integrator.hpp"
#include "framework/core/nearest_name.hpp"
#include "framework/core/observer.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

/// "a, b, c"
std::string listed(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// A component and how a scene takes it.
struct Described {
  std::string kind;
  const ComponentRecord* record = nullptr;
  TableLayout layout;
  const ForceRecord* force = nullptr;            ///< null for another kind
  const IntegratorRecord* integrator = nullptr;  ///< likewise
};

std::vector<Described> all_components(const Registry& registry) {
  std::vector<Described> all;
  for (const auto& record : registry.bodies()) {
    all.push_back({"body", record.get(), body_layout(*record), nullptr, nullptr});
  }
  for (const auto& record : registry.forces()) {
    all.push_back({"force", record.get(), force_layout(*record), record.get(), nullptr});
  }
  for (const auto& record : registry.integrators()) {
    all.push_back({"integrator", record.get(), integrator_layout(*record), nullptr, record.get()});
  }
  for (const auto& record : registry.observers()) {
    all.push_back({"observer", record.get(), observer_layout(*record), nullptr, nullptr});
  }
  return all;
}

constexpr std::array<std::pair<const char*, const char*>, 4> kKinds = {
    std::pair{"body", "bodies"}, std::pair{"force", "forces"},
    std::pair{"integrator", "integrators"}, std::pair{"observer", "observers"}};

const Described& find(const std::vector<Described>& all, const std::string& name) {
  std::vector<std::string> names;
  for (const Described& component : all) {
    if (component.record->name == name) return component;
    names.push_back(component.record->name);
  }
  Fault fault;
  fault.place.file = "tomlin";
  fault.why = fmt::format("there is no component \"{}\"", name);
  for (const auto& [kind, kinds] : kKinds) {
    if (is_later_type(kind, name)) fault.why = fmt::format("\"{}\" is not in this version", name);
  }
  fault.admissible = listed(names);
  fault.nearest = nearest_name(name, names).value_or("");
  throw InputError({fault});
}

using Claim = std::pair<const char*, bool>;

std::array<Claim, 8> claims(const Traits& traits) {
  return {Claim{"conservative", traits.conservative},
          Claim{"depends on velocity", traits.depends_on_velocity},
          Claim{"depends on time", traits.depends_on_time},
          Claim{"stochastic", traits.stochastic},
          Claim{"internal", traits.internal},
          Claim{"periodic", traits.periodic},
          Claim{"dissipative", traits.dissipative},
          Claim{"does work", traits.does_work}};
}

std::string default_text(const Parameter& row) {
  if (row.required()) return "required";
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  return standard ? "default " + value_text(*standard) : "may be absent";
}

/// What scenes may say one day: keys, words of a key, and values but the default.
std::vector<std::pair<std::string, std::string>> later(const TableLayout& layout) {
  std::vector<std::pair<std::string, std::string>> result;
  for (const ReservedKey& key : layout.reserved) result.emplace_back(key.key, key.note);
  for (const Parameter& row : layout.rows) {
    if (row.only_standard) result.emplace_back(row.key, "any value but the default");
    if (!row.later_choices.empty()) {
      result.emplace_back(row.key, fmt::format("\"{}\"", fmt::join(row.later_choices, "\", \"")));
    }
  }
  return result;
}

// ---- text

std::string origin_in_brackets(const ComponentRecord& record) {
  return record.library.empty() ? "" : " (" + record.library + ")";
}

std::string list_text(const std::vector<Described>& all) {
  std::size_t width = 0;
  for (const Described& component : all) width = std::max(width, component.record->name.size());
  std::string text;
  for (const auto& [kind, kinds] : kKinds) {
    const auto is_one = [name = kind](const Described& one) { return one.kind == name; };
    if (std::none_of(all.begin(), all.end(), is_one)) continue;
    text += std::string(kinds) + "\n";
    for (const Described& component : all) {
      if (component.kind != kind) continue;
      fmt::format_to(std::back_inserter(text), "  {:<{}}  {}{}\n", component.record->name, width,
                     component.record->summary, origin_in_brackets(*component.record));
    }
  }
  return text +
         "\n`tomlin describe NAME` shows one with its equation, parameters and an example.\n";
}

void append_indented(std::string& text, std::string_view lines) {
  while (!lines.empty()) {
    const auto end = std::min(lines.find('\n'), lines.size());
    const auto line = lines.substr(0, end);
    text += line.empty() ? "\n" : "  " + std::string(line) + "\n";
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
}

void append_traits(std::string& text, const Described& component) {
  if (component.force != nullptr) {
    std::vector<std::string> held;
    for (const auto& [name, holds] : claims(component.force->traits)) {
      if (holds) held.emplace_back(name);
    }
    text += std::string("\nacts on\n  ") + to_string(component.force->element) + "\n";
    text += "\ntraits\n  " + (held.empty() ? "none" : listed(held)) + "\n";
  }
  if (component.integrator != nullptr) {
    fmt::format_to(std::back_inserter(text),
                   "\ntraits\n  order {}, {}, {} evaluations of all forces per step\n",
                   component.integrator->order,
                   component.integrator->adaptive ? "adaptive steps" : "fixed steps",
                   component.integrator->evaluations_per_step);
  }
}

std::string component_text(const Described& component) {
  const ComponentRecord& record = *component.record;
  std::string text = fmt::format("{} ({}): {}\n", record.name, component.kind, record.summary);
  text += "\nequation\n";
  append_indented(text, record.equation);
  text += "\nsource\n";
  append_indented(text, record.source);
  text += "\ncomes from\n  ";
  text += (record.library.empty() ? "tomlin itself" : "the plugin " + record.library) + "\n";
  append_traits(text, component);
  text += "\nparameters\n";
  for (const Parameter& row : component.layout.rows) {
    fmt::format_to(std::back_inserter(text), "  {} [{}]: {}\n      {}; {}\n", row.key,
                   to_string(row.dimension), row.doc, what_is_due(row), default_text(row));
  }
  fmt::format_to(std::back_inserter(text), "\nevery {} also takes\n", component.kind);
  for (const OwnKey& own : component.layout.own_keys) {
    text += "  " + own.key + ": " + own.doc + "\n";
  }
  if (const auto to_come = later(component.layout); !to_come.empty()) {
    text += "\nnot in this version\n";
    for (const auto& [key, note] : to_come) {
      text += "  " + key + (note.empty() ? "" : ": " + note) + "\n";
    }
  }
  text += "\nexample\n";
  append_indented(text, record.example);
  return text;
}

// ---- JSON

Json json_of(const Node& node) {
  return std::visit(
      [](const auto& given) -> Json {
        using Kind = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Kind, List>) {
          Json list = Json::array();
          for (const Node& element : given) list.push_back(json_of(element));
          return list;
        } else if constexpr (std::is_same_v<Kind, Table>) {
          Json object = Json::object();
          for (const Entry& entry : given.entries) object[entry.key] = json_of(entry.value);
          return object;
        } else if constexpr (std::is_same_v<Kind, Moment>) {
          return nullptr;
        } else {
          return given;
        }
      },
      node.value);
}

/// What kind of value a row takes.
const char* kind_name(const Parameter& row) {
  static constexpr std::array kNames = {"number",
                                        "integer",
                                        "boolean",
                                        "word",
                                        "vector",
                                        "number_per_particle",
                                        "vector_per_particle",
                                        "pairs",
                                        "word_or_numbers",
                                        "attachment",
                                        "points",
                                        "words",
                                        "flags",
                                        "passing"};
  static_assert(kNames.size() == std::variant_size_v<ParameterValue>, "each kind has its name");
  return kNames[row.prototype.index()];
}

Json parameter_json(const Parameter& row) {
  Json entry;
  entry["key"] = row.key;
  entry["kind"] = kind_name(row);
  entry["dimension"] = to_string(row.dimension);
  entry["required"] = row.required();
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  entry["default"] = standard ? json_of(*standard) : Json();
  entry["admissible"] = what_is_due(row);
  entry["choices"] = row.choices;
  entry["doc"] = row.doc;
  return entry;
}

Json traits_json(const Described& component) {
  Json traits = Json::object();
  if (component.force != nullptr) {
    for (const auto& [name, holds] : claims(component.force->traits)) {
      std::string key = name;
      std::replace(key.begin(), key.end(), ' ', '_');
      traits[key] = holds;
    }
  }
  if (component.integrator != nullptr) {
    traits["order"] = component.integrator->order;
    traits["adaptive"] = component.integrator->adaptive;
    traits["evaluations_per_step"] = component.integrator->evaluations_per_step;
  }
  return traits;
}

Json component_json(const Described& component) {
  const ComponentRecord& record = *component.record;
  Json entry;
  entry["name"] = record.name;
  entry["kind"] = component.kind;
  entry["summary"] = record.summary;
  entry["equation"] = record.equation;
  entry["source"] = record.source;
  entry["library"] = record.library.empty() ? Json() : Json(record.library);
  if (component.force != nullptr) entry["acts_on"] = to_string(component.force->element);
  entry["traits"] = traits_json(component);
  entry["parameters"] = Json::array();
  for (const Parameter& row : component.layout.rows) {
    entry["parameters"].push_back(parameter_json(row));
  }
  entry["other_keys"] = Json::array();
  for (const OwnKey& own : component.layout.own_keys) {
    entry["other_keys"].push_back(Json{{"key", own.key}, {"doc", own.doc}});
  }
  entry["not_in_this_version"] = Json::array();
  for (const auto& [key, note] : later(component.layout)) {
    entry["not_in_this_version"].push_back(Json{{"key", key}, {"note", note}});
  }
  entry["example"] = record.example;
  return entry;
}

Json list_json(const std::vector<Described>& all) {
  Json list;
  for (const auto& [kind, kinds] : kKinds) {
    list[kinds] = Json::array();
    for (const Described& component : all) {
      if (component.kind != kind) continue;
      list[kinds].push_back(
          Json{{"name", component.record->name}, {"summary", component.record->summary}});
    }
  }
  return list;
}

}  // namespace

int describe_command(const DescribeArguments& arguments) {
  const Registry registry = registry_with_plugins(arguments.plugins, {});
  const auto all = all_components(registry);
  if (arguments.name.empty()) {
    return print_result(arguments.json ? list_json(all).dump(2) + "\n" : list_text(all));
  }
  const Described& component = find(all, arguments.name);
  return print_result(arguments.json ? component_json(component).dump(2) + "\n"
                                     : component_text(component));
}

}  // namespace tomlin
