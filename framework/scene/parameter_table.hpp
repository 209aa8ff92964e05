#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/formula/expression.hpp"
#include "framework/core/text/fault_code.hpp"

/// `[parameters]` of a scene, and expressions over them.
namespace tomlin {

/// A fault of one parameter.
struct ParameterFault {
  enum class Part { name, value };
  std::string parameter;
  std::size_t entry = 0;    ///< which entry of the table, in order of add()
  Part part = Part::value;  ///< what the column counts in: the key or the expression
  std::size_t column = 0;   ///< 0-based
  std::string why;
  std::string nearest = {};  ///< nearest valid name; empty when there is none
  FaultCode code = FaultCode::expression_syntax;
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

  /// Compute every value; true without faults. Needed again after add().
  bool resolve();

  /// All faults, by entry and column. What only follows from another fault is not repeated.
  const std::vector<ParameterFault>& faults() const { return faults_; }

  bool contains(std::string_view name) const { return find(name).has_value(); }
  std::optional<double> value(std::string_view name) const;
  /// Resolved ones, in order.
  std::vector<std::pair<std::string, double>> values() const;

  /// Value of an expression over the parameters, for any other key of a scene; with a count of
  /// particles also over `count`, unless a parameter has that name.
  std::variant<double, ExpressionError> evaluate(std::string_view text,
                                                 std::optional<std::int64_t> count = {}) const;
  /// An expression over the parameters and some variables, to be evaluated later.
  std::variant<BoundExpression, ExpressionError> bind(
      std::string_view text, std::span<const std::string_view> variables) const;

  /// Whether an expression of the table, or one evaluated or bound so far, draws a random number.
  bool draws_random() const;

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
  mutable bool random_was_bound_ = false;
};

}  // namespace tomlin
