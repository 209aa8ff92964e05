#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_phases.hpp"
#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 5 and 6 of Sircar and Patra: dragging and rolling.
namespace tomlin::test {
namespace {

constexpr const char* kFig5 = "rolling_ring/fig_5.toml";
constexpr const char* kFig6 = "rolling_ring/fig_6.toml";
constexpr int kPeriodsOfFig6 = 3;

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

/// Fig. 6

/// Largest distance, along an axis, of a particle to where it is in a ring moved by hand.
double difference_of_particles(const RigidRing& ring, const Trace& trace, int steps) {
  const auto& samples = trace["ring.rotation"];
  const auto points =
      ring.trace(static_cast<int>(samples.size()) - 1, 0.005 / ring.velocity, steps);
  double largest = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    for (std::size_t i = 0; i < kParticles; ++i) {
      const double angle = 2.0 * kPi * static_cast<double>(i) / kParticles + points[n].rotation;
      const double x = points[n].x + ring.radius * std::cos(angle);
      const double y = points[n].y + ring.radius * std::sin(angle);
      largest = std::max(
          {largest, std::abs(trace.position(n, i, 0) - x), std::abs(trace.position(n, i, 1) - y)});
    }
  }
  return largest;
}

TEST(RollingRingFig6, ParticlesAreWhereTheyAreByHand) {
  for (const double lambda : {0.01, 1.0}) {
    Trace trace;
    run_shipped(kFig6, {{"lambda", text_of(lambda)}}, &trace);
    RigidRing ring;
    ring.lambda = lambda;
    EXPECT_LT(difference_of_particles(ring, trace, 250), kSameTrace) << "lambda = " << lambda;
    ring.lambda *= 1.01;  // another ring leaves another trace
    EXPECT_GT(difference_of_particles(ring, trace, 250), 100.0 * kSameTrace) << lambda;
  }
}

TEST(RollingRingFig6, RollsTwiceAPeriodForSmallLambdaAndIsDraggedBetween) {
  Trace trace;
  run_shipped(kFig6, {}, &trace);
  const auto phases = phases_of_a_period(trace, 1.0, kPeriodsOfFig6);
  ASSERT_EQ(phases.size(), 4u);  // A-B, B-C, C-D, D-E
  double least_rolling = HUGE_VAL;
  double most_dragging = 0.0;
  double rolling = 0.0;
  for (const Phase& phase : phases) {
    (phase.rolls ? least_rolling : most_dragging) =
        phase.rolls ? std::min(least_rolling, phase.slope) : std::max(most_dragging, phase.slope);
    if (!phase.rolls) {
      EXPECT_LT(-phase.rotation, 0.1 * phase.advance);
      continue;
    }
    rolling += phase.length;
    // Half the way to the next particle each time, apart from what it turns while it is dragged.
    EXPECT_NEAR(phase.rotation, -kPi / kParticles, 0.03);
    // The centre of this turn is not the bottommost point, as the paper has it, 1 below the
    // centre: the ring advances less than half as far as one that rolls without slip.
    EXPECT_GT(phase.advance / -phase.rotation, 0.3);
    EXPECT_LT(phase.advance / -phase.rotation, 0.5);
  }
  EXPECT_NEAR(rolling, 0.135, 0.01);  // of the period
  // "Friction quickly changes in this phase", "a gradual change" in the next.
  EXPECT_GT(least_rolling, 2.0 * most_dragging);
}

TEST(RollingRingFig6, RollsAllTheTimeForLargeLambda) {
  Trace trace;
  run_shipped(kFig6, {{"lambda", "1"}}, &trace);
  EXPECT_EQ(phases_of_a_period(trace, 1.0, kPeriodsOfFig6).size(), 1u);
  const auto x = period(trace["ring.centre_of_mass.x"], kPeriodsOfFig6, 2);
  const auto rotation = period(trace["ring.rotation"], kPeriodsOfFig6, 2);
  for (std::size_t n = 1; n < x.size(); ++n) {  // never far from the mean, 2 pi R/(N a) = 0.785
    EXPECT_NEAR((rotation[n - 1] - rotation[n]) / (x[n] - x[n - 1]), 2.0 * kPi / kParticles, 0.01);
  }
}

}  // namespace
}  // namespace tomlin::test
