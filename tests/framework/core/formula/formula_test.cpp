#include "framework/core/formula/formula.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/formula/formula_force.hpp"
#include "framework/core/formula/graph.hpp"
#include "framework/core/formula/program.hpp"

// Formulas as graphs, their derivatives and their code, without any force around them.

namespace tomlin {
namespace {

constexpr std::array<std::uint64_t, 3> kSeeds = {20240611, 7, 424242};

/// Every operation and function, in forms that simplification touches.
const std::vector<std::string>& formulas() {
  static const std::vector<std::string> all = {
      "x",
      "3",
      "2*x - 3*y + 1",
      "x - x + y",
      "-(x - y)*4/2",
      "x*y/(x*y)",
      "(x + y)*(x - y)",
      "(x^2)^0.5",
      "sqrt(x)*sqrt(x)",
      "x^3*y^-2",
      "x^7 - y^5 + x^64",
      "x^1.5 + 2^x + x^y",
      "0.5*3.5*(x - 1.25)^2",
      "exp(-0.7*y^2)*cos(2*pi*x/1.3)",
      "sin(2*pi*x + 0.3)*cos(2*pi*x + 0.3)",
      "sin(cos(x))/tan(x)",
      "log(x/y) + exp(x)*exp(y)",
      "asin(x/5) + acos(y/5) - atan(x*y)",
      "atan2(y, x) + atan2(x - 3, y)",
      "abs(x - y) + abs(y - x)^3",
      "min(x, y, x*y) - max(x^2, y)",
      "floor(3*x) + floor(-y)",
      "tanh(x - y) + sinh(0.5*x) - cosh(y/2)",
      "tanh(3*x*t)^2*sinh(x)/cosh(y)",
      "sign(x - y)*x + step(y - x)*y^2",
      "1.7*(1 - exp(-1.2*(x - 1)))^2",
      "4*0.3*((0.9/x)^12 - (0.9/x)^6)",
      "(y - x)/(1 + x^2 + y^2)^1.5",
      "x/(y/(x/(y + 1)))",
      "cos(x*t) + t^2*y",
  };
  return all;
}

Expression parsed(const std::string& text) { return std::get<Expression>(Expression::parse(text)); }

constexpr std::uint32_t kT = formula_variable::time;

/// A graph with one formula over x, y and t.
struct Built {
  explicit Built(const std::string& text) {
    FormulaGraph::Lookup names = {
        {"x", graph.variable(0)}, {"y", graph.variable(1)}, {"t", graph.variable(kT)}};
    root = graph.build(parsed(text), names);
  }
  Quad at(FormulaGraph::Id node, Quad x, Quad y, Quad t) const {
    std::vector<Quad> values(formula_variable::particle_number, Quad(0.0));
    values[0] = x;
    values[1] = y;
    values[kT] = t;
    return graph.value(node, values);
  }
  FormulaGraph graph;
  FormulaGraph::Id root = 0;
};

double value_of(const std::string& text, double x, double y, double t) {
  const auto outcome = parsed(text).evaluate([&](std::string_view name) {
    return std::optional(name == "x" ? x : name == "y" ? y : t);
  });
  return std::holds_alternative<double>(outcome) ? std::get<double>(outcome) : std::nan("");
}

/// Positions where all of the formulas above are defined and smooth.
struct RandomPoints {
  explicit RandomPoints(std::uint64_t seed) : engine(seed) {}
  double next() { return std::uniform_real_distribution<double>(0.6, 2.9)(engine); }
  std::mt19937_64 engine;
};

/// A formula of a dozen operations, each rounded once; powers and sums of sizes up to 3^64 lose
/// relative to their largest term.
constexpr double kRounding = 1e-13;

TEST(FormulaGraph, HasTheValueOfTheExpression) {
  for (const std::string& text : formulas()) {
    SCOPED_TRACE(text);
    const Built built(text);
    for (const std::uint64_t seed : kSeeds) {
      RandomPoints points(seed);
      for (int k = 0; k < 20; ++k) {
        const double x = points.next(), y = points.next(), t = points.next();
        const double expected = value_of(text, x, y, t);
        const auto found = static_cast<double>(built.at(built.root, Quad(x), Quad(y), Quad(t)));
        EXPECT_NEAR(found, expected, kRounding * (1.0 + std::abs(expected))) << x << ' ' << y;
      }
    }
  }
}

/// In quadruple precision, a central difference with h = 1e-9 is right to h^2 = 1e-18 of a third
/// derivative; rounding takes 1e-34/h of the value.
TEST(FormulaGraph, DerivativesAreThoseOfTheValue) {
  constexpr double kStep = 1e-9;
  constexpr double kError = 1e-13;  // times sizes: the third derivative of x^64 is 2e5 times it
  for (const std::string& text : formulas()) {
    SCOPED_TRACE(text);
    Built built(text);
    for (const std::uint32_t variable : {0u, 1u, kT}) {
      const auto slope = built.graph.derivative(built.root, variable);
      for (const std::uint64_t seed : kSeeds) {
        RandomPoints points(seed);
        for (int k = 0; k < 10; ++k) {
          const std::array<Quad, 3> at = {Quad(points.next()), Quad(points.next()),
                                          Quad(points.next())};
          const auto moved = [&](double h) {
            std::array<Quad, 3> to = at;
            to[variable == kT ? 2 : variable] += Quad(h);
            return built.at(built.root, to[0], to[1], to[2]);
          };
          const auto difference =
              static_cast<double>((moved(kStep) - moved(-kStep)) / Quad(2.0 * kStep));
          const auto found = static_cast<double>(built.at(slope, at[0], at[1], at[2]));
          const auto size = static_cast<double>(abs(moved(0.0)));
          EXPECT_NEAR(found, difference, kError * (1.0 + std::abs(difference) + size));
        }
      }
    }
  }
}

TEST(FormulaGraph, SecondDerivativesAreSymmetric) {
  for (const std::string& text : formulas()) {
    SCOPED_TRACE(text);
    Built built(text);
    const auto xy = built.graph.derivative(built.graph.derivative(built.root, 0), 1);
    const auto yx = built.graph.derivative(built.graph.derivative(built.root, 1), 0);
    RandomPoints points(kSeeds[0]);
    for (int k = 0; k < 10; ++k) {
      const Quad x = points.next(), y = points.next(), t = points.next();
      const auto one = static_cast<double>(built.at(xy, x, y, t));
      const auto other = static_cast<double>(built.at(yx, x, y, t));
      EXPECT_NEAR(one, other, kRounding * (1.0 + std::abs(one)));
    }
  }
}

TEST(FormulaGraph, EqualPartsAreOneNode) {
  FormulaGraph graph;
  const FormulaGraph::Lookup names = {{"x", graph.variable(0)}, {"y", graph.variable(1)}};
  const auto node = [&](const std::string& text) { return graph.build(parsed(text), names); };
  EXPECT_EQ(node("x + y"), node("y + x"));
  EXPECT_EQ(node("2*x*3*y"), node("6*(y*x)"));
  EXPECT_EQ(node("x*x*x/x"), node("x^2"));
  EXPECT_EQ(node("x - x"), node("0"));
  EXPECT_EQ(node("cos(2*pi*x/4)"), node("cos(pi*x*0.5)"));
  EXPECT_EQ(node("-(-x)"), node("x"));
  EXPECT_NE(node("x - y"), node("y - x"));
  EXPECT_NE(node("(x^2)^0.5"), node("x"));
  // Differences keep their digits: a sum is not multiplied out.
  EXPECT_NE(node("3*(x - 1)"), node("3*x - 3"));
}

/// The corrugation with its decay needs one exponential and one sine with its cosine.
TEST(FormulaCode, SharesWhatForceAndEnergyHaveInCommon) {
  const FormulaLaw law({"A*exp(-b*y^2)*cos(2*pi*x/a)", {{"A", 0.1}, {"b", 1.0}, {"a", 1.5}}}, {});
  const FormulaCodes codes = law.compiled(2, {false, false, false});
  // x/a, its sine and cosine, y^2, -b y^2, exp, and twice two products
  EXPECT_LE(codes.force.body.size(), 10u);
  EXPECT_TRUE(codes.force.prologue.empty());
  int exponentials = 0, waves = 0;
  for (const FormulaInstruction& instruction : codes.force.body) {
    exponentials += instruction.op == FormulaOp::exponential;
    waves += instruction.op == FormulaOp::sine_and_cosine || instruction.op == FormulaOp::sine ||
             instruction.op == FormulaOp::cosine;
  }
  EXPECT_EQ(exponentials, 1);
  EXPECT_EQ(waves, 1);
}

TEST(FormulaCode, WhatOnlyChangesWithTimeIsComputedOnce) {
  const FormulaLaw law({"x*cos(3*t)*exp(-t)", {}}, {});
  const FormulaCodes codes = law.compiled(1, {false, false, false});
  EXPECT_FALSE(codes.force.prologue.empty());
  EXPECT_TRUE(codes.force.body.empty());
}

template <class Real>
struct Sets {
  static std::vector<InstructionSet> all() {
    std::vector<InstructionSet> sets = {InstructionSet::baseline};
    if constexpr (!std::is_same_v<Real, Quad>) {
      if (is_supported(InstructionSet::avx2)) sets.push_back(InstructionSet::avx2);
      if (is_supported(InstructionSet::avx512)) sets.push_back(InstructionSet::avx512);
    }
    return sets;
  }
};

template <class Real>
class FormulaKernelsOf : public ::testing::Test {};
using NumberTypes = ::testing::Types<double, Quad>;
TYPED_TEST_SUITE(FormulaKernelsOf, NumberTypes);

/// Code against the graph in quadruple precision; element by element and in blocks of every length.
TYPED_TEST(FormulaKernelsOf, HaveTheGraphsValueAndTheSameBitsInBlocks) {
  using Real = TypeParam;
  // Units of the last place of the number type; x^64 takes six squarings, each doubling the error.
  const double unit = std::is_same_v<Real, double> ? std::numeric_limits<double>::epsilon() : 1e-33;
  constexpr double kUnits = 600.0;
  constexpr std::size_t kMost = 150;  // more than two blocks
  for (const std::string& text : formulas()) {
    SCOPED_TRACE(text);
    Built built(text);
    const FormulaGraph::Id slope = built.graph.derivative(built.root, 0);
    constexpr std::uint32_t kOrigin = formula_variable::origin;
    const FormulaInputs inputs{{0, 1}, {kT, kOrigin, kOrigin + 1, kOrigin + 2}};
    const std::array<FormulaGraph::Id, 2> nodes = {built.root, slope};
    const FormulaProgram<Real> program(compile(built.graph, nodes, inputs));
    const Real start(0.25);
    RandomPoints points(kSeeds[1]);
    AlignedVector<Real> position(2 * padded(kMost), Real(0.0));
    for (Real& x : position) x = Real(points.next());
    std::vector<Real> first(2 * kMost);
    for (const InstructionSet set : Sets<Real>::all()) {
      const auto& kernels = kernels::FormulaKernels.on<Real>(set);
      for (std::size_t i = 0; i < kMost; ++i) {
        const Real at[kMostFormulaInputs] = {position[i], position[padded(kMost) + i]};
        Real found[2] = {};
        kernels.evaluate(program.view(start, true), at, 2, Real(0.5), found);
        for (std::size_t k = 0; k < 2; ++k) {
          if (set == InstructionSet::baseline) first[2 * i + k] = found[k];
          EXPECT_TRUE(first[2 * i + k] == found[k]) << "set " << static_cast<int>(set);
        }
        const Quad x(at[0]), y(at[1]);
        const auto expected = static_cast<double>(built.at(nodes[0], x, y, Quad(0.75)));
        const auto difference =
            static_cast<double>(Quad(found[0]) - built.at(nodes[0], x, y, Quad(0.75)));
        EXPECT_LE(std::abs(difference), kUnits * unit * (1.0 + std::abs(expected)));
      }
      for (const std::size_t count : {std::size_t{1}, std::size_t{8}, std::size_t{63}, kMost}) {
        AlignedVector<Real> force(2 * padded(kMost), Real(0.0));
        FormulaSiteArguments<Real> arguments;
        arguments.code = program.view(start, true);
        arguments.body.count = count;
        arguments.body.stride = padded(kMost);
        arguments.dimension = 2;
        arguments.axes = 2;
        arguments.axis[1] = 1;
        Stage<Real> stage;
        stage.position = position.data();
        stage.force = force.data();
        stage.elapsed = Real(0.5);
        kernels.site.set[0](&arguments, stage);
        for (std::size_t i = 0; i < padded(count); ++i) {
          for (std::size_t k = 0; k < 2; ++k) {
            const Real expected = i < count ? first[2 * i + k] : Real(0.0);
            EXPECT_TRUE(force[k * padded(kMost) + i] == expected) << i << " of " << count;
          }
        }
      }
    }
  }
}

TEST(FormulaLaw, SaysWhereItIsNotDefined) {
  struct Case {
    const char* text;
    double x;
    std::size_t column;
    const char* why;
  };
  const std::vector<Case> cases = {
      {"1 + log(x)", -1.0, 4, "only positive numbers"},
      {"log(x)*log(x)", -0.0, 0, "only positive numbers"},
      {"2/(x - 1)", 1.0, 1, "division by zero"},
      {"sqrt(1 - x)", 2.0, 0, "negative number"},
      {"3 + sqrt(x)", 0.0, 4, "derivative"},
      {"abs(x)^0.5", 0.0, 6, "derivative"},
      {"x^2*asin(x)", 1.5, 4, "outside [-1, 1]"},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.text);
    const FormulaLaw law({one.text, {}}, {});
    FormulaLaw::Values at{};
    at[0] = one.x;
    const auto trouble = law.trouble_at(at);
    ASSERT_TRUE(trouble.has_value());
    EXPECT_EQ(trouble->column, one.column);
    EXPECT_NE(trouble->why.find(one.why), std::string::npos) << trouble->why;
    at[0] = 0.5;
    EXPECT_FALSE(law.trouble_at(at).has_value());
  }
}

// ---- numbers of particles

TEST(FormulaLaw, TheLargestPartsThatFollowFromTheIndexAreNumbersOfParticles) {
  struct Case {
    const char* text;
    std::size_t numbers;
  };
  const std::vector<Case> cases = {
      {"x^2", 0},
      {"x*random(1, 2)/count", 0},
      {"i*x", 1},
      {"V0*(1 + 0.2*normal(7, i))*cos(x/V0 + random(3, i))", 2},
      {"x*i*normal(1, i)", 2},
      {"x*(i*normal(1, i))", 1},
      {"x*(i + 1) + x^2/(1+i) + cos(i+1)", 3},  // 1+i and i+1 are written differently
      {"-(-i)", 1},
      {"min(i, count, x)", 1},
      {"x^i^2", 1},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.text);
    const FormulaLaw law({one.text, {{"V0", 0.5}}}, {});
    EXPECT_EQ(law.particle_numbers(), one.numbers);
    EXPECT_FALSE(law.misplaced_random());
    EXPECT_EQ(law.compiled(1, {true, false, false}, 5).inputs.size(),
              one.numbers + (law.uses(formula_variable::position) ? 1 : 0));
  }
}

TEST(FormulaLaw, NumbersOfParticlesAreThoseOfTheExpression) {
  const FormulaLaw law({"x*(a*i + 1)", {{"a", 0.1}}}, {});
  const auto numbers = std::get<FormulaLaw::ParticleNumbers>(law.numbers_of_particles(4));
  ASSERT_EQ(numbers.size(), 1U);
  EXPECT_EQ(numbers[0], (std::vector<double>{1.0, 0.1 + 1.0, 0.1 * 2 + 1.0, 0.1 * 3 + 1.0}));
  const FormulaLaw wrong({}, {{{"x", {}}, {"y*(1/(i - 2))", {}}}});
  const auto trouble = std::get<FormulaLaw::Trouble>(wrong.numbers_of_particles(4));
  EXPECT_EQ(trouble.component, 1U);
  EXPECT_EQ(trouble.column, 4U);
  EXPECT_NE(trouble.why.find("particle 2"), std::string::npos) << trouble.why;
  EXPECT_TRUE(std::holds_alternative<FormulaLaw::ParticleNumbers>(wrong.numbers_of_particles(2)));
}

TEST(FormulaLaw, ParametersComeBeforeIndexAndCount) {
  const FormulaLaw law({"x*i/count", {{"i", 2.0}, {"count", 4.0}}}, {});
  EXPECT_FALSE(law.depends_on_particle());
  EXPECT_FALSE(law.uses(formula_variable::index));
  FormulaLaw::Values at{};
  at[formula_variable::position] = 3.0;
  at[formula_variable::index] = 7.0;
  EXPECT_EQ(std::get<double>(law.evaluate(0, at)), 1.5);
}

TEST(FormulaLaw, RandomNumbersOfAPositionOrATimeAreMisplaced) {
  struct Case {
    const char* text;
    std::size_t column;
  };
  for (const Case& one : {Case{"x + random(1, x)", 4}, Case{"x*normal(t, i)", 2},
                          Case{"x + i*random(1, random(i, floor(vx)))", 16}}) {
    const FormulaLaw law({one.text, {}}, {});
    ASSERT_TRUE(law.misplaced_random()) << one.text;
    EXPECT_EQ(law.misplaced_random()->column, one.column) << one.text;
  }
}

/// The derivative of a formula holds its numbers fixed, and messages know the particle.
TEST(FormulaLaw, SaysForWhichParticleItIsNotDefined) {
  const FormulaLaw law({"sqrt(x - i)", {}}, {});
  FormulaLaw::Values at{};
  at[formula_variable::count] = 5.0;
  at[formula_variable::position] = 2.0;
  at[formula_variable::index] = 1.0;
  EXPECT_FALSE(law.trouble_at(at));
  at[formula_variable::index] = 2.0;
  ASSERT_TRUE(law.trouble_at(at));
  EXPECT_NE(law.trouble_at(at)->why.find("derivative"), std::string::npos);
  at[formula_variable::index] = 3.0;
  ASSERT_TRUE(law.trouble_at(at));
  EXPECT_NE(law.trouble_at(at)->why.find("negative number"), std::string::npos);
}

TEST(FormulaLaw, MoreNumbersOfParticlesThanKernelsTakeAreTooLarge) {
  std::string text = "x";
  for (std::size_t k = 0; k <= FormulaLaw::kMostParticleNumbers; ++k) {
    text += " + x*normal(" + std::to_string(k) + ", i)";
  }
  const FormulaLaw law({text, {}}, {});
  EXPECT_THROW(law.compiled(1, {false, false, false}), std::length_error);
}

/// A product of n different factors has a second derivative of n^2 products of n factors.
TEST(FormulaLaw, RefusesWhatGrowsBeyondBoundsWhenDifferentiated) {
  std::string text = "x";
  for (int k = 1; k < 700; ++k) text += "*(x + " + std::to_string(k) + ")";
  const FormulaLaw law({text, {}}, {});
  EXPECT_THROW(law.compiled(1, {false, false, false}), std::length_error);
}

}  // namespace
}  // namespace tomlin
