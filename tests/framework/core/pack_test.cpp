#include "framework/core/numbers/pack.hpp"

#include "framework/core/numbers/vec.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

constexpr double kTiny = 0x1p-1074;
constexpr double kInf = __builtin_inf();

struct alignas(64) Lanes {
  double v[kLanes];
};
Lanes lanes_of(Pack p) {
  Lanes r;
  p.store(r.v);
  return r;
}
std::uint64_t bits_of(double x) { return __builtin_bit_cast(std::uint64_t, x); }
Pack ramp() {
  const Lanes r = {{0, 1, 2, 3, 4, 5, 6, 7}};
  return Pack::load(r.v);
}

}  // namespace

TARGET_TEST(Pack, FmaRoundsOnce) {
  // (1 + e)(1 - e) - 1 = -e^2, which a product rounded before the sum turns into 0.
  const double e = 0x1p-30;
  EXPECT_EQ(fma(1 + e, 1 - e, -1.0), -e * e);
  EXPECT_EQ(lanes_of(fma(Pack(1 + e), Pack(1 - e), Pack(-1.0))).v[5], -e * e);
  EXPECT_EQ(fnma(1 + e, 1 - e, 1.0), e * e);
  volatile double product = (1 + e) * (1 - e);
  EXPECT_EQ(product - 1.0, 0.0);  // the control: unfused it is lost
  EXPECT_EQ(fma(1.0f + 0x1p-12f, 1.0f - 0x1p-12f, -1.0f), -0x1p-24f);
}

TARGET_TEST(Pack, RoundGoesToTheEvenHalf) {
  const double in[] = {0.5,  1.5,   2.5,   -0.5, -1.5, 0.49999999999999994, 4503599627370495.5,
                       -2.7, 1e300, -kInf, -0.0};
  const double out[] = {0.0,  2.0,   2.0,   -0.0, -2.0, 0.0, 4503599627370496.0,
                        -3.0, 1e300, -kInf, -0.0};
  for (int i = 0; i < 11; ++i) {
    EXPECT_EQ(bits_of(round(in[i])), bits_of(out[i])) << in[i];
    EXPECT_EQ(bits_of(round(Pack(in[i])).lane(i % kLanes)), bits_of(out[i])) << in[i];
  }
  EXPECT_EQ(round(2.5f), 2.0f);
  EXPECT_EQ(round(-3.5f), -4.0f);
}

TARGET_TEST(Pack, MinMaxSignAndRoot) {
  EXPECT_EQ(lanes_of(min(ramp(), Pack(3.0))).v[6], 3.0);
  EXPECT_EQ(lanes_of(max(ramp(), Pack(3.0))).v[6], 6.0);
  EXPECT_EQ(lanes_of(abs(-ramp())).v[6], 6.0);
  EXPECT_EQ(lanes_of(copysign(ramp(), Pack(-0.0))).v[6], -6.0);
  EXPECT_EQ(bits_of(lanes_of(sqrt(ramp())).v[2]), bits_of(sqrt(2.0)));
  // The second argument wins on a NaN and on a tie of zeros.
  const double nan = __builtin_nan("");
  EXPECT_EQ(min(nan, 1.0), 1.0);
  EXPECT_EQ(min(Pack(nan), Pack(1.0)).lane(0), 1.0);
  EXPECT_NE(min(Pack(1.0), Pack(nan)).lane(0), 1.0);
  EXPECT_EQ(bits_of(max(0.0, -0.0)), bits_of(-0.0));
  EXPECT_EQ(bits_of(max(Pack(0.0), Pack(-0.0)).lane(7)), bits_of(-0.0));
}

TARGET_TEST(Pack, SubnormalsAreNotFlushed) {
  const Pack tiny(kTiny);
  EXPECT_EQ(lanes_of(tiny + tiny).v[3], 2 * kTiny);
  EXPECT_EQ(lanes_of(Pack(0x1p-1000) * Pack(0x1p-74)).v[3], kTiny);
  EXPECT_EQ(lanes_of(fma(Pack(0x1p-1000), Pack(0x1p-73), tiny)).v[3], 3 * kTiny);
  EXPECT_TRUE(all(tiny > 0.0));
}

TARGET_TEST(Pack, BitOperations) {
  const double x = 1.5;
  EXPECT_EQ(bits_of(bits_shift_left<3>(x)), bits_of(x) << 3);
  EXPECT_EQ(bits_of(bits_shift_right<52>(Pack(x)).lane(2)), bits_of(x) >> 52);
  EXPECT_EQ(bits_of(bits_shift_right<52>(x)), bits_of(x) >> 52);
  EXPECT_EQ(bits_of(bits_add(x, 2.0)), bits_of(x) + bits_of(2.0));
  EXPECT_EQ(bits_of(bits_add(Pack(x), Pack(2.0)).lane(6)), bits_of(x) + bits_of(2.0));
  EXPECT_EQ(bits_xor(x, -0.0), -x);
  EXPECT_EQ(bits_or(Pack(x), Pack(-0.0)).lane(6), -x);
  EXPECT_EQ(bits_and(-x, -0.0), 0.0);
}

TARGET_TEST(Vec, OperationsAndTheOrderOfDot) {
  const Vec<double, 3> a{1.0, 2.0, 3.0}, b{-4.0, 0.5, 2.0};
  const Vec<double, 3> c = 2.0 * a + b - a * 0.5;
  EXPECT_EQ(c[0], -2.5);
  EXPECT_EQ(c[1], 3.5);
  EXPECT_EQ(c[2], 6.5);
  EXPECT_EQ(dot(a, b), 3.0);
  EXPECT_EQ(norm_squared(a), 14.0);
  EXPECT_EQ((-a)[1], -2.0);
  EXPECT_EQ(fma(2.0, a, b)[2], 8.0);
  Vec<double, 3> d = a;
  d += b;
  d -= a;
  d *= 2.0;
  EXPECT_EQ(d[0], -8.0);

  // Axis 0 first: 1 is lost beside 1e16, the small one after the cancellation is not.
  const Vec<double, 3> p{1e16, 1.0, 1e16}, q{1.0, 1.0, -1.0};
  EXPECT_EQ(dot(p, q), fma(1e16, -1.0, fma(1.0, 1.0, 1e16)));

  const Vec<Pack, 2> u{ramp(), Pack(2.0)};
  EXPECT_EQ(dot(u, u).lane(3), 13.0);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
