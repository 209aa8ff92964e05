#include "framework/cli/reference_pages.hpp"

#include <iterator>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "framework/cli/diagnostics.hpp"
#include "framework/core/formula/expression.hpp"
#include "framework/core/text/citation.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

constexpr const char* kMadeBy =
    "<!-- Made by `tomlin describe --markdown`; a test says when it is stale. -->\n\n";

/// A page of components, and what they have in common.
struct Kind {
  const char* kind;
  const char* file;
  const char* title;
  const char* preface;
};

constexpr std::array kPages = {
    Kind{"body", "framework/bodies/REFERENCE.md", "Bodies",
         "Where particles start, and what may move: `[[body]]` in a scene."},
    Kind{"force", "forcefields/REFERENCE.md", "Forces",
         "What acts on bodies: `[[force]]` in a scene. [A force in ten minutes](README.md) says "
         "how to add one."},
    Kind{"integrator", "integrators/REFERENCE.md", "Integrators",
         "How time advances: `integrator = { type = ..., ... }` under `[run]` in a scene."}};

/// Text in a cell of a table: a bar would end it.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

/// "Linear springs." of "linear springs".
std::string sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') {
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  }
  return text.empty() || text.back() == '?' ? text : text + ".";
}

std::string code(const std::string& text) { return "`" + text + "`"; }

std::string default_cell(const Parameter& row) {
  if (row.required()) return "required";
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  return standard ? code(value_text(*standard)) + natural_unit_text(row) : "may be absent";
}

/// "..., doi:10.1/2" with a link.
std::string linked(const std::string& work) {
  const auto doi = work.find("doi:");
  if (doi == std::string::npos) return work;
  return fmt::format("{}[{}](https://doi.org/{})", work.substr(0, doi), work.substr(doi),
                     work.substr(doi + 4));
}

void append_block(std::string& text, const char* language, const std::string& lines) {
  fmt::format_to(std::back_inserter(text), "```{}\n{}{}```\n\n", language, lines,
                 lines.empty() || lines.back() == '\n' ? "" : "\n");
}

void append_rows(std::string& text, const std::vector<Parameter>& rows) {
  if (rows.empty()) return;
  text += "| key | what it is | dimension | admissible | default |\n|---|---|---|---|---|\n";
  for (const Parameter& row : rows) {
    fmt::format_to(std::back_inserter(text), "| {} | {} | {} | {} | {} |\n", code(row.key),
                   cell(row.doc), to_string(row.dimension), cell(admissible_values(row)),
                   cell(default_cell(row)));
  }
  text += "\n";
}

void append_own_keys(std::string& text, const std::vector<OwnKey>& keys) {
  for (const OwnKey& own : keys) {
    fmt::format_to(std::back_inserter(text), "- {}: {}\n", code(own.key), own.doc);
  }
  if (!keys.empty()) text += "\n";
}

std::string page_of(const Kind& kind, const std::vector<Described>& all) {
  std::string text = fmt::format("# {}\n\n{}{}\n\n", kind.title, kMadeBy, kind.preface);
  text += "| type | what it is |\n|---|---|\n";
  const auto found = those_of(kind.kind, all);
  for (const Described* one : found) {
    fmt::format_to(std::back_inserter(text), "| [`{0}`](#{0}) | {1} |\n", one->record->name,
                   cell(one->record->summary));
  }
  if (!found.empty()) {
    text += "\nBeside its own keys each takes\n\n";
    append_own_keys(text, found.back()->layout.own_keys);
  }
  for (const Described* one : found) text += component_section(*one);
  text.pop_back();  // of two line ends the last
  return text;
}

std::string page_of_scenes() {
  std::string text =
      std::string("# Scenes\n\n") + kMadeBy +
      "The tables of a scene. Where a number is expected, a text is an expression over "
      "`[parameters]`.\nThe components are on separate pages: "
      "[bodies](../bodies/REFERENCE.md),\n"
      "[forces](../../forcefields/REFERENCE.md),\n"
      "[integrators](../../integrators/REFERENCE.md).\n"
      "[Plugins](../plugin/README.md) add further components. A scene names them "
      "above its first table,\n`plugins = [\"libNAME.so\"]`. Observers, "
      "`[[observer]]` with a `type` and a `body`, come from plugins only.\n\n";
  std::vector<std::string> functions;
  std::vector<std::string> shared;
  for (const ExpressionFunction& function : expression_functions()) {
    functions.push_back(code(std::string(function.name)));
    if (function.may_name_parameter) shared.push_back(functions.back());
  }
  std::vector<std::string> variables;
  for (const std::string_view variable : expression_variables()) {
    variables.push_back(code(std::string(variable)));
  }
  text +=
      "## [parameters]\n\nNumbers and expressions, by names. Expressions have + - * / ^, "
      "brackets, `pi`, the names of\nparameters and the functions " +
      joined(functions) +
      ".\nNo parameter may be called like one of these, or like a variable of a formula: " +
      joined(variables) + ".\nExceptions are " + joined(shared) +
      ", which are functions only before a bracket.\n\n";
  for (const SceneTable& table : scene_tables()) text += table_section(table);
  text.pop_back();
  return text;
}

const char* shape_text(const ResultQuantity& quantity) {
  return quantity.shape == Shape::vector ? "number per axis" : to_string(quantity.shape);
}

std::string page_of_diagnostics() {
  return std::string("# Diagnostics\n\n") + kMadeBy +
         "An error message and a warning end with their code in brackets, `[scene.unknown_key]`. "
         "`check --json` and\n`explain --json` have that of an error as `code`, and so has "
         "`failure` in `summary.json`. Beside every list\n`warnings`, in `summary.json`, "
         "`compare.json`, `check --json` and `explain --json`, a list `warning_codes` has\nthe "
         "code "
         "of each; where `explain` announces that a run would be refused, that of the refusal. "
         "Entries of\nwarnings begin with *Warning*. Codes are stable, the wording of messages is "
         "not. `tomlin describe\nscene.unknown_key` shows one of these entries. `pt.toml` in the "
         "examples is the scene of `tomlin new pt`.\n\n" +
         diagnostics_section();
}

std::string page_of_results() {
  return std::string("# Results\n\n") + kMadeBy +
         "The quantities of `summary.json`. With dots between them the names are observables, for "
         "`--observable`,\n`until` and `perturb`: `drivers.NAME.mean_force.x`, or "
         "`NAME.mean_force.x`, and `events.slips`.\n[Results](../USER_GUIDE.md#results) in the "
         "user guide explains how to read them.\n\n" +
         results_section();
}

}  // namespace

std::string results_section() {
  std::string text =
      "A quantity is taken over the window of `[measure]`, at the end of the run, or over the "
      "whole "
      "run. What is\nundefined is null, as all of the window is when the run does not reach its "
      "end.\n\n";
  for (const ResultFamily& family : result_families()) {
    fmt::format_to(std::back_inserter(text), "## {}\n\n", family.family);
    const std::string about = std::string(family.of) +
                              (family.of.empty() || family.when.empty() ? "" : ", ") +
                              std::string(family.when);
    if (!about.empty()) text += sentence(about) + "\n\n";
    text += "| key | what it is | value | dimension | taken over |\n|---|---|---|---|---|\n";
    for (const ResultQuantity& quantity : family.quantities) {
      fmt::format_to(std::back_inserter(text), "| {} | {} | {} | {} | {} |\n", code(quantity.key),
                     cell(quantity.meaning), shape_text(quantity), unit_of(quantity),
                     to_string(quantity.scope));
    }
    text += "\n";
  }
  text +=
      "## observers\n\nEach observer: the numbers that its plugin declares, at the end, and with "
      "`mean_` in front the mean over\nits samples in the window.\n";
  return text;
}

std::string component_section(const Described& component) {
  const ComponentRecord& record = *component.record;
  std::string text = fmt::format("## {}\n\n{}\n\n", record.name, sentence(record.summary));
  append_block(text, "text", record.equation);
  for (const auto& [work, passage] : citations(record.source)) {
    text += "- source: " + linked(work) + (passage.empty() ? "" : ", " + passage) + "\n";
  }
  if (component.force != nullptr) {
    text += "- acts on: " + acts_on(*component.force) + "\n";
  }
  if (component.kind != "body") {
    const auto words = trait_words(component);
    text += "- traits: " + (words.empty() ? "none" : joined(words)) + "\n";
    text += "- numbers: " + joined(number_types(component)) + "\n";
  }
  text += "\n";
  append_rows(text, component.layout.rows);
  append_block(text, "toml", record.example);
  return text;
}

std::string table_section(const SceneTable& table) {
  std::string text = fmt::format("## [{}]\n\n{}\n\n", table.name, sentence(table.summary));
  append_own_keys(text, table.layout.own_keys);
  append_rows(text, table.layout.rows);
  return text;
}

std::vector<ReferencePage> reference_pages(const Registry& registry) {
  const auto all = all_components(registry);
  std::vector<ReferencePage> pages;
  pages.reserve(kPages.size() + 3);
  for (const Kind& kind : kPages) pages.push_back({kind.file, page_of(kind, all)});
  pages.push_back({"framework/scene/REFERENCE.md", page_of_scenes()});
  pages.push_back({"framework/run/REFERENCE.md", page_of_results()});
  pages.push_back({"framework/DIAGNOSTICS.md", page_of_diagnostics()});
  return pages;
}

}  // namespace tomlin
