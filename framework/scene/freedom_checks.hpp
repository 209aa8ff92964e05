#pragma once

#include <optional>
#include <vector>

#include "framework/scene/checks.hpp"
#include "framework/scene/fault_list.hpp"

namespace tomlin {

/// `coordinates`, `hold`, `motion` and the starting velocity of each body against each other and
/// the scene's dimension. The velocity of a motion that gives none is filled in.
void check_freedom(std::vector<BodyDraft>& bodies, std::optional<int> dimension, FaultList& faults);

}  // namespace tomlin
