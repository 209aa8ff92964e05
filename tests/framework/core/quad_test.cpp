#include "framework/core/numbers/quad.hpp"

#include <algorithm>
#include <cstdint>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
namespace {

// 300 bits, and exponents beyond those of a Quad.
using Exact = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<300, boost::multiprecision::digit_base_2, void,
                                         std::int32_t, -100000, 100000>,
    boost::multiprecision::et_off>;
using Bits = unsigned __int128;

constexpr double kInfinity = __builtin_inf();
const double kNan = __builtin_nan("");
constexpr int kSamples = 3000;

// Bounds in units of the last place, a little above the worst of 1e5 samples.
constexpr double kRounded = 0.5;     // one operation
constexpr double kTurnsError = 1.9;  // of 2 pi, the reduced angle, the library's function
constexpr double kExpError = 0.6;
constexpr double kLogError = 0.8;
constexpr double kPowError = 2.5;      // of results in the range of doubles
constexpr double kFarPowError = 30.0;  // it grows with the logarithm of the result
constexpr double kAtanError = 1.3;
constexpr double kAtan2Error = 1.8;  // of the quotient as well
constexpr double kAsinError = 1.2;
constexpr double kTangentError = 4.0;  // of sine, cosine, and their quotient

Exact exact(Quad x) {
  const auto bits = __builtin_bit_cast(Bits, x);
  const int field = static_cast<int>(bits >> 112) & 0x7fff;
  Bits significand = bits & ((Bits{1} << 112) - 1);
  if (field != 0) significand |= Bits{1} << 112;
  const Exact high(static_cast<std::uint64_t>(significand >> 64));
  const Exact magnitude = ldexp(high, 64) + Exact(static_cast<std::uint64_t>(significand));
  const Exact scaled = ldexp(magnitude, std::max(field, 1) - 16383 - 112);
  return bits >> 127 ? Exact(-scaled) : scaled;
}
double error_in_units(Quad x, const Exact& reference) {
  int exponent;
  frexp(reference, &exponent);
  const Exact unit = ldexp(Exact(1), std::max(exponent - 113, -16494));
  return abs(Exact((exact(x) - reference) / unit)).convert_to<double>();
}

struct Worst {
  double error = 0;
  void add(Quad got, const Exact& reference) {
    const double e = error_in_units(got, reference);
    if (!(e <= error)) error = e;
  }
};

// All 113 bits of it random.
class QuadNumbers {
 public:
  explicit QuadNumbers(std::uint64_t seed) : numbers_(seed) {}
  Quad uniform(double low, double high) {
    const Quad high_bits(numbers_.bits()), low_bits(numbers_.bits());
    const Quad fraction = high_bits * Quad(0x1p-64) + low_bits * Quad(0x1p-128);
    return Quad(low) + (Quad(high) - Quad(low)) * fraction;
  }
  // Positive, all exponents equally likely, subnormals among them.
  Quad any_positive() {
    const Bits high = numbers_.bits() >> 1;
    const auto x = __builtin_bit_cast(Quad, high << 64 | numbers_.bits());
    return x < Quad(kInfinity) ? x : Quad(1);
  }

 private:
  TestNumbers numbers_;
};

bool is_nan(Quad x) { return x != x; }
const Quad kTiny = __builtin_bit_cast(Quad, Bits{1});  // 2^-16494

}  // namespace

TEST(Quad, HasTheDigitsOfBinary128) {
  QuadNumbers numbers(41);
  Worst worst;
  for (int i = 0; i < kSamples; ++i) {
    const Quad a = numbers.uniform(-3, 3), b = numbers.uniform(-3, 3);
    worst.add(a + b, exact(a) + exact(b));
    worst.add(a - b, exact(a) - exact(b));
    worst.add(a * b, exact(a) * exact(b));
    worst.add(a / b, exact(a) / exact(b));
  }
  EXPECT_LE(worst.error, kRounded);
  EXPECT_GT(worst.error, 0.99 * kRounded);
  // The control: a double has not.
  const Quad third = Quad(1) / Quad(3);
  EXPECT_GT(error_in_units(Quad(static_cast<double>(third)), exact(third)), 0x1p50);
}

TEST(Quad, Converts) {
  EXPECT_EQ(static_cast<double>(Quad(0.1)), 0.1);
  EXPECT_EQ(static_cast<double>(Quad(1) + Quad(0x1p-53) + Quad(0x1p-100)), 1.0 + 0x1p-52);
  EXPECT_TRUE(Quad(3) == Quad(3.0));
  static_assert(!std::is_convertible_v<Quad, double> && std::is_convertible_v<double, Quad>);
  static_assert(std::is_trivially_copyable_v<Quad> && sizeof(Quad) == 16);
}

TEST(Quad, RootIsRoundedOnce) {
  QuadNumbers numbers(42);
  Worst worst;
  for (int i = 0; i < kSamples; ++i) {
    const Quad x = i % 2 ? numbers.any_positive() : numbers.uniform(0.5, 2);
    worst.add(sqrt(x), sqrt(exact(x)));
    EXPECT_TRUE(sqrt(Quad(i) * Quad(i)) == Quad(i));
  }
  EXPECT_LE(worst.error, kRounded);
  EXPECT_TRUE(sqrt(Quad(kInfinity)) == Quad(kInfinity));
  EXPECT_TRUE(is_nan(sqrt(Quad(-1))));
  EXPECT_TRUE(is_nan(sqrt(Quad(kNan))));
  EXPECT_TRUE(Quad(1) / sqrt(Quad(-0.0)) == Quad(-kInfinity));
}

TEST(Quad, SineAndCosineAreAccurate) {
  QuadNumbers numbers(43);
  const Exact two_pi = 4 * acos(Exact(0));
  Worst worst;
  for (int i = 0; i < kSamples; ++i) {
    const double ranges[] = {1, 0.126, 5000, 0x1p80, 0x1p-60};
    const double range = ranges[i % 5];
    // Near the zeros of the cosine as well, where an error of the reduction would show.
    const Quad x = numbers.uniform(-range, range) + Quad(i % 7 ? 0 : 0.25);
    Exact rest = exact(x);
    rest -= round(rest);
    Quad s, c;
    sincos_turns(x, s, c);
    worst.add(s, sin(Exact(two_pi * rest)));
    worst.add(c, cos(Exact(two_pi * rest)));
    EXPECT_TRUE(s == sin_turns(x) && c == cos_turns(x));
  }
  EXPECT_LT(worst.error, kTurnsError);
  EXPECT_GT(worst.error, 0.5 * kTurnsError);
}

TEST(Quad, TauIsRoundedOnce) {
  const Exact two_pi = 4 * acos(Exact(0));
  EXPECT_LE(error_in_units(tau<Quad>(), two_pi), kRounded);
  EXPECT_GT(error_in_units(Quad(tau<double>()), two_pi), 0x1p50);  // the control
}

TEST(Quad, QuartersOfATurnAreExact) {
  const double sines[] = {0, 1, 0, -1};
  for (int i = -9; i < 10; ++i) {
    EXPECT_TRUE(sin_turns(Quad(0.25 * i)) == Quad(sines[(i + 12) % 4])) << i;
    EXPECT_TRUE(cos_turns(Quad(0.25 * i)) == Quad(sines[(i + 13) % 4])) << i;
  }
  EXPECT_TRUE(cos_turns(Quad(0x1p200)) == Quad(1));
  for (const double bad : {kInfinity, -kInfinity, kNan}) {
    EXPECT_TRUE(is_nan(sin_turns(Quad(bad))) && is_nan(cos_turns(Quad(bad))));
  }
}

TEST(Quad, ExpAndLogAreAccurate) {
  QuadNumbers numbers(44);
  Worst exponential, logarithm;
  for (int i = 0; i < kSamples; ++i) {
    const Quad x = i % 2 ? numbers.uniform(-1, 1) : numbers.uniform(-11430, 11356);
    exponential.add(exp(x), exp(exact(x)));
    const Quad y = i % 3 == 0   ? numbers.any_positive()
                   : i % 3 == 1 ? numbers.uniform(0.5, 2)
                                : numbers.uniform(0.9999, 1.0001);
    logarithm.add(log(y), log(exact(y)));
  }
  EXPECT_LT(exponential.error, kExpError);
  EXPECT_LT(logarithm.error, kLogError);
  EXPECT_TRUE(exp(Quad(0)) == Quad(1));
  EXPECT_TRUE(exp(Quad(11357)) == Quad(kInfinity));
  EXPECT_TRUE(exp(Quad(-11434)) == Quad(0));
  EXPECT_TRUE(exp(Quad(-11432)) > Quad(0));
  EXPECT_TRUE(exp(Quad(kInfinity)) == Quad(kInfinity) && exp(Quad(-kInfinity)) == Quad(0));
  EXPECT_TRUE(is_nan(exp(Quad(kNan))));
  EXPECT_TRUE(log(Quad(1)) == Quad(0));
  EXPECT_TRUE(log(Quad(0)) == Quad(-kInfinity) && log(Quad(kInfinity)) == Quad(kInfinity));
  EXPECT_TRUE(is_nan(log(Quad(-1))) && is_nan(log(Quad(kNan))));
  EXPECT_LT(error_in_units(log(kTiny), log(exact(kTiny))), kLogError);
}

TEST(Quad, PowIsAccurate) {
  QuadNumbers numbers(45);
  Worst worst, far;
  for (int i = 0; i < kSamples; ++i) {
    const Quad x = i % 2 ? numbers.any_positive() : numbers.uniform(0.5, 2);
    // Exponents as large as the results allow.
    const Quad small = numbers.uniform(-709, 709) / log(x), y = numbers.uniform(-3, 3);
    const Quad large = i % 4 < 2 ? y : numbers.uniform(-11350, 11350) / log(x);
    worst.add(pow(x, small), exp(Exact(exact(small) * log(exact(x)))));
    const Exact power = exp(Exact(exact(large) * log(exact(x))));
    if (power < ldexp(Exact(1), 16383)) far.add(pow(x, large), power);
  }
  EXPECT_LT(worst.error, kPowError);
  EXPECT_LT(far.error, kFarPowError);
  EXPECT_GT(far.error, 0.5 * kFarPowError);
}

TEST(Quad, PowSpecialValues) {
  const Quad infinity(kInfinity);
  EXPECT_TRUE(pow(Quad(2), Quad(10)) == Quad(1024));
  EXPECT_TRUE(pow(Quad(-2), Quad(3)) == Quad(-8));
  EXPECT_TRUE(pow(Quad(-2), Quad(4)) == Quad(16));
  EXPECT_TRUE(pow(Quad(0), Quad(2.5)) == Quad(0));
  EXPECT_TRUE(pow(Quad(0), Quad(-1)) == infinity);
  EXPECT_TRUE(pow(infinity, Quad(0.5)) == infinity);
  EXPECT_TRUE(pow(infinity, Quad(-0.5)) == Quad(0));
  EXPECT_TRUE(pow(Quad(0.5), infinity) == Quad(0));
  EXPECT_TRUE(pow(Quad(2), Quad(16384)) == infinity);
  EXPECT_TRUE(pow(Quad(2), Quad(-16494)) == kTiny);
  for (const double x : {0.0, -2.0, kInfinity, kNan}) EXPECT_TRUE(pow(Quad(x), Quad(0)) == Quad(1));
  EXPECT_TRUE(pow(Quad(1), Quad(kNan)) == Quad(1));
  EXPECT_TRUE(is_nan(pow(Quad(-2), Quad(0.5))));
  EXPECT_TRUE(is_nan(pow(Quad(kNan), Quad(1))));
  EXPECT_TRUE(is_nan(pow(Quad(2), Quad(kNan))));
}

// Recorded once, as kMathBits of double is. What is rounded once has the same bits everywhere;
// functions have errors, and their bits may change with the C library.
constexpr std::uint64_t kQuadBits = 4740250219984360843u;

TEST(Quad, ArithmeticHasTheSameBitsEverywhere) {
  QuadNumbers numbers(46);
  std::uint64_t hash = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Quad a = numbers.uniform(-4, 4), b = numbers.any_positive(), c = numbers.uniform(-4, 4);
    for (const Quad x :
         {a + b, a - c, a * b, a / c, fma(a, b, c), fnma(a, c, b), sqrt(b), round(a), floor(a)}) {
      const auto bits = __builtin_bit_cast(Bits, x);
      for (const Bits part : {bits >> 64, bits}) {
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
      }
    }
  }
  EXPECT_EQ(hash, kQuadBits);
}

TEST(Quad, InverseFunctionsAreAccurate) {
  QuadNumbers numbers(47);
  Worst tangent, two, sine, cosine;
  for (int i = 0; i < kSamples; ++i) {
    const Quad x = i % 3 == 0   ? numbers.uniform(-3, 3)
                   : i % 3 == 1 ? numbers.uniform(0.41, 0.52)
                                : numbers.any_positive();
    const Quad y = numbers.uniform(-1, 1);
    tangent.add(atan(x), atan(exact(x)));
    two.add(atan2(y, x), atan2(exact(y), exact(x)));
    const Quad s = i % 2 ? y : Quad(1) - abs(y) * Quad(1e-6);
    sine.add(asin(s), asin(exact(s)));
    cosine.add(acos(s), acos(exact(s)));
  }
  EXPECT_LT(tangent.error, kAtanError);
  EXPECT_LT(two.error, kAtan2Error);
  EXPECT_LT(sine.error, kAsinError);
  EXPECT_LT(cosine.error, kAsinError);
  // The bounds are no looser than they need be.
  EXPECT_GT(tangent.error, 0.7 * kAtanError);
  EXPECT_GT(sine.error, 0.7 * kAsinError);
}

TEST(Quad, InverseFunctionsSpecialValues) {
  const Quad infinity(kInfinity), pi = tau<Quad>() * Quad(0.5);
  const auto same = [](Quad a, Quad b) {
    return a == b && copysign(Quad(1), a) == copysign(Quad(1), b);
  };
  for (const Quad sign : {Quad(1), Quad(-1)}) {
    EXPECT_TRUE(same(atan2(sign * Quad(0), Quad(0)), sign * Quad(0)));
    EXPECT_TRUE(same(atan2(sign * Quad(0), -Quad(0)), sign * pi));
    EXPECT_TRUE(same(atan2(sign * Quad(0), Quad(-2)), sign * pi));
    EXPECT_TRUE(same(atan2(sign, Quad(0)), sign * pi * Quad(0.5)));
    EXPECT_TRUE(same(atan2(sign * infinity, infinity), sign * pi * Quad(0.25)));
    EXPECT_TRUE(same(atan2(sign, infinity), sign * Quad(0)));
    EXPECT_TRUE(same(atan(sign * infinity), sign * pi * Quad(0.5)));
    EXPECT_TRUE(same(asin(sign * Quad(0)), sign * Quad(0)));
    EXPECT_TRUE(same(asin(sign), sign * pi * Quad(0.5)));
    EXPECT_TRUE(same(floor(sign * Quad(0)), sign * Quad(0)));
    EXPECT_TRUE(same(atan2(sign * kTiny, kTiny), sign * pi * Quad(0.25)));
  }
  EXPECT_TRUE(same(acos(Quad(1)), Quad(0)) && same(acos(Quad(-1)), pi));
  EXPECT_TRUE(is_nan(asin(Quad(1.5))) && is_nan(acos(Quad(-1.5))) && is_nan(atan(Quad(kNan))));
  EXPECT_TRUE(is_nan(atan2(Quad(kNan), infinity)) && is_nan(atan2(infinity, Quad(kNan))));
  EXPECT_TRUE(floor(Quad(-0.5)) == Quad(-1) && floor(Quad(1.5)) == Quad(1));
  EXPECT_TRUE(floor(Quad(0x1p80) + Quad(0.75)) == Quad(0x1p80));
  EXPECT_LT(error_in_units(tan_turns(Quad(0.125)), Exact(1)), kTangentError);
  // The ratio of the smallest and the largest numbers.
  EXPECT_LT(error_in_units(atan2(kTiny, Quad(3) * kTiny), atan(Exact(1) / 3)), kAtan2Error);
  const Quad huge = __builtin_bit_cast(Quad, Bits{0x7ffe} << 112);
  EXPECT_LT(error_in_units(atan2(huge, huge * Quad(1.25)), atan(Exact(4) / 5)), kAtan2Error);
}

TEST(Quad, RoundGoesToTheEvenHalf) {
  EXPECT_TRUE(round(Quad(0.5)) == Quad(0) && round(Quad(1.5)) == Quad(2));
  EXPECT_TRUE(round(Quad(-2.5)) == Quad(-2) && round(Quad(-2.75)) == Quad(-3));
  EXPECT_TRUE(round(Quad(0x1p111) + Quad(0.5)) == Quad(0x1p111));
  EXPECT_TRUE(round(Quad(0x1p120)) == Quad(0x1p120));
  EXPECT_TRUE(Quad(1) / round(Quad(-0.25)) == Quad(-kInfinity));
}

}  // namespace tomlin
