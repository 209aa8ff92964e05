#include "framework/model/final_state.hpp"

#include <algorithm>

namespace tomlin {

const FinalState::Support* FinalState::support(const std::string& name) const {
  const auto found = std::find_if(supports.begin(), supports.end(),
                                  [&name](const Support& one) { return one.name == name; });
  return found == supports.end() ? nullptr : &*found;
}

Quad absolute_position(const Origin& origin, int axis, Quad relative) {
  return Quad(static_cast<double>(origin.cells[axis])) * Quad(origin.unit[axis]) + relative;
}

}  // namespace tomlin
