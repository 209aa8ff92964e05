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
      [&](const auto& prototype) -> std::optional<ParameterValue> {
        using Kind = std::decay_t<decltype(prototype)>;
        if constexpr (std::is_same_v<Kind, double>) {
          return number(subject, node);
        } else if constexpr (std::is_same_v<Kind, std::int64_t>) {
          return integer(subject, node);
        } else if constexpr (std::is_same_v<Kind, bool>) {
          if (const bool* given = node.as<bool>()) return *given;
          return wrong_kind(subject, node);
        } else if constexpr (std::is_same_v<Kind, std::string>) {
          return text(subject, node);
        } else if constexpr (std::is_same_v<Kind, SpaceVector>) {
          return space_vector(subject, node);
        } else if constexpr (std::is_same_v<Kind, PerParticle>) {
          return per_particle(subject, node);
        } else if constexpr (std::is_same_v<Kind, PerParticleVector>) {
          return per_particle_vector(subject, node);
        } else if constexpr (std::is_same_v<Kind, PairSelection>) {
          return pair_selection(subject, node);
        } else if constexpr (std::is_same_v<Kind, WordOrNumbers>) {
          return word_or_numbers(subject, node);
        } else if constexpr (std::is_same_v<Kind, Attachment>) {
          return attachment(subject, node);
        } else if constexpr (std::is_same_v<Kind, PointList>) {
          return point_list(subject, node);
        } else if constexpr (std::is_same_v<Kind, NumberTable>) {
          return number_table(subject, node);
        } else if constexpr (std::is_same_v<Kind, WordList>) {
          return word_list(subject, node);
        } else if constexpr (std::is_same_v<Kind, FlagList>) {
          return flag_list(subject, node);
        } else if constexpr (std::is_same_v<Kind, Formula>) {
          return formula(subject, node);
        } else if constexpr (std::is_same_v<Kind, FormulaList>) {
          return formula_list(subject, node);
        } else if constexpr (std::is_same_v<Kind, AngleSelection>) {
          return angle_selection(subject, node);
        } else if constexpr (std::is_same_v<Kind, NamePerParticle>) {
          return names_of_particles(subject, node);
        } else {
          static_assert(std::is_same_v<Kind, Passing>);
          return passing(subject, node);
        }
      },
      subject.row.prototype);
}

std::optional<double> ValueReader::number(const Subject& subject, const Node& node) const {
  const auto x = evaluated(subject, node);
  if (!x || !in_range(subject, node, *x)) return std::nullopt;
  return x;
}

std::optional<std::int64_t> ValueReader::integer(const Subject& subject, const Node& node) const {
  const auto n = index(subject, node);
  if (!n || !in_range(subject, node, static_cast<double>(*n))) return std::nullopt;
  return n;
}

// An integer that the row's interval does not speak of.
std::optional<std::int64_t> ValueReader::index(const Subject& subject, const Node& node) const {
  if (const auto* given = node.as<std::int64_t>()) return *given;
  const auto x = evaluated(subject, node);
  if (!x) return std::nullopt;
  const std::string is = node.as<std::string>() ? fmt::format("is {}; ", *x) : "";
  if (!std::isfinite(*x)) {
    return wrong(FaultCode::scene_not_finite, subject, node, "not a finite number");
  }
  if (*x != std::floor(*x)) {
    return wrong(FaultCode::scene_out_of_range, subject, node, is + "not an integer");
  }
  if (*x < -kIntegersEnd || *x >= kIntegersEnd) {
    return wrong(FaultCode::scene_out_of_range, subject, node, is + "too large for an integer");
  }
  return static_cast<std::int64_t>(*x);
}

std::optional<std::vector<double>> ValueReader::numbers(const Subject& subject, const List& list,
                                                        const Node& whole) const {
  if (list.empty()) return wrong(FaultCode::scene_wrong_count, subject, whole, "the list is empty");
  std::vector<double> result;
  result.reserve(list.size());
  for (const Node& element : list) {
    const auto x = number(subject, element);
    if (!x) return std::nullopt;
    result.push_back(*x);
  }
  return result;
}

std::optional<std::string> ValueReader::text(const Subject& subject, const Node& node) const {
  const auto* given = node.as<std::string>();
  if (given == nullptr) return wrong_kind(subject, node);
  const auto& choices = subject.row.choices;
  if (!choices.empty() && !is_word(subject, node, *given, choices)) return std::nullopt;
  return *given;
}

std::optional<SpaceVector> ValueReader::space_vector(const Subject& subject,
                                                     const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  auto components = numbers(subject, *list, node);
  if (!components) return std::nullopt;
  if (components->size() > kMostDimensions) {
    return wrong(FaultCode::scene_wrong_count, subject, node,
                 fmt::format("{} components, but space has at most {} dimensions",
                             components->size(), kMostDimensions));
  }
  return SpaceVector{*std::move(components)};
}

std::optional<PerParticle> ValueReader::per_particle(const Subject& subject,
                                                     const Node& node) const {
  if (const auto* list = node.as<List>()) {
    auto values = numbers(subject, *list, node);
    if (!values) return std::nullopt;
    return PerParticle{*std::move(values)};
  }
  const auto x = number(subject, node);
  if (!x) return std::nullopt;
  return PerParticle{{*x}};
}

std::optional<PerParticleVector> ValueReader::per_particle_vector(const Subject& subject,
                                                                  const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  PerParticleVector result;
  const bool one_each = !list->empty() && list->front().as<List>();
  if (one_each) {
    for (const Node& element : *list) {
      auto vector = space_vector(subject, element);
      if (!vector) return std::nullopt;
      result.values.push_back(*std::move(vector));
    }
  } else {
    auto vector = space_vector(subject, node);
    if (!vector) return std::nullopt;
    result.values.push_back(*std::move(vector));
  }
  return result;
}

std::optional<PairSelection> ValueReader::pair_selection(const Subject& subject,
                                                         const Node& node) const {
  PairSelection result;
  if (const auto* word = node.as<std::string>()) {
    if (!is_word(subject, node, *word, expected_words(subject.row))) return std::nullopt;
    result.kind = value_named<PairSelection::Kind>(*word).value();
    return result;
  }
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  if (list->empty()) return wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
  result.kind = PairSelection::Kind::list;
  for (const Node& element : *list) {
    const auto* pair = element.as<List>();
    if (pair == nullptr || pair->size() != 2) {
      return wrong(pair == nullptr ? FaultCode::scene_wrong_type : FaultCode::scene_wrong_count,
                   subject, element, "not a pair of indices");
    }
    const auto first = index(subject, pair->front());
    if (!first) return std::nullopt;
    const auto second = index(subject, pair->back());
    if (!second) return std::nullopt;
    result.list.push_back({*first, *second});
  }
  return result;
}

std::optional<Formula> ValueReader::formula(const Subject& subject, const Node& node) const {
  Formula result;
  if (node.as<std::int64_t>() != nullptr || node.as<double>() != nullptr) {
    const auto x = evaluated(subject, node);
    if (!x || !in_range(subject, node, *x)) return std::nullopt;
    result.text = value_text(node);
    return result;
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
    return std::nullopt;
  }
  result.text = *text;
  result.parameters = std::get<BoundExpression>(std::move(bound)).parameters;
  return result;
}

std::optional<FormulaList> ValueReader::formula_list(const Subject& subject,
                                                     const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  if (list->empty()) return wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
  if (list->size() > kMostDimensions) {
    return wrong(FaultCode::scene_wrong_count, subject, node, "space has at most three dimensions");
  }
  FormulaList result;
  bool valid = true;
  for (const Node& element : *list) {
    auto component = formula(subject, element);
    valid = valid && component;
    if (component) result.components.push_back(*std::move(component));
  }
  if (!valid) return std::nullopt;
  return result;
}

std::optional<AngleSelection> ValueReader::angle_selection(const Subject& subject,
                                                           const Node& node) const {
  AngleSelection result;
  if (const auto* word = node.as<std::string>()) {
    if (!is_word(subject, node, *word, {"neighbours"})) return std::nullopt;
    return result;
  }
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  if (list->empty()) return wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
  result.neighbours = false;
  for (const Node& element : *list) {
    const auto* triple = element.as<List>();
    if (triple == nullptr || triple->size() != 3) {
      return wrong(triple == nullptr ? FaultCode::scene_wrong_type : FaultCode::scene_wrong_count,
                   subject, element, "not a triple of indices");
    }
    std::array<std::int64_t, 3> indices{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = index(subject, (*triple)[k]);
      if (!found) return std::nullopt;
      indices[k] = *found;
    }
    result.list.push_back(indices);
  }
  return result;
}

std::optional<NamePerParticle> ValueReader::names_of_particles(const Subject& subject,
                                                               const Node& node) const {
  NamePerParticle result;
  const auto take = [&](const Node& element) {
    const auto* name = element.as<std::string>();
    if (name == nullptr) {
      wrong_kind(subject, element);
    } else if (!is_species_name(*name)) {
      wrong(FaultCode::scene_invalid_name, subject, element, "not a name of a species");
    } else {
      result.names.push_back(*name);
      return true;
    }
    return false;
  };
  const auto* list = node.as<List>();
  if (list == nullptr) return take(node) ? std::optional(result) : std::nullopt;
  if (list->empty()) return wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
  if (!std::all_of(list->begin(), list->end(), take)) return std::nullopt;
  return result;
}

std::optional<WordOrNumbers> ValueReader::word_or_numbers(const Subject& subject,
                                                          const Node& node) const {
  WordOrNumbers result;
  if (const auto* list = node.as<List>()) {
    auto values = numbers(subject, *list, node);
    if (!values) return std::nullopt;
    result.numbers = *std::move(values);
    return result;
  }
  if (const auto* word = node.as<std::string>()) {
    const auto& choices = subject.row.choices;
    const auto holds = [&word](const auto& words) {
      return std::find(words.begin(), words.end(), *word) != words.end();
    };
    // A misspelt word would otherwise be called an unknown parameter.
    const bool meant_as_word =
        is_identifier(*word) && !parameters_.contains(*word) && nearest_name(*word, choices);
    if (holds(choices) || meant_as_word) {
      if (!is_word(subject, node, *word, choices)) return std::nullopt;
      result.word = *word;
      return result;
    }
  }
  const auto x = number(subject, node);
  if (!x) return std::nullopt;
  result.numbers = {*x};
  return result;
}

std::optional<Attachment> ValueReader::attachment(const Subject& subject, const Node& node) const {
  Attachment result;
  if (const auto* word = node.as<std::string>()) {
    if (!is_word(subject, node, *word, expected_words(subject.row))) {
      return std::nullopt;
    }
    result.kind = value_named<Attachment::Kind>(*word).value();
    return result;
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
  if (!given) return std::nullopt;
  result.kind = Attachment::Kind::particle;
  result.particle = *given;
  return result;
}

std::optional<PointList> ValueReader::point_list(const Subject& subject, const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  PointList result;
  if (list->empty() || list->front().as<List>() == nullptr) {
    auto coordinates = numbers(subject, *list, node);
    if (!coordinates) return std::nullopt;
    return PointList{1, *std::move(coordinates)};
  }
  for (const Node& element : *list) {
    const auto point = space_vector(subject, element);
    if (!point) return std::nullopt;
    const std::size_t dimension = point->components.size();
    if (result.dimension == 0) result.dimension = dimension;
    if (dimension != result.dimension) {
      return wrong(FaultCode::scene_wrong_count, subject, element,
                   fmt::format("point {} has {} coordinate{}, the first has {}", result.count(),
                               dimension, dimension == 1 ? "" : "s", result.dimension));
    }
    result.coordinates.insert(result.coordinates.end(), point->components.begin(),
                              point->components.end());
  }
  return result;
}

std::optional<NumberTable> ValueReader::number_table(const Subject& subject,
                                                     const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  NumberTable result;
  if (list->empty() || list->front().as<List>() == nullptr) {
    auto column = numbers(subject, *list, node);
    if (!column) return std::nullopt;
    return NumberTable{1, *std::move(column)};
  }
  for (const Node& element : *list) {
    const auto* row = element.as<List>();
    if (row == nullptr) return wrong_kind(subject, element);
    const auto entries = numbers(subject, *row, element);
    if (!entries) return std::nullopt;
    if (result.columns == 0) result.columns = entries->size();
    if (entries->size() != result.columns) {
      return wrong(
          FaultCode::scene_wrong_count, subject, element,
          fmt::format("row {} has {} entr{}, the first has {}", result.rows(), entries->size(),
                      entries->size() == 1 ? "y" : "ies", result.columns));
    }
    result.numbers.insert(result.numbers.end(), entries->begin(), entries->end());
  }
  return result;
}

std::optional<WordList> ValueReader::word_list(const Subject& subject, const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  WordList result;
  std::set<std::string> seen;
  for (const Node& element : *list) {
    auto word = text(subject, element);
    if (!word) return std::nullopt;
    if (!seen.insert(*word).second) {
      return wrong(FaultCode::scene_duplicate_key, subject, element, "is given twice");
    }
    result.words.push_back(*std::move(word));
  }
  return result;
}

std::optional<FlagList> ValueReader::flag_list(const Subject& subject, const Node& node) const {
  const auto* list = node.as<List>();
  if (list == nullptr) return wrong_kind(subject, node);
  if (list->empty()) return wrong(FaultCode::scene_wrong_count, subject, node, "the list is empty");
  FlagList result;
  for (const Node& element : *list) {
    const bool* flag = element.as<bool>();
    if (flag == nullptr) return wrong_kind(subject, element);
    result.flags.push_back(*flag);
  }
  return result;
}

std::optional<Passing> ValueReader::passing(const Subject& subject, const Node& node) const {
  const auto* table = node.as<Table>();
  if (table == nullptr) return wrong_kind(subject, node);
  Passing result;
  bool counted = false;
  for (const Entry& entry : table->entries) {
    const std::string path = subject.key + "." + entry.key;
    const Subject inner{subject.row, path};
    if (entry.key == "when") {
      const auto* given = entry.value.as<std::string>();
      if (given == nullptr || given->empty()) return wrong_kind(inner, entry.value);
      result.when = *given;
    } else if (entry.key == "above" || entry.key == "below") {
      const auto x = number(inner, entry.value);
      if (!x) return std::nullopt;
      (entry.key == "above" ? result.above : result.below) = *x;
    } else if (entry.key == "times") {
      const auto times = index(inner, entry.value);
      if (!times) return std::nullopt;
      if (*times < 1) {
        return wrong(FaultCode::scene_out_of_range, inner, entry.value, "out of range: at least 1");
      }
      result.times = *times;
      counted = true;
    } else {
      return wrong(FaultCode::scene_unknown_key, subject, node,
                   "unknown key " + shortened(entry.key, kLongestShownValue));
    }
  }
  if (result.when.empty()) {
    return wrong(FaultCode::scene_missing_key, subject, node, "when is missing");
  }
  if (!result.above && !result.below) {
    return wrong(FaultCode::scene_missing_key, subject, node, "above or below is missing");
  }
  if (result.above && result.below && !(*result.below < *result.above)) {
    return wrong(FaultCode::scene_conflict, subject, node, "below is not less than above");
  }
  if (result.above && result.below && !counted) result.times = kWithoutEnd;
  return result;
}

// A number as it stands, or the value of an expression; not yet held against the interval.
std::optional<double> ValueReader::evaluated(const Subject& subject, const Node& node) const {
  if (const auto* given = node.as<std::int64_t>()) return static_cast<double>(*given);
  if (const auto* given = node.as<double>()) return *given;
  const auto* expression = node.as<std::string>();
  if (expression == nullptr) return wrong_kind(subject, node);
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

std::nullopt_t ValueReader::wrong_kind(const Subject& subject, const Node& node) const {
  faults_.of_value(node, {FaultCode::scene_wrong_type, subject.key, "found " + kind_of(node),
                          admissible_values(subject.row)});
  return std::nullopt;
}

std::nullopt_t ValueReader::wrong(FaultCode code, const Subject& subject, const Node& node,
                                  std::string why) const {
  faults_.of_value(node, {code, subject.key, std::move(why), admissible_values(subject.row)});
  return std::nullopt;
}

}  // namespace tomlin
