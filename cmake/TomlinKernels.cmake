# Numeric kernels are compiled once per instruction set, each copy in a namespace of its own, and
# chosen when the program starts (framework/core/system/instruction_set.hpp).

set(TOMLIN_KERNEL_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/kernels.cpp.in)

# -DTOMLIN_INSTRUCTION_SETS="baseline;avx2" leaves sets out, for quicker builds that check something
# else; baseline is always needed. An installed tomlin tells its own (tomlinConfig.cmake).
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(TOMLIN_INSTRUCTION_SETS baseline)
elseif(NOT DEFINED TOMLIN_INSTRUCTION_SETS)
  set(TOMLIN_INSTRUCTION_SETS baseline avx2 avx512)
endif()
set(TOMLIN_SET_DEFINITIONS ${TOMLIN_INSTRUCTION_SETS})
list(REMOVE_ITEM TOMLIN_SET_DEFINITIONS baseline)
list(TRANSFORM TOMLIN_SET_DEFINITIONS TOUPPER)
list(TRANSFORM TOMLIN_SET_DEFINITIONS PREPEND TOMLIN_KERNELS_)

# -DTOMLIN_NUMBER_TYPES="double" leaves quadruple precision out in the same way.
if(NOT DEFINED TOMLIN_NUMBER_TYPES)
  set(TOMLIN_NUMBER_TYPES double Quad)
endif()
if(NOT Quad IN_LIST TOMLIN_NUMBER_TYPES)
  list(APPEND TOMLIN_SET_DEFINITIONS TOMLIN_WITHOUT_QUAD)
endif()

# What kernels are compiled with wherever they are compiled. Highway's own assertions, which builds
# without optimisation would switch on, need its library; here only its headers are used.
set(TOMLIN_KERNEL_FLAGS -ffp-contract=off -fno-math-errno -fno-trapping-math
                        -DHWY_IS_DEBUG_BUILD=0)

# -march alone makes Highway fall back to two lanes: it wants the cryptographic sets as well.
set(TOMLIN_FLAGS_baseline "")
set(TOMLIN_FLAGS_avx2 -march=x86-64-v3 -maes -mpclmul -DTOMLIN_TARGET=avx2 -DTOMLIN_TARGET_AVX2=1)
set(TOMLIN_FLAGS_avx512 -march=x86-64-v4 -maes -mpclmul -DTOMLIN_TARGET=avx512
                        -DTOMLIN_TARGET_AVX512=1)

# Under sanitizers kernels keep the address sanitizer and of the other what concerns numbers: all of
# it takes five times as long to compile.
set(TOMLIN_KERNEL_SANITIZERS "")
if(TOMLIN_FUZZ)
  set(TOMLIN_KERNEL_SANITIZERS -fno-sanitize=fuzzer-no-link,undefined
                               -fsanitize=signed-integer-overflow,shift,float-cast-overflow,bounds)
endif()

# tomlin_kernels(TARGET HEADER CLASS [TYPE...]): compile the kernels of CLASS, defined in HEADER (as
# an #include in TARGET names it, or absolute), into TARGET: in each number type (by default all of
# the build's) for every instruction set. Quadruple numbers have no vector instructions. CLASS may be
# a list, "A;B": its classes share one source file, since headers take most of the time to compile.
function(tomlin_kernels target header classes)
  set(TOMLIN_KERNEL_HEADER ${header})
  list(GET classes 0 first)
  set(types ${ARGN})
  if(NOT types)
    set(types ${TOMLIN_NUMBER_TYPES})
  endif()
  foreach(TOMLIN_KERNEL_TYPE ${types})
    set(TOMLIN_KERNEL_DEFINITIONS "")
    foreach(class IN LISTS classes)
      string(APPEND TOMLIN_KERNEL_DEFINITIONS
             "TOMLIN_DEFINE_KERNELS(${class}, ${TOMLIN_KERNEL_TYPE})\n")
    endforeach()
    set(sets ${TOMLIN_INSTRUCTION_SETS})
    if(TOMLIN_KERNEL_TYPE STREQUAL "Quad")
      set(sets baseline)
    endif()
    foreach(set ${sets})
      set(file ${CMAKE_CURRENT_BINARY_DIR}/${first}_${TOMLIN_KERNEL_TYPE}_${set}.cpp)
      configure_file(${TOMLIN_KERNEL_TEMPLATE} ${file} @ONLY)
      set_source_files_properties(${file} PROPERTIES
                                  COMPILE_OPTIONS "${TOMLIN_KERNEL_FLAGS};${TOMLIN_FLAGS_${set}};${TOMLIN_KERNEL_SANITIZERS}"
                                  SKIP_PRECOMPILE_HEADERS ON)
      target_sources(${target} PRIVATE ${file})
    endforeach()
  endforeach()
endfunction()

# tomlin_add_force(TARGET NAME): the file pair NAME.hpp/.cpp in the current folder, whose evaluator
# is NAME in CamelCase, becomes part of TARGET. It works in any project that has found tomlin.
function(tomlin_add_force target name)
  string(REPLACE "_" ";" words ${name})
  set(class "")
  foreach(word ${words})
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND class ${first}${rest})
  endforeach()
  target_sources(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp)
  tomlin_kernels(${target} ${CMAKE_CURRENT_SOURCE_DIR}/${name}.hpp ${class})
endfunction()
