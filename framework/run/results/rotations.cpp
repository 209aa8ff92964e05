#include "framework/run/results/rotations.hpp"

#include <cmath>

namespace tomlin {

void Rotations::declare(StateLayout& layout) const {
  layout.add_reals("rotations.last", model_.bodies().size());
  layout.add_integers("rotations.wraps", model_.bodies().size());
  layout.add_integers("rotations.steps_between_looks", 1);
}

void Rotations::attach(RunState& state) {
  last_ = state.reals("rotations.last");
  wraps_ = state.integers("rotations.wraps");
  steps_between_looks_ = state.integers("rotations.steps_between_looks");
}

double Rotations::turns_of(std::size_t b, const double* position) const {
  const double turns = model_.rotation(b, position);
  if (!counts_turns_of(model_.bodies()[b])) return turns;
  const double unwrapped = turns + static_cast<double>(wraps_[b]);
  return unwrapped - std::nearbyint(unwrapped - last_[b]);
}

/// How far it has turned since it was last looked at.
double Rotations::look_at(std::size_t b) {
  const double turns = model_.rotation(b, model_.system().view.position);
  const double change = turns + static_cast<double>(wraps_[b]) - last_[b];
  const double wraps = std::nearbyint(change);
  wraps_[b] -= static_cast<std::int64_t>(wraps);
  last_[b] = turns + static_cast<double>(wraps_[b]);
  return change - wraps;
}

}  // namespace tomlin
