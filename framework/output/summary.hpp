#pragma once

#include <string>

#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Text of summary.json for a run: one JSON object, with vectors as lists by axis, null for what
/// is undefined, and numbers that read back as the same bits.
std::string summary_json(const Scene& scene, const RunResult& result);

}  // namespace tomlin
