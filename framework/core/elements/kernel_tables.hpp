#pragma once

#include <type_traits>

#include "framework/core/elements/energy_kernels.hpp"
#include "framework/core/numbers/quad.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/kernel_arguments.hpp"

namespace tomlin {

/// Tables of kernels on each instruction set. Null: not compiled in this build.
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

/// Tables of kernels in each number type. Quadruple numbers have no vector instructions, and so one
/// table only.
template <template <class Real> class Table>
struct TablesByType {
  TablesBySet<Table<double>> in_double;
  TablesBySet<Table<Quad>> in_quadruple;

  template <class Real>
  const Table<Real>& on(InstructionSet set) const {
    if constexpr (std::is_same_v<Real, double>) {
      return in_double.on(set);
    } else {
      return in_quadruple.on(set);
    }
  }
};

using KernelTables = TablesByType<ElementTable>;

}  // namespace tomlin

// A set that the build leaves out (TOMLIN_INSTRUCTION_SETS in cmake/TomlinKernels.cmake) has no
// tables.
#if defined(TOMLIN_KERNELS_AVX2)
#define TOMLIN_TABLE_AVX2(table) &table
#else
#define TOMLIN_TABLE_AVX2(table) nullptr
#endif
#if defined(TOMLIN_KERNELS_AVX512)
#define TOMLIN_TABLE_AVX512(table) &table
#else
#define TOMLIN_TABLE_AVX512(table) nullptr
#endif
// A plugin without quadruple precision (cmake/TomlinPlugin.cmake) is not run in it.
#if defined(TOMLIN_WITHOUT_QUAD)
#define TOMLIN_TABLES_QUAD(baseline) \
  {}
#else
#define TOMLIN_TABLES_QUAD(baseline) \
  { &baseline, nullptr, nullptr }
#endif

/// In a component's .cpp: the tables that its kernel files define
/// (framework/core/elements/kernels.hpp), as tomlin::kernels::NAME. Macros, because names are
/// pasted.
#define TOMLIN_DECLARE_DOUBLE_TABLES(Name, Table)                                         \
  namespace tomlin::kernels {                                                             \
  extern const Table Name##_double_baseline;                                              \
  extern const Table Name##_double_avx2;                                                  \
  extern const Table Name##_double_avx512;                                                \
  inline constexpr TablesBySet<Table> Name = {&Name##_double_baseline,                    \
                                              TOMLIN_TABLE_AVX2(Name##_double_avx2),      \
                                              TOMLIN_TABLE_AVX512(Name##_double_avx512)}; \
  }
#define TOMLIN_DECLARE_TABLES(Name, Table)                             \
  namespace tomlin::kernels {                                          \
  extern const Table<double> Name##_double_baseline;                   \
  extern const Table<double> Name##_double_avx2;                       \
  extern const Table<double> Name##_double_avx512;                     \
  extern const Table<Quad> Name##_Quad_baseline;                       \
  inline constexpr TablesByType<Table> Name = {                        \
      {&Name##_double_baseline, TOMLIN_TABLE_AVX2(Name##_double_avx2), \
       TOMLIN_TABLE_AVX512(Name##_double_avx512)},                     \
      TOMLIN_TABLES_QUAD(Name##_Quad_baseline)};                       \
  }
#define TOMLIN_DECLARE_KERNELS(Evaluator) TOMLIN_DECLARE_TABLES(Evaluator, ElementTable)
