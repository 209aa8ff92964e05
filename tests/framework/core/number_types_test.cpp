// Every number type has to offer the same operations: double, Quad and their packs alike.
#include "framework/core/numbers/number_types.hpp"

#include <algorithm>
#include <cstdint>

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/hyperbolic.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

namespace {

template <class F>
void for_each_real(F f) {
  f.template operator()<double>();
  f.template operator()<Quad>();
}

template <class Real>
struct alignas(64) Eight {
  Real v[kLanes];
};
template <class P>
Eight<Scalar<P>> lanes_of(const P& p) {
  Eight<Scalar<P>> r;
  p.store(r.v);
  return r;
}
template <class Real>
Packed<Real> ramp() {
  const Eight<Real> r = {{0, 1, 2, 3, 4, 5, 6, 7}};
  return Packed<Real>::load(r.v);
}
template <class P>
unsigned mask_bits(const Mask<P>& mask) {
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= select(mask, P(1), P(0)).lane(i) != 0 ? 1u << i : 0u;
  return bits;
}
// Compares values and signs; two NaNs are the same.
template <class Real>
bool same(Real a, Real b) {
  if (a != a || b != b) return a != a && b != b;
  return a == b && copysign(Real(1), a) == copysign(Real(1), b);
}

struct {
  template <class Real>
  Real operator()(TestNumbers& numbers) const {
    const double specials[] = {0.0, -0.0, __builtin_inf(), __builtin_nan(""), 0.5, -1.5};
    const std::uint64_t choice = numbers.bits() % 32;
    if (choice < 6) return static_cast<Real>(specials[choice]);
    // More bits than a double has, which only Quad keeps.
    const Quad coarse = numbers.uniform(-9, 9);
    const Quad fine = coarse + Quad(numbers.uniform(-1, 1)) * Quad(0x1p-60);
    return static_cast<Real>(fine);
  }
} const any_number;

// f(a, b, c) of a pack has in every lane the bits of the scalars' result.
template <class Real, class F>
void expect_lanes_of_scalars(F f, const char* name) {
  TestNumbers numbers(31);
  for (int repeat = 0; repeat < 40; ++repeat) {
    Eight<Real> a, b, c;
    for (int i = 0; i < kLanes; ++i) {
      a.v[i] = any_number.operator()<Real>(numbers);
      b.v[i] = any_number.operator()<Real>(numbers);
      c.v[i] = any_number.operator()<Real>(numbers);
    }
    using P = Packed<Real>;
    const P result = f(P::load(a.v), P::load(b.v), P::load(c.v));
    for (int i = 0; i < kLanes; ++i) {
      ASSERT_TRUE(same<Real>(result.lane(i), f(a.v[i], b.v[i], c.v[i]))) << name << " lane " << i;
    }
  }
}

struct {
  template <class T>
  T operator()(T x) const {
    T s, c;
    sincos_turns(x, s, c);
    return fma(s, x, T(2.0) * c) / (T(1.5) + x * x) - sqrt(x + T(3.0)) * exp(T(-0.5) * x) +
           pow(x, T(2.5)) * log(x) + pow(x, x) + fnma(x, x, T(1.0)) * sin_turns(x / T(3.0)) -
           cos_turns(x) + abs(x - T(2.0)) + copysign(x, -x) + max(x, T(0.75)) * min(x, T(0.5)) +
           round(x) + select(x < T(1.0), x, -x);
  }
} const everything;

// The inverse functions, whose derivatives are in a header of their own.
struct {
  template <class T>
  T operator()(T x) const {
    return atan(x) + atan2(x, T(0.5) - x) + asin(x / T(3.0)) - acos(x / T(4.0)) +
           tan_turns(x / T(16.0)) + floor(x) * x + sinh(x) * tanh(x) + cosh(x) +
           sign(x - T(1.0)) * x + unit_step(x - T(1.0)) * x;
  }
} const inverse_functions;

// With constants beside the Dual, in the types that a force may have at hand.
struct {
  template <class T>
  T operator()(T x) const {
    return 2.0 * x - x / 3 + (x - 0.1) * (1.0 / x) + pow(x, 1.5) + pow(2.0, x) + 0.3 - x +
           atan2(x, 0.5) * atan2(2, x);
  }
} const with_constants;

template <class A, class B>
void expect_same_dual(const A& packed, const B& alone, int lane) {
  EXPECT_TRUE(same(packed.value.lane(lane), alone.value)) << lane;
  EXPECT_TRUE(same(packed.derivative[0].lane(lane), alone.derivative[0])) << lane;
}

}  // namespace

TARGET_TEST(NumberTypes, LanesHaveTheBitsOfScalars) {
  for_each_real([]<class Real>() {
#define EXPECT_LANES(expression)                                          \
  expect_lanes_of_scalars<Real>(                                          \
      [](auto x, auto y, auto z) {                                        \
        static_cast<void>(x), static_cast<void>(y), static_cast<void>(z); \
        return expression;                                                \
      },                                                                  \
      #expression)
    EXPECT_LANES(x + y);
    EXPECT_LANES(x - y);
    EXPECT_LANES(x * y);
    EXPECT_LANES(x / y);
    EXPECT_LANES(-x);
    EXPECT_LANES(x += y);
    EXPECT_LANES(x -= y);
    EXPECT_LANES(x *= y);
    EXPECT_LANES(x /= y);
    EXPECT_LANES(fma(x, y, z));
    EXPECT_LANES(fma(x, y, -(x * y)));
    EXPECT_LANES(fnma(x, y, z));
    EXPECT_LANES(sqrt(x));
    EXPECT_LANES(abs(x));
    EXPECT_LANES(round(x));
    EXPECT_LANES(min(x, y));
    EXPECT_LANES(max(x, y));
    EXPECT_LANES(copysign(x, y));
    EXPECT_LANES(select((x < y) | !(y <= z), x, select((x > z) & (x != y), y, z)));
    EXPECT_LANES(select(x >= y, x, select(y == z, y, z)));
    EXPECT_LANES(sin_turns(x));
    EXPECT_LANES(cos_turns(x));
    EXPECT_LANES(exp(x));
    EXPECT_LANES(log(x));
    EXPECT_LANES(pow(x, y));
    EXPECT_LANES(atan(x));
    EXPECT_LANES(atan2(y, x));
    EXPECT_LANES(asin(x / decltype(x)(9.0)));
    EXPECT_LANES(acos(x / decltype(x)(9.0)));
    EXPECT_LANES(tan_turns(x));
    EXPECT_LANES(floor(x));
    EXPECT_LANES(sinh(x));
    EXPECT_LANES(cosh(x));
    EXPECT_LANES(tanh(x));
    EXPECT_LANES(sign(x));
    EXPECT_LANES(unit_step(x));
#undef EXPECT_LANES
    expect_lanes_of_scalars<Real>(
        [](auto x, auto, auto) {
          decltype(x) s, c;
          sincos_turns(x, s, c);
          return s + c * c;
        },
        "sincos_turns");
  });
}

TARGET_TEST(NumberTypes, LoadStoreBroadcast) {
  for_each_real([]<class Real>() {
    using P = Packed<Real>;
    Real odd[kLanes + 1], back[kLanes + 1] = {};
    for (int i = 0; i <= kLanes; ++i) odd[i] = Real(10 + i);
    const P p = P::load_unaligned(odd + 1);
    p.store_unaligned(back + 1);
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_TRUE(back[i + 1] == Real(11 + i));
      EXPECT_TRUE(p.lane(i) == Real(11 + i));
      EXPECT_TRUE(lanes_of(P(2.5)).v[i] == Real(2.5));
    }
    EXPECT_TRUE(back[0] == Real(0));
  });
}

TARGET_TEST(NumberTypes, SumFollowsTheOneRule) {
  for_each_real([]<class Real>() {
    Real big = 1;
    while (big + Real(1) != big) big *= 2;
    const Eight<Real> a = {{big, 1, 1, 1, -big, 0, 0, 0}};
    const Real* v = a.v;
    const Real rule = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
    Real in_order = 0;
    for (const Real x : a.v) in_order += x;
    EXPECT_TRUE(sum(Packed<Real>::load(v)) == rule);
    EXPECT_FALSE(rule == in_order);  // the control
    EXPECT_TRUE(sum(ramp<Real>()) == Real(28));
  });
}

TARGET_TEST(NumberTypes, ComparisonsAndMasks) {
  for_each_real([]<class Real>() {
    using P = Packed<Real>;
    const P r = ramp<Real>(), three(3), nan(__builtin_nan(""));
    EXPECT_EQ(mask_bits<P>(r < three), 0x07u);
    EXPECT_EQ(mask_bits<P>(r <= three), 0x0fu);
    EXPECT_EQ(mask_bits<P>(r > three), 0xf0u);
    EXPECT_EQ(mask_bits<P>(r >= three), 0xf8u);
    EXPECT_EQ(mask_bits<P>(r == three), 0x08u);
    EXPECT_EQ(mask_bits<P>(r != three), 0xf7u);
    EXPECT_EQ(mask_bits<P>((r < three) & (r > P(1))), 0x04u);
    EXPECT_EQ(mask_bits<P>((r < P(1)) | (r > P(6))), 0x81u);
    EXPECT_EQ(mask_bits<P>(!(r < three)), 0xf8u);
    EXPECT_TRUE(any(r == P(7)) && !any(r > P(7)) && all(r < P(8)) && !all(r < P(7)));
    EXPECT_FALSE(any((nan < r) | (nan > r) | (nan == nan)));
    EXPECT_TRUE(all(nan != nan));
    for (int n = -1; n <= kLanes + 1; ++n) {
      const int inside = n < 0 ? 0 : n > kLanes ? kLanes : n;
      EXPECT_EQ(mask_bits<P>(first_lanes_of<P>(n)), (1u << inside) - 1u) << n;
    }
  });
}

TARGET_TEST(NumberTypes, PermuteAndThreeLanes) {
  for_each_real([]<class Real>() {
    const std::int64_t order[kLanes] = {7, 0, 3, 3, 5, 1, 6, 2};
    const Packed<Real> moved = permute(ramp<Real>(), order);
    const Packed<Real> three = three_lanes(Real(1), Real(2), Real(3));
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_TRUE(moved.lane(i) == Real(order[i])) << i;
      EXPECT_TRUE(three.lane(i) == Real(i < 3 ? i + 1 : 0)) << i;
    }
  });
}

TARGET_TEST(NumberTypes, TauIsRoundedOnce) {
  EXPECT_EQ(tau<double>(), 0x1.921fb54442d18p+2);
  // tau<Quad>() itself is compared with more digits in quad_test.cpp.
  EXPECT_TRUE(tau<QuadPack>().lane(5) == tau<Quad>());
  EXPECT_EQ(tau<Pack>().lane(5), tau<double>());
  const auto nested = tau<Dual<Dual<Pack, 2>, 3>>();
  EXPECT_EQ(nested.value.value.lane(1), tau<double>());
  EXPECT_EQ(nested.value.derivative[1].lane(1), 0.0);
  EXPECT_EQ(nested.derivative[2].value.lane(1), 0.0);
}

TARGET_TEST(NumberTypes, DualLanesHaveTheBitsOfScalars) {
  for_each_real([]<class Real>() {
    using P = Packed<Real>;
    Eight<Real> x;
    for (int i = 0; i < kLanes; ++i) x.v[i] = Real(0.31 + 0.27 * i);
    const auto packed = Dual<P, 1>::variable(P::load(x.v), 0);
    for (int i = 0; i < kLanes; ++i) {
      const auto alone = Dual<Real, 1>::variable(x.v[i], 0);
      expect_same_dual(everything(packed), everything(alone), i);
      expect_same_dual(with_constants(packed), with_constants(alone), i);
      expect_same_dual(inverse_functions(packed), inverse_functions(alone), i);
      EXPECT_TRUE(same(everything(packed).value.lane(i), everything(x.v[i])));
    }
  });
}

// Second derivatives in double and in Quad agree to the rounding of double, which the second
// derivative of x^2.5 log x and the like multiplies by up to a hundred.
template <class F>
double second_derivative_distance(F function, double x) {
  const auto at = [&]<class Real>(Real) {
    using Second = Dual<Dual<Real, 1>, 1>;
    const auto f = function(Second::variable(Dual<Real, 1>::variable(Real(x), 0), 0));
    return f.derivative[0].derivative[0];
  };
  const Quad exact = at(Quad());
  return static_cast<double>(abs(Quad(at(double())) - exact) / (Quad(1) + abs(exact)));
}

TARGET_TEST(NumberTypes, SecondDerivativesAgreeToTheRounding) {
  constexpr double kRoundings = 100;
  double distance = 0;
  for (double x : {0.3125, 0.8125, 1.25, 1.75}) {
    distance = std::max(distance, second_derivative_distance(everything, x));
    distance = std::max(distance, second_derivative_distance(inverse_functions, x));
  }
  EXPECT_LT(distance, kRoundings * 0x1p-53);
  // The control: a double is not as good as a Quad.
  EXPECT_GT(distance, 0x1p-57);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
