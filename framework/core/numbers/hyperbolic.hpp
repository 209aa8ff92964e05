// sinh, cosh, tanh, sign and unit_step for every number type, with the same bits in every lane of
// every target.
//
// A header of its own, since few kernels call them.
#pragma once

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {

// Errors below 2 ulp; in quad.cpp.
Quad sinh(Quad x);
Quad cosh(Quad x);
Quad tanh(Quad x);
QuadPack sinh(const QuadPack& x);
QuadPack cosh(const QuadPack& x);
QuadPack tanh(const QuadPack& x);

inline namespace TOMLIN_TARGET {
namespace math_detail {

// How polynomials were found is said in elementary_fits.hpp.
struct HyperbolicFit {
  // (sinh(u) / u - 1) / u^2 in z = u^2, |u| <= 1; relative error of sinh 3.1e-19.
  static constexpr double kSinh[7] = {
      0x1.5555555555556p-3,  0x1.1111111111040p-7,  0x1.a01a01a0318d3p-13, 0x1.71de3a4056daap-19,
      0x1.ae646b4cd4e38p-26, 0x1.6118dfb2fe615p-33, 0x1.b52ea7510497dp-41};
  // (tanh(u) / u - 1) / u^2 in z = u^2, |u| <= 9/16; relative error of tanh 1.0e-18.
  static constexpr double kTanh[11] = {
      -0x1.555555555554bp-2,  0x1.1111111110255p-3,  -0x1.ba1ba1b9310d2p-5,  0x1.664f48485e724p-6,
      -0x1.226e2ce5a6c96p-7,  0x1.d6d243717f239p-9,  -0x1.7d8b650886c30p-10, 0x1.345f3a4251efcp-11,
      -0x1.e7fcf7b74986bp-13, 0x1.594e385ff96a7p-14, -0x1.3cd4e90c7b026p-16};
};

// u + u z (f(u)/u - 1)/z, z = u^2: of an odd function near zero.
template <class T, class Real, int n>
TOMLIN_INLINE T odd_series(T u, const Real (&c)[n]) {
  const T z = u * u;
  return fma(u * z, estrin(z, z * z, c), u);
}

// exp(x) / 2 for x >= 0, as exp(x - ln 2): finite as long as cosh is.
template <class T>
TOMLIN_INLINE T half_exp(T x) {
  using F = Fit;
  const T high(F::kLn2High);
  const T reduced = x - high;
  // `lost` is the rounding error of the difference.
  const T back = reduced - x;
  const T lost = (x - (reduced - back)) - (high + back);
  return exp_of(reduced, lost - T(F::kLn2Low));
}

template <class T>
TOMLIN_INLINE T cosh_of(T x) {
  const T half = half_exp(abs(x));
  return half + T(0.25) / half;
}

// Beyond 1 the difference loses no more than a bit.
template <class T>
TOMLIN_INLINE T sinh_of(T x) {
  const T magnitude = abs(x);
  const T half = half_exp(magnitude);
  const T near = odd_series(magnitude, HyperbolicFit::kSinh);
  return copysign(select(magnitude < T(1.0), near, half - T(0.25) / half), x);
}

// tanh(x) = 1 - 2 / (exp(2 x) + 1), where it is above 1/2.
template <class T>
TOMLIN_INLINE T tanh_of(T x) {
  const T magnitude = abs(x);
  const T near = odd_series(magnitude, HyperbolicFit::kTanh);
  const T far = T(1.0) - T(2.0) / (exp_of(T(2.0) * magnitude) + T(1.0));
  return copysign(select(magnitude < T(0.5625), near, far), x);
}

}  // namespace math_detail

// Errors: sinh 1.6 ulp, cosh 1.2, tanh 1.7; subnormal arguments included.
// sinh and cosh are infinite from where the exact value overflows. Of a NaN all are NaNs.
//
// sign(0) = 0, unit_step(x) is 0 below 0 and 1 from there on.
#define TOMLIN_HYPERBOLIC(T)                                    \
  TOMLIN_INLINE T sinh(T x) { return math_detail::sinh_of(x); } \
  TOMLIN_INLINE T cosh(T x) { return math_detail::cosh_of(x); } \
  TOMLIN_INLINE T tanh(T x) { return math_detail::tanh_of(x); }
TOMLIN_HYPERBOLIC(double)
TOMLIN_HYPERBOLIC(Pack)
#undef TOMLIN_HYPERBOLIC

// 1 / cosh(x)^2, the slope of tanh: unlike 1 - tanh(x)^2 it keeps its digits far away.
template <class T>
TOMLIN_INLINE T sech_squared(const T& x) {
  const T c = cosh(x);
  return T(1.0) / (c * c);
}

// x - x is 0, or a NaN where x is one.
template <class T>
TOMLIN_INLINE T sign(const T& x) {
  return select(x > T(0.0), T(1.0), select(x < T(0.0), T(-1.0), x - x));
}
template <class T>
TOMLIN_INLINE T unit_step(const T& x) {
  return select(x >= T(0.0), T(1.0), select(x < T(0.0), T(0.0), x));
}

// ---------------------------------------------------------------------------------------------
// Dual

template <class T, int n>
TOMLIN_INLINE Dual<T, n> sinh(const Dual<T, n>& a) {
  return Dual<T, n>::chain(sinh(a.value), cosh(a.value), a);
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> cosh(const Dual<T, n>& a) {
  return Dual<T, n>::chain(cosh(a.value), sinh(a.value), a);
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> sech_squared(const Dual<T, n>& a) {
  const T s = sech_squared(a.value);
  return Dual<T, n>::chain(s, T(-2.0) * tanh(a.value) * s, a);
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> tanh(const Dual<T, n>& a) {
  return Dual<T, n>::chain(tanh(a.value), sech_squared(a.value), a);
}
// Derivatives at a jump are those beside it: zero.
template <class T, int n>
TOMLIN_INLINE Dual<T, n> sign(const Dual<T, n>& a) {
  return Dual<T, n>(sign(a.value));
}
template <class T, int n>
TOMLIN_INLINE Dual<T, n> unit_step(const Dual<T, n>& a) {
  return Dual<T, n>(unit_step(a.value));
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
