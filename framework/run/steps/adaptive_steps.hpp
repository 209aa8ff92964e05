#pragma once

#include "framework/run/steps/stepping.hpp"

namespace tomlin {

/// Steps as long as the scheme has them.
class AdaptiveSteps : public Stepping {
 public:
  explicit AdaptiveSteps(StepParts parts) : Stepping(std::move(parts)) {}
  void advance(std::uint64_t most) override;
  std::int64_t steps_for_lanes() override;
  void count_steps(std::int64_t steps, const DoubleDouble& time) override;

 protected:
  void look(const DoubleDouble& from, const DoubleDouble& to) override {
    parts_.observation.look_between(static_cast<double>(from), static_cast<double>(to));
  }
  double anchor_next() override;

 private:
  bool foresees_too_many_steps();
};

/// Steps along a path of equilibria, each of which may end; the next one follows at once.
class EquilibriumSteps : public AdaptiveSteps {
 public:
  using AdaptiveSteps::AdaptiveSteps;

 protected:
  void look(const DoubleDouble& from, const DoubleDouble& to) override {
    parts_.observation.look_along_path(static_cast<double>(from), static_cast<double>(to));
  }
  bool end_step() override { return !run_.path->ends() || slip(); }

 private:
  bool slip();
};

}  // namespace tomlin
