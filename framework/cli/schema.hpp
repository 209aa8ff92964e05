#pragma once

#include <string>

#include "framework/core/records/registry.hpp"

namespace tomlin {

/// A JSON Schema (draft 7) of the scenes that can be made of these components, for editors: what
/// one value is held against. What only holds between several values is left to the program, and
/// so is what an expression says.
std::string scene_schema(const Registry& registry);

}  // namespace tomlin
