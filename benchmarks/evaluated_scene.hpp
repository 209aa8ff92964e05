#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

#include "framework/core/system/aligned.hpp"
#include "framework/run/engine.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {

/// All digits of a number.
inline std::string digits(double x) {
  char number[40];
  std::snprintf(number, sizeof number, "%.17g", x);
  return number;
}

/// Evaluates all forces of a scene with one body, where it starts.
class EvaluatedScene {
 public:
  explicit EvaluatedScene(const std::string& text)
      : engine_(parse_scene(text, "benchmark.toml", components_, {}), {}),
        rates_(engine_.model().system().view.rates + 2 * kGroup) {}

  void evaluate() {
    const auto& view = engine_.model().system().view;
    const auto stage =
        stage_of(view, view.position, view.velocity, view.integrals, rates_.data(), 0.0);
    for (std::size_t k = 0; k < view.operation_count; ++k) {
      view.operations[k].run(view.operations[k].arguments, stage);
    }
  }
  double force(std::size_t atom, std::size_t axis) {
    return engine_.model().system().view.force[at(atom, axis)];
  }
  double position(std::size_t atom, std::size_t axis) {
    return engine_.model().system().view.position[at(atom, axis)];
  }

 private:
  std::size_t at(std::size_t atom, std::size_t axis) {
    const auto& body = engine_.model().bodies().front().bound.slot;
    return body.offset + axis * body.stride + atom;
  }

  Registry components_ = standard_registry();
  Engine engine_;
  AlignedVector<double> rates_;
};

}  // namespace tomlin
