#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/compare_text.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/compare.hpp"

namespace tomlin {
namespace {

struct CompareArguments : SettingOptions {
  std::vector<std::string> scenes;
  std::string observable;
  double tolerance = 1e-2;
  std::optional<std::string> folder;
  bool force = false;
};

constexpr const char* kCompareFooter = R"(
Runs every scene, estimates its error by a second run with other steps, and holds one number of the
summary against that of the model with the most free coordinates. Shows value, error and cost of
each, and which is the simplest that agrees within T (relative; absolute where the number is zero).
A model agrees when it does so even if both errors are taken in full; where the errors alone are
larger than T it is undecided.

Models are comparable when their drivers have the same velocity and their forces the same periods
along it; other scenes are refused. Another stiffness or amplitude is noted, and so is another axis
of the pull in scenes of other dimensions, or a scene that declares no period, as sheets of atoms.

In --observable "driver" and "body" stand for the only driver and the only body of each scene.

Examples:

  tomlin compare tip.toml ring.toml --observable driver.mean_force.x
  tomlin compare tip.toml chain.toml ring.toml --observable driver.mean_force.x --tolerance 1e-3

DIR then holds
  compare.csv       a row for each model
  compare.json      the same, with notes and warnings
  curves.csv        for each model with a driver the force along its pull over its displacement

tomlin plot DIR -o compare.svg draws the curves.

Exit status: 0 done; 1 a run failed, or the results could not be written; 2 invalid input;
nothing was written; 130 or 143 after an interrupt.)";

constexpr const char* kDefaultFolder = "compare.out";
constexpr const char* kCsvFile = "compare.csv";
constexpr const char* kJsonFile = "compare.json";
constexpr const char* kCurvesFile = "curves.csv";
constexpr std::array kFiles = {kCsvFile, kJsonFile, kCurvesFile};

/// The faults of all scenes together.
std::vector<std::shared_ptr<const Scene>> read_scenes(const std::vector<SceneDocument>& documents,
                                                      const Registry& registry,
                                                      const std::vector<Setting>& settings) {
  std::vector<std::shared_ptr<const Scene>> scenes;
  std::vector<Fault> faults;
  for (const SceneDocument& document : documents) {
    try {
      scenes.push_back(document.read(registry, settings));
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return scenes;
}

void add_options(CLI::App& parser, CompareArguments& arguments) {
  parser.add_option("SCENE", arguments.scenes, "the scenes, TOML files; two at least")
      ->option_text("...")
      ->required();
  add_setting_options(parser, arguments);
  add_observable_option(parser, arguments.observable);
  parser.add_option("--tolerance", arguments.tolerance, "to agree within; 1e-2 by default")
      ->type_name("T");
  add_output_option(parser, arguments.folder, "DIR", "folder for the results; compare.out");
  parser.add_flag("--force", arguments.force,
                  "DIR need not be empty; what tomlin writes is replaced");
}

void check(CompareArguments& arguments) {
  if (arguments.scenes.size() < 2) {
    refuse_command(FaultCode::command_missing_argument, "one scene cannot be compared",
                   "two or more");
  }
  refuse_unless_positive(arguments.tolerance, "--tolerance");
}

int compare(const CompareArguments& arguments) {
  const std::vector<SceneDocument> documents(arguments.scenes.begin(), arguments.scenes.end());
  const Registry registry = registry_with_plugins(arguments.plugins, documents);
  const auto scenes = read_scenes(documents, registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(kDefaultFolder),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, kFiles);
  for (const auto& scene : scenes) refuse_to_lose_inputs(folder, *scene, kFiles);
  folder.own();

  StopSignals signals;
  const Comparison comparison =
      compare_models(scenes, {arguments.observable, arguments.tolerance, &signals.stop()});

  folder.write_file(kCsvFile, compare_csv(comparison));
  folder.write_file(kCurvesFile, compare_curves_csv(comparison));
  const std::string where = fmt::format("{}: {}, {}, {}", (folder.path() / "").string(), kJsonFile,
                                        kCsvFile, kCurvesFile);
  folder.write_file(kJsonFile, compare_json(comparison));
  const int status = print_result(compare_text(comparison, where));
  if (comparison.interrupted) return kExitSignal + signals.caught();
  for (const ComparedModel& model : comparison.models) {
    if (model.result.status == RunStatus::failed) return kExitFailed;
  }
  return status;
}

}  // namespace

CommandRecord compare_command() {
  return {"compare", "models side by side; the simplest that agrees", kCompareFooter,
          declared<CompareArguments>(add_options, check, compare)};
}

}  // namespace tomlin
