#pragma once

#include <string_view>

namespace tomlin {

/// The sets that kernels are compiled for. Results have the same bits on each of them.
enum class InstructionSet { baseline, avx2, avx512 };

/// The widest set of this machine, or the one named by the environment variable
/// TOMLIN_INSTRUCTION_SET ("baseline", "avx2", "avx512") when the machine has it.
InstructionSet chosen_instruction_set();

/// True when this machine can run kernels of this set.
bool is_supported(InstructionSet set);

std::string_view to_string(InstructionSet set);

}  // namespace tomlin
