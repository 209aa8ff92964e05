#include "framework/cli/tradeoff_scene.hpp"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/cli/new_file.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"
#include "framework/scene/edit.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {}  // namespace

void check_new_scene(const TradeoffArguments& arguments) {
  if (!arguments.write) return;
  std::error_code error;
  if (fs::equivalent(*arguments.write, arguments.scene, error)) {
    refuse_input(FaultCode::file_exists, "--write", *arguments.write, "this is the scene itself",
                 "another file");
  }
  if (fs::exists(fs::symlink_status(*arguments.write, error)) && !arguments.force) {
    refuse_input(FaultCode::file_exists, "--write", *arguments.write, "the file exists",
                 "a new file, or --force");
  }
  refuse_unwritable(*arguments.write, "--write");
}

std::string write_scene(const TradeoffArguments& arguments, const SceneDocument& document,
                        const Registry& registry, const Recommendation& recommendation) {
  std::vector<Setting> settings = arguments.settings;
  settings.insert(settings.end(), recommendation.settings.begin(), recommendation.settings.end());
  try {
    const std::string text = edited(document.text(), arguments.scene, settings);
    const auto meant = document.read(registry, settings);
    const auto read = parse_scene(text, *arguments.write, registry);
    if (read->effective_toml != meant->effective_toml) return "the text would mean another scene";
    OutputFile file(*arguments.write);
    file.append(text);
    file.publish();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace tomlin
