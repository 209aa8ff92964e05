#include "framework/scene/value_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/core/text/xyz_file.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/passing.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostDimensions = 3;
constexpr double kIntegersEnd = 9223372036854775808.0;  // 2^63

/// The words of a kind of value, unless its row narrows them.
template <Worded Kind>
std::vector<std::string> allowed_words(const Parameter& row) {
  return row.choices.empty() ? words_of<Kind>() : row.choices;
}

std::string with_range(const char* what, const Interval& interval) {
  const bool anything = !std::isfinite(interval.low) && !std::isfinite(interval.high);
  return anything ? std::string(what) : std::string(what) + " " + interval.to_string();
}

std::string joined_with_or(const std::vector<std::string>& alternatives) {
  std::string result;
  for (std::size_t i = 0; i < alternatives.size(); ++i) {
    if (i > 0) result += i + 1 == alternatives.size() ? " or " : ", ";
    result += alternatives[i];
  }
  return result;
}

}  // namespace

std::string admissible_values(const Parameter& row) {
  std::string a_number = with_range("a number", row.interval);
  return std::visit(
      [&](const auto& prototype) -> std::string {
        using Kind = std::decay_t<decltype(prototype)>;
        if constexpr (std::is_same_v<Kind, double>) {
          return row.per_particle ? a_number + ", or a list of one per particle" : a_number;
        } else if constexpr (std::is_same_v<Kind, std::int64_t>) {
          return with_range("an integer", row.interval);
        } else if constexpr (std::is_same_v<Kind, bool>) {
          return "true or false";
        } else if constexpr (std::is_same_v<Kind, std::string>) {
          return row.choices.empty() ? "text" : joined_with_or(in_quotes(row.choices));
        } else if constexpr (std::is_same_v<Kind, SpaceVector>) {
          return "a list with " + a_number + " per dimension" +
                 (row.per_particle ? ", or a list of such lists" : "");
        } else if constexpr (std::is_same_v<Kind, PerParticle>) {
          return a_number + ", or a list of one per particle";
        } else if constexpr (std::is_same_v<Kind, PerParticleVector>) {
          return "a list with " + a_number + " per dimension, or a list of such lists";
        } else if constexpr (std::is_same_v<Kind, PairSelection>) {
          auto ways = in_quotes(allowed_words<PairSelection::Kind>(row));
          ways.emplace_back("a list of index pairs");
          return joined_with_or(ways);
        } else if constexpr (std::is_same_v<Kind, WordOrNumbers>) {
          auto ways = in_quotes(row.choices);
          ways.push_back(a_number);
          ways.emplace_back("a list of such");
          return joined_with_or(ways);
        } else if constexpr (std::is_same_v<Kind, Attachment>) {
          auto ways = in_quotes(allowed_words<Attachment::Kind>(row));
          ways.emplace_back("{ particle = INDEX }");
          return joined_with_or(ways);
        } else if constexpr (std::is_same_v<Kind, PointList>) {
          return "a list of points, each a list with " + a_number + " per dimension";
        } else if constexpr (std::is_same_v<Kind, NumberTable>) {
          return "a list of " + a_number + ", or of rows of such";
        } else if constexpr (std::is_same_v<Kind, WordList>) {
          return row.choices.empty() ? "a list of names"
                                     : "a list of " + joined_with_or(in_quotes(row.choices));
        } else if constexpr (std::is_same_v<Kind, FlagList>) {
          return "a list with true or false per dimension";
        } else if constexpr (std::is_same_v<Kind, Formula>) {
          return "a formula over the force's variables and the parameters";
        } else if constexpr (std::is_same_v<Kind, FormulaList>) {
          return "a list with a formula per dimension";
        } else if constexpr (std::is_same_v<Kind, AngleSelection>) {
          return "\"neighbours\" or a list of triples of indices";
        } else if constexpr (std::is_same_v<Kind, NamePerParticle>) {
          return "a name, or a list of one per particle: letters, digits, _, -, + and "
                 "parentheses, the first a letter or _";
        } else {
          static_assert(std::is_same_v<Kind, Passing>);
          return "{ when = OBSERVABLE, above = VALUE } or below, and times";
        }
      },
      row.prototype);
}

std::vector<std::string> expected_words(const Parameter& row) {
  if (std::holds_alternative<PairSelection>(row.prototype))
    return allowed_words<PairSelection::Kind>(row);
  if (std::holds_alternative<Attachment>(row.prototype))
    return allowed_words<Attachment::Kind>(row);
  return row.choices;
}

std::optional<ParameterValue> ValueReader::read(const Parameter& row, const Node& node,
                                                const std::string& key) const {
  const Subject subject{row, key};
  return std::visit(
      [&](auto value) -> std::optional<ParameterValue> {
        if (!read_into(value, subject, node)) return std::nullopt;
        return value;
      },
      row.prototype);
}

std::optional<double> ValueReader::number(const Subject& subject, const Node& node) const {
  const auto x = evaluated(subject, node);
  if (!x || !in_range(subject, node, *x)) return std::nullopt;
  return x;
}

bool ValueReader::read_into(double& value, const Subject& subject, const Node& node) const {
  const auto x = number(subject, node);
  if (x) value = *x;
  return x.has_value();
}

bool ValueReader::read_into(std::int64_t& value, const Subject& subject, const Node& node) const {
  const auto n = index(subject, node);
  if (!n || !in_range(subject, node, static_cast<double>(*n))) return false;
  value = *n;
  return true;
}

bool ValueReader::read_into(bool& value, const Subject& subject, const Node& node) const {
  const bool* given = node.as<bool>();
  if (given == nullptr) return wrong_kind(subject, node);
  value = *given;
  return true;
}

// An integer that the row's interval does not speak of.
std::optional<std::int64_t> ValueReader::index(const Subject& subject, const Node& node) const {
  if (const auto* given = node.as<std::int64_t>()) return *given;
  const auto x = evaluated(subject, node);
  if (!x) return std::nullopt;
  const std::string is = node.as<std::string>() ? fmt::format("is {}; ", *x) : "";
  if (!std::isfinite(*x)) {
    wrong(FaultCode::scene_not_finite, subject, node, "not a finite number");
  } else if (*x != std::floor(*x)) {
    wrong(FaultCode::scene_out_of_range, subject, node, is + "not an integer");
  } else if (*x < -kIntegersEnd || *x >= kIntegersEnd) {
    wrong(FaultCode::scene_out_of_range, subject, node, is + "too large for an integer");
  } else {
    return static_cast<std::int64_t>(*x);
  }
  return std::nullopt;
}

const List* ValueReader::filled_list(const Subject& subject, const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) {
    wrong_kind(subject, node);
  } else if (list->empty()) {
    wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
    return nullptr;
  }
  return list;
}

bool ValueReader::read_into(std::vector<double>& values, const Subject& subject,
                            const Node& node) const {
  const List* list = filled_list(subject, node);
  if (list == nullptr) return false;
  values.clear();
  values.reserve(list->size());
  return std::all_of(list->begin(), list->end(), [&](const Node& element) {
    return read_into(values.emplace_back(), subject, element);
  });
}

bool ValueReader::read_into(std::string& value, const Subject& subject, const Node& node) const {
  const auto* given = node.as<std::string>();
  if (given == nullptr) return wrong_kind(subject, node);
  const auto& choices = subject.row.choices;
  if (!choices.empty() && !is_word(subject, node, *given, choices)) return false;
  value = *given;
  return true;
}

bool ValueReader::read_into(SpaceVector& value, const Subject& subject, const Node& node) const {
  if (!read_into(value.components, subject, node)) return false;
  if (value.components.size() <= kMostDimensions) return true;
  return wrong(FaultCode::scene_wrong_count, subject, node,
               fmt::format("{} components, but space has at most {} dimensions",
                           value.components.size(), kMostDimensions));
}

bool ValueReader::read_into(PerParticle& value, const Subject& subject, const Node& node) const {
  if (node.as<List>() != nullptr) return read_into(value.values, subject, node);
  value.values.resize(1);
  return read_into(value.values.front(), subject, node);
}

bool ValueReader::read_into(PerParticleVector& value, const Subject& subject,
                            const Node& node) const {
  value.values.clear();
  const auto* list = node.as<List>();
  const bool one_each = list != nullptr && !list->empty() && list->front().as<List>() != nullptr;
  if (!one_each) return read_into(value.values.emplace_back(), subject, node);
  return std::all_of(list->begin(), list->end(), [&](const Node& element) {
    return read_into(value.values.emplace_back(), subject, element);
  });
}

/// A list of lists of as many indices, called `name` in messages.
template <std::size_t N>
bool ValueReader::read_tuples(std::vector<std::array<std::int64_t, N>>& tuples, const char* name,
                              const Subject& subject, const Node& node) const {
  const List* list = filled_list(subject, node);
  if (list == nullptr) return false;
  for (const Node& element : *list) {
    const auto* given = element.as<List>();
    if (given == nullptr || given->size() != N) {
      return wrong(given == nullptr ? FaultCode::scene_wrong_type : FaultCode::scene_wrong_count,
                   subject, element, fmt::format("not a {} of indices", name));
    }
    auto& tuple = tuples.emplace_back();
    for (std::size_t k = 0; k < N; ++k) {
      const auto found = index(subject, (*given)[k]);
      if (!found) return false;
      tuple[k] = *found;
    }
  }
  return true;
}

bool ValueReader::read_into(PairSelection& value, const Subject& subject, const Node& node) const {
  value = {};
  if (const auto* word = node.as<std::string>()) {
    if (!is_word(subject, node, *word, expected_words(subject.row))) return false;
    value.kind = value_named<PairSelection::Kind>(*word).value();
    return true;
  }
  value.kind = PairSelection::Kind::list;
  return read_tuples(value.list, "pair", subject, node);
}

bool ValueReader::read_into(Formula& value, const Subject& subject, const Node& node) const {
  value = {};
  if (node.as<std::int64_t>() != nullptr || node.as<double>() != nullptr) {
    value.text = value_text(node);
    return number(subject, node).has_value();
  }
  const auto* text = node.as<std::string>();
  if (text == nullptr) return wrong_kind(subject, node);
  const auto variables = expression_variables();
  std::vector<std::string_view> names(variables.begin(), variables.end());
  for (const std::string_view name : particle_variables()) {
    if (!parameters_.contains(name)) names.push_back(name);  // a parameter comes first
  }
  auto bound = parameters_.bind(*text, names);
  if (const auto* error = std::get_if<ExpressionError>(&bound)) {
    if (!error->consequence) {
      faults_.inside(node, error->column,
                     {error->code, subject.key, error->why, "", error->nearest});
    }
    return false;
  }
  value.text = *text;
  value.parameters = std::get<BoundExpression>(std::move(bound)).parameters;
  return true;
}

bool ValueReader::read_into(FormulaList& value, const Subject& subject, const Node& node) const {
  value = {};
  const List* list = filled_list(subject, node);
  if (list == nullptr) return false;
  if (list->size() > kMostDimensions) {
    return wrong(FaultCode::scene_wrong_count, subject, node, "space has at most three dimensions");
  }
  bool valid = true;
  for (const Node& element : *list) {
    valid = read_into(value.components.emplace_back(), subject, element) && valid;
  }
  return valid;
}

bool ValueReader::read_into(AngleSelection& value, const Subject& subject, const Node& node) const {
  value = {};
  if (const auto* word = node.as<std::string>()) {
    return is_word(subject, node, *word, {"neighbours"});
  }
  value.neighbours = false;
  return read_tuples(value.list, "triple", subject, node);
}

bool ValueReader::read_into(NamePerParticle& value, const Subject& subject,
                            const Node& node) const {
  value = {};
  const auto read_name = [&](const Node& element) {
    const auto* name = element.as<std::string>();
    if (name == nullptr) return wrong_kind(subject, element);
    if (!is_species_name(*name)) {
      return wrong(FaultCode::scene_invalid_name, subject, element, "not a name of a species");
    }
    value.names.push_back(*name);
    return true;
  };
  if (node.as<List>() == nullptr) return read_name(node);
  const List* list = filled_list(subject, node);
  return list != nullptr && std::all_of(list->begin(), list->end(), read_name);
}

bool ValueReader::read_into(WordOrNumbers& value, const Subject& subject, const Node& node) const {
  value = {};
  if (node.as<List>() != nullptr) return read_into(value.numbers, subject, node);
  if (const auto* word = node.as<std::string>()) {
    const auto& choices = subject.row.choices;
    // A misspelt word would otherwise be called an unknown parameter.
    const bool meant_as_word =
        is_identifier(*word) && !parameters_.contains(*word) && nearest_name(*word, choices);
    if (meant_as_word || std::find(choices.begin(), choices.end(), *word) != choices.end()) {
      value.word = *word;
      return is_word(subject, node, *word, choices);
    }
  }
  return read_into(value.numbers.emplace_back(), subject, node);
}

bool ValueReader::read_into(Attachment& value, const Subject& subject, const Node& node) const {
  value = {};
  if (const auto* word = node.as<std::string>()) {
    if (!is_word(subject, node, *word, expected_words(subject.row))) return false;
    value.kind = value_named<Attachment::Kind>(*word).value();
    return true;
  }
  const auto* table = node.as<Table>();
  if (table == nullptr) return wrong_kind(subject, node);
  const Node* particle = table->find("particle");
  if (particle == nullptr || table->entries.size() != 1) {
    return wrong(
        table->entries.empty() ? FaultCode::scene_missing_key : FaultCode::scene_unknown_key,
        subject, node, "a table here has the key particle and no other");
  }
  const auto given = index({subject.row, subject.key + ".particle"}, *particle);
  if (!given) return false;
  value.kind = Attachment::Kind::particle;
  value.particle = *given;
  return true;
}

/// A column of numbers, or a list of rows of the same length.
template <class ReadRow, class NameRow>
bool ValueReader::read_rows(std::size_t& columns, std::vector<double>& all, const Subject& subject,
                            const Node& node, ReadRow&& read_row, NameRow&& name_row) const {
  columns = 0;
  all.clear();
  const auto* list = node.as<List>();
  if (list == nullptr || list->empty() || list->front().as<List>() == nullptr) {
    columns = 1;
    return read_into(all, subject, node);
  }
  for (const Node& element : *list) {
    std::vector<double> row;
    if (!read_row(element, row)) return false;
    if (columns == 0) columns = row.size();
    if (row.size() != columns) {
      return wrong(
          FaultCode::scene_wrong_count, subject, element,
          fmt::format("{}, the first has {}", name_row(all.size() / columns, row.size()), columns));
    }
    all.insert(all.end(), row.begin(), row.end());
  }
  return true;
}

bool ValueReader::read_into(PointList& value, const Subject& subject, const Node& node) const {
  const auto read_point = [&](const Node& element, std::vector<double>& coordinates) {
    SpaceVector point;
    if (!read_into(point, subject, element)) return false;
    coordinates = std::move(point.components);
    return true;
  };
  const auto name_of = [](std::size_t point, std::size_t size) {
    return fmt::format("point {} has {} coordinate{}", point, size, size == 1 ? "" : "s");
  };
  return read_rows(value.dimension, value.coordinates, subject, node, read_point, name_of);
}

bool ValueReader::read_into(NumberTable& value, const Subject& subject, const Node& node) const {
  const auto read_row = [&](const Node& element, std::vector<double>& row) {
    return read_into(row, subject, element);
  };
  const auto name_of = [](std::size_t row, std::size_t size) {
    return fmt::format("row {} has {} entr{}", row, size, size == 1 ? "y" : "ies");
  };
  return read_rows(value.columns, value.numbers, subject, node, read_row, name_of);
}

bool ValueReader::read_into(WordList& value, const Subject& subject, const Node& node) const {
  value = {};
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  std::set<std::string> seen;
  for (const Node& element : *list) {
    std::string& word = value.words.emplace_back();
    if (!read_into(word, subject, element)) return false;
    if (!seen.insert(word).second) {
      return wrong(FaultCode::scene_duplicate_key, subject, element, "is given twice");
    }
  }
  return true;
}

bool ValueReader::read_into(FlagList& value, const Subject& subject, const Node& node) const {
  value = {};
  const List* list = filled_list(subject, node);
  if (list == nullptr) return false;
  for (const Node& element : *list) {
    bool flag = false;
    if (!read_into(flag, subject, element)) return false;
    value.flags.push_back(flag);
  }
  return true;
}

bool ValueReader::read_into(Passing& value, const Subject& subject, const Node& node) const {
  const auto* table = node.as<Table>();
  if (table == nullptr) return wrong_kind(subject, node);
  value = {};
  bool counted = false;
  for (const Entry& entry : table->entries) {
    const std::string path = subject.key + "." + entry.key;
    const Subject inner{subject.row, path};
    if (entry.key == "when") {
      const auto* given = entry.value.as<std::string>();
      if (given == nullptr || given->empty()) return wrong_kind(inner, entry.value);
      value.when = *given;
    } else if (entry.key == "above" || entry.key == "below") {
      const auto x = number(inner, entry.value);
      if (!x) return false;
      (entry.key == "above" ? value.above : value.below) = *x;
    } else if (entry.key == "times") {
      const auto times = index(inner, entry.value);
      if (!times) return false;
      if (*times < 1) {
        return wrong(FaultCode::scene_out_of_range, inner, entry.value, "out of range: at least 1");
      }
      value.times = *times;
      counted = true;
    } else {
      return wrong(FaultCode::scene_unknown_key, subject, node,
                   "unknown key " + shortened(entry.key, kLongestShownValue));
    }
  }
  if (value.when.empty()) {
    return wrong(FaultCode::scene_missing_key, subject, node, "when is missing");
  }
  if (!value.above && !value.below) {
    return wrong(FaultCode::scene_missing_key, subject, node, "above or below is missing");
  }
  if (value.above && value.below && !(*value.below < *value.above)) {
    return wrong(FaultCode::scene_conflict, subject, node, "below is not less than above");
  }
  if (value.above && value.below && !counted) value.times = kWithoutEnd;
  return true;
}

// A number as it stands, or the value of an expression; not yet held against the interval.
std::optional<double> ValueReader::evaluated(const Subject& subject, const Node& node) const {
  if (const auto* given = node.as<std::int64_t>()) return static_cast<double>(*given);
  if (const auto* given = node.as<double>()) return *given;
  const auto* expression = node.as<std::string>();
  if (expression == nullptr) {
    wrong_kind(subject, node);
    return std::nullopt;
  }
  auto result = parameters_.evaluate(*expression, count_.value);
  if (const auto* error = std::get_if<ExpressionError>(&result)) {
    const bool of_particles =
        error->code == FaultCode::expression_unknown_name && names_particles(node);
    if (!error->consequence && !(of_particles && count_.hidden)) {
      faults_.inside(node, error->column,
                     {error->code, subject.key, error->why, of_particles ? keys_of_particles() : "",
                      error->nearest});
    }
    return std::nullopt;
  }
  return std::get<double>(result);
}

/// Names the keys in which an index of particles has a value, for messages.
std::string ValueReader::keys_of_particles() const {
  if (keys_of_particles_.empty() && !count_.value) return "";
  if (keys_of_particles_.empty())
    return "numbers and parameters: nothing here may differ between particles";
  return "an expression over i in " + joined_with_or(keys_of_particles_);
}

bool ValueReader::in_range(const Subject& subject, const Node& node, double x) const {
  if (subject.row.interval.contains(x)) return true;
  const bool finite = std::isfinite(x);
  const FaultCode code = finite ? FaultCode::scene_out_of_range : FaultCode::scene_not_finite;
  std::string why = finite ? "out of range" : "not a finite number";
  if (node.as<std::string>()) why = fmt::format("is {}, {}", x, why);
  faults_.of_value(node, {code, subject.key, std::move(why), subject.row.interval.to_string()});
  return false;
}

namespace {

/// A choice by another of its names; empty where there is none.
std::string other_name(std::string_view word, const std::vector<std::string>& words) {
  constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
      {"graphite", "honeycomb"}, {"graphene", "honeycomb"}, {"triangular", "hexagonal"}};
  for (const auto& [name, choice] : kOtherNames) {
    const auto found = std::find(words.begin(), words.end(), choice);
    if (name == word && found != words.end()) return *found;
  }
  return "";
}

}  // namespace

bool ValueReader::is_word(const Subject& subject, const Node& node, const std::string& word,
                          const std::vector<std::string>& words) const {
  if (std::find(words.begin(), words.end(), word) != words.end()) return true;
  // Whoever names a system of units has numbers in it, and consistent ones are taken as they are.
  if (subject.key == "scene.units") {
    faults_.of_value(node, {FaultCode::scene_unknown_choice, subject.key, "no such choice",
                            "\"reduced\", for SI and any other consistent units, too, or "
                            "\"metal\": eV, Angstrom, ps, u, K"});
    return false;
  }
  faults_.of_value(node, {FaultCode::scene_unknown_choice, subject.key, "no such choice",
                          admissible_values(subject.row),
                          nearest_name(word, words).value_or(other_name(word, words))});
  return false;
}

bool ValueReader::wrong_kind(const Subject& subject, const Node& node) const {
  faults_.of_wrong_type(node, subject.key, admissible_values(subject.row));
  return false;
}

bool ValueReader::wrong(FaultCode code, const Subject& subject, const Node& node,
                        std::string why) const {
  faults_.of_value(node, {code, subject.key, std::move(why), admissible_values(subject.row)});
  return false;
}

}  // namespace tomlin
