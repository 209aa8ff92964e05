#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/lammps/lammps_input.hpp"
#include "framework/output/run_folder.hpp"

namespace tomlin {
namespace {

struct ExportArguments : SceneOptions {
  std::string to;
  std::optional<std::string> folder;
  bool force = false;
};

constexpr const char* kExportFooter = R"(
Writes input for LAMMPS that gives the same energy and the same forces at the start as the scene:

  data.lmp    box, masses, positions, velocities and bonds; a type of atoms for each body
  in.lmp      units, potentials, fixes and the run, with comments
  *.tersoff   the numbers of each force of this type

What LAMMPS has no exact counterpart for is refused, all of it with its position in the scene.

Examples:

  tomlin export tube.toml --to lammps
      writes to tube.lammps/ in the current folder.
  tomlin export tube.toml --to lammps --set v=1e-3 -o slow
  cd tube.lammps && lmp -in in.lmp
  cd tube.lammps && lmp -in in.lmp -var steps 0
      the energy and the forces at the start alone.

Exit status: 0 done; 1 the files could not be written; 2 invalid input; nothing was
written.)";

void add_options(CLI::App& parser, ExportArguments& arguments) {
  add_scene_options(parser, arguments);
  parser.add_option("--to", arguments.to, "the program: lammps")->type_name("PROGRAM")->required();
  add_output_option(parser, arguments.folder, "DIR",
                    "folder for the files; SCENE's stem + .lammps");
  parser.add_flag("--force", arguments.force,
                  "DIR need not be empty; only files of these names are replaced");
}

void check(ExportArguments& arguments) {
  if (arguments.to != "lammps") {
    refuse_command(FaultCode::command_invalid_value,
                   fmt::format("scenes are not written for \"{}\"", arguments.to), "--to lammps");
  }
}

int export_scene(const ExportArguments& arguments) {
  const OpenedScene opened(arguments);
  const std::vector<LammpsFile> files = lammps_input(opened.scene, lammps_units(*opened.scene));
  std::vector<const char*> names;
  names.reserve(files.size());
  for (const LammpsFile& file : files) names.push_back(file.name.c_str());
  RunFolder folder(folder_or_default(arguments.folder, arguments.scene, ".lammps"),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, names);
  refuse_to_lose_inputs(folder, *opened.scene, names);
  folder.create();
  for (const LammpsFile& file : files) folder.write_file(file.name, file.text);
  return print_result(fmt::format("{}: {}\n  cd {} && lmp -in {}\n", (folder.path() / "").string(),
                                  fmt::join(names, ", "), folder.path().string(), kLammpsInput));
}

}  // namespace

CommandRecord export_command() {
  return {"export", "write a scene as input for LAMMPS", kExportFooter,
          declared<ExportArguments>(add_options, check, export_scene)};
}

}  // namespace tomlin
