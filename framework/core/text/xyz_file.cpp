#include "framework/core/text/xyz_file.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "framework/core/text/ascii.hpp"
#include "framework/core/text/number_file.hpp"
#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostFaults = 10;  // of a file; nobody reads more
constexpr std::size_t kLongestSpecies = 60;
constexpr std::size_t kAxes = 3;
constexpr std::string_view kNoElement = "X";
constexpr std::string_view kStandardProperties = "species:S:1:pos:R:3";

/// Lines of a text, one after the other.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool any() const { return !rest_.empty(); }
  std::string_view rest() const { return rest_; }
  std::size_t number() const { return number_; }  ///< of the line that next() returned
  std::string_view next() {
    const std::size_t length = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, length);
    rest_.remove_prefix(std::min(length + 1, rest_.size()));
    ++number_;
    return line;
  }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// The words of a line, one after the other; an empty one at its end.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view next() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    std::size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

 private:
  std::string_view rest_;
};

bool is_blank_line(std::string_view line) { return Words(line).next().empty(); }

template <class Number>
std::optional<Number> whole_number(std::string_view word) {
  Number number = 0;
  const auto end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

bool is_same_key(std::string_view one, std::string_view other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](char a, char b) { return in_lower_case(a) == in_lower_case(b); });
}

/// The value of a key in a line of key=value, of which a value may stand in quotation marks;
/// nothing where the key is absent.
std::optional<std::string> value_in(std::string_view line, std::string_view wanted) {
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && is_space(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !is_space(line[at]) && line[at] != '=') ++at;
    const std::string_view key = line.substr(begin, at - begin);
    if (at == line.size() || line[at] != '=') continue;
    ++at;
    const bool quoted = at < line.size() && line[at] == '"';
    at += quoted ? 1 : 0;
    std::string value;
    while (at < line.size() && (quoted ? line[at] != '"' : !is_space(line[at]))) {
      if (quoted && line[at] == '\\' && at + 1 < line.size()) ++at;
      value += line[at++];
    }
    at += quoted ? 1 : 0;
    if (is_same_key(key, wanted)) return value;
  }
  return std::nullopt;
}

/// Purpose of a column.
enum class ColumnUse { skipped, species, position, velocity, mass };

struct Property {
  ColumnUse use = ColumnUse::skipped;
  std::size_t columns = 0;
};

ColumnUse use_of(std::string_view name) {
  if (name == "species") return ColumnUse::species;
  if (name == "pos") return ColumnUse::position;
  for (const char* known : {"velo", "vel", "velocity", "velocities"}) {
    if (name == known) return ColumnUse::velocity;
  }
  return name == "mass" || name == "masses" ? ColumnUse::mass : ColumnUse::skipped;
}

/// The columns that Properties names; `why` says what is wrong with it.
std::vector<Property> properties_in(std::string_view text, std::string& why) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t length = std::min(text.find(':'), text.size());
    parts.push_back(text.substr(0, length));
    if (length == text.size()) break;
    text.remove_prefix(length + 1);
  }
  std::vector<Property> properties;
  if (parts.size() % 3 != 0) {
    why = "Properties are no list of NAME:KIND:COLUMNS";
    return properties;
  }
  for (std::size_t k = 0; k < parts.size(); k += 3) {
    constexpr std::size_t kMostColumns = 1000;
    const ColumnUse use = use_of(parts[k]);
    const auto columns = whole_number<std::size_t>(parts[k + 2]);
    const bool is_kind = parts[k + 1].size() == 1 &&
                         std::string_view("SRIL").find(parts[k + 1]) != std::string_view::npos;
    if (!is_kind || !columns || *columns < 1 || *columns > kMostColumns) {
      why = fmt::format("property {} has no kind S, R, I or L, or no number of columns", k / 3);
      return properties;
    }
    const bool is_vector = use == ColumnUse::position || use == ColumnUse::velocity;
    const char* kind = use == ColumnUse::species ? "S" : "R";
    if (use != ColumnUse::skipped &&
        (*columns != (is_vector ? kAxes : 1) || parts[k + 1] != kind)) {
      why = fmt::format("property {} is expected to be :{}:{}", k / 3, kind, is_vector ? kAxes : 1);
      return properties;
    }
    const auto is_taken = [use](const Property& one) { return one.use == use; };
    if (use != ColumnUse::skipped && std::any_of(properties.begin(), properties.end(), is_taken)) {
      why = fmt::format("property {} is there twice", k / 3);
      return properties;
    }
    properties.push_back({use, *columns});
  }
  const auto is_position = [](const Property& one) { return one.use == ColumnUse::position; };
  if (std::none_of(properties.begin(), properties.end(), is_position)) {
    why = "Properties have no pos:R:3";
  }
  return properties;
}

/// The lines of one frame.
struct FrameText {
  std::size_t first_line = 0;  ///< that with the number of particles
  std::size_t particles = 0;
  std::string_view comment;
  std::string_view rows;  ///< all of them, with what follows
};

class XyzReader {
 public:
  XyzReader(std::string_view text, const std::string& name) : name_(name) {
    if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    text_ = text;
  }

  XyzFrame read(std::int64_t wanted) {
    const std::vector<FrameText> frames = frames_in();
    if (!frame_.faults.empty()) return std::move(frame_);
    const auto count = static_cast<std::int64_t>(frames.size());
    const std::int64_t index = wanted < 0 ? count + wanted : wanted;
    if (index < 0 || index >= count) {
      refuse(1, fmt::format("the file has {} frame{}", count, count == 1 ? "" : "s"));
    } else {
      read_frame(frames[static_cast<std::size_t>(index)]);
    }
    return std::move(frame_);
  }

 private:
  void refuse(std::size_t line, const std::string& why) {
    frame_.faults.push_back(fmt::format("{}:{}: {}", name_, line, why));
  }

  /// Finds the start of each frame; none in a file that ends too early.
  std::vector<FrameText> frames_in() {
    std::vector<FrameText> frames;
    Lines lines(text_);
    while (lines.any()) {
      const std::string_view head = lines.next();
      if (!frames.empty() && is_blank_line(head)) continue;
      FrameText frame;
      frame.first_line = lines.number();
      Words words(head);
      const auto count = whole_number<std::size_t>(words.next());
      if (!count || *count == 0 || !words.next().empty()) {
        refuse(lines.number(), "the line is not a number of particles");
        return {};
      }
      frame.particles = *count;
      frame.comment = lines.next();
      frame.rows = lines.rest();
      for (std::size_t i = 0; i < frame.particles; ++i) {
        if (!lines.any()) {
          refuse(lines.number(),
                 fmt::format("the file ends after {} of {} particles", i, frame.particles));
          return {};
        }
        lines.next();
      }
      frames.push_back(frame);
    }
    if (frames.empty()) refuse(1, "the file has no particles");
    return frames;
  }

  void read_frame(const FrameText& frame) {
    const auto given = value_in(frame.comment, "Properties");
    std::string why;
    const std::vector<Property> properties =
        properties_in(given ? std::string_view(*given) : kStandardProperties, why);
    if (!why.empty()) return refuse(frame.first_line + 1, why);
    if (const auto dimension = value_in(frame.comment, "dimension")) {
      const auto axes = whole_number<std::size_t>(*dimension);
      if (!axes || *axes < 1 || *axes > kAxes) {
        return refuse(frame.first_line + 1, "dimension is not 1, 2 or 3");
      }
      frame_.dimension = *axes;
    }
    Lines lines(frame.rows);
    for (std::size_t i = 0; i < frame.particles && frame_.faults.size() < kMostFaults; ++i) {
      const std::string_view row = lines.next();
      std::string fault = read_row(row, properties, !given);
      if (!fault.empty()) refuse(frame.first_line + 1 + lines.number(), fault);
    }
    const auto& names = frame_.species;
    const bool named = std::any_of(names.begin(), names.end(),
                                   [](const std::string& one) { return one != kNoElement; });
    if (!named) frame_.species.clear();
  }

  /// Never repeats what stands in the file: a scene of somebody else's may name any.
  std::string read_row(std::string_view row, const std::vector<Property>& properties, bool plain) {
    Words words(row);
    std::size_t column = 0;
    for (const Property& property : properties) {
      for (std::size_t k = 0; k < property.columns; ++k) {
        const std::string_view word = words.next();
        ++column;
        if (word.empty()) return fmt::format("column {} is missing", column);
        const std::string why = take(word, property.use, k);
        if (!why.empty()) return fmt::format("column {} {}", column, why);
      }
    }
    if (!plain && !words.next().empty()) {
      return fmt::format("there are more than {} columns", column);
    }
    return {};
  }

  std::string take(std::string_view word, ColumnUse use, std::size_t axis) {
    if (use == ColumnUse::skipped) return {};
    if (use == ColumnUse::species) {
      if (!is_species_name(word)) return "is not a name of a species";
      frame_.species.emplace_back(word);
      return {};
    }
    std::string why;
    const double number = parse_number(word, why);
    if (!why.empty()) return why;
    if (use == ColumnUse::mass) {
      if (!(number > 0.0)) return "is a mass that is not positive";
      frame_.masses.push_back(number);
    } else if (axis < frame_.dimension) {
      (use == ColumnUse::position ? frame_.positions : frame_.velocities).push_back(number);
    } else if (number != 0.0) {
      return fmt::format("is not zero, but the frame has dimension={}", frame_.dimension);
    }
    return {};
  }

  std::string name_;
  std::string_view text_;
  XyzFrame frame_;
};

}  // namespace

bool is_species_name(std::string_view name) {
  if (name.empty() || name.size() > kLongestSpecies) return false;
  return is_letter_or_underscore(name.front()) && std::all_of(name.begin(), name.end(), [](char c) {
           return is_letter_or_underscore(c) || is_digit(c) ||
                  std::string_view("-+()").find(c) != std::string_view::npos;
         });
}

XyzFrame parse_xyz(std::string_view text, const std::string& name, std::int64_t frame) {
  return XyzReader(text, name).read(frame);
}

}  // namespace tomlin
