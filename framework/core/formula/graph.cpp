#include "framework/core/formula/graph.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <tuple>

#include "framework/core/numbers/hyperbolic.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/number_types.hpp"

namespace tomlin {
namespace {

/// Whole powers up to here are products; beyond, the general power is as fast.
constexpr int kLargestWholePower = 64;
/// Powers of powers are products up to here.
constexpr int kLargestExponent = 4096;

constexpr Quad kZero = 0.0;
constexpr Quad kOne = 1.0;

bool finite(Quad x) { return x - x == kZero; }

/// -1, 0, 1.
int compare(Quad a, Quad b) { return a < b ? -1 : (b < a ? 1 : 0); }

/// A whole number that is small enough for a product; 0 where it is none.
int small_whole(Quad x) {
  const auto near = static_cast<double>(x);
  if (!(near >= -kLargestWholePower && near <= kLargestWholePower)) return 0;
  const int whole = static_cast<int>(near);
  return Quad(static_cast<double>(whole)) == x ? whole : 0;
}

constexpr Quad kNoNumber = __builtin_nan("");
constexpr Quad kMostTurns = 0x1p50;  // as doubles: messages are about these

/// The first two are numbers.
bool comparable(std::span<const Quad> x) { return x[0] == x[0] && x[1] == x[1]; }

/// The value of a function of constants.
Quad folded(FormulaGraph::Function which, std::span<const Quad> x) {
  using enum FormulaGraph::Function;
  switch (which) {
    case sqrt:
      return tomlin::sqrt(x[0]);
    case exp:
      return tomlin::exp(x[0]);
    case log:
      return tomlin::log(x[0]);
    case power:
      return pow(x[0], x[1]);
    case sin_turns:
      return tomlin::sin_turns(x[0]);
    case cos_turns:
      return tomlin::cos_turns(x[0]);
    case tan_turns:
      return tomlin::tan_turns(x[0]);
    case asin:
      return tomlin::asin(x[0]);
    case acos:
      return tomlin::acos(x[0]);
    case atan:
      return tomlin::atan(x[0]);
    case atan2:
      return tomlin::atan2(x[0], x[1]);
    case abs:
      return tomlin::abs(x[0]);
    case min:
      return comparable(x) ? (x[1] < x[0] ? x[1] : x[0]) : kNoNumber;
    case max:
      return comparable(x) ? (x[0] < x[1] ? x[1] : x[0]) : kNoNumber;
    case floor:
      return tomlin::floor(x[0]);
    case sinh:
      return tomlin::sinh(x[0]);
    case cosh:
      return tomlin::cosh(x[0]);
    case tanh:
      return tomlin::tanh(x[0]);
    case sign:
      return tomlin::sign(x[0]);
    case step:
      return unit_step(x[0]);
    case choose:
      return comparable(x) ? (x[0] < x[1] ? x[2] : x[3]) : kNoNumber;
    case when_positive:
      return x[0] > kZero ? x[0] : kNoNumber;
    case sech_squared:
      return tomlin::sech_squared(x[0]);
    case phase:
      return tomlin::abs(x[0]) < kMostTurns ? x[0] : kNoNumber;
    case where_finite:
      return finite(x[1]) ? x[0] : kNoNumber;
  }
  return kZero;
}

bool by_node(const FormulaGraph::Term& a, const FormulaGraph::Term& b) { return a.node < b.node; }
bool factor_by_node(const FormulaGraph::Factor& a, const FormulaGraph::Factor& b) {
  return a.node < b.node;
}

}  // namespace

bool FormulaGraph::Before::operator()(const Node& a, const Node& b) const {
  const auto key = [](const Node& node) {
    return std::make_tuple(node.kind, node.index, node.terms.size(), node.factors.size(),
                           node.arguments.size());
  };
  if (key(a) != key(b)) return key(a) < key(b);
  if (const int order = compare(a.number, b.number); order != 0) return order < 0;
  for (std::size_t k = 0; k < a.terms.size(); ++k) {
    if (a.terms[k].node != b.terms[k].node) return a.terms[k].node < b.terms[k].node;
    if (const int order = compare(a.terms[k].factor, b.terms[k].factor); order != 0) {
      return order < 0;
    }
  }
  for (std::size_t k = 0; k < a.factors.size(); ++k) {
    const Factor& one = a.factors[k];
    const Factor& other = b.factors[k];
    if (one.node != other.node) return one.node < other.node;
    if (one.exponent != other.exponent) return one.exponent < other.exponent;
  }
  return a.arguments < b.arguments;
}

FormulaGraph::Id FormulaGraph::intern(Node node) {
  const auto next = static_cast<Id>(nodes_.size());
  const auto [found, inserted] = known_.emplace(std::move(node), next);
  if (inserted) {
    const Node& kept = found->first;
    parts_ += 1 + kept.terms.size() + kept.factors.size() + kept.arguments.size();
    if (parts_ > kLargest) throw std::length_error("the formula is too large");
    nodes_.push_back(kept);
  }
  return found->second;
}

bool FormulaGraph::is_zero(Id node) const {
  return is_constant(node) && nodes_[node].number == kZero;
}

FormulaGraph::Id FormulaGraph::constant(Quad value) {
  Node node;
  node.number = value == kZero ? kZero : value;  // no -0
  return intern(std::move(node));
}

FormulaGraph::Id FormulaGraph::variable(std::uint32_t index) {
  Node node;
  node.kind = Kind::variable;
  node.index = index;
  return intern(std::move(node));
}

/// A sum takes in the terms of its parts where they are sums themselves.
FormulaGraph::Id FormulaGraph::sum(Quad factor_a, Id a, Quad factor_b, Id b) {
  Node all;
  all.kind = Kind::sum;
  for (const auto& [factor, id] : {std::pair(factor_a, a), std::pair(factor_b, b)}) {
    const Node& part = nodes_[id];
    if (part.kind == Kind::constant) {
      all.number += factor * part.number;
    } else if (part.kind == Kind::sum &&
               (factor == kOne || (part.terms.size() == 1 && part.number == kZero))) {
      all.number += factor * part.number;
      for (const Term& term : part.terms) all.terms.push_back({factor * term.factor, term.node});
    } else {
      all.terms.push_back({factor, id});
    }
  }
  std::stable_sort(all.terms.begin(), all.terms.end(), by_node);
  std::vector<Term> merged;
  for (const Term& term : all.terms) {
    if (!merged.empty() && merged.back().node == term.node) {
      merged.back().factor += term.factor;
    } else {
      merged.push_back(term);
    }
  }
  std::erase_if(merged, [](const Term& term) { return term.factor == kZero; });
  all.terms = std::move(merged);
  if (all.terms.empty()) return constant(all.number);
  if (all.terms.size() == 1 && all.terms.front().factor == kOne && all.number == kZero) {
    return all.terms.front().node;
  }
  return intern(std::move(all));
}

FormulaGraph::Id FormulaGraph::scale(Quad factor, Id node) {
  if (factor == kZero) return constant(kZero);
  if (factor == kOne) return node;
  return sum(factor, node, kZero, constant(kZero));
}

/// Multiples are taken out of products, so that c u and u share u.
FormulaGraph::Id FormulaGraph::multiply(Id a, Id b) {
  Quad factor = kOne;
  std::vector<Factor> factors;
  for (Id id : {a, b}) {
    const Node* node = &nodes_[id];
    if (node->kind == Kind::constant) {
      factor *= node->number;
      continue;
    }
    if (node->kind == Kind::sum && node->terms.size() == 1 && node->number == kZero) {
      factor *= node->terms.front().factor;
      id = node->terms.front().node;
      node = &nodes_[id];
    }
    if (node->kind == Kind::product) {
      factors.insert(factors.end(), node->factors.begin(), node->factors.end());
    } else {
      factors.push_back({1, id});
    }
  }
  if (factor == kZero) return constant(kZero);
  return scale(factor, product_of(std::move(factors)));
}

FormulaGraph::Id FormulaGraph::product_of(std::vector<Factor> factors) {
  std::stable_sort(factors.begin(), factors.end(), factor_by_node);
  Node all;
  all.kind = Kind::product;
  for (const Factor& factor : factors) {
    if (!all.factors.empty() && all.factors.back().node == factor.node) {
      all.factors.back().exponent += factor.exponent;
    } else {
      all.factors.push_back(factor);
    }
  }
  std::erase_if(all.factors, [](const Factor& factor) { return factor.exponent == 0; });
  if (all.factors.empty()) return constant(kOne);
  if (all.factors.size() == 1 && all.factors.front().exponent == 1) {
    return all.factors.front().node;
  }
  return intern(std::move(all));
}

FormulaGraph::Id FormulaGraph::whole_power(Id base, int exponent) {
  if (exponent == 0) return constant(kOne);
  if (exponent == 1) return base;
  const Node& node = nodes_[base];
  if (node.kind == Kind::constant) {
    const Quad value = pow(node.number, Quad(static_cast<double>(exponent)));
    // 1/0 stays what it is: binding finds it.
    if (finite(value)) return constant(value);
    return product_of({{exponent, base}});
  }
  if (node.kind == Kind::sum && node.terms.size() == 1 && node.number == kZero) {
    const Term term = node.terms.front();
    const Quad factor = pow(term.factor, Quad(static_cast<double>(exponent)));
    return scale(factor, whole_power(term.node, exponent));
  }
  std::vector<Factor> factors;
  if (node.kind == Kind::product) {
    factors = node.factors;
    for (Factor& factor : factors) {
      if (std::abs(factor.exponent) > kLargestExponent / std::abs(exponent)) {
        return function(Function::power, {base, constant(Quad(static_cast<double>(exponent)))});
      }
      factor.exponent *= exponent;
    }
  } else {
    factors.push_back({exponent, base});
  }
  return product_of(std::move(factors));
}

FormulaGraph::Id FormulaGraph::power(Id base, Id exponent) {
  if (is_constant(exponent)) {
    const Quad value = nodes_[exponent].number;
    if (value == kZero) return constant(kOne);
    if (const int whole = small_whole(value); whole != 0) return whole_power(base, whole);
    if (value == Quad(0.5)) return function(Function::sqrt, {base});
  }
  return function(Function::power, {base, exponent});
}

FormulaGraph::Id FormulaGraph::function(Function which, std::vector<Id> arguments) {
  const auto constants =
      std::all_of(arguments.begin(), arguments.end(), [&](Id id) { return is_constant(id); });
  if (constants) {
    std::vector<Quad> values;
    values.reserve(arguments.size());
    for (const Id id : arguments) values.push_back(nodes_[id].number);
    const Quad value = folded(which, values);
    if (finite(value)) return constant(value);
  }
  if (which == Function::choose && arguments[2] == arguments[3]) return arguments[2];
  Node node;
  node.kind = Kind::function;
  node.index = static_cast<std::uint32_t>(which);
  node.arguments = std::move(arguments);
  return intern(std::move(node));
}

/// An angle in radians as turns. Sums are multiplied out: a phase has no digits to lose.
FormulaGraph::Id FormulaGraph::in_turns(Id angle) {
  const Id turns = spread(kOne / tau<Quad>(), angle);
  return has_phase(turns) ? turns : function(Function::phase, {turns});
}

/// A sum of small multiples of variables: no position or time that a run reaches has too many
/// turns.
bool FormulaGraph::has_phase(Id id) const {
  constexpr Quad kMostPerUnit = 1024.0;
  const Node& node = nodes_[id];
  if (node.kind != Kind::sum) return is_bounded(id);
  return std::all_of(node.terms.begin(), node.terms.end(), [&](const Term& term) {
    return is_bounded(term.node) && tomlin::abs(term.factor) <= kMostPerUnit;
  });
}

/// A position, a velocity or the time, but not a number of a particle, which may have any size.
bool FormulaGraph::is_bounded(Id id) const {
  return nodes_[id].kind == Kind::variable && nodes_[id].index < kFirstUnboundedVariable;
}

/// factor * node, with sums multiplied out.
FormulaGraph::Id FormulaGraph::spread(Quad factor, Id id) {
  const Node node = nodes_[id];  // a copy: the graph grows
  if (node.kind != Kind::sum) return scale(factor, id);
  Id all = constant(factor * node.number);
  for (const Term& term : node.terms) all = add(all, spread(factor * term.factor, term.node));
  return all;
}

// ---- expressions --------------------------------------------------------------------------------

FormulaGraph::Id FormulaGraph::build(const Expression& expression, const Lookup& names,
                                     const Given& given, std::vector<Id>* steps) {
  using Op = Expression::Op;
  std::vector<Id> stack;
  for (std::size_t k = 0; k < expression.nodes().size(); ++k) {
    const Expression::Node& step = expression.nodes()[k];
    const std::size_t first = stack.size() - step.arguments;
    const std::span<const Id> arguments(stack.data() + first, step.arguments);
    Id result = 0;
    switch (step.op) {
      case Op::number:
        result = constant(Quad(step.number));
        break;
      case Op::pi:
        result = constant(tau<Quad>() / Quad(2.0));
        break;
      case Op::name:
        result = names.at(expression.names()[step.index].name);
        break;
      case Op::negate:
        result = negate(arguments[0]);
        break;
      case Op::add:
        result = add(arguments[0], arguments[1]);
        break;
      case Op::subtract:
        result = subtract(arguments[0], arguments[1]);
        break;
      case Op::multiply:
        result = multiply(arguments[0], arguments[1]);
        break;
      case Op::divide:
        result = divide(arguments[0], arguments[1]);
        break;
      case Op::power:
        result = power(arguments[0], arguments[1]);
        break;
      case Op::call:
        result = call(step, arguments);
        break;
    }
    if (const auto found = given.find(k); found != given.end()) result = found->second;
    stack.resize(first);
    stack.push_back(result);
    if (steps != nullptr) steps->push_back(result);
  }
  return stack.back();
}

FormulaGraph::Id FormulaGraph::call(const Expression::Node& called, std::span<const Id> arguments) {
  using enum ExpressionFunction::Id;
  const Id u = arguments[0];
  // A chain of two at a time.
  const auto folded_over = [&](Function which) {
    Id result = u;
    for (const Id next : arguments.subspan(1)) result = function(which, {result, next});
    return result;
  };
  switch (expression_functions()[called.index].id) {
    case sqrt:
      return function(Function::sqrt, {u});
    case exp:
      return function(Function::exp, {u});
    case log:
      return function(Function::log, {u});
    case sin:
      return function(Function::sin_turns, {in_turns(u)});
    case cos:
      return function(Function::cos_turns, {in_turns(u)});
    case tan:
      return function(Function::tan_turns, {in_turns(u)});
    case asin:
      return function(Function::asin, {u});
    case acos:
      return function(Function::acos, {u});
    case atan:
      return function(Function::atan, {u});
    case atan2:
      return function(Function::atan2, {u, arguments[1]});
    case abs:
      return function(Function::abs, {u});
    case min:
      return folded_over(Function::min);
    case max:
      return folded_over(Function::max);
    case floor:
      return function(Function::floor, {u});
    case sinh:
      return function(Function::sinh, {u});
    case cosh:
      return function(Function::cosh, {u});
    case tanh:
      return function(Function::tanh, {u});
    case sign:
      return function(Function::sign, {u});
    case step:
      return function(Function::step, {u});
    case random:
    case normal:
      break;  // part of a subexpression that is given
  }
  return u;
}

// ---- derivatives --------------------------------------------------------------------------------

FormulaGraph::Id FormulaGraph::derivative(Id node, std::uint32_t variable) {
  const auto found = slopes_.find({node, variable});
  if (found != slopes_.end()) return found->second;
  const Id result = slope(node, variable);
  slopes_.emplace(std::pair(node, variable), result);
  return result;
}

/// Nodes come after those that they are made of: one pass through all up to this one.
Quad FormulaGraph::value(Id node, std::span<const Quad> variables) const {
  std::vector<Quad> values;
  values.reserve(node + 1);
  for (Id id = 0; id <= node; ++id) {
    const Node& now = nodes_[id];
    Quad result = now.number;
    switch (now.kind) {
      case Kind::constant:
        break;
      case Kind::variable:
        result = variables[now.index];
        break;
      case Kind::sum:
        for (const Term& term : now.terms) result += term.factor * values[term.node];
        break;
      case Kind::product:
        result = kOne;
        for (const Factor& factor : now.factors) {
          result *= pow(values[factor.node], Quad(static_cast<double>(factor.exponent)));
        }
        break;
      case Kind::function: {
        std::vector<Quad> arguments;
        arguments.reserve(now.arguments.size());
        for (const Id argument : now.arguments) arguments.push_back(values[argument]);
        result = folded(static_cast<Function>(now.index), arguments);
        break;
      }
    }
    values.push_back(result);
  }
  return values.back();
}

FormulaGraph::Id FormulaGraph::slope(Id id, std::uint32_t variable) {
  const Node node = nodes_[id];  // a copy: the graph grows
  Id result = constant(kZero);
  switch (node.kind) {
    case Kind::constant:
      return result;
    case Kind::variable:
      return constant(Quad(node.index == variable ? 1.0 : 0.0));
    case Kind::sum:
      for (const Term& term : node.terms) {
        result = sum(kOne, result, term.factor, derivative(term.node, variable));
      }
      return result;
    case Kind::product:
      for (std::size_t k = 0; k < node.factors.size(); ++k) {
        const Id inner = derivative(node.factors[k].node, variable);
        if (is_zero(inner)) continue;
        std::vector<Factor> rest = node.factors;
        const int exponent = rest[k].exponent--;
        const Id outer = scale(Quad(static_cast<double>(exponent)), product_of(std::move(rest)));
        result = add(result, multiply(outer, inner));
      }
      return result;
    case Kind::function:
      return slope_of_function(node, variable);
  }
  return result;
}

FormulaGraph::Id FormulaGraph::slope_of_function(const Node& node, std::uint32_t variable) {
  using enum Function;
  const auto which = static_cast<Function>(node.index);
  std::vector<Id> inner;
  for (const Id argument : node.arguments) inner.push_back(derivative(argument, variable));
  if (std::all_of(inner.begin(), inner.end(), [&](Id id) { return is_zero(id); })) {
    return constant(kZero);
  }
  const Id self = function(which, node.arguments);
  const Id u = node.arguments[0];
  const Id v = node.arguments.size() > 1 ? node.arguments[1] : u;
  const Id one = constant(kOne);
  switch (which) {
    case sqrt:
      return scale(Quad(0.5), divide(inner[0], self));
    case exp:
      return multiply(self, inner[0]);
    case log:
      return divide(inner[0], function(when_positive, {u}));
    case power: {
      const Id lower = FormulaGraph::power(u, subtract(v, one));
      Id result = multiply(multiply(v, lower), inner[0]);
      if (!is_zero(inner[1])) {
        result = add(result, multiply(multiply(self, function(log, {u})), inner[1]));
      }
      return result;
    }
    case sin_turns:
      return scale(tau<Quad>(), multiply(function(cos_turns, {u}), inner[0]));
    case cos_turns:
      return scale(-tau<Quad>(), multiply(function(sin_turns, {u}), inner[0]));
    case tan_turns:
      return scale(tau<Quad>(), multiply(add(one, whole_power(self, 2)), inner[0]));
    case asin:
      return divide(inner[0], function(sqrt, {subtract(one, whole_power(u, 2))}));
    case acos:
      return negate(divide(inner[0], function(sqrt, {subtract(one, whole_power(u, 2))})));
    case atan:
      return divide(inner[0], add(one, whole_power(u, 2)));
    case atan2:
      return divide(subtract(multiply(v, inner[0]), multiply(u, inner[1])),
                    add(whole_power(u, 2), whole_power(v, 2)));
    case abs: {
      const Id zero = constant(kZero);
      return function(choose, {u, zero, negate(inner[0]), inner[0]});
    }
    case min:
      return function(choose, {v, u, inner[1], inner[0]});
    case max:
      return function(choose, {u, v, inner[1], inner[0]});
    case floor:
    case sign:
    case step:
      return constant(kZero);
    case sinh:
      return multiply(function(cosh, {u}), inner[0]);
    case cosh:
      // Not sinh(u): of 1/cosh(u) it would leave sinh/cosh^2, no number where both overflow.
      return multiply(multiply(self, function(tanh, {u})), inner[0]);
    case tanh:
      // Not 1 - tanh^2, of which no digits are left far away.
      return multiply(function(sech_squared, {u}), inner[0]);
    case sech_squared:
      return scale(Quad(-2.0), multiply(multiply(function(tanh, {u}), self), inner[0]));
    case choose:
      return function(choose, {u, v, inner[2], inner[3]});
    case when_positive:
    case phase:
      return inner[0];
    case where_finite:
      return function(where_finite, {inner[0], v});
  }
  return constant(kZero);
}

// ---- domains ------------------------------------------------------------------------------------

FormulaGraph::Domains FormulaGraph::domains_of(const std::vector<Id>& roots) {
  using enum Function;
  constexpr bool kPositive = true;
  constexpr bool kNotNegative = false;
  Domains found;
  std::set<Id> seen;
  std::vector<Id> left = roots;
  while (!left.empty()) {
    const Id id = left.back();
    left.pop_back();
    if (!seen.insert(id).second) continue;
    const Node node = nodes_[id];  // a copy: the graph grows
    for (const Term& term : node.terms) left.push_back(term.node);
    for (const Factor& factor : node.factors) left.push_back(factor.node);
    left.insert(left.end(), node.arguments.begin(), node.arguments.end());
    if (node.kind != Kind::function) continue;
    const Id u = node.arguments[0];
    switch (static_cast<Function>(node.index)) {
      case sqrt:
      case power:
        found.emplace(std::pair(kNotNegative, u), id);
        break;
      case log:
      case when_positive:
        found.emplace(std::pair(kPositive, u), id);
        break;
      case asin:
      case acos:
        // Their slopes have the root of this.
        found.emplace(std::pair(kNotNegative, subtract(constant(kOne), whole_power(u, 2))), id);
        break;
      default:
        break;
    }
  }
  return found;
}

void FormulaGraph::keep_domain(Id node, std::vector<Id>& slopes) {
  const Domains kept = domains_of(slopes);
  for (const auto& [domain, part] : domains_of({node})) {
    if (kept.count(domain) == 0) slopes[0] = function(Function::where_finite, {slopes[0], part});
  }
}

}  // namespace tomlin
