// A fingerprint of every operation on a fixed set of numbers, to prove that scalars and packs, and
// one instruction set and another, give the same bits.
#pragma once

#include <cstdint>
#include <type_traits>

#include "framework/core/math.hpp"
#include "framework/core/pack.hpp"
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

// One result per lane of f(a, b, c), computed in one Pack or in eight scalar calls.
template <class T, class F>
void add_results(BitsHash& hash, F f, const double* a, const double* b, const double* c) {
  double out[kLanes];
  if constexpr (std::is_same_v<T, Pack>) {
    f(Pack::load_unaligned(a), Pack::load_unaligned(b), Pack::load_unaligned(c))
        .store_unaligned(out);
  } else {
    for (int i = 0; i < kLanes; ++i) out[i] = f(a[i], b[i], c[i]);
  }
  for (double x : out) hash.add(x);
}

template <class T>
std::uint64_t math_bits() {
  BitsHash hash;
  TestNumbers numbers(20240917);
  constexpr int kBlocks = 4000;
  const double special[] = {0.0,
                            -0.0,
                            1.0,
                            -1.0,
                            0.5,
                            -2.0,
                            0.25,
                            0x1p-1074,
                            -0x1p-1074,
                            0x1p-1022,
                            0x1p50,
                            -0x1p50,
                            709.782712893384,
                            -745.13321910194122,
                            __builtin_inf(),
                            -__builtin_inf(),
                            __builtin_nan(""),
                            3.0,
                            1e300,
                            -1e-300};
  constexpr int kSpecial = sizeof(special) / sizeof(special[0]);
  for (int block = 0; block < kBlocks; ++block) {
    double a[kLanes], b[kLanes], c[kLanes], turns[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      switch (block % 4) {
        case 0:
          a[i] = numbers.uniform(-4, 4), b[i] = numbers.uniform(-4, 4);
          c[i] = numbers.uniform(-4, 4), turns[i] = a[i];
          break;
        case 1:
          a[i] = numbers.any_finite(), b[i] = numbers.any_finite(), c[i] = numbers.any_finite();
          turns[i] = numbers.uniform(-0x1p50, 0x1p50);
          break;
        case 2:
          a[i] = numbers.uniform(-750, 720), b[i] = numbers.uniform(-30, 30);
          c[i] = -a[i] * b[i], turns[i] = a[i];
          break;
        default:
          a[i] = special[numbers.bits() % kSpecial], b[i] = special[numbers.bits() % kSpecial];
          c[i] = special[numbers.bits() % kSpecial];
          // The phase is promised up to 2^50 only; infinity and NaN are promised to give NaN.
          turns[i] = a[i] == 1e300 ? 0.125 : a[i];
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
