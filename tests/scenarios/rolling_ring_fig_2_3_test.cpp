#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 2 and 3 of Sircar and Patra: a ring so small that it is a Prandtl-Tomlinson tip.
namespace tomlin::test {
namespace {

/// Fig. 2

TEST(RollingRingFig2, IsTheRingThatIsMovedByHand) {
  for (const double lambda : {0.0, 0.1, 1.0}) {
    RigidRing ring;
    ring.radius = 0.001;
    ring.lambda = lambda;
    const auto trace = two_periods(kFig2, {{"lambda", text_of(lambda)}});
    EXPECT_LT(difference_to(ring, trace, 1000), kSameTrace) << "lambda = " << lambda;
    // Another lambda is another trace.
    ring.lambda = lambda + 0.01;
    EXPECT_GT(difference_to(ring, trace, 1000), 100.0 * kSameTrace) << "lambda = " << lambda;
  }
}

/// What single slips of a tip lose per period in the limit of slow driving: from the fold, where
/// s cos(2 pi x) = 1, to the next place of rest for the same place of the driver.
double quasistatic_loss(double amplitude, double stiffness) {
  const double s = 4.0 * kPi * kPi * amplitude / stiffness;
  const auto driver_over = [&](double x) {
    return x - 2.0 * kPi * amplitude / stiffness * std::sin(2.0 * kPi * x);
  };
  const auto energy = [&](double x, double driver) {
    return amplitude * std::cos(2.0 * kPi * x) + 0.5 * stiffness * (x - driver) * (x - driver);
  };
  const double fold = -std::acos(1.0 / s) / (2.0 * kPi);  // before the top at 0
  const double driver = driver_over(fold);
  double low = std::acos(1.0 / s) / (2.0 * kPi);  // the branch of the next well, rising
  double high = 0.5;
  for (int n = 0; n < 100; ++n) {
    const double middle = 0.5 * (low + high);
    (driver_over(middle) < driver ? low : high) = middle;
  }
  return energy(fold, driver) - energy(low, driver);
}

TEST(RollingRingFig2, IsStickSlipAlready) {
  const double amplitude = 0.1 * std::abs(share(kParticles, 0.001));
  EXPECT_NEAR(4.0 * kPi * kPi * 0.1 / 2.0, 1.974, 5e-4);  // s, of three decimals
  // Friction stays as the driving slows down, up to v^(2/3), which two velocities take out.
  const double slow = mean_force(run_shipped(kFig2, {{"v", "2e-5"}}));
  const double slower = mean_force(run_shipped(kFig2, {{"v", "1e-5"}}));
  const double ratio = std::pow(2.0, 2.0 / 3.0);
  const double limit = (ratio * slower - slow) / (ratio - 1.0);
  EXPECT_NEAR(limit / quasistatic_loss(amplitude, 2.0), 1.0, 5e-3);  // higher powers of v^(1/3)
  // On a spring that holds, nothing but drag is left.
  const double s = 4.0 * kPi * kPi * amplitude / 8.0;
  const double smooth = mean_force(run_shipped(kFig2, {{"k", "8"}}));
  EXPECT_NEAR(smooth / (kDamping * 1e-3 / std::sqrt(1.0 - s * s)), 1.0, 1e-5);
}

TEST(RollingRingFig2, DoesNotTurn) {
  for (const char* lambda : {"0", "0.01", "1"}) {
    EXPECT_NEAR(turns(run_shipped(kFig2, {{"lambda", lambda}})), 0.0, 1e-8) << lambda;
  }
}

}  // namespace
}  // namespace tomlin::test
