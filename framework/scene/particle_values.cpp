// Values with one for each particle of a body: lists, and expressions in the particle's index.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

/// An expression, evaluated for one particle after the other.
class ParticleExpression {
 public:
  ParticleExpression(BoundExpression bound, const ParameterTable& parameters, std::int64_t count)
      : bound_(std::move(bound)), parameters_(parameters), count_(static_cast<double>(count)) {}

  std::variant<double, ExpressionError> at(std::size_t particle) const {
    return bound_.expression.evaluate([&](std::string_view name) -> std::optional<double> {
      if (const auto known = parameters_.value(name)) return known;
      return name == "i" ? static_cast<double>(particle) : count_;
    });
  }

 private:
  BoundExpression bound_;
  const ParameterTable& parameters_;
  double count_;
};

}  // namespace

bool ValueReader::names_particles(const Node& node) const {
  if (const auto* list = node.as<List>()) {
    return std::any_of(list->begin(), list->end(),
                       [this](const Node& element) { return names_particles(element); });
  }
  const auto* text = node.as<std::string>();
  if (text == nullptr) return false;
  const auto parsed = Expression::parse(*text);
  const auto* expression = std::get_if<Expression>(&parsed);
  if (expression == nullptr) return false;
  const auto& names = expression->names();
  const auto variables = particle_variables();
  return std::any_of(names.begin(), names.end(), [&](const Expression::Name& used) {
    return std::find(variables.begin(), variables.end(), used.name) != variables.end() &&
           !parameters_.contains(used.name);
  });
}

bool ValueReader::is_for_each(const Parameter& row, const Node& node) const {
  const auto* list = node.as<List>();
  if (list != nullptr && std::holds_alternative<double>(row.prototype)) return true;
  if (list != nullptr && std::holds_alternative<SpaceVector>(row.prototype) && !list->empty() &&
      list->front().as<List>() != nullptr) {
    return true;
  }
  return names_particles(node);
}

std::optional<ParameterValue> ValueReader::read_for_each(const Parameter& row, const Node& node,
                                                         const std::string& key,
                                                         std::int64_t count) const {
  const Subject subject{row, key};
  const bool is_number = std::holds_alternative<double>(row.prototype) ||
                         std::holds_alternative<PerParticle>(row.prototype);
  const auto read = [&](auto value) -> std::optional<ParameterValue> {
    if (!read_for_each(value.values, subject, node, count)) return std::nullopt;
    return value;
  };
  return is_number ? read(PerParticle{}) : read(PerParticleVector{});
}

bool ValueReader::has_count(const List& list, const Subject& subject, const Node& node,
                            std::int64_t count) const {
  if (list.size() == static_cast<std::size_t>(count)) return true;
  return wrong(FaultCode::scene_wrong_count, subject, node,
               fmt::format("{} entr{}, but the body has {} particle{}", list.size(),
                           list.size() == 1 ? "y" : "ies", count, count == 1 ? "" : "s"));
}

bool ValueReader::read_for_each(std::vector<double>& values, const Subject& subject,
                                const Node& node, std::int64_t count) const {
  const auto* list = node.as<List>();
  const auto size = static_cast<std::size_t>(count);
  if (list != nullptr && !has_count(*list, subject, node, count)) return false;
  values.clear();
  values.reserve(size);
  std::optional<ParticleExpression> expression;
  for (std::size_t i = 0; i < size; ++i) {
    const Node& element = list ? (*list)[i] : node;
    const auto* text = element.as<std::string>();
    if (text == nullptr) {
      if (!read_into(values.emplace_back(), subject, element)) return false;
      continue;
    }
    const auto report = [&](const ExpressionError& error, const std::string& where) {
      if (!error.consequence) {
        faults_.inside(element, error.column,
                       {error.code, subject.key, error.why + where, "", error.nearest});
      }
      return false;
    };
    if (list || !expression) {
      auto bound = parameters_.bind(*text, particle_variables());
      if (const auto* error = std::get_if<ExpressionError>(&bound)) return report(*error, "");
      expression.emplace(std::get<BoundExpression>(std::move(bound)), parameters_, count);
    }
    const auto result = expression->at(i);
    const std::string where = fmt::format(", for particle {}", i);
    if (const auto* error = std::get_if<ExpressionError>(&result)) return report(*error, where);
    const double x = std::get<double>(result);
    if (!subject.row.interval.contains(x)) {
      return wrong(FaultCode::scene_out_of_range, subject, element,
                   fmt::format("is {}, out of range{}", x, where));
    }
    values.push_back(x);
  }
  return true;
}

bool ValueReader::read_for_each(std::vector<SpaceVector>& values, const Subject& subject,
                                const Node& node, std::int64_t count) const {
  const List* list = filled_list(subject, node);
  if (list == nullptr) return false;
  values.assign(static_cast<std::size_t>(count), {});
  if (list->front().as<List>() == nullptr) {
    // One vector of expressions: component by component for all particles.
    for (const Node& component : *list) {
      if (component.as<List>()) return wrong_kind(subject, component);
      std::vector<double> numbers;
      if (!read_for_each(numbers, subject, component, count)) return false;
      for (std::size_t i = 0; i < values.size(); ++i) values[i].components.push_back(numbers[i]);
    }
    return true;
  }
  if (!has_count(*list, subject, node, count)) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!read_into(values[i], subject, (*list)[i])) return false;
    if (values[i].components.size() == values.front().components.size()) continue;
    return wrong(FaultCode::scene_wrong_count, subject, (*list)[i],
                 fmt::format("vector {} has {} components, the first has {}", i,
                             values[i].components.size(), values.front().components.size()));
  }
  return true;
}

}  // namespace tomlin
