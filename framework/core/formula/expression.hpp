#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/text/fault_code.hpp"

/// Expressions of a scene: a string where a number is expected, e.g. `"2 * sqrt(k / m)"`.
///
///   sum     = product { ("+" | "-") product }
///   product = signed { ("*" | "/") signed }
///   signed  = ("-" | "+") signed | power
///   power   = operand [ "^" signed ]              right-associative: -2^2 = -4, 2^-1 = 0.5
///   operand = number | "pi" | name | function "(" sum { "," sum } ")" | "(" sum ")"
///
/// A value has the same bits on every machine and in every locale: + - * / sqrt are IEEE double,
/// every other function and ^ is computed in quadruple precision and rounded once; libm is never
/// asked. A value is always finite: what would be nan or inf is an error that names the operation.
namespace tomlin {

struct ExpressionError {
  std::size_t column = 0;  ///< 0-based, in bytes of the text
  std::string why;
  std::string nearest = {};  ///< nearest valid name; empty when there is none
  /// Follows from a fault of a parameter that the table reports itself: no news to the user.
  bool consequence = false;
  FaultCode code = FaultCode::expression_syntax;
  friend bool operator==(const ExpressionError&, const ExpressionError&) = default;
};

/// A function that expressions may call.
struct ExpressionFunction {
  enum class Id : std::uint8_t {
    sqrt,
    exp,
    log,
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    atan2,
    abs,
    min,
    max,
    floor,
    tanh,
    sinh,
    cosh,
    sign,
    step,
    random,
    normal
  };
  Id id;
  std::string_view name;
  std::size_t fewest_arguments;
  std::size_t most_arguments;
  std::string_view summary;
  /// Before '(' only; elsewhere the name may be a parameter's.
  bool may_name_parameter = false;
};

/// All of them, in the order of the help text.
std::span<const ExpressionFunction> expression_functions();

/// Whether it draws a random number. Motions have none, and those of a formula belong to a
/// particle, not to a position or a time.
constexpr bool is_random(ExpressionFunction::Id id) {
  return id == ExpressionFunction::Id::random || id == ExpressionFunction::Id::normal;
}

/// The variables of expression forces and prescribed motions; parameters may not shadow them.
std::span<const std::string_view> expression_variables();

/// Further names in expressions that have a value for each particle of a body: its index `i`
/// and the `count` of particles. A parameter of such a name comes first.
std::span<const std::string_view> particle_variables();

/// [A-Za-z_][A-Za-z0-9_]*
bool is_identifier(std::string_view name);

/// A function, unless parameters may share its name, `pi` or a variable: no name for a parameter.
bool is_reserved_name(std::string_view name);

/// Parsed once, evaluated often; immutable.
class Expression {
 public:
  static constexpr std::size_t kMaxLength = 10000;  ///< bytes of text
  static constexpr std::size_t kMaxDepth = 200;     ///< parentheses, calls, signs, exponents

  enum class Op : std::uint8_t {
    number,
    pi,
    name,
    negate,
    add,
    subtract,
    multiply,
    divide,
    power,
    call
  };

  /// One step of the postfix program; operands come before their operation.
  struct Node {
    Op op = Op::number;
    std::uint32_t column = 0;
    std::uint32_t index = 0;      ///< name: into names(); call: into expression_functions()
    std::uint32_t arguments = 0;  ///< operands that it takes from the stack
    double number = 0.0;
  };

  struct Name {
    std::string name;
    std::size_t column = 0;  ///< of its first use
    friend bool operator==(const Name&, const Name&) = default;
  };

  using Lookup = std::function<std::optional<double>(std::string_view name)>;

  static std::variant<Expression, ExpressionError> parse(std::string_view text);

  /// The first error met, or a finite number.
  std::variant<double, ExpressionError> evaluate(const Lookup& lookup) const;

  /// Free names (neither functions nor `pi`), each once, in order of first use.
  const std::vector<Name>& names() const { return names_; }
  /// The first call of a function that draws random numbers; null without one.
  const Node* random_call() const;
  /// The subexpression that ends with a step; columns stay those of the whole text.
  Expression part(std::size_t step) const;
  /// For whoever evaluates expressions over other number types.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// The text as written; of a part as to_string() has it.
  const std::string& text() const { return text_; }
  /// Fewest parentheses and even spacing; parses to the same nodes.
  std::string to_string() const;

 private:
  Expression() = default;
  friend class ExpressionParser;

  std::string text_;
  std::vector<Node> nodes_;
  std::vector<Name> names_;
};

}  // namespace tomlin
