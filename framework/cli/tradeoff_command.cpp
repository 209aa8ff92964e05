#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/tradeoff_text.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/tradeoff.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCsvFile = "tradeoff.csv";
constexpr const char* kJsonFile = "tradeoff.json";

std::string default_folder(const std::string& scene_file) {
  return fs::path(scene_file).stem().string() + ".tradeoff.out";
}

}  // namespace

int tradeoff_command(const TradeoffArguments& arguments) {
  const Registry registry = standard_registry();
  const auto scene = read_scene(arguments.scene, registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(default_folder(arguments.scene)),
                   arguments.force ? Occupied::replace_results : Occupied::refuse);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  TradeoffRequest request{arguments.observable, arguments.tolerance, arguments.budget,
                          &signals.stop()};
  const Tradeoff tradeoff = measure_tradeoff(scene, registry, request);

  folder.create();
  folder.write_file(kCsvFile, tradeoff_csv(tradeoff));
  folder.write_file(kJsonFile, tradeoff_json(*scene, tradeoff));
  const std::string where = (folder.path() / "").string() + ": " + kCsvFile + ", " + kJsonFile;
  const int status = print_result(tradeoff_text(*scene, tradeoff, where));
  if (tradeoff.interrupted) return kExitSignal + signals.caught();
  return status;
}

}  // namespace tomlin
