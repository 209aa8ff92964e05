#pragma once

#include "framework/core/registry.hpp"

namespace tomlin {

/// Every component that comes with tomlin.
Registry standard_registry();

}  // namespace tomlin
