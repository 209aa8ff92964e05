#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "framework/scene/scene.hpp"

namespace tomlin {

/// Returns the output of `tomlin check --json` for a scene that can be read. `seed` selects the
/// random states at which properties are verified. Throws InputError for everything that a run
/// would refuse. `stop` ends it early, with what has been verified.
std::string check_json(const std::shared_ptr<const Scene>& scene, std::uint64_t seed = 1,
                       const std::atomic<bool>* stop = nullptr);

}  // namespace tomlin
