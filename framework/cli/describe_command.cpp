#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/command.hpp"
#include "framework/cli/describe_json.hpp"
#include "framework/cli/described.hpp"
#include "framework/cli/diagnostics.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/reference_pages.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/text/citation.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct DescribeArguments {
  std::string name;  ///< empty: all components
  std::vector<std::string> plugins;
  bool json = false;
  bool markdown = false;
  std::optional<std::string> folder;  ///< for the reference pages
  bool force = false;
};

constexpr const char* kDescribeFooter = R"(
Examples:

  tomlin describe                          all components in a line each
  tomlin describe sinusoidal_substrate     equation, source, parameters, an example that runs
  tomlin describe force                    the forces, and the keys that each of them takes
  tomlin describe run                      the keys of a table of the scene
  tomlin describe results                  what summary.json has, with dimensions and meanings
  tomlin describe diagnostics              the codes of errors and warnings
  tomlin describe scene.unknown_key        what one of them means, an example and a cure
  tomlin describe rk4 --json               the same for programs
  tomlin describe rk4 --markdown           the same for a page
  tomlin describe --markdown -o DIR        all of it as pages, DIR/forcefields/REFERENCE.md ...)";

/// nullptr when there is none of that name.
const Described* find(const std::vector<Described>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&name](const auto& one) { return one.record->name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// "until" is "run.until", too.
const SceneTable* find(const std::vector<SceneTable>& tables, const std::string& name) {
  const auto found = std::find_if(tables.begin(), tables.end(), [&name](const auto& table) {
    return table.name == name || table.name.ends_with("." + name);
  });
  return found == tables.end() ? nullptr : &*found;
}

/// "force" or "forces"; nullptr when it is no kind of component.
const KindNames* find_kind(const std::string& name) {
  const auto* found = std::find_if(kKinds.begin(), kKinds.end(), [&name](const KindNames& kind) {
    return name == kind.first || name == kind.second;
  });
  return found == kKinds.end() ? nullptr : found;
}

/// Removes the signs of a scene from a name: "[run]", "[[force]]", "force.driving_spring".
std::string without_scene_signs(std::string name) {
  std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
  for (const auto& [kind, kinds] : kKinds) {
    const std::string start = std::string(kind) + ".";
    if (name.starts_with(start)) return name.substr(start.size());
  }
  return name;
}

/// All tables of a scene but components: those with keys of the program's own, and [parameters].
std::vector<SceneTable> described_tables() {
  std::vector<SceneTable> tables = scene_tables();
  SceneTable parameters{"parameters", "names for numbers, for all expressions of the scene", {}};
  parameters.layout.own_keys = {
      {"NAME", "a number, or an expression over other parameters: k = 2.0, xi = \"2 * sqrt(k)\""}};
  tables.insert(tables.begin() + 1, std::move(parameters));
  return tables;
}

/// The components and tables that take a key of that name.
std::vector<std::string> takers_of(const std::string& key, const std::vector<Described>& all,
                                   const std::vector<SceneTable>& tables) {
  std::vector<std::string> takers;
  for (const Described& component : all) {
    if (component.layout.row(key) != nullptr) takers.push_back(component.record->name);
  }
  for (const SceneTable& table : tables) {
    const bool own = table.layout.is_own_key(key);
    if (own || table.layout.row(key) != nullptr) takers.push_back("[" + table.name + "]");
  }
  return takers;
}

[[noreturn]] void refuse(const std::string& name, const std::vector<Described>& all,
                         const std::vector<SceneTable>& tables) {
  std::vector<std::string> names;
  names.reserve(all.size() + tables.size());
  for (const Described& component : all) names.push_back(component.record->name);
  for (const SceneTable& table : tables) names.push_back(table.name);
  for (const auto& [kind, kinds] : kKinds) names.emplace_back(kind);
  names.insert(names.end(), {"results", "diagnostics"});
  for (const FaultKind& kind : fault_kinds()) {
    if (name.find('.') != std::string::npos) names.emplace_back(kind.id);
  }
  const auto takers = takers_of(name, all, tables);
  if (!takers.empty()) {
    refuse_command(FaultCode::scene_unknown_component,
                   fmt::format("\"{}\" is a key of {}", name, joined(takers)),
                   "one of these names");
  }
  refuse_command(FaultCode::scene_unknown_component,
                 fmt::format("there is no component \"{}\"", name), joined(names),
                 nearest_name(name, names).value_or(""));
}

// ---- text

std::string origin_in_brackets(const ComponentRecord& record) {
  return record.library.empty() ? "" : " (" + record.library + ")";
}

constexpr const char* kHowToSeeOne =
    "\n`tomlin describe NAME` shows one with its equation, parameters and an example.\n";

/// Components in a line each.
void append_summaries(std::string& text, const std::vector<const Described*>& components,
                      std::size_t width) {
  for (const Described* one : components) {
    fmt::format_to(std::back_inserter(text), "  {:<{}}  {}{}\n", one->record->name, width,
                   one->record->summary, origin_in_brackets(*one->record));
  }
}

std::string list_text(const std::vector<Described>& all, const std::vector<SceneTable>& tables) {
  std::size_t width = 0;
  for (const Described& component : all) width = std::max(width, component.record->name.size());
  std::string text;
  for (const auto& [kind, kinds] : kKinds) {
    const auto found = those_of(kind, all);
    if (!found.empty()) text += std::string(kinds) + "\n";
    append_summaries(text, found, width);
  }
  text += "tables of a scene\n";
  for (const SceneTable& table : tables) {
    fmt::format_to(std::back_inserter(text), "  {:<{}}  {}\n", table.name, width, table.summary);
  }
  return text + kHowToSeeOne;
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
  text += "\ntraits\n  " + (held.empty() ? "none" : joined(held)) + "\n";
  text += "\nnumbers\n  " + joined(number_types(component)) + "\n";
}

void append_sources(std::string& text, const std::string& source) {
  text += "\nsource\n";
  for (const auto& [work, passage] : citations(source)) {
    text += "  " + work + (passage.empty() ? "" : ", " + passage) + "\n";
  }
}

void append_rows(std::string& text, const std::vector<Parameter>& rows) {
  text += "\nparameters\n";
  for (const Parameter& row : rows) {
    fmt::format_to(std::back_inserter(text), "  {} [{}]: {}\n      {}; {}\n", row.key,
                   to_string(row.dimension), row.doc, admissible_values(row), default_text(row));
  }
}

void append_own_keys(std::string& text, const std::string& title, const std::vector<OwnKey>& keys) {
  if (keys.empty()) return;
  text += "\n" + title + "\n";
  for (const OwnKey& own : keys) text += "  " + own.key + ": " + own.doc + "\n";
}

std::string table_text(const SceneTable& table) {
  std::string text = fmt::format("[{}]: {}\n", table.name, table.summary);
  if (!table.layout.rows.empty()) append_rows(text, table.layout.rows);
  append_own_keys(text, table.layout.rows.empty() ? "keys" : "and", table.layout.own_keys);
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
  text += "\nexample\n";
  append_indented(text, record.example);
  return text;
}

/// Returns the table or key of a scene that holds a component of this kind.
std::string heading_of(const KindNames& kind) {
  const std::string name = kind.first;
  if (name == "integrator") return "integrator = { type = ..., ... } in [run]";
  return "[[" + name + "]]";
}

/// All of a kind in a line each, and what each of them takes.
std::string kind_text(const KindNames& kind, const std::vector<Described>& all) {
  const auto found = those_of(kind.first, all);
  std::string text = fmt::format("{}: {}\n", heading_of(kind), kind.second);
  if (found.empty()) return text + "  none; they come with plugins, see describe --plugin LIB\n";
  std::size_t width = 0;
  for (const Described* one : found) width = std::max(width, one->record->name.size());
  text += "\ntype\n";
  append_summaries(text, found, width);
  append_own_keys(text, std::string("every ") + kind.first + " takes, beside keys of its own",
                  found.front()->layout.own_keys);
  return text + kHowToSeeOne;
}

std::string kind_section(const KindNames& kind, const std::vector<Described>& all) {
  std::string text;
  for (const Described* one : those_of(kind.first, all)) text += component_section(*one);
  return text;
}

// ---- Markdown

std::string all_pages(const Registry& registry) {
  std::string text;
  for (const ReferencePage& page : reference_pages(registry)) {
    text += (text.empty() ? "" : "\n") + page.text;
  }
  return text;
}

/// Looks at all files first, so that all pages are written or none.
int write_pages(const fs::path& folder, const Registry& registry, bool force) {
  const auto pages = reference_pages(registry);
  for (const ReferencePage& page : pages) refuse_to_replace(folder / page.file, force);
  std::string written;
  for (const ReferencePage& page : pages) {
    const fs::path file = folder / page.file;
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) {
      refuse_input(FaultCode::file_cannot_write, "-o", file.parent_path().string(),
                   "cannot be made: " + error.message());
    }
    write_new_file(file, page.text);
    written += file.string() + "\n";
  }
  return print_result(written);
}

void add_options(CLI::App& parser, DescribeArguments& arguments) {
  parser
      .add_option("NAME", arguments.name,
                  "a component by its type, a kind of them (force), or a table of the scene; all "
                  "by default")
      ->option_text(" ");
  add_plugin_option(parser, arguments.plugins);
  CLI::Option* json = add_json_option(parser, arguments.json);
  CLI::Option* markdown =
      parser.add_flag("--markdown", arguments.markdown, "as Markdown")->excludes(json);
  add_output_option(parser, arguments.folder, "DIR", "folder for the reference pages")
      ->needs(markdown);
  parser.add_flag("--force", arguments.force, "replace pages that are there");
}

void check(DescribeArguments& arguments) {
  refuse_empty(arguments.folder, "-o");
  if (arguments.folder && !arguments.name.empty()) {
    refuse_command(FaultCode::command_conflict,
                   "a folder is written with the pages of all components", "-o without NAME");
  }
}

int describe(const DescribeArguments& arguments) {
  const Registry registry = registry_with_plugins(arguments.plugins, {});
  if (arguments.folder) return write_pages(*arguments.folder, registry, arguments.force);
  const auto all = all_components(registry);
  const auto tables = described_tables();
  const auto print_form = [&arguments](const std::string& text, const nlohmann::ordered_json& json,
                                       const std::string& markdown) {
    if (arguments.markdown) return print_result(markdown);
    return print_result(arguments.json ? json_text(json) : text);
  };
  if (arguments.name.empty()) {
    return print_form(list_text(all, tables), list_json(all, tables), all_pages(registry));
  }
  const std::string name = without_scene_signs(arguments.name);
  if (const Described* one = find(all, name)) {
    return print_form(component_text(*one), component_json(*one), component_section(*one));
  }
  if (const KindNames* kind = find_kind(name)) {
    return print_form(kind_text(*kind, all), kind_json(*kind, all), kind_section(*kind, all));
  }
  if (const SceneTable* table = find(tables, name)) {
    return print_form(table_text(*table), table_json(*table), table_section(*table));
  }
  if (name == "results") return print_form(results_section(), results_json(), results_section());
  if (name == "diagnostics") {
    return print_form(diagnostics_text(), diagnostics_json(), diagnostics_section());
  }
  if (const auto code = fault_code_of(name)) {
    const FaultKind& kind = kind_of(*code);
    return print_form(diagnostic_text(kind), diagnostic_json(kind), diagnostic_section(kind));
  }
  refuse(name, all, tables);
}

}  // namespace

CommandRecord describe_command() {
  return {"describe", "show the components that scenes are made of", kDescribeFooter,
          declared<DescribeArguments>(add_options, check, describe)};
}

}  // namespace tomlin
