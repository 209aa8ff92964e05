#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/build_version.hpp"
#include "framework/cli/command.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/recorded_sweep.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/sweep_folder.hpp"
#include "framework/cli/sweep_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/scene/text.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct SweepArguments : SceneOptions {
  std::vector<std::string> over;
  std::vector<std::string> zips;
  std::vector<std::string> observables;
  std::optional<std::string> folder;
  std::size_t threads = 0;  ///< 0: one for each processor
  std::optional<std::string> trace;
  bool continues = false;
  std::optional<std::string> repeats;
  std::optional<std::string> refine;
  std::optional<std::string> refine_along;
  std::optional<std::string> refine_to;
  std::optional<std::string> shard;
  bool dry_run = false;
  bool force = false;
  bool quiet = false;
};

constexpr const char* kSweepFooter = R"(
Runs the scene once for every combination of the values, in one process, and writes a table: a row
for each point with the values, the observables and how the run ended. The last axis runs fastest.

  --over v=1e-3,1e-2           a list; values as in --set, also words, lists and expressions
  --over k=1:5:9               9 values from 1 to 5, equally spaced
  --over v=1e-4:1e-1:31:log    31 values, equally spaced in the logarithm
  --zip k,v                    these axes take their values together, and are one axis

NAME is a parameter or a dotted path, as in --set. The ends of a grid are exact; the values between
them are the doubles nearest to those of the formulas, on every machine.

Examples:

  tomlin sweep pt.toml --over v=1e-3:1e-1:21:log --observable driver.mean_force.x
  tomlin sweep pt.toml --over v=1e-3,1e-2 --over run.integrator.dt=1e-2,5e-3 \
      --observable driver.mean_force.x --observable events.slips --threads 2

With --continue-from-neighbour a point starts where the one before it along the last axis has ended,
as in a measurement that goes up and down:

  tomlin sweep pt.toml --over F=0.1,0.4,0.7,0.4,0.1 --continue-from-neighbour \
      --observable tip.mean_velocity.x

The first value of that axis starts from the scene's start, each next one with the positions,
velocities and internal variables that the one before has ended with, and its drivers where they
were, at the velocities that the scene now gives them. Time, window and integrals begin at 0, and
reversals anew. A point whose neighbour has not finished is refused.

With --refine the sweep adds points to those of its axes, by bisection along one of them, the last
one unless --refine-along names another:

  tomlin sweep pt.toml --over k=1:5:9 --refine events.slips=0.5
  tomlin sweep pt.toml --over k=1:5:9 --refine driver.mean_force.x --refine-to 1e-3

With a level, between any two neighbours of which one is below the level and the other one is not;
without a level, where the observable changes most between neighbours, for each combination of the
other axes. There it is followed as long as the difference stays above half of what it was: else
there is no jump, and sweep.json has the status "smooth" for it. Bisection ends when the interval is
not wider than --refine-to, 1e-4 of the axis by default; on a logarithmic axis middle and width are
those of the logarithm. sweep.json has each interval with the observable at both of its ends.

With --repeats each point is run several times with independent noise, of the streams 0, 1, ... of
the scene's seed, which become the first axis, run.stream:

  tomlin sweep thermal.toml --over v=1e-3:1:7:log --repeats 16 --observable driver.mean_force.x

A scene may have the same in a table, which these options replace:

  [sweep]
  over = { v = "1e-3:1e-1:21:log", "run.integrator.dt" = [1e-2, 5e-3] }
  observables = ["driver.mean_force.x"]

A row has the bits of tomlin run with the same --set, unless it continues from another one. A point
that the scene refuses, or that fails, is a row with its reason. DIR then holds
  sweep.csv       a row for each point
  sweep.h5        the same as arrays over the axes, netCDF-4: xarray.open_dataset opens it; with
                  --refine over the points, which are no grid
  sweep.json      axes, observables, counts, warnings, intervals of --refine
  scene.toml      the scene with all defaults and [sweep]
  sweep.journal   a record for each point that has ended
  sweep.points/   the results of tomlin run for the rows of --trace (0,5-7, or all); while the sweep
                  goes on, checkpoints of points that take longer than [run] checkpoint_every, and
                  ends of points that others continue from

Several machines can share a sweep. --shard I/N, I from 1 to N, runs one of every N successive points
in a folder of its own, and tomlin merge makes one sweep of the folders:

  tomlin sweep pt.toml --shard "$SLURM_ARRAY_TASK_ID/10"        # of an array job, 1-10
  tomlin merge pt.sweep.*-of-10.out -o pt.sweep.out

Processes on several machines that share one sweep and one folder are started from Python:
tomlin.sweep(..., executor=E) takes any executor of concurrent.futures, such as that of mpi4py.

Ctrl-C ends a sweep early. A sweep that was stopped or killed is continued by the same command:
points with a row are not run again, those with a checkpoint resume from it, and the results have the
bytes of a sweep that was left alone.

Exit status: 0 every point has a row; 1 the results could not be written, or every point was refused;
2 invalid input; nothing was written; 130 or 143 after an interrupt.)";

void add_options(CLI::App& parser, SweepArguments& arguments) {
  add_scene_options(parser, arguments);
  add_repeatable_option(parser, "--over", arguments.over, "NAME=VALUES",
                        "an axis: a name and its values");
  add_repeatable_option(parser, "--zip", arguments.zips, "NAME,NAME",
                        "axes that are one axis together");
  parser.add_flag("--continue-from-neighbour", arguments.continues,
                  "each point starts where the one before it along the last axis has ended");
  parser
      .add_option("--repeats", arguments.repeats,
                  "run each point so many times, with independent noise")
      ->type_name("N");
  parser
      .add_option("--refine", arguments.refine,
                  "add points where this observable crosses LEVEL, or else where it jumps")
      ->type_name("O[=LEVEL]");
  parser.add_option("--refine-along", arguments.refine_along, "the axis; the last one by default")
      ->type_name("NAME");
  parser
      .add_option("--refine-to", arguments.refine_to,
                  "how narrow an interval becomes; 1e-4 of the axis by default")
      ->type_name("WIDTH");
  add_repeatable_option(parser, "--observable", arguments.observables, "O",
                        "a dotted path in summary.json");
  add_output_option(parser, arguments.folder, "DIR",
                    "folder for the results; SCENE's stem + .sweep.out, or .sweep.I-of-N.out");
  parser.add_option("--threads", arguments.threads, "how many; one for each processor by default")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{4096}));
  parser
      .add_option("--trace", arguments.trace, "rows, counted from 0, whose full results are kept")
      ->type_name("ROWS");
  parser
      .add_option("--shard", arguments.shard,
                  "run this part only of N, I = 1 to N; for tomlin merge")
      ->type_name("I/N");
  parser.add_flag("--dry-run", arguments.dry_run,
                  "only show how many points there are and what they cost");
  parser.add_flag("--force", arguments.force,
                  "start over in DIR; only files that tomlin writes are replaced");
  parser.add_flag("--quiet", arguments.quiet, "print errors only");
}

/// Reads what the options say of axes; adds a fault for each that says nothing.
void read_axes(const std::vector<std::string>& options, SweepSettings& settings,
               std::vector<Fault>& faults) {
  const SourceLocation location{"--over"};
  settings.over.clear();
  settings.unread.clear();
  for (const std::string& option : options) {
    const std::size_t equals = option.find('=');
    const std::string name = option.substr(0, equals);
    if (equals == std::string::npos || name.empty()) {
      settings.unread.push_back(name);
      faults.emplace_back(FaultCode::command_missing_argument, location,
                          option.empty() ? "\"\"" : shortened(option, kLongestShownValue), "",
                          equals == std::string::npos ? "no values" : "no name", "NAME=VALUES");
      continue;
    }
    if (option.find(';') != std::string::npos &&
        option.find('=', equals + 1) != std::string::npos) {
      settings.unread.push_back(name);
      faults.emplace_back(FaultCode::command_invalid_value, location,
                          shortened(option, kLongestShownValue), "", "several axes in one option",
                          "another --over for each axis");
      continue;
    }
    add_axis(settings, name, option.substr(equals + 1), location, faults);
  }
}

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names(1);
  for (const char c : text) {
    if (c == ',') {
      names.emplace_back();
    } else if (c != ' ') {
      names.back() += c;
    }
  }
  return names;
}

/// `[sweep]` of the scene with what the options replace. Axes are replaced together, zips with
/// them.
SweepSettings settings_of(const SceneDocument& document, const SweepArguments& arguments,
                          std::vector<Fault>& faults) {
  SweepSettings settings = document.sweep(faults).value_or(SweepSettings{});
  if (!arguments.over.empty()) {
    read_axes(arguments.over, settings, faults);
    settings.zips.clear();
  }
  if (!arguments.zips.empty()) {
    settings.zips.clear();
    for (const std::string& zip : arguments.zips) {
      settings.zips.push_back({names_in(zip), SourceLocation{"--zip"}});
    }
  }
  settings.continues = settings.continues || arguments.continues;
  if (arguments.repeats) settings.repeats = {*arguments.repeats, SourceLocation{"--repeats"}, ""};
  add_repeats(settings, faults);
  for (const auto& [given, option, into] :
       {std::tuple{&arguments.refine, "--refine", &settings.refine.what},
        std::tuple{&arguments.refine_along, "--refine-along", &settings.refine.along},
        std::tuple{&arguments.refine_to, "--refine-to", &settings.refine.to}}) {
    if (*given) *into = {**given, SourceLocation{option}, ""};
  }
  if (!arguments.observables.empty()) {
    settings.observables = arguments.observables;
    settings.observables_location = SourceLocation{"--observable"};
  }
  const auto missing = [&faults](const char* what, const char* admissible) {
    faults.emplace_back(FaultCode::command_missing_argument, SourceLocation{"tomlin"}, "", "", what,
                        admissible);
  };
  if (settings.over.empty() && settings.unread.empty()) {
    missing("nothing to sweep over", "--over NAME=VALUES, or over in [sweep] of the scene");
  }
  const auto of_observables = [](const Fault& fault) { return fault.key == "sweep.observables"; };
  if (settings.observables.empty() && !settings.refine.what &&
      std::none_of(faults.begin(), faults.end(), of_observables)) {
    missing("no observable",
            "--observable O, a dotted path in summary.json, or observables in [sweep]");
  }
  return settings;
}

std::optional<std::size_t> whole_number(std::string_view digits) {
  std::size_t value = 0;
  const char* const last = digits.data() + digits.size();
  const auto [end, error] = std::from_chars(digits.data(), last, value);
  return error == std::errc() && end == last ? std::optional(value) : std::nullopt;
}

/// "all", or rows and ranges of them: "0,5-7". Adds a fault for what is neither.
std::vector<std::size_t> rows_in(const std::string& text, std::size_t points,
                                 std::vector<Fault>& faults) {
  std::vector<std::size_t> rows;
  const auto number = [points](std::string_view digits) {
    const auto row = whole_number(digits);
    return row && *row < points ? row : std::nullopt;
  };
  for (const std::string& part : names_in(text)) {
    const std::size_t dash = part.find('-');
    const auto first = part == "all" ? 0 : number(part.substr(0, dash));
    const auto last = part == "all"               ? points - 1
                      : dash == std::string::npos ? first
                                                  : number(part.substr(dash + 1));
    if (!first || !last || *first > *last) {
      faults.emplace_back(FaultCode::command_invalid_value, SourceLocation{"--trace"}, "",
                          shortened(part, kLongestShownValue), "no row of this sweep",
                          fmt::format("all, or rows from 0 to {}: 0,5-7", points - 1));
      continue;
    }
    for (std::size_t row = *first; row <= *last; ++row) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

/// "2/10": the second of ten parts. Adds a fault for anything else.
std::optional<SweepPart> shard_of(const std::string& text, const SweepPlan& plan,
                                  std::vector<Fault>& faults) {
  const auto number = [](std::string_view digits) {
    const std::size_t value = whole_number(digits).value_or(0);
    return value <= kMostSweepPoints ? value : 0;
  };
  const std::string_view view = text;
  const std::size_t slash = std::min(view.find('/'), view.size());
  const std::size_t shard = number(view.substr(0, slash));
  const std::size_t shards = number(view.substr(std::min(slash + 1, view.size())));
  if (shard >= 1 && shard <= shards) return SweepPart{shard - 1, shards, plan.line()};
  faults.emplace_back(
      FaultCode::command_invalid_value, SourceLocation{"--shard"},
      shortened(text, kLongestShownValue), "", "not one of several parts",
      fmt::format("I/N with I from 1 to N, at most {}: 1/4, 2/4, 3/4, 4/4", kMostSweepPoints));
  return std::nullopt;
}

SweepPlan plan_of(SceneDocument document, const Registry& registry,
                  const SweepArguments& arguments) {
  std::vector<Fault> faults;
  SweepSettings settings = settings_of(document, arguments, faults);
  return SweepPlan(std::move(document), registry, arguments.settings, std::move(settings),
                   build_version(), std::move(faults));
}

/// An axis whose values have independent noise each.
bool is_stream(const SweepAxis& axis) {
  if (axis.name != "run.stream" && axis.name != "run.seed") return false;
  std::vector<std::string> values;
  for (std::size_t k = 0; k < axis.values.size(); ++k) values.push_back(axis.values.plain_text(k));
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) == values.end();
}

/// The sweep that the scene and the options describe.
struct RequestedSweep {
  /// Throws InputError.
  explicit RequestedSweep(const SweepArguments& arguments)
      : RequestedSweep(arguments, SceneDocument(arguments.scene)) {}
  RequestedSweep(const SweepArguments& arguments, SceneDocument document)
      : registry(registry_with_plugins(arguments.plugins, {&document, 1})),
        plan(plan_of(std::move(document), registry, arguments)) {
    std::vector<Fault> faults;
    if (arguments.trace) traced = rows_in(*arguments.trace, plan.points(), faults);
    if (arguments.shard) shard = shard_of(*arguments.shard, plan, faults);
    for (const SweepAxis& axis : plan.axes()) {
      if (axis.name != "run.stream" || plan.is_random_somewhere()) continue;
      const bool repeats = arguments.repeats && axis.location.file == "--repeats";
      faults.emplace_back(FaultCode::command_conflict, axis.location,
                          repeats ? "repeats" : axis.name,
                          repeats ? *arguments.repeats : axis.shown,
                          "the scene has no noise: all repeats would be equal",
                          "a force with noise, such as langevin, or a start_temperature");
    }
    const std::vector<std::size_t>& last = plan.dimensions().back().axes;
    const bool other_streams = std::any_of(last.begin(), last.end(), [this](std::size_t axis) {
      return is_stream(plan.axes()[axis]);
    });
    if (plan.line() > 1 && plan.has_noise_somewhere() && !other_streams) {
      faults.emplace_back(FaultCode::command_conflict, SourceLocation{"--continue-from-neighbour"},
                          "", "",
                          "each point would have the noise of the one that it continues from",
                          "another run.stream at each point: an axis, zipped with the last one");
    }
    if (arguments.trace && plan.line() > 1) {
      faults.emplace_back(FaultCode::command_conflict, SourceLocation{"--trace"}, "", "",
                          "a point that continues from its neighbour is no run of its own",
                          "no --continue-from-neighbour beside it");
    }
    for (const auto& [option, is_given] : {std::pair{"--trace", arguments.trace.has_value()},
                                           std::pair{"--shard", arguments.shard.has_value()}}) {
      if (!is_given || !plan.refinement()) continue;
      faults.emplace_back(FaultCode::command_conflict, SourceLocation{option}, "", "",
                          "a sweep that is refined has more rows than its axes, and not known ones",
                          "no refine beside it");
    }
    if (!faults.empty()) throw InputError(std::move(faults));
    part = shard.value_or(SweepPart{});
    std::erase_if(traced, [this](std::size_t point) { return !part.has(point); });
    const std::string suffix =
        shard ? fmt::format(".sweep.{}-of-{}.out", shard->index + 1, shard->of) : ".sweep.out";
    path = folder_or_default(arguments.folder, arguments.scene, suffix);
  }
  RequestedSweep(const RequestedSweep&) = delete;
  RequestedSweep& operator=(const RequestedSweep&) = delete;

  Registry registry;
  SweepPlan plan;
  std::vector<std::size_t> traced;
  std::optional<SweepPart> shard;
  SweepPart part;
  fs::path path;
};

int sweep(const SweepArguments& arguments) {
  RequestedSweep requested(arguments);
  SweepPlan& plan = requested.plan;
  const std::size_t all = std::max<std::size_t>(1, std::thread::hardware_concurrency());
  const std::size_t threads = arguments.threads > 0 ? arguments.threads : all;
  if (arguments.dry_run) {
    return print_result(sweep_plan_text(plan, threads, requested.shard));
  }

  const fs::path& path = requested.path;
  RunFolder folder(path, occupied_by_sweep(path, plan, arguments.force), kSweepFiles);
  own_sweep_folder(folder, plan, arguments.force, arguments.quiet);
  StopSignals signals;
  ProgressLine progress_line(arguments.quiet ? ProgressLine::Style::silent : progress_style());
  RecordedSweepOptions options;
  options.threads = threads;
  options.shard = requested.shard;
  options.traced = requested.traced;
  options.begins_anew = arguments.force;
  options.stop = &signals.stop();
  options.on_progress = [&progress_line](const SweepProgress& now) {
    progress_line.show(sweep_progress_text(now), now.seconds);
  };
  const RecordedSweep run = record_sweep(folder, plan, options);
  progress_line.finish();
  int status = run.status == SweepStatus::refused ? kExitFailed : kExitDone;
  if (run.over_before) {
    if (arguments.quiet) return status;
    return std::max(status, print_result("finished already; nothing to do\n  results  " +
                                         where_the_sweep_is(folder) + "\n"));
  }
  if (!arguments.quiet) {
    status = std::max(status, print_result(sweep_text(plan, run, where_the_sweep_is(folder))));
  }
  const bool is_done = run.counts && run.progress.traces_left == 0;
  if (is_done) return status;
  return kExitSignal + signals.caught();
}

}  // namespace

CommandRecord sweep_command() {
  return {"sweep", "many runs over values of parameters", kSweepFooter,
          declared<SweepArguments>(add_options, nullptr, sweep)};
}

}  // namespace tomlin
