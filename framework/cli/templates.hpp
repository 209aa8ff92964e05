#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// A scene to start from; the texts stand in framework/cli/templates/.
struct SceneTemplate {
  std::string name;  ///< "pt"
  std::string summary;
  std::string text;  ///< a whole scene that runs
};

const std::vector<SceneTemplate>& scene_templates();

/// A file of a plugin to start from, whose force is called plugin_name and PluginName; they stand
/// in framework/cli/templates/plugin/.
struct PluginTemplate {
  std::string file;
  std::string text;
};

const std::vector<PluginTemplate>& plugin_templates();

/// Files of a plugin with a force between particles, whose class is called PairPluginName; those
/// that differ stand in templates/pairs/.
const std::vector<PluginTemplate>& pair_plugin_templates();

/// The types that the headers of framework/core bring into a plugin: "Site".
const std::vector<std::string_view>& core_types();

}  // namespace tomlin
