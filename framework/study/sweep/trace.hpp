#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>

#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// Runs a point and leaves in a folder what `tomlin run` does; goes on with one that was stopped
/// there, and does nothing where it has ended or the scene refuses the point. False when it was
/// stopped. Throws OutputError, and InputError where the folder cannot be used.
bool trace_point(const SweepPlan& plan, std::size_t point, const std::filesystem::path& folder,
                 const std::atomic<bool>* stop);

}  // namespace tomlin
