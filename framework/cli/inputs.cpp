#include "framework/cli/inputs.hpp"

#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/output/journal.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct Input {
  std::string what;
  fs::path path;
};

/// Returns the files that the scene reads, the scene itself first.
std::vector<Input> inputs_of(const Scene& scene) {
  std::vector<Input> all = {{"the scene itself", scene.file}};
  const auto add = [&all](const char* what, const auto& components) {
    for (const auto& component : components) {
      if (component.record->read_from == nullptr) continue;
      const fs::path& file = component.record->read_from(component.description.get());
      if (!file.empty()) all.push_back({what + component.name, file});
    }
  };
  add("the positions of ", scene.bodies);
  add("the numbers of ", scene.forces);
  for (const Library& library : scene.libraries) all.push_back({"a plugin", library.path});
  return all;
}

/// A scene may be run again in the folder it was found in, but never be replaced by another.
bool stays_the_same(const fs::path& file, const std::string& scene_text) {
  return file.filename() == kSceneFile &&
         read_text_file(file, scene_text.size()).text == scene_text;
}

}  // namespace

void refuse_to_lose_inputs(const RunFolder& folder, const Scene& scene,
                           std::span<const char* const> names, const std::string& scene_text) {
  for (const Input& input : inputs_of(scene)) {
    for (const char* name : names) {
      for (const fs::path& file : {folder.file(name), unfinished(folder.file(name))}) {
        std::error_code error;
        if (!fs::equivalent(file, input.path, error) || stays_the_same(file, scene_text)) continue;
        refuse_input(FaultCode::file_exists, "-o", folder.path().string(),
                     fmt::format("the results would replace {}: {}", input.what, file.string()),
                     "another folder");
      }
    }
  }
}

void refuse_to_lose_inputs(const RunFolder& folder, const Scene& scene,
                           std::span<const char* const> names) {
  refuse_to_lose_inputs(folder, scene, names, scene.effective_toml);
}

void note_missing_locks(const RunFolder& folder, bool quiet) {
  if (quiet || !folder.lacks_locks()) return;
  std::cerr << fmt::format(
      "note: the file system of {} has no locks: {} keeps other programs away\n",
      folder.path().string(), folder.file(kLockFile).string());
}

}  // namespace tomlin
