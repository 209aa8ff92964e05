#include "framework/plot/axis_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"

namespace tomlin {
namespace {

/// Dimensions that results spell out, by the key of `axes`.
constexpr std::array kSpelled = {
    std::pair{"length/time", "velocity"}, std::pair{"mass*length/time^2", "force"},
    std::pair{"mass*length^2/time^2", "energy"}, std::pair{"temperature", "energy"}};

/// The symbols of metal units, in tables and in figures.
constexpr std::array kSymbols = {
    std::pair{std::string_view("eV"), "eV"},      std::pair{std::string_view("u"), "u"},
    std::pair{std::string_view("A"), "\xC3\x85"}, std::pair{std::string_view("ps"), "ps"},
    std::pair{std::string_view("K"), "K"},        std::pair{std::string_view("1"), "1"}};

constexpr std::array kWords = {
    std::pair{"length", dimension::length},       std::pair{"time", dimension::time},
    std::pair{"mass", dimension::mass},           std::pair{"velocity", dimension::velocity},
    std::pair{"force", dimension::force},         std::pair{"energy", dimension::energy},
    std::pair{"stiffness", dimension::stiffness}, std::pair{"temperature", dimension::temperature}};

/// "eV/\xC3\x85^{2}" of "eV/A^2", a symbol as tables of metal units have it; empty of a pure number
/// and of any other text.
std::string figure_symbol(std::string_view symbol) {
  std::string text;
  while (!symbol.empty()) {
    const std::string_view word = symbol.substr(0, symbol.find_first_of("*/^"));
    const auto found = std::find_if(kSymbols.begin(), kSymbols.end(),
                                    [&](const auto& one) { return one.first == word; });
    if (found == kSymbols.end()) return "";
    text += found->second;
    symbol.remove_prefix(word.size());
    if (symbol.starts_with('^')) {
      const std::string_view digits = symbol.substr(1, symbol.find_first_of("*/", 1) - 1);
      text += fmt::format("^{{{}}}", digits);
      symbol.remove_prefix(digits.size() + 1);
    }
    if (symbol.empty()) break;
    text += symbol.front() == '*' ? ' ' : symbol.front();
    symbol.remove_prefix(1);
  }
  return text == "1" ? "" : text;
}

std::string named_unit(const StoredRun& run, const std::string& key) {
  const auto found = run.units.find(key);
  return found == run.units.end() ? "" : found->second;
}

/// As a divisor, and as a divisor of what is above it.
std::string in_brackets(const std::string& unit) {
  const bool compound = unit.find_first_of("/* ") != std::string::npos;
  return compound ? "(" + unit + ")" : unit;
}

}  // namespace

std::string dimension_words(const StoredRun& run, const std::string& unit) {
  if (unit == "1") return "";
  if (run.system == UnitSystem::reduced) return literal_text(unit);
  for (const auto& [words, dimension] : kWords) {
    if (unit == unit_symbol(run.system, dimension)) return words;
  }
  return "";
}

std::string literal_text(std::string_view plain) {
  constexpr std::string_view kMarkup = "\\{}_^@&~";
  std::string result;
  for (const char c : plain) {
    if (kMarkup.find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string unit_name(const StoredRun& run, std::string_view dimension) {
  if (dimension == "rad") return "rad";
  if (run.system != UnitSystem::reduced) {
    return figure_symbol(unit_in_tables(run.system, std::string(dimension)));
  }
  std::string key(dimension);
  for (const auto& [spelled, short_name] : kSpelled) {
    if (dimension == spelled) key = short_name;
  }
  std::string unit = named_unit(run, key);
  if (!unit.empty() || key != "velocity") return unit;
  const std::string length = named_unit(run, "length");
  const std::string time = named_unit(run, "time");
  if (length.empty() || time.empty()) return "";
  return in_brackets(length) + "/" + in_brackets(time);
}

FigureText axis_text(const std::string& words, const std::string& symbol, const std::string& unit) {
  std::string text = words;
  if (!symbol.empty()) text += (text.empty() ? "" : " ") + symbol;
  if (!unit.empty()) text += " / " + in_brackets(unit);
  return {text, true};
}

void check_unit_names(const std::vector<StoredRun>& runs, std::string_view dimension) {
  const std::string first = unit_name(runs.front(), dimension);
  for (const StoredRun& run : runs) {
    const std::string unit = unit_name(run, dimension);
    if (unit == first) continue;
    const StoredRun& without = first.empty() ? runs.front() : run;
    const StoredRun& with = first.empty() ? run : runs.front();
    const std::string& name = first.empty() ? unit : first;
    const bool both = !first.empty() && !unit.empty();
    refuse_input(FaultCode::command_conflict, file_of(without, kSummaryFile), "scene.axes",
                 fmt::format("{} for the unit of {}, on one axis with {} of {}",
                             both ? unit : "no name", dimension, name, with.folder),
                 "folders whose scenes name the units of the axis alike");
  }
}

}  // namespace tomlin
