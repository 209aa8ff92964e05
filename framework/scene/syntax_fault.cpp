#include "framework/scene/syntax_fault.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/ascii.hpp"
#include "framework/scene/text.hpp"
#include "framework/scene/units.hpp"

namespace tomlin {
namespace {

bool is_key_character(char c) { return is_letter_or_underscore(c) || is_digit(c) || c == '-'; }
bool is_quote(char c) { return c == '"' || c == '\''; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool begins_comment_of_others(std::string_view text) {
  return text.starts_with("//") || text.starts_with("/*") || text.starts_with("--") ||
         text.starts_with(";") || text.starts_with("%") || text.starts_with("!");
}

/// An opening bracket of a list or a table in one line, and where it stands.
struct Bracket {
  char open = '[';
  std::size_t at = 0;
};

/// What has been opened before some byte of a text and is not closed there.
struct Opened {
  std::optional<std::size_t> string;  ///< its quote
  bool many_lines = false;            ///< of the string: three quotes
  std::vector<Bracket> brackets;
};

/// Behind the string that begins at `at`; npos where it does not end before `stop`, or not in its
/// line.
std::size_t end_of_string(std::string_view text, std::size_t at, std::size_t stop) {
  const char quote = text[at];
  const bool many_lines = text.substr(at, 3) == std::string(3, quote);
  std::size_t next = at + (many_lines ? 3 : 1);
  while (next < std::min(stop, text.size())) {
    if (quote == '"' && text[next] == '\\') {
      next += 2;
    } else if (many_lines && text.substr(next, 3) == std::string(3, quote)) {
      return next + 3;
    } else if (!many_lines && text[next] == quote) {
      return next + 1;
    } else if (!many_lines && text[next] == '\n') {
      return std::string_view::npos;
    } else {
      ++next;
    }
  }
  return std::string_view::npos;
}

Opened opened_before(std::string_view text, std::size_t stop) {
  Opened opened;
  bool at_start_of_line = true;
  for (std::size_t next = 0; next < stop;) {
    const char c = text[next];
    const bool begins_line = at_start_of_line;
    at_start_of_line = c == '\n' || (at_start_of_line && is_space(c));
    const bool header = begins_line && opened.brackets.empty() && c == '[';
    if (c == '#' || header) {
      next = std::min(text.find('\n', next), stop);
    } else if (is_quote(c)) {
      const std::size_t end = end_of_string(text, next, stop + 1);
      if (end == std::string_view::npos) {
        opened.string = next;
        opened.many_lines = text.substr(next, 3) == std::string(3, c);
        return opened;
      }
      next = end;
    } else {
      if (c == '[' || c == '{') opened.brackets.push_back({c, next});
      if ((c == ']' || c == '}') && !opened.brackets.empty()) opened.brackets.pop_back();
      ++next;
    }
  }
  return opened;
}

/// A number as a person may write one, and what follows it.
struct NumberLike {
  std::string_view whole;
  std::string_view fraction;  ///< with its point
  std::string_view exponent;  ///< with its letter
  std::string_view rest;

  std::string_view number(std::string_view text) const {
    return text.substr(0, text.size() - rest.size());
  }
};

std::string_view digits_of(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && (is_digit(text[end]) || text[end] == '_')) ++end;
  return text.substr(0, end);
}

std::optional<NumberLike> number_like(std::string_view text) {
  NumberLike found;
  std::string_view rest = text;
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  found.whole = digits_of(rest);
  rest.remove_prefix(found.whole.size());
  if (!rest.empty() && rest.front() == '.') {
    found.fraction = rest.substr(0, 1 + digits_of(rest.substr(1)).size());
    rest.remove_prefix(found.fraction.size());
  }
  if (found.whole.empty() && found.fraction.size() < 2) return std::nullopt;
  if (!rest.empty() && (rest.front() == 'e' || rest.front() == 'E')) {
    const bool is_signed = rest.size() > 1 && (rest[1] == '-' || rest[1] == '+');
    const std::size_t before = is_signed ? 2 : 1;
    const std::string_view digits = digits_of(rest.substr(before));
    if (!digits.empty() || rest.size() == before || !is_letter_or_underscore(rest[before])) {
      found.exponent = rest.substr(0, before + digits.size());
      rest.remove_prefix(found.exponent.size());
    }
  }
  found.rest = rest;
  return found;
}

/// The mistake at one place of a text.
class Syntax {
 public:
  Syntax(std::string_view text, const std::string& file, const TextPlace& at,
         std::string_view message)
      : text_(text), file_(file), message_(message), at_(offset_of(at)) {
    line_begin_ = at_ == 0 ? 0 : text.rfind('\n', at_ - 1) + 1;
    line_end_ = std::min(text.find('\n', at_), text.size());
  }

  Fault explained() {
    if (message_.find("cannot redefine") != std::string_view::npos) return redefined();
    if (message_.find("escape sequence") != std::string_view::npos) {
      return fault(at_, "", "", "a backslash in double quotes begins an escape, as \\n",
                   "\\\\ for the backslash itself, or single quotes");
    }
    opened_ = opened_before(text_, at_);
    if (opened_.string) return at_end_of_line() ? open_string() : in_string();
    const std::string_view line = text_.substr(line_begin_, line_end_ - line_begin_);
    if (opened_.brackets.empty()) {
      if (begins_comment_of_others(trimmed(line))) return comment(line_begin_ + indent(line));
      if (trimmed(line).starts_with("[")) return header(trimmed(line));
      if (!has_equals(line)) return no_equals(trimmed(line));
    }
    if (auto found = value()) return *std::move(found);
    return as_it_is();
  }

 private:
  std::size_t offset_of(const TextPlace& place) const {
    std::size_t at = 0;
    for (std::uint32_t line = 1; line < place.line; ++line) {
      const std::size_t end = text_.find('\n', at);
      if (end == std::string_view::npos) return text_.size();
      at = end + 1;
    }
    for (std::uint32_t column = 1; column < place.column && at < text_.size(); ++column) {
      do {
        ++at;
      } while (at < text_.size() && is_utf8_continuation(text_[at]));
    }
    return at;
  }

  Place place_of(std::size_t at) const {
    const std::string_view before = text_.substr(0, at);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::string_view tail = before.substr(before.rfind('\n') + 1);
    const auto column = 1 + std::count_if(tail.begin(), tail.end(),
                                          [](char c) { return !is_utf8_continuation(c); });
    return {file_, static_cast<int>(line), static_cast<int>(column)};
  }

  int line_of(std::size_t at) const { return place_of(at).line; }

  Fault fault(std::size_t at, std::string_view key, std::string_view value, std::string_view why,
              std::string_view admissible = "") const {
    return fault_of(FaultCode::scene_syntax, at, key, value, why, admissible);
  }

  Fault fault_of(FaultCode code, std::size_t at, std::string_view key, std::string_view value,
                 std::string_view why, std::string_view admissible = "") const {
    Fault found(code);
    found.place = place_of(at);
    found.key = shortened(key, kLongestShownValue);
    found.value = found.key.empty() ? "" : shortened(value, kLongestShownValue);
    found.why = shortened(why, kLongestShownMessage);
    found.admissible = shortened(admissible, kLongestShownMessage);
    return found;
  }

  bool at_control_character() const {
    if (at_ >= text_.size()) return false;
    const char c = text_[at_];
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0x7FU || (byte < 0x20U && c != '\n' && !is_space(c));
  }

  /// In the library's words.
  Fault as_it_is() const {
    constexpr std::string_view kOpening = "Error while parsing ";
    std::string_view message = message_;
    const bool says_where = message.starts_with(kOpening);
    if (says_where) message.remove_prefix(kOpening.size());
    const FaultCode code =
        at_control_character() ? FaultCode::scene_encoding : FaultCode::scene_syntax;
    return fault_of(code, at_, "", "",
                    (says_where ? "TOML syntax error in " : "TOML syntax error: ") +
                        shortened(message, kLongestShownMessage));
  }

  static std::size_t indent(std::string_view line) {
    std::size_t n = 0;
    while (n < line.size() && is_space(line[n])) ++n;
    return n;
  }

  static bool has_equals(std::string_view line) {
    return line.substr(0, line.find('#')).find('=') != std::string_view::npos;
  }

  Fault comment(std::size_t at) const { return fault(at, "", "", "a comment begins with #"); }

  /// What is redefined, between single quotes in the message.
  std::string_view redefined_name() const {
    const std::size_t open = message_.find('\'');
    const std::size_t close = message_.rfind('\'');
    if (open == std::string_view::npos || close <= open) return "";
    return message_.substr(open + 1, close - open - 1);
  }

  /// The last line before this one that begins with the name; with a header's brackets, or without
  /// them. 0: there is none.
  int earlier_line(std::string_view name, bool header) const {
    int found = 0;
    int number = 0;
    for (std::size_t begin = 0; begin < line_begin_;) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      ++number;
      std::string_view line = trimmed(text_.substr(begin, end - begin));
      const bool fits = line.starts_with("[") == header;
      while (line.starts_with("[")) line.remove_prefix(1);
      line = trimmed(line);
      const std::string_view behind =
          line.starts_with(name) ? trimmed(line.substr(name.size())) : std::string_view("x");
      const bool ends = behind.empty() || !is_key_character(behind.front());
      if (fits && ends && !behind.empty()) found = number;
      begin = end + 1;
    }
    return found;
  }

  /// A key or a table that is there already.
  Fault twice(std::size_t at, std::string_view name, std::string_view why,
              std::string_view admissible) const {
    return fault_of(FaultCode::scene_duplicate_key, at, name, "", why, admissible);
  }

  Fault redefined() const {
    const std::string name(redefined_name());
    const std::string_view line = trimmed(text_.substr(line_begin_, line_end_ - line_begin_));
    int before = earlier_line(name, line.starts_with("["));
    if (before == 0) before = earlier_line(name, !line.starts_with("["));
    const std::string where =
        before > 0 ? fmt::format(", as in line {}", before) : std::string(", as above");
    const std::size_t begin = line_begin_ + indent(text_.substr(line_begin_));
    const auto is = [&](const char* what) { return message_.find(what) != std::string_view::npos; };
    if (line.starts_with("[[")) {
      return twice(
          begin, name,
          fmt::format(
              "[[{0}]] is an element of a list of tables, but {0} is also a single key or table{1}",
              name, where),
          fmt::format("[[{}]] in all of these lines", name));
    }
    if (line.starts_with("[") && is("array")) {
      return twice(
          begin, name,
          fmt::format("[{0}] is a single table, but [[{0}]] is an element of a list of tables{1}",
                      name, where),
          fmt::format("[[{}]] in all of these lines", name));
    }
    if (line.starts_with("[")) {
      return twice(begin, name, fmt::format("the table [{}] is given twice{}", name, where),
                   "all of its keys below one header");
    }
    return twice(begin, name, "is given twice" + where, "one of the two");
  }

  Fault open_string() const {
    const std::size_t begin = *opened_.string;
    const std::string quotes(opened_.many_lines ? 3 : 1, text_[begin]);
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    const std::string_view written = trimmed(text_.substr(begin, end - begin));
    return fault(begin, key_before(begin), written,
                 opened_.many_lines
                     ? fmt::format("text that begins with {0} and does not end with {0}", quotes)
                     : fmt::format("the closing {} is missing in this line", quotes));
  }

  bool at_end_of_line() const {
    return at_ >= text_.size() || text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n";
  }

  Fault in_string() const {
    if (static_cast<unsigned char>(text_[at_]) >= 0x20U) return as_it_is();
    return fault_of(FaultCode::scene_encoding, at_, "", "",
                    "a control character, which text in quotes cannot hold as it is",
                    "an escape in double quotes, as \\u0000");
  }

  Fault header(std::string_view line) const {
    const std::size_t begin = line_begin_ + indent(text_.substr(line_begin_));
    const std::size_t opening = line.starts_with("[[") ? 2 : 1;
    const std::string_view rest = line.substr(opening);
    const std::string_view name = trimmed(rest.substr(0, rest.find_first_of("]#=")));
    const std::string right = fmt::format("{0}{1}{2}", opening == 2 ? "[[" : "[",
                                          name.empty() ? "NAME" : name, opening == 2 ? "]]" : "]");
    const std::size_t close = rest.find(']');
    if (close == std::string_view::npos ||
        !rest.substr(close).starts_with(std::string(opening, ']')))
      return fault(begin, "", "", fmt::format("the header of a table is not closed"), right);
    const std::string_view behind = trimmed(rest.substr(close + opening));
    if (name.empty()) return fault(begin, "", "", "a table needs a name", right);
    if (begins_comment_of_others(behind)) {
      return comment(static_cast<std::size_t>(behind.data() - text_.data()));
    }
    if (!behind.empty() && !behind.starts_with("#")) {
      return fault(static_cast<std::size_t>(behind.data() - text_.data()), "", "",
                   "the header of a table needs a line to itself", right);
    }
    if (std::any_of(name.begin(), name.end(), is_space)) {
      return fault(begin, "", "", "the name of a table has no spaces", right_without_spaces(right));
    }
    return as_it_is();
  }

  static std::string right_without_spaces(std::string text) {
    std::replace_if(text.begin(), text.end(), is_space, '_');
    return text;
  }

  /// A line that gives no value to any key.
  Fault no_equals(std::string_view line) const {
    const std::size_t begin = line_begin_ + indent(text_.substr(line_begin_));
    line = trimmed(line.substr(0, line.find('#')));
    std::size_t end = 0;
    while (end < line.size() && (is_key_character(line[end]) || line[end] == '.')) ++end;
    const std::string_view key = line.substr(0, end);
    std::string_view rest = trimmed(line.substr(end));
    if (key.empty()) return as_it_is();
    if (rest.starts_with("]")) {
      return fault(begin, "", "", "the header of a table is not opened",
                   std::string(rest.starts_with("]]") ? "[[" : "[") + std::string(line));
    }
    while (!rest.empty() && (rest.front() == ':' || is_space(rest.front()))) rest.remove_prefix(1);
    if (rest.empty()) {
      return fault(begin, "", "", "a line is KEY = VALUE, a [table] or a # comment",
                   fmt::format("{} = VALUE", key));
    }
    return fault(begin, key, "",
                 "a key and its value are joined by =", fmt::format("{} = {}", key, rest));
  }

  /// The key that `at` is the value of, as it is written; empty inside of lists.
  std::string_view key_before(std::size_t at) const {
    std::size_t end = at;
    while (end > 0 && is_space(text_[end - 1])) --end;
    if (end == 0 || text_[end - 1] != '=') return "";
    --end;
    while (end > 0 && is_space(text_[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && (is_key_character(text_[begin - 1]) || text_[begin - 1] == '.')) --begin;
    return text_.substr(begin, end - begin);
  }

  bool in_brackets() const { return !opened_.brackets.empty(); }

  /// The value that the library was reading, or had just read.
  std::string_view token() const {
    const std::string_view starts = in_brackets() ? "=,[{]}\n" : "=\n";
    std::size_t begin = at_;
    while (begin > line_begin_ && starts.find(text_[begin - 1]) == std::string_view::npos) --begin;
    const std::string_view stops = in_brackets() ? ",]}#\n" : "#\n";
    std::size_t end = at_;
    while (end < text_.size() && stops.find(text_[end]) == std::string_view::npos) ++end;
    return trimmed(text_.substr(begin, end - begin));
  }

  std::size_t offset_in_text(std::string_view part) const {
    return static_cast<std::size_t>(part.data() - text_.data());
  }

  std::optional<Fault> value() const {
    const std::string_view given = token();
    const std::size_t begin = given.empty() ? at_ : offset_in_text(given);
    const std::string_view key = key_before(begin);
    if (!in_brackets() && key.empty()) {
      if (auto found = unfit_key()) return found;
    }
    if (auto found = brackets(given)) return found;
    if (given.empty()) {
      if (key.empty()) return std::nullopt;
      return fault(begin, key, "", "the value is missing");
    }
    if (given.front() == '=') {
      return fault(begin, key, "", "a key and its value are separated by one =");
    }
    if (is_quote(given.front())) return behind_string(begin, key, given);
    if (const auto number = number_like(given)) return like_number(begin, key, given, *number);
    if (given.front() == '(') {
      const std::string_view inner = trimmed(given.substr(1, given.find(')') - 1));
      const bool expression = inner.find_first_of("*/+^") != std::string_view::npos;
      return fault(begin, key, given,
                   expression ? "an expression is written in quotes"
                              : "a list is written in brackets, [ and ]",
                   expression ? quoted(given) : fmt::format("[{}]", inner));
    }
    if (is_letter_or_underscore(given.front()) || given.front() == '-' || given.front() == '+' ||
        given.front() == '$' || given.front() == '/' || given.front() == '.') {
      return bare(begin, key, given);
    }
    return std::nullopt;
  }

  static std::string quoted(std::string_view text) { return '"' + shortened(text, 60) + '"'; }

  /// `= 1`, `driving v = 2`.
  std::optional<Fault> unfit_key() const {
    const std::string_view line = text_.substr(line_begin_, line_end_ - line_begin_);
    const std::string_view key = trimmed(line.substr(0, line.find('=')));
    const std::size_t begin = line_begin_ + indent(line);
    if (key.empty()) return fault(begin, "", "", "the key before = is missing", "KEY = VALUE");
    if (std::any_of(key.begin(), key.end(), is_space)) {
      return fault(begin, "", "", fmt::format("a key has no spaces: {}", shortened(key, 60)),
                   right_without_spaces(shortened(key, 60)));
    }
    return std::nullopt;
  }

  /// Lists and tables that are not closed, or lack a comma, or have one too many.
  std::optional<Fault> brackets(std::string_view given) const {
    if (!in_brackets()) return std::nullopt;
    const Bracket& last = opened_.brackets.back();
    const bool list = last.open == '[';
    const char* close = list ? "]" : "}";
    const bool at_end = at_ >= text_.size();
    const std::string_view key = key_before(last.at);
    const std::size_t first_end = std::min(text_.find('\n', last.at), text_.size());
    const std::string_view written = trimmed(text_.substr(last.at, first_end - last.at));
    if (message_.find("dangling comma") != std::string_view::npos) {
      return fault(at_, key, "", "a table in braces has no comma before its }");
    }
    if (message_.find("saw comma") != std::string_view::npos) {
      return fault(at_, key, "", "a value is missing before this comma");
    }
    if (!list && (at_end || text_[at_] == '\n' || text_[at_] == '\r')) {
      return fault(last.at, key, written,
                   "a table in braces ends in the line in which it begins, and here the closing } "
                   "is missing",
                   key.empty() ? "{ KEY = VALUE, KEY = VALUE }"
                               : fmt::format("{} = {{ KEY = VALUE, KEY = VALUE }}", key));
    }
    if (at_end) {
      return fault(last.at, key, written, "the closing ] of this list is missing");
    }
    if (message_.find("expected comma") == std::string_view::npos) return std::nullopt;
    // A line like KEY = VALUE, or a header, is behind the end of a list that was not closed.
    const std::string_view line = text_.substr(line_begin_, line_end_ - line_begin_);
    const bool later_line = last.at < line_begin_;
    if (list && later_line && (has_equals(line) || trimmed(line).starts_with("[["))) {
      return fault(last.at, key, written, "the closing ] of this list is missing");
    }
    const auto number = given.empty() ? std::nullopt : number_like(given);
    const bool within = number && offset_in_text(given) < at_;
    const std::string_view behind = within ? trimmed(number->rest) : std::string_view();
    const bool another = !behind.empty() && (is_quote(behind.front()) || is_digit(behind.front()));
    if ((within && !another) ||
        (!given.empty() && is_letter_or_underscore(given.front()) && offset_in_text(given) < at_ &&
         given.find('=') == std::string_view::npos)) {
      return std::nullopt;  // something is wrong with a value
    }
    return fault(at_, key, "",
                 fmt::format("a comma or the closing {} is missing before this", close));
  }

  std::optional<Fault> behind_string(std::size_t begin, std::string_view key,
                                     std::string_view given) const {
    const std::size_t end = end_of_string(text_, begin, text_.size());
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view string = text_.substr(begin, end - begin);
    const std::string_view behind = trimmed(given.substr(std::min(end - begin, given.size())));
    if (behind.empty()) return std::nullopt;
    return rest_of_line(key, behind, fmt::format("{} = {}", key, string))
        .value_or(fault(offset_in_text(behind), key, given,
                        "the quoted text ends before this; a quote inside it is written \\\"",
                        "single quotes around text with double ones in it"));
  }

  /// What may not follow a value in its line; nothing where it is neither of these.
  std::optional<Fault> rest_of_line(std::string_view key, std::string_view rest,
                                    const std::string& first) const {
    if (begins_comment_of_others(rest)) return comment(offset_in_text(rest));
    std::size_t end = 0;
    while (end < rest.size() && is_key_character(rest[end])) ++end;
    const std::string_view behind = trimmed(rest.substr(end));
    if (end > 0 && behind.starts_with("=") && !behind.starts_with("==")) {
      return fault(offset_in_text(rest), "", "",
                   in_brackets() ? "a comma is missing before this key"
                                 : "each key begins a line of its own",
                   first + (in_brackets() ? ", " : " in one line, ") + std::string(rest));
    }
    (void)key;
    return std::nullopt;
  }

  Fault like_number(std::size_t begin, std::string_view key, std::string_view given,
                    const NumberLike& number) const {
    const std::string_view rest = number.rest;
    const std::string text(number.number(given));
    if (rest.empty()) return unfit_number(begin, key, given, number);
    const std::string_view behind = trimmed(rest);
    if (auto found = rest_of_line(key, behind, fmt::format("{} = {}", key, text))) return *found;
    if (rest.front() == ',') {
      const std::string_view decimals = trimmed(rest.substr(1));
      const bool decimal = !decimals.empty() && digits_of(decimals).size() == decimals.size();
      return fault(begin, key, given,
                   decimal ? "decimals follow a point, not a comma"
                           : "several values are a list, in brackets",
                   decimal ? fmt::format("{}.{}", text, decimals) : fmt::format("[{}]", given));
    }
    if ((rest.front() == 'd' || rest.front() == 'D') && rest.size() > 1 &&
        (is_digit(rest[1]) || rest[1] == '-' || rest[1] == '+')) {
      return fault(begin, key, given, "an exponent begins with e",
                   text + "e" + std::string(rest.substr(1)));
    }
    if (const auto unit = unit_in(given)) {
      const std::string written = written_without_unit(*unit);
      return fault(
          offset_in_text(behind), key, given, std::string(kNumbersHaveNoUnits),
          written == unit->number ? fmt::format("{}, in the units of the scene", text) : written);
    }
    if (std::string_view("*/^+-(").find(behind.front()) != std::string_view::npos) {
      return fault(begin, key, given, "an expression is written in quotes", quoted(given));
    }
    return fault(offset_in_text(behind), key, given, "the number ends before this",
                 "a number, or an expression in quotes");
  }

  Fault unfit_number(std::size_t begin, std::string_view key, std::string_view given,
                     const NumberLike& number) const {
    const std::string sign(given.front() == '-' ? "-" : "");
    if (number.whole.empty()) {
      return fault(begin, key, given, "a number has a digit before its point",
                   fmt::format("{}0{}{}", sign, number.fraction, number.exponent));
    }
    if (number.fraction == ".") {
      return fault(begin, key, given, "a number has a digit behind its point",
                   fmt::format("{}{}.0{}", sign, number.whole, number.exponent));
    }
    if (!number.exponent.empty() && !is_digit(number.exponent.back())) {
      return fault(begin, key, given, "the digits of the exponent are missing");
    }
    if (number.whole.size() > 1 && number.whole.front() == '0') {
      const std::size_t zeros =
          std::min(number.whole.find_first_not_of('0'), number.whole.size() - 1);
      return fault(begin, key, given, "a number has no leading zeros",
                   fmt::format("{}{}{}{}", sign, number.whole.substr(zeros), number.fraction,
                               number.exponent));
    }
    if (message_.find("representable") != std::string_view::npos) {
      return fault_of(FaultCode::scene_out_of_range, begin, key, given, "too large for an integer",
                      "a number with a point or an exponent, as 1e23");
    }
    if (given.find('_') != std::string_view::npos) {
      return fault(begin, key, given, "an underscore stands between digits only");
    }
    return as_it_is();
  }

  /// A word, a name or an expression without quotes.
  Fault bare(std::size_t begin, std::string_view key, std::string_view given) const {
    std::string small(given);
    std::transform(small.begin(), small.end(), small.begin(), [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    for (const char* word : {"true", "false", "inf", "nan"}) {
      if (small == word && given != word) {
        return fault(begin, key, given, "is written in small letters", word);
      }
    }
    for (const auto& [word, meant] :
         {std::pair{"yes", "true"}, {"on", "true"}, {"no", "false"}, {"off", "false"}}) {
      if (small == word) {
        return fault(begin, key, given, "booleans are true and false; text is quoted", meant);
      }
    }
    if (small == "none" || small == "null" || small == "nil") {
      return fault(begin, key, given, "there is no null value", "leave the key out");
    }
    std::size_t end = 0;
    while (end < given.size() && !is_space(given[end])) ++end;
    const std::string_view behind = trimmed(given.substr(end));
    if (!behind.empty()) {
      const std::string_view word = given.substr(0, end);
      if (auto found = rest_of_line(key, behind, fmt::format("{} = {}", key, quoted(word)))) {
        return *found;
      }
    }
    return fault(begin, key, given, "words, names and expressions are written in quotes",
                 quoted(given));
  }

  std::string_view text_;
  const std::string& file_;
  std::string_view message_;
  std::size_t at_;
  std::size_t line_begin_ = 0;
  std::size_t line_end_ = 0;
  Opened opened_;
};

}  // namespace

Fault explain_syntax(std::string_view text, const std::string& file, const TextPlace& at,
                     std::string_view message) {
  return Syntax(text, file, at, message).explained();
}

Fault explain_character(std::string_view rest, const std::string& file, const TextPlace& at) {
  struct Known {
    std::string_view character;
    const char* why;
    const char* admissible;
  };
  static constexpr std::array kKnown = {
      Known{"\xE2\x80\x9C", "typographic quotes are not allowed", "\""},  // left double
      Known{"\xE2\x80\x9D", "typographic quotes are not allowed", "\""},  // right double
      Known{"\xE2\x80\x9E", "typographic quotes are not allowed", "\""},  // low double
      Known{"\xC2\xAB", "typographic quotes are not allowed", "\""},      // guillemet
      Known{"\xC2\xBB", "typographic quotes are not allowed", "\""},      // guillemet
      Known{"\xE2\x80\x98", "typographic quotes are not allowed", "'"},   // left single
      Known{"\xE2\x80\x99", "typographic quotes are not allowed", "'"},   // right single
      Known{"\xE2\x88\x92", "a minus sign is written as a hyphen", "-"},  // minus sign
      Known{"\xE2\x80\x93", "a minus sign is written as a hyphen", "-"},  // en dash
      Known{"\xE2\x80\x94", "a minus sign is written as a hyphen", "-"},  // em dash
      Known{"\xC2\xA0", "a no-break space (U+00A0)", "a plain space"},
      Known{"\xE2\x80\xAF", "a narrow no-break space (U+202F)", "a plain space"},
      Known{"\xE2\x80\x8B", "a zero-width space (U+200B)", "remove it"}};
  Fault fault(FaultCode::scene_syntax);
  fault.place = {file, static_cast<int>(at.line), static_cast<int>(at.column)};
  for (const Known& known : kKnown) {
    if (!rest.starts_with(known.character)) continue;
    fault.why = known.why;
    fault.admissible = known.admissible;
    return fault;
  }
  fault.why = "a character beyond ASCII outside of strings and comments";
  fault.admissible = "letters a to z, digits, _ and - in names; any text in quotes";
  return fault;
}

}  // namespace tomlin
