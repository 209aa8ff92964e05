#include "framework/core/numbers/math.hpp"

#include <cmath>

#include "tests/framework/core/math_bits.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

constexpr double kInf = __builtin_inf();
const double kNan = __builtin_nan("");
constexpr double kTwoPi = 0x1.921fb54442d18p+2;
constexpr long double kLongTwoPi = 6.283185307179586476925286766559L;

// Worst errors, in units of the last place of the result unless stated. Each is what rounding adds
// up to for the way the function is evaluated, a little above the worst case in 1e7 samples; the
// truncation of the polynomials is a hundred times smaller. The reference is the x87 long double,
// whose own error is 1/2048 of such a unit.
constexpr double kSineError = 2.5e-16;      // absolute: three roundings near 1, one of r^2
constexpr double kCosineError = 1.6e-16;    // absolute: one rounding near 1, one of r^2
constexpr double kSineNearZeroError = 2.0;  // coefficient, product, sum
constexpr double kExpError = 1.35;          // 1 + r, and the sum, just below a power of two
constexpr double kLogError = 0.85;
constexpr double kPowError = 1.3;  // one rounding, and 709 times 2^-63 of the logarithm

// The distance of doubles at x; below 2^-1022 it no longer shrinks.
double unit_at(long double x) {
  int exponent;
  frexpl(x, &exponent);
  return ldexp(1.0, exponent - 53 < -1074 ? -1074 : exponent - 53);
}

// The exact rest of x in turns, and the reference value from it.
long double sine_reference(double x) {
  return sinl(kLongTwoPi * static_cast<long double>(x - nearbyint(x)));
}
long double cosine_reference(double x) {
  return cosl(kLongTwoPi * static_cast<long double>(x - nearbyint(x)));
}

// Largest |f(x) - reference(x)| in the measure given, over x = sample(i).
template <class F, class Reference, class Sample, class Measure>
double worst(F f, Reference reference, Sample sample, Measure measure) {
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = sample(i);
    const long double exact = reference(x);
    const double error = static_cast<double>(fabsl(f(x) - exact) / measure(exact));
    if (!(error <= largest)) largest = error;
  }
  return largest;
}
const auto absolute = [](long double) { return 1.0; };
const auto in_units = [](long double exact) { return unit_at(exact); };

// Arguments that matter for phases: one turn, the reduced interval's ends, a few thousand turns.
struct Phases {
  TestNumbers numbers{11};
  double operator()(int i) {
    switch (i % 4) {
      case 0:
        return numbers.uniform(-1, 1);
      case 1:
        return numbers.uniform(0.2499, 0.2501);
      case 2:
        return numbers.uniform(-4000, 4000);
      default:
        return numbers.uniform(-0.26, 0.26);
    }
  }
};

}  // namespace

TARGET_TEST(Math, SineAndCosineAreAccurate) {
  const auto sine = [](double x) { return sin_turns(x); };
  const auto cosine = [](double x) { return cos_turns(x); };
  EXPECT_LT(worst(sine, sine_reference, Phases(), absolute), kSineError);
  EXPECT_LT(worst(cosine, cosine_reference, Phases(), absolute), kCosineError);
  TestNumbers numbers(12);
  const auto small = [&](int) { return numbers.uniform(-1, 1) * exp(numbers.uniform(-600, -3)); };
  EXPECT_LT(worst(sine, sine_reference, small, in_units), kSineNearZeroError);
}

TARGET_TEST(Math, AccuracyCheckCatchesADegradedPolynomial) {
  // The accuracy check must fail for the sine with its last term dropped, and with one coefficient
  // off in the twelfth digit.
  const auto degraded = [](double x, double last, double first_factor) {
    using Fit = math_detail::Fit;
    const double r = x - round(2 * x) / 2, z = r * r;
    double q = last;
    for (int i = 5; i >= 0; --i) q = fma(z, q, Fit::kSin[i]);
    const double s = r * fma(z, fma(z, q, Fit::kSin1 * first_factor), Fit::kSin0);
    return round(2 * x) - 2 * round(x) == 0 ? s : -s;
  };
  const auto intact = [&](double x) { return degraded(x, math_detail::Fit::kSin[6], 1.0); };
  const auto dropped = [&](double x) { return degraded(x, 0.0, 1.0); };
  const auto off = [&](double x) { return degraded(x, math_detail::Fit::kSin[6], 1 + 1e-12); };
  EXPECT_LT(worst(intact, sine_reference, Phases(), absolute), 2 * kSineError);
  EXPECT_GT(worst(dropped, sine_reference, Phases(), absolute), 1000 * kSineError);
  EXPECT_GT(worst(off, sine_reference, Phases(), absolute), 1000 * kSineError);
}

TARGET_TEST(Math, SineSpecialValues) {
  EXPECT_EQ(sin_turns(0.0), 0.0);
  EXPECT_EQ(cos_turns(0.0), 1.0);
  EXPECT_EQ(cos_turns(0.5), -1.0);
  EXPECT_EQ(cos_turns(-7.0), 1.0);
  EXPECT_EQ(sin_turns(12345.5), 0.0);
  EXPECT_EQ(sin_turns(0x1p-1000), kTwoPi * 0x1p-1000);
  EXPECT_EQ(sin_turns(0x1p-1074), 6 * 0x1p-1074);
  for (double bad : {kInf, -kInf, kNan}) {
    EXPECT_TRUE(std::isnan(sin_turns(bad)));
    EXPECT_TRUE(std::isnan(cos_turns(bad)));
    EXPECT_TRUE(std::isnan(sin_turns(Pack(bad)).lane(3)));
    EXPECT_TRUE(std::isnan(cos_turns(Pack(bad)).lane(3)));
  }
}

TARGET_TEST(Math, SineKnowsItsPhaseUpTo2To50) {
  TestNumbers numbers(13);
  for (int i = 0; i < 20000; ++i) {
    // x = whole + fraction exactly.
    const double whole = nearbyint(ldexp(numbers.uniform(-1, 1), i % 51));
    const double x = whole + numbers.uniform(-0.5, 0.5);
    const double rest = x - nearbyint(x);
    ASSERT_LE(std::abs(x), 0x1p50);
    EXPECT_EQ(std::abs(sin_turns(x)), std::abs(sin_turns(rest))) << x;
    // On the boundary of two half turns the reduced argument may be +-1/4 either way.
    EXPECT_NEAR(sin_turns(x), sin_turns(rest), kSineError) << x;
    EXPECT_NEAR(cos_turns(x), cos_turns(rest), kCosineError) << x;
  }
  EXPECT_NEAR(sin_turns(0x1p50 - 0.25), -1.0, kSineError);
  EXPECT_NEAR(cos_turns(-0x1p50 + 0.5), -1.0, kCosineError);
}

TARGET_TEST(Math, SineStaysSaneFarBeyond) {
  TestNumbers numbers(14);
  for (int i = 0; i < 20000; ++i) {
    const double x = numbers.uniform(-0x1p51, 0x1p51);
    EXPECT_LE(std::abs(sin_turns(x)), 1 + 1e-15) << x;
    EXPECT_LE(std::abs(cos_turns(x)), 1 + 1e-15) << x;
    const double y = numbers.any_finite();
    EXPECT_TRUE(std::isfinite(sin_turns(y))) << y;
    EXPECT_TRUE(std::isfinite(cos_turns(y))) << y;
  }
}

TARGET_TEST(Math, SineAndCosineTogetherEqualThemAlone) {
  Phases phases;
  for (int i = 0; i < 20000; ++i) {
    const double x = phases(i);
    double s, c;
    sincos_turns(x, s, c);
    EXPECT_EQ(s, sin_turns(x));
    EXPECT_EQ(c, cos_turns(x));
    EXPECT_EQ(sin_turns(-x), -s);
    EXPECT_EQ(cos_turns(-x), c);
  }
}

TARGET_TEST(Math, ExpIsAccurate) {
  TestNumbers numbers(15);
  const auto f = [](double x) { return exp(x); };
  const auto reference = [](double x) { return expl(x); };
  const auto wide = [&](int) { return numbers.uniform(-708, 709.78); };
  const auto narrow = [&](int) { return numbers.uniform(-1, 1); };
  const auto subnormal = [&](int) { return numbers.uniform(-746, -708); };
  EXPECT_LT(worst(f, reference, wide, in_units), kExpError);
  EXPECT_LT(worst(f, reference, narrow, in_units), kExpError);
  EXPECT_LT(worst(f, reference, subnormal, in_units), kExpError);
}

TARGET_TEST(Math, ExpSpecialValues) {
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-745.0), 0x1p-1074);
  EXPECT_EQ(exp(-745.2), 0.0);
  EXPECT_EQ(exp(-1e9), 0.0);
  EXPECT_EQ(exp(-1e300), 0.0);
  EXPECT_EQ(exp(-kInf), 0.0);
  EXPECT_LT(exp(709.78), kInf);
  EXPECT_EQ(exp(709.79), kInf);
  EXPECT_EQ(exp(1e300), kInf);
  EXPECT_EQ(exp(kInf), kInf);
  EXPECT_TRUE(std::isnan(exp(kNan)));
}

TARGET_TEST(Math, LogIsAccurate) {
  TestNumbers numbers(16);
  const auto f = [](double x) { return log(x); };
  const auto reference = [](double x) { return logl(x); };
  const auto wide = [&](int) { return std::abs(numbers.any_finite()); };
  const auto narrow = [&](int) { return numbers.uniform(0.5, 2); };
  const auto near_one = [&](int) { return 1 + numbers.uniform(-1, 1) * 1e-6; };
  EXPECT_LT(worst(f, reference, wide, in_units), kLogError);
  EXPECT_LT(worst(f, reference, narrow, in_units), kLogError);
  EXPECT_LT(worst(f, reference, near_one, in_units), kLogError);
}

TARGET_TEST(Math, LogSpecialValues) {
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_EQ(log(0.0), -kInf);
  EXPECT_EQ(log(-0.0), -kInf);
  EXPECT_EQ(log(kInf), kInf);
  EXPECT_DOUBLE_EQ(log(0x1p-1074), -744.4400719213812621);
  EXPECT_DOUBLE_EQ(log(3 * 0x1p-1074), -743.3414596327131524);
  for (double bad : {-1.0, -0x1p-1074, -1e300, -kInf, kNan}) EXPECT_TRUE(std::isnan(log(bad)));
}

TARGET_TEST(Math, PowIsAccurate) {
  TestNumbers numbers(17);
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 2 ? std::abs(numbers.any_finite()) : numbers.uniform(0.3, 3);
    const double y = i % 4 < 2 ? numbers.uniform(-3, 3) : numbers.uniform(-740, 709) / std::log(x);
    const long double exact = powl(x, y);
    if (!(exact < 1.79e308L)) continue;
    const double error = static_cast<double>(fabsl(pow(x, y) - exact) / unit_at(exact));
    if (!(error <= largest)) largest = error;
  }
  EXPECT_LT(largest, kPowError);
}

TARGET_TEST(Math, PowSpecialValues) {
  EXPECT_EQ(pow(0.0, 2.5), 0.0);
  EXPECT_EQ(pow(0.0, -1.0), kInf);
  EXPECT_EQ(pow(kInf, 0.5), kInf);
  EXPECT_EQ(pow(kInf, -0.5), 0.0);
  for (double x : {0.0, -2.0, 1e300, kInf, kNan}) EXPECT_EQ(pow(x, 0.0), 1.0);
  EXPECT_EQ(pow(1.0, kInf), 1.0);
  for (double x : {3.0, 0.1, 1e300, 7e-310}) EXPECT_EQ(pow(x, 1.0), x);
  EXPECT_EQ(pow(2.0, 10.0), 1024.0);
  EXPECT_EQ(pow(-2.0, 3.0), -8.0);
  EXPECT_EQ(pow(-2.0, 4.0), 16.0);
  EXPECT_EQ(pow(-2.0, -3.0), -0.125);
  EXPECT_TRUE(std::isnan(pow(-2.0, 0.5)));
  EXPECT_TRUE(std::isnan(pow(kNan, 1.0)));
  EXPECT_TRUE(std::isnan(pow(2.0, kNan)));
  EXPECT_EQ(pow(2.0, 1024.0), kInf);
  EXPECT_EQ(pow(2.0, -1074.0), 0x1p-1074);
  EXPECT_EQ(pow(2.0, -1076.0), 0.0);
  EXPECT_EQ(pow(0.5, kInf), 0.0);
  EXPECT_EQ(pow(0.5, 1e300), 0.0);
}

// Recorded once. Every compiler and instruction set must reproduce it; it changes only together
// with a function, and then results of simulations change too.
constexpr std::uint64_t kMathBits = 10315382484320994793u;

TARGET_TEST(Math, LanesHaveTheBitsOfScalars) { EXPECT_EQ(math_bits<Pack>(), math_bits<double>()); }

TARGET_TEST(Math, EveryTargetHasTheSameBits) { EXPECT_EQ(math_bits<Pack>(), kMathBits); }

TARGET_TEST(Math, BitsHashSeesTheLastBit) {
  BitsHash a, b, c;
  a.add(1.0);
  b.add(1.0 + 0x1p-52);
  EXPECT_NE(a.value(), b.value());
  c.add(0.0);
  BitsHash d;
  d.add(-0.0);
  EXPECT_NE(c.value(), d.value());
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
