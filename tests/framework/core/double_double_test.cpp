#include "framework/core/numbers/double_double.hpp"

#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

// Exact arithmetic to compare with: doubles are rationals.
using Exact = boost::multiprecision::cpp_rational;
Exact exact(DoubleDouble x) { return Exact(x.hi) + Exact(x.lo); }
double relative_error(DoubleDouble x, const Exact& reference) {
  if (reference == 0) return std::abs(static_cast<double>(x));
  const Exact error = (exact(x) - reference) / reference;
  return std::abs(error.convert_to<double>());
}

// Sums err by two roundings of the low half, products by a few: multiples of 2^-106.
constexpr double kSumError = 4 * 0x1p-106;
constexpr double kProductError = 8 * 0x1p-106;
constexpr int kSamples = 2000;

DoubleDouble sample(TestNumbers& numbers) {
  const double hi = std::ldexp(numbers.uniform(-1, 1), static_cast<int>(numbers.bits() % 40));
  return two_sum(hi, hi * numbers.uniform(-1, 1) * 0x1p-53);
}

}  // namespace

TARGET_TEST(DoubleDouble, ErrorFreeTransformations) {
  TestNumbers numbers(21);
  for (int i = 0; i < kSamples; ++i) {
    const double a = std::ldexp(numbers.uniform(-1, 1), i % 60), b = numbers.uniform(-1, 1);
    EXPECT_EQ(exact(two_sum(a, b)), Exact(a) + Exact(b));
    EXPECT_EQ(exact(two_prod(a, b)), Exact(a) * Exact(b));
    EXPECT_EQ(exact(fast_two_sum(2.0 + std::abs(a), b)), Exact(2.0 + std::abs(a)) + Exact(b));
  }
  static_assert(two_sum(1.0, 0x1p-80).lo == 0x1p-80);
}

TARGET_TEST(DoubleDouble, ArithmeticHasTwiceThePrecision) {
  TestNumbers numbers(22);
  for (int i = 0; i < kSamples; ++i) {
    const DoubleDouble a = sample(numbers), b = sample(numbers);
    const double c = numbers.uniform(-1e3, 1e3);
    EXPECT_LT(relative_error(a + b, exact(a) + exact(b)), kSumError);
    EXPECT_LT(relative_error(a - b, exact(a) - exact(b)), kSumError);
    EXPECT_LT(relative_error(a + c, exact(a) + Exact(c)), kSumError);
    EXPECT_LT(relative_error(c - a, Exact(c) - exact(a)), kSumError);
    EXPECT_LT(relative_error(a * b, exact(a) * exact(b)), kProductError);
    EXPECT_LT(relative_error(c * a, exact(a) * Exact(c)), kProductError);
    // The control: a double alone is nowhere near.
    EXPECT_GT(relative_error(DoubleDouble(a.hi * b.hi), exact(a) * exact(b)), kProductError);
  }
}

TARGET_TEST(DoubleDouble, Comparisons) {
  const DoubleDouble one(1.0), more(1.0, 0x1p-60), less(1.0, -0x1p-60);
  EXPECT_TRUE(less < one && one < more && less < more);
  EXPECT_TRUE(more > one && one > less && more >= one && one >= one && less <= one);
  EXPECT_FALSE(more < one || one < one || one == more);
  EXPECT_TRUE(one == DoubleDouble(1.0));
}

TARGET_TEST(DoubleDouble, AClockDoesNotDrift) {
  const double dt = 0.1;
  constexpr int kSteps = 1000000;
  DoubleDouble clock;
  double plain = 0;
  for (int i = 0; i < kSteps; ++i) clock += dt, plain += dt;
  EXPECT_LT(relative_error(clock, Exact(dt) * kSteps), kSteps * kSumError);
  EXPECT_EQ(static_cast<double>(clock), (Exact(dt) * kSteps).convert_to<double>());
  EXPECT_GT(std::abs(plain - static_cast<double>(clock)), 1e-7);  // the control: a plain one does
}

TARGET_TEST(DoubleDouble, RemainderIsExactToItsOwnRounding) {
  TestNumbers numbers(23);
  for (int i = 0; i < kSamples; ++i) {
    const double unit = numbers.uniform(0.1, 5);
    DoubleDouble x = sample(numbers) * std::ldexp(1.0, static_cast<int>(numbers.bits() % 20));
    std::int64_t cells = 0;
    const double rest = remainder_of(x, unit, cells);
    const Exact true_rest = exact(x) - Exact(cells) * Exact(unit);
    EXPECT_LE(std::abs(rest), 0.5 * unit);
    EXPECT_LE(relative_error(DoubleDouble(rest), true_rest), 0x1p-53);
    // The control: half as much information cannot know it.
    if (std::abs(x.hi) > 1e6) {
      EXPECT_GT(relative_error(DoubleDouble(std::remainder(x.hi, unit)), true_rest), 0x1p-53);
    }
  }
}

TARGET_TEST(DoubleDouble, RemainderOfFarPlaces) {
  // 1e9 and 2^61 periods away, and a rest that only the low half knows.
  for (const double count : {1e9, 0x1p61, -0x1p61}) {
    for (const double unit : {1.0, 0.29, 2.46}) {
      const DoubleDouble x = two_prod(count, unit) + 0x1p-20;
      std::int64_t cells = 0;
      const double rest = remainder_of(x, unit, cells);
      EXPECT_EQ(cells, static_cast<std::int64_t>(count));
      EXPECT_NEAR(rest, 0x1p-20, std::abs(count) * unit * 0x1p-105);
    }
  }
}

TARGET_TEST(DoubleDouble, RemainderAtHalvesAndOutOfRange) {
  std::int64_t cells = 7;
  EXPECT_EQ(std::abs(remainder_of(DoubleDouble(2.5), 1.0, cells)), 0.5);
  EXPECT_EQ(remainder_of(DoubleDouble(0.5, 0x1p-60), 1.0, cells), -0.5);
  EXPECT_EQ(cells, 1);
  EXPECT_EQ(remainder_of(DoubleDouble(-0.5, -0x1p-60), 1.0, cells), 0.5);
  EXPECT_EQ(cells, -1);
  EXPECT_EQ(remainder_of(DoubleDouble(0.3), 1.0, cells), 0.3);
  EXPECT_EQ(cells, 0);
  for (double bad : {__builtin_nan(""), __builtin_inf(), 1e30}) {
    cells = 7;
    EXPECT_TRUE(std::isnan(remainder_of(DoubleDouble(bad), 1.0, cells)));
    EXPECT_EQ(cells, 0);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
