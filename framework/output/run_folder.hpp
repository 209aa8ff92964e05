#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/output/descriptor.hpp"
#include "framework/output/lock_file.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {

inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kTableFile = "observables.csv";
inline constexpr const char* kEventsFile = "events.csv";
inline constexpr const char* kH5mdFile = "trajectory.h5";
inline constexpr const char* kXyzFile = "trajectory.xyz";
inline constexpr const char* kSceneFile = "scene.toml";
inline constexpr const char* kCheckpointFile = "run.checkpoint";
inline constexpr const char* kJournalFile = "run.journal";
inline constexpr const char* kStoreFile = "run.store";

/// Results of a run, made when it ends. The summary is removed first and written last: if it
/// exists, everything else belongs to it.
inline constexpr std::array kResultFiles = {kSummaryFile, kTableFile, kEventsFile, kH5mdFile,
                                            kXyzFile};

/// Everything that a run leaves in its folder, and so all that --force may replace.
inline constexpr std::array kFilesOfARun = {kSummaryFile,    kTableFile,   kEventsFile,
                                            kH5mdFile,       kXyzFile,     kSceneFile,
                                            kCheckpointFile, kJournalFile, kStoreFile};

/// Treatment of a folder that has something in it.
enum class Occupied {
  refuse,
  replace_results,  ///< replace the files of a run, touch nothing else
  go_on,            ///< use it where there are files of these names, refuse it otherwise
};

/// The folder that a run, or a study, writes its results to. Whoever has the journal in it locked
/// has the folder, a study as well.
class RunFolder {
 public:
  /// Looks, and makes nothing. Throws InputError when the folder cannot be used, or no file be
  /// written under one of these names.
  RunFolder(const std::filesystem::path& folder, Occupied occupied,
            std::span<const char* const> names = kFilesOfARun);
  /// A folder that was made and never written to disappears again, and so does a journal that
  /// nothing was written to.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Makes the folder with all above it. Throws InputError when that fails.
  void create();
  /// Makes the folder, and has it from now on: no other program writes to it meanwhile. `journal`
  /// is its journal, locked, or not open where there is none; then it is made. Throws InputError
  /// when another program has the folder, or has put something there since it was looked at.
  void own(Descriptor& journal);
  /// Owns the folder of a study, whose journal is only a lock: it never outlives the study.
  void own();
  /// Whether the folder that is owned still has its name: it may have been moved away, and another
  /// been made.
  bool in_place() const;
  /// Throws OutputError where it has not.
  void require_in_place() const;
  /// Its journal, with the folder as own() has it: not open where there is none.
  Descriptor own_existing_journal() const;
  /// Whether kLockFile stands for a lock that the file system does not have.
  bool lacks_locks() const { return lock_file_.taken(); }
  /// Takes away what an earlier run has found, and whatever is unfinished. Throws OutputError.
  void remove_results();
  /// Takes away, for a study, all that an earlier run has left but files of the study's own names
  /// and the journal, which is emptied. Throws OutputError.
  void remove_run();
  /// The folder that was opened, whatever it is called by now, where the system has a name for
  /// that.
  std::filesystem::path opened() const;
  /// Takes a file away; it need not be there. Throws OutputError.
  void remove(std::string_view name);
  /// Writes a file whole or not at all. Throws OutputError.
  void write_file(std::string_view name, std::string_view text) const;
  /// Whether there is something of this name. Throws InputError where that cannot be known.
  bool holds(std::string_view name) const;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path file(std::string_view name) const { return folder_ / name; }

 private:
  void check_folder() const;
  void check_occupied() const;
  void check_location_for_new() const;
  void look_again() const;
  bool is_unused() const;
  bool holds_any_run() const;

  std::filesystem::path folder_;
  Occupied occupied_;
  std::vector<std::string> names_;           ///< of files that are to be written
  std::vector<std::filesystem::path> made_;  ///< outermost first
  mutable bool written_ = false;  ///< a file of the run's own, which it says something of
  bool only_locked_ = false;      ///< of a study: nothing is ever written to the journal
  mutable LockFile lock_file_;
  Descriptor descriptor_;  ///< of the folder, once it is owned
  Descriptor lock_;        ///< the journal's, which is locked as long as this is
};

}  // namespace tomlin
