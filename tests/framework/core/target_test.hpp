// For tests that are compiled once per instruction set and linked into one program.
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "framework/core/numbers/target.hpp"

// TARGET_TEST(Suite, Name) is TEST(Suite_avx2, Name) in the avx2 copy, and so on. It skips itself
// on a processor that cannot run the copy.
#define TARGET_TEST(suite, name) TARGET_TEST_EXPAND(suite, TOMLIN_TARGET, name)
#define TARGET_TEST_EXPAND(suite, target, name) TARGET_TEST_PASTE(suite, target, name)
#define TARGET_TEST_PASTE(suite, target, name)                                                   \
  static void suite##_##target##_##name##_body();                                                \
  TEST(suite##_##target, name) {                                                                 \
    if (!cpu_runs_target()) GTEST_SKIP() << "this processor lacks the instructions of " #target; \
    suite##_##target##_##name##_body();                                                          \
  }                                                                                              \
  static void suite##_##target##_##name##_body()

namespace tomlin {
inline namespace TOMLIN_TARGET {

inline bool cpu_runs_target() {
#if TOMLIN_TARGET_IS_AVX512
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd");
#elif TOMLIN_TARGET_IS_AVX2
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

// The splitmix64 sequence: the same numbers with every compiler and library.
class TestNumbers {
 public:
  explicit TestNumbers(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }
  // Any finite double, all exponents equally likely, subnormals among them.
  double any_finite() {
    for (;;) {
      const double x = __builtin_bit_cast(double, bits());
      if (x - x == 0.0) return x;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
