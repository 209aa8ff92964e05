#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "framework/run/run.hpp"

namespace tomlin {

class Engine;

/// A run beside the run proper, without a sink and without the scene's `perturb`. It keeps its
/// checkpoints in the store of the options, where there is one, under this name: stopped and run
/// again it resumes from the last one, and when it was over it is over at once.
RunResult side_run(const std::shared_ptr<const Scene>& scene, RunOptions options,
                   const std::string& name);

/// A side run whose owner takes its steps, in a batch of several.
class SideRun {
 public:
  SideRun(const std::shared_ptr<const Scene>& scene, RunOptions options, std::string name);
  ~SideRun();
  SideRun(const SideRun&) = delete;
  SideRun& operator=(const SideRun&) = delete;

  Engine& engine() { return *engine_; }

 private:
  std::string name_;
  std::unique_ptr<RunSink> checkpoints_;
  std::vector<std::byte> kept_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace tomlin
