// atan, atan2, asin, acos, tan_turns and floor for every number type, with the same bits in every
// lane of every target.
//
// A header of its own, since few kernels call them.
#pragma once

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {

// Errors below 2 ulp, but that of tan_turns, which is below 4; in quad.cpp.
Quad atan(Quad x);
Quad atan2(Quad y, Quad x);
Quad asin(Quad x);
Quad acos(Quad x);
Quad tan_turns(Quad x);
Quad floor(Quad x);
QuadPack atan(const QuadPack& x);
QuadPack atan2(const QuadPack& y, const QuadPack& x);
QuadPack asin(const QuadPack& x);
QuadPack acos(const QuadPack& x);
QuadPack tan_turns(const QuadPack& x);
QuadPack floor(const QuadPack& x);

inline namespace TOMLIN_TARGET {
namespace math_detail {

// Polynomials and constants; how they were found is said in elementary_fits.hpp.
struct InverseFit {
  // pi/4 = kEighthTurn + kEighthTurnRest; kEighthTurn times 3 is exact.
  static constexpr double kEighthTurn = 0x1.921fb54442d18p-1;
  static constexpr double kEighthTurnRest = 0x1.1a62633145c07p-55;
  // (atan(u) / u - 1) / u^2 in z = u^2, |u| <= 1/2; error of atan(u)/u 4.3e-18.
  static constexpr double kAtan[12] = {
      -0x1.5555555555513p-2, 0x1.9999999990ccap-3, -0x1.249249214a0f0p-3, 0x1.c71c708b3793fp-4,
      -0x1.745cf44eecf12p-4, 0x1.3b1136fd49c9fp-4, -0x1.10f2e0b746017p-4, 0x1.dfe674938dd62p-5,
      -0x1.a38c0e2ded5a2p-5, 0x1.56d59c72d6b5dp-5, -0x1.c11f4f26f7471p-6, 0x1.4b051bba8711ap-7};
  // (asin(s) / s - 1) / s^2 in z = s^2, |s| <= 1/2; error of asin(s)/s 1.1e-18.
  static constexpr double kAsin[13] = {
      0x1.5555555555577p-3, 0x1.333333332e1d7p-4, 0x1.6db6db72067c3p-5, 0x1.f1c71a9a612bcp-6,
      0x1.6e8bde357e3ffp-6, 0x1.1c49fd309612cp-6, 0x1.ca1e4bde65f16p-7, 0x1.759020e3f57d1p-7,
      0x1.60fff6c6f49f2p-7, 0x1.e995aa7ea282cp-9, 0x1.627f8e45fcf05p-6, -0x1.5667f5d274d99p-6,
      0x1.0ac783d4e1577p-5};
};

// n pi / 4 + (main + tail), n = 0 to 4, |main| <= 1 and tail far below it; rounded hardly more than
// once.
template <class T>
TOMLIN_INLINE T plus_eighth_turns(T n, T main, T tail) {
  using F = InverseFit;
  const T base = n * T(F::kEighthTurn);
  const T sum = base + main;
  const T rest = (base - sum) + main;
  return sum + (rest + fma(n, T(F::kEighthTurnRest), tail));
}

// (atan(u) / u - 1) / z, z = u^2.
template <class T>
TOMLIN_INLINE T arctangent_series(T z) {
  return estrin(z, z * z, InverseFit::kAtan);
}

// The angle of (x, y) for x, y >= 0, and pi less that where `mirrored`; a NaN where both are
// infinite or zero. A ratio t above 1/2 is brought below it by
// atan(t) = pi/4 + atan((t - 1) / (t + 1)), where t - 1 is exact, and atan(t) = pi/2 - atan(1/t).
template <class T>
TOMLIN_INLINE T quadrant_angle(T y, T x, Mask<T> mirrored) {
  const Mask<T> steep = y > x;
  const T small = select(steep, x, y);
  const T large = select(steep, y, x);
  const Mask<T> wide = small > T(0.5) * large;
  const T u = select(wide, small - large, small) / select(wide, small + large, large);

  const T from_axis = select(wide, T(1.0), T(0.0));
  const T in_quadrant = select(steep, T(2.0) - from_axis, from_axis);
  const T eighths = select(mirrored, T(4.0) - in_quadrant, in_quadrant);
  const T turned = select(steep, -u, u);
  const T main = select(mirrored, -turned, turned);
  const T z = u * u;
  return plus_eighth_turns(eighths, main, main * z * arctangent_series(z));
}

template <class T>
TOMLIN_INLINE T atan_of(T x) {
  return copysign(quadrant_angle(abs(x), T(1.0), T(1.0) < T(0.0)), x);
}

template <class T>
TOMLIN_INLINE T atan2_of(T y, T x) {
  constexpr int bias = Fit::kBias, digits = Fit::kFractionBits;
  T ax = abs(x), ay = abs(y);
  // Away from overflow and from subnormal numbers, whose ratio decides as well.
  const T largest = max(ax, ay);
  const T grown =
      select(largest < T(power_of_two(2 - bias + digits)), T(power_of_two(2 * digits)), T(1.0));
  const T scale = select(largest > T(power_of_two(bias - 2)), T(0.125), grown);
  // Two equal ones are as good as two ones, infinities too; beside a zero any x will do.
  const Mask<T> equal = ax == ay;
  ay = select(equal, select(largest == T(0.0), T(0.0), T(1.0)), ay * scale);
  ax = select(equal, T(1.0), ax * scale);
  const Mask<T> behind = copysign(T(1.0), x) < T(0.0);
  return copysign(quadrant_angle(ay, ax, behind), y);
}

// asin(s) = s + s z (asin(s)/s - 1)/z, z = s^2, for |s| <= 1/2; beyond, s = sqrt((1 - |x|) / 2) and
// asin(x) = pi/2 - 2 asin(s).
template <class T>
struct HalfArc {
  Mask<T> beyond;
  T s, z;
  TOMLIN_INLINE explicit HalfArc(T x) : beyond(abs(x) > T(0.5)) {
    const T magnitude = abs(x);
    z = select(beyond, (T(1.0) - magnitude) * T(0.5), magnitude * magnitude);
    s = select(beyond, sqrt(z), magnitude);
  }
  // n pi / 4 + factor asin(s).
  TOMLIN_INLINE T angle(T n, T factor) const {
    const T main = factor * s;
    return plus_eighth_turns(n, main, main * z * estrin(z, z * z, InverseFit::kAsin));
  }
};

template <class T>
TOMLIN_INLINE T asin_of(T x) {
  const HalfArc<T> arc(x);
  const T n = select(arc.beyond, T(2.0), T(0.0));
  return copysign(arc.angle(n, select(arc.beyond, T(-2.0), T(1.0))), x);
}

template <class T>
TOMLIN_INLINE T acos_of(T x) {
  const HalfArc<T> arc(x);
  const Mask<T> negative = x < T(0.0);
  const T n = select(arc.beyond, select(negative, T(4.0), T(0.0)), T(2.0));
  const T sign = select(negative, T(1.0), T(-1.0));
  return arc.angle(n, select(arc.beyond, T(-2.0) * sign, sign));
}

template <class T>
TOMLIN_INLINE T tan_turns_of(T x) {
  T s, c;
  sincos_turns(x, s, c);
  return s / c;
}

template <class T>
TOMLIN_INLINE T floor_of(T x) {
  const T nearest = round(x);
  return select(nearest > x, nearest - T(1.0), nearest);
}

}  // namespace math_detail

// Errors: atan 1.5 ulp, atan2 1.6, asin 1.2, acos 1.2; subnormal arguments
// and results included. Zeros and infinities as in C: atan2(y, x) is in [-pi, pi], with the sign of
// y, and atan2(0, 0) = 0; asin and acos of |x| > 1 are NaNs.
//
// tan_turns(x) = tan(2 pi x) is the quotient of sine and cosine: near a pole its relative error is
// that of x, as large as it then is.
#define TOMLIN_INVERSE_TRIGONOMETRY(T)                                    \
  TOMLIN_INLINE T atan(T x) { return math_detail::atan_of(x); }           \
  TOMLIN_INLINE T atan2(T y, T x) { return math_detail::atan2_of(y, x); } \
  TOMLIN_INLINE T asin(T x) { return math_detail::asin_of(x); }           \
  TOMLIN_INLINE T acos(T x) { return math_detail::acos_of(x); }           \
  TOMLIN_INLINE T tan_turns(T x) { return math_detail::tan_turns_of(x); } \
  TOMLIN_INLINE T floor(T x) { return math_detail::floor_of(x); }
TOMLIN_INVERSE_TRIGONOMETRY(double)
TOMLIN_INVERSE_TRIGONOMETRY(Pack)
#undef TOMLIN_INVERSE_TRIGONOMETRY

// ---------------------------------------------------------------------------------------------
// Dual

template <class T, int n>
TOMLIN_INLINE Dual<T, n> atan(const Dual<T, n>& a) {
  return Dual<T, n>::chain(atan(a.value), T(1.0) / fma(a.value, a.value, T(1.0)), a);
}
// (x dy - y dx) / (x^2 + y^2).
template <class T, int n>
TOMLIN_INLINE Dual<T, n> atan2(const Dual<T, n>& y, const Dual<T, n>& x) {
  const T inverse = T(1.0) / fma(x.value, x.value, y.value * y.value);
  const T along_y = x.value * inverse, along_x = -(y.value * inverse);
  Dual<T, n> r;
  r.value = atan2(y.value, x.value);
  for (int i = 0; i < n; ++i) {
    r.derivative[i] = fma(along_y, y.derivative[i], along_x * x.derivative[i]);
  }
  return r;
}
template <class T, int n, ConstantFor<T> S>
TOMLIN_INLINE Dual<T, n> atan2(const Dual<T, n>& y, const S& x) {
  return atan2(y, Dual<T, n>(x));
}
template <class T, int n, ConstantFor<T> S>
TOMLIN_INLINE Dual<T, n> atan2(const S& y, const Dual<T, n>& x) {
  return atan2(Dual<T, n>(y), x);
}
// 1 / sqrt(1 - x^2), without cancellation near 1; infinite at 1.
template <class T, int n>
TOMLIN_INLINE Dual<T, n> asin(const Dual<T, n>& a) {
  const T slope = T(1.0) / sqrt((T(1.0) - a.value) * (T(1.0) + a.value));
  return Dual<T, n>::chain(asin(a.value), slope, a);
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> acos(const Dual<T, n>& a) {
  const T slope = T(-1.0) / sqrt((T(1.0) - a.value) * (T(1.0) + a.value));
  return Dual<T, n>::chain(acos(a.value), slope, a);
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> tan_turns(const Dual<T, n>& a) {
  const T t = tan_turns(a.value);
  return Dual<T, n>::chain(t, fma(t, t, T(1.0)) * tau<Scalar<T>>(), a);
}
// At an integer, where it jumps, the derivative is that to the right: none.
template <class T, int n>
TOMLIN_INLINE Dual<T, n> floor(const Dual<T, n>& a) {
  return Dual<T, n>(floor(a.value));
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
