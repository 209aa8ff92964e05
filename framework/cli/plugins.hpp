#pragma once

#include <string>
#include <vector>

#include "framework/core/registry.hpp"
#include "framework/plugin/load.hpp"

namespace tomlin {

/// The libraries of the command line, for all scenes, by paths from the current folder, then those
/// that the scenes name, by paths from their own.
std::vector<PluginRequest> requested_plugins(const std::vector<std::string>& given,
                                             const std::vector<std::string>& scenes);

/// All components that a command has: tomlin's own and those of plugins. Throws InputError. A crash
/// of the process tells from then on which libraries were loaded.
Registry registry_with_plugins(const std::vector<std::string>& given,
                               const std::vector<std::string>& scenes);

}  // namespace tomlin
