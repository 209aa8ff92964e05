# Numeric kernels are compiled once per instruction set, each copy in a namespace of its own, and
# chosen when the program starts (framework/core/instruction_set.hpp).

set(TOMLIN_KERNEL_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/kernels.cpp.in)
set(TOMLIN_INSTRUCTION_SETS baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND TOMLIN_INSTRUCTION_SETS avx2 avx512)
endif()

# -march alone makes Highway fall back to two lanes: it wants the cryptographic sets as well.
set(TOMLIN_FLAGS_baseline "")
set(TOMLIN_FLAGS_avx2 -march=x86-64-v3 -maes -mpclmul -DTOMLIN_TARGET=avx2 -DTOMLIN_TARGET_AVX2=1)
set(TOMLIN_FLAGS_avx512 -march=x86-64-v4 -maes -mpclmul -DTOMLIN_TARGET=avx512
                        -DTOMLIN_TARGET_AVX512=1)

# tomlin_kernels(TARGET HEADER CLASS [TYPE...]): compile the kernels of CLASS, defined in HEADER (relative to
# the project), into TARGET: in each number type for every instruction set. Quadruple numbers have
# no vector instructions. By default all of double, float, Quad.
function(tomlin_kernels target header class)
  set(TOMLIN_KERNEL_HEADER ${header})
  set(TOMLIN_KERNEL_CLASS ${class})
  set(types ${ARGN})
  if(NOT types)
    set(types double float Quad)
  endif()
  foreach(TOMLIN_KERNEL_TYPE ${types})
    set(sets ${TOMLIN_INSTRUCTION_SETS})
    if(TOMLIN_KERNEL_TYPE STREQUAL "Quad")
      set(sets baseline)
    endif()
    foreach(set ${sets})
      set(file ${CMAKE_CURRENT_BINARY_DIR}/${class}_${TOMLIN_KERNEL_TYPE}_${set}.cpp)
      configure_file(${TOMLIN_KERNEL_TEMPLATE} ${file} @ONLY)
      set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS "${TOMLIN_FLAGS_${set}}"
                                                     SKIP_PRECOMPILE_HEADERS ON)
      target_sources(${target} PRIVATE ${file})
    endforeach()
  endforeach()
endfunction()

# tomlin_force(NAME): the file pair NAME.hpp/.cpp, whose evaluator is NAME in CamelCase.
function(tomlin_force name)
  string(REPLACE "_" ";" words ${name})
  set(class "")
  foreach(word ${words})
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND class ${first}${rest})
  endforeach()
  target_sources(tomlin_forcefields PRIVATE ${name}.cpp)
  tomlin_kernels(tomlin_forcefields forcefields/${name}.hpp ${class})
endfunction()
