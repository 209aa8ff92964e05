#pragma once

#include <string>

#include "framework/cli/arguments.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/study/tradeoff.hpp"

/// `tomlin tradeoff --write NEW.toml`
namespace tomlin {

/// Looks whether the file can be made, and makes nothing. Throws InputError.
void check_new_scene(const TradeoffArguments& arguments);

/// The user's file with the recommended lines in it; it means what was measured, or it is not
/// written. Returns why it is not. Throws OutputError.
std::string write_scene(const TradeoffArguments& arguments, const SceneDocument& document,
                        const Registry& registry, const Recommendation& recommendation);

}  // namespace tomlin
