#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/build_version.hpp"
#include "framework/cli/command.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/stop_signals.hpp"
#include "framework/cli/sweep_folder.hpp"
#include "framework/cli/sweep_text.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/record.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/merge.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct MergeArguments {
  std::vector<std::string> folders;
  std::optional<std::string> into;
  bool force = false;
  bool quiet = false;
};

constexpr const char* kMergeFooter = R"(
Makes one sweep of the folders that tomlin sweep --shard has left, in any order. They must be of the
same sweep (scene, axes, observables, plugins) and of this version of tomlin. Nothing is run.

Examples:

  tomlin sweep pt.toml --over v=1e-3:1e-1:21:log --observable driver.mean_force.x --shard 1/2
  tomlin sweep pt.toml --over v=1e-3:1e-1:21:log --observable driver.mean_force.x --shard 2/2
  tomlin merge pt.sweep.1-of-2.out pt.sweep.2-of-2.out -o pt.sweep.out

DIR then holds what one sweep of all points leaves, with the same bytes but for performance in
sweep.json. It may hold rows of the same sweep already, as from an earlier merge; the other folders
stay as they are, with their traces. Where points are missing, their number and the first one are
shown and DIR has no tables yet: merge the folders of these points into it later, or run the points
there, by the command of the sweep without --shard and with -o DIR. A merge that was stopped or
killed is continued by the same command.

Two folders with different rows for the same point are refused: the same program gives the same rows.

Exit status: 0 every point has a row; 1 points are missing, or the results could not be written; 2
invalid input; nothing was written; 130 or 143 after an interrupt.)";

void add_options(CLI::App& parser, MergeArguments& arguments) {
  parser.add_option("DIR", arguments.folders, "the folders of the shards")
      ->option_text("...")
      ->required();
  add_output_option(parser, arguments.into, "DIR", "folder for the results")->required();
  parser.add_flag("--force", arguments.force,
                  "start over in DIR; only files that tomlin writes are replaced");
  parser.add_flag("--quiet", arguments.quiet, "print errors only");
}

bool is_same_folder(const fs::path& one, const fs::path& other) {
  std::error_code error;
  return fs::equivalent(one, other, error);
}

void check(MergeArguments& arguments) {
  for (const std::string& folder : arguments.folders) {
    if (arguments.force && is_same_folder(folder, *arguments.into)) {
      refuse_command(FaultCode::command_conflict,
                     fmt::format("--force would remove the rows of {}", folder),
                     "another folder for -o, or no --force, which keeps them");
    }
  }
}

SweepPlan plan_in(const fs::path& folder, Registry& registry) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    refuse_input(FaultCode::file_invalid, folder.string(), "", "is not the folder of a sweep",
                 "the folders that tomlin sweep --shard has left");
  }
  const std::string file = (folder / kSceneFile).string();
  SceneDocument document(file);
  registry = registry_with_plugins({}, {&document, 1});
  std::vector<Fault> faults;
  std::optional<SweepSettings> settings = document.sweep(faults);
  if (!settings) {
    if (!faults.empty()) throw InputError(std::move(faults));
    refuse_input(FaultCode::file_invalid, file, "", "a scene without [sweep]",
                 "the folder of a sweep");
  }
  if (settings->refine.what) {
    refuse_input(FaultCode::command_conflict, file, "sweep.refine",
                 "a sweep that is refined has no shards", "folders of --shard I/N");
  }
  return SweepPlan(std::move(document), registry, {}, *std::move(settings), build_version(),
                   std::move(faults));
}

/// Why the journal of a folder cannot be merged; nothing where it can.
std::optional<Fault> fault_of(const fs::path& folder, const fs::path& first,
                              const SweepPlan& plan) {
  const SourceLocation location{folder.string()};
  try {
    switch (SweepJournal::look(folder / kSweepJournalFile, plan)) {
      case SweepJournal::Found::same_sweep:
        return std::nullopt;
      case SweepJournal::Found::nothing:
        return Fault(FaultCode::file_invalid, location, "", "",
                     fmt::format("there is no {}, or it cannot be read", kSweepJournalFile),
                     "the folder of a shard");
      case SweepJournal::Found::other_version:
        return Fault(FaultCode::resume_other_version, location, "", "",
                     "this sweep was made by another version of tomlin", "that version");
      case SweepJournal::Found::other_sweep:
        return Fault(FaultCode::resume_other_scene, location, "", "",
                     folder == first
                         ? "scene.toml, or a plugin that it names, is not that of the rows"
                         : fmt::format("the rows are of another sweep than {}", first.string()),
                     "folders of one sweep: the same scene, plugins, axes and observables");
    }
  } catch (const DamagedFile& error) {
    return Fault(FaultCode::file_damaged, location, "", "", error.what(),
                 "the other folders; sweep then runs the points of this one again");
  }
  return std::nullopt;
}

/// The journals of these folders, which must be of the sweep.
std::deque<SweepJournal> journals_in(const std::vector<std::string>& folders,
                                     const SweepPlan& plan) {
  std::vector<Fault> faults;
  for (const std::string& folder : folders) {
    if (auto fault = fault_of(folder, folders.front(), plan)) faults.push_back(*std::move(fault));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  std::deque<SweepJournal> journals;
  for (const std::string& folder : folders) {
    journals.emplace_back(fs::path(folder) / kSweepJournalFile, plan, SweepJournal::Use::read);
  }
  return journals;
}

void refuse_conflicts(const SweepPlan& plan, const std::deque<SweepJournal>& journals,
                      const std::vector<std::string>& folders) {
  const auto conflict = find_conflict(plan, journals);
  if (!conflict) return;
  refuse_input(FaultCode::file_damaged, folders[conflict->other], "",
               fmt::format("its row of point {} is not that of {}: {}", conflict->point,
                           folders[conflict->one], conflict->what),
               "one of the two folders, without the other");
}

std::size_t first_without_row(const SweepPlan& plan, const SweepJournal& journal) {
  std::size_t point = 0;
  while (point < plan.points() && journal.has(point)) ++point;
  return point;
}

int merge_into(const fs::path& path, const SweepPlan& plan,
               const std::deque<SweepJournal>& journals, const MergeArguments& arguments) {
  RunFolder folder(path, occupied_by_sweep(path, plan, arguments.force), kSweepFiles);
  own_sweep_folder(folder, plan, arguments.force, arguments.quiet);
  const StopSignals signals;
  if (arguments.force) remove_sweep(folder);
  for (const char* name : kSweepResults) folder.remove(name);
  folder.require_in_place();
  RecordedSweep merged;
  merged.progress.points = plan.points();
  {
    // The journal comes first: whatever else is there, the rows so far are merged again from it.
    SweepJournal journal(folder.file(kSweepJournalFile), plan);
    folder.write_file(kSceneFile, plan.scene_text());
    merge_rows(plan, journals, journal, signals.stop());
  }
  if (signals.stop()) return kExitSignal + signals.caught();
  // The merged journal has been written and can be read.
  SweepJournal journal(folder.file(kSweepJournalFile), plan);
  for (std::size_t k = 0; k < plan.points(); ++k) merged.progress.before += journal.has(k) ? 1 : 0;
  if (merged.progress.complete()) merged.counts = write_sweep_results(folder, plan, journal);
  folder.write_file(kSweepSummaryFile, sweep_json(plan, merged, 1));
  if (merged.counts) journal.complete(merged.counts->status());
  int status = kExitDone;
  if (!arguments.quiet) {
    status = print_result(
        merge_text(plan, merged, first_without_row(plan, journal), where_the_sweep_is(folder)));
  }
  return merged.counts ? status : kExitFailed;
}

int merge(const MergeArguments& arguments) {
  Registry registry;
  const SweepPlan plan = plan_in(arguments.folders.front(), registry);
  std::vector<std::string> folders = arguments.folders;
  // Rows that are there already are compared like the others.
  const std::string& into = *arguments.into;
  if (!arguments.force && occupied_by_sweep(into, plan, false) == Occupied::go_on) {
    const std::optional<Fault> fault = fault_of(into, into, plan);
    if (fault && fault->code == FaultCode::file_damaged) throw InputError({*fault});
    if (!fault) folders.push_back(into);
  }
  try {
    const std::deque<SweepJournal> journals = journals_in(folders, plan);
    refuse_conflicts(plan, journals, folders);
    return merge_into(into, plan, journals, arguments);
  } catch (const DamagedFile& error) {
    refuse_input(FaultCode::file_damaged, "tomlin", "", error.what(), "a journal that is complete");
  }
}

}  // namespace

CommandRecord merge_command() {
  return {"merge", "the shards of a sweep into one", kMergeFooter,
          declared<MergeArguments>(add_options, check, merge)};
}

}  // namespace tomlin
