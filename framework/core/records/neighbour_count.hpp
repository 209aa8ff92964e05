#pragma once

#include <cstddef>
#include <cstdint>

namespace tomlin {

/// Contents of a force's neighbour lists, as they were last made.
struct NeighbourCount {
  double mean = 0.0;        ///< neighbours of a particle, within the cutoff and the skin
  std::size_t most = 0;     ///< of any particle
  std::uint64_t pairs = 0;  ///< each once
  std::uint64_t bytes = 0;  ///< of all lists and what belongs to them
};

/// Further interface of forces with a cutoff.
class CountsNeighbours {
 public:
  virtual ~CountsNeighbours() = default;
  /// All zero before the first evaluation.
  virtual NeighbourCount count_neighbours() const = 0;

 protected:
  CountsNeighbours() = default;
};

}  // namespace tomlin
