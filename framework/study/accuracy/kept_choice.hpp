#pragma once

#include <memory>
#include <optional>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/study/accuracy/pilot.hpp"

namespace tomlin {

void keep_choice(RunStore& store, const ChosenIntegrator& chosen);

/// Returns the kept choice, bit by bit, for the same scene; nothing where none was kept.
std::optional<ChosenIntegrator> kept_choice(const RunStore& store,
                                            const std::shared_ptr<const Scene>& scene,
                                            const Registry& registry);

}  // namespace tomlin
