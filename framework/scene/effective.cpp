#include "framework/scene/effective.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/scene/passing.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

Node node(decltype(Node::value) value) { return {std::move(value), {}}; }

Node list_of(const std::vector<double>& numbers) {
  List list;
  for (const double x : numbers) list.push_back(node(x));
  return node(std::move(list));
}

// One for all stands as a number.
std::optional<Node> one_or_list(const std::vector<double>& numbers) {
  if (numbers.empty()) return std::nullopt;
  return numbers.size() == 1 ? node(numbers.front()) : list_of(numbers);
}

std::optional<Node> node_of(const SpaceVector& vector) {
  if (vector.components.empty()) return std::nullopt;
  return list_of(vector.components);
}

std::optional<Node> node_of(const PerParticle& numbers) { return one_or_list(numbers.values); }

std::optional<Node> node_of(const PerParticleVector& vectors) {
  if (vectors.values.empty()) return std::nullopt;
  if (vectors.values.size() == 1) return node_of(vectors.values.front());
  List list;
  for (const SpaceVector& vector : vectors.values) list.push_back(list_of(vector.components));
  return node(std::move(list));
}

std::optional<Node> node_of(const PairSelection& pairs) {
  if (const char* word = to_string(pairs.kind)) return node(word);
  List list;
  for (const auto& [first, second] : pairs.list) {
    list.push_back(node(List{node(first), node(second)}));
  }
  return node(std::move(list));
}

std::optional<Node> node_of(const WordOrNumbers& value) {
  if (!value.word.empty()) return node(value.word);
  return one_or_list(value.numbers);
}

std::optional<Node> node_of(const Attachment& attachment) {
  if (const char* word = to_string(attachment.kind)) return node(word);
  Table table;
  table.set("particle", node(attachment.particle));
  return node(std::move(table));
}

/// A list, or a list of rows where there are several columns.
std::optional<Node> rows_of(const std::vector<double>& numbers, std::size_t columns) {
  if (numbers.empty()) return std::nullopt;
  if (columns == 1) return list_of(numbers);
  List list;
  for (auto row = numbers.begin(); row != numbers.end();) {
    const auto next = row + static_cast<std::ptrdiff_t>(columns);
    list.push_back(list_of({row, next}));
    row = next;
  }
  return node(std::move(list));
}

std::optional<Node> node_of(const PointList& points) {
  return rows_of(points.coordinates, points.dimension);
}

std::optional<Node> node_of(const NumberTable& table) {
  return rows_of(table.numbers, table.columns);
}

std::optional<Node> node_of(const WordList& names) {
  if (names.words.empty()) return std::nullopt;
  List list;
  for (const std::string& word : names.words) list.push_back(node(word));
  return node(std::move(list));
}

std::optional<Node> node_of(const FlagList& switches) {
  if (switches.flags.empty()) return std::nullopt;
  List list;
  for (const bool flag : switches.flags) list.push_back(node(flag));
  return node(std::move(list));
}

std::optional<Node> node_of(const Passing& passing) {
  if (passing.when.empty()) return std::nullopt;
  Table table;
  table.set("when", node(passing.when));
  if (passing.above) table.set("above", node(*passing.above));
  if (passing.below) table.set("below", node(*passing.below));
  if (!alternates(passing)) table.set("times", node(passing.times));
  return node(std::move(table));
}

std::optional<Node> node_of(const Formula& formula) {
  if (formula.text.empty()) return std::nullopt;
  return node(formula.text);
}

std::optional<Node> node_of(const FormulaList& formulas) {
  if (formulas.components.empty()) return std::nullopt;
  List list;
  for (const Formula& formula : formulas.components) list.push_back(node(formula.text));
  return node(std::move(list));
}

std::optional<Node> node_of(const AngleSelection& angles) {
  if (angles.neighbours) return node("neighbours");
  List list;
  for (const auto& [first, middle, last] : angles.list) {
    list.push_back(node(List{node(first), node(middle), node(last)}));
  }
  return node(std::move(list));
}

std::optional<Node> node_of(const NamePerParticle& species) {
  if (species.names.empty()) return std::nullopt;
  if (species.names.size() == 1) return node(species.names.front());
  List list;
  for (const std::string& name : species.names) list.push_back(node(name));
  return node(std::move(list));
}

/// A number that is absent reads as NaN.
std::optional<Node> node_of(double number) {
  if (std::isnan(number)) return std::nullopt;
  return node(number);
}

// std::int64_t, bool and std::string stand for themselves.
template <class Plain>
std::optional<Node> node_of(const Plain& value) {
  return node(value);
}

/// With a point or an exponent, so that it reads back as a number and not as an integer.
std::string number_text(double x) {
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string list_text(const List& list) {
  std::string text;
  for (const Node& element : list) text += (text.empty() ? "" : ", ") + value_text(element);
  return "[" + text + "]";
}

std::string inline_table_text(const Table& table) {
  std::string text;
  for (const Entry& entry : table.entries) {
    text += (text.empty() ? " " : ", ") + key_text(entry.key) + " = " + value_text(entry.value);
  }
  return "{" + text + (text.empty() ? "}" : " }");
}

void append_table(std::string& text, const std::string& header, const Table& table) {
  if (!text.empty()) text += '\n';
  text += header + '\n';
  for (const Entry& entry : table.entries) {
    text += key_text(entry.key) + " = " + value_text(entry.value) + '\n';
  }
}

bool is_list_of_tables(const Node& node) {
  const auto* list = node.as<List>();
  return list && (list->empty() || list->front().as<Table>());
}

}  // namespace

std::optional<Node> to_node(const ParameterValue& value) {
  return std::visit([](const auto& given) { return node_of(given); }, value);
}

std::string value_text(const Node& value) {
  return std::visit(
      [](const auto& given) -> std::string {
        using Kind = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Kind, bool>) {
          return given ? "true" : "false";
        } else if constexpr (std::is_same_v<Kind, std::int64_t>) {
          return fmt::format("{}", given);
        } else if constexpr (std::is_same_v<Kind, double>) {
          return number_text(given);
        } else if constexpr (std::is_same_v<Kind, std::string>) {
          return quoted_text(given);
        } else if constexpr (std::is_same_v<Kind, List>) {
          return list_text(given);
        } else if constexpr (std::is_same_v<Kind, Table>) {
          return inline_table_text(given);
        } else {
          static_assert(std::is_same_v<Kind, Moment>);
          return "";  // no key of a scene takes one, so none is ever written
        }
      },
      value.value);
}

std::string to_toml(const Table& document) {
  std::string text;
  // Values outside of tables come first.
  for (const Entry& entry : document.entries) {
    if (entry.value.as<Table>() || is_list_of_tables(entry.value)) continue;
    text += key_text(entry.key) + " = " + value_text(entry.value) + '\n';
  }
  for (const Entry& entry : document.entries) {
    if (const auto* table = entry.value.as<Table>()) {
      append_table(text, "[" + entry.key + "]", *table);
    } else if (is_list_of_tables(entry.value)) {
      for (const Node& element : *entry.value.as<List>()) {
        append_table(text, "[[" + entry.key + "]]", *element.as<Table>());
      }
    }
  }
  return text;
}

}  // namespace tomlin
