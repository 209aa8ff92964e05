// Pack: eight doubles, and the same operations for plain double and bool.
//
// The width is eight on every target, because the one summation rule (eight interleaved partial
// sums, folded pairwise) must not depend on the machine: one 512-bit vector, two 256-bit vectors,
// or an array. Every operation is one correctly rounded IEEE operation, so a lane of a Pack has
// the bits of the same scalar computation on every target. The one exception is the payload and
// sign of a NaN, which the standard leaves open.
#pragma once

#include <cstdint>

#include "framework/core/numbers/target.hpp"

#if !TOMLIN_TARGET_IS_BASELINE
#include <hwy/highway.h>
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace tomlin {
inline namespace TOMLIN_TARGET {

inline constexpr int kLanes = 8;

// ---------------------------------------------------------------------------------------------
// Scalars

TOMLIN_INLINE double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
TOMLIN_INLINE double fnma(double a, double b, double c) { return __builtin_fma(-a, b, c); }
TOMLIN_INLINE double sqrt(double x) { return __builtin_sqrt(x); }
TOMLIN_INLINE double abs(double x) { return __builtin_fabs(x); }
TOMLIN_INLINE double copysign(double magnitude, double sign) {
  return __builtin_copysign(magnitude, sign);
}
// The second argument wins when either is a NaN or both are zero, as the vector instruction has it.
TOMLIN_INLINE double min(double a, double b) { return a < b ? a : b; }
TOMLIN_INLINE double max(double a, double b) { return a > b ? a : b; }
TOMLIN_INLINE double select(bool mask, double a, double b) { return mask ? a : b; }
TOMLIN_INLINE double sum(double x) { return x; }

TOMLIN_INLINE bool any(bool mask) { return mask; }
TOMLIN_INLINE bool all(bool mask) { return mask; }
TOMLIN_INLINE bool select(bool mask, bool a, bool b) { return mask ? a : b; }

// Rounds to the nearest integer, halves to the even one.
#if TOMLIN_TARGET_IS_BASELINE
// There is no instruction for this before SSE4.1, and libm is not used in kernels: adding and
// subtracting 2^52 leaves no room for a fraction.
TOMLIN_INLINE double round(double x) {
  const double shift = copysign(0x1p52, x);
  return abs(x) < 0x1p52 ? copysign((x + shift) - shift, x) : x;
}
#else
TOMLIN_INLINE double round(double x) { return __builtin_rint(x); }
#endif

// Operations on the 64-bit pattern of a double, for the elementary functions.
#if defined(__SSE2__)
// Written for the vector registers: by way of the integer ones each would cost four cycles more.
TOMLIN_INLINE __m128d widen(double x) {
#if defined(__clang__)
  return _mm_set_sd(x);
#else
  // g++ clears the upper half with an instruction that is not free and not needed here.
  __m128d wide;
  asm("" : "=x"(wide) : "0"(x));
  return wide;
#endif
}
TOMLIN_INLINE __m128i to_bits(double x) { return _mm_castpd_si128(widen(x)); }
TOMLIN_INLINE double from_bits(__m128i x) { return _mm_cvtsd_f64(_mm_castsi128_pd(x)); }
TOMLIN_INLINE double bits_and(double a, double b) {
  return _mm_cvtsd_f64(_mm_and_pd(widen(a), widen(b)));
}
TOMLIN_INLINE double bits_or(double a, double b) {
  return _mm_cvtsd_f64(_mm_or_pd(widen(a), widen(b)));
}
TOMLIN_INLINE double bits_xor(double a, double b) {
  return _mm_cvtsd_f64(_mm_xor_pd(widen(a), widen(b)));
}
TOMLIN_INLINE double bits_add(double a, double b) {
  return from_bits(_mm_add_epi64(to_bits(a), to_bits(b)));
}
template <int count>
TOMLIN_INLINE double bits_shift_left(double a) {
  return from_bits(_mm_slli_epi64(to_bits(a), count));
}
template <int count>
TOMLIN_INLINE double bits_shift_right(double a) {
  return from_bits(_mm_srli_epi64(to_bits(a), count));
}
#else
TOMLIN_INLINE std::uint64_t to_bits(double x) { return __builtin_bit_cast(std::uint64_t, x); }
TOMLIN_INLINE double from_bits(std::uint64_t x) { return __builtin_bit_cast(double, x); }
TOMLIN_INLINE double bits_and(double a, double b) { return from_bits(to_bits(a) & to_bits(b)); }
TOMLIN_INLINE double bits_or(double a, double b) { return from_bits(to_bits(a) | to_bits(b)); }
TOMLIN_INLINE double bits_xor(double a, double b) { return from_bits(to_bits(a) ^ to_bits(b)); }
TOMLIN_INLINE double bits_add(double a, double b) { return from_bits(to_bits(a) + to_bits(b)); }
template <int count>
TOMLIN_INLINE double bits_shift_left(double a) {
  return from_bits(to_bits(a) << count);
}
template <int count>
TOMLIN_INLINE double bits_shift_right(double a) {
  return from_bits(to_bits(a) >> count);
}
#endif

// ---------------------------------------------------------------------------------------------
// Pack and PackMask

#if TOMLIN_TARGET_IS_BASELINE

// An array. Highway is not used here: its baseline has no fused multiply-add, and the results
// would differ from those of the other targets.
struct PackMask {
  bool v[kLanes];
};

struct Pack {
  double v[kLanes];

  Pack() = default;
  TOMLIN_INLINE Pack(double x) {  // NOLINT: a number is a Pack of equal lanes
    for (int i = 0; i < kLanes; ++i) v[i] = x;
  }
  TOMLIN_INLINE static Pack load(const double* from) { return load_unaligned(from); }
  TOMLIN_INLINE static Pack load_unaligned(const double* from) {
    Pack r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = from[i];
    return r;
  }
  TOMLIN_INLINE void store(double* to) const { store_unaligned(to); }
  TOMLIN_INLINE void store_unaligned(double* to) const {
    for (int i = 0; i < kLanes; ++i) to[i] = v[i];
  }
  TOMLIN_INLINE double lane(int i) const { return v[i]; }
};

namespace pack_detail {

// f in every lane, for any pack P whose lanes are an array v.
template <class P, class F, class... Rest>
TOMLIN_INLINE P map(F f, const P& a, const Rest&... rest) {
  P r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = f(a.v[i], rest.v[i]...);
  return r;
}
template <class M, class P, class F>
TOMLIN_INLINE M compare(F f, const P& a, const P& b) {
  M r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = f(a.v[i], b.v[i]);
  return r;
}

}  // namespace pack_detail

#define TOMLIN_PACK_MAP1(P, name, expression)                                           \
  TOMLIN_INLINE P name(const P& a) {                                                    \
    return pack_detail::map([](auto x) TOMLIN_INLINE_LAMBDA { return expression; }, a); \
  }
#define TOMLIN_PACK_MAP2(P, name, expression)                                                      \
  TOMLIN_INLINE P name(const P& a, const P& b) {                                                   \
    return pack_detail::map([](auto x, auto y) TOMLIN_INLINE_LAMBDA { return expression; }, a, b); \
  }
#define TOMLIN_PACK_MAP3(P, name, expression)                                             \
  TOMLIN_INLINE P name(const P& a, const P& b, const P& c) {                              \
    return pack_detail::map(                                                              \
        [](auto x, auto y, auto z) TOMLIN_INLINE_LAMBDA { return expression; }, a, b, c); \
  }
#define TOMLIN_PACK_COMPARE(M, P, name, expression)                                                \
  TOMLIN_INLINE M name(const P& a, const P& b) {                                                   \
    return pack_detail::compare<M>([](auto x, auto y) TOMLIN_INLINE_LAMBDA { return expression; }, \
                                   a, b);                                                          \
  }

TOMLIN_PACK_MAP2(Pack, operator+, x + y)
TOMLIN_PACK_MAP2(Pack, operator-, x - y)
TOMLIN_PACK_MAP2(Pack, operator*, x* y)
TOMLIN_PACK_MAP2(Pack, operator/, x / y)
TOMLIN_PACK_MAP1(Pack, operator-, -x)
TOMLIN_PACK_MAP3(Pack, fma, tomlin::fma(x, y, z))
TOMLIN_PACK_MAP3(Pack, fnma, tomlin::fnma(x, y, z))
TOMLIN_PACK_MAP1(Pack, sqrt, tomlin::sqrt(x))
TOMLIN_PACK_MAP1(Pack, abs, tomlin::abs(x))
TOMLIN_PACK_MAP1(Pack, round, tomlin::round(x))
TOMLIN_PACK_MAP2(Pack, min, tomlin::min(x, y))
TOMLIN_PACK_MAP2(Pack, max, tomlin::max(x, y))
TOMLIN_PACK_MAP2(Pack, copysign, tomlin::copysign(x, y))
TOMLIN_PACK_MAP2(Pack, bits_and, tomlin::bits_and(x, y))
TOMLIN_PACK_MAP2(Pack, bits_or, tomlin::bits_or(x, y))
TOMLIN_PACK_MAP2(Pack, bits_xor, tomlin::bits_xor(x, y))
TOMLIN_PACK_MAP2(Pack, bits_add, tomlin::bits_add(x, y))
template <int count>
TOMLIN_PACK_MAP1(Pack, bits_shift_left, tomlin::bits_shift_left<count>(x))
template <int count>
TOMLIN_PACK_MAP1(Pack, bits_shift_right, tomlin::bits_shift_right<count>(x))
TOMLIN_PACK_COMPARE(PackMask, Pack, operator<, x < y)
TOMLIN_PACK_COMPARE(PackMask, Pack, operator<=, x <= y)
TOMLIN_PACK_COMPARE(PackMask, Pack, operator>, x > y)
TOMLIN_PACK_COMPARE(PackMask, Pack, operator>=, x >= y)
TOMLIN_PACK_COMPARE(PackMask, Pack, operator==, x == y)
TOMLIN_PACK_COMPARE(PackMask, Pack, operator!=, x != y)

TOMLIN_INLINE PackMask operator&(const PackMask& a, const PackMask& b) {
  PackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[i] & b.v[i];
  return r;
}
TOMLIN_INLINE PackMask operator|(const PackMask& a, const PackMask& b) {
  PackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[i] | b.v[i];
  return r;
}
TOMLIN_INLINE PackMask operator!(const PackMask& a) {
  PackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = !a.v[i];
  return r;
}
TOMLIN_INLINE bool any(const PackMask& a) {
  bool r = false;
  for (int i = 0; i < kLanes; ++i) r |= a.v[i];
  return r;
}
TOMLIN_INLINE bool all(const PackMask& a) {
  bool r = true;
  for (int i = 0; i < kLanes; ++i) r &= a.v[i];
  return r;
}
TOMLIN_INLINE Pack select(const PackMask& mask, const Pack& a, const Pack& b) {
  Pack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = mask.v[i] ? a.v[i] : b.v[i];
  return r;
}
// True in lanes 0 to n-1.
TOMLIN_INLINE PackMask first_lanes(int n) {
  PackMask r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = i < n;
  return r;
}
// The one rule: lanes i and i+4, then i and i+2, then i and i+1.
TOMLIN_INLINE double sum(const Pack& a) {
  return ((a.v[0] + a.v[4]) + (a.v[2] + a.v[6])) + ((a.v[1] + a.v[5]) + (a.v[3] + a.v[7]));
}

// Lane i becomes lane order[i].
TOMLIN_INLINE Pack permute(const Pack& a, const std::int64_t* order) {
  Pack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[order[i]];
  return r;
}
// {a, b, c, 0, ...}
TOMLIN_INLINE Pack three_lanes(double a, double b, double c) {
  Pack r(0.0);
  r.v[0] = a;
  r.v[1] = b;
  r.v[2] = c;
  return r;
}

#else  // avx2, avx512

namespace hn = hwy::HWY_NAMESPACE;

namespace pack_detail {
// Part: one native vector; a Pack has kParts of them.
using PartTag = hn::ScalableTag<double>;
using PartBitsTag = hn::RebindToUnsigned<PartTag>;
inline constexpr PartTag part_tag{};
inline constexpr PartBitsTag part_bits_tag{};
using Part = hn::Vec<PartTag>;
using PartMask = hn::Mask<PartTag>;
inline constexpr int kPartLanes = static_cast<int>(hn::MaxLanes(PartTag()));
// Highway falls back to two lanes, silently, when a flag it wants is missing.
static_assert(kPartLanes == (TOMLIN_TARGET_IS_AVX512 ? 8 : 4), "add -maes -mpclmul");
}  // namespace pack_detail

#if TOMLIN_TARGET_IS_AVX512

struct PackMask {
  pack_detail::PartMask v;
};

struct Pack {
  pack_detail::Part v;

  Pack() = default;
  TOMLIN_INLINE explicit Pack(pack_detail::Part part) : v(part) {}
  TOMLIN_INLINE Pack(double x)  // NOLINT: a number is a Pack of equal lanes
      : v(hn::Set(pack_detail::part_tag, x)) {}
  TOMLIN_INLINE static Pack load(const double* from) {
    return Pack(hn::Load(pack_detail::part_tag, from));
  }
  TOMLIN_INLINE static Pack load_unaligned(const double* from) {
    return Pack(hn::LoadU(pack_detail::part_tag, from));
  }
  TOMLIN_INLINE void store(double* to) const { hn::Store(v, pack_detail::part_tag, to); }
  TOMLIN_INLINE void store_unaligned(double* to) const { hn::StoreU(v, pack_detail::part_tag, to); }
  TOMLIN_INLINE double lane(int i) const {
    double lanes[kLanes];
    store_unaligned(lanes);
    return lanes[i];
  }
};

#define TOMLIN_PACK_OP1(Result, name, Arg, call)                     \
  TOMLIN_INLINE Result name(Arg a) {                                 \
    const auto f = [](auto x) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v)};                                           \
  }
#define TOMLIN_PACK_OP2(Result, name, Arg, call)                             \
  TOMLIN_INLINE Result name(Arg a, Arg b) {                                  \
    const auto f = [](auto x, auto y) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v, b.v)};                                              \
  }
#define TOMLIN_PACK_OP3(Result, name, First, Arg, call)                              \
  TOMLIN_INLINE Result name(First a, Arg b, Arg c) {                                 \
    const auto f = [](auto x, auto y, auto z) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v, b.v, c.v)};                                                 \
  }

TOMLIN_INLINE bool all(PackMask a) { return hn::AllTrue(pack_detail::part_tag, a.v); }
TOMLIN_INLINE bool any(PackMask a) { return !hn::AllFalse(pack_detail::part_tag, a.v); }
// True in lanes 0 to n-1.
TOMLIN_INLINE PackMask first_lanes(int n) {
  return {hn::FirstN(pack_detail::part_tag, static_cast<std::size_t>(n < 0 ? 0 : n))};
}

#else  // avx2

struct PackMask {
  pack_detail::PartMask lo, hi;
};

struct Pack {
  pack_detail::Part lo, hi;

  Pack() = default;
  TOMLIN_INLINE Pack(pack_detail::Part low, pack_detail::Part high) : lo(low), hi(high) {}
  TOMLIN_INLINE Pack(double x)  // NOLINT: a number is a Pack of equal lanes
      : lo(hn::Set(pack_detail::part_tag, x)), hi(lo) {}
  TOMLIN_INLINE static Pack load(const double* from) {
    return Pack(hn::Load(pack_detail::part_tag, from),
                hn::Load(pack_detail::part_tag, from + kLanes / 2));
  }
  TOMLIN_INLINE static Pack load_unaligned(const double* from) {
    return Pack(hn::LoadU(pack_detail::part_tag, from),
                hn::LoadU(pack_detail::part_tag, from + kLanes / 2));
  }
  TOMLIN_INLINE void store(double* to) const {
    hn::Store(lo, pack_detail::part_tag, to);
    hn::Store(hi, pack_detail::part_tag, to + kLanes / 2);
  }
  TOMLIN_INLINE void store_unaligned(double* to) const {
    hn::StoreU(lo, pack_detail::part_tag, to);
    hn::StoreU(hi, pack_detail::part_tag, to + kLanes / 2);
  }
  TOMLIN_INLINE double lane(int i) const {
    double lanes[kLanes];
    store_unaligned(lanes);
    return lanes[i];
  }
};

#define TOMLIN_PACK_OP1(Result, name, Arg, call)                     \
  TOMLIN_INLINE Result name(Arg a) {                                 \
    const auto f = [](auto x) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.lo), f(a.hi)};                                 \
  }
#define TOMLIN_PACK_OP2(Result, name, Arg, call)                             \
  TOMLIN_INLINE Result name(Arg a, Arg b) {                                  \
    const auto f = [](auto x, auto y) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.lo, b.lo), f(a.hi, b.hi)};                             \
  }
#define TOMLIN_PACK_OP3(Result, name, First, Arg, call)                              \
  TOMLIN_INLINE Result name(First a, Arg b, Arg c) {                                 \
    const auto f = [](auto x, auto y, auto z) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.lo, b.lo, c.lo), f(a.hi, b.hi, c.hi)};                         \
  }

TOMLIN_INLINE bool all(PackMask a) {
  return hn::AllTrue(pack_detail::part_tag, hn::And(a.lo, a.hi));
}
TOMLIN_INLINE bool any(PackMask a) {
  return !hn::AllFalse(pack_detail::part_tag, hn::Or(a.lo, a.hi));
}
// True in lanes 0 to n-1.
TOMLIN_INLINE PackMask first_lanes(int n) {
  const int low = n < 0 ? 0 : n > kLanes / 2 ? kLanes / 2 : n;
  const int high = n < kLanes / 2 ? 0 : n > kLanes ? kLanes / 2 : n - kLanes / 2;
  return {hn::FirstN(pack_detail::part_tag, static_cast<std::size_t>(low)),
          hn::FirstN(pack_detail::part_tag, static_cast<std::size_t>(high))};
}

#endif  // avx512 or avx2

TOMLIN_PACK_OP2(Pack, operator+, Pack, hn::Add(x, y))
TOMLIN_PACK_OP2(Pack, operator-, Pack, hn::Sub(x, y))
TOMLIN_PACK_OP2(Pack, operator*, Pack, hn::Mul(x, y))
TOMLIN_PACK_OP2(Pack, operator/, Pack, hn::Div(x, y))
TOMLIN_PACK_OP1(Pack, operator-, Pack, hn::Neg(x))
TOMLIN_PACK_OP3(Pack, fma, Pack, Pack, hn::MulAdd(x, y, z))
TOMLIN_PACK_OP3(Pack, fnma, Pack, Pack, hn::NegMulAdd(x, y, z))
TOMLIN_PACK_OP1(Pack, sqrt, Pack, hn::Sqrt(x))
TOMLIN_PACK_OP1(Pack, abs, Pack, hn::Abs(x))
TOMLIN_PACK_OP1(Pack, round, Pack, hn::Round(x))
TOMLIN_PACK_OP2(Pack, min, Pack, hn::Min(x, y))
TOMLIN_PACK_OP2(Pack, max, Pack, hn::Max(x, y))
TOMLIN_PACK_OP2(Pack, copysign, Pack, hn::CopySign(x, y))
TOMLIN_PACK_OP2(Pack, bits_and, Pack, hn::And(x, y))
TOMLIN_PACK_OP2(Pack, bits_or, Pack, hn::Or(x, y))
TOMLIN_PACK_OP2(Pack, bits_xor, Pack, hn::Xor(x, y))
TOMLIN_PACK_OP2(Pack, bits_add, Pack,
                hn::BitCast(pack_detail::part_tag,
                            hn::Add(hn::BitCast(pack_detail::part_bits_tag, x),
                                    hn::BitCast(pack_detail::part_bits_tag, y))))
template <int count>
TOMLIN_PACK_OP1(Pack, bits_shift_left, Pack,
                hn::BitCast(pack_detail::part_tag,
                            hn::ShiftLeft<count>(hn::BitCast(pack_detail::part_bits_tag, x))))
template <int count>
TOMLIN_PACK_OP1(Pack, bits_shift_right, Pack,
                hn::BitCast(pack_detail::part_tag,
                            hn::ShiftRight<count>(hn::BitCast(pack_detail::part_bits_tag, x))))
TOMLIN_PACK_OP2(PackMask, operator<, Pack, hn::Lt(x, y))
TOMLIN_PACK_OP2(PackMask, operator<=, Pack, hn::Le(x, y))
TOMLIN_PACK_OP2(PackMask, operator>, Pack, hn::Gt(x, y))
TOMLIN_PACK_OP2(PackMask, operator>=, Pack, hn::Ge(x, y))
TOMLIN_PACK_OP2(PackMask, operator==, Pack, hn::Eq(x, y))
// Not hn::Ne, which says false for a NaN.
TOMLIN_PACK_OP2(PackMask, operator!=, Pack, hn::Not(hn::Eq(x, y)))
TOMLIN_PACK_OP2(PackMask, operator&, PackMask, hn::And(x, y))
TOMLIN_PACK_OP2(PackMask, operator|, PackMask, hn::Or(x, y))
TOMLIN_PACK_OP1(PackMask, operator!, PackMask, hn::Not(x))
TOMLIN_PACK_OP3(Pack, select, PackMask, Pack, hn::IfThenElse(x, y, z))

// The one rule: lanes i and i+4, then i and i+2, then i and i+1.
TOMLIN_INLINE double sum(Pack a) {
#if TOMLIN_TARGET_IS_AVX512
  const __m256d fours =
      _mm256_add_pd(_mm512_castpd512_pd256(a.v.raw), _mm512_extractf64x4_pd(a.v.raw, 1));
#else
  const __m256d fours = _mm256_add_pd(a.lo.raw, a.hi.raw);
#endif
  const __m128d twos = _mm_add_pd(_mm256_castpd256_pd128(fours), _mm256_extractf128_pd(fours, 1));
  return _mm_cvtsd_f64(_mm_add_sd(twos, _mm_unpackhi_pd(twos, twos)));
}

#endif  // baseline or not

TOMLIN_INLINE Pack& operator+=(Pack& a, const Pack& b) { return a = a + b; }
TOMLIN_INLINE Pack& operator-=(Pack& a, const Pack& b) { return a = a - b; }
TOMLIN_INLINE Pack& operator*=(Pack& a, const Pack& b) { return a = a * b; }
TOMLIN_INLINE Pack& operator/=(Pack& a, const Pack& b) { return a = a / b; }

// The type of a comparison: bool for scalars, PackMask for Pack; dual numbers add theirs.
template <class T>
struct MaskOf {
  using Type = bool;
};
template <>
struct MaskOf<Pack> {
  using Type = PackMask;
};
template <class T>
using Mask = typename MaskOf<T>::Type;

#if TOMLIN_TARGET_IS_AVX512
// Lane i becomes lane order[i].
TOMLIN_INLINE Pack permute(Pack a, const std::int64_t* order) {
  const auto indices = hn::SetTableIndices(pack_detail::part_tag, order);
  return Pack(hn::TableLookupLanes(a.v, indices));
}
// {a, b, c, 0, ...}
TOMLIN_INLINE Pack three_lanes(double a, double b, double c) {
  return Pack(pack_detail::Part{_mm512_zextpd256_pd512(_mm256_set_pd(0.0, c, b, a))});
}
#elif TOMLIN_TARGET_IS_AVX2
// No instruction permutes across two registers: each half of the result is picked from both halves.
// Doubles move as pairs of 32-bit words, of whose index only the lowest three bits count.
TOMLIN_INLINE Pack permute(const Pack& a, const std::int64_t* order) {
  double halves[kLanes];
  a.store_unaligned(halves);
  const __m256i low = _mm256_castpd_si256(_mm256_loadu_pd(halves));
  const __m256i high = _mm256_castpd_si256(_mm256_loadu_pd(halves + 4));
  alignas(32) double moved[kLanes];
  for (int half = 0; half < 2; ++half) {
    const __m256i from = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(order + 4 * half));
    const __m256i word = _mm256_add_epi64(from, from);
    const __m256i next = _mm256_slli_epi64(_mm256_add_epi64(word, _mm256_set1_epi64x(1)), 32);
    const __m256i words = _mm256_or_si256(word, next);
    const __m256i in_high = _mm256_cmpgt_epi64(from, _mm256_set1_epi64x(3));
    const __m256i picked = _mm256_blendv_epi8(_mm256_permutevar8x32_epi32(low, words),
                                              _mm256_permutevar8x32_epi32(high, words), in_high);
    _mm256_store_pd(moved + 4 * half, _mm256_castsi256_pd(picked));
  }
  return Pack::load(moved);
}
TOMLIN_INLINE Pack three_lanes(double a, double b, double c) {
  alignas(32) const double lanes[kLanes] = {a, b, c};
  return Pack::load(lanes);
}
#endif

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
