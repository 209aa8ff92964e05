#pragma once

#include "framework/core/instruction_set.hpp"
#include "framework/core/kernel_arguments.hpp"

namespace tomlin {

/// The same kernels on each instruction set. Null: not compiled for this architecture.
template <class Table>
struct TablesBySet {
  const Table* baseline = nullptr;
  const Table* avx2 = nullptr;
  const Table* avx512 = nullptr;

  const Table& on(InstructionSet set) const {
    if (set == InstructionSet::avx512 && avx512) return *avx512;
    if (set == InstructionSet::avx2 && avx2) return *avx2;
    return *baseline;
  }
};

using KernelTables = TablesBySet<KernelTable<double>>;

}  // namespace tomlin

/// In a component's .cpp: the tables that its kernel files define (framework/core/kernels.hpp),
/// as tomlin::kernels::NAME. A macro, because names are pasted.
#if defined(__x86_64__)
#define TOMLIN_DECLARE_TABLES(Name, Table)                                                     \
  namespace tomlin::kernels {                                                                  \
  extern const Table Name##_baseline;                                                          \
  extern const Table Name##_avx2;                                                              \
  extern const Table Name##_avx512;                                                            \
  inline constexpr TablesBySet<Table> Name = {&Name##_baseline, &Name##_avx2, &Name##_avx512}; \
  }
#else
#define TOMLIN_DECLARE_TABLES(Name, Table)                                         \
  namespace tomlin::kernels {                                                      \
  extern const Table Name##_baseline;                                              \
  inline constexpr TablesBySet<Table> Name = {&Name##_baseline, nullptr, nullptr}; \
  }
#endif
#define TOMLIN_DECLARE_KERNELS(Evaluator) TOMLIN_DECLARE_TABLES(Evaluator, KernelTable<double>)
