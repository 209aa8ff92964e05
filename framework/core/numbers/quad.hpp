// Quad: quadruple precision (IEEE binary128, 113 bits), and QuadPack, eight of them.
//
// For reference runs, which show what rounding does to the same trajectory in double. Hardly any
// processor computes with it: operations are calls of the compiler's library, functions of the C
// library (binary128.hpp). So a Quad does not depend on the instruction set, and is in none of the
// namespaces of target.hpp; and the operations of QuadPack are functions, not inlined, which keeps
// kernels small at no cost that would show.
#pragma once

#include <cstdint>
#include <type_traits>

#include "framework/core/numbers/pack.hpp"

namespace tomlin {

struct Quad {
#if defined(__SIZEOF_FLOAT128__)
  using Number = __float128;
#else
  using Number = long double;
  static_assert(__LDBL_MANT_DIG__ == 113,
                "quadruple precision needs __float128, or a long double of 113 bits");
#endif

  Number v;

  Quad() = default;
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, Number>) TOMLIN_INLINE constexpr Quad(S x)
      : v(x) {}  // NOLINT: every number is a Quad, exactly

  TOMLIN_INLINE constexpr explicit operator double() const { return static_cast<double>(v); }
};

TOMLIN_INLINE constexpr Quad operator+(Quad a, Quad b) { return a.v + b.v; }
TOMLIN_INLINE constexpr Quad operator-(Quad a, Quad b) { return a.v - b.v; }
TOMLIN_INLINE constexpr Quad operator*(Quad a, Quad b) { return a.v * b.v; }
TOMLIN_INLINE constexpr Quad operator/(Quad a, Quad b) { return a.v / b.v; }
TOMLIN_INLINE constexpr Quad operator-(Quad a) { return -a.v; }
TOMLIN_INLINE constexpr Quad& operator+=(Quad& a, Quad b) { return a = a + b; }
TOMLIN_INLINE constexpr Quad& operator-=(Quad& a, Quad b) { return a = a - b; }
TOMLIN_INLINE constexpr Quad& operator*=(Quad& a, Quad b) { return a = a * b; }
TOMLIN_INLINE constexpr Quad& operator/=(Quad& a, Quad b) { return a = a / b; }

TOMLIN_INLINE constexpr bool operator<(Quad a, Quad b) { return a.v < b.v; }
TOMLIN_INLINE constexpr bool operator<=(Quad a, Quad b) { return a.v <= b.v; }
TOMLIN_INLINE constexpr bool operator>(Quad a, Quad b) { return a.v > b.v; }
TOMLIN_INLINE constexpr bool operator>=(Quad a, Quad b) { return a.v >= b.v; }
TOMLIN_INLINE constexpr bool operator==(Quad a, Quad b) { return a.v == b.v; }
TOMLIN_INLINE constexpr bool operator!=(Quad a, Quad b) { return a.v != b.v; }

// Rounded twice, unlike that of double: the digits to spare are the point of a Quad, and rounding
// once would take fifty times as long.
TOMLIN_INLINE constexpr Quad fma(Quad a, Quad b, Quad c) { return a * b + c; }
TOMLIN_INLINE constexpr Quad fnma(Quad a, Quad b, Quad c) { return c - a * b; }
// The second argument wins when either is a NaN or both are zero, as for double.
TOMLIN_INLINE constexpr Quad min(Quad a, Quad b) { return a < b ? a : b; }
TOMLIN_INLINE constexpr Quad max(Quad a, Quad b) { return a > b ? a : b; }
TOMLIN_INLINE constexpr Quad select(bool mask, Quad a, Quad b) { return mask ? a : b; }
TOMLIN_INLINE constexpr Quad sum(Quad x) { return x; }
Quad abs(Quad x);
Quad copysign(Quad magnitude, Quad sign);
// To the nearest integer, halves to the even one.
Quad round(Quad x);
// Rounded once; errors below are in units of the last place (ulp). Subnormal arguments included.
Quad sqrt(Quad x);

// sin(2 pi x) and cos(2 pi x): error below 2 ulp, near their zeros too.
// Finite arguments beyond 2^112 are whole turns; infinity and NaN give NaN.
Quad sin_turns(Quad x);
Quad cos_turns(Quad x);
void sincos_turns(Quad x, Quad& s, Quad& c);
// Errors below 2 ulp, of pow 3, and 30 outside the range of doubles; special values as for double.
Quad exp(Quad x);
Quad log(Quad x);
Quad pow(Quad x, Quad y);

struct QuadPackMask {
  bool v[kLanes];

  // True in lanes 0 to n-1.
  static QuadPackMask first(int n);
};

struct QuadPack {
  Quad v[kLanes];

  QuadPack() = default;
  template <class S>
  requires std::is_convertible_v<S, Quad> TOMLIN_INLINE QuadPack(const S& x)
      : QuadPack(broadcast(x)) {}  // NOLINT: as for Pack
  static QuadPack load(const Quad* from);
  static QuadPack load_unaligned(const Quad* from);
  void store(Quad* to) const;
  void store_unaligned(Quad* to) const;
  TOMLIN_INLINE Quad lane(int i) const { return v[i]; }

 private:
  static QuadPack broadcast(Quad x);
};

QuadPack operator+(const QuadPack& a, const QuadPack& b);
QuadPack operator-(const QuadPack& a, const QuadPack& b);
QuadPack operator*(const QuadPack& a, const QuadPack& b);
QuadPack operator/(const QuadPack& a, const QuadPack& b);
QuadPack operator-(const QuadPack& a);
QuadPack& operator+=(QuadPack& a, const QuadPack& b);
QuadPack& operator-=(QuadPack& a, const QuadPack& b);
QuadPack& operator*=(QuadPack& a, const QuadPack& b);
QuadPack& operator/=(QuadPack& a, const QuadPack& b);

QuadPackMask operator<(const QuadPack& a, const QuadPack& b);
QuadPackMask operator<=(const QuadPack& a, const QuadPack& b);
QuadPackMask operator>(const QuadPack& a, const QuadPack& b);
QuadPackMask operator>=(const QuadPack& a, const QuadPack& b);
QuadPackMask operator==(const QuadPack& a, const QuadPack& b);
QuadPackMask operator!=(const QuadPack& a, const QuadPack& b);
QuadPackMask operator&(const QuadPackMask& a, const QuadPackMask& b);
QuadPackMask operator|(const QuadPackMask& a, const QuadPackMask& b);
QuadPackMask operator!(const QuadPackMask& a);
bool any(const QuadPackMask& a);
bool all(const QuadPackMask& a);

QuadPack fma(const QuadPack& a, const QuadPack& b, const QuadPack& c);
QuadPack fnma(const QuadPack& a, const QuadPack& b, const QuadPack& c);
QuadPack sqrt(const QuadPack& a);
QuadPack abs(const QuadPack& a);
QuadPack round(const QuadPack& a);
QuadPack min(const QuadPack& a, const QuadPack& b);
QuadPack max(const QuadPack& a, const QuadPack& b);
QuadPack copysign(const QuadPack& a, const QuadPack& b);
QuadPack select(const QuadPackMask& mask, const QuadPack& a, const QuadPack& b);
// The one rule: lanes i and i+4, then i and i+2, then i and i+1.
Quad sum(const QuadPack& a);
// Lane i becomes lane order[i].
QuadPack permute(const QuadPack& a, const std::int64_t* order);
// {a, b, c, 0, ...}
QuadPack three_lanes(Quad a, Quad b, Quad c);

QuadPack sin_turns(const QuadPack& x);
QuadPack cos_turns(const QuadPack& x);
void sincos_turns(const QuadPack& x, QuadPack& s, QuadPack& c);
QuadPack exp(const QuadPack& x);
QuadPack log(const QuadPack& x);
QuadPack pow(const QuadPack& x, const QuadPack& y);

inline namespace TOMLIN_TARGET {
template <>
struct MaskOf<QuadPack> {
  using Type = QuadPackMask;
};
}  // namespace TOMLIN_TARGET

}  // namespace tomlin
