#include "framework/core/numbers/quad.hpp"

#include "framework/core/numbers/binary128.hpp"
#include "framework/core/numbers/hyperbolic.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/number_types.hpp"

namespace tomlin {
namespace {

// x = rest + n / 4, |rest| <= 1/8 without error; theta = 2 pi rest.
struct QuarterTurns {
  Quad theta;
  int quarter;  // n modulo 4, from -2 to 2

  explicit QuarterTurns(Quad x) {
    const Quad n = round(Quad(4) * x);
    theta = tau<Quad>() * (x - n * Quad(0.25));
    const Quad modulo = n - Quad(4) * round(n * Quad(0.25));
    quarter = modulo == modulo ? static_cast<int>(static_cast<double>(modulo)) : 0;
  }
};

// The functions that a kernel calls on eight lanes.
template <class F, class... Rest>
QuadPack map(F f, const QuadPack& a, const Rest&... rest) {
  QuadPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = f(a.v[i], rest.v[i]...);
  return r;
}
template <class F, class Lanes>
QuadPackMask compare(F f, const Lanes& a, const Lanes& b) {
  QuadPackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = f(a.v[i], b.v[i]);
  return r;
}

}  // namespace

Quad abs(Quad x) { return binary128::fabs(x.v); }
Quad copysign(Quad magnitude, Quad sign) { return binary128::copysign(magnitude.v, sign.v); }
Quad round(Quad x) { return binary128::roundeven(x.v); }
Quad floor(Quad x) { return binary128::floor(x.v); }
Quad sqrt(Quad x) { return binary128::sqrt(x.v); }
Quad exp(Quad x) { return binary128::exp(x.v); }
Quad log(Quad x) { return binary128::log(x.v); }
Quad pow(Quad x, Quad y) { return binary128::pow(x.v, y.v); }
Quad atan(Quad x) { return binary128::atan(x.v); }
Quad atan2(Quad y, Quad x) { return binary128::atan2(y.v, x.v); }
Quad asin(Quad x) { return binary128::asin(x.v); }
Quad acos(Quad x) { return binary128::acos(x.v); }
Quad sinh(Quad x) { return binary128::sinh(x.v); }
Quad cosh(Quad x) { return binary128::cosh(x.v); }
Quad tanh(Quad x) { return binary128::tanh(x.v); }

Quad sin_turns(Quad x) {
  const QuarterTurns turns(x);
  const Quad s = turns.quarter & 1 ? binary128::cos(turns.theta.v) : binary128::sin(turns.theta.v);
  return turns.quarter & 2 ? -s : s;
}
Quad cos_turns(Quad x) {
  const QuarterTurns turns(x);
  const Quad c = turns.quarter & 1 ? binary128::sin(turns.theta.v) : binary128::cos(turns.theta.v);
  return (turns.quarter + 1) & 2 ? -c : c;
}
void sincos_turns(Quad x, Quad& s, Quad& c) {
  s = sin_turns(x);
  c = cos_turns(x);
}
Quad tan_turns(Quad x) { return math_detail::tan_turns_of(x); }

QuadPackMask QuadPackMask::first(int n) {
  QuadPackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = i < n;
  return r;
}

QuadPack QuadPack::broadcast(Quad x) {
  QuadPack r;
  for (Quad& lane : r.v) lane = x;
  return r;
}
QuadPack QuadPack::load(const Quad* from) { return load_unaligned(from); }
QuadPack QuadPack::load_unaligned(const Quad* from) {
  QuadPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = from[i];
  return r;
}
void QuadPack::store(Quad* to) const { store_unaligned(to); }
void QuadPack::store_unaligned(Quad* to) const {
  for (int i = 0; i < kLanes; ++i) to[i] = v[i];
}

#define TOMLIN_QUAD_MAP1(name, expression)            \
  QuadPack name(const QuadPack& a) {                  \
    return map([](Quad x) { return expression; }, a); \
  }
#define TOMLIN_QUAD_MAP2(name, expression)                       \
  QuadPack name(const QuadPack& a, const QuadPack& b) {          \
    return map([](Quad x, Quad y) { return expression; }, a, b); \
  }
#define TOMLIN_QUAD_MAP3(name, expression)                                  \
  QuadPack name(const QuadPack& a, const QuadPack& b, const QuadPack& c) {  \
    return map([](Quad x, Quad y, Quad z) { return expression; }, a, b, c); \
  }
#define TOMLIN_QUAD_COMPARE(name, expression)                        \
  QuadPackMask name(const QuadPack& a, const QuadPack& b) {          \
    return compare([](Quad x, Quad y) { return expression; }, a, b); \
  }

TOMLIN_QUAD_MAP2(operator+, x + y)
TOMLIN_QUAD_MAP2(operator-, x - y)
TOMLIN_QUAD_MAP2(operator*, x* y)
TOMLIN_QUAD_MAP2(operator/, x / y)
TOMLIN_QUAD_MAP1(operator-, -x)
TOMLIN_QUAD_MAP3(fma, tomlin::fma(x, y, z))
TOMLIN_QUAD_MAP3(fnma, tomlin::fnma(x, y, z))
TOMLIN_QUAD_MAP1(sqrt, tomlin::sqrt(x))
TOMLIN_QUAD_MAP1(abs, tomlin::abs(x))
TOMLIN_QUAD_MAP1(round, tomlin::round(x))
TOMLIN_QUAD_MAP2(min, tomlin::min(x, y))
TOMLIN_QUAD_MAP2(max, tomlin::max(x, y))
TOMLIN_QUAD_MAP2(copysign, tomlin::copysign(x, y))
TOMLIN_QUAD_MAP1(sin_turns, tomlin::sin_turns(x))
TOMLIN_QUAD_MAP1(cos_turns, tomlin::cos_turns(x))
TOMLIN_QUAD_MAP1(exp, tomlin::exp(x))
TOMLIN_QUAD_MAP1(log, tomlin::log(x))
TOMLIN_QUAD_MAP2(pow, tomlin::pow(x, y))
TOMLIN_QUAD_MAP1(atan, tomlin::atan(x))
TOMLIN_QUAD_MAP2(atan2, tomlin::atan2(x, y))
TOMLIN_QUAD_MAP1(asin, tomlin::asin(x))
TOMLIN_QUAD_MAP1(acos, tomlin::acos(x))
TOMLIN_QUAD_MAP1(tan_turns, tomlin::tan_turns(x))
TOMLIN_QUAD_MAP1(floor, tomlin::floor(x))
TOMLIN_QUAD_MAP1(sinh, tomlin::sinh(x))
TOMLIN_QUAD_MAP1(cosh, tomlin::cosh(x))
TOMLIN_QUAD_MAP1(tanh, tomlin::tanh(x))
TOMLIN_QUAD_COMPARE(operator<, x < y)
TOMLIN_QUAD_COMPARE(operator<=, x <= y)
TOMLIN_QUAD_COMPARE(operator>, x > y)
TOMLIN_QUAD_COMPARE(operator>=, x >= y)
TOMLIN_QUAD_COMPARE(operator==, x == y)
TOMLIN_QUAD_COMPARE(operator!=, x != y)

QuadPack& operator+=(QuadPack& a, const QuadPack& b) { return a = a + b; }
QuadPack& operator-=(QuadPack& a, const QuadPack& b) { return a = a - b; }
QuadPack& operator*=(QuadPack& a, const QuadPack& b) { return a = a * b; }
QuadPack& operator/=(QuadPack& a, const QuadPack& b) { return a = a / b; }

QuadPackMask operator&(const QuadPackMask& a, const QuadPackMask& b) {
  return compare([](bool x, bool y) { return x && y; }, a, b);
}
QuadPackMask operator|(const QuadPackMask& a, const QuadPackMask& b) {
  return compare([](bool x, bool y) { return x || y; }, a, b);
}
QuadPackMask operator!(const QuadPackMask& a) {
  return compare([](bool x, bool) { return !x; }, a, a);
}
bool any(const QuadPackMask& a) {
  for (const bool lane : a.v) {
    if (lane) return true;
  }
  return false;
}
bool all(const QuadPackMask& a) { return !any(!a); }

QuadPack select(const QuadPackMask& mask, const QuadPack& a, const QuadPack& b) {
  QuadPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = mask.v[i] ? a.v[i] : b.v[i];
  return r;
}
Quad sum(const QuadPack& a) {
  return ((a.v[0] + a.v[4]) + (a.v[2] + a.v[6])) + ((a.v[1] + a.v[5]) + (a.v[3] + a.v[7]));
}
QuadPack permute(const QuadPack& a, const std::int64_t* order) {
  QuadPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[order[i]];
  return r;
}
QuadPack three_lanes(Quad a, Quad b, Quad c) {
  QuadPack r(0);
  r.v[0] = a;
  r.v[1] = b;
  r.v[2] = c;
  return r;
}
void sincos_turns(const QuadPack& x, QuadPack& s, QuadPack& c) {
  for (int i = 0; i < kLanes; ++i) sincos_turns(x.v[i], s.v[i], c.v[i]);
}

}  // namespace tomlin
