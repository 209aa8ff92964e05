#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "framework/model/model.hpp"
#include "framework/run/steps/run_plan.hpp"

namespace tomlin {

/// Rotations of bodies from their start. Flexible ones have no coordinate of rotation, and those of
/// rigid ones in space are short-lived: their whole turns are counted by looking often enough.
class Rotations {
 public:
  explicit Rotations(const Model& model) : model_(model) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// Begins a run.
  void start() { *steps_between_looks_ = 1; }

  /// In turns, unwrapped.
  double turns_of(std::size_t body, const double* position) const;
  /// A flexible body turns fast, or a rigid one in space, where a block of steps could turn it too
  /// far: look() is needed after every step.
  bool is_needed_at_every_step() const { return *steps_between_looks_ == 1 || model_.has_rotors(); }
  /// Some body has turns to be counted.
  bool counts_turns() const {
    return std::any_of(model_.bodies().begin(), model_.bodies().end(),
                       [this](const Model::Body& body) { return counts_turns_of(body); });
  }
  /// Counts whole turns; `turned(body, turns)` for each flexible body.
  template <class Turned>
  void look(Turned turned);

 private:
  bool counts_turns_of(const Model::Body& body) const {
    return body.rotates() && (!body.bound.slot.mapped || body.rotor);
  }
  double look_at(std::size_t body);

  const Model& model_;
  double* last_ = nullptr;         ///< [body], when last looked at
  std::int64_t* wraps_ = nullptr;  ///< [body]
  std::int64_t* steps_between_looks_ = nullptr;
};

template <class Turned>
void Rotations::look(Turned turned) {
  /// A flexible body that would turn more than this between looks is looked at after every step.
  constexpr double kMostTurnsBetweenLooks = 0.05;
  const std::int64_t steps = *steps_between_looks_;
  *steps_between_looks_ = kBlock;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    if (!counts_turns_of(model_.bodies()[b])) continue;
    const double change = look_at(b);
    turned(b, last_[b]);
    const double a_step = std::abs(change) / static_cast<double>(steps);
    if (a_step * kBlock > kMostTurnsBetweenLooks) *steps_between_looks_ = 1;
  }
}

}  // namespace tomlin
