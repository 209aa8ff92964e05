#pragma once

#include <memory>
#include <string>

#include "framework/run/run.hpp"

namespace tomlin {

/// A run beside the run proper, without a sink and without the scene's `perturb`. It keeps its
/// checkpoints in the store of the options, where there is one, under this name: stopped and run
/// again it resumes from the last one, and when it was over it is over at once.
RunResult side_run(const std::shared_ptr<const Scene>& scene, RunOptions options,
                   const std::string& name);

}  // namespace tomlin
