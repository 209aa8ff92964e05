# tomlin_add_plugin(NAME FILE...
#                   [NUMBER_TYPES double Quad] [INSTRUCTION_SETS baseline avx2 avx512])
#
# Makes the shared library libNAME.so, for `plugins = ["libNAME.so"]` in a scene. NAME is a target
# like any other. Of each FILE.cpp that declares kernels, TOMLIN_DECLARE_KERNELS(Evaluator), the
# evaluator is compiled in every number type for every instruction set, as tomlin's own are: from
# FILE.hpp where there is one, else from FILE.cpp itself, whose other parts then stand between
# `#ifndef TOMLIN_KERNELS_ONLY` and `#endif`. Number types or instruction sets that are left out
# leave out ways to run, and nothing else; double and baseline are always needed.
#
# Where the project says nothing of optimisation (no CMAKE_BUILD_TYPE, no -O in CMAKE_CXX_FLAGS),
# the plugin is compiled as tomlin is: -O3. Options of the folder or the target come later and count.

set(TOMLIN_PLUGIN_NOTE ${CMAKE_CURRENT_LIST_DIR}/plugin_note.cpp.in)

function(tomlin_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "NUMBER_TYPES;INSTRUCTION_SETS")
  set(types ${TOMLIN_NUMBER_TYPES})
  if(arg_NUMBER_TYPES)
    set(types ${arg_NUMBER_TYPES})
  endif()
  set(left_out ${TOMLIN_INSTRUCTION_SETS})
  if(arg_INSTRUCTION_SETS)
    set(TOMLIN_INSTRUCTION_SETS ${arg_INSTRUCTION_SETS})
  endif()
  list(REMOVE_ITEM left_out ${TOMLIN_INSTRUCTION_SETS})

  add_library(${name} MODULE ${arg_UNPARSED_ARGUMENTS})
  set_target_properties(${name} PROPERTIES PREFIX lib SUFFIX .so CXX_VISIBILITY_PRESET hidden
                        VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PRIVATE tomlin::plugin_kit)
  # Nothing of tomlin's libraries shows; what is missing is found now. (Sanitizers' own functions
  # are in the program.)
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    target_link_options(${name} PRIVATE -Wl,-z,defs)
  endif()
  get_property(has_configurations GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(NOT has_configurations AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CXX_FLAGS MATCHES "(^| )-O")
    target_compile_options(${name} BEFORE PRIVATE -O3 -DNDEBUG)
  endif()
  foreach(set ${left_out})
    string(TOUPPER ${set} set)
    target_compile_options(${name} PRIVATE -UTOMLIN_KERNELS_${set})
  endforeach()
  foreach(type ${TOMLIN_NUMBER_TYPES})
    if(NOT type IN_LIST types)
      string(TOUPPER ${type} upper)
      target_compile_definitions(${name} PRIVATE TOMLIN_WITHOUT_${upper})
    endif()
  endforeach()

  foreach(file ${arg_UNPARSED_ARGUMENTS})
    tomlin_plugin_kernels(${name} ${file} ${types})
  endforeach()

  set(TOMLIN_PLUGIN_NAME ${name})
  string(REPLACE ";" " " TOMLIN_NOTE_SETS "${TOMLIN_INSTRUCTION_SETS}")
  string(REPLACE ";" " " TOMLIN_NOTE_NUMBERS "${types}")
  string(REPLACE "Quad" "quadruple" TOMLIN_NOTE_NUMBERS "${TOMLIN_NOTE_NUMBERS}")
  set(note ${CMAKE_CURRENT_BINARY_DIR}/${name}_note.cpp)
  configure_file(${TOMLIN_PLUGIN_NOTE} ${note} @ONLY)
  target_sources(${name} PRIVATE ${note})
endfunction()

# The kernels of all evaluators that a source file declares.
function(tomlin_plugin_kernels target file)
  get_filename_component(file ${file} ABSOLUTE)
  if(NOT file MATCHES "\\.cpp$" OR NOT EXISTS ${file})
    return()
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(STRINGS ${file} declarations REGEX "^[ \t]*TOMLIN_DECLARE_KERNELS\\(")
  foreach(declaration ${declarations})
    string(REGEX REPLACE ".*\\([ \t]*([A-Za-z_0-9]+)[ \t]*\\).*" "\\1" class "${declaration}")
    string(REGEX REPLACE "\\.cpp$" ".hpp" header ${file})
    if(NOT EXISTS ${header})
      set(header ${CMAKE_CURRENT_BINARY_DIR}/${class}_evaluator.hpp)
      file(CONFIGURE OUTPUT ${header} @ONLY CONTENT
           "#define TOMLIN_KERNELS_ONLY\n#include \"@file@\"\n")
    endif()
    tomlin_kernels(${target} ${header} ${class} ${ARGN})
  endforeach()
endfunction()
