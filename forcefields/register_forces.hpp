#pragma once

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// Registers every force of this folder.
void register_forcefields(Registry& registry);

}  // namespace tomlin
