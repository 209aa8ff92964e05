#pragma once

#include <array>

#include "framework/core/text/words.hpp"

namespace tomlin {

/// The sets that kernels are compiled for. Results have the same bits on each of them.
enum class InstructionSet { baseline, avx2, avx512 };

constexpr auto word_table(InstructionSet) {
  using enum InstructionSet;
  return std::to_array<Word<InstructionSet>>(
      {{baseline, "baseline"}, {avx2, "avx2"}, {avx512, "avx512"}});
}

// A build may leave these out: TOMLIN_INSTRUCTION_SETS in cmake/TomlinKernels.cmake.
#if defined(TOMLIN_KERNELS_AVX2)
inline constexpr bool kCompiledForAvx2 = true;
#else
inline constexpr bool kCompiledForAvx2 = false;
#endif
#if defined(TOMLIN_KERNELS_AVX512)
inline constexpr bool kCompiledForAvx512 = true;
#else
inline constexpr bool kCompiledForAvx512 = false;
#endif

/// The widest supported set, or the one that the variable TOMLIN_INSTRUCTION_SET ("baseline",
/// "avx2", "avx512") names, where it is supported. Throws InputError when it names none of them.
InstructionSet chosen_instruction_set();

/// True when the build has kernels of this set and this machine can run them.
bool is_supported(InstructionSet set);

}  // namespace tomlin
