#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 5 and 6 of Sircar and Patra: dragging and rolling.
namespace tomlin::test {
namespace {

/// Fig. 5

TEST(RollingRingFig5, IsTheRingThatIsMovedByHand) {
  for (const double lambda : {0.01, 1.0, 100.0}) {
    RigidRing ring;
    ring.lambda = lambda;
    const auto trace = two_periods(kFig5, {{"lambda", text_of(lambda)}});
    EXPECT_LT(difference_to(ring, trace, 500), kSameTrace) << "lambda = " << lambda;
  }
}

TEST(RollingRingFig5, TheForceItselfDoesNotJumpWhereTheDriverOvertakes) {
  // The paper's F_f has the size of the whole force and the sign of its x component.
  const auto trace = two_periods(kFig5, {{"lambda", "100"}});
  const auto& fx = trace["driver.force.x"];
  const auto& fy = trace["driver.force.y"];
  double jump_of_ff = 0.0;
  double jump_of_fx = 0.0;
  for (std::size_t n = fx.size() / 2; n + 1 < fx.size(); ++n) {  // after the first period
    const auto ff = [&](std::size_t m) { return std::copysign(std::hypot(fx[m], fy[m]), fx[m]); };
    jump_of_ff = std::max(jump_of_ff, std::abs(ff(n + 1) - ff(n)));
    jump_of_fx = std::max(jump_of_fx, std::abs(fx[n + 1] - fx[n]));
  }
  EXPECT_GT(jump_of_ff, 20.0 * jump_of_fx);
  // It is twice the force of the spring along y.
  const double fy_most = *std::max_element(fy.begin() + 100, fy.end());
  EXPECT_NEAR(jump_of_ff / (2.0 * fy_most), 1.0, 0.02);
}

TEST(RollingRingFig5, CostsLessWhenItMayNotTurn) {
  // A ring that is held slides smoothly, s < 1: drag only, and its height hardly changes.
  const double s = 4.0 * kPi * kPi * 0.1 * std::abs(share(kParticles, 1.0, 0.01)) / 2.0;
  const double held = mean_force(run_shipped(kFig5, {kHeld}));
  EXPECT_NEAR(held / (kDamping * 1e-3 / std::sqrt(1.0 - s * s)), 1.0, 2e-3);
  EXPECT_NEAR(mean_force(run_shipped(kFig5)) / 2.878089991e-2, 1.0, 1e-7);  // Table I
  EXPECT_GT(mean_force(run_shipped(kFig5)), 7.0 * held);
}

}  // namespace
}  // namespace tomlin::test
