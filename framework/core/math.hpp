// Elementary functions for double, float and Pack, with the same bits in every lane of every
// target. libm is not used: it differs between machines and versions.
//
//   sin_turns(x) = sin(2 pi x), cos_turns, sincos_turns; exp, log, pow; sqrt is in pack.hpp.
//
// The polynomials are least-squares fits at Chebyshev points on the reduced interval, computed
// with 90 decimal digits. Coefficients were rounded to double one at a time, lowest power first,
// and the remaining ones fitted again after each rounding. The error of each fit, rounding of the
// coefficients included, is stated beside it. All are summed by Estrin's scheme, which halves the
// latency of Horner's; the scheme is part of the result, so it is the same on every target.
#pragma once

#include "framework/core/float_pack.hpp"
#include "framework/core/pack.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {
namespace math_detail {

inline constexpr double kInfinity = __builtin_inf();
inline constexpr double kNan = __builtin_nan("");
inline constexpr double kLog2E = 0x1.71547652b82fep+0;
// ln 2 = kLn2High + kLn2Low, both full doubles.
inline constexpr double kLn2High = 0x1.62e42fefa39efp-1;
inline constexpr double kLn2Low = 0x1.abc9e3b39803fp-56;
// ln 2 = kLn2Short + kLn2Rest; a product of kLn2Short with an exponent is exact.
inline constexpr double kLn2Short = 0x1.62e42fee00000p-1;
inline constexpr double kLn2Rest = 0x1.a39ef35793c76p-33;

// c[0] + c[1] z + ... + c[6] z^6; the caller has z2 = z^2 at hand.
template <class T>
TOMLIN_INLINE T estrin7(T z, T z2, const double (&c)[7]) {
  const T p0 = fma(z, T(c[1]), T(c[0]));
  const T p1 = fma(z, T(c[3]), T(c[2]));
  const T p2 = fma(z, T(c[5]), T(c[4]));
  return fma(z2 * z2, fma(z2, T(c[6]), p2), fma(z2, p1, p0));
}
// c[0] + c[1] z + ... + c[7] z^7.
template <class T>
TOMLIN_INLINE T estrin8(T z, const double (&c)[8]) {
  const T z2 = z * z;
  const T z4 = z2 * z2;
  const T p0 = fma(z, T(c[1]), T(c[0]));
  const T p1 = fma(z, T(c[3]), T(c[2]));
  const T p2 = fma(z, T(c[5]), T(c[4]));
  const T p3 = fma(z, T(c[7]), T(c[6]));
  return fma(z4, fma(z2, p3, p2), fma(z2, p1, p0));
}

// sin(2 pi r) / r in z = r^2 on [0, 1/16]; error of the sine 4.4e-18.
inline constexpr double kSin0 = 0x1.921fb54442d18p+2, kSin1 = -0x1.4abbce625be40p+5;
inline constexpr double kSin[7] = {
    0x1.466bc6775a409p+6, -0x1.32d2cce604ae5p+6, 0x1.5078347826517p+5, -0x1.e307483c1b49bp+3,
    0x1.e8f1f3b8d1890p+1, -0x1.6f486175c2fe9p-1, 0x1.97972a35f7df8p-4};
// cos(2 pi r) in z = r^2 on [0, 1/16], the constant term 1; error of the cosine 5.5e-18.
inline constexpr double kCos1 = -0x1.3bd3cc9be45dcp+4;
inline constexpr double kCos[7] = {
    0x1.03c1f081b59a7p+6, -0x1.55d3c7e3c0266p+6, 0x1.e1f506815e272p+5, -0x1.a6d1efd023277p+4,
    0x1.f9d2561c35bd5p+2, -0x1.b695b5d772851p+0, 0x1.167c22aeef940p-2};
// (exp(r) - 1 - r) / r^2 on |r| <= 1.0005 ln(2) / 2; relative error of exp(r) 4.6e-18.
inline constexpr double kExp[8] = {
    0x1.000000000000cp-1,  0x1.5555555555516p-3,  0x1.555555554fe59p-5,  0x1.1111111120de0p-7,
    0x1.6c16c185eeaaap-10, 0x1.a01a014ee5450p-13, 0x1.a01996022775ap-16, 0x1.71ded4c954336p-19};
inline constexpr double kExp8 = 0x1.28b0b47905805p-22;
inline constexpr double kExp9 = 0x1.adfd93bffe702p-26;
// (2 atanh(s) / s - 2) / s^2 in z = s^2, |s| <= tanh(ln(2) / 4); error of 2 atanh(s)/s 1.9e-20.
inline constexpr double kLog[8] = {0x1.5555555555555p-1, 0x1.9999999999d0ap-2, 0x1.249249243a361p-2,
                                   0x1.c71c724a82c6fp-3, 0x1.745ce20ffd0bcp-3, 0x1.3b2018a521d73p-3,
                                   0x1.0f68463bb8667p-3, 0x1.0f05040883d52p-3};
// (atanh(s) / s - 1 - z / 3) / z^2 in z = s^2, same interval; error of atanh(s)/s 9.0e-23.
inline constexpr double kLogTail[8] = {
    0x1.9999999999995p-3, 0x1.2492492493150p-3, 0x1.c71c71c56444fp-4, 0x1.745d183dec639p-4,
    0x1.3b135fff863dfp-4, 0x1.112112a7d433ep-4, 0x1.de26213628c94p-5, 0x1.eb76255ddc6b8p-5};

// x = rest + n / 2 with |rest| <= 1/4, n = round(2 x), halves to the even one.
//
// Adding 1.5 * 2^51 leaves one fraction bit, and in it the parity of n. Exact for |x| <= 2^50;
// beyond, where the phase of a double means nothing, results stay finite but may be wrong. This is
// 20 % faster in latency than the rounding instruction, and 6 % than twice its range would be.
inline constexpr double kTurnShift = 0x1.8p51;

#if TOMLIN_TARGET_IS_AVX512
// One instruction for x - round(2 x) / 2; the result is the same, as both are exact.
TOMLIN_INLINE double half_turn_rest(double x, double) {
  return _mm_cvtsd_f64(_mm_reduce_sd(widen(x), widen(x), 0x10));
}
TOMLIN_INLINE Pack half_turn_rest(Pack x, Pack) {
  return Pack(pack_detail::Part{_mm512_reduce_pd(x.v.raw, 0x10)});
}
// It makes 0 of infinity. Adding 0 * infinity to a coefficient makes it a NaN again, at no latency.
template <class T>
TOMLIN_INLINE T finite_or_nan(double coefficient, T shifted) {
  return fma(shifted, T(0.0), T(coefficient));
}
#else
template <class T>
TOMLIN_INLINE T half_turn_rest(T x, T shifted) {
  return x - (shifted - T(kTurnShift));
}
template <class T>
TOMLIN_INLINE T finite_or_nan(double coefficient, T) {
  return T(coefficient);
}
#endif

template <class T>
struct HalfTurns {
  T shifted, rest, z, z2;
  TOMLIN_INLINE explicit HalfTurns(T x)
      : shifted(x + T(kTurnShift)), rest(half_turn_rest(x, shifted)), z(rest * rest), z2(z * z) {}

  // The two leading terms are kept apart from the rest, which is small: its rounding hardly shows.
  TOMLIN_INLINE T sine() const {
    // Adding 0 makes +0 of a -0, on which the ways to reduce x do not agree.
    const T leading = fma(rest, fma(z, T(kSin1), finite_or_nan(kSin0, shifted)), T(0.0));
    return with_parity(fma(rest * z2, estrin7(z, z2, kSin), leading));
  }
  TOMLIN_INLINE T cosine() const {
    const T leading = fma(z, T(kCos1), finite_or_nan(1.0, shifted));
    return with_parity(fma(z2, estrin7(z, z2, kCos), leading));
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
    // The low bits of a double near 1.5 * 2^52 are an integer; the added 1023 makes it an exponent.
    constexpr double shift = 0x1.8p52 + 1023;
    const T half = fma(n, T(0.5), T(shift));
    const T other = (n - (half - T(shift))) + T(shift);
    first = bits_shift_left<52>(half);
    second = bits_shift_left<52>(other);
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
// The same in one instruction. For scalars the way above is as fast.
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
  return select(x > T(710.0), T(kInfinity), select(x < T(-746.0), T(0.0), y));
}

// (exp(r) - 1 - r) / r^2.
template <class T>
TOMLIN_INLINE T exp_quotient(T r, T r2) {
  const T r4 = r2 * r2;
  const T p0 = fma(r, T(kExp[1]), T(kExp[0]));
  const T p1 = fma(r, T(kExp[3]), T(kExp[2]));
  const T p2 = fma(r, T(kExp[5]), T(kExp[4]));
  const T p3 = fma(r, T(kExp[7]), T(kExp[6]));
  const T p4 = fma(r, T(kExp9), T(kExp8));
  return fma(r4, fma(r4, p4, fma(r2, p3, p2)), fma(r2, p1, p0));
}

inline constexpr double kExpShift = 0x1.8p52;

// exp(x) = 2^n exp(r), n = round(x / ln 2).
template <class T>
TOMLIN_INLINE T exp_of(T x) {
  const T n = fma(x, T(kLog2E), T(kExpShift)) - T(kExpShift);
  const T r = fnma(n, T(kLn2Low), fnma(n, T(kLn2High), x));
  const T r2 = r * r;
  return exp_range(x, scaled_sum(r2, exp_quotient(r, r2), T(1.0) + r, n));
}

// exp(x + tail) for a tail far below x, with hardly more than the one rounding at the end.
template <class T>
TOMLIN_INLINE T exp_of(T x, T tail) {
  const T n = fma(x, T(kLog2E), T(kExpShift)) - T(kExpShift);
  const T r_high = fnma(n, T(kLn2High), x);
  const T r_low = fnma(n, T(kLn2Low), tail);
  const T r = r_high + r_low;
  const T r2 = r * r;
  const T high = T(1.0) + r_high;
  const T low = (r_high - (high - T(1.0))) + r_low;
  return exp_range(x, scaled_sum(r2, exp_quotient(r, r2), low, high, n));
}

// x = 2^exponent (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), for finite x > 0; f is exact.
template <class T>
struct Octave {
  T exponent, f;
  TOMLIN_INLINE explicit Octave(T x) {
    const Mask<T> subnormal = x < T(0x1p-1022);
    const T normal = select(subnormal, x * T(0x1p54), x);
    const T bias = select(subnormal, T(0x1p52 + 1023 + 54), T(0x1p52 + 1023));
    // Shifting the pattern from sqrt(1/2) to 1 makes the exponent field turn over at sqrt(2).
    constexpr std::uint64_t one = 0x3ff0000000000000, root_half = 0x3fe6a09e667f3bcd;
    const T turned = bits_add(normal, T(__builtin_bit_cast(double, one - root_half)));
    exponent = bits_or(bits_shift_right<52>(turned), T(0x1p52)) - bias;
    const T fraction =
        bits_and(turned, T(__builtin_bit_cast(double, std::uint64_t{0x000fffffffffffff})));
    f = bits_add(fraction, T(__builtin_bit_cast(double, root_half))) - T(1.0);
  }
};

template <class T>
TOMLIN_INLINE T log_of(T x) {
  // log(1 + f) = 2 atanh(s), s = f / (2 + f), arranged around f and f^2 / 2, the bulk of it.
  const Octave<T> octave(x);
  const T f = octave.f, k = octave.exponent;
  const T s = f / (T(2.0) + f);
  const T z = s * s;
  const T tail = z * estrin8(z, kLog);
  const T half_square = T(0.5) * f * f;
  const T small = fma(s, half_square + tail, k * T(kLn2Rest));
  const T y = k * T(kLn2Short) - ((half_square - small) - f);
  const T finite = select(x < T(kInfinity), y, x);
  return select(x > T(0.0), finite, select(x == T(0.0), T(-kInfinity), T(kNan)));
}

// log(x) = hi + lo to about 2^-63 relative, for finite x > 0.
template <class T>
struct LongLog {
  T hi, lo;
  TOMLIN_INLINE explicit LongLog(T x) {
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
    const T tail = (z * z) * estrin8(z, kLogTail);
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
    const T e = k * T(kLn2Short);
    const T sum = e + c;
    const T sum_low = ((e - sum) + c) + fma(k, T(kLn2Rest), c_low);
    hi = sum + sum_low;
    lo = sum_low - (hi - sum);
  }
};

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
  // A negative base needs an integral exponent, whose parity gives the sign.
  const Mask<T> negative = x < T(0.0);
  const Mask<T> integral = round(y) == y;
  const T half = y * T(0.5);
  const Mask<T> odd = integral & (round(half) != half);
  r = select(negative, select(integral, select(odd, -r, r), T(kNan)), r);
  r = select((x != x) | (y != y), T(kNan), r);
  return select((y == T(0.0)) | (x == T(1.0)), T(1.0), r);
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

// float goes through double: it is there to measure what precision costs, not to be fast here.
TOMLIN_INLINE float sin_turns(float x) { return static_cast<float>(sin_turns(double{x})); }
TOMLIN_INLINE float cos_turns(float x) { return static_cast<float>(cos_turns(double{x})); }
TOMLIN_INLINE void sincos_turns(float x, float& s, float& c) {
  double s_wide, c_wide;
  sincos_turns(double{x}, s_wide, c_wide);
  s = static_cast<float>(s_wide);
  c = static_cast<float>(c_wide);
}
TOMLIN_INLINE float exp(float x) { return static_cast<float>(exp(double{x})); }
TOMLIN_INLINE float log(float x) { return static_cast<float>(log(double{x})); }
TOMLIN_INLINE float pow(float x, float y) { return static_cast<float>(pow(double{x}, double{y})); }

TOMLIN_INLINE FloatPack sin_turns(FloatPack x) { return to_float(sin_turns(to_double(x))); }
TOMLIN_INLINE FloatPack cos_turns(FloatPack x) { return to_float(cos_turns(to_double(x))); }
TOMLIN_INLINE void sincos_turns(FloatPack x, FloatPack& s, FloatPack& c) {
  Pack s_wide, c_wide;
  sincos_turns(to_double(x), s_wide, c_wide);
  s = to_float(s_wide);
  c = to_float(c_wide);
}
TOMLIN_INLINE FloatPack exp(FloatPack x) { return to_float(exp(to_double(x))); }
TOMLIN_INLINE FloatPack log(FloatPack x) { return to_float(log(to_double(x))); }
TOMLIN_INLINE FloatPack pow(FloatPack x, FloatPack y) {
  return to_float(pow(to_double(x), to_double(y)));
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
