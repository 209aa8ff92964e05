#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/print_result.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/tradeoff_scene.hpp"
#include "framework/cli/tradeoff_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct TradeoffArguments : SceneOptions {
  std::string observable;
  double tolerance = 1e-3;
  double budget = 60.0;              ///< seconds
  std::optional<std::string> write;  ///< a scene file to be made
  std::optional<std::string> folder;
  bool force = false;
};

constexpr const char* kTradeoffFooter = R"(
Computes one number of the scene's summary in every way that applies: by every integrator from
coarse to fine, and by simpler models of the scene (flexible bodies as rigid
ones, without inertia, quasistatic). Each is held against a reference whose own error is established:
the best scheme tightened until the number stops moving, checked by a scheme of another family and
in quadruple precision. Shows what accuracy costs, in force evaluations with Jacobian columns and in
seconds, and recommends the cheapest setting whose error is below T, as lines of a scene.

Examples:

  tomlin tradeoff pt.toml --observable driver.mean_force.x --tolerance 1e-4
  tomlin tradeoff pt.toml --observable driver.mean_force.x --set v=1e-3 --write cheap.toml

T is relative to the number itself; where that is zero, as far as the reference knows it, T is in its
unit. The error that a setting is recommended by keeps a fifth below T.

The number is also computed from starts that differ by 1e-12 and 1e-9 of a period: when that moves it
by more than T and than ten times the estimated error of the steps, it is not determined by the
scene; then the digits that are determined are shown, and nothing is recommended for the others.

A run that does not fit into the budget is left out, and listed with how far it got.

DIR then holds
  tradeoff.csv      every point: rung (the method), step or tolerance, value, error, cost
  tradeoff.json     the same with the reference, what was left out and the recommendation

tomlin plot DIR -o tradeoff.svg draws error against cost.

Exit status: 0 done, whatever was found; 1 the results could not be written; 2 the input was not
right, and nothing was written; 130 or 143 after an interrupt.)";

constexpr const char* kCsvFile = "tradeoff.csv";
constexpr const char* kJsonFile = "tradeoff.json";
constexpr std::array kFiles = {kCsvFile, kJsonFile};

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

void add_options(CLI::App& parser, TradeoffArguments& arguments) {
  add_scene_options(parser, arguments);
  add_observable_option(parser, arguments.observable);
  parser.add_option("--tolerance", arguments.tolerance, "error to be met; 1e-3 by default")
      ->type_name("T");
  parser.add_option("--budget", arguments.budget, "time to use; 60 by default")
      ->type_name("SECONDS");
  parser.add_option("--write", arguments.write, "the scene with the recommended lines")
      ->type_name("NEW.toml");
  add_output_option(parser, arguments.folder, "DIR",
                    "folder for the results; SCENE's stem + .tradeoff.out");
  add_force_option(
      parser, arguments.force,
      "DIR need not be empty, and NEW.toml may be there; what tomlin writes is replaced");
}

void check(TradeoffArguments& arguments) {
  refuse_unless_positive(arguments.tolerance, "--tolerance");
  refuse_unless_positive(arguments.budget, "--budget");
  refuse_empty(arguments.write, "--write");
  read_settings(arguments);
}

int measure(const TradeoffArguments& arguments) {
  const SceneDocument document(arguments.scene);
  const Registry registry = registry_with_plugins(arguments.plugins, {&document, 1});
  const auto scene = document.read(registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(default_folder(arguments.scene)),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, kFiles);
  refuse_to_lose_inputs(folder, *scene, kFiles);
  if (arguments.write) check_new_scene(*arguments.write, arguments.scene, arguments.force);
  folder.own();

  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  const Tradeoff tradeoff = measured(scene, registry, arguments, signals);

  folder.write_file(kCsvFile, tradeoff_csv(tradeoff));
  std::string where = (folder.path() / "").string() + ": " + kJsonFile + ", " + kCsvFile;
  folder.write_file(kJsonFile, tradeoff_json(*scene, tradeoff));
  std::string trouble;
  if (arguments.write && tradeoff.recommendation) {
    trouble = write_scene(*arguments.write, document, arguments.scene, arguments.settings, registry,
                          *tradeoff.recommendation);
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

}  // namespace

CommandRecord tradeoff_command() {
  return {"tradeoff", "measure the cost of accuracy and find the cheapest setting", kTradeoffFooter,
          declared<TradeoffArguments>(add_options, check, measure)};
}

}  // namespace tomlin
