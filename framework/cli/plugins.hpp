#pragma once

#include <string>
#include <vector>

#include "framework/core/registry.hpp"
#include "framework/plugin/load.hpp"

namespace tomlin {

/// The libraries of the command line, for all scenes, then those that the scenes name. A library of
/// the command line is looked for from the current folder on; one without a slash that is not
/// there, in the folder of the first scene.
std::vector<PluginRequest> requested_plugins(const std::vector<std::string>& given,
                                             const std::vector<std::string>& scenes);

/// All components that a command has: tomlin's own and those of plugins. Throws InputError.
Registry registry_with_plugins(const std::vector<std::string>& given,
                               const std::vector<std::string>& scenes);

}  // namespace tomlin
