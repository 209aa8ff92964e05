#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/cli/build_version.hpp"
#include "framework/cli/command.hpp"
#include "framework/cli/crash_note.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/result_text.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/core/system/thread_team.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/store_file.hpp"
#include "framework/run/results/failure_fault.hpp"
#include "framework/run/run.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/recorded_run.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct RunArguments : SceneOptions {
  std::optional<std::string> folder;
  bool resume = false;
  bool force = false;
  bool quiet = false;
  std::size_t threads = 1;
};

constexpr const char* kRunFooter = R"(
Examples:

  tomlin run pt.toml
      writes to pt.out/ in the current folder.
  tomlin run pt.toml --set v=1e-3 -o slow
      the parameter v has another value; writes to slow/.
  tomlin run pt.toml --set "v=V0/10" --set run.integrator.dt=1e-3 --force
      an expression over [parameters]; a dotted path; pt.out/ may hold an earlier run.

PATH is a parameter's name or a dotted path such as run.duration, body.ring.coordinates or
force.driver.stiffness, with a component's name, or its type where it has none. VALUE is as in a
scene: a number, true, [1.0, 0.0], a word or an expression.

  tomlin run pt.toml --resume
      resumes the run that was stopped in pt.out/, or starts it if there is none.

DIR then holds
  summary.json      mean, static and extreme forces, work, motion of the bodies, warnings
  observables.csv   the samples in time, when the scene has [output] every
  events.csv        slips, turns and the like: when, how large
  scene.toml        the scene with all defaults filled in; running it gives the same bits
and, while the run is going on or after it was stopped, what it can be resumed from
  run.checkpoint    kept every [run] checkpoint_every seconds
  run.journal       all samples and events so far

Ctrl-C ends a run early and leaves what is known so far, with a checkpoint; a second Ctrl-C ends it
at once. A run that was stopped, was killed or ran out of disk space resumes with --resume, from the last
checkpoint to the same bits as one that was left alone. The scene must be the same, and so must the
version of tomlin.

Exit status: 0 done; 1 the run failed numerically (the message says when, where and why) or its
results could not be written; 2 invalid input; nothing was written; 130 or 143 after
an interrupt.)";

constexpr const char* kPluginFooter = R"(
A force that tomlin does not have is compiled into a shared library; tomlin new plugin NAME writes
one to start from. A scene names its libraries above its first [table], relative to its own folder:

  plugins = ["libmorse.so"]

or --plugin does, relative to the current folder. Both load it from there alone. See
also tomlin describe --plugin LIB.)";

std::string folder_of(const RunArguments& arguments) {
  return folder_or_default(arguments.folder, arguments.scene, ".out");
}

void print_error(FaultCode code, const std::string& file, const std::string& why) {
  print_error_line(to_string(Fault(code, {file}, "", "", why)));
}

std::string where_results_are(const RunFolder& folder) {
  std::string files;
  for (const char* name : kFilesOfARun) {
    std::error_code error;
    if (!fs::exists(folder.file(name), error)) continue;
    files += (files.empty() ? "" : ", ") + std::string(name);
  }
  return (folder.path() / "").string() + ": " + (files.empty() ? "nothing" : files);
}

/// A folder may be used as it is, added to, or taken over.
Occupied occupied(const RunArguments& arguments) {
  if (arguments.resume) return Occupied::go_on;
  return arguments.force ? Occupied::replace_results : Occupied::refuse;
}

Resumption resumption(const RunArguments& arguments, const RunFolder& folder, const Scene& scene) {
  if (arguments.resume) return find_resumption(folder, scene, build_version());
  return start_again(folder);
}

/// Before a library is loaded that the run was not begun with.
void require_plugins_of_run(const RunArguments& arguments,
                            const std::vector<PluginRequest>& plugins) {
  std::vector<Library> libraries;
  libraries.reserve(plugins.size());
  for (const PluginRequest& plugin : plugins) {
    libraries.push_back({plugin.given, plugin.path.string(), examine_plugin(plugin.path).hash});
  }
  require_same_libraries(folder_of(arguments), libraries);
}

/// A run that has come to its end already.
int already_over(RunFolder& folder, const Scene& scene, const Resumption& found, bool quiet) {
  if (found.kind == Resumption::Kind::failed) {
    print_error(FaultCode::resume_impossible, scene.file,
                "the run in " + folder.path().string() +
                    " has failed and would fail again: " + found.failure);
    return kExitFailed;
  }
  remove_leftovers(folder);
  if (quiet) return kExitDone;
  return print_result("finished already; nothing to do\n  results  " + where_results_are(folder) +
                      "\n");
}

void add_options(CLI::App& parser, RunArguments& arguments) {
  add_scene_options(parser, arguments);
  add_output_option(parser, arguments.folder, "DIR", "folder for the results; SCENE's stem + .out");
  parser.add_flag("--resume", arguments.resume, "go on with the run that was stopped in DIR");
  parser.add_flag("--force", arguments.force,
                  "DIR need not be empty; only files that tomlin writes are replaced");
  parser.add_flag("--quiet", arguments.quiet, "print errors only");
  parser
      .add_option("--threads", arguments.threads,
                  "that share the evaluations of forces between particles; 1 by default. The "
                  "results are the same")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{4096}));
}

void check(RunArguments& arguments) {
  if (arguments.resume && arguments.force) {
    refuse_command(FaultCode::command_conflict, "--resume continues a run, --force starts it again",
                   "one of them");
  }
}

int run_scene(const RunArguments& arguments) {
  // The scene, then the folder for its results; only then is anything made.
  std::optional<SceneDocument> document(arguments.scene);
  const auto plugins = requested_plugins(arguments.plugins, {&*document, 1});
  if (arguments.resume) require_plugins_of_run(arguments, plugins);
  Registry registry = standard_registry();
  load_plugins(plugins, registry);
  tell_of_plugins_in_a_crash(loaded_plugins());
  const auto scene = document->read(registry, arguments.settings);
  document.reset();  // may be large, and the run long
  RunFolder folder(folder_of(arguments), occupied(arguments));
  refuse_to_lose_inputs(folder, *scene, kFilesOfARun);
  Resumption found = resumption(arguments, folder, *scene);
  if (found.kind == Resumption::Kind::finished || found.kind == Resumption::Kind::failed) {
    return already_over(folder, *scene, found, arguments.quiet);
  }
  folder.own(found.journal);
  note_missing_locks(folder, arguments.quiet);
  StopSignals signals;
  ProgressLine progress(arguments.quiet ? ProgressLine::Style::silent : progress_style(),
                        scene->run.accuracy ? "pilot: looking for the integrator" : "");
  RecordedRunOptions options;
  options.program_version = build_version();
  options.before = arguments.resume ? StoreFile::Before::read : StoreFile::Before::ignore;
  options.stop = &signals.stop();
  const std::unique_ptr<ThreadTeam> team = team_of(arguments.threads);
  if (team) options.team = &team->team();
  options.on_progress = [&progress](const RunProgress& now) { progress.show(now); };
  options.on_trouble = [&signals] { signals.request_stop(); };
  options.on_end = [&progress] { progress.finish(); };
  const RecordedRun run = record_run(folder, scene, registry, std::move(found), options);
  if (run.stopped_before) return kExitSignal + signals.caught();

  int status = kExitDone;
  if (!arguments.quiet) {
    status = print_result(result_text(*scene, run.result, where_results_are(folder)));
  }
  if (run.failure) print_error_line(to_string(fault_of(*run.failure, *run.scene)));
  if (run.trouble) print_error(FaultCode::file_cannot_write, "tomlin", *run.trouble);
  if (run.failure || run.trouble) return kExitFailed;
  if (run.result.status == RunStatus::interrupted) return kExitSignal + signals.caught();
  return status;
}

}  // namespace

CommandRecord run_command() {
  return {"run", "run one scene", std::string(kRunFooter) + "\n" + kPluginFooter,
          declared<RunArguments>(add_options, check, run_scene)};
}

}  // namespace tomlin
