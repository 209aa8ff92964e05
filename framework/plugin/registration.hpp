#pragma once

#include <filesystem>
#include <string>

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// Calls `visit` with the list of records of each kind.
template <class Visit>
void for_each_kind(const Registry& registry, Visit visit) {
  visit(registry.bodies());
  visit(registry.forces());
  visit(registry.integrators());
  visit(registry.observers());
}

/// Loads a library, which then stays, and lets it add its components to `registry`. What was wrong;
/// empty when nothing was.
std::string register_components(const std::filesystem::path& library, Registry& registry);

/// How long a library may take to register, in seconds; some need milliseconds.
inline constexpr double kLongestRegistration = 10.0;

/// Registers in a child process, where a crash, an endless loop or a call of exit() does no harm.
std::string probe_registration(const std::filesystem::path& library,
                               double seconds = kLongestRegistration);

}  // namespace tomlin
