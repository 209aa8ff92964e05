#include "framework/core/numbers/quad.hpp"

#include "framework/core/numbers/inverse_trigonometry.hpp"

// The functions are written out with + - * / only, which binary128 arithmetic rounds correctly:
// libm and libquadmath differ between machines. Series run in Horner's form with their quotients,
// since a division takes hardly longer than a multiplication.
namespace tomlin {

// What the templates of the inverse functions ask of a number type.
inline namespace TOMLIN_TARGET {
namespace math_detail {

template <>
struct Fit<Quad> {
  using Bits = unsigned __int128;
  static constexpr int kFractionBits = 112, kBias = 16383;
};
template <>
struct InverseFit<Quad> {
  // pi/4 in three doubles; the two of the first number are 107 bits together.
  static constexpr Quad kEighthTurn = Quad(0x1.921fb54442d18p-1) + Quad(0x1.1a62633145c07p-55);
  static constexpr Quad kEighthTurnRest = -0x1.f1976b7ed8fbcp-111;
};

// Taylor's series: the first term left out is below 2^-123, as z <= 1/4.
template <>
Quad arctangent_series(Quad z) {
  Quad series = 0;
  for (int k = 119; k > 1; k -= 2) series = Quad(1) / Quad(k) - z * series;
  return -series;
}

}  // namespace math_detail
}  // namespace TOMLIN_TARGET

namespace {

using Bits = unsigned __int128;
static_assert(sizeof(Bits) == sizeof(Quad));

constexpr int kFractionBits = 112;
constexpr int kBias = 16383;
constexpr Bits kSignBit = Bits{1} << 127;

Bits bits_of(Quad x) { return __builtin_bit_cast(Bits, x); }
Quad from_bits(Bits x) { return __builtin_bit_cast(Quad, x); }

// 2^n for a normal number.
Quad power_of_two(int n) { return from_bits(static_cast<Bits>(n + kBias) << kFractionBits); }
// x 2^n. In two steps, since 2^n may be out of range when the result is not; the first is exact.
Quad scaled(Quad x, int n) { return x * power_of_two(n / 2) * power_of_two(n - n / 2); }

const Quad kInfinity = __builtin_inf();
const Quad kNan = __builtin_nan("");
// Each the sum of three doubles, rounded once; in 1 / ln 2 a double is enough.
constexpr Quad kTau =
    Quad(0x1.921fb54442d18p+2) + (Quad(0x1.1a62633145c07p-52) - Quad(0x1.f1976b7ed8fbcp-108));
constexpr double kLog2E = 0x1.71547652b82fep+0;
// ln 2 = kLn2Short + kLn2Rest; a product of kLn2Short with an exponent is exact.
constexpr Quad kLn2Short = Quad(0x1.62e42fefa39efp-1) + Quad(0x1.abc9e3b398000p-56);
constexpr Quad kLn2Rest =
    Quad(0x1.f97b57a079a19p-103) + (Quad(0x1.9ca62d8b62834p-158) + Quad(0x1.75b8baafa2be8p-212));

// x = rest + n / 4, |rest| <= 1/8; theta = 2 pi rest.
struct QuarterTurns {
  Quad theta, z;
  int quarter;  // n modulo 4, from -2 to 2

  explicit QuarterTurns(Quad x) {
    const Quad n = round(Quad(4) * x);
    theta = kTau * (x - n * Quad(0.25));
    z = theta * theta;
    const Quad modulo = n - Quad(4) * round(n * Quad(0.25));
    quarter = modulo == modulo ? static_cast<int>(static_cast<double>(modulo)) : 0;
  }

  // sin theta and cos theta by Taylor's series, |theta| <= pi / 4: the first term left out is below
  // 2^-119 of the result.
  Quad sine() const {
    Quad series = 1;
    for (int k = 30; k > 0; k -= 2) series = Quad(1) - z * series / Quad(k * (k + 1));
    return theta * series;
  }
  Quad cosine() const {
    Quad series = 1;
    for (int k = 31; k > 0; k -= 2) series = Quad(1) - z * series / Quad(k * (k + 1));
    return series;
  }
};

// An unevaluated sum, about 226 bits.
struct Twofold {
  Quad hi, lo;
};

Twofold fast_two_sum(Quad a, Quad b) {
  const Quad s = a + b;
  return {s, b - (s - a)};
}

// The upper 56 bits of x, rounded; what remains has 56 bits too, and products of such are exact.
Quad upper_half(Quad x) {
  constexpr Bits unit = Bits{1} << 57;
  return from_bits((bits_of(x) + unit / 2) & ~(unit - 1));
}
Twofold two_product(Quad a, Quad b) {
  const Quad a_hi = upper_half(a), b_hi = upper_half(b);
  const Quad a_lo = a - a_hi, b_lo = b - b_hi;
  const Quad p = a * b;
  return {p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}
Twofold product(const Twofold& a, const Twofold& b) {
  const Twofold p = two_product(a.hi, b.hi);
  return fast_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
// a + b for |a.hi| >= |b.hi|, or a = 0.
Twofold sum(const Twofold& a, const Twofold& b) {
  const Twofold s = fast_two_sum(a.hi, b.hi);
  return fast_two_sum(s.hi, s.lo + (a.lo + b.lo));
}
// a / b for numbers a, and b of two parts.
Twofold quotient(Quad a, const Twofold& b) {
  const Quad q = a / b.hi;
  const Twofold p = two_product(q, b.hi);
  return fast_two_sum(q, (((a - p.hi) - p.lo) - q * b.lo) / b.hi);
}

// log x to about 2^-135 relative, for finite x > 0, which leaves pow the 15 bits that a large
// exponent takes.
Twofold long_log(Quad x) {
  // x = 2^k (1 + f), 1 + f from sqrt(1/2) to sqrt(2); f is exact.
  constexpr double root_two = 0x1.6a09e667f3bcdp+0;
  const bool subnormal = bits_of(x) >> kFractionBits == 0;
  const Bits bits = bits_of(subnormal ? x * power_of_two(kFractionBits) : x);
  int k = static_cast<int>(bits >> kFractionBits) - kBias - (subnormal ? kFractionBits : 0);
  const Bits fraction = bits & ((Bits{1} << kFractionBits) - 1);
  Quad m = from_bits(fraction | (static_cast<Bits>(kBias) << kFractionBits));
  if (m > Quad(root_two)) {
    m *= Quad(0.5);
    ++k;
  }
  const Quad f = m - Quad(1);
  // log(1 + f) = 2 atanh(s) = 2 s (1 + z/3 + z^2/5 + ...), s = f / (2 + f), z = s^2 <= 0.0295. From
  // z^4 on a Quad is enough; the first term left out is below 2^-143.
  const Twofold s = quotient(f, fast_two_sum(2, f));
  const Twofold z = product(s, s);
  Quad tail = 0;
  for (int n = 55; n > 8; n -= 2) tail = tail * z.hi + Quad(1) / Quad(n);
  Twofold series{tail, 0};
  for (int n = 7; n > 0; n -= 2) series = sum(quotient(1, {n, 0}), product(z, series));
  const Twofold log_m = product({s.hi * Quad(2), s.lo * Quad(2)}, series);
  return sum({Quad(k) * kLn2Short, Quad(k) * kLn2Rest}, log_m);
}

// exp(x + tail) for a tail far below x.
Quad exp_of(Quad x, Quad tail) {
  if (x != x) return x;
  // The largest finite result is exp(11356.5...), the smallest exp(-11432.7...).
  if (x > Quad(11360)) return kInfinity;
  if (x < Quad(-11440)) return 0;
  const Quad n = round(x * Quad(kLog2E));
  const Quad r = (x - n * kLn2Short) + (tail - n * kLn2Rest);
  // Taylor's series; the first term left out is below 2^-121, as |r| < 0.35.
  Quad series = 1;
  for (int k = 26; k > 0; --k) series = Quad(1) + r * series / Quad(k);
  return scaled(series, static_cast<int>(static_cast<double>(n)));
}

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

Quad abs(Quad x) { return from_bits(bits_of(x) & ~kSignBit); }
Quad copysign(Quad magnitude, Quad sign) {
  return from_bits((bits_of(magnitude) & ~kSignBit) | (bits_of(sign) & kSignBit));
}

Quad round(Quad x) {
  // Adding and subtracting 2^112 leaves no room for a fraction.
  const Quad limit = 0x1p112;
  const Quad shift = copysign(limit, x);
  return abs(x) < limit ? copysign((x + shift) - shift, x) : x;
}

Quad sqrt(Quad x) {
  if (!(x > Quad(0)) || x == kInfinity) return x < Quad(0) ? kNan : x;
  // x = m 2^(2 k) with m from 1/2 to 2, so that its root fits a double.
  const bool subnormal = bits_of(x) >> kFractionBits == 0;
  const Quad normal = subnormal ? x * power_of_two(kFractionBits) : x;
  const int exponent = static_cast<int>(bits_of(normal) >> kFractionBits) - kBias;
  const int k = exponent >> 1;
  const Quad m = normal * power_of_two(-k) * power_of_two(-k);
  // The square of a double is exact, and so is its difference from m. Two terms of the series of
  // sqrt(y^2 + (m - y^2)) are then enough.
  const Quad y = tomlin::sqrt(static_cast<double>(m));
  const Quad d = (m - y * y) / (Quad(2) * y);
  const Quad root = y + (d - d * d / (Quad(2) * y));
  return root * power_of_two(subnormal ? k - kFractionBits / 2 : k);
}

void sincos_turns(Quad x, Quad& s, Quad& c) {
  const QuarterTurns turns(x);
  const Quad sine = turns.sine(), cosine = turns.cosine();
  const bool swapped = turns.quarter & 1;
  s = swapped ? cosine : sine;
  c = swapped ? sine : cosine;
  if (turns.quarter & 2) s = -s;
  if ((turns.quarter + 1) & 2) c = -c;
}
Quad sin_turns(Quad x) {
  const QuarterTurns turns(x);
  const Quad s = turns.quarter & 1 ? turns.cosine() : turns.sine();
  return turns.quarter & 2 ? -s : s;
}
Quad cos_turns(Quad x) {
  const QuarterTurns turns(x);
  const Quad c = turns.quarter & 1 ? turns.sine() : turns.cosine();
  return (turns.quarter + 1) & 2 ? -c : c;
}

Quad exp(Quad x) { return exp_of(x, 0); }

Quad log(Quad x) {
  if (x == Quad(0)) return -kInfinity;
  if (!(x > Quad(0))) return kNan;
  return x < kInfinity ? long_log(x).hi : x;
}

Quad pow(Quad x, Quad y) {
  if (y == Quad(0) || x == Quad(1)) return 1;
  if (x != x || y != y) return kNan;
  const bool integral = round(y) == y;
  if (x < Quad(0) && !integral) return kNan;
  const bool odd = integral && round(y * Quad(0.5)) != y * Quad(0.5);
  const Quad base = abs(x);
  Quad r;
  if (base == Quad(0) || base == kInfinity) {
    r = (base == Quad(0)) == (y < Quad(0)) ? kInfinity : Quad(0);
  } else {
    const Twofold log_base = long_log(base);
    const Quad p = y * log_base.hi;
    // Beyond this exp is 0 or infinity, and the parts of the product may overflow.
    const bool in_range = abs(p) < Quad(20000);
    const Quad p_low = in_range ? two_product(y, log_base.hi).lo + y * log_base.lo : Quad(0);
    r = exp_of(p, p_low);
  }
  return x < Quad(0) && odd ? -r : r;
}

Quad atan(Quad x) { return math_detail::atan_of(x); }
Quad atan2(Quad y, Quad x) { return math_detail::atan2_of(y, x); }
Quad asin(Quad x) { return atan2(x, sqrt((Quad(1) - x) * (Quad(1) + x))); }
Quad acos(Quad x) { return atan2(sqrt((Quad(1) - x) * (Quad(1) + x)), x); }
Quad tan_turns(Quad x) { return math_detail::tan_turns_of(x); }
Quad floor(Quad x) { return math_detail::floor_of(x); }

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
