#include "framework/cli/plugins.hpp"

#include <filesystem>
#include <system_error>

#include "framework/scene/libraries.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

PluginRequest request_of(const std::string& given, const std::vector<std::string>& scenes) {
  PluginRequest request;
  request.given = given;
  request.place.file = "--plugin";
  request.everywhere = true;
  fs::path path = fs::absolute(given);
  std::error_code error;
  if (given.find('/') == std::string::npos && !scenes.empty() && !fs::exists(path, error)) {
    path = fs::absolute(scenes.front()).parent_path() / given;
  }
  request.path = path.lexically_normal();
  return request;
}

}  // namespace

std::vector<PluginRequest> requested_plugins(const std::vector<std::string>& given,
                                             const std::vector<std::string>& scenes) {
  std::vector<PluginRequest> requests;
  requests.reserve(given.size());
  for (const std::string& name : given) requests.push_back(request_of(name, scenes));
  for (const std::string& scene : scenes) {
    for (NamedLibrary& library : libraries_of_scene(scene)) {
      requests.push_back({library.given, library.path, library.place, false});
    }
  }
  return requests;
}

Registry registry_with_plugins(const std::vector<std::string>& given,
                               const std::vector<std::string>& scenes) {
  Registry registry = standard_registry();
  load_plugins(requested_plugins(given, scenes), registry);
  return registry;
}

}  // namespace tomlin
