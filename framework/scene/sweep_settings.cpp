#include "framework/scene/sweep_settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "framework/core/formula/rounded_functions.hpp"
#include "framework/core/text/ascii.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/parameter_table.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/sweep_refinement.hpp"
#include "framework/scene/table_reader.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kAxisForms =
    "NAME=a,b,c or NAME=from:to:count or NAME=from:to:count:log with numbers";

/// Up to here doubles hold every integer.
constexpr std::int64_t kLargestInteger = std::int64_t{1} << 53;

/// A number that a double holds, or an expression without parameters.
std::optional<double> constant_of(std::string_view text) {
  const Node node = parse_setting(text, 0);
  if (const auto* number = node.as<double>()) return *number;
  if (const auto* integer = node.as<std::int64_t>()) {
    if (*integer > kLargestInteger || *integer < -kLargestInteger) return std::nullopt;
    return static_cast<double>(*integer);
  }
  const auto* expression = node.as<std::string>();
  if (expression == nullptr) return std::nullopt;
  const auto value = ParameterTable().evaluate(*expression);
  if (const double* number = std::get_if<double>(&value)) return *number;
  return std::nullopt;
}

/// At marks outside of brackets and quotes.
std::vector<std::string> split_outside(std::string_view text, char mark) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = '\0';
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quote != '\0') {
      if (c == '\\' && quote == '"' && k + 1 < text.size()) parts.back() += text[k++];
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{' || c == '(') {
      ++depth;
    } else if (c == ']' || c == '}' || c == ')') {
      --depth;
    } else if (c == mark && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += text[k];
  }
  for (std::string& part : parts) part = std::string(trimmed(part, " \t"));
  return parts;
}

/// Whether a name of `--set` is another one or stands below it. A parameter has two names.
bool sets_part_of(const std::string& name, const std::string& whole) {
  const auto in_full = [](const std::string& one) {
    return one.find('.') == std::string::npos ? "parameters." + one : one;
  };
  const std::string below = in_full(whole);
  return (in_full(name) + ".").starts_with(below + ".");
}

Wrong wrong_axis(std::string why, std::string admissible = kAxisForms) {
  return {FaultCode::command_invalid_value, "", std::move(why), std::move(admissible)};
}

}  // namespace

std::string number_as_setting(double number) { return fmt::format("{}", number); }

std::optional<double> finite_constant(std::string_view text) {
  const auto number = constant_of(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::variant<SweepValues, Wrong> SweepValues::parse(std::string_view text) {
  const std::vector<std::string> ends = split_outside(text, ':');
  if (ends.size() == 1) {
    std::vector<std::string> values = split_outside(text, ',');
    if (std::find(values.begin(), values.end(), "") != values.end()) {
      return wrong_axis(values.size() == 1 ? "no values" : "an empty value");
    }
    if (values.size() > kMostSweepPoints) return wrong_axis("too many values");
    return listed(std::move(values));
  }
  if (ends.size() > 4 || ends.size() < 3) {
    return wrong_axis("a grid has two ends and a number of points");
  }
  SweepValues values;
  const auto from = finite_constant(ends[0]);
  const auto to = finite_constant(ends[1]);
  if (!from || !to) {
    const std::string& end = from ? ends[1] : ends[0];
    return wrong_axis(fmt::format("\"{}\" is not a finite number that a double holds", end));
  }
  values.from_ = *from;
  values.to_ = *to;
  values.spacing_ = Spacing::linear;
  if (ends.size() == 4) {
    if (ends[3] != "log" && ends[3] != "lin") {
      Wrong wrong = wrong_axis(fmt::format("\"{}\" is no spacing", ends[3]), "log, or lin");
      wrong.nearest = nearest_name(ends[3], {"log", "lin"}).value_or("");
      return wrong;
    }
    if (ends[3] == "log") values.spacing_ = Spacing::logarithmic;
  }
  const std::string& count = ends[2];
  const auto read = std::from_chars(count.data(), count.data() + count.size(), values.count_);
  if (read.ec != std::errc() || read.ptr != count.data() + count.size() || values.count_ < 2 ||
      values.count_ > kMostSweepPoints) {
    return wrong_axis(fmt::format("\"{}\" is no number of points", count),
                      fmt::format("an integer from 2 to {}", kMostSweepPoints));
  }
  if (values.spacing_ == Spacing::logarithmic && !(values.from_ > 0.0 && values.to_ > 0.0)) {
    return wrong_axis("logarithms of both ends are needed", "ends > 0");
  }
  return values;
}

SweepValues SweepValues::listed(std::vector<std::string> texts) {
  SweepValues values;
  values.texts_ = std::move(texts);
  values.count_ = values.texts_.size();
  for (const std::string& text : values.texts_) {
    const auto number = finite_constant(text);
    values.numeric_ = values.numeric_ && number;
    if (values.numeric_) values.numbers_.push_back(*number);
  }
  if (!values.numeric_) values.numbers_.clear();
  return values;
}

std::string SweepValues::text(std::size_t k) const {
  return spacing_ == Spacing::list ? texts_[k] : number_as_setting(number(k));
}

std::string SweepValues::plain_text(std::size_t k) const {
  if (spacing_ != Spacing::list) return text(k);
  const Node node = parse_setting(texts_[k], 0);
  const auto* word = node.as<std::string>();
  if (word == nullptr) return value_text(node);
  const Node again = parse_setting(*word, 0);
  const auto* same = again.as<std::string>();
  return same != nullptr && *same == *word ? *word : value_text(node);
}

double SweepValues::number(std::size_t k) const {
  switch (spacing_) {
    case Spacing::list:
      return numbers_[k];
    case Spacing::linear:
      return rounded_linear_step(from_, to_, k, count_ - 1);
    case Spacing::logarithmic:
      break;
  }
  return rounded_logarithmic_step(from_, to_, k, count_ - 1);
}

std::string SweepValues::canonical() const {
  if (spacing_ == Spacing::list) {
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < count_; ++k) texts.push_back(plain_text(k));
    return fmt::format("{}", fmt::join(in_quotes(texts), ","));
  }
  return fmt::format("{}:{}:{}:{}", from_, to_, count_,
                     spacing_ == Spacing::logarithmic ? "log" : "lin");
}

void add_axis(SweepSettings& settings, const std::string& name, const std::string& values,
              const SourceLocation& location, std::vector<Fault>& faults) {
  const std::string shown = shortened(values, kLongestShownValue);
  auto read = SweepValues::parse(values);
  if (auto* axis = std::get_if<SweepValues>(&read)) {
    settings.over.push_back({name, std::move(*axis), location, shown});
    return;
  }
  settings.unread.push_back(name);
  Wrong& wrong = std::get<Wrong>(read);
  faults.emplace_back(wrong.code, location, name, shown, std::move(wrong.why),
                      std::move(wrong.admissible), std::move(wrong.nearest));
}

void add_repeats(SweepSettings& settings, std::vector<Fault>& faults) {
  if (!settings.repeats) return;
  const SweepText given = *std::exchange(settings.repeats, std::nullopt);
  std::size_t count = 0;
  const char* const end = given.text.data() + given.text.size();
  const auto [read, error] = std::from_chars(given.text.data(), end, count);
  if (error != std::errc() || read != end || count < 2 || count > kMostSweepPoints) {
    faults.emplace_back(FaultCode::command_invalid_value, given.location, given.key, given.text,
                        "not a number of repeats",
                        fmt::format("a whole number from 2 to {}", kMostSweepPoints));
    return;
  }
  auto values = SweepValues::parse(fmt::format("0:{}:{}", count - 1, count));
  settings.over.insert(
      settings.over.begin(),
      {"run.stream", std::get<SweepValues>(std::move(values)), given.location, given.text});
}

std::vector<SweepDimension> sweep_dimensions(const SweepSettings& settings,
                                             std::vector<Fault>& faults) {
  const std::vector<SweepAxis>& over = settings.over;
  std::vector<std::string> names;
  for (const SweepAxis& axis : over) {
    const bool taken = std::any_of(names.begin(), names.end(), [&axis](const std::string& name) {
      return sets_part_of(axis.name, name) || sets_part_of(name, axis.name);
    });
    if (taken) {
      faults.emplace_back(FaultCode::scene_duplicate_key, axis.location, axis.name, axis.shown,
                          "another axis sets it, or a part of it, already");
    }
    names.push_back(axis.name);
  }
  const auto index_of = [&names](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };

  std::vector<const SweepZip*> zip_of(over.size(), nullptr);
  for (const SweepZip& zip : settings.zips) {
    const std::string shown = fmt::format("{}", fmt::join(zip.names, ","));
    const auto complain = [&](FaultCode code, std::string why, std::string admissible,
                              std::string nearest = "") {
      faults.emplace_back(code, zip.location, "zip", shown, std::move(why), std::move(admissible),
                          std::move(nearest));
    };
    if (zip.names.size() < 2) {
      complain(FaultCode::scene_wrong_count, "one name alone is an axis anyway",
               "two names or more");
    }
    const SweepAxis* first = nullptr;
    for (const std::string& name : zip.names) {
      const auto& unread = settings.unread;
      if (std::find(unread.begin(), unread.end(), name) != unread.end()) continue;
      const std::size_t k = index_of(name);
      if (k == over.size()) {
        complain(FaultCode::scene_unknown_name, fmt::format("there is no axis \"{}\"", name),
                 listed(names), nearest_name(name, names).value_or(""));
        continue;
      }
      if (zip_of[k] != nullptr) {
        complain(FaultCode::scene_conflict, fmt::format("\"{}\" is zipped already", name), "");
        continue;
      }
      zip_of[k] = &zip;
      if (first == nullptr) first = &over[k];
      if (over[k].values.size() != first->values.size()) {
        complain(FaultCode::scene_wrong_count,
                 fmt::format("{} has {} values and {} has {}", first->name, first->values.size(),
                             name, over[k].values.size()),
                 "the same number of values");
      }
    }
  }

  std::vector<SweepDimension> dimensions;
  std::map<const SweepZip*, std::size_t> made;
  for (std::size_t k = 0; k < over.size(); ++k) {
    if (zip_of[k] != nullptr) {
      const auto [entry, is_new] = made.try_emplace(zip_of[k], dimensions.size());
      if (!is_new) {
        dimensions[entry->second].axes.push_back(k);
        continue;
      }
    }
    dimensions.push_back({{k}, over[k].values.size()});
  }
  if (dimensions.size() > kMostSweepDimensions) {
    faults.emplace_back(FaultCode::scene_too_large, over.front().location, "", "",
                        fmt::format("{} axes are too many", dimensions.size()),
                        fmt::format("at most {}; --set for a single value", kMostSweepDimensions));
  }
  double points = 1.0;
  for (const SweepDimension& dimension : dimensions) points *= static_cast<double>(dimension.count);
  if (points > static_cast<double>(kMostSweepPoints)) {
    faults.emplace_back(FaultCode::scene_too_large, over.front().location, "", "",
                        fmt::format("{:g} points are too many", points),
                        fmt::format("at most {}", kMostSweepPoints));
  }
  return dimensions;
}

namespace {

/// `[sweep]` on its way into settings.
class SweepReader {
 public:
  SweepReader(const Source& source, std::vector<Fault>& faults)
      : source_(source), faults_(faults) {}

  SweepSettings read(const Node& given) {
    const Table* table = given.as<Table>();
    if (table == nullptr) {
      wrong_type(given, "sweep", "a table, [sweep]");
      return {};
    }
    for (const Entry& entry : table->entries) {
      if (entry.key == "over") {
        read_over(entry.value, "");
      } else if (entry.key == "zip") {
        read_zips(entry.value);
      } else if (entry.key == "continue_from_neighbour") {
        const bool* value = entry.value.as<bool>();
        if (value != nullptr) {
          settings_.continues = *value;
        } else {
          wrong_type(entry.value, "sweep.continue_from_neighbour", "true or false");
        }
      } else if (entry.key == "repeats") {
        const auto* count = entry.value.as<std::int64_t>();
        if (count != nullptr && *count < 2) {
          complain(entry.value, FaultCode::scene_out_of_range, "sweep.repeats", "out of range",
                   "2 or more");
        } else if (count != nullptr) {
          settings_.repeats = text_of(entry, value_text(entry.value));
        } else {
          wrong_type(entry.value, "sweep.repeats", "a whole number");
        }
      } else if (entry.key == "refine") {
        read_text(entry, settings_.refine.what, "an observable in quotes");
      } else if (entry.key == "refine_along") {
        read_text(entry, settings_.refine.along, "a name of over in quotes");
      } else if (entry.key == "refine_to") {
        const bool is_number =
            entry.value.as<double>() != nullptr || entry.value.as<std::int64_t>() != nullptr;
        if (is_number) {
          settings_.refine.to = text_of(entry, value_text(entry.value));
        } else {
          read_text(entry, settings_.refine.to, "a number");
        }
      } else if (entry.key == "files") {
        check_files(entry.value);
      } else if (entry.key == "observables") {
        settings_.observables = words(entry.value, "sweep.observables");
        settings_.observables_location = source_.location(entry.value.where);
      } else {
        report_unknown(entry);
      }
    }
    return std::move(settings_);
  }

 private:
  void complain(const Node& node, FaultCode code, std::string key, std::string why,
                std::string admissible) {
    faults_.emplace_back(code, source_.location(node.where), std::move(key),
                         source_.written(node.where), std::move(why), std::move(admissible));
  }

  void wrong_type(const Node& node, std::string key, std::string admissible) {
    complain(node, FaultCode::scene_wrong_type, std::move(key), "found " + kind_of(node),
             std::move(admissible));
  }

  SweepText text_of(const Entry& entry, std::string text) const {
    return {std::move(text), source_.location(entry.value.where), "sweep." + entry.key};
  }

  void read_text(const Entry& entry, std::optional<SweepText>& into, const char* admissible) {
    if (const auto* text = entry.value.as<std::string>()) {
      into = text_of(entry, *text);
    } else {
      wrong_type(entry.value, "sweep." + entry.key, admissible);
    }
  }

  /// texts_of_files() reads them.
  void check_files(const Node& node) {
    const Table* table = node.as<Table>();
    const bool valid =
        table != nullptr &&
        std::all_of(table->entries.begin(), table->entries.end(),
                    [](const Entry& one) { return one.value.as<std::string>() != nullptr; });
    if (valid) return;
    wrong_type(node, "sweep.files", "a table of names of files with their texts");
  }

  void report_unknown(const Entry& entry) {
    const std::vector<std::string> keys = sweep_layout().keys();
    const std::string name = "sweep." + key_text(shortened(entry.key, kLongestShownValue));
    faults_.emplace_back(FaultCode::scene_unknown_key, source_.location(entry.where), name, "",
                         "unknown key", listed(keys), nearest_name(entry.key, keys).value_or(""));
  }

  /// Names with dots may be keys in quotes, or tables in one another.
  void read_over(const Node& node, const std::string& above) {
    const Table* table = node.as<Table>();
    if (table == nullptr) {
      return wrong_type(node, "sweep.over", "a table of names with their values");
    }
    for (const Entry& entry : table->entries) {
      const std::string name = above + entry.key;
      if (entry.value.as<Table>() != nullptr) {
        read_over(entry.value, name + ".");
      } else if (auto values = values_of(entry.value, "sweep.over." + name)) {
        settings_.over.push_back({name, *std::move(values), source_.location(entry.value.where),
                                  source_.written(entry.value.where)});
      } else {
        settings_.unread.push_back(name);
      }
    }
  }

  std::optional<SweepValues> values_of(const Node& node, const std::string& key) {
    constexpr const char* kForms = "\"from:to:count\", \"from:to:count:log\" or a list of values";
    if (const auto* list = node.as<List>()) {
      if (list->empty()) {
        complain(node, FaultCode::scene_wrong_count, key, "no values", kForms);
        return std::nullopt;
      }
      std::vector<std::string> texts;
      texts.reserve(list->size());
      for (const Node& value : *list) {
        // An expression stands in quotes here, and means the same without.
        const auto* text = value.as<std::string>();
        const bool plain = text != nullptr && parse_setting(*text, 0).as<std::string>() != nullptr;
        texts.push_back(plain ? *text : value_text(value));
      }
      return SweepValues::listed(std::move(texts));
    }
    const auto* text = node.as<std::string>();
    if (text == nullptr) {
      wrong_type(node, key, kForms);
      return std::nullopt;
    }
    auto read = SweepValues::parse(*text);
    if (auto* values = std::get_if<SweepValues>(&read)) return std::move(*values);
    Wrong& wrong = std::get<Wrong>(read);
    complain(node, FaultCode::scene_wrong_type, key, std::move(wrong.why),
             wrong.admissible == kAxisForms ? kForms : std::move(wrong.admissible));
    return std::nullopt;
  }

  std::vector<std::string> words(const Node& node, const std::string& key) {
    std::vector<std::string> result;
    const auto* list = node.as<List>();
    const bool valid =
        list != nullptr && std::all_of(list->begin(), list->end(), [](const Node& one) {
          return one.as<std::string>() != nullptr;
        });
    if (!valid) {
      wrong_type(node, key, "a list of names");
      return result;
    }
    for (const Node& one : *list) result.push_back(*one.as<std::string>());
    return result;
  }

  void read_zips(const Node& node) {
    const auto* list = node.as<List>();
    const bool nested = list != nullptr && !list->empty() && list->front().as<List>() != nullptr;
    if (!nested) {
      settings_.zips.push_back({words(node, "sweep.zip"), source_.location(node.where)});
      return;
    }
    for (const Node& one : *list) {
      settings_.zips.push_back({words(one, "sweep.zip"), source_.location(one.where)});
    }
  }

  const Source& source_;
  std::vector<Fault>& faults_;
  SweepSettings settings_;
};

}  // namespace

std::optional<SweepSettings> sweep_settings(const Table& document, const Source& source,
                                            std::vector<Fault>& faults) {
  const Node* node = document.find("sweep");
  if (node == nullptr) return std::nullopt;
  return SweepReader(source, faults).read(*node);
}

std::map<std::string, std::string> texts_of_files(const Table& document) {
  std::map<std::string, std::string> texts;
  const Node* sweep = document.find("sweep");
  const Table* table = sweep != nullptr ? sweep->as<Table>() : nullptr;
  const Node* files = table != nullptr ? table->find("files") : nullptr;
  table = files != nullptr ? files->as<Table>() : nullptr;
  if (table == nullptr) return texts;
  for (const Entry& entry : table->entries) {
    if (const auto* text = entry.value.as<std::string>()) texts.emplace(entry.key, *text);
  }
  return texts;
}

void check_sweep(const Table& document, const Source& source, FaultList& faults) {
  std::vector<Fault> found;
  const auto settings = sweep_settings(document, source, found);
  if (!settings) return;
  sweep_refinement(*settings, sweep_dimensions(*settings, found), found);
  for (const SweepAxis& axis : settings->over) {
    const std::vector<Setting> setting = {{axis.name, axis.values.text(0)}};
    const Source of_setting("", "", setting);
    FaultList of_name(of_setting);
    Table changed = document;
    try {
      apply_settings(setting, changed, of_name);
      of_name.throw_if_any();
    } catch (const InputError& error) {
      for (Fault fault : error.faults()) {
        fault.location = axis.location;
        fault.value = axis.shown;
        found.push_back(std::move(fault));
      }
    }
  }
  for (Fault& fault : found) faults.take(std::move(fault));
}

}  // namespace tomlin
