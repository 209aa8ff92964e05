#pragma once

#include "framework/core/numbers/quad.hpp"

/// Coefficients of schemes, each to all digits of every number type.
namespace tomlin {

/// A quotient of integers.
struct Coefficient {
  double numerator = 0.0;
  double denominator = 1.0;

  constexpr bool zero() const { return numerator == 0.0; }
  template <class Real>
  constexpr Real as() const {
    return Real(numerator) / Real(denominator);
  }
};

/// A decimal fraction, such as "-1.25e-2", of up to 33 digits.
struct Decimal {
  Quad value = Quad(0.0);

  constexpr Decimal() = default;
  constexpr explicit Decimal(Quad x) : value(x) {}
  consteval Decimal(const char* text) {  // NOLINT: a number is a number
    const bool negative = *text == '-';
    if (negative) ++text;
    int power = 0;
    bool fraction = false;
    for (; *text != '\0' && *text != 'e'; ++text) {
      if (*text == '.') {
        fraction = true;
        continue;
      }
      value = value * Quad(10.0) + Quad(*text - '0');
      if (fraction) --power;
    }
    if (*text == 'e') power += exponent(text + 1);
    Quad scale(1.0);  // exact up to 1e48
    for (int k = 0; k < (power < 0 ? -power : power); ++k) scale = scale * Quad(10.0);
    value = power < 0 ? value / scale : value * scale;
    if (negative) value = -value;
  }

  friend constexpr Decimal operator-(const Decimal& a, const Decimal& b) {
    return Decimal(a.value - b.value);
  }
  constexpr bool zero() const { return value == Quad(0.0); }
  template <class Real>
  constexpr Real as() const {
    return static_cast<Real>(value);
  }

 private:
  static consteval int exponent(const char* text) {
    const bool negative = *text == '-';
    if (negative || *text == '+') ++text;
    int power = 0;
    for (; *text != '\0'; ++text) power = 10 * power + (*text - '0');
    return negative ? -power : power;
  }
};

}  // namespace tomlin
