#include <csignal>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/cli/commands.hpp"
#include "framework/cli/crash_note.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/result_text.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/output_size.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/run_recorder.hpp"
#include "framework/output/store_file.hpp"
#include "framework/run/failure_fault.hpp"
#include "framework/run/run.hpp"
#include "framework/run/trial.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/accuracy.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

std::string default_folder(const std::string& scene_file) {
  return fs::path(scene_file).stem().string() + ".out";
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
  if (arguments.resume) return find_resumption(folder, scene, TOMLIN_VERSION);
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
  require_same_libraries(arguments.folder.value_or(default_folder(arguments.scene)), libraries);
}

/// A run that has come to its end already. Killed at the last moment it may have left what it had
/// no use for any more.
int already_over(RunFolder& folder, const Scene& scene, const Resumption& found, bool quiet) {
  if (found.kind == Resumption::Kind::failed) {
    print_error(FaultCode::resume_impossible, scene.file,
                "the run in " + folder.path().string() +
                    " has failed and would fail again: " + found.failure);
    return kExitFailed;
  }
  for (const char* name : {kStoreFile, kCheckpointFile, kJournalFile}) {
    if (folder.holds(name)) folder.remove(name);
  }
  if (quiet) return kExitDone;
  return print_result("finished already; nothing to do\n  results  " + where_results_are(folder) +
                      "\n");
}

}  // namespace

int run_command(const RunArguments& arguments) {
  // The scene, then the place for its results; only then is anything made.
  std::optional<SceneDocument> document(arguments.scene);
  const auto plugins = requested_plugins(arguments.plugins, {&*document, 1});
  if (arguments.resume) require_plugins_of_run(arguments, plugins);
  Registry registry = standard_registry();
  load_plugins(plugins, registry);
  tell_of_plugins_in_a_crash(loaded_plugins());
  const auto scene = document->read(registry, arguments.settings);
  document.reset();  // may be large, and the run long
  RunFolder folder(arguments.folder.value_or(default_folder(arguments.scene)), occupied(arguments));
  refuse_to_lose_inputs(folder, *scene, kFilesOfARun);
  Resumption found = resumption(arguments, folder, *scene);
  if (found.kind == Resumption::Kind::finished || found.kind == Resumption::Kind::failed) {
    return already_over(folder, *scene, found, arguments.quiet);
  }
  folder.own(found.journal);
  StoreFile store(folder, *scene, TOMLIN_VERSION,
                  arguments.resume ? StoreFile::Before::read : StoreFile::Before::ignore);

  // The recorder looks at it when the run begins, which is after the pilot.
  if (scene->run.accuracy) {
    if (const auto layout = layout_of(scene)) {
      require_room(*scene, output_size(*scene, *layout), room_in(folder.path()));
    }
  }

  // A full disk or a reader that went away is an error that is reported, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  ProgressLine progress(arguments.quiet ? ProgressLine::Style::silent : progress_style(),
                        scene->run.accuracy ? "pilot: looking for the integrator" : "");
  // With an accuracy the program looks for the integrator; the same one when a run resumes.
  ChosenIntegrator chosen;
  chosen.scene = scene;
  if (scene->run.accuracy) {
    chosen = choose_integrator(scene, registry, &signals.stop(), kMostPilotWork, &store);
    if (chosen.interrupted) return kExitSignal + signals.caught();
  }
  const std::vector<std::byte> state = std::move(found.state);
  RunOptions options;
  if (found.kind == Resumption::Kind::go_on) options.resume_from = &state;
  RunRecorder recorder(folder, *scene, TOMLIN_VERSION, std::move(found),
                       [&signals] { signals.request_stop(); });
  options.sink = &recorder;
  options.on_progress = [&progress](const RunProgress& now) { progress.show(now); };
  options.stop = &signals.stop();
  options.store = &store;
  RunResult result = run_as_bound(chosen.scene, options);
  progress.finish();
  if (scene->run.accuracy) estimate_errors(chosen, options, result);

  const auto numerical = result.failure;
  const auto trouble = recorder.finish(result);
  int status = kExitDone;
  if (!arguments.quiet) {
    status = print_result(result_text(*scene, result, where_results_are(folder)));
  }
  if (numerical) print_error_line(to_string(fault_of(*numerical, *chosen.scene)));
  if (trouble) print_error(FaultCode::file_cannot_write, "tomlin", *trouble);
  if (numerical || trouble) return kExitFailed;
  if (result.status == RunStatus::interrupted) return kExitSignal + signals.caught();
  return status;
}

}  // namespace tomlin
