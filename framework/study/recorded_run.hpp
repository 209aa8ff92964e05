#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "framework/core/records/registry.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/store_file.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// `tomlin run`: one run with everything that it leaves in a folder.
namespace tomlin {

struct RecordedRun {
  RunResult result;
  std::shared_ptr<const Scene> scene;  ///< with the integrator that it was run with
  /// The choice of the integrator was stopped: there is no result.
  bool stopped_before = false;
  std::optional<RunFailure> failure;   ///< of the run itself
  std::optional<std::string> trouble;  ///< what could not be written
};

struct RecordedRunOptions {
  std::string program_version;
  StoreFile::Before before = StoreFile::Before::ignore;
  const std::atomic<bool>* stop = nullptr;
  const Team* team = nullptr;  ///< see RunOptions
  std::function<void(const RunProgress&)> on_progress = {};
  std::function<void()> on_trouble = {};  ///< something cannot be written: stop
  std::function<void()> on_end = {};      ///< of the run proper, before its results are written
};

/// The folder is owned. `found`: what the run begins with. Throws InputError.
RecordedRun record_run(RunFolder& folder, const std::shared_ptr<const Scene>& scene,
                       const Registry& registry, Resumption found,
                       const RecordedRunOptions& options);

}  // namespace tomlin
