// Vec: a point or a vector in one, two or three dimensions, over any number type.
#pragma once

#include "framework/core/numbers/pack.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

template <class T, int D>
struct Vec {
  static_assert(D >= 1 && D <= 3);
  T v[D];

  TOMLIN_INLINE T& operator[](int axis) { return v[axis]; }
  TOMLIN_INLINE const T& operator[](int axis) const { return v[axis]; }

  TOMLIN_INLINE Vec& operator+=(const Vec& b) { return *this = *this + b; }
  TOMLIN_INLINE Vec& operator-=(const Vec& b) { return *this = *this - b; }
  TOMLIN_INLINE Vec& operator*=(const T& s) { return *this = *this * s; }

  TOMLIN_INLINE friend Vec operator+(const Vec& a, const Vec& b) {
    Vec r;
    for (int i = 0; i < D; ++i) r.v[i] = a.v[i] + b.v[i];
    return r;
  }
  TOMLIN_INLINE friend Vec operator-(const Vec& a, const Vec& b) {
    Vec r;
    for (int i = 0; i < D; ++i) r.v[i] = a.v[i] - b.v[i];
    return r;
  }
  TOMLIN_INLINE friend Vec operator-(const Vec& a) {
    Vec r;
    for (int i = 0; i < D; ++i) r.v[i] = -a.v[i];
    return r;
  }
  TOMLIN_INLINE friend Vec operator*(const Vec& a, const T& s) {
    Vec r;
    for (int i = 0; i < D; ++i) r.v[i] = a.v[i] * s;
    return r;
  }
  TOMLIN_INLINE friend Vec operator*(const T& s, const Vec& a) { return a * s; }
  // s a + b, one rounding per component.
  TOMLIN_INLINE friend Vec fma(const T& s, const Vec& a, const Vec& b) {
    Vec r;
    for (int i = 0; i < D; ++i) r.v[i] = fma(s, a.v[i], b.v[i]);
    return r;
  }
  // The order of the sum is fixed, axis 0 first: it decides the last bit.
  TOMLIN_INLINE friend T dot(const Vec& a, const Vec& b) {
    T r = a.v[0] * b.v[0];
    for (int i = 1; i < D; ++i) r = fma(a.v[i], b.v[i], r);
    return r;
  }
  TOMLIN_INLINE friend T norm_squared(const Vec& a) { return dot(a, a); }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
