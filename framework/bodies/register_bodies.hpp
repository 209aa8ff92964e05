#pragma once

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// Registers every body of this folder.
void register_bodies(Registry& registry);

}  // namespace tomlin
