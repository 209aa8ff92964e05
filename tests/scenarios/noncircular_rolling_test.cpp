// scenarios/noncircular_rolling: an ellipse and a square against the ring of Table I.

#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

RunResult run_of_shape(const std::string& scene, const std::string& parameter, double value,
                       double lambda) {
  return run_shipped("noncircular_rolling/" + scene + ".toml",
                     {{parameter, text_of(value)}, {"lambda", text_of(lambda)}});
}

double cost_of(const RunResult& result) {
  return observable(result, "driver.mean_force.x").value();
}
double turns_in_a_period(const RunResult& result) {
  return observable(result, "ring.turns").value() / 9.0;
}

TEST(NoncircularRolling, ACircleIsTheRingOfTableI) {
  for (const double lambda : {1.0, 3.0}) {
    const RunResult ring =
        run_shipped("rolling_ring/table_1_rigid.toml", {{"lambda", text_of(lambda)}});
    const RunResult circle = run_of_shape("ellipse", "q", 1.0, lambda);
    // Positions that differ by rounding, over a few thousand steps of 1e-10.
    EXPECT_NEAR(cost_of(circle), cost_of(ring), 1e-6 * cost_of(ring));
    EXPECT_NEAR(turns_in_a_period(circle), -0.125, 1e-6);
  }
}

TEST(NoncircularRolling, LongShapesLockIntoOtherSteps) {
  EXPECT_NEAR(turns_in_a_period(run_of_shape("ellipse", "q", 1.5, 1.0)), -1.0 / 6.0, 1e-6);
  const RunResult square = run_of_shape("polygon", "c", 4, 3.0);
  EXPECT_NEAR(turns_in_a_period(square), -0.25, 1e-6);
  EXPECT_GT(cost_of(square), 2.0 * cost_of(run_of_shape("polygon", "c", 8, 3.0)));
}

TEST(NoncircularRolling, ALittleEllipticitySaves) {
  EXPECT_LT(cost_of(run_of_shape("ellipse", "q", 1.2, 1.0)),
            0.85 * cost_of(run_of_shape("ellipse", "q", 1.0, 1.0)));
}

}  // namespace
}  // namespace tomlin::test
