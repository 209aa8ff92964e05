#include "framework/scene/libraries.hpp"

#include <utility>

namespace tomlin {
namespace fs = std::filesystem;

std::vector<NamedLibrary> named_libraries(const Table& document, const std::string& file,
                                          const Source& source, FaultList& faults) {
  constexpr std::size_t kMostLibraries = 100;
  const Node* node = document.find("plugins");
  if (node == nullptr) return {};
  const std::string expected = "a list of shared libraries, [\"libmorse.so\"]";
  const auto* list = node->as<List>();
  if (list == nullptr || list->size() > kMostLibraries) {
    faults.of_value(*node, {list ? FaultCode::scene_too_large : FaultCode::scene_wrong_type,
                            "plugins", list ? "too many" : "found " + kind_of(*node), expected});
    return {};
  }
  std::vector<NamedLibrary> libraries;
  libraries.reserve(list->size());
  const fs::path folder = fs::absolute(file).parent_path();
  for (const Node& element : *list) {
    const auto* name = element.as<std::string>();
    if (name == nullptr) {
      faults.of_wrong_type(element, "plugins", expected);
    } else if (name->empty() || name->find('\0') != std::string::npos) {
      faults.of_value(
          element, {FaultCode::plugin_cannot_load, "plugins", "not the name of a file", expected});
    } else {
      libraries.push_back(
          {*name, (folder / *name).lexically_normal(), source.location(element.where)});
    }
  }
  return libraries;
}

}  // namespace tomlin
