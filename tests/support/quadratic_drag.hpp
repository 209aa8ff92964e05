#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin::test {

/// Reads velocities and is no linear friction: a drag with the square of the speed.
class QuadraticDrag : public BoundForce<double> {
 public:
  explicit QuadraticDrag(const Binding<double>& binding) : slot_(binding.bodies[0]->slot) {}
  std::vector<Pass<double>> passes() override {
    return {{&run<true>, &run<false>, this, {{0, false}}, kRankCheap}};
  }

 private:
  template <bool set>
  static void run(const void* self, const Stage<double>& stage) {
    const std::size_t at = static_cast<const QuadraticDrag*>(self)->slot_.offset;
    const double v = stage.velocity[at];
    stage.force[at] = (set ? 0.0 : stage.force[at]) - v * std::abs(v);
  }
  BodySlot<double> slot_;
};

struct NoParameters {};

inline ForceRecord quadratic_drag() {
  ForceRecord record;
  record.name = "quadratic_drag";
  record.summary = "drag with the square of the speed";
  record.equation = "F = -v |v|";
  record.source = "a test";
  record.example = "a test";
  record.traits = {.depends_on_velocity = true, .dissipative = true};
  record.make_description = &make_description<NoParameters>;
  record.bind = +[](const void*, const Binding<double>& b) -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<QuadraticDrag>(b);
  };
  return record;
}

inline std::string with_drag(const std::string& run) {
  return "[[body]]\ntype = \"point\"\nposition = [0.0]\nvelocity = [1.0]\nparticle_mass = 1.0\n"
         "[[force]]\nname = \"wind\"\ntype = \"quadratic_drag\"\n[run]\nduration = 1.0\n" +
         run + "\n";
}

inline Registry drag_registry() {
  Registry registry = standard_registry();
  registry.add(quadratic_drag());
  return registry;
}

}  // namespace tomlin::test
