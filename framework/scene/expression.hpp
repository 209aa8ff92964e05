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

/// Expressions of a scene: a string where a number is due, e.g. `"2 * sqrt(k / m)"`.
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
    floor
  };
  Id id;
  std::string_view name;
  std::size_t fewest_arguments;
  std::size_t most_arguments;
  std::string_view summary;
};

/// All of them, in the order of the help text.
std::span<const ExpressionFunction> expression_functions();

/// The variables of expression forces and prescribed motions; parameters may not shadow them.
std::span<const std::string_view> expression_variables();

/// [A-Za-z_][A-Za-z0-9_]*
bool is_identifier(std::string_view name);

/// A function, `pi` or a variable: no name for a parameter.
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
  /// For whoever evaluates expressions over other number types.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// As written.
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

/// A fault of one parameter.
struct ParameterFault {
  enum class Part { name, value };
  std::string parameter;
  std::size_t entry = 0;    ///< which entry of the table, in order of add()
  Part part = Part::value;  ///< what the column counts in: the key or the expression
  std::size_t column = 0;   ///< 0-based
  std::string why;
  std::string nearest = {};  ///< nearest valid name; empty when there is none
};

/// An expression with the values of the parameters that it names.
struct BoundExpression {
  Expression expression;
  std::vector<std::pair<std::string, double>> parameters;
};

/// `[parameters]`: names with numbers or expressions over each other, in any order.
class ParameterTable {
 public:
  /// Entries keep their order; nothing is refused here, faults come from resolve().
  void add(std::string name, double value);
  void add(std::string name, std::string_view expression);

  /// Another value for a parameter (`--set`, sweeps); false when there is none of that name.
  bool replace(std::string_view name, double value);
  bool replace(std::string_view name, std::string_view expression);

  /// Compute every value; true without faults. Needed again after add() or replace().
  bool resolve();

  /// All faults, by entry and column. What only follows from another fault is not repeated.
  const std::vector<ParameterFault>& faults() const { return faults_; }
  /// Faults of one entry.
  std::span<const ParameterFault> faults_of(std::size_t entry) const;
  /// Faults of all entries of that name.
  std::vector<ParameterFault> faults_of(std::string_view name) const;

  std::size_t size() const { return entries_.size(); }
  bool contains(std::string_view name) const { return find(name).has_value(); }
  std::vector<std::string> names() const;
  std::optional<double> value(std::string_view name) const;
  /// Resolved ones, in order.
  std::vector<std::pair<std::string, double>> values() const;

  /// Value of an expression over the parameters, for any other key of a scene.
  std::variant<double, ExpressionError> evaluate(std::string_view text) const;
  /// An expression over the parameters and one variable, to be evaluated later.
  std::variant<BoundExpression, ExpressionError> bind(std::string_view text,
                                                      std::string_view variable) const;

 private:
  using Source = std::variant<double, Expression, ExpressionError>;
  struct Entry {
    std::string name;
    Source source;
    std::optional<double> value = {};
  };
  struct Edge {
    std::size_t target;
    std::size_t column;
  };

  std::optional<std::size_t> find(std::string_view name) const;
  void append(std::string name, Source source);
  bool assign(std::string_view name, Source source);
  void fault(std::size_t entry, ParameterFault::Part part, ExpressionError error);
  void check_names();
  std::vector<std::vector<Edge>> find_references();
  void report_cycle(std::vector<std::size_t> cycle, const std::vector<std::vector<Edge>>& edges);
  void compute(std::size_t entry);
  ExpressionError explain_unknown(std::string_view name, std::size_t column,
                                  std::optional<std::size_t> user) const;

  std::vector<Entry> entries_;
  std::map<std::string, std::size_t, std::less<>> by_name_;  ///< first entry of each name
  std::vector<ParameterFault> faults_;
  std::vector<std::size_t> first_fault_;  ///< of each entry, and the end
};

}  // namespace tomlin
