#include "framework/scene/syntax_fault.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "framework/core/text/ascii.hpp"
#include "framework/core/text/utf8.hpp"
#include "framework/scene/text.hpp"
#include "framework/scene/units.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLongestShownLine = 200;  // bytes; of a longer line the position is reported
constexpr std::size_t kLongestName = 200;       // bytes; a longer one is no name of a scene

/// The text between the line breaks around `at`.
std::string_view line_around(std::string_view text, std::size_t at) {
  const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  return text.substr(begin, text.find('\n', begin) - begin);
}

std::size_t offset_of(std::string_view text, const TextPosition& location) {
  std::size_t at = 0;
  for (std::uint32_t line = 1; line < location.line; ++line) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) return text.size();
    at = end + 1;
  }
  for (std::uint32_t column = 1; column < location.column && at < text.size(); ++column) {
    do {
      ++at;
    } while (at < text.size() && is_utf8_continuation(text[at]));
  }
  return at;
}

/// A line that defines a table or a key.
struct Definition {
  std::string path;
  bool is_table = false;
  bool is_element = false;  ///< of a list of tables
  int line = 0;
};

bool starts_below(std::string_view path, const std::string& above) {
  return path.starts_with(above + ".");
}

bool exclude_each_other(const Definition& a, const Definition& b) {
  if (a.path == b.path) return !(a.is_element && b.is_element);
  return (!a.is_table && starts_below(b.path, a.path)) ||
         (!b.is_table && starts_below(a.path, b.path));
}

/// Reads the definitions of a text line by line.
class DefinitionReader {
 public:
  std::optional<Definition> read(std::string_view line) {
    ++line_;
    line = trimmed(line);
    const bool is_table = line.starts_with("[");
    const bool is_element = line.starts_with("[[");
    const std::size_t begin = is_element ? 2 : is_table ? 1 : 0;
    const std::size_t end = line.find(is_table ? ']' : '=', begin);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string name(trimmed(line.substr(begin, end - begin)));
    const auto is_bare = [](char c) {
      return is_letter_or_underscore(c) || is_digit(c) || c == '-' || c == '.';
    };
    if (is_table) {
      const std::string_view behind = trimmed(line.substr(std::min(end + begin, line.size())));
      const bool is_row =
          (!behind.empty() && !behind.starts_with("#")) || name.find(',') < name.size();
      if (is_row) return std::nullopt;  // of a list
      table_ = name.substr(0, kLongestName);
    }
    if (name.empty() || name.size() > kLongestName) return std::nullopt;
    if (!std::all_of(name.begin(), name.end(), is_bare)) return std::nullopt;
    const bool below = !is_table && !table_.empty();
    return Definition{below ? table_ + "." + name : name, is_table, is_element, line_};
  }

 private:
  std::string table_;  ///< that keys belong to
  int line_ = 0;
};

/// Calls `action` with each definition in the lines of a text.
template <typename Action>
void for_each_definition(std::string_view text, const Action& action) {
  DefinitionReader reader;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (const auto found = reader.read(text.substr(begin, end - begin))) action(*found);
    begin = end + 1;
  }
}

/// The line of an earlier definition of what the line around `at` defines; 0: there is none.
int earlier_definition(std::string_view text, std::size_t at) {
  const std::string_view line = line_around(text, at);
  const std::string_view before =
      text.substr(0, static_cast<std::size_t>(line.data() - text.data()));
  const int number = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
  Definition here;
  for_each_definition(text.substr(0, before.size() + line.size()),
                      [&](const Definition& one) { here = one; });
  if (here.line != number) return 0;
  int earlier = 0;
  for_each_definition(before, [&](const Definition& one) {
    // Another element of a list of tables begins without keys.
    if (one.is_element && starts_below(here.path, one.path)) earlier = 0;
    if (earlier == 0 && exclude_each_other(one, here)) earlier = one.line;
  });
  return earlier;
}

bool at_end_of_line(std::string_view rest) {
  return rest.empty() || rest.starts_with("\n") || rest.starts_with("\r\n");
}

bool is_control_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte == 0x7FU || (byte < 0x20U && c != '\n' && !is_space(c));
}

bool begins_comment_of_others(std::string_view text) {
  return text.starts_with("//") || text.starts_with("/*") || text.starts_with("--") ||
         text.starts_with(";") || text.starts_with("%") || text.starts_with("!");
}

/// The quote or the brace that is missing at the end of a line; empty where none is.
std::string_view unclosed_in(std::string_view line) {
  bool in_braces = false;
  for (std::size_t next = 0; next < line.size() && line[next] != '#'; ++next) {
    const char c = line[next];
    if (c == '{') in_braces = true;
    if (c == '}') in_braces = false;
    if (c != '"' && c != '\'') continue;
    const std::size_t quote = next++;
    while (next < line.size() && line[next] != c) next += c == '"' && line[next] == '\\' ? 2 : 1;
    if (next >= line.size()) return line.substr(quote, 1);
  }
  return in_braces ? "}" : "";
}

/// The unquoted value in which the library stopped, or which it had just read; empty elsewhere.
std::string_view value_around(std::string_view text, std::size_t at) {
  if (trimmed(line_around(text, at)).starts_with("[")) return "";  // the header of a table
  constexpr std::string_view kStarts = "=,[{";
  std::size_t begin = at;
  while (begin > 0 && text[begin - 1] != '\n' &&
         kStarts.find(text[begin - 1]) == std::string_view::npos) {
    --begin;
  }
  if (begin == 0 || text[begin - 1] == '\n') return "";
  const std::size_t end = std::min(text.find_first_of(",]}#\n", at), text.size());
  const std::string_view value = trimmed(text.substr(begin, end - begin));
  return value.find_first_of("\"'=[{") == std::string_view::npos ? value : "";
}

/// Digits that are as many as fit into 64 bits, or more.
bool is_long_integer(std::string_view value) {
  if (value.starts_with('-') || value.starts_with('+')) value.remove_prefix(1);
  return value.size() > std::numeric_limits<std::int64_t>::digits10 && value.front() != '0' &&
         std::all_of(value.begin(), value.end(), is_digit);
}

std::string expected_for(std::string_view value) {
  if (const auto unit = unit_in(value)) {
    return fmt::format("{}; {}", written_without_unit(*unit), kNumbersHaveNoUnits);
  }
  return "a number as 0.5 or 1e3, true, false, or text or an expression in quotes";
}

/// Adds what the text itself shows: a code of its own where it has one, and what would be right.
void add_hint(Fault& fault, std::string_view text, std::size_t at) {
  const std::string_view rest = text.substr(at);
  const std::string_view value = value_around(text, at);
  const std::string_view unclosed = at_end_of_line(rest) ? unclosed_in(line_around(text, at)) : "";
  if (!rest.empty() && is_control_character(rest.front())) {
    fault.code = FaultCode::scene_encoding;
    fault.admissible = "in quotes an escape, as \\u0000";
  } else if (const int line = earlier_definition(text, at)) {
    fault.code = FaultCode::scene_duplicate_key;
    fault.admissible = fmt::format("this or line {}, not both", line);
  } else if (!unclosed.empty()) {
    fault.admissible = fmt::format("a closing {} in this line", unclosed);
  } else if (is_long_integer(value)) {
    fault.code = FaultCode::scene_out_of_range;
    fault.admissible = "a number with a point or an exponent, as 1e23";
  } else if (begins_comment_of_others(rest) ||
             begins_comment_of_others(trimmed(line_around(text, at)))) {
    fault.admissible = "# at the beginning of a comment";
  } else if (!value.empty()) {
    fault.admissible = expected_for(value);
  }
}

}  // namespace

Fault explain_syntax(std::string_view text, const std::string& file, const TextPosition& at,
                     std::string_view message) {
  const std::size_t stopped = offset_of(text, at);
  Fault fault(FaultCode::scene_syntax);
  fault.location = {file, static_cast<int>(at.line), static_cast<int>(at.column)};
  fault.why = "no valid TOML: " + shortened(message, kLongestShownMessage);
  std::string_view line = line_around(text, stopped);
  if (line.ends_with('\r')) line.remove_suffix(1);
  const bool is_printable = std::none_of(line.begin(), line.end(), is_control_character);
  if (is_printable && line.size() <= kLongestShownLine) fault.value = line;
  add_hint(fault, text, stopped);
  return fault;
}

}  // namespace tomlin
