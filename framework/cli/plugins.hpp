#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/plugin/load.hpp"
#include "framework/scene/scene_document.hpp"

namespace tomlin {

/// The libraries of the command line, for all scenes, by paths from the current folder, then those
/// that the scenes name, by paths from their own.
std::vector<PluginRequest> requested_plugins(const std::vector<std::string>& given,
                                             std::span<const SceneDocument> scenes);

/// All components that a command has: tomlin's own and those of plugins. Throws InputError. A crash
/// of the process reports from then on which libraries were loaded.
Registry registry_with_plugins(const std::vector<std::string>& given,
                               std::span<const SceneDocument> scenes);

}  // namespace tomlin
