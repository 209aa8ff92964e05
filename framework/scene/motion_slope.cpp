#include "framework/scene/motion_slope.hpp"

#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "framework/core/formula/rounded_functions.hpp"

namespace tomlin {
namespace {

/// A value and its derivative with respect to time.
struct Slope {
  double value = 0.0;
  double slope = 0.0;
};

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Slope add(const Slope& a, const Slope& b) { return {a.value + b.value, a.slope + b.slope}; }
Slope subtract(const Slope& a, const Slope& b) { return {a.value - b.value, a.slope - b.slope}; }
Slope multiply(const Slope& a, const Slope& b) {
  return {a.value * b.value, a.slope * b.value + a.value * b.slope};
}
Slope divide(const Slope& a, const Slope& b) {
  const double value = a.value / b.value;
  return {value, (a.slope - value * b.slope) / b.value};
}

Slope power(const Slope& base, const Slope& exponent) {
  const double value = rounded_power(base.value, exponent.value);
  double slope = 0.0;
  if (base.slope != 0.0 && exponent.value != 0.0) {
    if (base.value == 0.0 && exponent.value < 1.0) return {value, kNone};
    slope = exponent.value * rounded_power(base.value, exponent.value - 1.0) * base.slope;
  }
  if (exponent.slope != 0.0 && !(base.value > 0.0)) return {value, kNone};
  if (exponent.slope != 0.0) slope += value * rounded_log(base.value) * exponent.slope;
  return {value, slope};
}

Slope call(ExpressionFunction::Id id, std::span<const Slope> arguments) {
  using Id = ExpressionFunction::Id;
  const Slope& a = arguments[0];
  const double x = a.value;
  const auto chain = [&a](double value, double slope) {
    // A value that does not depend on time has no slope, also where the function has none.
    return Slope{value, a.slope == 0.0 ? 0.0 : slope * a.slope};
  };
  const bool turns_too_far = !(std::abs(x) < kLargestAngle);
  switch (id) {
    case Id::sqrt: {
      const double root = std::sqrt(x);
      return chain(root, 0.5 / root);
    }
    case Id::exp: {
      const double value = rounded_exp(x);
      return chain(value, value);
    }
    case Id::log:
      return chain(rounded_log(x), 1.0 / x);
    case Id::sin:
      if (turns_too_far) return {kNone, kNone};
      return chain(rounded_sin(x), rounded_cos(x));
    case Id::cos:
      if (turns_too_far) return {kNone, kNone};
      return chain(rounded_cos(x), -rounded_sin(x));
    case Id::tan: {
      if (turns_too_far) return {kNone, kNone};
      const double value = rounded_tan(x);
      return chain(value, 1.0 + value * value);
    }
    case Id::asin:
      return chain(rounded_asin(x), 1.0 / std::sqrt((1.0 - x) * (1.0 + x)));
    case Id::acos:
      return chain(rounded_acos(x), -1.0 / std::sqrt((1.0 - x) * (1.0 + x)));
    case Id::atan:
      return chain(rounded_atan2(x, 1.0), 1.0 / (1.0 + x * x));
    case Id::atan2: {
      const Slope& b = arguments[1];
      const double square = x * x + b.value * b.value;
      return {rounded_atan2(x, b.value), (a.slope * b.value - x * b.slope) / square};
    }
    case Id::abs:
      return {std::abs(x), x < 0.0 ? -a.slope : a.slope};
    case Id::min:
    case Id::max: {
      Slope best = a;
      for (const Slope& other : arguments.subspan(1)) {
        if (id == Id::min ? other.value < best.value : other.value > best.value) best = other;
      }
      return best;
    }
    case Id::floor:
      return {std::floor(x), 0.0};
    case Id::tanh: {
      const double root = 1.0 / rounded_cosh(x);
      return chain(rounded_tanh(x), root * root);
    }
    case Id::sinh:
      return chain(rounded_sinh(x), rounded_cosh(x));
    case Id::cosh:
      return chain(rounded_cosh(x), rounded_sinh(x));
    case Id::sign:
      return {x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0), 0.0};
    case Id::step:
      return {x < 0.0 ? 0.0 : 1.0, 0.0};
    case Id::random:
    case Id::normal:
      break;  // refused where motions are read
  }
  return {kNone, kNone};
}

}  // namespace

double slope_of(const TimeFunction& function, double t) {
  if (function.is_constant()) return 0.0;
  const Expression& expression = *function.expression;
  const auto value_of = [&](std::string_view name) {
    for (const auto& [parameter, value] : function.parameters) {
      if (parameter == name) return Slope{value, 0.0};
    }
    return Slope{t, 1.0};  // the only other name that it may use
  };
  using Op = Expression::Op;
  std::vector<Slope> stack;
  for (const Expression::Node& node : expression.nodes()) {
    const std::size_t first = stack.size() - node.arguments;
    const std::span<const Slope> of(stack.data() + first, node.arguments);
    Slope result;
    switch (node.op) {
      case Op::number:
        result = {node.number, 0.0};
        break;
      case Op::pi:
        result = {3.14159265358979323846, 0.0};
        break;
      case Op::name:
        result = value_of(expression.names()[node.index].name);
        break;
      case Op::negate:
        result = {-of[0].value, -of[0].slope};
        break;
      case Op::add:
        result = add(of[0], of[1]);
        break;
      case Op::subtract:
        result = subtract(of[0], of[1]);
        break;
      case Op::multiply:
        result = multiply(of[0], of[1]);
        break;
      case Op::divide:
        result = divide(of[0], of[1]);
        break;
      case Op::power:
        result = power(of[0], of[1]);
        break;
      case Op::call:
        result = call(expression_functions()[node.index].id, of);
        break;
    }
    stack.resize(first);
    stack.push_back(result);
  }
  return stack.back().slope;
}

}  // namespace tomlin
