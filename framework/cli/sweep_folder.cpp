#include "framework/cli/sweep_folder.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/inputs.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

SweepJournal::Found found_in(const fs::path& folder, const SweepPlan& plan) {
  try {
    return SweepJournal::look(folder / kSweepJournalFile, plan);
  } catch (const DamagedFile& error) {
    refuse_input(FaultCode::file_damaged, "-o", folder.string(), error.what(),
                 "another folder, or --force, which starts again");
  }
}

/// The files that axes name may be what has changed since the sweep was begun.
void refuse_changed_files(const fs::path& folder, const SweepPlan& plan) {
  std::vector<std::string> changed;
  for (const auto& [name, text] : SceneDocument((folder / kSceneFile).string()).files()) {
    const auto now = plan.files().find(name);
    if (now != plan.files().end() && now->second != text) changed.push_back(name);
  }
  if (changed.empty()) return;
  refuse_input(FaultCode::resume_other_scene, "-o", folder.string(),
               fmt::format("files have changed since this sweep was begun: {}", listed(changed)),
               "the files as they were, another folder, or --force, which replaces that sweep");
}

}  // namespace

Occupied occupied_by_sweep(const fs::path& folder, const SweepPlan& plan, bool force) {
  if (force) return Occupied::replace_results;
  std::error_code error;
  if (!fs::exists(folder / kSweepJournalFile, error)) return Occupied::refuse;
  switch (found_in(folder, plan)) {
    case SweepJournal::Found::nothing:
    case SweepJournal::Found::same_sweep:
      return Occupied::go_on;
    case SweepJournal::Found::other_sweep:
      refuse_changed_files(folder, plan);
      refuse_input(FaultCode::resume_other_scene, "-o", folder.string(),
                   "this folder is of another sweep: of another scene, other axes or observables",
                   "another folder, or --force, which replaces that sweep");
    case SweepJournal::Found::other_version:
      refuse_input(FaultCode::resume_other_version, "-o", folder.string(),
                   "the sweep in this folder was begun with another version of tomlin",
                   "that version, another folder, or --force, which starts again");
  }
  return Occupied::refuse;
}

void own_sweep_folder(RunFolder& folder, const SweepPlan& plan, bool force, bool quiet) {
  refuse_to_lose_inputs(folder, plan.scene(), kSweepFiles, plan.scene_text());
  if (force) refuse_to_lose_inputs(folder, plan.scene(), kFilesOfARun);
  folder.own();
  note_missing_locks(folder, quiet);
}

void remove_sweep(RunFolder& folder) {
  folder.remove_run();
  folder.remove(kSweepJournalFile);
  remove_points(folder.opened() / kPointsFolder);
}

bool holds_all_results(const RunFolder& folder) {
  return std::all_of(kSweepFiles.begin(), kSweepFiles.end(),
                     [&folder](const char* name) { return folder.holds(name); });
}

std::string where_the_sweep_is(const RunFolder& folder) {
  std::string files;
  for (const char* name : kSweepFiles) {
    if (folder.holds(name)) files += (files.empty() ? "" : ", ") + std::string(name);
  }
  return (folder.path() / "").string() + ": " + files;
}

void remove_points(const fs::path& folder, bool traces) {
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error))) return;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, error)) entries.push_back(entry.path());
  for (const fs::path& entry : entries) {
    // K/, K.store and K.line, and what a kill has left of the latter two.
    const std::string name = entry.filename().string();
    const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
    const std::string rest = digits == 0 ? "-" : name.substr(digits);
    for (const char* suffix : {kPointSuffix, kLineSuffix}) {
      if (rest == suffix || rest == unfinished(suffix)) fs::remove(entry, error);
    }
    if (!traces || !rest.empty() || !fs::is_directory(fs::symlink_status(entry, error))) continue;
    for (const char* file : kFilesOfARun) fs::remove(entry / file, error);
    fs::remove(entry, error);
  }
  fs::remove(folder, error);  // if it is empty
}

SweepCounts write_sweep_results(const RunFolder& folder, const SweepPlan& plan,
                                const SweepJournal& journal) {
  SweepCounts counts = count_rows(plan, journal);
  folder.require_in_place();
  write_sweep_table(folder.file(kSweepTableFile), plan, journal);
  folder.require_in_place();
  write_sweep_arrays(folder.file(kSweepArraysFile), plan, journal);
  return counts;
}

}  // namespace tomlin
