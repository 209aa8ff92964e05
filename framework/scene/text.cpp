#include "framework/scene/text.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/ascii.hpp"

namespace tomlin {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7F; }

}  // namespace

std::string shortened(std::string_view text, std::size_t most_bytes) {
  const bool valid = is_utf8(text);
  std::string line;
  bool after_break = false;  // then one space stands for the break and the spaces around it
  for (const char c : text) {
    if (line.size() > most_bytes) break;
    after_break = is_control(c) || (after_break && c == ' ');
    if (!after_break) {
      line += valid || is_ascii(c) ? c : '?';
    } else if (line.empty() || line.back() != ' ') {
      line += ' ';
    }
  }
  if (line.size() <= most_bytes) return line;
  std::size_t end = most_bytes;
  while (end > 0 && is_utf8_continuation(line[end])) --end;
  return line.substr(0, end) + "...";
}

std::string quoted_text(std::string_view text) {
  static constexpr std::pair<char, const char*> kEscapes[] = {
      {'"', "\\\""}, {'\\', "\\\\"}, {'\b', "\\b"}, {'\t', "\\t"},
      {'\n', "\\n"}, {'\f', "\\f"},  {'\r', "\\r"}};
  std::string result = "\"";
  for (const char c : text) {
    const auto* escape = std::find_if(std::begin(kEscapes), std::end(kEscapes),
                                      [c](const auto& candidate) { return candidate.first == c; });
    if (escape != std::end(kEscapes)) {
      result += escape->second;
    } else if (is_control(c)) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string key_text(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return is_letter(c) || is_digit(c) || c == '_' || c == '-';
  });
  return bare ? std::string(key) : quoted_text(key);
}

std::string listed(const std::vector<std::string>& names) {
  std::string result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) result += ", ";
    if (i == kMostShownNames) return result + "...";
    result += names[i];
  }
  return result;
}

std::vector<std::string> in_quotes(const std::vector<std::string>& words) {
  std::vector<std::string> result;
  result.reserve(words.size());
  for (const std::string& word : words) result.push_back(quoted_text(word));
  return result;
}

bool is_component_name(std::string_view name) {
  if (name.empty() || !(is_letter(name.front()) || name.front() == '_')) return false;
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; });
}

}  // namespace tomlin
