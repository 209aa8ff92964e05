#pragma once

#include <version>

#include "framework/plugin/border.hpp"  // made by CMake: TOMLIN_BORDER, TOMLIN_RELEASE
#include "framework/plugin/entry.hpp"

// A build describes itself in its note by literals: `key=value` between semicolons. Macros,
// because the note is put together by the preprocessor (cmake/plugin_note.cpp.in).

#define TOMLIN_TEXT_(x) #x
#define TOMLIN_TEXT(x) TOMLIN_TEXT_(x)

// The C++ library, whose types cross the border.
#if defined(_LIBCPP_VERSION)
#define TOMLIN_NOTE_LIBRARY "libc++ " TOMLIN_TEXT(_LIBCPP_ABI_VERSION)
#elif defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
#define TOMLIN_NOTE_LIBRARY "libstdc++ cxx11"
#else
#define TOMLIN_NOTE_LIBRARY "libstdc++ before cxx11"
#endif
#if defined(_GLIBCXX_DEBUG)  // containers of another size
#define TOMLIN_NOTE_ABI TOMLIN_NOTE_LIBRARY " debug"
#else
#define TOMLIN_NOTE_ABI TOMLIN_NOTE_LIBRARY
#endif

#if defined(__clang__)
#define TOMLIN_NOTE_COMPILER "clang " TOMLIN_TEXT(__clang_major__) "." TOMLIN_TEXT(__clang_minor__)
#else
#define TOMLIN_NOTE_COMPILER "gcc " TOMLIN_TEXT(__GNUC__) "." TOMLIN_TEXT(__GNUC_MINOR__)
#endif

#define TOMLIN_NOTE_HEAD                                                                   \
  "api=" TOMLIN_TEXT(TOMLIN_PLUGIN_API) ";release=" TOMLIN_RELEASE ";abi=" TOMLIN_NOTE_ABI \
                                        ";compiler=" TOMLIN_NOTE_COMPILER ";border=" TOMLIN_BORDER
