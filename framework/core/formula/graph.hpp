#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/formula/expression.hpp"
#include "framework/core/numbers/quad.hpp"

/// Formulas as a graph in which equal parts are one node, and their exact derivatives.
///
/// Every node is kept in one form: a sum of multiples, c0 + c1 u1 + c2 u2 + ...; a product of whole
/// powers, u1^n1 u2^n2 ...; a function of other nodes. What is equal in these forms is the same
/// node, so that a formula and its derivatives share what they have in common. Sums are not
/// multiplied out: (r - r0)^2 keeps its difference, and with it its digits.
///
/// Constants have quadruple precision, and sines and cosines take turns: of cos(2*pi*x/a) is left a
/// division by a.
namespace tomlin {

class FormulaGraph {
 public:
  using Id = std::uint32_t;

  /// Nodes and their parts together; a graph that would grow beyond it throws std::length_error.
  /// Long products have derivatives with the square of their factors.
  static constexpr std::size_t kLargest = 400000;

  /// Variables from this index on may have any size; no position or time that a run reaches is so
  /// large that its sine has no phase.
  static constexpr std::uint32_t kFirstUnboundedVariable = 17;

  enum class Kind : std::uint8_t { constant, variable, sum, product, function };

  enum class Function : std::uint8_t {
    sqrt,
    exp,
    log,
    power,      ///< of two nodes, the exponent no small whole number
    sin_turns,  ///< sin(2 pi u)
    cos_turns,
    tan_turns,
    asin,
    acos,
    atan,
    atan2,
    abs,
    min,
    max,
    floor,
    sinh,
    cosh,
    tanh,
    sign,
    step,           ///< 0 where u < 0, else 1
    choose,         ///< of four: a < b ? c : d
    when_positive,  ///< u where u > 0, and no number elsewhere: of slopes of what is defined there
                    ///< only
    sech_squared,   ///< 1 / cosh(u)^2: slopes of tanh, which stay finite however far away
    phase,          ///< turns, and no number where they are so many that no phase is left
    where_finite,   ///< of two: the first where the second is finite, and no number elsewhere
  };

  struct Term {
    Quad factor;
    Id node;
  };
  struct Factor {
    int exponent;
    Id node;
  };
  struct Node {
    Kind kind = Kind::constant;
    Quad number = Quad(0.0);      ///< the constant, or that of a sum
    std::uint32_t index = 0;      ///< which variable; which Function
    std::vector<Term> terms;      ///< of a sum, by node; factors are not 0
    std::vector<Factor> factors;  ///< of a product, by node; exponents are not 0
    std::vector<Id> arguments;    ///< of a function
  };

  /// Nodes that the names of an expression stand for.
  using Lookup = std::map<std::string_view, Id>;
  /// Nodes that stand for whole subexpressions, by the last step of each.
  using Given = std::map<std::size_t, Id>;

  Id constant(Quad value);
  Id variable(std::uint32_t index);
  Id add(Id a, Id b) { return sum(Quad(1.0), a, Quad(1.0), b); }
  Id subtract(Id a, Id b) { return sum(Quad(1.0), a, Quad(-1.0), b); }
  Id scale(Quad factor, Id node);
  Id negate(Id node) { return scale(Quad(-1.0), node); }
  Id multiply(Id a, Id b);
  Id divide(Id a, Id b) { return multiply(a, whole_power(b, -1)); }
  Id power(Id base, Id exponent);
  Id function(Function which, std::vector<Id> arguments);

  /// The whole of an expression. Every name of it must be known, and every random number must be
  /// part of a subexpression that is given. `steps` gets the node of each step, unless it is null.
  Id build(const Expression& expression, const Lookup& names, const Given& given = {},
           std::vector<Id>* steps = nullptr);

  /// d node / d variable, exactly. Where a formula has a kink (abs, min, max) or a jump (floor,
  /// sign, step) the derivative is that of either side.
  Id derivative(Id node, std::uint32_t variable);

  const Node& operator[](Id node) const { return nodes_[node]; }
  std::size_t size() const { return nodes_.size(); }
  bool is_constant(Id node) const { return nodes_[node].kind == Kind::constant; }
  bool is_zero(Id node) const;

  /// Slopes that keep to where `node` is defined: of sqrt(x)^2 the slope is 1, which is no number
  /// left of zero either. Roots, logarithms and powers that the slopes have lost are kept in the
  /// first of them.
  void keep_domain(Id node, std::vector<Id>& slopes);

  /// The value where the variables have these values; slow, for messages.
  Quad value(Id node, std::span<const Quad> variables) const;

 private:
  struct Before {
    bool operator()(const Node& a, const Node& b) const;
  };

  Id intern(Node node);
  Id sum(Quad factor_a, Id a, Quad factor_b, Id b);
  Id whole_power(Id base, int exponent);
  Id product_of(std::vector<Factor> factors);
  Id in_turns(Id angle);
  bool has_phase(Id turns) const;
  bool is_bounded(Id id) const;
  Id spread(Quad factor, Id id);
  Id slope(Id node, std::uint32_t variable);
  Id slope_of_function(const Node& node, std::uint32_t variable);
  Id call(const Expression::Node& step, std::span<const Id> arguments);
  /// Conditions under which a part of a formula is defined: a node has to be positive, or not
  /// negative.
  using Domains = std::map<std::pair<bool, Id>, Id>;  ///< to a node that is no number elsewhere
  Domains domains_of(const std::vector<Id>& roots);

  std::vector<Node> nodes_;
  std::map<Node, Id, Before> known_;
  std::size_t parts_ = 0;
  std::map<std::pair<Id, std::uint32_t>, Id> slopes_;
};

}  // namespace tomlin
