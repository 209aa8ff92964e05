// scenarios/noncircular_rolling: an ellipse and a square against the ring of Table I.

#include <string>

#include <gtest/gtest.h>

#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

RunResult shape(const std::string& scene, const std::string& parameter, double value,
                double lambda) {
  return run_shipped("noncircular_rolling/" + scene + ".toml",
                     {{parameter, text_of(value)}, {"lambda", text_of(lambda)}});
}

double cost(const RunResult& result) { return observable(result, "driver.mean_force.x").value(); }
double turns(const RunResult& result) { return observable(result, "ring.turns").value() / 9.0; }

TEST(NoncircularRolling, ACircleIsTheRingOfTableI) {
  for (const double lambda : {1.0, 3.0}) {
    const RunResult ring =
        run_shipped("rolling_ring/table_1_rigid.toml", {{"lambda", text_of(lambda)}});
    const RunResult circle = shape("ellipse", "q", 1.0, lambda);
    // Positions that differ by rounding, over a few thousand steps of 1e-10.
    EXPECT_NEAR(cost(circle), cost(ring), 1e-6 * cost(ring));
    EXPECT_NEAR(turns(circle), -0.125, 1e-6);
  }
}

TEST(NoncircularRolling, LongShapesLockIntoOtherSteps) {
  EXPECT_NEAR(turns(shape("ellipse", "q", 1.5, 1.0)), -1.0 / 6.0, 1e-6);
  const RunResult square = shape("polygon", "c", 4, 3.0);
  EXPECT_NEAR(turns(square), -0.25, 1e-6);
  EXPECT_GT(cost(square), 2.0 * cost(shape("polygon", "c", 8, 3.0)));
}

TEST(NoncircularRolling, ALittleEllipticitySaves) {
  EXPECT_LT(cost(shape("ellipse", "q", 1.2, 1.0)), 0.85 * cost(shape("ellipse", "q", 1.0, 1.0)));
}

}  // namespace
}  // namespace tomlin::test
