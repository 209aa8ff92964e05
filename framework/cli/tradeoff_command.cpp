#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/tradeoff_scene.hpp"
#include "framework/cli/tradeoff_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

namespace tomlin {
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

void print_note(const std::string& note) { print_error_line("note: " + note); }

Tradeoff measured(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                  const TradeoffArguments& arguments, const StopSignals& signals) {
  using Clock = std::chrono::steady_clock;
  const bool on_terminal = progress_style() == ProgressLine::Style::terminal;
  ProgressLine line(on_terminal ? ProgressLine::Style::terminal : ProgressLine::Style::silent);
  const auto show = [&, started = Clock::now()](const std::string& what) {
    const std::chrono::duration<double> used = Clock::now() - started;
    line.show(fmt::format("{:.0f} of {:g} s, {}", used.count(), arguments.budget, what),
              used.count());
  };
  return measure_tradeoff(
      scene, registry,
      {arguments.observable, arguments.tolerance, arguments.budget, &signals.stop(), show});
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
  parser.add_flag(
      "--force", arguments.force,
      "DIR need not be empty, and NEW.toml may be there; what tomlin writes is replaced");
}

void check(TradeoffArguments& arguments) {
  refuse_unless_positive(arguments.tolerance, "--tolerance");
  refuse_unless_positive(arguments.budget, "--budget");
  refuse_empty(arguments.write, "--write");
}

int measure(const TradeoffArguments& arguments) {
  const OpenedScene opened(arguments);
  const auto& [document, registry, scene] = opened;
  RunFolder folder(folder_or_default(arguments.folder, arguments.scene, ".tradeoff.out"),
                   arguments.force ? Occupied::replace_results : Occupied::refuse, kFiles);
  refuse_to_lose_inputs(folder, *scene, kFiles);
  if (arguments.write) check_new_scene(*arguments.write, arguments.scene, arguments.force);
  folder.own();

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
