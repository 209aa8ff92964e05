// A fingerprint of every operation on a fixed set of numbers, to prove that scalars and packs, and
// one instruction set and another, give the same bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/math.hpp"
#include "tests/framework/core/target_test.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

class BitsHash {
 public:
  void add(double x) {
    // The standard leaves sign and payload of a NaN open; they are not part of the promise.
    const std::uint64_t bits = x != x ? 0x7ff8000000000000u : __builtin_bit_cast(std::uint64_t, x);
    state_ = (state_ ^ bits) * 0x9e3779b97f4a7c15u;
    state_ ^= state_ >> 29;
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x243f6a8885a308d3u;
};

// The functions end at these numbers: subnormals, the phase, the exponential.
struct TestRange {
  static constexpr double kTiny = 0x1p-1074, kNormal = 0x1p-1022, kHuge = 1e300, kSmall = 1e-300;
  static constexpr double kTurns = 0x1p50;
  static constexpr double kExpHighest = 709.782712893384, kExpLowest = -745.13321910194122;
  static constexpr double kBeyondLow = -750, kBeyondHigh = 720;
  static constexpr double kInfinity = __builtin_inf(), kNan = __builtin_nan("");
  static constexpr double kMax = std::numeric_limits<double>::max();
};

/// The largest error in units of the last place, which no longer shrinks for subnormal numbers; a
/// NaN is worse than everything.
struct WorstError {
  double error = 0;
  void add(double got, long double exact) {
    int exponent;
    frexpl(exact, &exponent);
    const double unit = ldexp(1.0, std::max(exponent - 53, -1074));
    const double e = static_cast<double>(fabsl(got - exact)) / unit;
    if (!(e <= error)) error = e;
  }
};

/// Central differences of this step err by h^2 f'''/6 and by rounding/h.
inline constexpr double kDifferenceStep = 1e-5;
inline constexpr double kDifferenceError = 3e-7;

/// Returns how far the derivative that f has in dual numbers is off its central difference.
template <class F>
double difference_error(F f, double x) {
  const double slope = (f(x + kDifferenceStep) - f(x - kDifferenceStep)) / (2 * kDifferenceStep);
  const auto d = f(Dual<double, 1>::variable(x, 0));
  return std::abs(d.derivative[0] - slope) / (1 + std::abs(slope));
}

// One result per lane of f(a, b, c), computed in one pack or in eight scalar calls.
template <class T, class F>
void add_results(BitsHash& hash, F f, const double* a, const double* b, const double* c) {
  double out[kLanes];
  if constexpr (std::is_same_v<T, double>) {
    for (int i = 0; i < kLanes; ++i) out[i] = f(a[i], b[i], c[i]);
  } else {
    f(T::load_unaligned(a), T::load_unaligned(b), T::load_unaligned(c)).store_unaligned(out);
  }
  for (double x : out) hash.add(x);
}

template <class T>
std::uint64_t math_bits() {
  BitsHash hash;
  TestNumbers numbers(20240917);
  constexpr int kBlocks = 4000;
  const double special[] = {0,
                            -0.0,
                            1,
                            -1,
                            0.5,
                            -2,
                            0.25,
                            TestRange::kTiny,
                            -TestRange::kTiny,
                            TestRange::kNormal,
                            TestRange::kTurns,
                            -TestRange::kTurns,
                            TestRange::kExpHighest,
                            TestRange::kExpLowest,
                            TestRange::kInfinity,
                            -TestRange::kInfinity,
                            TestRange::kNan,
                            3,
                            TestRange::kHuge,
                            -TestRange::kSmall};
  constexpr int kSpecial = sizeof(special) / sizeof(special[0]);
  const auto uniform = [&](double low, double high) { return numbers.uniform(low, high); };
  for (int block = 0; block < kBlocks; ++block) {
    double a[kLanes], b[kLanes], c[kLanes], turns[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      switch (block % 4) {
        case 0:
          a[i] = uniform(-4, 4), b[i] = uniform(-4, 4);
          c[i] = uniform(-4, 4), turns[i] = a[i];
          break;
        case 1:
          a[i] = numbers.any_finite(), b[i] = numbers.any_finite();
          c[i] = numbers.any_finite();
          turns[i] = uniform(-TestRange::kTurns, TestRange::kTurns);
          break;
        case 2:
          a[i] = uniform(TestRange::kBeyondLow, TestRange::kBeyondHigh), b[i] = uniform(-30, 30);
          c[i] = -a[i] * b[i], turns[i] = a[i];
          break;
        default:
          a[i] = special[numbers.bits() % kSpecial], b[i] = special[numbers.bits() % kSpecial];
          c[i] = special[numbers.bits() % kSpecial];
          // The phase is promised up to kTurns only; infinity and NaN are promised to give NaN.
          turns[i] = a[i] == TestRange::kHuge ? 0.125 : a[i];
      }
    }
#define TOMLIN_ADD(expression)                                            \
  add_results<T>(                                                         \
      hash,                                                               \
      [](auto x, auto y, auto z) {                                        \
        static_cast<void>(x), static_cast<void>(y), static_cast<void>(z); \
        return expression;                                                \
      },                                                                  \
      a, b, c)
    TOMLIN_ADD(x + y);
    TOMLIN_ADD(x - y);
    TOMLIN_ADD(x * y);
    TOMLIN_ADD(x / y);
    TOMLIN_ADD(-x);
    TOMLIN_ADD(fma(x, y, z));
    TOMLIN_ADD(fnma(x, y, z));
    TOMLIN_ADD(sqrt(x));
    TOMLIN_ADD(abs(x));
    TOMLIN_ADD(min(x, y));
    TOMLIN_ADD(max(x, y));
    TOMLIN_ADD(round(x));
    TOMLIN_ADD(copysign(x, y));
    TOMLIN_ADD(select((x < y) | !(y <= z), x, select((x > z) & (x != y), y, z)));
    TOMLIN_ADD(select(x >= y, x, select(y == z, y, z)));
    TOMLIN_ADD(exp(x));
    TOMLIN_ADD(log(x));
    TOMLIN_ADD(log(abs(x)));
    TOMLIN_ADD(pow(x, y));
    TOMLIN_ADD(pow(abs(x), y));
    TOMLIN_ADD(pow(x, round(y)));
#undef TOMLIN_ADD
    const auto sine = [](auto x, auto, auto) { return sin_turns(x); };
    const auto cosine = [](auto x, auto, auto) { return cos_turns(x); };
    const auto both_sine = [](auto x, auto, auto) {
      decltype(x) sine_of, cosine_of;
      sincos_turns(x, sine_of, cosine_of);
      return sine_of;
    };
    const auto both_cosine = [](auto x, auto, auto) {
      decltype(x) sine_of, cosine_of;
      sincos_turns(x, sine_of, cosine_of);
      return cosine_of;
    };
    add_results<T>(hash, sine, turns, b, c);
    add_results<T>(hash, cosine, turns, b, c);
    add_results<T>(hash, both_sine, turns, b, c);
    add_results<T>(hash, both_cosine, turns, b, c);
  }
  return hash.value();
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
