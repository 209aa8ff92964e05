#pragma once

#include <cstddef>

/// The program and a shared library with components agree on this before either knows the other.
///
/// A plugin links libtomlin_core into itself, hidden, and takes nothing from the program but the
/// Registry that it is handed: it resolves no symbol of the program's, so that the program exports
/// none, two plugins cannot get into each other's way, and any program that links tomlin's
/// libraries can load it. What crosses the border is then the layout of the types in
/// framework/core, which the note (note.hpp) states, and exceptions and memory, which are the C++
/// library's and shared.
namespace tomlin {

class Registry;

/// Counts changes of this file's meaning.
#define TOMLIN_PLUGIN_API 1

/// The only symbol that a plugin exports. It adds its components and returns 0; or it returns
/// another number with the reason in `message`. Never throws.
inline constexpr const char* kPluginEntry = "tomlin_register_plugin";
using PluginEntry = int (*)(Registry* registry, char* message, std::size_t size);

/// The ELF note that says whether a file can be loaded, without loading it.
inline constexpr const char* kNoteOwner = "tomlin";
inline constexpr unsigned kNoteType = 1;

}  // namespace tomlin
