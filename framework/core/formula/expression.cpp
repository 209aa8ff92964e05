#include "framework/core/formula/expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <system_error>
#include <tuple>

#include <boost/container/small_vector.hpp>

#include "framework/core/formula/rounded_functions.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/text/ascii.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace {

// ---- Names ----------------------------------------------------------------------------------

using FunctionId = ExpressionFunction::Id;

constexpr std::size_t kAnyNumber = Expression::kMaxLength;

constexpr std::size_t kUsualDepth = 32;  // of the stack that an evaluation needs

// In the order of FunctionId.
constexpr std::array<ExpressionFunction, 21> kFunctions{{
    {FunctionId::sqrt, "sqrt", 1, 1, "square root"},
    {FunctionId::exp, "exp", 1, 1, "exponential"},
    {FunctionId::log, "log", 1, 1, "natural logarithm"},
    {FunctionId::sin, "sin", 1, 1, "sine, of radians"},
    {FunctionId::cos, "cos", 1, 1, "cosine, of radians"},
    {FunctionId::tan, "tan", 1, 1, "tangent, of radians"},
    {FunctionId::asin, "asin", 1, 1, "arc sine, -pi/2 to pi/2"},
    {FunctionId::acos, "acos", 1, 1, "arc cosine, 0 to pi"},
    {FunctionId::atan, "atan", 1, 1, "arc tangent, -pi/2 to pi/2"},
    {FunctionId::atan2, "atan2", 2, 2, "atan2(y, x): angle of the point (x, y), -pi to pi"},
    {FunctionId::abs, "abs", 1, 1, "absolute value"},
    {FunctionId::min, "min", 2, kAnyNumber, "smallest of two or more"},
    {FunctionId::max, "max", 2, kAnyNumber, "largest of two or more"},
    {FunctionId::floor, "floor", 1, 1, "largest integer that is not larger"},
    {FunctionId::tanh, "tanh", 1, 1, "hyperbolic tangent", true},
    {FunctionId::sinh, "sinh", 1, 1, "hyperbolic sine", true},
    {FunctionId::cosh, "cosh", 1, 1, "hyperbolic cosine", true},
    {FunctionId::sign, "sign", 1, 1, "-1, 0 or 1: the sign of a number", true},
    {FunctionId::step, "step", 1, 1, "0 below 0, and 1 from 0 on", true},
    {FunctionId::random, "random", 2, 2,
     "random(seed, n): the n-th random number, uniform between 0 and 1", true},
    {FunctionId::normal, "normal", 2, 2,
     "normal(seed, n): the same of mean 0 and standard deviation 1", true},
}};

constexpr std::array<std::string_view, 12> kVariables{"x",  "y",  "z",  "vx", "vy",    "vz",
                                                      "xc", "yc", "zc", "r",  "theta", "t"};

constexpr std::array<std::string_view, 2> kParticleVariables{"i", "count"};

constexpr std::string_view kPi = "pi";

/// Up to here doubles hold every integer.
constexpr double kLargestCount = 9007199254740992.0;

/// Each function has a stream of its own: the same seed and number are not the same draw.
double drawn(FunctionId function, double seed, double number) {
  const bool uniform = function == FunctionId::random;
  const RandomKey key{static_cast<std::uint64_t>(seed), stream_of(uniform ? "random" : "normal")};
  const auto [first, second] = uniform_pair(key, {static_cast<std::uint64_t>(number), 0, 0, 0});
  if (uniform) return first;
  // Box and Muller, Ann. Math. Stat. 29 (1958) 610.
  return std::sqrt(-2.0 * rounded_log(first)) * rounded_cos(2.0 * std::numbers::pi * second);
}

std::optional<std::uint32_t> find_function(std::string_view name) {
  for (std::uint32_t i = 0; i < kFunctions.size(); ++i) {
    if (kFunctions[i].name == name) return i;
  }
  return std::nullopt;
}

bool is_variable(std::string_view name) {
  return std::find(kVariables.begin(), kVariables.end(), name) != kVariables.end();
}

// Not <cctype>, which depends on the locale.

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  if (text.size() <= longest) return '\'' + std::string(text) + '\'';
  return '\'' + std::string(text.substr(0, longest)) + "...'";
}

std::string written(double number) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  return {buffer.data(), end};
}

// A left operand as it would have to be written.
std::string operand(double number) {
  return std::signbit(number) ? '(' + written(number) + ')' : written(number);
}

}  // namespace

std::span<const ExpressionFunction> expression_functions() { return kFunctions; }

std::span<const std::string_view> expression_variables() { return kVariables; }

std::span<const std::string_view> particle_variables() { return kParticleVariables; }

bool is_identifier(std::string_view name) {
  if (name.empty() || !is_letter_or_underscore(name[0])) return false;
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return is_letter_or_underscore(c) || is_digit(c); });
}

bool is_reserved_name(std::string_view name) {
  const auto function = find_function(name);
  return name == kPi || is_variable(name) ||
         (function && !kFunctions[*function].may_name_parameter);
}

// ---- Parsing ----------------------------------------------------------------------------------

/// Recursive descent; writes the postfix program. The first error stops it.
class ExpressionParser {
 public:
  explicit ExpressionParser(std::string_view text) : text_(text) {}

  std::variant<Expression, ExpressionError> parse() {
    if (text_.size() > Expression::kMaxLength) {
      return ExpressionError{.column = Expression::kMaxLength,
                             .why = "the expression is longer than " +
                                    std::to_string(Expression::kMaxLength) + " characters",
                             .code = FaultCode::scene_too_large};
    }
    skip_space();
    if (at_end()) return ExpressionError{0, "the expression is empty"};
    if (sum() && !at_end()) refuse_rest();
    if (error_) return *std::move(error_);
    expression_.text_ = text_;
    return std::move(expression_);
  }

 private:
  using Op = Expression::Op;

  // Every function below leaves the position behind trailing space, and is false on error.

  bool sum() {
    if (!product()) return false;
    while (peek() == '+' || peek() == '-') {
      const Op op = peek() == '+' ? Op::add : Op::subtract;
      const std::size_t column = take();
      if (!product()) return false;
      emit(op, column, 2);
    }
    return true;
  }

  bool product() {
    if (!signed_operand()) return false;
    while (peek() == '*' || peek() == '/') {
      const Op op = peek() == '*' ? Op::multiply : Op::divide;
      const std::size_t column = take();
      if (op == Op::multiply && peek() == '*' && position_ == column + 1) {
        return fail(column, "'**' is not an operator; a power is written '^'");
      }
      if (!signed_operand()) return false;
      emit(op, column, 2);
    }
    return true;
  }

  bool signed_operand() {
    if (peek() != '-' && peek() != '+') return power();
    const bool minus = peek() == '-';
    const std::size_t column = take();
    if (!enter(column) || !signed_operand()) return false;
    leave();
    if (minus) emit(Op::negate, column, 1);
    return true;
  }

  bool power() {
    if (!primary()) return false;
    if (peek() != '^') return true;
    const std::size_t column = take();
    if (!enter(column) || !signed_operand()) return false;
    leave();
    emit(Op::power, column, 2);
    return true;
  }

  bool primary() {
    const char c = peek();
    if (is_digit(c) || c == '.') return number();
    if (is_letter_or_underscore(c)) return name_or_call();
    if (c == '(') {
      const std::size_t column = take();
      if (!enter(column) || !sum() || !close(column)) return false;
      leave();
      return true;
    }
    if (at_end()) {
      return fail(position_, "a number, a name or '(' is missing at the end");
    }
    if (is_punctuation(c)) {
      return fail(position_, "a number, a name or '(' is missing before " + in_quotes({&c, 1}));
    }
    return refuse_character();
  }

  bool number() {
    const std::size_t column = position_;
    double value = 0.0;
    const char* const begin = text_.data() + position_;
    const char* const end = text_.data() + text_.size();
    const auto [stop, status] = std::from_chars(begin, end, value);
    // A word, as a reader would see it, has to be one number.
    const char* word_end = status == std::errc::invalid_argument ? begin : stop;
    while (word_end != end &&
           (is_digit(*word_end) || is_letter_or_underscore(*word_end) || *word_end == '.')) {
      ++word_end;
    }
    const std::string_view word(begin, static_cast<std::size_t>(word_end - begin));
    if (status == std::errc::invalid_argument || stop != word_end) {
      const bool product = status != std::errc::invalid_argument && is_letter_or_underscore(*stop);
      return fail(column, in_quotes(word) + " is not a number" +
                              (product ? "; a product is written with '*'" : ""));
    }
    if (status == std::errc::result_out_of_range || !std::isfinite(value)) {
      return fail(FaultCode::expression_not_finite, column,
                  in_quotes(word) + " is outside the range of double precision");
    }
    position_ += word.size();
    skip_space();
    emit(Op::number, column, 0, 0, value);
    return true;
  }

  bool name_or_call() {
    const std::size_t column = position_;
    std::size_t end = position_;
    while (end < text_.size() && (is_letter_or_underscore(text_[end]) || is_digit(text_[end])))
      ++end;
    const std::string_view name = text_.substr(column, end - column);
    position_ = end;
    skip_space();
    const auto function = find_function(name);
    if (peek() == '(') {
      if (!function) return refuse_call(name, column);
      return call(*function, column);
    }
    if (function && !kFunctions[*function].may_name_parameter) {
      return fail(column, in_quotes(name) + " is a function; its argument follows in parentheses");
    }
    if (name == kPi) {
      emit(Op::pi, column, 0, 0, std::numbers::pi);
    } else {
      emit(Op::name, column, 0, index_of(name, column));
    }
    return true;
  }

  bool call(std::uint32_t index, std::size_t column) {
    const ExpressionFunction& function = kFunctions[index];
    const std::size_t open = take();
    if (!enter(open)) return false;
    std::size_t count = 0;
    if (peek() != ')') {
      if (!sum()) return false;
      ++count;
      while (peek() == ',') {
        take();
        if (!sum()) return false;
        ++count;
      }
    }
    if (!close(open)) return false;
    leave();
    if (count < function.fewest_arguments || count > function.most_arguments) {
      const std::string expected =
          std::to_string(function.fewest_arguments) +
          (function.most_arguments > function.fewest_arguments ? " or more" : "");
      return fail(column, in_quotes(function.name) + " takes " + expected +
                              (expected == "1" ? " argument, not " : " arguments, not ") +
                              std::to_string(count));
    }
    emit(Op::call, column, static_cast<std::uint32_t>(count), index);
    return true;
  }

  bool close(std::size_t open) {
    if (peek() == ')') {
      take();
      return true;
    }
    if (at_end()) return fail(open, "this parenthesis is not closed");
    return refuse_rest();
  }

  bool refuse_call(std::string_view name, std::size_t column) {
    std::vector<std::string> functions;
    functions.reserve(kFunctions.size());
    for (const ExpressionFunction& function : kFunctions) functions.emplace_back(function.name);
    fail(FaultCode::expression_unknown_name, column,
         in_quotes(name) + " is not a function; a product is written with '*'");
    error_->nearest = nearest_name(name, functions).value_or("");
    return false;
  }

  // At something that cannot follow an operand.
  bool refuse_rest() {
    const char c = peek();
    if (c == ')') return fail(position_, "')' closes no parenthesis");
    if (c == ',') {
      return fail(position_,
                  "',' only separates the arguments of a function; decimals follow a point");
    }
    if (is_digit(c) || is_letter_or_underscore(c) || c == '(' || c == '.') {
      return fail(position_, "an operator is missing before " + in_quotes({&c, 1}) +
                                 "; a product is written with '*'");
    }
    return refuse_character();
  }

  bool refuse_character() {
    // The whole character where it is UTF-8, its code where it cannot be shown.
    std::size_t end = position_ + 1;
    while (end < text_.size() && (text_[end] & 0xC0) == 0x80) ++end;
    const auto byte = static_cast<unsigned char>(peek());
    if (byte >= 0x20 && byte != 0x7F) {
      return fail(position_,
                  "unexpected character " + in_quotes(text_.substr(position_, end - position_)));
    }
    return fail(position_, "unexpected control character, code " + std::to_string(byte));
  }

  static bool is_punctuation(char c) {
    return c != '\0' && std::string_view("+-*/^),").find(c) != std::string_view::npos;
  }

  bool enter(std::size_t column) {
    if (++depth_ <= Expression::kMaxDepth) return true;
    return fail(FaultCode::scene_too_large, column,
                "nested deeper than " + std::to_string(Expression::kMaxDepth) +
                    " parentheses, signs and exponents");
  }
  void leave() { --depth_; }

  bool fail(std::size_t column, std::string why) {
    return fail(FaultCode::expression_syntax, column, std::move(why));
  }

  bool fail(FaultCode code, std::size_t column, std::string why) {
    error_ = ExpressionError{.column = column, .why = std::move(why), .code = code};
    return false;
  }

  bool at_end() const { return position_ == text_.size(); }
  char peek() const { return at_end() ? '\0' : text_[position_]; }

  // Skip one character and the space behind it; its column.
  std::size_t take() {
    const std::size_t column = position_++;
    skip_space();
    return column;
  }

  void skip_space() {
    while (!at_end() && std::string_view(" \t\r\n").find(peek()) != std::string_view::npos) {
      ++position_;
    }
  }

  void emit(Op op, std::size_t column, std::uint32_t arguments, std::uint32_t index = 0,
            double number = 0.0) {
    expression_.nodes_.push_back(
        {op, static_cast<std::uint32_t>(column), index, arguments, number});
  }

  std::uint32_t index_of(std::string_view name, std::size_t column) {
    const auto next = static_cast<std::uint32_t>(expression_.names_.size());
    const auto [found, inserted] = indices_.emplace(name, next);
    if (inserted) expression_.names_.push_back({std::string(name), column});
    return found->second;
  }

  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t depth_ = 0;
  Expression expression_;
  std::map<std::string_view, std::uint32_t> indices_;
  std::optional<ExpressionError> error_;
};

std::variant<Expression, ExpressionError> Expression::parse(std::string_view text) {
  return ExpressionParser(text).parse();
}

// ---- Evaluation -------------------------------------------------------------------------------

namespace {

// Result of an operation: a number, or the reason why there is none.
using Outcome = std::variant<double, std::string>;

std::string overflow(const std::string& operation) { return operation + " overflows"; }

Outcome raise(double base, double exponent) {
  const auto operation = [&] { return operand(base) + " ^ " + operand(exponent); };
  if (base == 0.0 && exponent < 0.0) return operation() + " is a division by zero";
  if (base < 0.0 && std::floor(exponent) != exponent) {
    return operation() + ": a negative number has no real power with a fractional exponent";
  }
  const double result = rounded_power(base, exponent);
  if (!std::isfinite(result)) return overflow(operation());
  return result;
}

Outcome combine(Expression::Op op, double a, double b) {
  double result = 0.0;
  const char* symbol = "";
  switch (op) {
    case Expression::Op::add:
      result = a + b;
      symbol = " + ";
      break;
    case Expression::Op::subtract:
      result = a - b;
      symbol = " - ";
      break;
    case Expression::Op::multiply:
      result = a * b;
      symbol = " * ";
      break;
    case Expression::Op::divide:
      if (b == 0.0) return operand(a) + " / " + operand(b) + " is a division by zero";
      result = a / b;
      symbol = " / ";
      break;
    default:
      return raise(a, b);
  }
  if (!std::isfinite(result)) return overflow(operand(a) + symbol + operand(b));
  return result;
}

Outcome call_function(const ExpressionFunction& function, std::span<const double> arguments) {
  const double x = arguments[0];
  const auto refuse = [&](const std::string& why) {
    return std::string(function.name) + '(' + written(x) + ')' + why;
  };
  if (std::fabs(x) >= kLargestAngle &&
      (function.id == FunctionId::sin || function.id == FunctionId::cos ||
       function.id == FunctionId::tan)) {
    return refuse(": the argument exceeds 2^50 periods, where a double has no phase left");
  }
  if (std::fabs(x) > 1.0 && (function.id == FunctionId::asin || function.id == FunctionId::acos)) {
    return refuse(": the argument is outside [-1, 1]");
  }
  switch (function.id) {
    case FunctionId::sqrt:
      if (x < 0.0) return refuse(": a negative number has no real square root");
      return std::sqrt(x);
    case FunctionId::exp: {
      const double result = rounded_exp(x);
      if (!std::isfinite(result)) return overflow(refuse(""));
      return result;
    }
    case FunctionId::log:
      if (x <= 0.0) return refuse(": only positive numbers have a logarithm");
      return rounded_log(x);
    case FunctionId::sin:
      return rounded_sin(x);
    case FunctionId::cos:
      return rounded_cos(x);
    case FunctionId::tan:
      return rounded_tan(x);
    case FunctionId::asin:
      return rounded_asin(x);
    case FunctionId::acos:
      return rounded_acos(x);
    case FunctionId::atan:
      return rounded_atan2(x, 1.0);
    case FunctionId::atan2:
      if (x == 0.0 && arguments[1] == 0.0) return "atan2(0, 0): the origin has no angle";
      return rounded_atan2(x, arguments[1]);
    case FunctionId::abs:
      return std::fabs(x);
    case FunctionId::min:
      return *std::min_element(arguments.begin(), arguments.end());
    case FunctionId::max:
      return *std::max_element(arguments.begin(), arguments.end());
    case FunctionId::floor:
      return std::floor(x);
    case FunctionId::tanh:
      return rounded_tanh(x);
    case FunctionId::sinh:
    case FunctionId::cosh: {
      const double result = function.id == FunctionId::sinh ? rounded_sinh(x) : rounded_cosh(x);
      if (!std::isfinite(result)) return overflow(refuse(""));
      return result;
    }
    case FunctionId::sign:
      return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0);
    case FunctionId::step:
      return x < 0.0 ? 0.0 : 1.0;
    case FunctionId::random:
    case FunctionId::normal:
      for (const double argument : arguments) {
        if (argument < 0.0 || argument > kLargestCount || argument != std::floor(argument)) {
          return refuse(": seed and number are integers from 0 on");
        }
      }
      return drawn(function.id, x, arguments[1]);
  }
  return refuse(" is not implemented");
}

}  // namespace

std::variant<double, ExpressionError> Expression::evaluate(const Lookup& lookup) const {
  // Prescribed motions are evaluated in every step: no allocation for expressions of usual size.
  boost::container::small_vector<double, kUsualDepth> stack;
  for (const Node& node : nodes_) {
    Outcome outcome;
    FaultCode code = FaultCode::expression_not_finite;
    switch (node.op) {
      case Op::number:
      case Op::pi:
        outcome = node.number;
        break;
      case Op::name: {
        const std::string& name = names_[node.index].name;
        const std::optional<double> value = lookup(name);
        if (!value) {
          code = FaultCode::expression_unknown_name;
          outcome = "unknown name " + in_quotes(name);
        } else if (!std::isfinite(*value)) {
          outcome = in_quotes(name) + " is not finite";
        } else {
          outcome = *value;
        }
        break;
      }
      case Op::negate:
        outcome = -stack.back();
        break;
      case Op::call:
        outcome = call_function(kFunctions[node.index],
                                {stack.data() + stack.size() - node.arguments, node.arguments});
        break;
      default:
        outcome = combine(node.op, *(stack.end() - 2), stack.back());
    }
    if (const std::string* why = std::get_if<std::string>(&outcome)) {
      return ExpressionError{.column = node.column, .why = *why, .code = code};
    }
    stack.erase(stack.end() - node.arguments, stack.end());
    stack.push_back(std::get<double>(outcome));
  }
  return stack.back();
}

Expression Expression::part(std::size_t step) const {
  std::size_t first = step + 1;
  for (std::size_t missing = 1; missing > 0;) missing = missing - 1 + nodes_[--first].arguments;
  Expression result;
  std::map<std::uint32_t, std::uint32_t> indices;
  for (std::size_t k = first; k <= step; ++k) {
    Node node = nodes_[k];
    if (node.op == Op::name) {
      const auto next = static_cast<std::uint32_t>(result.names_.size());
      const auto [found, inserted] = indices.emplace(node.index, next);
      if (inserted) result.names_.push_back({names_[node.index].name, node.column});
      node.index = found->second;
    }
    result.nodes_.push_back(node);
  }
  result.text_ = result.to_string();
  return result;
}

const Expression::Node* Expression::random_call() const {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(), [](const Node& node) {
    return node.op == Op::call && is_random(kFunctions[node.index].id);
  });
  return found == nodes_.end() ? nullptr : &*found;
}

std::string Expression::to_string() const {
  // How tightly a text binds, from a sum to what needs no parentheses ever.
  enum class Binding { sum, product, sign, power, closed };
  using enum Binding;
  struct Piece {
    std::string text;
    Binding binding;
  };
  const auto at_least = [](Piece piece, Binding binding) {
    if (piece.binding >= binding) return std::move(piece.text);
    return '(' + piece.text + ')';
  };
  std::vector<Piece> stack;
  const auto pop = [&stack] {
    Piece piece = std::move(stack.back());
    stack.pop_back();
    return piece;
  };
  // The operands' least bindings keep a - (b - c) and a ^ (b ^ c) what they are.
  const auto binary = [&](const char* symbol, Binding left, Binding right, Binding result) {
    const std::string second = at_least(pop(), right);
    std::string text = at_least(pop(), left);
    text += symbol;
    text += second;
    stack.push_back({std::move(text), result});
  };
  for (const Node& node : nodes_) {
    switch (node.op) {
      case Op::number:
        stack.push_back({written(node.number), closed});
        break;
      case Op::pi:
        stack.push_back({std::string(kPi), closed});
        break;
      case Op::name:
        stack.push_back({names_[node.index].name, closed});
        break;
      case Op::negate:
        stack.push_back({'-' + at_least(pop(), sign), sign});
        break;
      case Op::add:
        binary(" + ", sum, product, sum);
        break;
      case Op::subtract:
        binary(" - ", sum, product, sum);
        break;
      case Op::multiply:
        binary(" * ", product, sign, product);
        break;
      case Op::divide:
        binary(" / ", product, sign, product);
        break;
      case Op::power:
        binary("^", closed, sign, power);
        break;
      case Op::call: {
        std::string text = std::string(kFunctions[node.index].name) + '(';
        const std::size_t first = stack.size() - node.arguments;
        for (std::size_t i = first; i < stack.size(); ++i) {
          if (i > first) text += ", ";
          text += stack[i].text;
        }
        stack.resize(first);
        stack.push_back({text + ')', closed});
        break;
      }
    }
  }
  return stack.back().text;
}

}  // namespace tomlin
