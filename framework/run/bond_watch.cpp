#include "framework/run/bond_watch.hpp"

#include <algorithm>

namespace tomlin {

bool has_images(const Model& model) {
  const auto& box = model.plan().box;
  return std::any_of(box.begin(), box.end(), [](double length) { return length > 0.0; });
}

void note_long_bonds(const Model& model, const Stage<double>& stage, std::int64_t* beyond) {
  for (std::size_t k = 0; k < model.forces().size(); ++k) {
    if (beyond[k] != 0) continue;
    beyond[k] = model.forces()[k].bound->bond_beyond_half_box(stage).empty() ? 0 : 1;
  }
}

std::vector<std::string> warnings_of_long_bonds(const Model& model, const std::int64_t* beyond) {
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < model.forces().size(); ++k) {
    if (beyond[k] == 0) continue;
    warnings.push_back(model.forces()[k].name +
                       ": a bond became as long as half the box or longer: it stays with the image "
                       "of its particle with which it started, though another is nearer by then; a "
                       "potential between whatever is near is a formula of r");
  }
  return warnings;
}

}  // namespace tomlin
