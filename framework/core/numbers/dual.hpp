// Dual: a value and its derivatives along n directions, carried through every operation.
//
// Nests for second derivatives, Dual<Dual<double, 3>, 3>, and takes every number of
// number_types.hpp. Comparisons look at the value only, so that a Dual takes the branch its number
// would take.
#pragma once

#include <type_traits>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

template <class T, int n>
struct Dual;

template <class T, int n>
struct MaskOf<Dual<T, n>> {
  using Type = Mask<T>;
};

template <class T, int n>
struct ScalarOf<Dual<T, n>> : ScalarOf<T> {};

template <class T>
inline constexpr bool is_dual = false;
template <class T, int n>
inline constexpr bool is_dual<Dual<T, n>> = true;

// A plain constant beside a Dual<T, n>: a number, or a T, whose derivatives are zero.
template <class S, class T>
concept ConstantFor = std::is_convertible_v<S, T>;

template <class T, int n>
struct Dual {
  T value;
  T derivative[n];

  Dual() = default;
  template <ConstantFor<T> S>
  TOMLIN_INLINE Dual(const S& constant) : value(constant) {  // NOLINT: a constant is a Dual
    for (int i = 0; i < n; ++i) derivative[i] = T(0.0);
  }
  // The independent variable of direction `index`.
  TOMLIN_INLINE static Dual variable(const T& value, int index) {
    Dual r(value);
    r.derivative[index] = T(1.0);
    return r;
  }
  // f(a) with f' = slope.
  TOMLIN_INLINE static Dual chain(const T& value, const T& slope, const Dual& a) {
    Dual r;
    r.value = value;
    for (int i = 0; i < n; ++i) r.derivative[i] = slope * a.derivative[i];
    return r;
  }

  TOMLIN_INLINE friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value + b.value;
    for (int i = 0; i < n; ++i) r.derivative[i] = a.derivative[i] + b.derivative[i];
    return r;
  }
  TOMLIN_INLINE friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value - b.value;
    for (int i = 0; i < n; ++i) r.derivative[i] = a.derivative[i] - b.derivative[i];
    return r;
  }
  TOMLIN_INLINE friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value * b.value;
    for (int i = 0; i < n; ++i) {
      r.derivative[i] = fma(a.value, b.derivative[i], b.value * a.derivative[i]);
    }
    return r;
  }
  TOMLIN_INLINE friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r;
    r.value = a.value / b.value;
    const T inverse = T(1.0) / b.value;
    for (int i = 0; i < n; ++i) {
      r.derivative[i] = fnma(r.value, b.derivative[i], a.derivative[i]) * inverse;
    }
    return r;
  }
  TOMLIN_INLINE friend Dual operator-(const Dual& a) {
    Dual r;
    r.value = -a.value;
    for (int i = 0; i < n; ++i) r.derivative[i] = -a.derivative[i];
    return r;
  }

  // Constants get their own operators: multiplying their zero derivatives would not be free.
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator+(const Dual& a, const S& b) {
    Dual r = a;
    r.value = a.value + constant(b);
    return r;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator+(const S& a, const Dual& b) {
    return b + a;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator-(const Dual& a, const S& b) {
    Dual r = a;
    r.value = a.value - constant(b);
    return r;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator-(const S& a, const Dual& b) {
    Dual r = -b;
    r.value = constant(a) - b.value;
    return r;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator*(const Dual& a, const S& b) {
    Dual r;
    const auto factor = constant(b);
    r.value = a.value * factor;
    for (int i = 0; i < n; ++i) r.derivative[i] = a.derivative[i] * factor;
    return r;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator*(const S& a, const Dual& b) {
    return b * a;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator/(const Dual& a, const S& b) {
    Dual r;
    const auto divisor = constant(b);
    r.value = a.value / divisor;
    for (int i = 0; i < n; ++i) r.derivative[i] = a.derivative[i] / divisor;
    return r;
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual operator/(const S& a, const Dual& b) {
    const T quotient = constant(a) / b.value;
    return chain(quotient, -(quotient / b.value), b);
  }

  template <class S>
  TOMLIN_INLINE Dual& operator+=(const S& b) {
    return *this = *this + b;
  }
  template <class S>
  TOMLIN_INLINE Dual& operator-=(const S& b) {
    return *this = *this - b;
  }
  template <class S>
  TOMLIN_INLINE Dual& operator*=(const S& b) {
    return *this = *this * b;
  }
  template <class S>
  TOMLIN_INLINE Dual& operator/=(const S& b) {
    return *this = *this / b;
  }

  TOMLIN_INLINE friend Mask<T> operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  TOMLIN_INLINE friend Mask<T> operator<=(const Dual& a, const Dual& b) {
    return a.value <= b.value;
  }
  TOMLIN_INLINE friend Mask<T> operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  TOMLIN_INLINE friend Mask<T> operator>=(const Dual& a, const Dual& b) {
    return a.value >= b.value;
  }
  TOMLIN_INLINE friend Mask<T> operator==(const Dual& a, const Dual& b) {
    return a.value == b.value;
  }
  TOMLIN_INLINE friend Mask<T> operator!=(const Dual& a, const Dual& b) {
    return a.value != b.value;
  }

  TOMLIN_INLINE friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
    Dual r;
    r.value = fma(a.value, b.value, c.value);
    for (int i = 0; i < n; ++i) {
      const T rest = fma(b.value, a.derivative[i], c.derivative[i]);
      r.derivative[i] = fma(a.value, b.derivative[i], rest);
    }
    return r;
  }
  TOMLIN_INLINE friend Dual fnma(const Dual& a, const Dual& b, const Dual& c) {
    return fma(-a, b, c);
  }
  TOMLIN_INLINE friend Dual select(const Mask<T>& mask, const Dual& a, const Dual& b) {
    Dual r;
    r.value = select(mask, a.value, b.value);
    for (int i = 0; i < n; ++i) r.derivative[i] = select(mask, a.derivative[i], b.derivative[i]);
    return r;
  }
  TOMLIN_INLINE friend Dual min(const Dual& a, const Dual& b) { return select(a < b, a, b); }
  TOMLIN_INLINE friend Dual max(const Dual& a, const Dual& b) { return select(a > b, a, b); }

  // At a kink the derivative is that of the side the value's sign bit names.
  TOMLIN_INLINE friend Dual abs(const Dual& a) {
    return chain(abs(a.value), copysign(T(1.0), a.value), a);
  }
  TOMLIN_INLINE friend Dual copysign(const Dual& magnitude, const Dual& sign) {
    const T slope = copysign(T(1.0), magnitude.value) * copysign(T(1.0), sign.value);
    return chain(copysign(magnitude.value, sign.value), slope, magnitude);
  }
  TOMLIN_INLINE friend Dual round(const Dual& a) { return Dual(round(a.value)); }

  TOMLIN_INLINE friend Dual sqrt(const Dual& a) {
    const T root = sqrt(a.value);
    return chain(root, T(0.5) / root, a);
  }
  TOMLIN_INLINE friend Dual exp(const Dual& a) {
    const T e = exp(a.value);
    return chain(e, e, a);
  }
  TOMLIN_INLINE friend Dual log(const Dual& a) { return chain(log(a.value), T(1.0) / a.value, a); }
  TOMLIN_INLINE friend void sincos_turns(const Dual& a, Dual& s, Dual& c) {
    T sine, cosine;
    sincos_turns(a.value, sine, cosine);
    const Dual copy = a;  // a may be s or c
    s = chain(sine, cosine * tau<Scalar<T>>(), copy);
    c = chain(cosine, sine * -tau<Scalar<T>>(), copy);
  }
  TOMLIN_INLINE friend Dual sin_turns(const Dual& a) {
    Dual s, c;
    sincos_turns(a, s, c);
    return s;
  }
  TOMLIN_INLINE friend Dual cos_turns(const Dual& a) {
    Dual s, c;
    sincos_turns(a, s, c);
    return c;
  }

  // A constant exponent or base keeps the other's derivative out, and with it the logarithm. It is
  // handed down as a constant to a nested Dual, for the same reason.
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual pow(const Dual& a, const S& exponent) {
    const auto e = constant(exponent);
    return chain(pow(a.value, e), power_slope(a.value, e), a);
  }
  template <ConstantFor<T> S>
  TOMLIN_INLINE friend Dual pow(const S& base, const Dual& exponent) {
    const auto b = constant(base);
    const T p = pow(b, exponent.value);
    return chain(p, exponent_slope(T(b), p), exponent);
  }
  TOMLIN_INLINE friend Dual pow(const Dual& a, const Dual& exponent) {
    const T p = pow(a.value, exponent.value);
    const T da = power_slope(a.value, exponent.value);
    const T de = exponent_slope(a.value, p);
    Dual r;
    r.value = p;
    for (int i = 0; i < n; ++i) {
      r.derivative[i] = fma(da, a.derivative[i], de * exponent.derivative[i]);
    }
    return r;
  }

 private:
  // Converts a constant to what the operations of T take beside a T.
  template <class S>
  TOMLIN_INLINE static auto constant(const S& x) {
    if constexpr (!is_dual<T>) {
      return T(x);
    } else if constexpr (std::is_arithmetic_v<S>) {
      return static_cast<double>(x);
    } else {
      return x;
    }
  }
  // d/dx x^y = y x^(y-1), and 0 for y = 0 even at x = 0.
  template <class Y>
  TOMLIN_INLINE static T power_slope(const T& x, const Y& y) {
    if constexpr (std::is_arithmetic_v<Y>) {
      return y == Y(0) ? T(0.0) : T(y * pow(x, y - Y(1)));
    } else {
      return select(y == Y(0.0), T(0.0), y * pow(x, y - Y(1.0)));
    }
  }
  // d/dy x^y = x^y log x, and 0 at x = 0, its limit for y > 0.
  TOMLIN_INLINE static T exponent_slope(const T& x, const T& p) {
    return select(x == T(0.0), T(0.0), p * log(x));
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
