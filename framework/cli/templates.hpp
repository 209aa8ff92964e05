#pragma once

#include <string>
#include <vector>

namespace tomlin {

/// A scene to start from; the texts stand in framework/cli/templates/.
struct SceneTemplate {
  std::string name;  ///< "pt"
  std::string summary;
  std::string text;  ///< a whole scene that runs
};

const std::vector<SceneTemplate>& scene_templates();

}  // namespace tomlin
