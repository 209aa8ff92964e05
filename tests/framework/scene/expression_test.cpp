#include <algorithm>
#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <locale>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/parameter_table.hpp"

namespace tomlin {
namespace {

using Values = std::map<std::string, double, std::less<>>;

Expression::Lookup lookup_in(const Values& values) {
  return [&values](std::string_view name) -> std::optional<double> {
    const auto found = values.find(name);
    if (found == values.end()) return std::nullopt;
    return found->second;
  };
}

Expression parsed(const std::string& text) {
  auto result = Expression::parse(text);
  if (const auto* error = std::get_if<ExpressionError>(&result)) {
    ADD_FAILURE() << text << ": column " << error->column << ": " << error->why;
    return std::get<Expression>(Expression::parse("0"));
  }
  return std::get<Expression>(std::move(result));
}

std::variant<double, ExpressionError> outcome(const std::string& text, const Values& values = {}) {
  auto result = Expression::parse(text);
  if (auto* error = std::get_if<ExpressionError>(&result)) return *error;
  return std::get<Expression>(result).evaluate(lookup_in(values));
}

double value(const std::string& text, const Values& values = {}) {
  const auto result = outcome(text, values);
  if (const auto* error = std::get_if<ExpressionError>(&result)) {
    ADD_FAILURE() << text << ": column " << error->column << ": " << error->why;
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::get<double>(result);
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// Distance in units of the last place, for finite numbers of one sign.
std::uint64_t ulps(double a, double b) {
  return bits(a) > bits(b) ? bits(a) - bits(b) : bits(b) - bits(a);
}

TEST(Expression, PrecedenceAndAssociativity) {
  const std::vector<std::pair<std::string, double>> table{
      {"1 + 2 * 3", 7},
      {"(1 + 2) * 3", 9},
      {"10 - 4 - 3", 3},
      {"10 - (4 - 3)", 9},
      {"48 / 4 / 3", 4},
      {"48 / (4 / 2)", 24},
      {"12 / 2 * 3", 18},
      {"2 * 3 ^ 2", 18},
      {"2 ^ 3 ^ 2", 512},
      {"(2 ^ 3) ^ 2", 64},
      {"-2^2", -4},
      {"(-2)^2", 4},
      {"2^-1", 0.5},
      {"2^-2^2", 0.0625},
      {"-2^-2", -0.25},
      {"--2", 2},
      {"-+-2", 2},
      {"+2 - -2", 4},
      {"3 * -2", -6},
      {"8 / -2 ^ 2", -2},
      {"1 - 2 + 3", 2},
      {"2 + 3 ^ 2 * 2", 20},
      {"-1 + 2", 1},
      {"-2 * 3", -6},
      {"((((7))))", 7},
      {" \t2\n*\r3 ", 6},
      {"min(1, 2) + max(3, 4) * 2", 9},
      {"atan2(1, 1) * 4 - pi", 0},
      {"2 * (3 + 4) ^ 2 / 7", 14},
  };
  for (const auto& [text, expected] : table) EXPECT_EQ(value(text), expected) << text;
}

TEST(Expression, Numbers) {
  EXPECT_EQ(value("1"), 1.0);
  EXPECT_EQ(value("1."), 1.0);
  EXPECT_EQ(value(".5"), 0.5);
  EXPECT_EQ(value("0.1"), 0.1);
  EXPECT_EQ(value("6.02214076e23"), 6.02214076e23);
  EXPECT_EQ(value("1E-3"), 1e-3);
  EXPECT_EQ(value("1e+3"), 1e3);
  EXPECT_EQ(value("5e-324"), 5e-324);
  EXPECT_EQ(value("1.7976931348623157e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(value("9007199254740993"), 9007199254740992.0);
  EXPECT_EQ(value("pi"), std::numbers::pi);
}

TEST(Expression, EveryFunction) {
  const std::vector<std::pair<std::string, double>> table{
      {"sqrt(2)", std::numbers::sqrt2},
      {"exp(0)", 1},
      {"exp(1)", std::numbers::e},
      {"log(1)", 0},
      {"log(2)", std::numbers::ln2},
      {"log(10)", std::numbers::ln10},
      {"sin(0)", 0},
      {"sin(pi / 2)", 1},
      {"cos(0)", 1},
      {"cos(pi)", -1},
      {"tan(0)", 0},
      {"asin(1)", std::numbers::pi / 2},
      {"asin(-1)", -std::numbers::pi / 2},
      {"acos(1)", 0},
      {"acos(0)", std::numbers::pi / 2},
      {"acos(-1)", std::numbers::pi},
      {"atan(1)", std::numbers::pi / 4},
      {"atan(-1)", -std::numbers::pi / 4},
      {"atan(1e300)", std::numbers::pi / 2},
      {"atan2(1, 0)", std::numbers::pi / 2},
      {"atan2(-1, 0)", -std::numbers::pi / 2},
      {"atan2(0, -1)", std::numbers::pi},
      {"atan2(0, 1)", 0},
      {"atan2(1, -1)", 3 * std::numbers::pi / 4},
      {"abs(-3)", 3},
      {"abs(3)", 3},
      {"min(2, 1)", 1},
      {"min(3, 1, 2)", 1},
      {"max(2, 1)", 2},
      {"max(1, 3, 2, -5)", 3},
      {"floor(1.5)", 1},
      {"floor(-1.5)", -2},
      {"floor(7)", 7},
      {"tanh(0)", 0},
      {"tanh(1e3)", 1},
      {"tanh(-1e3)", -1},
      {"sinh(0)", 0},
      {"cosh(0)", 1},
      {"sign(-3)", -1},
      {"sign(0)", 0},
      {"sign(-0)", 0},
      {"sign(1e-300)", 1},
      {"step(-1e-300)", 0},
      {"step(0)", 1},
      {"step(-0)", 1},
      {"step(2)", 1},
      {"random(1, 0) * 0", 0},
      {"normal(1, 0) * 0", 0},
  };
  for (const auto& [text, expected] : table) EXPECT_EQ(value(text), expected) << text;

  // The table is complete.
  for (const ExpressionFunction& function : expression_functions()) {
    const std::string call = std::string(function.name) + '(';
    EXPECT_TRUE(std::any_of(table.begin(), table.end(), [&](const auto& row) {
      return row.first.starts_with(call);
    })) << call;
    EXPECT_FALSE(function.summary.empty());
    EXPECT_NE(is_reserved_name(function.name), function.may_name_parameter) << call;
  }
}

// Moments of many draws, within four standard errors.
TEST(Expression, RandomNumbersHaveTheirDistributions) {
  constexpr int kDraws = 4000;
  for (const int seed : {0, 1, 4711}) {
    double sums[6] = {};
    for (int n = 0; n < kDraws; ++n) {
      const auto draw = [&](const char* name) {
        return value(std::string(name) + "(" + std::to_string(seed) + ", " + std::to_string(n) +
                     ")");
      };
      const double u = draw("random");
      const double g = draw("normal");
      ASSERT_GT(u, 0.0);
      ASSERT_LT(u, 1.0);
      const double terms[6] = {u, u * u, g, g * g, g * g * g * g, u * g};
      for (int k = 0; k < 6; ++k) sums[k] += terms[k];
    }
    const double mean[6] = {0.5, 1.0 / 3.0, 0.0, 1.0, 3.0, 0.0};
    const double variance[6] = {1.0 / 12.0, 4.0 / 45.0, 1.0, 2.0, 96.0, 1.0 / 3.0};
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(sums[k] / kDraws, mean[k], 4.0 * std::sqrt(variance[k] / kDraws)) << seed << k;
    }
  }
  EXPECT_EQ(value("random(3, 7)"), value("random(3, 7)"));
  EXPECT_NE(value("random(3, 7)"), value("random(4, 7)"));
  EXPECT_NE(value("random(3, 7)"), value("random(3, 8)"));
  for (const char* wrong : {"random(0.5, 1)", "random(1, -1)", "normal(1, 1e300)", "random(1)"}) {
    const auto parsed = Expression::parse(wrong);
    const auto* expression = std::get_if<Expression>(&parsed);
    if (expression == nullptr) continue;  // one argument is too few
    const auto result =
        expression->evaluate([](std::string_view) { return std::optional<double>(); });
    EXPECT_TRUE(std::holds_alternative<ExpressionError>(result)) << wrong;
  }
}

TEST(Expression, BitsOfArithmeticAreThoseOfDoubles) {
  EXPECT_EQ(bits(value("2 * sqrt(2)")), bits(2 * std::sqrt(2.0)));
  EXPECT_EQ(bits(value("0.1 + 0.2")), bits(0.1 + 0.2));
  EXPECT_EQ(bits(value("1 / 3")), bits(1.0 / 3.0));
  // Not contracted to a fused multiply-add, which would give another number.
  EXPECT_EQ(value("0.1 * 10 - 1"), 0.0);
  EXPECT_EQ(bits(value("-0")), bits(-0.0));
}

// Expected bits from an independent program (mpmath, 1400 bits, rounded exactly).
TEST(Expression, FunctionsAreRoundedCorrectly) {
  const std::vector<std::pair<std::string, double>> table{
      {"10^-3", 1e-3},
      {"10^-300", 1e-300},
      {"10^22", 1e22},
      {"10^300", 1e300},
      {"10^-320", 1e-320},
      {"2^-1074", 5e-324},
      {"2^-1075", 0.0},
      {"3 * 2^-1074 / 2", 1e-323},
      {"2^1023", 0x1p1023},
      {"4^0.5", 2.0},
      {"27^(1/3)", 3.0},
      {"1.1^10", 0x1.4bffc0c03023ep+1},
      {"0.9^-37", 0x1.8a904f409272bp+5},
      {"(1 + 2^-52)^(2^55)", 0x1.749ea7d470c68p+11},
      {"exp(0.5)", 0x1.a61298e1e069cp+0},
      {"exp(-700)", 0x1.14f2b0fb9307fp-1010},
      {"exp(-744.5)", 5e-324},
      {"exp(-1e9)", 0.0},
      {"exp(709.78)", 0x1.fe9ce5c4c52b4p+1023},
      {"log(1 + 2^-52)", 0x1.fffffffffffffp-53},
      {"log(5e-324)", -0x1.74385446d71c3p+9},
      {"sin(pi)", 0x1.1a62633145c07p-53},
      {"sin(1e15)", 0x1.b76f88136cebap-1},
      {"cos(7074237752028439)", 0x1.29bf53f75c4d3p-2},
      {"tan(pi / 2)", 0x1.d02967c31cdb5p+53},
      {"tan(1)", 0x1.8eb245cbee3a6p+0},
      {"asin(0.5)", 0x1.0c152382d7366p-1},
      {"acos(0.999999)", 0x1.72ba46065af16p-10},
      {"atan(0.1)", 0x1.983e282e2cc4dp-4},
      {"tanh(0.1)", 0x1.983d7795f413ap-4},
      {"tanh(1e-5)", 0x1.4f8b588e06854p-17},
      {"tanh(18)", 0x1.ffffffffffffcp-1},
      {"sinh(1e-8)", 0x1.5798ee2308c3ap-27},
      {"sinh(-3)", -0x1.40926e70949aep+3},
      {"sinh(710)", 0x1.3e21a464507f9p+1023},
      {"cosh(0.1)", 0x1.0147f40224b38p+0},
      {"cosh(710.4)", 0x1.da98a7371610bp+1023},
      {"atan2(-1e-300, -1)", -std::numbers::pi},
      {"atan2(1e-300, 1e300)", 0.0},
  };
  for (const auto& [text, expected] : table) {
    EXPECT_EQ(bits(value(text)), bits(expected)) << text << " = " << std::hexfloat << value(text);
  }
  EXPECT_LE(ulps(value("sin(pi / 6)"), 0.5), 1u);
}

// Two independent implementations; ours is within half an ulp, libm within one where we know it.
TEST(Expression, FunctionsAgreeWithLibmAndEachOther) {
  std::mt19937_64 random(20240607);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 500; ++i) {
    const Values at{{"u", uniform(-1, 1)}, {"v", uniform(-1e4, 1e4)}, {"w", uniform(1e-3, 1e3)}};
    const double u = at.at("u");
    const double v = at.at("v");
    const double w = at.at("w");
    EXPECT_LE(ulps(value("exp(u)", at), std::exp(u)), 1u) << u;
    EXPECT_LE(ulps(value("log(w)", at), std::log(w)), 1u) << w;
    EXPECT_LE(ulps(value("sin(v)", at), std::sin(v)), 1u) << v;
    EXPECT_LE(ulps(value("cos(v)", at), std::cos(v)), 1u) << v;
    EXPECT_LE(ulps(value("tan(v)", at), std::tan(v)), 2u) << v;
    EXPECT_LE(ulps(value("asin(u)", at), std::asin(u)), 1u) << u;
    EXPECT_LE(ulps(value("acos(u)", at), std::acos(u)), 1u) << u;
    EXPECT_LE(ulps(value("atan(v)", at), std::atan(v)), 1u) << v;
    EXPECT_LE(ulps(value("atan2(u, v)", at), std::atan2(u, v)), 1u) << u << ' ' << v;
    EXPECT_LE(ulps(value("w ^ u", at), std::pow(w, u)), 1u) << w << ' ' << u;
    EXPECT_EQ(bits(value("w ^ 2", at)), bits(w * w)) << w;
    EXPECT_EQ(bits(value("w ^ 0.5", at)), bits(std::sqrt(w))) << w;
    EXPECT_EQ(bits(value("w ^ -1", at)), bits(1 / w)) << w;
  }
}

TEST(Expression, PowersAtTheEdges) {
  EXPECT_EQ(value("0^0"), 1.0);
  EXPECT_EQ(value("0^2"), 0.0);
  EXPECT_EQ(value("0^0.5"), 0.0);
  EXPECT_EQ(value("(-2)^3"), -8.0);
  EXPECT_EQ(value("(-2)^-3"), -0.125);
  EXPECT_EQ(value("(-1)^1e300"), 1.0);
  EXPECT_EQ(value("(-1)^9007199254740991"), -1.0);
  EXPECT_EQ(value("1^1e308"), 1.0);
  EXPECT_EQ(value("0.5^1e308"), 0.0);
  EXPECT_EQ(value("1e-300^1000"), 0.0);
}

struct WrongExpression {
  std::string text;
  std::size_t column;
  std::string part = "";  ///< of the message: what cannot be evaluated, or a number
  const char* code = "expression.syntax";
};

void expect_error(const std::variant<double, ExpressionError>& result,
                  const WrongExpression& wrong) {
  const auto* error = std::get_if<ExpressionError>(&result);
  ASSERT_NE(error, nullptr) << wrong.text;
  EXPECT_EQ(error->column, wrong.column) << wrong.text << ": " << error->why;
  EXPECT_EQ(id_of(error->code), wrong.code) << wrong.text << ": " << error->why;
  EXPECT_NE(error->why.find(wrong.part), std::string::npos) << wrong.text << ": " << error->why;
}

TEST(Expression, SyntaxErrorsHaveTheirColumnAndCode) {
  const char* const unknown = "expression.unknown_name";
  const char* const not_finite = "expression.not_finite";
  const std::vector<WrongExpression> table{
      {"", 0},
      {"   ", 0},
      {"1 +", 3},
      {"* 2", 0, "'*'"},
      {"2 * / 3", 4, "'/'"},
      {"(1 + 2", 0},
      {"2 * sin(1", 7},
      {"1 + 2)", 5, "')'"},
      {"()", 1, "')'"},
      {"2 3", 2, "'3'"},
      {"a b", 2, "'b'"},
      {"(1)(2)", 3, "'('"},
      {"2x", 0, "'2x'"},
      {"1..2", 0, "'1..2'"},
      {"1.2.3", 0, "'1.2.3'"},
      {"3 + 1e", 4, "'1e'"},
      {"0x10", 0, "'0x10'"},
      {"1_000", 0, "'1_000'"},
      {".", 0, "'.'"},
      {"1e999", 0, "'1e999'", not_finite},
      {"1e-999", 0, "'1e-999'", not_finite},
      {"1,5", 1, "','"},
      {"2 ** 3", 2, "'^'"},
      {"2 $ 3", 2, "'$'"},
      {"2 \xC3\x97 3", 2, "'\xC3\x97'"},
      {std::string("1 \0 2", 5), 2, "code 0"},
      {std::string("\0", 1), 0, "code 0"},
      {"1 + sqrt", 4, "'sqrt'"},
      {"foo(1)", 0, "'foo'", unknown},
      {"pi(2)", 0, "'pi'", unknown},
      {"1 + sin()", 4, "not 0"},
      {"sin(1, 2)", 0, "not 2"},
      {"atan2(1)", 0, "not 1"},
      {"atan2(1, 2, 3)", 0, "not 3"},
      {"min(1)", 0, "not 1"},
      {"max()", 0, "not 0"},
      {"min(1,)", 6, "')'"},
  };
  for (const WrongExpression& wrong : table) expect_error(outcome(wrong.text), wrong);
  const auto misspelt = Expression::parse("1 + sqr(2)");
  ASSERT_TRUE(std::holds_alternative<ExpressionError>(misspelt));
  EXPECT_EQ(std::get<ExpressionError>(misspelt).nearest, "sqrt");
}

TEST(Expression, ValuesAreNeverNanOrInf) {
  const char* const not_finite = "expression.not_finite";
  expect_error(outcome("1 + a * 2"), {"1 + a * 2", 4, "'a'", "expression.unknown_name"});
  const std::vector<WrongExpression> table{
      {"1 / 0", 2, "1 / 0"},
      {"0 / 0", 2, "0 / 0"},
      {"1 / (2 - 2)", 2, "1 / 0"},
      {"0 ^ -1", 2, "0 ^ (-1)"},
      {"(-8) ^ (1 / 3)", 5, "(-8)"},
      {"1e308 * 10", 6, "1e+308 * 10"},
      {"1e308 + 1e308", 6, "1e+308 + 1e+308"},
      {"-1e308 - 1e308", 7, "(-1e+308) - 1e+308"},
      {"1 / 1e-320", 2},
      {"10 ^ 309", 3, "10 ^ 309"},
      {"10 ^ 1e308", 3, "10 ^ 1e+308"},
      {"(-10) ^ 309", 6, "(-10) ^ 309"},
      {"0.5 ^ -1e308", 4, "0.5 ^ (-1e+308)"},
      {"2 + exp(710)", 4, "exp(710)"},
      {"1 + sinh(-711)", 4, "sinh(-711)"},
      {"cosh(711)", 0, "cosh(711)"},
      {"exp(1e308)", 0, "exp(1e+308)"},
      {"sqrt(-1)", 0, "sqrt(-1)"},
      {"1 + log(0)", 4, "log(0)"},
      {"log(-2)", 0, "log(-2)"},
      {"asin(1.5)", 0, "[-1, 1]"},
      {"acos(-2)", 0, "[-1, 1]"},
      {"atan2(0, 0)", 0, "atan2(0, 0)"},
      {"sin(1e300)", 0, "sin(1e+300)"},
      {"cos(2^53)", 0, "cos("},
      {"tan(-1e17)", 0, "tan(-1e+17)"},
  };
  for (WrongExpression wrong : table) {
    wrong.code = not_finite;
    expect_error(outcome(wrong.text), wrong);
  }
  for (const double bad :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const auto result = outcome("2 * a", {{"a", bad}});
    ASSERT_TRUE(std::holds_alternative<ExpressionError>(result));
    EXPECT_EQ(std::get<ExpressionError>(result).column, 4u);
  }
}

TEST(Expression, NamesAreListedOnceWithTheirColumn) {
  const Expression expression = parsed("k * R + sin(theta) / k + pi + _x1");
  const std::vector<Expression::Name> expected{{"k", 0}, {"R", 4}, {"theta", 12}, {"_x1", 30}};
  EXPECT_EQ(expression.names(), expected);
  EXPECT_EQ(expression.text(), "k * R + sin(theta) / k + pi + _x1");
  EXPECT_TRUE(parsed("2 * pi").names().empty());
  EXPECT_EQ(value("Pi + pI", {{"Pi", 1}, {"pI", 2}}), 3.0);  // case matters
}

TEST(Expression, Limits) {
  const auto nested = [](std::size_t depth, const std::string& open, const std::string& close) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) text += open;
    text += '1';
    for (std::size_t i = 0; i < depth; ++i) text += close;
    return text;
  };
  const std::size_t depth = Expression::kMaxDepth;
  EXPECT_EQ(value(nested(depth, "(", ")")), 1.0);
  EXPECT_EQ(value(nested(depth, "abs(", ")")), 1.0);
  EXPECT_EQ(value(nested(depth, "-", "")), 1.0);
  EXPECT_EQ(value(nested(depth, "1^", "")), 1.0);
  for (const auto& [open, close] :
       std::vector<std::pair<std::string, std::string>>{{"(", ")"}, {"-", ""}, {"1^", ""}}) {
    const auto result = Expression::parse(nested(depth + 1, open, close));
    ASSERT_TRUE(std::holds_alternative<ExpressionError>(result)) << open;
    const auto& error = std::get<ExpressionError>(result);
    EXPECT_EQ(error.code, FaultCode::scene_too_large);
    EXPECT_NE(error.why.find("200"), std::string::npos);
  }
  const auto deep = Expression::parse(std::string(9999, '('));
  ASSERT_TRUE(std::holds_alternative<ExpressionError>(deep));
  EXPECT_EQ(std::get<ExpressionError>(deep).column, depth);
  const auto deeper = Expression::parse(nested(10000, "(", ")"));
  ASSERT_TRUE(std::holds_alternative<ExpressionError>(deeper));
  EXPECT_EQ(std::get<ExpressionError>(deeper).code, FaultCode::scene_too_large);
  EXPECT_NE(std::get<ExpressionError>(deeper).why.find("10000"), std::string::npos);

  // Long is not deep.
  std::string sum = "1";
  while (sum.size() + 2 <= Expression::kMaxLength) sum += "+1";
  EXPECT_EQ(value(sum), static_cast<double>(sum.size() / 2 + 1));
  EXPECT_EQ(value(parsed("0" + sum.substr(1, 4000)).to_string()), 2000.0);
  sum += std::string(Expression::kMaxLength - sum.size(), ' ');
  EXPECT_TRUE(std::holds_alternative<Expression>(Expression::parse(sum)));
  EXPECT_TRUE(std::holds_alternative<ExpressionError>(Expression::parse(sum + ' ')));
  EXPECT_TRUE(
      std::holds_alternative<ExpressionError>(Expression::parse(std::string(1000000, '-'))));
}

// Decimal comma and grouped digits, in C and in C++.
class CommaPunctuation : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Expression, LocaleDoesNotMatter) {
  const std::string c_locale = std::setlocale(LC_ALL, nullptr);
  const std::locale cpp_locale;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
  EXPECT_EQ(value("1.5 + 1234.25"), 1235.75);
  EXPECT_EQ(parsed("1234567.5").to_string(), "1234567.5");
  EXPECT_TRUE(std::holds_alternative<ExpressionError>(Expression::parse("1,5")));
  const auto error = outcome("sqrt(0 - 1234.5)");
  EXPECT_NE(std::get<ExpressionError>(error).why.find("sqrt(-1234.5)"), std::string::npos);
  std::locale::global(cpp_locale);
  std::setlocale(LC_ALL, c_locale.c_str());
}

TEST(Expression, PrintsFewestParentheses) {
  const std::vector<std::pair<std::string, std::string>> table{
      {"1+2*3", "1 + 2 * 3"},
      {"(1+2)*3", "(1 + 2) * 3"},
      {"(1-2)-3", "1 - 2 - 3"},
      {"1-(2-3)", "1 - (2 - 3)"},
      {"1/(2/3)", "1 / (2 / 3)"},
      {"2^3^2", "2^3^2"},
      {"(2^3)^2", "(2^3)^2"},
      {"2^(3^2)", "2^3^2"},
      {"-(2^2)", "-2^2"},
      {"(-2)^2", "(-2)^2"},
      {"2^(-1)", "2^-1"},
      {"-(a+b)", "-(a + b)"},
      {"(-a)*b", "-a * b"},
      {"a*(-b)", "a * -b"},
      {"- -a", "--a"},
      {"+a", "a"},
      {"max( 1,(2+3) ,pi)", "max(1, 2 + 3, pi)"},
      {"0.10", "0.1"},
  };
  for (const auto& [text, printed] : table) {
    EXPECT_EQ(parsed(text).to_string(), printed);
    EXPECT_EQ(parsed(printed).to_string(), printed);
  }
}

// A random expression over a and b, every operation parenthesised.
std::string random_text(std::mt19937_64& random, int depth) {
  const auto pick = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  if (depth == 0 || pick(6) == 0) {
    const std::vector<std::string> leaves{"a", "b", "pi", "2", "0.1", "3", "1e-3", ".75"};
    return leaves[pick(leaves.size())];
  }
  const std::string one = random_text(random, depth - 1);
  switch (pick(4)) {
    case 0:
      return "(-" + one + ')';
    case 1: {
      const ExpressionFunction& function = expression_functions()[pick(19)];
      std::string text = std::string(function.name) + '(' + one;
      for (std::size_t i = 1; i < function.fewest_arguments; ++i) {
        text += ',' + random_text(random, depth - 1);
      }
      return text + ')';
    }
    default: {
      const std::string operators = "+-*/^";
      return '(' + one + operators[pick(5)] + random_text(random, depth - 1) + ')';
    }
  }
}

TEST(Expression, PrintingRoundTrips) {
  const Values at{{"a", 0.7}, {"b", -1.3}};
  std::mt19937_64 random(7);
  int numbers = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = random_text(random, 5);
    const Expression first = parsed(text);
    const std::string printed = first.to_string();
    const Expression second = parsed(printed);
    EXPECT_EQ(second.to_string(), printed) << text;
    ASSERT_EQ(second.nodes().size(), first.nodes().size()) << text;
    const auto a = first.evaluate(lookup_in(at));
    const auto b = second.evaluate(lookup_in(at));
    ASSERT_EQ(a.index(), b.index()) << text;
    if (const double* x = std::get_if<double>(&a)) {
      EXPECT_EQ(bits(*x), bits(std::get<double>(b))) << text;
      EXPECT_TRUE(std::isfinite(*x)) << text;
      ++numbers;
    }
  }
  EXPECT_GT(numbers, 300);  // it did compare something
}

// Anything at all: an answer or an error inside the text, no crash.
TEST(Expression, AnyBytesAreAnswered) {
  std::mt19937_64 random(11);
  const std::string alphabet = "0123456789.eE+-*/^(),absqrtminpx \t\n_\\\"\x80\xC3\xFF";
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (std::uint64_t n = random() % 24; n > 0; --n) text += alphabet[random() % alphabet.size()];
    const auto result = Expression::parse(text);
    if (const auto* error = std::get_if<ExpressionError>(&result)) {
      EXPECT_LE(error->column, text.size());
      EXPECT_FALSE(error->why.empty());
    }
  }
}

TEST(Expression, Names) {
  EXPECT_TRUE(is_identifier("k_wh"));
  EXPECT_TRUE(is_identifier("_0"));
  EXPECT_FALSE(is_identifier(""));
  EXPECT_FALSE(is_identifier("0a"));
  EXPECT_FALSE(is_identifier("a-b"));
  EXPECT_FALSE(is_identifier("\xC3\xBC"));
  for (const char* name : {"pi", "sin", "floor", "x", "vz", "zc", "r", "theta", "t"}) {
    EXPECT_TRUE(is_reserved_name(name)) << name;
  }
  for (const char* name : {"R", "T", "X", "k", "lambda", "Sin"}) {
    EXPECT_FALSE(is_reserved_name(name)) << name;
  }
  EXPECT_EQ(expression_variables().size(), 12u);
}

TEST(Expression, PartsAreExpressionsOfTheirOwn) {
  const Expression whole = parsed("2*a + random(b, a - b)^-c");
  std::vector<std::string> parts;
  for (std::size_t step = 0; step < whole.nodes().size(); ++step) {
    const Expression part = whole.part(step);
    parts.push_back(part.to_string());
    EXPECT_EQ(part.text(), parts.back());
    EXPECT_EQ(part.nodes().back().column, whole.nodes()[step].column);
    EXPECT_EQ(parsed(part.text()).names().size(), part.names().size());
  }
  EXPECT_EQ(parts, (std::vector<std::string>{"2", "a", "2 * a", "b", "a", "b", "a - b",
                                             "random(b, a - b)", "c", "-c", "random(b, a - b)^-c",
                                             "2 * a + random(b, a - b)^-c"}));
}

// Younger than scenes whose parameters have their names.
TEST(Expression, SomeFunctionsShareTheirNamesWithParameters) {
  const Values at{{"step", 3}, {"sign", 5}, {"tanh", 7}, {"sinh", 0.5}, {"cosh", 2}};
  EXPECT_EQ(value("step * sign - tanh + sinh / cosh", at), 8.25);
  EXPECT_EQ(value("step(step - 4) + sign(sign) * step", at), 3.0);
  EXPECT_EQ(value("sign (-2) * cosh", at), -2.0);
  EXPECT_EQ(parsed("step + step(1)").to_string(), "step + step(1)");
  expect_error(outcome("tanh()"), {"tanh()", 0, "not 0"});
  expect_error(outcome("floor + 1"), {"floor + 1", 0, "'floor'"});

  ParameterTable table;
  for (const auto& [name, number] : at) table.add(name, number);
  table.add("floor", 1.0);
  table.resolve();
  ASSERT_EQ(table.faults().size(), 1u);
  EXPECT_EQ(table.faults().front().parameter, "floor");
}

// ---- Parameters ----

TEST(ParameterTable, ResolvesInAnyOrder) {
  ParameterTable table;
  table.add("xi", "2 * sqrt(k)");
  table.add("k", "k0 + 1");
  table.add("k0", 1);
  table.add("alone", "pi");
  ASSERT_TRUE(table.resolve());
  EXPECT_EQ(table.value("k"), 2.0);
  EXPECT_EQ(table.value("xi"), 2 * std::sqrt(2.0));
  EXPECT_EQ(table.value("alone"), std::numbers::pi);
  EXPECT_EQ(table.value("K"), std::nullopt);
  ASSERT_EQ(table.values().size(), 4u);
  EXPECT_EQ(table.values()[2], (std::pair<std::string, double>{"k0", 1.0}));
}

TEST(ParameterTable, CyclesAreNamed) {
  ParameterTable table;
  table.add("user", "b + 1");  // depends on a cycle: not a fault of its own
  table.add("a", "2 * b");
  table.add("b", "c");
  table.add("c", "1 + a");
  table.add("self", "self^2");
  table.add("fine", "2");
  EXPECT_FALSE(table.resolve());
  ASSERT_EQ(table.faults().size(), 2u);
  EXPECT_EQ(table.faults()[0].parameter, "a");
  EXPECT_EQ(table.faults()[0].column, 4u);
  EXPECT_EQ(table.faults()[0].code, FaultCode::expression_cycle);
  EXPECT_NE(table.faults()[0].why.find("a -> b -> c -> a"), std::string::npos);
  EXPECT_EQ(table.faults()[1].parameter, "self");
  EXPECT_EQ(table.faults()[1].column, 0u);
  EXPECT_NE(table.faults()[1].why.find("self -> self"), std::string::npos);
  EXPECT_EQ(table.value("fine"), 2.0);
  EXPECT_EQ(table.value("user"), std::nullopt);

  ParameterTable two;
  two.add("a", "b");
  two.add("b", "a");
  EXPECT_FALSE(two.resolve());
  ASSERT_EQ(two.faults().size(), 1u);
  EXPECT_NE(two.faults()[0].why.find("a -> b -> a"), std::string::npos);
}

TEST(ParameterTable, LongChainsAndCyclesAreNoProblem) {
  constexpr int kLength = 20000;
  ParameterTable chain;
  ParameterTable cycle;
  for (int i = 0; i < kLength; ++i) {
    for (ParameterTable* table : {&chain, &cycle}) {
      table->add("p" + std::to_string(i), "p" + std::to_string(i + 1) + " + 1");
    }
  }
  chain.add("p" + std::to_string(kLength), 0);
  ASSERT_TRUE(chain.resolve());
  EXPECT_EQ(chain.value("p0"), static_cast<double>(kLength));
  cycle.add("p" + std::to_string(kLength), "p0");
  EXPECT_FALSE(cycle.resolve());
  ASSERT_EQ(cycle.faults().size(), 1u);
  EXPECT_LT(cycle.faults()[0].why.size(), 300u);
  EXPECT_NE(cycle.faults()[0].why.find("20001"), std::string::npos);
}

TEST(ParameterTable, ShadowingAndBadNames) {
  for (const char* name : {"sin", "max", "pi", "x",     "y", "z", "vx", "vy",  "vz",  "xc",
                           "yc",  "zc",  "r",  "theta", "t", "",  "2a", "a b", "a-b", "\xCE\xBB"}) {
    ParameterTable table;
    table.add(name, 1.0);
    EXPECT_FALSE(table.resolve()) << name;
    ASSERT_EQ(table.faults().size(), 1u) << name;
    EXPECT_EQ(table.faults()[0].part, ParameterFault::Part::name);
    EXPECT_EQ(table.faults()[0].code, FaultCode::scene_invalid_name);
    EXPECT_EQ(table.faults()[0].parameter, name);
  }
}

TEST(ParameterTable, AllFaultsTogether) {
  ParameterTable table;
  table.add("lambda", 1.0);                                  // 0
  table.add("decay", "lamda / Rr");                          // 1: two names
  table.add("theta", "1 / 0");                               // 2: name and value
  table.add("broken", "2 * (1");                             // 3
  table.add("user", "broken + decay");                       // 4: follows, not repeated
  table.add("R", std::numeric_limits<double>::quiet_NaN());  // 5
  table.add("speed", "sqrt(0 - lambda)");                    // 6
  table.add("moving", "2 * x");                              // 7
  table.add("R", 2.0);                                       // 8: again
  table.add("good", "2 * lambda");                           // 9
  EXPECT_FALSE(table.resolve());

  std::vector<std::pair<std::string, std::size_t>> found;
  for (const ParameterFault& fault : table.faults())
    found.emplace_back(fault.parameter, fault.column);
  const std::vector<std::pair<std::string, std::size_t>> expected{
      {"decay", 0}, {"decay", 8}, {"theta", 0},  {"theta", 2}, {"broken", 4},
      {"R", 0},     {"speed", 0}, {"moving", 4}, {"R", 0}};
  EXPECT_EQ(found, expected);
  EXPECT_EQ(table.faults()[0].nearest, "lambda");
  EXPECT_EQ(table.faults()[1].nearest, "");
  EXPECT_EQ(table.faults()[7].code, FaultCode::expression_unknown_name);

  EXPECT_EQ(table.faults()[2].part, ParameterFault::Part::name);
  EXPECT_EQ(table.faults()[3].part, ParameterFault::Part::value);
  EXPECT_EQ(table.faults()[8].entry, 8u);
  EXPECT_EQ(table.value("good"), 2.0);
}

TEST(ParameterTable, EvaluatesOtherKeys) {
  ParameterTable table;
  table.add("N", 8);
  table.add("stiffness", 2);
  table.add("bad", "1 / 0");
  EXPECT_FALSE(table.resolve());
  EXPECT_EQ(std::get<double>(table.evaluate("1 / N")), 0.125);

  const auto undefined = std::get<ExpressionError>(table.evaluate("2 * stifness"));
  EXPECT_EQ(undefined.column, 4u);
  EXPECT_EQ(undefined.nearest, "stiffness");
  EXPECT_FALSE(undefined.consequence);
  EXPECT_TRUE(std::get<ExpressionError>(table.evaluate("2 * bad")).consequence);
  EXPECT_FALSE(std::get<ExpressionError>(table.evaluate("bad + unknown")).consequence);
  EXPECT_EQ(std::get<ExpressionError>(table.evaluate("t")).code,
            FaultCode::expression_unknown_name);
  EXPECT_EQ(std::get<ExpressionError>(table.evaluate("N / (4 - N / 2)")).column, 2u);
  EXPECT_EQ(std::get<ExpressionError>(table.evaluate("N +")).column, 3u);
}

TEST(NearestName, OnlyWhenReasonablyClose) {
  const std::vector<std::string> names{
      "stiffness", "velocity", "period", "decay", "k", "R", "xi", "rk4", "sinusoidal_substrate"};
  const std::vector<std::pair<std::string, std::string>> near{
      {"stifness", "stiffness"},
      {"stiffnes", "stiffness"},
      {"Velocity", "velocity"},
      {"velocty", "velocity"},
      {"perido", "period"},
      {"decai", "decay"},
      {"r", "R"},
      {"ix", "xi"},
      {"rk", "rk4"},
      {"sinusoidal", "sinusoidal_substrate"},
      {"rk5", "rk4"},
      {"stiff", "stiffness"},
      {"q", ""},
      {"y", ""},
      {"mass", ""},
      {"", ""},
      {"completely_other", ""}};
  for (const auto& [name, expected] : near) {
    EXPECT_EQ(nearest_name(name, names).value_or(""), expected) << name;
  }
  EXPECT_EQ(nearest_name("abd", {"abc", "abe"}), "abc");  // the first of equals
  EXPECT_EQ(nearest_name("bodies", {"box", "body"}), "body");
  EXPECT_EQ(nearest_name("mass", {"radius", "particle_mass"}), "particle_mass");
  EXPECT_EQ(nearest_name("damping", {"viscous_damping", "memory_damping"}), std::nullopt);
  EXPECT_EQ(nearest_name("mas", {"radius", "particle_mass"}), std::nullopt);
  EXPECT_EQ(nearest_name("K", {"x", "k"}), "k");
  EXPECT_EQ(nearest_name("a", {}), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), {std::string(100000, 'b')}), std::nullopt);
}

}  // namespace
}  // namespace tomlin
