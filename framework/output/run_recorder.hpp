#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/output/checkpoint.hpp"
#include "framework/output/journal.hpp"
#include "framework/output/output_size.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Keeps what a run leaves: its journal and checkpoints on the way, its results at the end. Killed
/// between any two steps of that, a folder holds results that are whole, or a run to go on with, or
/// nothing that looks like either.
///
/// When something cannot be written the run is asked to stop instead of broken off, so that what is
/// known can still be said; the last checkpoint stays.
class RunRecorder : public RunSink {
 public:
  /// Records into an owned folder. Nothing is touched before begin(). `on_trouble` is called when
  /// something cannot be written.
  RunRecorder(RunFolder& folder, const Scene& scene, std::string program_version,
              Resumption resumption, std::function<void()> on_trouble,
              std::uint64_t most_events = kMostEvents);

  /// Throws InputError, and has touched nothing, when the run was begun by a program that keeps
  /// other numbers in its checkpoints than this one, or there is no room for what it would write.
  void begin(const RunLayout& layout) override;
  void sample(const std::vector<double>& row) override;
  void event(const Event& event) override;
  void checkpoint(const RunState& state) override;

  /// Writes the results, the summary last, and takes away what a run that has ended has no use for.
  /// A file that could not be written makes the result a failed one; the reason is returned.
  std::optional<std::string> finish(RunResult& result);

 private:
  void start(const RunLayout& layout);
  void go_on(const RunLayout& layout);
  void write_results();
  void tell_of_dropped_events(RunResult& result) const;
  bool holds_scene() const;
  template <class Action>
  void attempt(Action action);

  RunFolder& folder_;
  const Scene& scene_;
  std::string version_;
  Resumption resumption_;
  std::function<void()> on_trouble_;
  std::uint64_t most_events_;  ///< that are kept
  std::optional<JournalWriter> journal_;
  bool cleared_ = false;    ///< results of an earlier run are gone
  bool kept_once_ = false;  ///< a checkpoint
  std::optional<std::string> trouble_;
};

}  // namespace tomlin
