#include "framework/plugin/note.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "framework/plugin/note_text.hpp"

namespace tomlin {
namespace {

/// The value behind `key=`, up to the next semicolon.
std::optional<std::string_view> value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const auto end = std::min(text.find(';'), text.size());
    const std::string_view entry = text.substr(0, end);
    if (entry.size() > key.size() && entry.starts_with(key) && entry[key.size()] == '=') {
      return entry.substr(key.size() + 1);
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return std::nullopt;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const auto end = std::min(text.find(' '), text.size());
    if (end > 0) words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

}  // namespace

std::optional<PluginNote> parse_note(std::string_view text) {
  const auto api = value_of(text, "api");
  const auto release = value_of(text, "release");
  const auto abi = value_of(text, "abi");
  const auto compiler = value_of(text, "compiler");
  const auto border = value_of(text, "border");
  const auto numbers = value_of(text, "numbers");
  const auto sets = value_of(text, "sets");
  if (!api || !release || !abi || !compiler || !border || !numbers || !sets) return std::nullopt;
  PluginNote note;
  const char* const end = api->data() + api->size();
  const auto [stop, error] = std::from_chars(api->data(), end, note.api);
  if (error != std::errc() || stop != end) return std::nullopt;
  note.release = *release;
  note.abi = *abi;
  note.compiler = *compiler;
  note.border = *border;
  note.number_types = words_of(*numbers);
  note.instruction_sets = words_of(*sets);
  return note;
}

PluginNote own_note() {
  return parse_note(TOMLIN_NOTE_HEAD ";numbers=double quadruple;sets=baseline").value();
}

std::string mismatch(const PluginNote& plugin, const PluginNote& program) {
  std::string difference;
  if (plugin.api != program.api) {
    difference = fmt::format("the library is registered by interface {}, the program loads by {}",
                             plugin.api, program.api);
  } else if (plugin.abi != program.abi) {
    difference = fmt::format("the library was built with {} ({}), the program with {} ({})",
                             plugin.abi, plugin.compiler, program.abi, program.compiler);
  } else if (plugin.release != program.release) {
    difference = fmt::format("the library was built with tomlin {}, the program is tomlin {}",
                             plugin.release, program.release);
  } else if (plugin.border != program.border) {
    difference = fmt::format(
        "the library was built with other headers of tomlin {} ({}) than the program ({})",
        plugin.release, plugin.border, program.border);
  } else {
    return "";
  }
  return difference + ": build the library again, with the tomlin that loads it";
}

}  // namespace tomlin
