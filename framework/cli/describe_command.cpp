#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/commands.hpp"
#include "framework/cli/described.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/node_json.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/reference_pages.hpp"
#include "framework/core/body.hpp"
#include "framework/core/citation.hpp"
#include "framework/core/fault.hpp"
#include "framework/core/force.hpp"
#include "framework/core/integrator.hpp"
#include "framework/core/nearest_name.hpp"
#include "framework/core/observer.hpp"
#include "framework/output/output_file.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// "a, b, c"
std::string listed(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// nullptr when there is none of that name.
const Described* find(const std::vector<Described>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&name](const auto& one) { return one.record->name == name; });
  return found == all.end() ? nullptr : &*found;
}

const SceneTable* find(const std::vector<SceneTable>& tables, const std::string& name) {
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&name](const auto& table) { return table.name == name; });
  return found == tables.end() ? nullptr : &*found;
}

[[noreturn]] void refuse(const std::string& name, const std::vector<Described>& all,
                         const std::vector<SceneTable>& tables) {
  std::vector<std::string> names;
  names.reserve(all.size() + tables.size());
  for (const Described& component : all) names.push_back(component.record->name);
  for (const SceneTable& table : tables) names.push_back(table.name);
  Fault fault;
  fault.place.file = "tomlin";
  fault.why = fmt::format("there is no component \"{}\"", name);
  fault.admissible = listed(names);
  fault.nearest = nearest_name(name, names).value_or("");
  throw InputError({fault});
}

// ---- text

std::string origin_in_brackets(const ComponentRecord& record) {
  return record.library.empty() ? "" : " (" + record.library + ")";
}

std::string list_text(const std::vector<Described>& all, const std::vector<SceneTable>& tables) {
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
  text += "tables of a scene\n";
  for (const SceneTable& table : tables) {
    fmt::format_to(std::back_inserter(text), "  {:<{}}  {}\n", table.name, width, table.summary);
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
  if (component.kind == "body") return;
  if (component.force != nullptr) {
    text += "\nacts on\n  " + acts_on(*component.force) + "\n";
  }
  const auto held = trait_words(component);
  text += "\ntraits\n  " + (held.empty() ? "none" : listed(held)) + "\n";
  text += "\nnumbers\n  " + listed(number_types(component)) + "\n";
}

void append_sources(std::string& text, const std::string& source) {
  text += "\nsource\n";
  for (const auto& [work, place] : citations(source)) {
    text += "  " + work + (place.empty() ? "" : ", " + place) + "\n";
  }
}

void append_rows(std::string& text, const std::vector<Parameter>& rows) {
  text += "\nparameters\n";
  for (const Parameter& row : rows) {
    fmt::format_to(std::back_inserter(text), "  {} [{}]: {}\n      {}; {}\n", row.key,
                   to_string(row.dimension), row.doc, what_is_due(row), default_text(row));
  }
}

void append_own_keys(std::string& text, const std::string& title, const std::vector<OwnKey>& keys) {
  if (keys.empty()) return;
  text += "\n" + title + "\n";
  for (const OwnKey& own : keys) text += "  " + own.key + ": " + own.doc + "\n";
}

void append_later(std::string& text, const TableLayout& layout) {
  const auto to_come = later(layout);
  if (to_come.empty()) return;
  text += "\nnot in this version\n";
  for (const auto& [key, note] : to_come) {
    text += "  " + key + (note.empty() ? "" : ": " + note) + "\n";
  }
}

std::string table_text(const SceneTable& table) {
  std::string text = fmt::format("[{}]: {}\n", table.name, table.summary);
  append_rows(text, table.layout.rows);
  append_own_keys(text, "and", table.layout.own_keys);
  append_later(text, table.layout);
  return text;
}

std::string component_text(const Described& component) {
  const ComponentRecord& record = *component.record;
  std::string text = fmt::format("{} ({}): {}\n", record.name, component.kind, record.summary);
  text += "\nequation\n";
  append_indented(text, record.equation);
  append_sources(text, record.source);
  text += "\ncomes from\n  ";
  text += (record.library.empty() ? "tomlin itself" : "the plugin " + record.library) + "\n";
  append_traits(text, component);
  append_rows(text, component.layout.rows);
  append_own_keys(text, "every " + component.kind + " also takes", component.layout.own_keys);
  append_later(text, component.layout);
  text += "\nexample\n";
  append_indented(text, record.example);
  return text;
}

// ---- JSON

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
                                        "passing",
                                        "formula",
                                        "formulas",
                                        "angles"};
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

template <class Claims>
void append_claims(Json& traits, const Claims& given) {
  for (const auto& [name, holds] : given) {
    std::string key = name;
    std::replace(key.begin(), key.end(), ' ', '_');
    traits[key] = holds;
  }
}

Json citations_json(const std::string& source) {
  Json list = Json::array();
  for (const auto& [work, place] : citations(source)) {
    list.push_back(Json{{"work", work}, {"place", place}});
  }
  return list;
}

Json traits_json(const Described& component) {
  Json traits = Json::object();
  if (component.force != nullptr) {
    append_claims(traits, claims(component.force->traits));
  }
  if (component.integrator != nullptr) {
    traits["order"] = component.integrator->order;
    traits["evaluations_per_step"] = component.integrator->evaluations_per_step;
    append_claims(traits, abilities(*component.integrator));
  }
  return traits;
}

void append_layout(Json& entry, const TableLayout& layout) {
  entry["parameters"] = Json::array();
  for (const Parameter& row : layout.rows) {
    entry["parameters"].push_back(parameter_json(row));
  }
  entry["other_keys"] = Json::array();
  for (const OwnKey& own : layout.own_keys) {
    entry["other_keys"].push_back(Json{{"key", own.key}, {"doc", own.doc}});
  }
  entry["not_in_this_version"] = Json::array();
  for (const auto& [key, note] : later(layout)) {
    entry["not_in_this_version"].push_back(Json{{"key", key}, {"note", note}});
  }
}

Json table_json(const SceneTable& table) {
  Json entry = {{"name", table.name}, {"kind", "table"}, {"summary", table.summary}};
  append_layout(entry, table.layout);
  return entry;
}

Json component_json(const Described& component) {
  const ComponentRecord& record = *component.record;
  Json entry;
  entry["name"] = record.name;
  entry["kind"] = component.kind;
  entry["summary"] = record.summary;
  entry["equation"] = record.equation;
  entry["source"] = record.source;
  entry["works"] = citations_json(record.source);
  if (component.force != nullptr) entry["acts_on"] = acts_on(*component.force);
  entry["library"] = record.library.empty() ? Json() : Json(record.library);
  entry["traits"] = traits_json(component);
  if (component.kind != "body") entry["number_types"] = number_types(component);
  append_layout(entry, component.layout);
  entry["example"] = record.example;
  return entry;
}

Json list_json(const std::vector<Described>& all, const std::vector<SceneTable>& tables) {
  Json list;
  for (const auto& [kind, kinds] : kKinds) {
    list[kinds] = Json::array();
    for (const Described& component : all) {
      if (component.kind != kind) continue;
      list[kinds].push_back(
          Json{{"name", component.record->name}, {"summary", component.record->summary}});
    }
  }
  list["tables"] = Json::array();
  for (const SceneTable& table : tables) {
    list["tables"].push_back(Json{{"name", table.name}, {"summary", table.summary}});
  }
  return list;
}

// ---- Markdown

std::string all_pages(const Registry& registry) {
  std::string text;
  for (const ReferencePage& page : reference_pages(registry)) {
    text += (text.empty() ? "" : "\n") + page.text;
  }
  return text;
}

/// Looks at all places first, so that all pages are written or none.
int write_pages(const fs::path& folder, const Registry& registry, bool force) {
  const auto pages = reference_pages(registry);
  for (const ReferencePage& page : pages) refuse_to_replace(folder / page.file, force);
  std::string written;
  for (const ReferencePage& page : pages) {
    const fs::path file = folder / page.file;
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) {
      Fault fault;
      fault.place.file = "-o";
      fault.key = file.parent_path().string();
      fault.why = "cannot be made: " + error.message();
      throw InputError({fault});
    }
    OutputFile output(file);
    output.append(page.text);
    output.publish();
    written += file.string() + "\n";
  }
  return print_result(written);
}

/// Paths of libraries may be any bytes.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

int describe_command(const DescribeArguments& arguments) {
  const Registry registry = registry_with_plugins(arguments.plugins, {});
  if (arguments.folder) return write_pages(*arguments.folder, registry, arguments.force);
  const auto all = all_components(registry);
  const auto tables = scene_tables();
  if (arguments.name.empty()) {
    if (arguments.markdown) return print_result(all_pages(registry));
    return print_result(arguments.json ? text_of(list_json(all, tables)) + "\n"
                                       : list_text(all, tables));
  }
  if (const Described* component = find(all, arguments.name)) {
    if (arguments.markdown) return print_result(component_section(*component));
    return print_result(arguments.json ? text_of(component_json(*component)) + "\n"
                                       : component_text(*component));
  }
  if (const SceneTable* table = find(tables, arguments.name)) {
    if (arguments.markdown) return print_result(table_section(*table));
    return print_result(arguments.json ? text_of(table_json(*table)) + "\n" : table_text(*table));
  }
  refuse(arguments.name, all, tables);
}

}  // namespace tomlin
