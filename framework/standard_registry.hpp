#pragma once

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// Every component that comes with tomlin. The registry is the caller's: user-defined components
/// are added to it before a scene is read.
Registry standard_registry();

}  // namespace tomlin
