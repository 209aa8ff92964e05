#include <array>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "framework/cli/commands.hpp"
#include "framework/cli/compare_text.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/study_figure.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/compare.hpp"

namespace tomlin {
namespace {

constexpr const char* kDefaultFolder = "compare.out";
constexpr const char* kCsvFile = "compare.csv";
constexpr const char* kJsonFile = "compare.json";
constexpr const char* kFigureFile = "compare.svg";
constexpr std::array kFiles = {kCsvFile, kJsonFile, kFigureFile};

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

}  // namespace

int compare_command(const CompareArguments& arguments) {
  const std::vector<SceneDocument> documents(arguments.scenes.begin(), arguments.scenes.end());
  const Registry registry = registry_with_plugins(arguments.plugins, documents);
  const auto scenes = read_scenes(documents, registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(kDefaultFolder),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, kFiles);
  for (const auto& scene : scenes) refuse_to_lose_inputs(folder, *scene, kFiles);
  folder.own();

  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  const Comparison comparison =
      compare_models(scenes, {arguments.observable, arguments.tolerance, &signals.stop()});

  folder.write_file(kCsvFile, compare_csv(comparison));
  std::string where = (folder.path() / "").string() + ": " + kJsonFile + ", " + kCsvFile;
  if (write_study_figure(folder, kFigureFile, compare_figure(comparison))) {
    where += std::string(", ") + kFigureFile;
  }
  folder.write_file(kJsonFile, compare_json(comparison));
  const int status = print_result(compare_text(comparison, where));
  if (comparison.interrupted) return kExitSignal + signals.caught();
  for (const ComparedModel& model : comparison.models) {
    if (model.result.status == RunStatus::failed) return kExitFailed;
  }
  return status;
}

}  // namespace tomlin
