#include "framework/scene/document.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

// In toml++ 3.3 an assertion fails for "[=" before the error that the parser has for it; without
// NDEBUG and with no assertions nothing is assumed either, and the error is reached.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <fmt/format.h>
#include <toml++/toml.h>

#include "framework/core/text/ascii.hpp"
#include "framework/core/text/utf8.hpp"
#include "framework/scene/syntax_fault.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

// The TOML library does so, too; its columns do not count the mark.
std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

[[noreturn]] void stop(FaultCode code, const std::string& file, const TextPosition& mark,
                       std::string why, std::string admissible = "") {
  throw InputError({Fault(code, {file, static_cast<int>(mark.line), static_cast<int>(mark.column)},
                          "", "", std::move(why), std::move(admissible))});
}

/// Walks over text and knows line and column.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  bool at_end() const { return next_ >= text_.size(); }
  char peek() const { return text_[next_]; }
  std::string_view rest() const { return text_.substr(next_); }
  TextPosition mark() const { return mark_; }

  void advance(std::size_t bytes = 1) {
    for (; bytes > 0 && !at_end(); --bytes, ++next_) {
      if (text_[next_] == '\n') {
        ++mark_.line;
        mark_.column = 1;
      } else if (!is_utf8_continuation(text_[next_])) {
        ++mark_.column;
      }
    }
  }

 private:
  std::string_view text_;
  std::size_t next_ = 0;
  TextPosition mark_{1, 1};
};

/// The first character of UTF-8 text that begins beyond ASCII.
std::uint32_t code_point(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  std::uint32_t point = first >= 0xF0U   ? first & 0x07U
                        : first >= 0xE0U ? first & 0x0FU
                                         : first & 0x1FU;
  for (const char c : text.substr(1)) {
    if (!is_utf8_continuation(c)) break;
    point = point << 6U | (static_cast<unsigned char>(c) & 0x3FU);
  }
  return point;
}

void refuse_other_encodings(std::string_view text, const std::string& file) {
  const std::size_t valid = valid_utf8_prefix(text);
  if (valid == text.size()) return;
  Cursor cursor(text);
  cursor.advance(valid);
  stop(FaultCode::scene_encoding, file, cursor.mark(), "the file is not UTF-8 text");
}

/// Checks a text before the library reads it, for what the library does not survive: nesting
/// without end, and characters beyond ASCII where it compares them with white space. For U+00A1 and
/// some 3000 others the behaviour of that comparison is undefined. It is made outside of strings
/// and comments, in multi-line strings behind a backslash, and in all of a malformed number, such
/// as 1"text".
class Outline {
 public:
  Outline(std::string_view text, const std::string& file) : cursor_(text), file_(file) {}

  void check() {
    while (!cursor_.at_end()) {
      const char c = cursor_.peek();
      const bool string = (c == '"' || c == '\'') && !in_number_;
      in_number_ = in_number_ ? !contains(" \t\n\v\f\r]},#", c)
                              : contains(" \t\n\r=[{,", before_) && contains("+-0123456789", c);
      before_ = c;
      if (string) {
        skip_string();
      } else if (c == '#') {
        while (!cursor_.at_end() && cursor_.peek() != '\n') cursor_.advance();
      } else {
        look_at(c);
        cursor_.advance();
      }
    }
  }

 private:
  static bool contains(std::string_view characters, char c) {
    return characters.find(c) != std::string_view::npos;
  }

  void skip_string() {
    const char quote = cursor_.peek();
    const std::string triple(3, quote);
    const bool multi_line = cursor_.rest().starts_with(triple);
    const std::string_view end = multi_line ? triple : std::string_view(triple).substr(0, 1);
    cursor_.advance(end.size());
    while (!cursor_.at_end() && !cursor_.rest().starts_with(end)) {
      if (!multi_line && cursor_.peek() == '\n') return;  // not closed: the library says so
      const bool escape = quote == '"' && cursor_.peek() == '\\';
      if (escape && multi_line) check_behind_backslash();
      cursor_.advance(escape ? 2 : 1);
    }
    cursor_.advance(end.size());
    // Up to two quotes before the closing three are the string's own: """"a"""""
    for (int own = 0; multi_line && own < 2 && !cursor_.at_end() && cursor_.peek() == quote;
         ++own) {
      cursor_.advance();
    }
  }

  void check_behind_backslash() const {
    const std::string_view rest = cursor_.rest();
    const std::size_t next = rest.find_first_not_of(" \t\n\v\f\r", 1);
    if (next == std::string_view::npos || is_ascii(rest[next])) return;
    Cursor behind = cursor_;
    behind.advance(next);
    stop(FaultCode::scene_syntax, file_, behind.mark(),
         "a backslash, also one at the end of a line, is followed by a character beyond ASCII",
         "an escape, as \\u00e9");
  }

  void look_at(char c) {
    // Strict TOML has other alphabets in strings and comments only.
    if (!is_ascii(c)) {
      stop(FaultCode::scene_syntax, file_, cursor_.mark(),
           fmt::format("the character U+{:04X} outside of strings and comments",
                       code_point(cursor_.rest())),
           "letters a to z, digits, plain quotes, hyphens and spaces; any text in quotes");
    }
    bool begins_value = true;
    switch (c) {
      case '[':
      case '{':
        ++brackets_;
        break;
      case '=':
      case ',':
        break;
      case ']':
      case '}':
        brackets_ = std::max(0, brackets_ - 1);
        [[fallthrough]];
      case '\n':
      case '.':
        begins_value = false;
        break;
      default:
        return;
    }
    // The library and all that follows walk nested values and tables by recursion; a file must not
    // exhaust the stack. Dots are those of one key.
    dots_ = c == '.' ? dots_ + 1 : 0;
    if (brackets_ > kDeepestNesting || dots_ >= kDeepestNesting) {
      stop(FaultCode::scene_too_large, file_, cursor_.mark(), "nested too deeply",
           "at most " + std::to_string(kDeepestNesting) + " levels");
    }
    if (begins_value && ++values_ > kMostValues) {
      stop(FaultCode::scene_too_large, file_, cursor_.mark(), "too many values",
           "at most " + std::to_string(kMostValues) + " values, lists and tables in a scene");
    }
  }

  Cursor cursor_;
  const std::string& file_;
  char before_ = '\n';      ///< the byte before, or the quote that opened the string before
  bool in_number_ = false;  ///< in what begins as a number does; there a quote opens no string
  int brackets_ = 0;
  int dots_ = 0;
  std::size_t values_ = 0;
};

bool says_nothing(std::string_view text) {
  Cursor cursor(text);
  for (; !cursor.at_end(); cursor.advance()) {
    if (cursor.peek() == '#') {
      while (!cursor.at_end() && cursor.peek() != '\n') cursor.advance();
    } else if (std::string_view(" \t\r\n").find(cursor.peek()) == std::string_view::npos) {
      return false;
    }
  }
  return true;
}

Extent extent_of(const toml::source_region& region, std::uint32_t setting) {
  return {{region.begin.line, region.begin.column}, {region.end.line, region.end.column}, setting};
}

bool comes_before(const Entry& a, const Entry& b) {
  return std::pair(a.where.begin.line, a.where.begin.column) <
         std::pair(b.where.begin.line, b.where.begin.column);
}

Node converted(const toml::node& node, std::uint32_t setting) {
  Node result;
  result.where = extent_of(node.source(), setting);
  if (const auto* table = node.as_table()) {
    Table& entries = result.value.emplace<Table>();
    for (const auto& [key, value] : *table) {
      entries.entries.push_back(
          {std::string(key.str()), extent_of(key.source(), setting), converted(value, setting)});
    }
    // The library sorts by key.
    std::stable_sort(entries.entries.begin(), entries.entries.end(), comes_before);
  } else if (const auto* array = node.as_array()) {
    List& list = result.value.emplace<List>();
    list.reserve(array->size());
    for (const toml::node& element : *array) list.push_back(converted(element, setting));
  } else if (const auto* text = node.as_string()) {
    result.value = text->get();
  } else if (const auto* integer = node.as_integer()) {
    result.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    result.value = number->get();
  } else if (const auto* boolean = node.as_boolean()) {
    result.value = boolean->get();
  } else {
    result.value = Moment{};
  }
  return result;
}

}  // namespace

const Entry* Table::find_entry(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [key](const Entry& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

const Node* Table::find(std::string_view key) const {
  const Entry* entry = find_entry(key);
  return entry == nullptr ? nullptr : &entry->value;
}

Node* Table::find(std::string_view key) {
  return const_cast<Node*>(std::as_const(*this).find(key));
}

void Table::set(std::string_view key, Node value) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [key](const Entry& entry) { return entry.key == key; });
  if (found == entries.end()) {
    const Extent where = value.where;
    entries.push_back({std::string(key), where, std::move(value)});
  } else {
    found->where = value.where;
    found->value = std::move(value);
  }
}

std::string kind_of(const Node& node) {
  static constexpr const char* kKinds[] = {"a boolean", "an integer", "a number",      "text",
                                           "a list",    "a table",    "a date or time"};
  return kKinds[node.value.index()];
}

void check_outline(std::string_view text, const std::string& file) { Outline(text, file).check(); }

void refuse_too_large(const std::string& file) {
  stop(FaultCode::scene_too_large, file, {1, 1}, "the file is too large",
       "at most " + std::to_string(kLargestSceneFile >> 20) + " MiB");
}

namespace {

std::atomic<std::size_t> parsed = 0;

Table parse_text(std::string_view text, const std::string& file) {
  if (text.size() > kLargestSceneFile) refuse_too_large(file);
  refuse_other_encodings(text, file);
  text = without_byte_order_mark(text);
  if (says_nothing(text)) {
    stop(FaultCode::file_invalid, file, {1, 1}, "the file is empty: there is no scene in it");
  }
  check_outline(text, file);
  try {
    const toml::table document = toml::parse(text);
    return std::move(*converted(document, 0).as<Table>());
  } catch (const toml::parse_error& error) {
    const auto& begin = error.source().begin;
    throw InputError({explain_syntax(text, file, {begin.line, begin.column}, error.description())});
  }
}

}  // namespace

Table parse_document(std::string_view text, const std::string& file) {
  ++parsed;
  return parse_text(text, file);
}

std::size_t parsed_documents() { return parsed; }

namespace {

/// The value of a text that is a decimal number with a fraction or an exponent, as most values of
/// axes are. The library needs some microseconds for it.
std::optional<double> plain_number(std::string_view text) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  const std::size_t point = text.find_first_not_of("0123456789", sign);
  const bool leading_zero = text.size() > sign + 1 && text[sign] == '0' && is_digit(text[sign + 1]);
  if (point == sign || point == std::string_view::npos || leading_zero) return {};
  if (text[point] != 'e' && (text[point] != '.' || point + 1 == text.size())) return {};
  if (text[point] == '.' && !is_digit(text[point + 1])) return {};
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

Node parse_setting(std::string_view text, std::uint32_t setting) {
  Node plain_text;
  plain_text.value = std::string(text);
  plain_text.where.setting = setting;
  if (const auto number = plain_number(text)) {
    plain_text.value = *number;
    return plain_text;
  }
  const std::string document = "value = " + std::string(text);
  try {
    if (document.size() > kLargestSceneFile) return plain_text;
    check_outline(document, "");
    const toml::table table = toml::parse(document);
    // More than one entry: a line break in the text, and then something like "other = 1".
    if (table.size() == 1) return converted(table.begin()->second, setting);
  } catch (const toml::parse_error&) {
    return plain_text;
  } catch (const InputError&) {
    return plain_text;
  }
  return plain_text;
}

std::optional<Fault> explain_setting(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return std::nullopt;
  if (std::string_view("[{\"'").find(text[begin]) == std::string_view::npos) return std::nullopt;
  const std::string document = "value = " + std::string(text);
  try {
    (void)parse_text(document, "");
  } catch (const InputError& error) {
    return error.faults().front();
  }
  return std::nullopt;
}

Source::Source(std::string file, std::string_view text, const std::vector<Setting>& settings)
    : file_(std::move(file)), text_(without_byte_order_mark(text)), settings_(settings) {}

SourceLocation Source::location(const Extent& extent) const {
  if (extent.setting > 0) {
    const Setting& setting = settings_[extent.setting - 1];
    return {"--set " + shortened(setting.path + "=" + setting.value, kLongestShownValue), 0, 0};
  }
  return {file_, static_cast<int>(extent.begin.line), static_cast<int>(extent.begin.column)};
}

std::string Source::written(const Extent& extent) const {
  return shortened(slice(extent), kLongestShownValue);
}

SourceLocation Source::location_inside(const Node& text, std::size_t byte) const {
  SourceLocation location = this->location(text.where);
  const std::string* contents = text.as<std::string>();
  const std::string_view source = slice(text.where);
  const bool literal = contents != nullptr && source.size() == contents->size() + 2 &&
                       source.substr(1, contents->size()) == *contents;
  if (text.where.setting == 0 && literal) {
    const std::string_view before = std::string_view(*contents).substr(0, byte);
    location.column += 1 + static_cast<int>(std::count_if(before.begin(), before.end(), [](char c) {
                         return !is_utf8_continuation(c);
                       }));
  }
  return location;
}

std::string_view Source::slice(const Extent& extent) const {
  if (extent.setting > 0) return settings_[extent.setting - 1].value;
  if (extent.begin.line == 0) return {};
  const std::size_t begin = offset(extent.begin);
  return text_.substr(begin, offset(extent.end) - begin);
}

std::size_t Source::offset(const TextPosition& mark) const {
  const bool ahead =
      std::pair(mark.line, mark.column) >= std::pair(last_mark_.line, last_mark_.column);
  TextPosition here = ahead ? last_mark_ : TextPosition{1, 1};
  std::size_t at = ahead ? last_offset_ : 0;
  while (here.line < mark.line) {
    const std::size_t end = text_.find('\n', at);
    if (end == std::string_view::npos) return text_.size();
    at = end + 1;
    here = {here.line + 1, 1};
  }
  for (; here.column < mark.column && at < text_.size(); ++here.column) {
    do {
      ++at;
    } while (at < text_.size() && is_utf8_continuation(text_[at]));
  }
  last_mark_ = here;
  last_offset_ = at;
  return at;
}

}  // namespace tomlin
