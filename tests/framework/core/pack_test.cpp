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
unsigned mask_bits(PackMask m) {
  const Lanes r = lanes_of(select(m, Pack(1.0), Pack(0.0)));
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= r.v[i] != 0.0 ? 1u << i : 0u;
  return bits;
}

}  // namespace

TARGET_TEST(Pack, LoadStoreBroadcast) {
  double odd[kLanes + 1];
  for (int i = 0; i <= kLanes; ++i) odd[i] = 10.0 + i;
  const Pack p = Pack::load_unaligned(odd + 1);
  double back[kLanes + 1] = {};
  p.store_unaligned(back + 1);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(back[i + 1], 11.0 + i);
    EXPECT_EQ(p.lane(i), 11.0 + i);
    EXPECT_EQ(lanes_of(2.5).v[i], 2.5);
  }
  EXPECT_EQ(back[0], 0.0);
}

TARGET_TEST(Pack, ArithmeticIsThatOfDoublesInEveryLane) {
  TestNumbers numbers(1);
  for (int round_number = 0; round_number < 500; ++round_number) {
    Lanes a, b, c;
    for (int i = 0; i < kLanes; ++i) {
      a.v[i] = numbers.uniform(-3, 3), b.v[i] = numbers.uniform(-3, 3);
      c.v[i] = -a.v[i] * b.v[i];  // makes the fused product differ from the unfused one
    }
    const Pack x = Pack::load(a.v), y = Pack::load(b.v), z = Pack::load(c.v);
    Pack updated = x;
    updated += y;
    updated *= x;
    updated -= y;
    const Lanes add = lanes_of(x + y), sub = lanes_of(x - y), mul = lanes_of(x * y);
    const Lanes div = lanes_of(x / y), neg = lanes_of(-x), fused = lanes_of(fma(x, y, z));
    const Lanes fused_negative = lanes_of(fnma(x, y, z)), update = lanes_of(updated);
    for (int i = 0; i < kLanes; ++i) {
      const double p = a.v[i], q = b.v[i];
      EXPECT_EQ(bits_of(add.v[i]), bits_of(p + q));
      EXPECT_EQ(bits_of(sub.v[i]), bits_of(p - q));
      EXPECT_EQ(bits_of(mul.v[i]), bits_of(p * q));
      EXPECT_EQ(bits_of(div.v[i]), bits_of(p / q));
      EXPECT_EQ(bits_of(neg.v[i]), bits_of(-p));
      EXPECT_EQ(bits_of(fused.v[i]), bits_of(fma(p, q, c.v[i])));
      EXPECT_EQ(bits_of(fused_negative.v[i]), bits_of(fnma(p, q, c.v[i])));
      EXPECT_EQ(bits_of(update.v[i]), bits_of((p + q) * p - q));
    }
  }
}

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

TARGET_TEST(Pack, SumFollowsTheOneRule) {
  // Numbers whose sum depends on the order.
  const Lanes a = {{1e16, 1.0, -1e16, 3.0, 1.0, 1e-3, 7.0, -1e16}};
  const double* v = a.v;
  const double rule = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
  double in_order = 0;
  for (double x : a.v) in_order += x;
  EXPECT_EQ(sum(Pack::load(v)), rule);
  EXPECT_NE(rule, in_order);  // the control
  EXPECT_EQ(sum(ramp()), 28.0);
}

TARGET_TEST(Pack, ComparisonsAndMasks) {
  const Pack r = ramp();
  EXPECT_EQ(mask_bits(r < 3.0), 0x07u);
  EXPECT_EQ(mask_bits(r <= 3.0), 0x0fu);
  EXPECT_EQ(mask_bits(r > 3.0), 0xf0u);
  EXPECT_EQ(mask_bits(r >= 3.0), 0xf8u);
  EXPECT_EQ(mask_bits(r == 3.0), 0x08u);
  EXPECT_EQ(mask_bits(r != 3.0), 0xf7u);
  EXPECT_EQ(mask_bits((r > 1.0) & (r < 4.0)), 0x0cu);
  EXPECT_EQ(mask_bits((r < 1.0) | (r > 6.0)), 0x81u);
  EXPECT_EQ(mask_bits(!(r < 3.0)), 0xf8u);
  EXPECT_TRUE(any(r == 7.0));
  EXPECT_TRUE(any(r == 0.0));
  EXPECT_FALSE(any(r > 7.0));
  EXPECT_TRUE(all(r < 8.0));
  EXPECT_FALSE(all(r < 7.0));
  EXPECT_FALSE(all(r > 0.0));
  for (int n = -1; n <= kLanes + 1; ++n) {
    const int inside = n < 0 ? 0 : n > kLanes ? kLanes : n;
    EXPECT_EQ(mask_bits(first_lanes(n)), (1u << inside) - 1u) << n;
  }
  const Pack nan(__builtin_nan(""));
  EXPECT_FALSE(any((nan < r) | (nan > r) | (nan == nan)));
  EXPECT_TRUE(all(nan != nan));
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
