#pragma once

namespace tomlin {

/// What scenes, results and messages call the axes of space.
inline constexpr const char* kAxisNames[] = {"x", "y", "z"};

}  // namespace tomlin
