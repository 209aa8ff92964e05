#include "framework/model/plugin_code.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/records/integrator.hpp"

namespace tomlin {

PluginError::PluginError(std::string component, std::string library, std::string said)
    : std::runtime_error(
          fmt::format("the plugin {} has thrown an exception: {}: {}", library, component, said)),
      component_(std::move(component)),
      library_(std::move(library)),
      said_(std::move(said)) {}

bool uses_plugins(const Scene& scene) {
  return !scene.libraries.empty() || !scene.run.integrator.record->library.empty() ||
         std::any_of(scene.forces.begin(), scene.forces.end(),
                     [](const SceneForce& force) { return !force.record->library.empty(); });
}

PluginError thrown_by_plugins(const Scene& scene, const std::string& said) {
  std::vector<std::string> components;
  std::vector<std::string> libraries;
  const auto add = [&](const std::string& component, const std::string& library) {
    if (library.empty()) return;
    components.push_back(component);
    if (std::find(libraries.begin(), libraries.end(), library) == libraries.end()) {
      libraries.push_back(library);
    }
  };
  for (const SceneForce& force : scene.forces) add("force " + force.name, force.record->library);
  const SceneIntegrator& integrator = scene.run.integrator;
  add("integrator " + integrator.name, integrator.record->library);
  if (components.empty()) {
    components.emplace_back("a function of a record");
    for (const Library& library : scene.libraries) libraries.push_back(library.path);
  }
  return {fmt::format("{}", fmt::join(components, " or ")),
          fmt::format("{}", fmt::join(libraries, " or ")), said};
}

}  // namespace tomlin
