#include "framework/cli/plugins.hpp"

#include <filesystem>

#include "framework/cli/crash_note.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

PluginRequest request_of(const std::string& given) {
  PluginRequest request;
  request.given = given;
  request.location.file = "--plugin";
  request.everywhere = true;
  request.path = fs::absolute(given).lexically_normal();
  return request;
}

}  // namespace

std::vector<PluginRequest> requested_plugins(const std::vector<std::string>& given,
                                             std::span<const SceneDocument> scenes) {
  std::vector<PluginRequest> requests;
  requests.reserve(given.size());
  for (const std::string& name : given) requests.push_back(request_of(name));
  for (const SceneDocument& scene : scenes) {
    for (const NamedLibrary& library : scene.libraries()) {
      requests.push_back({library.given, library.path, library.location, false});
    }
  }
  return requests;
}

Registry registry_with_plugins(const std::vector<std::string>& given,
                               std::span<const SceneDocument> scenes) {
  Registry registry = standard_registry();
  load_plugins(requested_plugins(given, scenes), registry);
  tell_of_plugins_in_a_crash(loaded_plugins());
  return registry;
}

}  // namespace tomlin
