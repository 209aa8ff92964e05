// FloatPack: eight floats, with the operations of Pack.
//
// It has eight lanes as Pack has, and follows the same summation rule, although a 512-bit vector
// would hold sixteen: one kernel serves both types. A lane has the bits of the scalar float
// operation on every target, the payload and sign of a NaN excepted.
#pragma once

#include <cstdint>

#include "framework/core/numbers/pack.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

// Operations on the 32-bit pattern of a float, for the elementary functions.
TOMLIN_INLINE std::uint32_t to_bits(float x) { return __builtin_bit_cast(std::uint32_t, x); }
TOMLIN_INLINE float from_bits(std::uint32_t x) { return __builtin_bit_cast(float, x); }
TOMLIN_INLINE float bits_and(float a, float b) { return from_bits(to_bits(a) & to_bits(b)); }
TOMLIN_INLINE float bits_or(float a, float b) { return from_bits(to_bits(a) | to_bits(b)); }
TOMLIN_INLINE float bits_xor(float a, float b) { return from_bits(to_bits(a) ^ to_bits(b)); }
TOMLIN_INLINE float bits_add(float a, float b) { return from_bits(to_bits(a) + to_bits(b)); }
template <int count>
TOMLIN_INLINE float bits_shift_left(float a) {
  return from_bits(to_bits(a) << count);
}
template <int count>
TOMLIN_INLINE float bits_shift_right(float a) {
  return from_bits(to_bits(a) >> count);
}

#if TOMLIN_TARGET_IS_BASELINE

struct FloatPackMask {
  bool v[kLanes];

  // True in lanes 0 to n-1.
  TOMLIN_INLINE static FloatPackMask first(int n) {
    FloatPackMask r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = i < n;
    return r;
  }
};

struct FloatPack {
  float v[kLanes];

  FloatPack() = default;
  TOMLIN_INLINE FloatPack(float x) {  // NOLINT: a number is a FloatPack of equal lanes
    for (int i = 0; i < kLanes; ++i) v[i] = x;
  }
  TOMLIN_INLINE static FloatPack load(const float* from) { return load_unaligned(from); }
  TOMLIN_INLINE static FloatPack load_unaligned(const float* from) {
    FloatPack r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = from[i];
    return r;
  }
  TOMLIN_INLINE void store(float* to) const { store_unaligned(to); }
  TOMLIN_INLINE void store_unaligned(float* to) const {
    for (int i = 0; i < kLanes; ++i) to[i] = v[i];
  }
  TOMLIN_INLINE float lane(int i) const { return v[i]; }
};

TOMLIN_PACK_MAP2(FloatPack, operator+, x + y)
TOMLIN_PACK_MAP2(FloatPack, operator-, x - y)
TOMLIN_PACK_MAP2(FloatPack, operator*, x* y)
TOMLIN_PACK_MAP2(FloatPack, operator/, x / y)
TOMLIN_PACK_MAP1(FloatPack, operator-, -x)
TOMLIN_PACK_MAP3(FloatPack, fma, tomlin::fma(x, y, z))
TOMLIN_PACK_MAP3(FloatPack, fnma, tomlin::fnma(x, y, z))
TOMLIN_PACK_MAP1(FloatPack, sqrt, tomlin::sqrt(x))
TOMLIN_PACK_MAP1(FloatPack, abs, tomlin::abs(x))
TOMLIN_PACK_MAP1(FloatPack, round, tomlin::round(x))
TOMLIN_PACK_MAP2(FloatPack, min, tomlin::min(x, y))
TOMLIN_PACK_MAP2(FloatPack, max, tomlin::max(x, y))
TOMLIN_PACK_MAP2(FloatPack, copysign, tomlin::copysign(x, y))
TOMLIN_PACK_MAP2(FloatPack, bits_and, tomlin::bits_and(x, y))
TOMLIN_PACK_MAP2(FloatPack, bits_or, tomlin::bits_or(x, y))
TOMLIN_PACK_MAP2(FloatPack, bits_xor, tomlin::bits_xor(x, y))
TOMLIN_PACK_MAP2(FloatPack, bits_add, tomlin::bits_add(x, y))
template <int count>
TOMLIN_PACK_MAP1(FloatPack, bits_shift_left, tomlin::bits_shift_left<count>(x))
template <int count>
TOMLIN_PACK_MAP1(FloatPack, bits_shift_right, tomlin::bits_shift_right<count>(x))
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator<, x < y)
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator<=, x <= y)
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator>, x > y)
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator>=, x >= y)
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator==, x == y)
TOMLIN_PACK_COMPARE(FloatPackMask, FloatPack, operator!=, x != y)
TOMLIN_PACK_MAP2(FloatPackMask, operator&, x&& y)
TOMLIN_PACK_MAP2(FloatPackMask, operator|, x || y)
TOMLIN_PACK_MAP1(FloatPackMask, operator!, !x)

TOMLIN_INLINE bool any(const FloatPackMask& a) {
  bool r = false;
  for (int i = 0; i < kLanes; ++i) r |= a.v[i];
  return r;
}
TOMLIN_INLINE bool all(const FloatPackMask& a) { return !any(!a); }
TOMLIN_INLINE FloatPack select(const FloatPackMask& mask, const FloatPack& a, const FloatPack& b) {
  FloatPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = mask.v[i] ? a.v[i] : b.v[i];
  return r;
}
// The one rule: lanes i and i+4, then i and i+2, then i and i+1.
TOMLIN_INLINE float sum(const FloatPack& a) {
  return ((a.v[0] + a.v[4]) + (a.v[2] + a.v[6])) + ((a.v[1] + a.v[5]) + (a.v[3] + a.v[7]));
}
// Lane i becomes lane order[i].
TOMLIN_INLINE FloatPack permute(const FloatPack& a, const std::int64_t* order) {
  FloatPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[order[i]];
  return r;
}
// {a, b, c, 0, ...}
TOMLIN_INLINE FloatPack three_lanes(float a, float b, float c) {
  FloatPack r(0.0f);
  r.v[0] = a;
  r.v[1] = b;
  r.v[2] = c;
  return r;
}
TOMLIN_INLINE Pack to_double(const FloatPack& a) {
  Pack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = a.v[i];
  return r;
}
// Rounds every lane.
TOMLIN_INLINE FloatPack to_float(const Pack& a) {
  FloatPack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = static_cast<float>(a.v[i]);
  return r;
}

#else  // avx2, avx512: one 256-bit vector

namespace pack_detail {
using FloatTag = hn::FixedTag<float, kLanes>;
inline constexpr FloatTag float_tag{};
inline constexpr hn::RebindToUnsigned<FloatTag> float_bits_tag{};
}  // namespace pack_detail

struct FloatPackMask {
  hn::Mask<pack_detail::FloatTag> v;

  // True in lanes 0 to n-1.
  TOMLIN_INLINE static FloatPackMask first(int n) {
    const int count = n < 0 ? 0 : n > kLanes ? kLanes : n;
    return {hn::FirstN(pack_detail::float_tag, static_cast<std::size_t>(count))};
  }
};

struct FloatPack {
  hn::Vec<pack_detail::FloatTag> v;

  FloatPack() = default;
  TOMLIN_INLINE explicit FloatPack(hn::Vec<pack_detail::FloatTag> lanes) : v(lanes) {}
  TOMLIN_INLINE FloatPack(float x)  // NOLINT: a number is a FloatPack of equal lanes
      : v(hn::Set(pack_detail::float_tag, x)) {}
  TOMLIN_INLINE static FloatPack load(const float* from) {
    return FloatPack(hn::Load(pack_detail::float_tag, from));
  }
  TOMLIN_INLINE static FloatPack load_unaligned(const float* from) {
    return FloatPack(hn::LoadU(pack_detail::float_tag, from));
  }
  TOMLIN_INLINE void store(float* to) const { hn::Store(v, pack_detail::float_tag, to); }
  TOMLIN_INLINE void store_unaligned(float* to) const { hn::StoreU(v, pack_detail::float_tag, to); }
  TOMLIN_INLINE float lane(int i) const {
    float lanes[kLanes];
    store_unaligned(lanes);
    return lanes[i];
  }
};

#define TOMLIN_FLOAT_OP1(Result, name, Arg, call)                    \
  TOMLIN_INLINE Result name(Arg a) {                                 \
    const auto f = [](auto x) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v)};                                           \
  }
#define TOMLIN_FLOAT_OP2(Result, name, Arg, call)                            \
  TOMLIN_INLINE Result name(Arg a, Arg b) {                                  \
    const auto f = [](auto x, auto y) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v, b.v)};                                              \
  }
#define TOMLIN_FLOAT_OP3(Result, name, First, Arg, call)                             \
  TOMLIN_INLINE Result name(First a, Arg b, Arg c) {                                 \
    const auto f = [](auto x, auto y, auto z) TOMLIN_INLINE_LAMBDA { return call; }; \
    return Result{f(a.v, b.v, c.v)};                                                 \
  }

TOMLIN_FLOAT_OP2(FloatPack, operator+, FloatPack, hn::Add(x, y))
TOMLIN_FLOAT_OP2(FloatPack, operator-, FloatPack, hn::Sub(x, y))
TOMLIN_FLOAT_OP2(FloatPack, operator*, FloatPack, hn::Mul(x, y))
TOMLIN_FLOAT_OP2(FloatPack, operator/, FloatPack, hn::Div(x, y))
TOMLIN_FLOAT_OP1(FloatPack, operator-, FloatPack, hn::Neg(x))
TOMLIN_FLOAT_OP3(FloatPack, fma, FloatPack, FloatPack, hn::MulAdd(x, y, z))
TOMLIN_FLOAT_OP3(FloatPack, fnma, FloatPack, FloatPack, hn::NegMulAdd(x, y, z))
TOMLIN_FLOAT_OP1(FloatPack, sqrt, FloatPack, hn::Sqrt(x))
TOMLIN_FLOAT_OP1(FloatPack, abs, FloatPack, hn::Abs(x))
TOMLIN_FLOAT_OP1(FloatPack, round, FloatPack, hn::Round(x))
TOMLIN_FLOAT_OP2(FloatPack, min, FloatPack, hn::Min(x, y))
TOMLIN_FLOAT_OP2(FloatPack, max, FloatPack, hn::Max(x, y))
TOMLIN_FLOAT_OP2(FloatPack, copysign, FloatPack, hn::CopySign(x, y))
TOMLIN_FLOAT_OP2(FloatPack, bits_and, FloatPack, hn::And(x, y))
TOMLIN_FLOAT_OP2(FloatPack, bits_or, FloatPack, hn::Or(x, y))
TOMLIN_FLOAT_OP2(FloatPack, bits_xor, FloatPack, hn::Xor(x, y))
TOMLIN_FLOAT_OP2(FloatPack, bits_add, FloatPack,
                 hn::BitCast(pack_detail::float_tag,
                             hn::Add(hn::BitCast(pack_detail::float_bits_tag, x),
                                     hn::BitCast(pack_detail::float_bits_tag, y))))
template <int count>
TOMLIN_FLOAT_OP1(FloatPack, bits_shift_left, FloatPack,
                 hn::BitCast(pack_detail::float_tag,
                             hn::ShiftLeft<count>(hn::BitCast(pack_detail::float_bits_tag, x))))
template <int count>
TOMLIN_FLOAT_OP1(FloatPack, bits_shift_right, FloatPack,
                 hn::BitCast(pack_detail::float_tag,
                             hn::ShiftRight<count>(hn::BitCast(pack_detail::float_bits_tag, x))))
TOMLIN_FLOAT_OP2(FloatPackMask, operator<, FloatPack, hn::Lt(x, y))
TOMLIN_FLOAT_OP2(FloatPackMask, operator<=, FloatPack, hn::Le(x, y))
TOMLIN_FLOAT_OP2(FloatPackMask, operator>, FloatPack, hn::Gt(x, y))
TOMLIN_FLOAT_OP2(FloatPackMask, operator>=, FloatPack, hn::Ge(x, y))
TOMLIN_FLOAT_OP2(FloatPackMask, operator==, FloatPack, hn::Eq(x, y))
// Not hn::Ne, which says false for a NaN.
TOMLIN_FLOAT_OP2(FloatPackMask, operator!=, FloatPack, hn::Not(hn::Eq(x, y)))
TOMLIN_FLOAT_OP2(FloatPackMask, operator&, FloatPackMask, hn::And(x, y))
TOMLIN_FLOAT_OP2(FloatPackMask, operator|, FloatPackMask, hn::Or(x, y))
TOMLIN_FLOAT_OP1(FloatPackMask, operator!, FloatPackMask, hn::Not(x))
TOMLIN_FLOAT_OP3(FloatPack, select, FloatPackMask, FloatPack, hn::IfThenElse(x, y, z))

TOMLIN_INLINE bool any(FloatPackMask a) { return !hn::AllFalse(pack_detail::float_tag, a.v); }
TOMLIN_INLINE bool all(FloatPackMask a) { return hn::AllTrue(pack_detail::float_tag, a.v); }

// The one rule: lanes i and i+4, then i and i+2, then i and i+1.
TOMLIN_INLINE float sum(FloatPack a) {
  const __m128 fours =
      _mm_add_ps(_mm256_castps256_ps128(a.v.raw), _mm256_extractf128_ps(a.v.raw, 1));
  const __m128 twos = _mm_add_ps(fours, _mm_movehl_ps(fours, fours));
  return _mm_cvtss_f32(_mm_add_ss(twos, _mm_shuffle_ps(twos, twos, 1)));
}
// Lane i becomes lane order[i].
TOMLIN_INLINE FloatPack permute(FloatPack a, const std::int64_t* order) {
  const __m256 low = _mm256_loadu_ps(reinterpret_cast<const float*>(order));
  const __m256 high = _mm256_loadu_ps(reinterpret_cast<const float*>(order + kLanes / 2));
  // The lower words of the eight numbers, first in the order 0 1 4 5 2 3 6 7.
  const __m256i words = _mm256_castps_si256(_mm256_shuffle_ps(low, high, 0x88));
  const __m256i indices = _mm256_permute4x64_epi64(words, 0xd8);
  return FloatPack(hn::Vec<pack_detail::FloatTag>{_mm256_permutevar8x32_ps(a.v.raw, indices)});
}
// {a, b, c, 0, ...}
TOMLIN_INLINE FloatPack three_lanes(float a, float b, float c) {
  return FloatPack(
      hn::Vec<pack_detail::FloatTag>{_mm256_zextps128_ps256(_mm_set_ps(0.0f, c, b, a))});
}

TOMLIN_INLINE Pack to_double(FloatPack a) {
#if TOMLIN_TARGET_IS_AVX512
  return Pack(pack_detail::Part{_mm512_cvtps_pd(a.v.raw)});
#else
  return Pack(pack_detail::Part{_mm256_cvtps_pd(_mm256_castps256_ps128(a.v.raw))},
              pack_detail::Part{_mm256_cvtps_pd(_mm256_extractf128_ps(a.v.raw, 1))});
#endif
}
// Rounds every lane.
TOMLIN_INLINE FloatPack to_float(const Pack& a) {
#if TOMLIN_TARGET_IS_AVX512
  return FloatPack(hn::Vec<pack_detail::FloatTag>{_mm512_cvtpd_ps(a.v.raw)});
#else
  return FloatPack(hn::Vec<pack_detail::FloatTag>{
      _mm256_set_m128(_mm256_cvtpd_ps(a.hi.raw), _mm256_cvtpd_ps(a.lo.raw))});
#endif
}

#endif  // baseline or not

TOMLIN_INLINE FloatPack& operator+=(FloatPack& a, const FloatPack& b) { return a = a + b; }
TOMLIN_INLINE FloatPack& operator-=(FloatPack& a, const FloatPack& b) { return a = a - b; }
TOMLIN_INLINE FloatPack& operator*=(FloatPack& a, const FloatPack& b) { return a = a * b; }
TOMLIN_INLINE FloatPack& operator/=(FloatPack& a, const FloatPack& b) { return a = a / b; }

template <>
struct MaskOf<FloatPack> {
  using Type = FloatPackMask;
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
