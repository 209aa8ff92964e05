#include "framework/output/run_recorder.hpp"

#include <exception>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/output/result_file.hpp"
#include "framework/output/summary.hpp"

namespace tomlin {
namespace {

/// Everything that it gets goes to every file.
class ToAll : public RunSink {
 public:
  explicit ToAll(std::vector<std::unique_ptr<ResultFile>>& files) : files_(files) {}
  void begin(const RunLayout& layout) override {
    for (const auto& file : files_) file->begin(layout);
  }
  void sample(const std::vector<double>& row) override {
    for (const auto& file : files_) file->sample(row);
  }
  void event(const Event& event) override {
    for (const auto& file : files_) file->event(event);
  }

 private:
  std::vector<std::unique_ptr<ResultFile>>& files_;
};

}  // namespace

RunRecorder::RunRecorder(RunFolder& folder, const Scene& scene, std::string program_version,
                         Resumption resumption, std::function<void()> on_trouble,
                         std::uint64_t most_events)
    : folder_(folder),
      scene_(scene),
      version_(std::move(program_version)),
      resumption_(std::move(resumption)),
      on_trouble_(std::move(on_trouble)),
      most_events_(most_events) {}

template <class Action>
void RunRecorder::attempt(Action action) {
  if (trouble_) return;
  try {
    action();
  } catch (const OutputError& error) {
    trouble_ = error.what();
    on_trouble_();
  }
}

void RunRecorder::begin(const RunLayout& layout) {
  if (resumption_.kind == Resumption::Kind::go_on && layout.state != resumption_.layout.state) {
    refuse_input(
        FaultCode::resume_other_version, "-o", folder_.path().string(),
        "this program stores another state of this scene than the program that was stopped",
        "the program that began the run, or --force, which starts again");
  }
  require_room(scene_, output_size(scene_, layout), room_in(folder_.path()));
  attempt([&] { resumption_.kind == Resumption::Kind::go_on ? go_on(layout) : start(layout); });
}

void RunRecorder::start(const RunLayout& layout) {
  // The journal says what there is to go on with, and so changes only when nothing is left of what
  // was there before: where it is empty, a run can begin.
  folder_.require_in_place();
  folder_.remove_results();
  cleared_ = true;
  folder_.remove(kCheckpointFile);
  if (!holds_scene()) folder_.remove(kSceneFile);
  journal_.emplace(folder_.file(kJournalFile), std::move(resumption_.journal),
                   JournalHeader{version_, scene_.effective_toml, layout});
  folder_.write_file(kSceneFile, scene_.effective_toml);
}

/// Whether scene.toml is what it is going to be: the run may be of that very file.
bool RunRecorder::holds_scene() const {
  const std::string& scene = scene_.effective_toml;
  return read_text_file(folder_.file(kSceneFile), scene.size()).text == scene;
}

void RunRecorder::go_on(const RunLayout& layout) {
  folder_.require_in_place();
  folder_.remove_results();
  cleared_ = true;
  if (!folder_.holds(kSceneFile)) folder_.write_file(kSceneFile, scene_.effective_toml);
  journal_.emplace(folder_.file(kJournalFile), std::move(resumption_.journal), layout,
                   resumption_.mark);
  kept_once_ = true;
}

void RunRecorder::sample(const std::vector<double>& row) {
  attempt([&] { journal_->row(row); });
}

void RunRecorder::event(const Event& event) {
  attempt([&] {
    if (journal_->events() < most_events_) journal_->event(event);
  });
}

void RunRecorder::checkpoint(const RunState& state) {
  attempt([&] {
    Checkpoint checkpoint;
    checkpoint.program_version = version_;
    checkpoint.scene = scene_fingerprint(scene_.effective_toml);
    checkpoint.journal = journal_->flush();
    checkpoint.state = state.to_bytes();
    for (const Library& library : scene_.libraries) {
      checkpoint.plugins.push_back({library.path, library.hash});
    }
    folder_.require_in_place();
    // A power cut right after the start costs nothing but the start: short runs stay quick.
    const auto lasting = std::exchange(kept_once_, true) ? OutputFile::Lasting::with_its_name
                                                         : OutputFile::Lasting::some_time_later;
    if (lasting == OutputFile::Lasting::with_its_name) journal_->synchronise();
    write_checkpoint(folder_.file(kCheckpointFile), checkpoint, lasting);
  });
}

/// Everything comes from the journal, whose checksums are looked at once more.
void RunRecorder::write_results() {
  const JournalMark end = journal_->flush();
  folder_.require_in_place();
  auto files = result_files(scene_, folder_, release_of(version_));
  ToAll all(files);
  try {
    JournalReader journal(folder_.file(kJournalFile));
    journal.play(all);
    if (journal.mark() != end) {
      throw DamagedFile(
          fmt::format("{}: it was changed during the run", folder_.file(kJournalFile).string()));
    }
    for (const auto& file : files) {
      folder_.require_in_place();
      file->finish();
    }
  } catch (const DamagedFile& error) {
    throw OutputError(error.what());
  }
}

/// The counts of the summary are of all.
void RunRecorder::tell_of_dropped_events(RunResult& result) const {
  if (!journal_ || journal_->events() < most_events_) return;
  double all = 0.0;
  for (const ResultValue& count : result.group("events").values) all += count.value_or(0.0);
  if (all <= static_cast<double>(most_events_)) return;
  result.warnings.push_back({FaultCode::output_events_dropped,
                             fmt::format("{} has the first {} of {:.0f} events; all are counted",
                                         kEventsFile, most_events_, all),
                             "events"});
}

std::optional<std::string> RunRecorder::finish(RunResult& result) {
  tell_of_dropped_events(result);
  const bool ended = result.status != RunStatus::interrupted;
  attempt([&] { write_results(); });
  if (trouble_ && !result.failure) {
    RunFailure failure;
    failure.step = result.steps;
    failure.time = result.end_time;
    failure.what = *trouble_;
    failure.cause = "the results could not be written";
    failure.code = FaultCode::file_cannot_write;
    result.status = RunStatus::failed;
    result.failure = failure;
  }
  try {
    // The summary would speak for results of an earlier or another run beside it.
    if (cleared_ && folder_.in_place()) {
      folder_.write_file(kSummaryFile, summary_json(scene_, result));
      synchronise_folder_of(folder_.file(kSummaryFile));
    }
  } catch (const OutputError& error) {
    if (!trouble_) trouble_ = error.what();
  }
  if (ended) {
    attempt([&] {
      folder_.require_in_place();
      for (const char* name : {kStoreFile, kCheckpointFile, kJournalFile}) folder_.remove(name);
    });
  }
  return trouble_;
}

}  // namespace tomlin
