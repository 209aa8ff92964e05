#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/result_text.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/core/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/summary.hpp"
#include "framework/output/table.hpp"
#include "framework/run/run.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

/// Passes samples on to the table. When the table cannot take them, the run stops instead of
/// breaking off, so that what is known so far is still written.
class StoppingSink : public RunSink {
 public:
  StoppingSink(TableWriter& table, StopSignals& signals) : table_(table), signals_(signals) {}

  void begin(const RunLayout& layout) override {
    attempt([&] { table_.begin(layout); });
  }
  void sample(const std::vector<double>& values) override {
    attempt([&] { table_.sample(values); });
  }
  const std::optional<std::string>& trouble() const { return trouble_; }

 private:
  template <class Action>
  void attempt(Action action) {
    if (trouble_) return;
    try {
      action();
    } catch (const OutputError& error) {
      trouble_ = error.what();
      signals_.request_stop();
    }
  }

  TableWriter& table_;
  StopSignals& signals_;
  std::optional<std::string> trouble_;
};

std::string default_folder(const std::string& scene_file) {
  return fs::path(scene_file).stem().string() + ".out";
}

/// A scene may be run again in the folder it was found in, but never be replaced by another.
void refuse_to_lose_scene(const RunFolder& folder, const Scene& scene) {
  for (const char* name : kFilesOfARun) {
    std::error_code error;
    if (!fs::equivalent(folder.file(name), scene.file, error)) continue;
    std::ifstream file(scene.file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (name == std::string(kSceneFile) && text == scene.effective_toml) continue;
    Fault fault;
    fault.place.file = "-o";
    fault.key = folder.path().string();
    fault.why = "the results would replace the scene itself";
    fault.admissible = "another folder";
    throw InputError({fault});
  }
}

/// Writes everything; what could not be written, and why, is returned.
std::optional<std::string> write_results(RunFolder& folder, const Scene& scene, TableWriter& table,
                                         std::optional<std::string> trouble, RunResult& result) {
  try {
    folder.remove_earlier_results();
    folder.write_file(kSceneFile, scene.effective_toml);
    if (trouble) {
      table.flush();
    } else {
      table.finish();
    }
  } catch (const OutputError& error) {
    if (!trouble) trouble = error.what();
  }
  if (trouble && !result.failure) {
    RunFailure failure;
    failure.step = result.steps;
    failure.time = result.end_time;
    failure.what = *trouble;
    failure.cause = "the results could not be written";
    result.status = RunStatus::failed;
    result.failure = failure;
  }
  try {
    folder.write_file(kSummaryFile, summary_json(scene, result));
  } catch (const OutputError& error) {
    if (!trouble) trouble = error.what();
  }
  return trouble;
}

void print_error(const std::string& file, const std::string& why) {
  Fault fault;
  fault.place.file = file;
  fault.why = why;
  std::fputs((to_string(fault) + "\n").c_str(), stderr);
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

}  // namespace

int run_command(const RunArguments& arguments) {
  // The scene, then the place for its results; only then is anything made.
  const Registry registry = standard_registry();
  const auto scene = read_scene(arguments.scene, registry, arguments.settings);
  RunFolder folder(arguments.folder.value_or(default_folder(arguments.scene)),
                   arguments.force ? Occupied::replace_results : Occupied::refuse);
  refuse_to_lose_scene(folder, *scene);
  folder.create();

  // A full disk or a reader that went away is an error that is reported, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  StopSignals signals;
  TableWriter table(folder.file(kTableFile));
  StoppingSink sink(table, signals);
  ProgressLine progress(arguments.quiet ? ProgressLine::Style::silent : progress_style());
  RunOptions options;
  options.sink = &sink;
  options.on_progress = [&progress](const RunProgress& now) { progress.show(now); };
  options.stop = &signals.stop();
  RunResult result = run(scene, options);
  progress.finish();

  const auto numerical = result.failure;
  const auto trouble = write_results(folder, *scene, table, sink.trouble(), result);
  int status = kExitDone;
  if (!arguments.quiet) {
    status = print_result(result_text(*scene, result, where_results_are(folder)));
  }
  if (numerical) print_error(scene->file, to_string(*numerical));
  if (trouble) print_error("tomlin", *trouble);
  if (numerical || trouble) return kExitFailed;
  if (result.status == RunStatus::interrupted) return kExitSignal + signals.caught();
  return status;
}

}  // namespace tomlin
