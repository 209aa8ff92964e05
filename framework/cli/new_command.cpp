#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/new_plugin.hpp"
#include "framework/cli/templates.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(Fault fault) { throw InputError({std::move(fault)}); }

const SceneTemplate& template_of(const std::string& model) {
  std::vector<std::string> names;
  for (const SceneTemplate& known : scene_templates()) {
    if (known.name == model) return known;
    names.push_back(known.name);
  }
  Fault fault(FaultCode::command_invalid_value);
  fault.place.file = "tomlin";
  names.emplace_back("plugin");
  fault.why = fmt::format("there is no model \"{}\" to start from", model);
  fault.admissible = fmt::format("{}", fmt::join(names, ", "));
  fault.nearest = nearest_name(model, names).value_or("");
  refuse(std::move(fault));
}

/// FILE, or NAME.toml.
fs::path file_of(const NewArguments& arguments) {
  if (arguments.file) return *arguments.file;
  const fs::path name = arguments.name.value_or(arguments.model);
  return name.extension() == ".toml" ? name : fs::path(name.string() + ".toml");
}

}  // namespace

int new_command(const NewArguments& arguments) {
  if (arguments.model == "plugin") return new_plugin(arguments);
  const SceneTemplate& scene = template_of(arguments.model);
  const fs::path file = file_of(arguments);
  refuse_to_replace(file, arguments.force);
  refuse_unwritable(file);
  OutputFile output(file);
  output.append(scene.text);
  output.publish();
  return print_result(fmt::format(
      "{}: {}\n  tomlin explain {}    what it builds, its scales, its stable step, its cost\n"
      "  tomlin run {}        runs it\n",
      file.string(), scene.summary, file.string(), file.string()));
}

}  // namespace tomlin
