#include "framework/core/numbers/inverse_trigonometry.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/framework/core/math_bits.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

constexpr double kInf = __builtin_inf();
const double kNan = __builtin_nan("");
constexpr double kPi = 0x1.921fb54442d18p+1;

// Worst errors in units of the last place, a little above the worst of 1e7 samples. Of atan: half a
// unit each from t + 1, the quotient and the last sum; atan2 rounds the ratio as well. Of asin and
// acos: the root, the series, the last sum.
constexpr double kAtanError = 1.45;
constexpr double kAtan2Error = 1.6;
constexpr double kAsinError = 1.2;
constexpr double kAcosError = 1.15;

/// Arguments of atan: of order one, near the ends of the reduced interval, of any size.
double any_ratio(TestNumbers& numbers, int i) {
  switch (i % 4) {
    case 0:
      return numbers.uniform(-3, 3);
    case 1:
      return numbers.uniform(0.4, 0.7);
    case 2:
      return numbers.uniform(0.9, 2.5);
    default:
      return numbers.any_finite();
  }
}
/// Arguments of asin and acos: all, near 0, near 1/2, near 1.
double any_sine(TestNumbers& numbers, int i) {
  const double sign = i % 8 < 4 ? 1 : -1;
  switch (i % 4) {
    case 0:
      return sign * numbers.uniform(0, 1);
    case 1:
      return sign * ldexp(numbers.uniform(0.5, 1), -i % 1000);
    case 2:
      return sign * numbers.uniform(0.48, 0.52);
    default:
      return sign * (1 - numbers.uniform(0, 1e-3));
  }
}

void expect_same(double got, double wanted) {
  EXPECT_EQ(got, wanted);
  EXPECT_EQ(std::signbit(got), std::signbit(wanted)) << wanted;
}

}  // namespace

constexpr int kSamples = 200000;

TARGET_TEST(InverseTrigonometry, AtanIsAccurate) {
  TestNumbers numbers(61);
  WorstError one, two;
  for (int i = 0; i < kSamples; ++i) {
    const double x = any_ratio(numbers, i);
    one.add(atan(x), atanl(x));
    const double y = numbers.uniform(-1, 1) * (i % 3 == 0 ? x : 1.0);
    two.add(atan2(y, x), atan2l(y, x));
  }
  EXPECT_LT(one.error, kAtanError);
  EXPECT_LT(two.error, kAtan2Error);
  // The bounds are no looser than they need be.
  EXPECT_GT(one.error, 0.85 * kAtanError);
  EXPECT_GT(two.error, 0.8 * kAtan2Error);
}

TARGET_TEST(InverseTrigonometry, AtanOfVeryLargeAndSmallCoordinates) {
  // Overflow of x + y, ratios of subnormal numbers.
  const double sizes[] = {0x1p-1074, 3 * 0x1p-1074, 0x1p-1060, 1e-300, 1, 1e300, 0x1p1023, 1.7e308};
  TestNumbers numbers(62);
  WorstError worst;
  for (const double a : sizes) {
    for (const double b : sizes) {
      for (int i = 0; i < 200; ++i) {
        const double y = a * (i % 4 ? numbers.uniform(-1, 1) : 1);
        const double x = b * (i % 5 ? numbers.uniform(-1, 1) : -1);
        worst.add(atan2(y, x), atan2l(y, x));
      }
    }
  }
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      worst.add(atan2(i * 0x1p-1074, j * 0x1p-1074), atan2l(i, j));
    }
  }
  EXPECT_LT(worst.error, kAtan2Error);
}

TARGET_TEST(InverseTrigonometry, AsinAndAcosAreAccurate) {
  TestNumbers numbers(63);
  WorstError sine, cosine;
  for (int i = 0; i < kSamples; ++i) {
    const double x = any_sine(numbers, i);
    sine.add(asin(x), asinl(x));
    cosine.add(acos(x), acosl(x));
  }
  EXPECT_LT(sine.error, kAsinError);
  EXPECT_LT(cosine.error, kAcosError);
  EXPECT_GT(sine.error, 0.85 * kAsinError);
  EXPECT_GT(cosine.error, 0.85 * kAcosError);
}

TARGET_TEST(InverseTrigonometry, AccuracyChecksSeeASpoiltSeries) {
  // The accuracy checks must fail for atan with its last term dropped, and with the low part of
  // pi/4 left out.
  using Fit = math_detail::InverseFit;
  WorstError dropped, intact, short_pi;
  TestNumbers numbers(65);
  for (int i = 0; i < 2000; ++i) {
    const double u = numbers.uniform(0.4, 0.5), z = u * u;
    double q = 0;
    for (int k = 10; k >= 0; --k) q = fma(z, q, Fit::kAtan[k]);
    dropped.add(fma(u * z, q, u), atanl(u));
    q = Fit::kAtan[11];
    for (int k = 10; k >= 0; --k) q = fma(z, q, Fit::kAtan[k]);
    intact.add(fma(u * z, q, u), atanl(u));
    short_pi.add(Fit::kEighthTurn * 4 - atan(u), acosl(-1.0L) - atanl(u));
  }
  EXPECT_LT(intact.error, kAtanError);
  EXPECT_GT(dropped.error, 1e4 * kAtanError);
  EXPECT_GT(short_pi.error, 0.75);
  WorstError long_pi;
  for (int i = 0; i < 2000; ++i) {
    const double u = numbers.uniform(0.3, 0.41);
    long_pi.add(atan2(u, -1.0), acosl(-1.0L) - atanl(u));
  }
  EXPECT_LT(long_pi.error, 0.65);
}

TARGET_TEST(InverseTrigonometry, SpecialValues) {
  const double zero = 0.0, one = 1.0;
  for (const double sign : {one, -one}) {
    // IEEE 754, section 9.2.1.
    for (const double x : {zero, one, kInf}) {
      expect_same(atan2(sign * zero, x), sign * zero);
      expect_same(atan2(sign * zero, -x), sign * kPi);
    }
    expect_same(atan2(sign * one, zero), sign * kPi / 2);
    expect_same(atan2(sign * one, -zero), sign * kPi / 2);
    expect_same(atan2(sign * one, kInf), sign * zero);
    expect_same(atan2(sign * one, -kInf), sign * kPi);
    expect_same(atan2(sign * kInf, one), sign * kPi / 2);
    expect_same(atan2(sign * kInf, -one), sign * kPi / 2);
    expect_same(atan2(sign * kInf, kInf), sign * kPi / 4);
    expect_same(atan2(sign * kInf, -kInf), sign * 0x1.2d97c7f3321d2p+1);
    expect_same(atan2(sign * one, one), sign * kPi / 4);
    expect_same(atan(sign * zero), sign * zero);
    expect_same(atan(sign * kInf), sign * kPi / 2);
    expect_same(asin(sign * zero), sign * zero);
    expect_same(asin(sign * one), sign * kPi / 2);
    expect_same(floor(sign * zero), sign * zero);
    expect_same(floor(sign * kInf), sign * kInf);
  }
  expect_same(acos(one), zero);
  expect_same(acos(-one), kPi);
  expect_same(acos(zero), kPi / 2);
  const double above = std::nextafter(one, 2.0);
  for (const double x : {above, -above, 2.0, kInf, -kInf, kNan}) {
    EXPECT_TRUE(std::isnan(asin(x))) << x;
    EXPECT_TRUE(std::isnan(acos(x))) << x;
  }
  for (const double x : {zero, one, kInf, -kInf, kNan}) {
    EXPECT_TRUE(std::isnan(atan2(kNan, x))) << x;
    EXPECT_TRUE(std::isnan(atan2(x, kNan))) << x;
  }
  EXPECT_TRUE(std::isnan(atan(kNan)) && std::isnan(floor(kNan)) && std::isnan(tan_turns(kInf)));
}

TARGET_TEST(InverseTrigonometry, Floor) {
  TestNumbers numbers(66);
  for (int i = 0; i < 20000; ++i) {
    const double x = i % 2 ? numbers.any_finite() : ldexp(numbers.uniform(-1, 1), i % 60);
    EXPECT_EQ(floor(x), std::floor(x)) << x;
  }
  for (const double x : {0.5, 1.5, -0.5, -1.5, 2.0, -2.0, 1 - 0x1p-53, -0x1p-1074}) {
    EXPECT_EQ(floor(x), std::floor(x)) << x;
  }
}

TARGET_TEST(InverseTrigonometry, TangentIsSineOverCosine) {
  TestNumbers numbers(67);
  for (int i = 0; i < 20000; ++i) {
    const double x = numbers.uniform(-3, 3);
    EXPECT_EQ(tan_turns(x), sin_turns(x) / cos_turns(x));
  }
  EXPECT_EQ(tan_turns(0.0), 0.0);
  EXPECT_EQ(tan_turns(0.125), 1.0);
}

// f of eight random or special arguments, in one pack or in eight scalars.
template <class T>
std::uint64_t inverse_bits() {
  const double special[] = {0,
                            -0.0,
                            1,
                            -1,
                            0.5,
                            2,
                            TestRange::kTiny,
                            -TestRange::kTiny,
                            TestRange::kHuge,
                            TestRange::kSmall,
                            TestRange::kInfinity,
                            -TestRange::kInfinity,
                            TestRange::kNan,
                            TestRange::kMax,
                            0.25,
                            0.414};
  BitsHash hash;
  TestNumbers numbers(20261122);
  for (int block = 0; block < 4000; ++block) {
    double a[kLanes], b[kLanes], unit[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      unit[i] = numbers.uniform(-1.01, 1.01);
      switch (block % 3) {
        case 0:
          a[i] = numbers.uniform(-4, 4);
          b[i] = numbers.uniform(-4, 4);
          break;
        case 1:
          a[i] = numbers.any_finite(), b[i] = numbers.any_finite();
          break;
        default:
          a[i] = special[numbers.bits() % std::size(special)];
          b[i] = special[numbers.bits() % std::size(special)];
          unit[i] = special[numbers.bits() % std::size(special)];
      }
    }
    const auto add = [&](auto f) { add_results<T>(hash, f, a, b, unit); };
    add([](auto x, auto, auto) { return atan(x); });
    add([](auto x, auto y, auto) { return atan2(y, x); });
    add([](auto, auto, auto z) { return asin(z); });
    add([](auto, auto, auto z) { return acos(z); });
    add([](auto x, auto, auto) { return floor(x); });
    if (block % 3 == 0) {
      add([](auto x, auto, auto) { return tan_turns(x); });
    }
  }
  return hash.value();
}

// Recorded once, as kMathBits in math_test.cpp.
constexpr std::uint64_t kInverseBits = 15298276074390035445u;

TARGET_TEST(InverseTrigonometry, EveryLaneAndTargetHasTheSameBits) {
  EXPECT_EQ(inverse_bits<double>(), kInverseBits);
  EXPECT_EQ(inverse_bits<Pack>(), kInverseBits);
}

// ---------------------------------------------------------------------------------------------
// Derivatives

namespace {

using Single = Dual<double, 1>;

// Each function with its inner derivative in play; x is between 0.1 and 0.9.
struct {
  template <class T>
  T operator()(T x) const {
    return atan(x * x * 3.0) + 2.0 * atan2(x + 0.2, x * x - 0.5) + atan2(x, -0.3) +
           3.0 * atan2(0.7, x * x) + asin(0.9 * x) * 1.5 - acos(x * x) * 0.7 +
           tan_turns(0.2 * x) * 0.8 + floor(x * 5.0) * x;
  }
} const everything;

}  // namespace

TARGET_TEST(InverseTrigonometry, DerivativesAgreeWithDifferences) {
  using Second = Dual<Single, 1>;
  for (const double x : {0.11, 0.31, 0.47, 0.63, 0.83, 0.89}) {
    EXPECT_LT(difference_error(everything, x), kDifferenceError) << x;
    EXPECT_EQ(everything(Single::variable(x, 0)).value, everything(x));
    const Second d = everything(Second::variable(Single::variable(x, 0), 0));
    const double up = everything(Single::variable(x + kDifferenceStep, 0)).derivative[0];
    const double down = everything(Single::variable(x - kDifferenceStep, 0)).derivative[0];
    const double curvature = (up - down) / (2 * kDifferenceStep);
    EXPECT_NEAR(d.derivative[0].derivative[0], curvature,
                10 * kDifferenceError * (1 + std::abs(curvature)))
        << x;
  }
  // The controls: each function's derivative off by 1e-4.
  const auto off = [](auto f) {
    return [f](auto x) {
      auto y = f(x);
      if constexpr (is_dual<decltype(x)>) y.derivative[0] *= 1 + 1e-4;
      return y;
    };
  };
  EXPECT_GT(difference_error(off([](auto x) { return atan(x); }), 0.4), 10 * kDifferenceError);
  EXPECT_GT(difference_error(off([](auto x) { return asin(x); }), 0.4), 10 * kDifferenceError);
  EXPECT_GT(difference_error(off([](auto x) { return tan_turns(x); }), 0.1), 10 * kDifferenceError);
}

TARGET_TEST(InverseTrigonometry, DerivativesInClosedForm) {
  constexpr double kRounding = 1e-15;
  const Single x = Single::variable(0.6, 0);
  EXPECT_NEAR(asin(x).derivative[0], 1.25, kRounding);
  EXPECT_NEAR(acos(x).derivative[0], -1.25, kRounding);
  EXPECT_NEAR(atan(x).derivative[0], 1 / 1.36, kRounding);
  EXPECT_NEAR(tan_turns(Single::variable(0.125, 0)).derivative[0], 4 * kPi, 10 * kRounding);
  EXPECT_EQ(floor(x).derivative[0], 0.0);
  // Around the circle the angle turns evenly, in all quadrants.
  for (const double turns : {0.05, 0.2, 0.3, 0.45, 0.55, 0.7, 0.8, 0.95}) {
    const Single phase = Single::variable(turns, 0);
    const Single angle = atan2(3.0 * sin_turns(phase), 3.0 * cos_turns(phase));
    EXPECT_NEAR(angle.derivative[0], 2 * kPi, 20 * kRounding);
    EXPECT_NEAR(angle.value, 2 * kPi * (turns < 0.5 ? turns : turns - 1), 2 * kRounding);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
