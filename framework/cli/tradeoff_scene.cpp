#include "framework/cli/tradeoff_scene.hpp"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/cli/new_file.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/scene/edit.hpp"

namespace tomlin {
namespace fs = std::filesystem;

void check_new_scene(const std::string& file, const std::string& scene, bool force) {
  std::error_code error;
  if (fs::equivalent(file, scene, error)) {
    refuse_input(FaultCode::file_exists, "--write", file, "this is the scene itself",
                 "another file");
  }
  if (fs::exists(fs::symlink_status(file, error)) && !force) {
    refuse_input(FaultCode::file_exists, "--write", file, "the file exists",
                 "a new file, or --force");
  }
  refuse_unwritable(file, "--write");
}

std::string write_scene(const std::string& file, const SceneDocument& document,
                        const std::string& scene, std::vector<Setting> settings,
                        const Registry& registry, const Recommendation& recommendation) {
  settings.insert(settings.end(), recommendation.settings.begin(), recommendation.settings.end());
  try {
    const std::string text = edited(document.text(), scene, settings);
    const auto meant = document.read(registry, settings);
    const auto read = parse_scene(text, file, registry);
    if (read->effective_toml != meant->effective_toml) return "the text would mean another scene";
    write_new_file(file, text);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace tomlin
