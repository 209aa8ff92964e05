#pragma once

#include <cstddef>
#include <cstdio>
#include <exception>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/plugin/entry.hpp"

/// The source file of a plugin includes this. Once in the library:
///
///   TOMLIN_PLUGIN(registry) { registry.add(tomlin::morse_record()); }
///
/// registers its forces, bodies, integrators and observers, by the same records as the program's
/// own. `tomlin new plugin NAME` writes a whole one with its CMake file.
namespace tomlin::plugin {

inline int registers(void (*components)(Registry&), Registry& registry, char* message,
                     std::size_t size) noexcept {
  const char* why = "an exception that is no std::exception";
  try {
    components(registry);
    return 0;
  } catch (const std::exception& error) {
    std::snprintf(message, size, "%s", error.what());
  } catch (...) {
    std::snprintf(message, size, "%s", why);
  }
  return 1;
}

}  // namespace tomlin::plugin

// A macro, since it defines what the program looks for by name.
#define TOMLIN_PLUGIN(registry)                                                                    \
  static void tomlin_plugin_components(tomlin::Registry& registry);                                \
  extern "C" __attribute__((visibility("default"))) int tomlin_register_plugin(                    \
      tomlin::Registry* into, char* message, std::size_t size);                                    \
  extern "C" int tomlin_register_plugin(tomlin::Registry* into, char* message, std::size_t size) { \
    return tomlin::plugin::registers(&tomlin_plugin_components, *into, message, size);             \
  }                                                                                                \
  static void tomlin_plugin_components(tomlin::Registry& registry)
