#pragma once

#include <span>
#include <string>

#include "framework/output/run_folder.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Throws InputError where results with these names would replace what the scene reads, or the
/// scene itself: that may be replaced by the same text only, which is what `scene.toml` will hold.
void refuse_to_lose_inputs(const RunFolder& folder, const Scene& scene,
                           std::span<const char* const> names, const std::string& scene_text);
/// Throws InputError likewise, where `scene.toml` will hold the effective scene.
void refuse_to_lose_inputs(const RunFolder& folder, const Scene& scene,
                           std::span<const char* const> names);

/// Says on standard error, where the file system of an owned folder has no locks, which file stands
/// for one.
void note_missing_locks(const RunFolder& folder, bool quiet);

}  // namespace tomlin
