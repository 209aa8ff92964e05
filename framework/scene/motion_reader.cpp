#include "framework/scene/motion_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/table_reader.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostDimensions = 3;
constexpr std::string_view kVariable = "t";
constexpr const char* kExpectedNumber = "a number or an expression in t";
constexpr const char* kExpectedVelocity =
    "a list with a number or an expression in t per dimension";

TableLayout motion_layout() {
  TableLayout layout;
  layout.own_keys = {{"velocity", "of the centre of mass"},
                     {"angular_velocity", "rad/time, counter-clockwise"}};
  return layout;
}

TimeFunction constant_function(double value, std::string text) {
  TimeFunction function;
  function.constant = value;
  function.text = std::move(text);
  return function;
}

/// Motions are evaluated as time goes on, and random numbers belong to particles.
std::optional<ExpressionError> random_in_motion(const Expression& expression) {
  const Expression::Node* call = expression.random_call();
  if (call == nullptr) return std::nullopt;
  return ExpressionError{.column = call->column,
                         .why = "a motion draws no random numbers: give one a name in [parameters]",
                         .code = FaultCode::expression_unknown_name};
}

class MotionReader {
 public:
  MotionReader(const ParameterTable& parameters, FaultList& faults)
      : parameters_(parameters), faults_(faults) {}

  std::optional<std::vector<TimeFunction>> vector(const Node& node, const std::string& key) {
    const auto* list = node.as<List>();
    if (list == nullptr) {
      faults_.of_wrong_type(node, key, kExpectedVelocity);
      return std::nullopt;
    }
    std::vector<TimeFunction> result;
    for (const Node& element : *list) {
      if (auto component = number(element, key)) result.push_back(*std::move(component));
    }
    if (result.size() < list->size()) return std::nullopt;
    if (!result.empty() && result.size() <= kMostDimensions) return result;
    faults_.of_value(node,
                     {FaultCode::scene_wrong_count, key,
                      result.empty() ? "the list is empty" : "space has at most three dimensions",
                      kExpectedVelocity});
    return std::nullopt;
  }

  std::optional<TimeFunction> number(const Node& node, const std::string& key) {
    if (const auto* integer = node.as<std::int64_t>()) {
      return constant_function(static_cast<double>(*integer), value_text(node));
    }
    if (const auto* text = node.as<std::string>()) return function(node, *text, key);
    const auto* given = node.as<double>();
    if (given != nullptr && std::isfinite(*given)) {
      return constant_function(*given, value_text(node));
    }
    faults_.of_value(node,
                     {given ? FaultCode::scene_not_finite : FaultCode::scene_wrong_type, key,
                      given ? "not a finite number" : "found " + kind_of(node), kExpectedNumber});
    return std::nullopt;
  }

 private:
  std::optional<TimeFunction> function(const Node& node, const std::string& text,
                                       const std::string& key) {
    auto result = parameters_.bind(text, {&kVariable, 1});
    if (const auto* error = std::get_if<ExpressionError>(&result)) return refuse(node, key, *error);
    auto& bound = std::get<BoundExpression>(result);

    // Every run begins at 0: there at least it must have a value.
    const auto& known = bound.parameters;
    const auto at_start = bound.expression.evaluate([&known](std::string_view name) {
      const auto found = std::find_if(known.begin(), known.end(),
                                      [name](const auto& one) { return one.first == name; });
      return std::optional(found == known.end() ? 0.0 : found->second);
    });
    if (const auto* error = std::get_if<ExpressionError>(&at_start)) {
      return refuse(node, key, *error);
    }
    const auto& names = bound.expression.names();
    const bool changes = std::any_of(names.begin(), names.end(),
                                     [](const auto& used) { return used.name == kVariable; });
    if (!changes) return constant_function(std::get<double>(at_start), text);
    if (const auto error = random_in_motion(bound.expression)) return refuse(node, key, *error);
    TimeFunction function;
    function.text = text;
    function.expression = std::make_shared<const Expression>(std::move(bound.expression));
    function.parameters = std::move(bound.parameters);
    return function;
  }

  std::nullopt_t refuse(const Node& node, const std::string& key, const ExpressionError& error) {
    if (!error.consequence) {
      faults_.inside(node, error.column, {error.code, key, error.why, "", error.nearest});
    }
    return std::nullopt;
  }

  const ParameterTable& parameters_;
  FaultList& faults_;
};

}  // namespace

std::optional<Motion> read_motion(const Node& node, const std::string& key,
                                  const ParameterTable& parameters, FaultList& faults) {
  const auto* table = node.as<Table>();
  if (table == nullptr) {
    faults.of_wrong_type(node, key, "{ velocity = [..], angular_velocity = .. }");
    return std::nullopt;
  }
  MotionReader reader(parameters, faults);
  Motion motion;
  bool valid = true;
  for (const Entry& entry : table->entries) {
    const std::string path = key + "." + entry.key;
    if (entry.key == "velocity") {
      auto velocity = reader.vector(entry.value, path);
      valid = valid && velocity;
      if (velocity) motion.velocity = *std::move(velocity);
    } else if (entry.key == "angular_velocity") {
      auto angular = reader.number(entry.value, path);
      valid = valid && angular;
      if (angular) motion.angular_velocity = *std::move(angular);
    } else {
      report_key(entry, key, motion_layout(), faults);
      valid = false;
    }
  }
  if (!valid) return std::nullopt;
  return motion;
}

Table effective_motion(const Table& given, int dimension) {
  Table motion = given;
  const Node zero{0.0, {}};
  if (motion.find("velocity") == nullptr) {
    motion.set("velocity", Node{List(static_cast<std::size_t>(dimension), zero), {}});
  }
  if (dimension == 2 && motion.find("angular_velocity") == nullptr) {
    motion.set("angular_velocity", zero);
  }
  return motion;
}

}  // namespace tomlin
