#include "framework/core/system/instruction_set.hpp"

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace {

bool machine_has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi2");
#else
  return false;
#endif
}

bool machine_has_avx512() {
#if defined(__x86_64__)
  return machine_has_avx2() && __builtin_cpu_supports("avx512f") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd");
#else
  return false;
#endif
}

constexpr const char* kVariable = "TOMLIN_INSTRUCTION_SET";

InstructionSet named(const std::string& wish) {
  if (const auto set = value_named<InstructionSet>(wish)) return *set;
  const std::vector<std::string> names = words_of<InstructionSet>();
  Fault fault(FaultCode::machine_instruction_set);
  fault.location.file = "tomlin";
  fault.key = kVariable;
  fault.value = wish;
  fault.why = "not an instruction set with kernels";
  fault.admissible = names[0] + ", " + names[1] + ", " + names[2];
  fault.nearest = nearest_name(wish, names).value_or("");
  throw InputError({std::move(fault)});
}

}  // namespace

bool is_supported(InstructionSet set) {
  switch (set) {
    case InstructionSet::baseline:
      return true;
    case InstructionSet::avx2:
      return kCompiledForAvx2 && machine_has_avx2();
    case InstructionSet::avx512:
      return kCompiledForAvx512 && machine_has_avx512();
  }
  return false;
}

InstructionSet chosen_instruction_set() {
  const char* wish = std::getenv(kVariable);
  if (wish != nullptr && *wish != '\0') {
    const InstructionSet set = named(wish);
    if (is_supported(set)) return set;
  }
  if (is_supported(InstructionSet::avx512)) return InstructionSet::avx512;
  if (is_supported(InstructionSet::avx2)) return InstructionSet::avx2;
  return InstructionSet::baseline;
}

}  // namespace tomlin
