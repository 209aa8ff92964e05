#pragma once

#include <memory>

#include "framework/run/run.hpp"

namespace tomlin {

/// `[run] repeats`: repeats the run with noise of its own for each repeat, which no other stream
/// and no other repeat has, and replaces each number over the window by its mean over all
/// repeats, with the standard error of that mean. Counts, and what is known of the end of a run,
/// stay those of the run as it is. Repeats take their steps together where lanes have them
/// (lane_batch.hpp).
void average_over_repeats(const std::shared_ptr<const Scene>& scene, const RunOptions& options,
                          RunResult& result);

}  // namespace tomlin
