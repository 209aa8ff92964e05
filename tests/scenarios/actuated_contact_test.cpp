// scenarios/actuated_contact: friction vanishes where the corrugation is weak for a moment.

#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

double actuated_friction(double alpha, double v) {
  const RunResult result =
      run_shipped("actuated_contact/tip.toml", {{"alpha", text_of(alpha)}, {"v", text_of(v)}});
  return observable(result, "driver.mean_force.x").value();
}

TEST(ActuatedContact, BeyondTheThresholdFrictionIsThatOfTheWayInACycle) {
  constexpr double kFast = 1e-4;
  constexpr double kSlow = 3e-5;
  // 1 - 1/s = 2/3.
  const double above = actuated_friction(0.8, kSlow);
  EXPECT_NEAR(actuated_friction(0.8, kFast) / above, kFast / kSlow, 0.1);
  EXPECT_LT(above, 0.02 * actuated_friction(0.0, kSlow));
  // Before the threshold it hardly depends on the velocity.
  const double below = actuated_friction(0.4, kSlow);
  EXPECT_GT(below, 0.3 * actuated_friction(0.0, kSlow));
  EXPECT_LT(actuated_friction(0.4, kFast) / below, 1.3);
}

}  // namespace
}  // namespace tomlin::test
