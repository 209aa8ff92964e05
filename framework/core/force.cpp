#include "framework/core/force.hpp"

namespace tomlin {

std::uint64_t count_pairs(const PairSelection& selection, const SceneOutline& scene) {
  const auto n = static_cast<std::uint64_t>(scene.bodies.front().count);
  switch (selection.kind) {
    case PairSelection::Kind::all:
      return scene.bodies.size() == 2 ? n * static_cast<std::uint64_t>(scene.bodies.back().count)
                                      : n * (n - 1) / 2;
    case PairSelection::Kind::neighbours:
      return n - 1 + (scene.bodies.front().closed && n > 2 ? 1 : 0);
    case PairSelection::Kind::list:
      return selection.list.size();
  }
  return 0;
}

}  // namespace tomlin
