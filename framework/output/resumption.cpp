#include "framework/output/resumption.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/text/text_file.hpp"
#include "framework/output/checkpoint.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kStartAgain = "--force, which starts again from the beginning";

[[noreturn]] void refuse(FaultCode code, const fs::path& what, std::string why,
                         std::string admissible = "") {
  refuse_input(code, "--resume", what.string(), std::move(why),
               admissible.empty() ? kStartAgain : std::move(admissible));
}

/// Refuses a damaged file: its message names it already.
[[noreturn]] void refuse(const DamagedFile& damage) {
  refuse_input(FaultCode::file_damaged, "--resume", "", damage.what(), kStartAgain);
}

/// Takes the first line off.
std::string_view next_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// "line 7 was `dt = 0.01` and is `dt = 0.02`"
std::string first_difference(std::string_view before, std::string_view now) {
  std::size_t line = 0;
  std::string_view was;
  std::string_view is;
  do {
    was = next_line(before);
    is = next_line(now);
    ++line;
  } while (was == is && !(before.empty() && now.empty()));
  const auto shown = [](std::string_view text) {
    constexpr std::size_t kShown = 200;
    if (text.empty()) return std::string("absent");
    if (text.size() <= kShown) return fmt::format("\"{}\"", text);
    return fmt::format("\"{}...\"", text.substr(0, kShown));
  };
  return fmt::format("line {} of the effective scene was {} and is {}", line, shown(was),
                     shown(is));
}

void require_same_scene(const fs::path& file, std::string_view before, const Scene& scene) {
  const std::string was = without_plugin_paths(before);
  const std::string is = without_plugin_paths(scene.effective_toml);
  if (was == is) return;
  refuse(FaultCode::resume_other_scene, file,
         "the run was of another scene: " + first_difference(was, is),
         "the scene as it was, another folder, or --force, which starts again from the beginning");
}

/// All of a text file; what cannot be read is refused.
std::string text_of(const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  TextFile file = read_text_file(path, error ? 0 : static_cast<std::size_t>(size));
  if (file.too_large) file.why = "the file is changing while it is read";
  if (!file.why.empty()) refuse(FaultCode::file_cannot_read, path, file.why);
  return std::move(file.text);
}

/// scene.toml, where it is there, is the scene that the run is of.
void require_same_scene_file(const RunFolder& folder, const Scene& scene) {
  if (!folder.holds(kSceneFile)) return;
  const fs::path path = folder.file(kSceneFile);
  require_same_scene(path, text_of(path), scene);
}

/// Entries of the summary that matter here.
struct Ended {
  std::optional<RunStatus> status;  ///< nothing: there is no summary
  std::string failure;
  std::vector<Checkpoint::Plugin> plugins;
};

std::string text_at(const nlohmann::json& object, const char* key) {
  if (!object.is_object()) return "";
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

Ended read_summary(const fs::path& path) {
  const auto summary = nlohmann::json::parse(text_of(path), nullptr, false);
  Ended ended;
  ended.status = value_named<RunStatus>(text_at(summary, "status"));
  if (!ended.status) {
    refuse(FaultCode::file_damaged, path, "not a file that a run has written");
  }
  if (summary.contains("failure")) ended.failure = text_at(summary["failure"], "what");
  if (!summary.contains("plugins")) return ended;
  for (const auto& plugin : summary["plugins"]) {
    ended.plugins.push_back({text_at(plugin, "path"), text_at(plugin, "xxh3_128")});
  }
  return ended;
}

Ended read_summary(const RunFolder& folder) {
  return folder.holds(kSummaryFile) ? read_summary(folder.file(kSummaryFile)) : Ended();
}

/// A sink that ignores what it gets: the reader counts.
class Ignored : public RunSink {
 public:
  void begin(const RunLayout& layout) override { (void)layout; }
  void sample(const std::vector<double>& row) override { (void)row; }
};

/// A journal without a checkpoint is that of a run which was killed before it kept any; then it
/// holds no more than the start.
Resumption without_checkpoint(const RunFolder& folder, JournalReader& journal, Descriptor owned,
                              const Ended& ended) {
  Ignored ignored;
  try {
    journal.play(ignored);
  } catch (const TruncatedFile&) {
    // The rest was being written when the run was killed.
  }
  const JournalMark mark = journal.mark();
  if (ended.status == RunStatus::interrupted) {
    refuse(FaultCode::resume_impossible, folder.file(kCheckpointFile),
           "the checkpoint is missing, although the run was stopped with one");
  }
  if (mark.rows > 1 || mark.events > 0) {
    refuse(
        FaultCode::resume_impossible, folder.file(kCheckpointFile),
        fmt::format("the checkpoint is missing, although the journal has {} samples and {} events",
                    mark.rows, mark.events));
  }
  Resumption resumption;
  resumption.journal = std::move(owned);
  return resumption;
}

/// "/home/me/libmorse.so with the content 0123..."
std::string shown(const std::string& path, const std::string& hash) {
  if (hash.empty()) return path + ", which cannot be read";
  return path + " with the content " + hash;
}

/// The plugins that `file` says a run was begun with and those that it would go on with: of the
/// same content, wherever they lie, whoever named them first and how often.
void require_same(const fs::path& file, const std::vector<Checkpoint::Plugin>& recorded,
                  const std::vector<Library>& libraries) {
  std::map<std::string, std::string> before;  // what is shown, by content
  std::map<std::string, std::string> now;
  for (const Checkpoint::Plugin& plugin : recorded) {
    before.emplace(plugin.hash, shown(plugin.path, plugin.hash));
  }
  for (const Library& library : libraries) {
    now.emplace(library.hash, shown(library.path, library.hash));
  }
  const auto same = [](const auto& one, const auto& other) { return one.first == other.first; };
  const bool readable = !now.contains("");
  if (readable && std::equal(before.begin(), before.end(), now.begin(), now.end(), same)) return;
  const auto listed = [](const std::map<std::string, std::string>& all) {
    std::string text;
    for (const auto& [hash, what] : all) text += (text.empty() ? "" : "; ") + what;
    return text.empty() ? "none" : text;
  };
  refuse(
      FaultCode::resume_other_version, file,
      fmt::format("the run was begun with other plugins: {}; now: {}", listed(before), listed(now)),
      "the plugins as they were, or --force, which starts again from the beginning");
}

Resumption with_checkpoint(const RunFolder& folder, JournalReader& journal, Descriptor owned,
                           const Scene& scene, const std::string& program_version) {
  const fs::path path = folder.file(kCheckpointFile);
  Checkpoint checkpoint = read_checkpoint(path);
  if (checkpoint.program_version != program_version) {
    refuse(FaultCode::resume_other_version, path,
           fmt::format("written by version {} of tomlin; this is version {}",
                       checkpoint.program_version, program_version));
  }
  if (checkpoint.scene != scene_fingerprint(scene.effective_toml)) {
    refuse(FaultCode::resume_other_scene, path,
           "belongs to another scene than the journal beside it");
  }
  require_same(path, checkpoint.plugins, scene.libraries);
  const fs::path journal_path = folder.file(kJournalFile);
  if (journal.size() < checkpoint.journal.bytes) {
    refuse(FaultCode::file_damaged, journal_path,
           fmt::format("truncated: it has {} bytes, the checkpoint was kept after {}",
                       journal.size(), checkpoint.journal.bytes));
  }
  Ignored ignored;
  journal.play(ignored, checkpoint.journal.bytes);
  if (journal.mark() != checkpoint.journal) {
    refuse(FaultCode::resume_other_scene, journal_path,
           "not the journal that the checkpoint beside it belongs to");
  }
  Resumption resumption;
  resumption.kind = Resumption::Kind::go_on;
  resumption.journal = std::move(owned);
  resumption.mark = checkpoint.journal;
  resumption.layout = journal.header().layout;
  resumption.state = std::move(checkpoint.state);
  return resumption;
}

Resumption from_journal(const RunFolder& folder, const Scene& scene,
                        const std::string& program_version, Descriptor owned, const Ended& ended) {
  const bool has_checkpoint = folder.holds(kCheckpointFile);
  std::optional<JournalReader> journal;
  try {
    journal.emplace(folder.file(kJournalFile));
  } catch (const TruncatedFile&) {
    if (has_checkpoint) throw;
    // Killed while the first lines were written. Where there is no summary either, whatever else is
    // there was about to be replaced.
    if (ended.status) require_same_scene_file(folder, scene);
    Resumption resumption;
    resumption.journal = std::move(owned);
    return resumption;
  }
  const JournalHeader& header = journal->header();
  if (header.program_version != program_version) {
    refuse(FaultCode::resume_other_version, folder.file(kJournalFile),
           fmt::format("written by version {} of tomlin; this is version {}",
                       header.program_version, program_version),
           "that version, or --force, which starts again from the beginning");
  }
  require_same_scene(folder.file(kJournalFile), header.scene, scene);
  require_same_scene_file(folder, scene);
  return has_checkpoint
             ? with_checkpoint(folder, *journal, std::move(owned), scene, program_version)
             : without_checkpoint(folder, *journal, std::move(owned), ended);
}

/// There is neither a journal nor a summary: only a start that was killed leaves such a folder.
Resumption without_journal(const RunFolder& folder, const Scene& scene, const Ended& ended) {
  if (folder.holds(kCheckpointFile)) {
    refuse(FaultCode::resume_impossible, folder.file(kJournalFile),
           "there is none, though there is a checkpoint");
  }
  require_same_scene_file(folder, scene);
  Resumption resumption;
  if (ended.status == RunStatus::failed) {
    require_same(folder.file(kSummaryFile), ended.plugins, scene.libraries);
    resumption.kind = Resumption::Kind::failed;
    resumption.failure = ended.failure;
    return resumption;
  }
  if (ended.status) {
    refuse(FaultCode::resume_impossible, folder.path(),
           "the run was stopped, and its journal and checkpoint are missing");
  }
  for (const char* name : kResultFiles) {
    if (folder.holds(name)) {
      refuse(FaultCode::resume_impossible, folder.file(name), "results without a summary");
    }
  }
  return resumption;
}

/// The journal of a folder, owned; not open when there is none.
Descriptor own_existing(const RunFolder& folder) {
  try {
    return folder.own_existing_journal();
  } catch (const JournalInUse& error) {
    refuse_input(FaultCode::folder_in_use, "-o", folder.path().string(), error.what(),
                 "another folder");
  } catch (const OutputError& error) {
    refuse_input(FaultCode::file_cannot_write, "-o", folder.path().string(), error.what(),
                 kStartAgain);
  }
}

}  // namespace

Resumption find_resumption(const RunFolder& folder, const Scene& scene,
                           const std::string& program_version) try {
  Descriptor owned = own_existing(folder);
  const Ended ended = read_summary(folder);
  if (ended.status == RunStatus::finished) {
    if (!folder.holds(kSceneFile)) {
      refuse(FaultCode::resume_impossible, folder.file(kSceneFile), "there is none");
    }
    require_same_scene_file(folder, scene);
    require_same(folder.file(kSummaryFile), ended.plugins, scene.libraries);
    Resumption resumption;
    resumption.kind = Resumption::Kind::finished;
    resumption.journal = std::move(owned);
    return resumption;
  }
  if (!owned.open()) return without_journal(folder, scene, ended);
  return from_journal(folder, scene, program_version, std::move(owned), ended);
} catch (const DamagedFile& damage) {
  refuse(damage);
}

void require_same_libraries(const fs::path& folder, const std::vector<Library>& libraries) {
  const fs::path checkpoint = folder / kCheckpointFile;
  const fs::path summary = folder / kSummaryFile;
  std::error_code error;
  if (fs::exists(checkpoint, error)) {
    std::vector<Checkpoint::Plugin> recorded;
    try {
      recorded = read_checkpoint(checkpoint).plugins;
    } catch (const DamagedFile&) {
      return;  // find_resumption() says what is wrong with it
    }
    require_same(checkpoint, recorded, libraries);
  } else if (fs::exists(summary, error)) {
    require_same(summary, read_summary(summary).plugins, libraries);
  }
}

void remove_leftovers(RunFolder& folder) {
  for (const char* name : {kStoreFile, kCheckpointFile, kJournalFile}) {
    if (folder.holds(name)) folder.remove(name);
  }
}

Resumption start_again(const RunFolder& folder) {
  Resumption resumption;
  resumption.journal = own_existing(folder);
  return resumption;
}

}  // namespace tomlin
