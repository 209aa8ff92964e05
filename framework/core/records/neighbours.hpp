#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tomlin {

/// Indices of two particles of a body.
using IndexPair = std::array<std::int64_t, 2>;

/// Lists the pairs of a body that "neighbours" means, each once. Null: consecutive particles.
using NeighbourList = std::function<std::vector<IndexPair>()>;

}  // namespace tomlin
