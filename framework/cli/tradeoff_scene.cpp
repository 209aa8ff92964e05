#include "framework/cli/tradeoff_scene.hpp"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/cli/new_file.hpp"
#include "framework/core/fault.hpp"
#include "framework/core/text_file.hpp"
#include "framework/output/output_file.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/edit.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse_file(const std::string& file, std::string why, std::string admissible) {
  Fault fault;
  fault.place.file = "--write";
  fault.key = file;
  fault.why = std::move(why);
  fault.admissible = std::move(admissible);
  throw InputError({std::move(fault)});
}

}  // namespace

void check_new_scene(const TradeoffArguments& arguments) {
  if (!arguments.write) return;
  std::error_code error;
  if (fs::equivalent(*arguments.write, arguments.scene, error)) {
    refuse_file(*arguments.write, "this is the scene itself", "another file");
  }
  if (fs::exists(fs::symlink_status(*arguments.write, error)) && !arguments.force) {
    refuse_file(*arguments.write, "there is something of this name", "a new file, or --force");
  }
  refuse_unwritable(*arguments.write, "--write");
}

std::string write_scene(const TradeoffArguments& arguments, const Registry& registry,
                        const Recommendation& recommendation) {
  std::vector<Setting> settings = arguments.settings;
  settings.insert(settings.end(), recommendation.settings.begin(), recommendation.settings.end());
  const TextFile source = read_text_file(arguments.scene, kLargestSceneFile);
  if (source.too_large) return "the scene is too large";
  if (!source.why.empty()) return source.why;
  try {
    const std::string text = edited(source.text, arguments.scene, settings);
    const auto meant = parse_scene(source.text, arguments.scene, registry, settings);
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
