// Instruction set for which this translation unit is compiled.
//
// Numeric code is compiled once per instruction set and chosen when the program starts. Each copy
// lives in its own inline namespace, so that the linker can never mix differently compiled copies:
//
//   namespace tomlin { inline namespace TOMLIN_TARGET { ... } }
//
// The compile line says which: -DTOMLIN_TARGET=avx2 -DTOMLIN_TARGET_AVX2=1, or
// -DTOMLIN_TARGET=avx512 -DTOMLIN_TARGET_AVX512=1, or nothing (baseline).
#pragma once

#ifndef TOMLIN_TARGET
#define TOMLIN_TARGET baseline
#endif

#if defined(TOMLIN_TARGET_AVX2) && TOMLIN_TARGET_AVX2
#define TOMLIN_TARGET_IS_AVX2 1
#else
#define TOMLIN_TARGET_IS_AVX2 0
#endif

#if defined(TOMLIN_TARGET_AVX512) && TOMLIN_TARGET_AVX512
#define TOMLIN_TARGET_IS_AVX512 1
#else
#define TOMLIN_TARGET_IS_AVX512 0
#endif

#define TOMLIN_TARGET_IS_BASELINE (!TOMLIN_TARGET_IS_AVX2 && !TOMLIN_TARGET_IS_AVX512)

// Inlining is forced, not hoped for: a Pack passed through memory costs more than the arithmetic.
#define TOMLIN_INLINE __attribute__((always_inline)) inline
// A kernel takes everything that it calls into itself, evaluators of users included. Not where only
// old machines run it: it makes compilation five times as long.
#if TOMLIN_TARGET_IS_BASELINE
#define TOMLIN_FLATTEN
#else
#define TOMLIN_FLATTEN __attribute__((flatten))
#endif
#define TOMLIN_INLINE_LAMBDA __attribute__((always_inline))

#if TOMLIN_TARGET_IS_AVX2 && TOMLIN_TARGET_IS_AVX512
#error "choose one of TOMLIN_TARGET_AVX2 and TOMLIN_TARGET_AVX512"
#endif

namespace tomlin {

// The name of the namespace and the derived macros must tell the same story.
namespace target_check {
inline constexpr int baseline = 0, avx2 = 1, avx512 = 2;
static_assert(TOMLIN_TARGET == (TOMLIN_TARGET_IS_AVX512 ? 2
                                : TOMLIN_TARGET_IS_AVX2 ? 1
                                                        : 0),
              "TOMLIN_TARGET contradicts TOMLIN_TARGET_AVX2 / TOMLIN_TARGET_AVX512");
}  // namespace target_check

#if TOMLIN_TARGET_IS_AVX2 || TOMLIN_TARGET_IS_AVX512
#if defined(__AVX2__) && defined(__FMA__) && defined(__AES__) && defined(__PCLMUL__)
inline constexpr bool target_has_avx2_flags = true;
#else
inline constexpr bool target_has_avx2_flags = false;
#endif
static_assert(target_has_avx2_flags, "compile with -march=x86-64-v3 (or -v4) -maes -mpclmul");
#endif

#if TOMLIN_TARGET_IS_AVX512
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && \
    defined(__AVX512BW__) && defined(__AVX512CD__)
inline constexpr bool target_has_avx512_flags = true;
#else
inline constexpr bool target_has_avx512_flags = false;
#endif
static_assert(target_has_avx512_flags, "compile with -march=x86-64-v4 -maes -mpclmul");
#endif

#ifdef __FAST_MATH__
#error "-ffast-math breaks the promise of the same bits on every target"
#endif

}  // namespace tomlin
