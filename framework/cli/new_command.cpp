#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/new_plugin.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/templates.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct NewArguments {
  std::string model;                ///< "pt", "fk", "ring", "plugin"
  std::optional<std::string> name;  ///< of the file, without .toml; of the force
  std::optional<std::string> file;  ///< instead of the name; the folder of a plugin
  bool pairs = false;               ///< of a plugin: a force between particles
  bool force = false;
};

constexpr const char* kNewFooter = R"(
Models:

  pt      one tip on a substrate: Prandtl-Tomlinson
  fk      a driven chain of particles and springs: Frenkel-Kontorova
  ring    a ring that drags, rolls or hops
  plugin  no scene but a folder: a user-defined force in C++, with a CMake file, a scene and a test

Examples:

  tomlin new pt                  writes pt.toml, a scene with comments that runs as it is
  tomlin new ring my_ring        writes my_ring.toml
  tomlin new fk -o scenes/a.toml
  tomlin new plugin my_force     writes the folder my_force
  tomlin new plugin my_law --pairs   a force between particles, with a cutoff

Exit status: 0 done; 1 the file could not be written; 2 invalid input.)";

const SceneTemplate& template_of(const std::string& model) {
  std::vector<std::string> names;
  for (const SceneTemplate& known : scene_templates()) {
    if (known.name == model) return known;
    names.push_back(known.name);
  }
  names.emplace_back("plugin");
  refuse_command(FaultCode::command_invalid_value,
                 fmt::format("there is no model \"{}\" to start from", model),
                 fmt::format("{}", fmt::join(names, ", ")),
                 nearest_name(model, names).value_or(""));
}

/// FILE, or NAME.toml.
fs::path file_of(const NewArguments& arguments) {
  if (arguments.file) return *arguments.file;
  const fs::path name = arguments.name.value_or(arguments.model);
  return name.extension() == ".toml" ? name : fs::path(name.string() + ".toml");
}

void add_options(CLI::App& parser, NewArguments& arguments) {
  parser.add_option("MODEL", arguments.model, "pt, fk, ring or plugin")
      ->option_text(" ")
      ->required();
  parser.add_option("NAME", arguments.name, "of the file, or of the force; MODEL by default")
      ->option_text(" ");
  add_output_option(parser, arguments.file, "FILE",
                    "the file, NAME.toml by default; of a plugin the folder, NAME by default");
  parser.add_flag("--pairs", arguments.pairs,
                  "of a plugin: a force between pairs of particles, of one body or two");
  parser.add_flag("--force", arguments.force, "replace a file that is there");
}

void check(NewArguments& arguments) {
  refuse_empty(arguments.name, "NAME");
  refuse_empty(arguments.file, "-o");
  if (arguments.name && arguments.file && arguments.model != "plugin") {
    refuse_command(FaultCode::command_conflict, "NAME and -o both name the file", "one of them");
  }
  if (arguments.pairs && arguments.model != "plugin") {
    refuse_command(FaultCode::command_conflict, "--pairs is about the force of a plugin",
                   "tomlin new plugin NAME --pairs");
  }
}

int write_new(const NewArguments& arguments) {
  if (arguments.model == "plugin") {
    return new_plugin(arguments.name, arguments.file,
                      arguments.pairs ? NewForce::pairs : NewForce::particles, arguments.force);
  }
  const SceneTemplate& scene = template_of(arguments.model);
  const fs::path file = file_of(arguments);
  refuse_to_replace(file, arguments.force);
  refuse_unwritable(file);
  write_new_file(file, scene.text);
  return print_result(fmt::format(
      "{}: {}\n  tomlin explain {}    what it builds, its scales, its stable step, its cost\n"
      "  tomlin run {}        runs it\n",
      file.string(), scene.summary, file.string(), file.string()));
}

}  // namespace

CommandRecord new_command() {
  return {"new", "write a commented scene to start from", kNewFooter,
          declared<NewArguments>(add_options, check, write_new)};
}

}  // namespace tomlin
