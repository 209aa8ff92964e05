#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/study_figure.hpp"
#include "framework/cli/tradeoff_figure.hpp"
#include "framework/cli/tradeoff_scene.hpp"
#include "framework/cli/tradeoff_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/tradeoff.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCsvFile = "tradeoff.csv";
constexpr const char* kJsonFile = "tradeoff.json";
constexpr const char* kFigureFile = "tradeoff.svg";
constexpr std::array kFiles = {kCsvFile, kJsonFile, kFigureFile};

std::string default_folder(const std::string& scene_file) {
  return fs::path(scene_file).stem().string() + ".tradeoff.out";
}

void print_note(const std::string& note) { print_error_line("note: " + note); }

/// On a terminal one line that tells what is going on.
class Progress {
 public:
  explicit Progress(double budget)
      : budget_(budget), on_(progress_style() == ProgressLine::Style::terminal) {}
  ~Progress() { show(""); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void tell(const std::string& what) {
    const std::chrono::duration<double> used = std::chrono::steady_clock::now() - started_;
    show(fmt::format("tomlin: {:.0f} of {:g} s, {}", used.count(), budget_, what));
  }

 private:
  void show(const std::string& line) {
    if (!on_) return;
    std::fputs(("\r" + line + std::string(width_ > line.size() ? width_ - line.size() : 0, ' ') +
                (line.empty() ? "\r" : ""))
                   .c_str(),
               stderr);
    std::fflush(stderr);
    width_ = line.size();
  }

  double budget_;
  bool on_;
  std::size_t width_ = 0;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

Tradeoff measured(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                  const TradeoffArguments& arguments, const StopSignals& signals) {
  Progress progress(arguments.budget);
  return measure_tradeoff(
      scene, registry,
      {arguments.observable, arguments.tolerance, arguments.budget, &signals.stop(),
       [&progress](const std::string& what) { progress.tell(what); }});
}

}  // namespace

int tradeoff_command(const TradeoffArguments& arguments) {
  const SceneDocument document(arguments.scene);
  const Registry registry = registry_with_plugins(arguments.plugins, {&document, 1});
  const auto scene = document.read(registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(default_folder(arguments.scene)),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, kFiles);
  refuse_to_lose_inputs(folder, *scene, kFiles);
  check_new_scene(arguments);
  folder.own();

  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  const Tradeoff tradeoff = measured(scene, registry, arguments, signals);

  folder.write_file(kCsvFile, tradeoff_csv(tradeoff));
  std::string where = (folder.path() / "").string() + ": " + kJsonFile + ", " + kCsvFile;
  if (!tradeoff.points.empty() &&
      write_study_figure(folder, kFigureFile, tradeoff_figure(tradeoff))) {
    where += std::string(", ") + kFigureFile;
  }
  folder.write_file(kJsonFile, tradeoff_json(*scene, tradeoff));
  std::string trouble;
  if (arguments.write && tradeoff.recommendation) {
    trouble = write_scene(arguments, document, registry, *tradeoff.recommendation);
    if (trouble.empty()) where += "; " + *arguments.write;
  }
  const int status = print_result(tradeoff_text(*scene, tradeoff, where));
  if (arguments.write && !tradeoff.recommendation) {
    print_note(*arguments.write + " is not written: there is nothing to recommend");
  }
  if (!trouble.empty()) {
    print_note(*arguments.write + " cannot be written, paste the lines instead: " + trouble);
    return kExitFailed;
  }
  if (tradeoff.interrupted) return kExitSignal + signals.caught();
  return status;
}

}  // namespace tomlin
