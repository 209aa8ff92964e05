#pragma once

#include "framework/core/records/traits.hpp"

namespace tomlin {

/// "each particle", "pairs of particles", "a body as a whole, or particles of it".
const char* to_string(Element element);

/// "x", "y", "z".
const char* axis_name(int axis);

}  // namespace tomlin
