// Elementary functions for double and its packs, with the same bits in every lane of every
// target. libm is not used: it differs between machines and versions.
//
//   sin_turns(x) = sin(2 pi x), cos_turns, sincos_turns; exp, log, pow; sqrt is in pack.hpp.
//
// The polynomials are in elementary_fits.hpp.
#pragma once

#include "framework/core/numbers/elementary_fits.hpp"
#include "framework/core/numbers/number_types.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {
namespace math_detail {

inline constexpr double kInfinity = __builtin_inf();
inline constexpr double kNan = __builtin_nan("");

constexpr double power_of_two(int n) {
  return __builtin_bit_cast(double, static_cast<Fit::Bits>(n + Fit::kBias) << Fit::kFractionBits);
}
// The low bits of a number near 1.5 2^52 are an integer; adding and subtracting it rounds to one.
inline constexpr double kIntegerShift = 0x1.8p52;

// c[0] + c[1] z + ... + c[n-1] z^(n-1), from c[first] on; z2 = z^2.
//
// Groups of four by Estrin's scheme, which halves the latency of Horner's. The order is part of the
// result, so it is the same on every target.
template <int first = 0, class T, class Real, int n>
TOMLIN_INLINE T estrin(T z, T z2, const Real (&c)[n]) {
  constexpr int left = n - first;
  if constexpr (left == 1) {
    return T(c[first]);
  } else {
    T group = fma(z, T(c[first + 1]), T(c[first]));
    if constexpr (left == 3) group = fma(z2, T(c[first + 2]), group);
    if constexpr (left >= 4) {
      group = fma(z2, fma(z, T(c[first + 3]), T(c[first + 2])), group);
    }
    if constexpr (left > 4) group = fma(z2 * z2, estrin<first + 4>(z, z2, c), group);
    return group;
  }
}

// x = rest + n / 2 with |rest| <= 1/4, n = round(2 x), halves to the even one.
//
// Adding 1.5 * 2^51 leaves one fraction bit, and in it the parity of n. Exact for |x| <= 2^50;
// beyond, where the phase means nothing, results stay finite but may be wrong. This is 20 % faster
// in latency than the rounding instruction, and 6 % than twice its range would be.
inline constexpr double kTurnShift = kIntegerShift / 2;

template <class T>
TOMLIN_INLINE T half_turn_rest(T x, T shifted) {
  return x - (shifted - T(kTurnShift));
}
template <class T>
TOMLIN_INLINE T finite_or_nan(double coefficient, T) {
  return T(coefficient);
}
#if TOMLIN_TARGET_IS_AVX512
// One instruction for x - round(2 x) / 2; the result is the same, as both are exact.
TOMLIN_INLINE double half_turn_rest(double x, double) {
  return _mm_cvtsd_f64(_mm_reduce_sd(widen(x), widen(x), 0x10));
}
TOMLIN_INLINE Pack half_turn_rest(Pack x, Pack) {
  return Pack(pack_detail::Part{_mm512_reduce_pd(x.v.raw, 0x10)});
}
// It makes 0 of infinity. Adding 0 * infinity to a coefficient makes it a NaN again, at no latency.
TOMLIN_INLINE double finite_or_nan(double coefficient, double shifted) {
  return fma(shifted, 0.0, coefficient);
}
TOMLIN_INLINE Pack finite_or_nan(double coefficient, Pack shifted) {
  return fma(shifted, Pack(0.0), Pack(coefficient));
}
#endif

template <class T>
struct HalfTurns {
  using F = Fit;
  T shifted, rest, z, z2;
  TOMLIN_INLINE explicit HalfTurns(T x)
      : shifted(x + T(kTurnShift)), rest(half_turn_rest(x, shifted)), z(rest * rest), z2(z * z) {}

  // The two leading terms are kept apart from the rest, which is small: its rounding hardly shows.
  TOMLIN_INLINE T sine() const {
    // Adding 0 makes +0 of a -0, on which the ways to reduce x do not agree.
    const T leading = fma(rest, fma(z, T(F::kSin1), finite_or_nan(F::kSin0, shifted)), T(0.0));
    return with_parity(fma(rest * z2, estrin(z, z2, F::kSin), leading));
  }
  TOMLIN_INLINE T cosine() const {
    const T leading = fma(z, T(F::kCos1), finite_or_nan(1.0, shifted));
    return with_parity(fma(z2, estrin(z, z2, F::kCos), leading));
  }

 private:
  // The parity of n is the lowest bit of shifted; moved to the top it flips the sign.
  TOMLIN_INLINE T with_parity(T value) const {
    return bits_xor(value, bits_shift_left<63>(shifted));
  }
};

// 2^n (high + r2 q), and 2^n (high + (low + r2 q)). The sum is rounded once, and a subnormal result
// once more.
//
// 2^n is applied in two halves, because it may be out of range when the result is not; the first
// half is folded into the sum, where it is exact and costs no time.
template <class T>
struct PowerOfTwo {
  T first, second;
  TOMLIN_INLINE explicit PowerOfTwo(T n) {
    // The added bias makes an exponent of the integer in the low bits.
    using F = Fit;
    constexpr auto shift = kIntegerShift + F::kBias;
    const T half = fma(n, T(0.5), T(shift));
    const T other = (n - (half - T(shift))) + T(shift);
    first = bits_shift_left<F::kFractionBits>(half);
    second = bits_shift_left<F::kFractionBits>(other);
  }
};
template <class T>
TOMLIN_INLINE T scaled_sum(T r2, T q, T high, T n) {
  const PowerOfTwo<T> power(n);
  return fma(r2 * power.first, q, high * power.first) * power.second;
}
template <class T>
TOMLIN_INLINE T scaled_sum(T r2, T q, T low, T high, T n) {
  const PowerOfTwo<T> power(n);
  return fma(fma(r2, q, low), power.first, high * power.first) * power.second;
}
#if TOMLIN_TARGET_IS_AVX512
// AVX-512 scales in one instruction. For scalars the way above is as fast.
TOMLIN_INLINE Pack scaled_sum(Pack r2, Pack q, Pack high, Pack n) {
  return Pack(pack_detail::Part{_mm512_scalef_pd(fma(r2, q, high).v.raw, n.v.raw)});
}
TOMLIN_INLINE Pack scaled_sum(Pack r2, Pack q, Pack low, Pack high, Pack n) {
  return Pack(pack_detail::Part{_mm512_scalef_pd((fma(r2, q, low) + high).v.raw, n.v.raw)});
}
#endif

// Out here exp(x) is 0 or infinity for certain, and what was computed may be meaningless.
template <class T>
TOMLIN_INLINE T exp_range(T x, T y) {
  using F = Fit;
  return select(x > T(F::kExpHighest), T(kInfinity), select(x < T(F::kExpLowest), T(0.0), y));
}

// round(x / ln 2).
template <class T>
TOMLIN_INLINE T octaves(T x) {
  constexpr auto shift = kIntegerShift;
  return fma(x, T(Fit::kLog2E), T(shift)) - T(shift);
}

// exp(x) = 2^n exp(r), n = round(x / ln 2).
template <class T>
TOMLIN_INLINE T exp_of(T x) {
  using F = Fit;
  const T n = octaves(x);
  const T r = fnma(n, T(F::kLn2Low), fnma(n, T(F::kLn2High), x));
  const T r2 = r * r;
  return exp_range(x, scaled_sum(r2, estrin(r, r2, F::kExp), T(1.0) + r, n));
}

// exp(x + tail) for a tail far below x, with hardly more than the one rounding at the end.
template <class T>
TOMLIN_INLINE T exp_of(T x, T tail) {
  using F = Fit;
  const T n = octaves(x);
  const T r_high = fnma(n, T(F::kLn2High), x);
  const T r_low = fnma(n, T(F::kLn2Low), tail);
  const T r = r_high + r_low;
  const T r2 = r * r;
  const T high = T(1.0) + r_high;
  const T low = (r_high - (high - T(1.0))) + r_low;
  return exp_range(x, scaled_sum(r2, estrin(r, r2, F::kExp), low, high, n));
}

// x = 2^exponent (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), for finite x > 0; f is exact.
template <class T>
struct Octave {
  T exponent, f;
  TOMLIN_INLINE explicit Octave(T x) {
    using F = Fit;
    using Bits = F::Bits;
    constexpr int lift = F::kFractionBits + 2;
    constexpr double integers = power_of_two(F::kFractionBits);
    const Mask<T> subnormal = x < T(F::kSmallestNormal);
    const T normal = select(subnormal, x * T(power_of_two(lift)), x);
    const T bias = select(subnormal, T(integers + F::kBias + lift), T(integers + F::kBias));
    // Shifting the pattern from sqrt(1/2) to 1 makes the exponent field turn over at sqrt(2).
    constexpr Bits one = __builtin_bit_cast(Bits, 1.0);
    constexpr Bits fraction_bits = (Bits{1} << F::kFractionBits) - 1;
    const T turned = bits_add(normal, T(__builtin_bit_cast(double, one - F::kRootHalf)));
    exponent = bits_or(bits_shift_right<F::kFractionBits>(turned), T(integers)) - bias;
    const T fraction = bits_and(turned, T(__builtin_bit_cast(double, fraction_bits)));
    f = bits_add(fraction, T(__builtin_bit_cast(double, F::kRootHalf))) - T(1.0);
  }
};

template <class T>
TOMLIN_INLINE T log_of(T x) {
  // log(1 + f) = 2 atanh(s), s = f / (2 + f), arranged around f and f^2 / 2, the bulk of it.
  using F = Fit;
  const Octave<T> octave(x);
  const T f = octave.f, k = octave.exponent;
  const T s = f / (T(2.0) + f);
  const T z = s * s;
  const T tail = z * estrin(z, z * z, F::kLog);
  const T half_square = T(0.5) * f * f;
  const T small = fma(s, half_square + tail, k * T(F::kLn2Rest));
  const T y = k * T(F::kLn2Short) - ((half_square - small) - f);
  const T finite = select(x < T(kInfinity), y, x);
  return select(x > T(0.0), finite, select(x == T(0.0), T(-kInfinity), T(kNan)));
}

// log(x) = hi + lo to about 2^-63 relative, for finite x > 0.
template <class T>
struct LongLog {
  T hi, lo;
  TOMLIN_INLINE explicit LongLog(T x) {
    using F = Fit;
    constexpr double third_high = 0x1.5555555555555p-2, third_low = 0x1.5555555555555p-56;
    const Octave<T> octave(x);
    const T f = octave.f, k = octave.exponent;
    // s = f / (2 + f) and z = s^2, each as an unevaluated sum of two doubles.
    const T d = T(2.0) + f;
    const T d_low = f - (d - T(2.0));
    const T inverse = T(1.0) / d;
    const T s = f * inverse;
    const T s_low = fnma(s, d_low, fnma(s, d, f)) * inverse;
    const T z = s * s;
    const T z_low = fma(T(2.0) * s, s_low, fma(s, s, -z));
    // w = z/3 + z^2/5 + ..., so that log(1 + f) = 2 s (1 + w).
    const T tail = (z * z) * estrin(z, z * z, F::kLogTail);
    const T a = z * T(third_high);
    const T a_low = fma(z, T(third_high), -a) + fma(z, T(third_low), z_low * T(third_high));
    const T w = a + tail;
    const T w_low = ((a - w) + tail) + a_low;
    const T s2 = T(2.0) * s;
    const T s2_low = T(2.0) * s_low;
    const T b = s2 * w;
    const T b_low = fma(s2, w, -b) + fma(s2, w_low, s2_low * w);
    const T c = s2 + b;
    const T c_low = ((s2 - c) + b) + (b_low + s2_low);
    // Add k ln 2: the leading product is exact and either zero or the larger term.
    const T e = k * T(F::kLn2Short);
    const T sum = e + c;
    const T sum_low = ((e - sum) + c) + fma(k, T(F::kLn2Rest), c_low);
    hi = sum + sum_low;
    lo = sum_low - (hi - sum);
  }
};

// pow(x, y), given r = pow(|x|, y).
template <class T>
TOMLIN_INLINE T signed_power(T x, T y, T r) {
  // A negative base needs an integral exponent, whose parity gives the sign.
  const Mask<T> negative = x < T(0.0);
  const Mask<T> integral = round(y) == y;
  const T half = y * T(0.5);
  const Mask<T> odd = integral & (round(half) != half);
  r = select(negative, select(integral, select(odd, -r, r), T(kNan)), r);
  r = select((x != x) | (y != y), T(kNan), r);
  return select((y == T(0.0)) | (x == T(1.0)), T(1.0), r);
}

template <class T>
TOMLIN_INLINE T pow_of(T x, T y) {
  const T base = abs(x);
  const LongLog<T> log_base(base);
  const T product = y * log_base.hi;
  const T product_low = fma(y, log_base.lo, fma(y, log_base.hi, -product));
  T r = exp_of(product, product_low);
  // Zero and infinity as base; both go the other way for a negative exponent.
  r = select(base == T(0.0), select(y < T(0.0), T(kInfinity), T(0.0)), r);
  r = select(base == T(kInfinity), select(y < T(0.0), T(0.0), T(kInfinity)), r);
  return signed_power(x, y, r);
}

}  // namespace math_detail

// sin(2 pi x) and cos(2 pi x) for |x| <= 2^50: absolute error below 2.5e-16 and 1.6e-16, relative
// error of the sine near x = 0 about 2 ulp. Infinity and NaN give NaN.
TOMLIN_INLINE double sin_turns(double x) { return math_detail::HalfTurns<double>(x).sine(); }
TOMLIN_INLINE double cos_turns(double x) { return math_detail::HalfTurns<double>(x).cosine(); }
TOMLIN_INLINE void sincos_turns(double x, double& s, double& c) {
  const math_detail::HalfTurns<double> half(x);
  s = half.sine();
  c = half.cosine();
}
// Errors: exp 1.3 ulp, log 0.8 ulp, pow 1.3 ulp (0.7 for results near 1); subnormal arguments and
// results included.
TOMLIN_INLINE double exp(double x) { return math_detail::exp_of(x); }
TOMLIN_INLINE double log(double x) { return math_detail::log_of(x); }
// pow(x, 0) = pow(1, y) = 1; a negative base with a fractional exponent is a NaN.
TOMLIN_INLINE double pow(double x, double y) { return math_detail::pow_of(x, y); }

TOMLIN_INLINE Pack sin_turns(Pack x) { return math_detail::HalfTurns<Pack>(x).sine(); }
TOMLIN_INLINE Pack cos_turns(Pack x) { return math_detail::HalfTurns<Pack>(x).cosine(); }
TOMLIN_INLINE void sincos_turns(Pack x, Pack& s, Pack& c) {
  const math_detail::HalfTurns<Pack> half(x);
  s = half.sine();
  c = half.cosine();
}
TOMLIN_INLINE Pack exp(Pack x) { return math_detail::exp_of(x); }
TOMLIN_INLINE Pack log(Pack x) { return math_detail::log_of(x); }
TOMLIN_INLINE Pack pow(Pack x, Pack y) { return math_detail::pow_of(x, y); }

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
