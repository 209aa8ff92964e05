#include "framework/core/numbers/dual.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/framework/core/math_bits.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

using Single = Dual<double, 1>;
using Hessian = Dual<Dual<double, 2>, 2>;

// A derivative by the chain rule costs a few roundings.
constexpr double kRounding = 2e-15;

struct {
  template <class T>
  T operator()(T x) const {
    T s, c;
    sincos_turns(x, s, c);
    return fma(s, x, 2.0 * c) / (1.5 + x * x) - sqrt(x + 3.0) * exp(-0.5 * x) +
           pow(x, 2.5) * log(x) - pow(2.0, x) / x + pow(x, x) + 1.0 / (x - 7.0) +
           fnma(x, x, T(1.0)) * sin_turns(0.3 * x) - cos_turns(x / 5.0) + abs(x - 2.0) +
           copysign(x, -x) + max(x, T(0.7)) * min(x * x, T(0.9)) + round(x) + (-x) * 3;
  }
} everything;

}  // namespace

TARGET_TEST(Dual, EveryFunctionAgreesWithDifferences) {
  for (double x : {0.31, 0.63, 0.81, 1.2, 1.7, 2.3}) {
    EXPECT_NEAR(everything(Single::variable(x, 0)).value, everything(x), 1e-13) << x;
    EXPECT_LT(difference_error(everything, x), kDifferenceError) << x;
  }
}

TARGET_TEST(Dual, DifferencesCatchAWrongSlope) {
  // The control: a slope off by 1e-5.
  const auto wrong = [](auto x) {
    auto y = everything(x);
    if constexpr (is_dual<decltype(x)>) y.derivative[0] *= 1 + 1e-5;
    return y;
  };
  EXPECT_GT(difference_error(wrong, 1.2), 2 * kDifferenceError);
}

TARGET_TEST(Dual, ClosedForms) {
  const double x = 0.83, two_pi = 0x1.921fb54442d18p+2;
  const Single d = Single::variable(x, 0);
  EXPECT_NEAR(sin_turns(d).derivative[0], two_pi * cos_turns(x), 10 * kRounding);
  EXPECT_NEAR(cos_turns(d).derivative[0], -two_pi * sin_turns(x), 10 * kRounding);
  EXPECT_NEAR(exp(d).derivative[0], exp(x), kRounding);
  EXPECT_NEAR(log(d).derivative[0], 1 / x, kRounding);
  EXPECT_NEAR(sqrt(d).derivative[0], 0.5 / sqrt(x), kRounding);
  EXPECT_NEAR(pow(d, 3.0).derivative[0], 3 * x * x, kRounding);
  EXPECT_NEAR(pow(3.0, d).derivative[0], pow(3.0, x) * log(3.0), 5 * kRounding);
  EXPECT_NEAR((1.0 / d).derivative[0], -1 / (x * x), kRounding);
  EXPECT_NEAR((d / (d + 1.0)).derivative[0], 1 / ((x + 1) * (x + 1)), kRounding);
  EXPECT_EQ(abs(-d).derivative[0], 1.0);
  EXPECT_EQ(copysign(d, Single(-1.0)).derivative[0], -1.0);
  EXPECT_EQ(round(d).derivative[0], 0.0);
  EXPECT_EQ(round(d).value, 1.0);
  EXPECT_EQ(select(d < 1.0, d, 2.0 * d).derivative[0], 1.0);
  EXPECT_EQ(select(d > 1.0, d, 2.0 * d).derivative[0], 2.0);
  // At zero the exponent decides, not 0 * infinity.
  const Single zero = Single::variable(0.0, 0);
  EXPECT_EQ(pow(zero, 2.0).derivative[0], 0.0);
  EXPECT_EQ(pow(zero, 1.0).derivative[0], 1.0);
  EXPECT_EQ(pow(zero, 0.0).derivative[0], 0.0);
  EXPECT_EQ(pow(zero, Single(2.0)).derivative[0], 0.0);
}

TARGET_TEST(Dual, SineAndCosineMayOverwriteTheirArgument) {
  Single x = Single::variable(0.1, 0), c;
  const Single s = sin_turns(x);
  sincos_turns(x, x, c);
  EXPECT_EQ(x.value, s.value);
  EXPECT_EQ(x.derivative[0], s.derivative[0]);
}

TARGET_TEST(Dual, UpdatesInPlace) {
  Single d = Single::variable(2.0, 0);
  d *= d;
  d += 1.0;
  d -= Single::variable(3.0, 0);
  d /= 2.0;
  d *= 3;
  EXPECT_EQ(d.value, 3.0);
  EXPECT_EQ(d.derivative[0], 4.5);
}

TARGET_TEST(Dual, NestedGivesTheHessian) {
  // f = x^2 y^3 + exp(x y) + sqrt(x)
  const double x = 0.7, y = -0.4;
  Hessian p = Hessian::variable(Dual<double, 2>::variable(x, 0), 0);
  Hessian q = Hessian::variable(Dual<double, 2>::variable(y, 1), 1);
  const Hessian f = p * p * pow(q, 3.0) + exp(p * q) + sqrt(p) * 1.0;
  const double e = std::exp(x * y);
  EXPECT_NEAR(f.value.value, x * x * y * y * y + e + std::sqrt(x), kRounding);
  EXPECT_NEAR(f.value.derivative[0], 2 * x * y * y * y + y * e + 0.5 / std::sqrt(x), kRounding);
  EXPECT_NEAR(f.derivative[1].value, 3 * x * x * y * y + x * e, kRounding);
  EXPECT_NEAR(f.derivative[0].derivative[0], 2 * y * y * y + y * y * e - 0.25 / (x * std::sqrt(x)),
              kRounding);
  EXPECT_NEAR(f.derivative[0].derivative[1], 6 * x * y * y + (1 + x * y) * e, kRounding);
  EXPECT_EQ(f.derivative[0].derivative[1], f.derivative[1].derivative[0]);
  EXPECT_NEAR(f.derivative[1].derivative[1], 6 * x * x * y + x * x * e, kRounding);
}

TARGET_TEST(Dual, NestedAgreesWithDifferencesOfTheFirst) {
  using Second = Dual<Single, 1>;
  for (double x : {0.31, 0.81, 1.2, 1.7}) {
    const Second d = everything(Second::variable(Single::variable(x, 0), 0));
    const double up = everything(Single::variable(x + kDifferenceStep, 0)).derivative[0];
    const double down = everything(Single::variable(x - kDifferenceStep, 0)).derivative[0];
    const double curvature = (up - down) / (2 * kDifferenceStep);
    EXPECT_NEAR(d.derivative[0].derivative[0], curvature,
                kDifferenceError * (1 + std::abs(curvature)));
  }
}

TARGET_TEST(Dual, LanesHaveTheBitsOfScalars) {
  alignas(64) double x[kLanes];
  for (int i = 0; i < kLanes; ++i) x[i] = 0.31 + 0.27 * i;
  const Dual<Pack, 1> packed = everything(Dual<Pack, 1>::variable(Pack::load(x), 0));
  for (int i = 0; i < kLanes; ++i) {
    const Single alone = everything(Single::variable(x[i], 0));
    EXPECT_EQ(packed.value.lane(i), alone.value);
    EXPECT_EQ(packed.derivative[0].lane(i), alone.derivative[0]);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
