#include "framework/core/numbers/hyperbolic.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/framework/core/math_bits.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

const double kNan = __builtin_nan("");

// Worst errors in units of the last place, a little above the worst of 1e7 samples. The exponential
// takes half a unit and a little; the quotient, and the last sum, as much.
constexpr double kSinhError = 1.65;
constexpr double kCoshError = 1.2;
constexpr double kTanhError = 1.7;

constexpr int kSamples = 200000;

constexpr double kHighest = 710.4758;  // cosh of it is just finite

/// Arguments of order one, near the ends of the series, up to overflow, of any small size.
double any_argument(TestNumbers& numbers, int i) {
  const double sign = i % 8 < 4 ? 1 : -1;
  switch (i % 4) {
    case 0:
      return sign * numbers.uniform(0, 3);
    case 1:
      return sign * numbers.uniform(0.5, 1.1);
    case 2:
      return sign * numbers.uniform(0, kHighest);
    default:
      return sign * ldexp(numbers.uniform(0.5, 1), -i % 1000);
  }
}

// f of eight random or special arguments, in one pack or in eight scalars.
template <class T>
std::uint64_t hyperbolic_bits() {
  const double special[] = {0,
                            -0.0,
                            1,
                            -1,
                            0.5625,
                            0.6931,
                            TestRange::kTiny,
                            -TestRange::kTiny,
                            TestRange::kHuge,
                            TestRange::kSmall,
                            TestRange::kExpHighest,
                            -TestRange::kExpHighest,
                            TestRange::kInfinity,
                            -TestRange::kInfinity,
                            TestRange::kNan,
                            TestRange::kMax};
  BitsHash hash;
  TestNumbers numbers(20261125);
  for (int block = 0; block < 4000; ++block) {
    double a[kLanes];
    for (double& x : a) {
      switch (block % 4) {
        case 0:
          x = numbers.uniform(-3, 3);
          break;
        case 1:
          x = numbers.uniform(TestRange::kBeyondLow, TestRange::kBeyondHigh);
          break;
        case 2:
          x = numbers.any_finite();
          break;
        default:
          x = special[numbers.bits() % std::size(special)];
      }
    }
    const auto add = [&](auto f) { add_results<T>(hash, f, a, a, a); };
    add([](auto x, auto, auto) { return sinh(x); });
    add([](auto x, auto, auto) { return cosh(x); });
    add([](auto x, auto, auto) { return tanh(x); });
    add([](auto x, auto, auto) { return sign(x); });
    add([](auto x, auto, auto) { return unit_step(x); });
  }
  return hash.value();
}

// Recorded once, as kMathBits in math_test.cpp.
constexpr std::uint64_t kHyperbolicBits = 12007967381882562232u;

using Slope = Dual<double, 1>;

// x is between 0.1 and 2.
struct {
  template <class T>
  T operator()(T x) const {
    return sinh(x * x) * 0.3 + 2.0 * cosh(0.7 * x) - tanh(1.5 * x) * x + tanh(0.2 * x) +
           sign(x - 0.05) * x + unit_step(x - 0.05) * x * x;
  }
} const all_hyperbolic;

}  // namespace

TARGET_TEST(Hyperbolic, DoublesAreAccurate) {
  TestNumbers numbers(71);
  WorstError sine, cosine, tangent;
  for (int i = 0; i < kSamples; ++i) {
    const double x = any_argument(numbers, i);
    sine.add(sinh(x), sinhl(x));
    cosine.add(cosh(x), coshl(x));
    tangent.add(tanh(x), tanhl(x));
  }
  EXPECT_LT(sine.error, kSinhError);
  EXPECT_LT(cosine.error, kCoshError);
  EXPECT_LT(tangent.error, kTanhError);
  // The bounds are no looser than they need be.
  EXPECT_GT(sine.error, 0.8 * kSinhError);
  EXPECT_GT(cosine.error, 0.8 * kCoshError);
  EXPECT_GT(tangent.error, 0.8 * kTanhError);
}

// The definitions lose digits by cancellation, and fail beyond the overflow of the exponential.
TARGET_TEST(Hyperbolic, AccuracyChecksSeeTheDefinitions) {
  WorstError sine, tangent, cosine;
  for (const double x : {1e-3, 0.02, 0.3}) {
    sine.add(0.5 * (exp(x) - exp(-x)), sinhl(x));
    tangent.add(1.0 - 2.0 / (exp(2.0 * x) + 1.0), tanhl(x));
  }
  cosine.add(0.5 * (exp(710.0) + exp(-710.0)), coshl(710.0L));
  EXPECT_GT(sine.error, 10 * kSinhError);
  EXPECT_GT(tangent.error, 10 * kTanhError);
  EXPECT_GT(cosine.error, 1e3);
}

TARGET_TEST(Hyperbolic, SpecialValues) {
  const auto inf = std::numeric_limits<double>::infinity();
  for (const double sign_of : {1.0, -1.0}) {
    EXPECT_EQ(std::signbit(sinh(sign_of * 0.0)), sign_of < 0);
    EXPECT_EQ(sinh(sign_of * 0.0), 0.0);
    EXPECT_EQ(std::signbit(tanh(sign_of * 0.0)), sign_of < 0);
    EXPECT_EQ(tanh(sign_of * 0.0), 0.0);
    EXPECT_EQ(cosh(sign_of * 0.0), 1.0);
    EXPECT_EQ(sinh(sign_of * inf), sign_of * inf);
    EXPECT_EQ(cosh(sign_of * inf), inf);
    EXPECT_EQ(tanh(sign_of * inf), sign_of);
    EXPECT_EQ(tanh(sign_of * 50.0), sign_of);
    EXPECT_EQ(sinh(sign_of * 800.0), sign_of * inf);
    EXPECT_EQ(cosh(sign_of * 800.0), inf);
    const double tiny = sign_of * std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(sinh(tiny), tiny);
    EXPECT_EQ(tanh(tiny), tiny);
    EXPECT_EQ(sign(tiny), sign_of);
    EXPECT_EQ(unit_step(tiny), sign_of < 0 ? 0.0 : 1.0);
    EXPECT_EQ(sign(sign_of * 0.0), 0.0);
    EXPECT_EQ(unit_step(sign_of * 0.0), 1.0);
    EXPECT_EQ(sign(sign_of * inf), sign_of);
    EXPECT_EQ(unit_step(sign_of * inf), sign_of < 0 ? 0.0 : 1.0);
  }
  EXPECT_TRUE(std::isnan(sinh(kNan)) && std::isnan(cosh(kNan)) && std::isnan(tanh(kNan)));
  EXPECT_TRUE(std::isnan(sign(kNan)) && std::isnan(unit_step(kNan)));
}

TARGET_TEST(Hyperbolic, EveryLaneAndTargetHasTheSameBits) {
  EXPECT_EQ(hyperbolic_bits<double>(), kHyperbolicBits);
  EXPECT_EQ(hyperbolic_bits<Pack>(), kHyperbolicBits);
}

TARGET_TEST(Hyperbolic, DerivativesAgreeWithDifferences) {
  using Second = Dual<Slope, 1>;
  for (const double x : {0.11, 0.31, 0.63, 0.97, 1.4, 1.9}) {
    EXPECT_LT(difference_error(all_hyperbolic, x), kDifferenceError) << x;
    EXPECT_EQ(all_hyperbolic(Slope::variable(x, 0)).value, all_hyperbolic(x));
    const Second d = all_hyperbolic(Second::variable(Slope::variable(x, 0), 0));
    const auto slope = [&](double at) {
      return all_hyperbolic(Slope::variable(at, 0)).derivative[0];
    };
    const double curvature =
        (slope(x + kDifferenceStep) - slope(x - kDifferenceStep)) / (2 * kDifferenceStep);
    EXPECT_NEAR(d.derivative[0].derivative[0], curvature,
                10 * kDifferenceError * (1 + std::abs(curvature)))
        << x;
  }
  // A control: a derivative off by 1e-4.
  const auto off = [](auto x) {
    auto y = tanh(x);
    if constexpr (is_dual<decltype(x)>) y.derivative[0] *= 1 + 1e-4;
    return y;
  };
  EXPECT_GT(difference_error(off, 0.4), 10 * kDifferenceError);
}

// 1 - tanh^2 would be zero from 19 on.
TARGET_TEST(Hyperbolic, TheSlopeOfTanhKeepsItsDigits) {
  constexpr double kRelative = 1e-14;
  for (const double x : {0.0, 0.5, 5.0, 20.0, 100.0, 300.0}) {
    const double c = static_cast<double>(coshl(x));
    const double slope = tanh(Slope::variable(x, 0)).derivative[0];
    EXPECT_NEAR(slope * c * c, 1.0, kRelative) << x;
  }
  EXPECT_EQ(tanh(Slope::variable(1e4, 0)).derivative[0], 0.0);
  using Second = Dual<Slope, 1>;
  const Second far = tanh(Second::variable(Slope::variable(1e4, 0), 0));
  EXPECT_EQ(far.derivative[0].derivative[0], 0.0);
  EXPECT_EQ(sign(Slope::variable(0.0, 0)).derivative[0], 0.0);
  EXPECT_EQ(unit_step(Slope::variable(0.0, 0)).derivative[0], 0.0);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
