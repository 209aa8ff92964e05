#pragma once

#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

/// `tomlin tradeoff --write NEW.toml`
namespace tomlin {

/// Looks whether the file can be made, and makes nothing. Throws InputError.
void check_new_scene(const std::string& file, const std::string& scene, bool force);

/// The document, which was read from `scene` with these settings, with the recommended lines in it;
/// the file means what was measured, or it is not written. Returns why it is not. Throws
/// OutputError.
std::string write_scene(const std::string& file, const SceneDocument& document,
                        const std::string& scene, std::vector<Setting> settings,
                        const Registry& registry, const Recommendation& recommendation);

}  // namespace tomlin
