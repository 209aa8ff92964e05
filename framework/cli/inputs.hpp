#pragma once

#include <span>

#include "framework/output/run_folder.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Throws InputError where results with these names would replace what the scene reads, or the
/// scene itself: only a run may, and then by the same text.
void refuse_to_lose_inputs(const RunFolder& folder, const Scene& scene,
                           std::span<const char* const> names);

}  // namespace tomlin
