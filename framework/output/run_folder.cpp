#include "framework/output/run_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/journal.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kUsableFolder = "a new or an empty folder";

/// The folder's own fault, or that of what is in it.
[[noreturn]] void refuse_folder(FaultCode code, const fs::path& folder, std::string why,
                                std::string admissible = "") {
  refuse_input(code, "-o", folder.empty() ? "\"\"" : folder.string(), std::move(why),
               std::move(admissible));
}

std::string message(int error) { return std::generic_category().message(error); }

/// 0, or why this process may not make files in the folder.
int reason_not_writable(const fs::path& folder) {
  return ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0 ? 0 : errno;
}

/// The folder above; "." above a plain name.
fs::path above(const fs::path& path) {
  const fs::path parent = path.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// The path as a folder's: without a slash at its end.
fs::path trimmed(const fs::path& path) {
  return path.has_filename() || !path.has_relative_path() ? path : path.parent_path();
}

}  // namespace

RunFolder::RunFolder(const fs::path& folder, Occupied occupied, std::span<const char* const> names)
    : folder_(trimmed(folder)), occupied_(occupied), names_(names.begin(), names.end()) {
  if (folder_.empty()) {
    refuse_folder(FaultCode::command_invalid_value, folder_, "no name for a folder", kUsableFolder);
  }
  std::error_code error;
  const auto status = fs::status(folder_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status)) {
      refuse_folder(FaultCode::file_invalid, folder_, "this exists and is not a folder",
                    kUsableFolder);
    }
    check_folder();
  } else if (status.type() == fs::file_type::not_found) {
    if (fs::is_symlink(fs::symlink_status(folder_, error))) {
      refuse_folder(FaultCode::file_cannot_write, folder_, "a dangling symbolic link",
                    kUsableFolder);
    }
    check_location_for_new();
  } else {
    refuse_folder(FaultCode::file_cannot_write, folder_, error.message());
  }
}

RunFolder::~RunFolder() {
  struct stat status = {};
  if ((only_locked_ || !written_) && lock_.open() && ::fstat(lock_.number(), &status) == 0 &&
      status.st_size == 0 && in_place()) {
    // Results from before the run began are of no use without it.
    for (const char* name : {kStoreFile, kJournalFile}) ::unlink(file(name).c_str());
  }
  lock_file_.release();
  // rmdir takes empty folders only.
  std::for_each(made_.rbegin(), made_.rend(), [](const fs::path& path) { ::rmdir(path.c_str()); });
}

void RunFolder::check_folder() const {
  std::error_code error;
  const fs::directory_iterator content(folder_, error);
  if (error) {
    refuse_folder(FaultCode::file_cannot_read, folder_, "cannot be read: " + error.message());
  }
  if (content != fs::directory_iterator()) check_occupied();
  if (const int reason = reason_not_writable(folder_)) {
    refuse_folder(FaultCode::file_cannot_write, folder_,
                  "cannot be written to: " + message(reason));
  }
  for (const std::string& name : names_) {
    for (const fs::path& path : {file(name), unfinished(file(name))}) {
      if (fs::is_directory(fs::symlink_status(path, error))) {
        refuse_folder(FaultCode::file_cannot_write, path, "a folder where a file is to be written");
      }
    }
  }
}

/// Nothing, or what a program has left that was killed before it had anything to keep.
bool RunFolder::is_unused() const {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    if (entry.path().filename() == kLockFile) continue;
    if (entry.path().filename() != kJournalFile) return false;
    if (!entry.is_regular_file(error) || entry.file_size(error) != 0 || error) return false;
  }
  return !error;
}

void RunFolder::check_occupied() const {
  if (occupied_ == Occupied::replace_results || is_unused()) return;
  if (occupied_ == Occupied::go_on && holds_any_run()) return;
  if (holds(kJournalFile) || holds(kCheckpointFile)) {
    refuse_folder(
        FaultCode::file_exists, folder_, "a run was stopped here",
        "--resume, which continues it, or --force, which starts again; or another folder");
  }
  refuse_folder(FaultCode::file_exists, folder_, "the folder is not empty",
                "a new or an empty folder, or --force, which replaces what an earlier run left");
}

bool RunFolder::holds_any_run() const {
  return std::any_of(names_.begin(), names_.end(), [this](const std::string& name) {
    return holds(name) || holds(unfinished(name).string());
  });
}

bool RunFolder::holds(std::string_view name) const {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file(name), error);
  if (status.type() == fs::file_type::none) {
    refuse_folder(FaultCode::file_cannot_read, file(name), "cannot be read: " + error.message());
  }
  return fs::exists(status);
}

void RunFolder::check_location_for_new() const {
  std::error_code error;
  fs::path ancestor = above(folder_);
  while (!fs::exists(fs::status(ancestor, error)) && ancestor != above(ancestor)) {
    if (error && error != std::errc::no_such_file_or_directory &&
        error != std::errc::not_a_directory) {
      refuse_folder(FaultCode::file_cannot_write, folder_, error.message());
    }
    ancestor = above(ancestor);
  }
  if (!fs::is_directory(fs::status(ancestor, error))) {
    refuse_folder(FaultCode::file_cannot_write, folder_,
                  fmt::format("{} is not a folder", ancestor.string()));
  }
  if (const int reason = reason_not_writable(ancestor)) {
    refuse_folder(FaultCode::file_cannot_write, folder_,
                  fmt::format("cannot be made in {}: {}", ancestor.string(), message(reason)));
  }
}

void RunFolder::create() {
  fs::path path;
  for (const fs::path& part : folder_) {
    path /= part;
    if (::mkdir(path.c_str(), 0777) == 0) {
      made_.push_back(path);
      continue;
    }
    const int reason = errno;
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      refuse_folder(FaultCode::file_cannot_write, folder_, "cannot be made: " + message(reason));
    }
  }
}

Descriptor RunFolder::own_existing_journal() const {
  return own_journal(file(kJournalFile), Absent::leave_it, &lock_file_);
}

fs::path RunFolder::opened() const {
  const fs::path path = fmt::format("/proc/self/fd/{}", descriptor_.number());
  std::error_code error;
  return descriptor_.open() && fs::is_directory(path, error) ? path : folder_;
}

void RunFolder::own(Descriptor& journal) {
  create();
  descriptor_ = Descriptor(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!journal.open()) {
    try {
      journal = own_journal(file(kJournalFile), Absent::make_it, &lock_file_);
    } catch (const JournalInUse& error) {
      refuse_folder(FaultCode::folder_in_use, folder_, error.what(), "another folder");
    } catch (const OutputError& error) {
      refuse_folder(FaultCode::file_cannot_write, folder_, error.what());
    }
    lock_ = Descriptor(::fcntl(journal.number(), F_DUPFD_CLOEXEC, 0));
    look_again();
    return;
  }
  lock_ = Descriptor(::fcntl(journal.number(), F_DUPFD_CLOEXEC, 0));
  if (occupied_ == Occupied::refuse) look_again();
}

void RunFolder::own() {
  Descriptor journal;
  own(journal);
  only_locked_ = true;
}

/// Another program may have come and gone before this one had the folder.
void RunFolder::look_again() const {
  const auto refuse_new = [this] {
    refuse_folder(FaultCode::file_exists, folder_,
                  "another program has written into this folder in the meantime", kUsableFolder);
  };
  if (occupied_ == Occupied::refuse && !is_unused()) refuse_new();
  if (occupied_ != Occupied::go_on) return;
  for (const char* name : kFilesOfARun) {
    if (name != std::string_view(kJournalFile) && name != std::string_view(kSceneFile) &&
        holds(name)) {
      refuse_new();
    }
  }
}

bool RunFolder::in_place() const { return is_at(lock_, file(kJournalFile)); }

void RunFolder::require_in_place() const {
  if (in_place()) return;
  throw OutputError(
      fmt::format("cannot write to {}: it has gone; the folder was removed or replaced during the "
                  "run",
                  folder_.string()));
}

void RunFolder::remove_results() {
  for (const char* name : kResultFiles) remove(name);
  // Unfinished files of a killed run would be in the way of the same files.
  for (const char* name : kFilesOfARun) remove(unfinished(name).string());
}

void RunFolder::remove_run() {
  remove_results();
  for (const char* name : kFilesOfARun) {
    const bool is_own = std::find(names_.begin(), names_.end(), name) != names_.end();
    if (std::string_view(name) != kJournalFile && !is_own) remove(name);
  }
  if (::ftruncate(lock_.number(), 0) != 0) throw OutputError(file(kJournalFile), errno);
}

void RunFolder::remove(std::string_view name) {
  if (lock_.open()) require_in_place();
  if (::unlink(file(name).c_str()) != 0 && errno != ENOENT) {
    throw OutputError(fmt::format("cannot replace {}: {}", file(name).string(), message(errno)));
  }
}

void RunFolder::write_file(std::string_view name, std::string_view text) const {
  OutputFile output(file(name));
  if (lock_.open()) require_in_place();
  output.append(text);
  output.publish();
  written_ = true;
}

}  // namespace tomlin
