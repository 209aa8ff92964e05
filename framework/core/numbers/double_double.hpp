// DoubleDouble: an unevaluated sum of two doubles, about 106 bits.
//
// For clocks, which add a small step very often, and for positions far from the origin, whose
// remainder within a cell must not lose digits.
#pragma once

#include <cstdint>

#include "framework/core/numbers/pack.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

struct DoubleDouble {
  double hi = 0.0, lo = 0.0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double x) : hi(x) {}  // NOLINT: every double is a DoubleDouble
  // The two must not overlap: |low| <= ulp(high) / 2. two_sum and two_prod make such pairs.
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}

  constexpr explicit operator double() const { return hi + lo; }
};

// a + b = hi + lo exactly.
constexpr DoubleDouble two_sum(double a, double b) {
  const double s = a + b;
  const double b_part = s - a;
  return {s, (a - (s - b_part)) + (b - b_part)};
}
// a + b = hi + lo exactly for |a| >= |b| or a = 0, in half the operations.
constexpr DoubleDouble fast_two_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
// a b = hi + lo exactly, as long as lo does not underflow.
TOMLIN_INLINE DoubleDouble two_prod(double a, double b) {
  const double p = a * b;
  return {p, fma(a, b, -p)};
}

constexpr DoubleDouble operator-(DoubleDouble a) { return {-a.hi, -a.lo}; }

constexpr DoubleDouble operator+(DoubleDouble a, double b) {
  const DoubleDouble s = two_sum(a.hi, b);
  return fast_two_sum(s.hi, s.lo + a.lo);
}
// Both halves are added exactly, so that the error stays relative to the sum even when the two
// cancel.
constexpr DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble s = two_sum(a.hi, b.hi);
  const DoubleDouble t = two_sum(a.lo, b.lo);
  const DoubleDouble u = fast_two_sum(s.hi, s.lo + t.hi);
  return fast_two_sum(u.hi, u.lo + t.lo);
}
constexpr DoubleDouble operator+(double a, DoubleDouble b) { return b + a; }
constexpr DoubleDouble operator-(DoubleDouble a, double b) { return a + (-b); }
constexpr DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + (-b); }
constexpr DoubleDouble operator-(double a, DoubleDouble b) { return (-b) + a; }

TOMLIN_INLINE DoubleDouble operator*(DoubleDouble a, double b) {
  const DoubleDouble p = two_prod(a.hi, b);
  return fast_two_sum(p.hi, fma(a.lo, b, p.lo));
}
TOMLIN_INLINE DoubleDouble operator*(double a, DoubleDouble b) { return b * a; }
TOMLIN_INLINE DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble p = two_prod(a.hi, b.hi);
  return fast_two_sum(p.hi, p.lo + fma(a.hi, b.lo, a.lo * b.hi));
}

constexpr DoubleDouble& operator+=(DoubleDouble& a, double b) { return a = a + b; }
constexpr DoubleDouble& operator+=(DoubleDouble& a, DoubleDouble b) { return a = a + b; }
constexpr DoubleDouble& operator-=(DoubleDouble& a, double b) { return a = a - b; }
constexpr DoubleDouble& operator-=(DoubleDouble& a, DoubleDouble b) { return a = a - b; }
TOMLIN_INLINE DoubleDouble& operator*=(DoubleDouble& a, double b) { return a = a * b; }

/// Adds to a sum whose high and low parts stand in an array.
inline void add_to(double* parts, double x) {
  const DoubleDouble sum = DoubleDouble(parts[0], parts[1]) + x;
  parts[0] = sum.hi;
  parts[1] = sum.lo;
}

// Pairs are normalised, so the high halves decide unless they are equal.
constexpr bool operator==(DoubleDouble a, DoubleDouble b) { return a.hi == b.hi && a.lo == b.lo; }
constexpr bool operator<(DoubleDouble a, DoubleDouble b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}
constexpr bool operator>(DoubleDouble a, DoubleDouble b) { return b < a; }
constexpr bool operator<=(DoubleDouble a, DoubleDouble b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo <= b.lo);
}
constexpr bool operator>=(DoubleDouble a, DoubleDouble b) { return b <= a; }

// With all the digits that Real has.
template <class Real>
constexpr Real from_double_double(DoubleDouble x) {
  if constexpr (sizeof(Real) > sizeof(double)) {
    return Real(x.hi) + Real(x.lo);
  } else {
    return Real(static_cast<double>(x));
  }
}

// x = cells * unit + rest with |rest| <= unit / 2; returns rest, correctly to its own rounding.
//
// unit > 0. Not a number, infinite, or 2^62 units and more: rest is a NaN and cells 0.
inline double remainder_of(DoubleDouble x, double unit, std::int64_t& cells) {
  cells = 0;
  if (!(abs(x.hi) < 0x1p62 * unit)) return __builtin_nan("");
  // The first quotient is off by a rounding error of up to 2^9 cells when x is far away; what it
  // leaves is exact enough for the second to be off by one at most, near a half.
  for (int pass = 0; pass < 3; ++pass) {
    const double count = round(x.hi / unit);
    if (count == 0.0) break;
    x = x - two_prod(count, unit);
    cells += static_cast<std::int64_t>(count);
  }
  // A rest of exactly half a unit in its high part may exceed it in the low one.
  if (x > DoubleDouble(0.5 * unit)) {
    x -= unit;
    ++cells;
  } else if (x < DoubleDouble(-0.5 * unit)) {
    x += unit;
    --cells;
  }
  return static_cast<double>(x);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
