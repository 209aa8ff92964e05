#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 2 and 3 of Sircar and Patra: a ring so small that it is a Prandtl-Tomlinson tip.
namespace tomlin::test {
namespace {

constexpr const char* kFig2 = "rolling_ring/fig_2.toml";
constexpr const char* kFig3 = "rolling_ring/fig_3.toml";
constexpr const char* kFig3Tip = "rolling_ring/fig_3_tip.toml";

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

/// Returns the loss of single slips of a tip per period in the limit of slow driving: from the
/// fold, s cos(2 pi x) = 1, to the next position of rest for the same position of the driver.
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
  double high = 1.0 - low;                        // where it ends
  for (int n = 0; n < 100; ++n) {
    const double middle = 0.5 * (low + high);
    (driver_over(middle) < driver ? low : high) = middle;
  }
  return energy(fold, driver) - energy(low, driver);
}

/// The limit for v -> 0 of what grows as v^(2/3), from its values at some v and at half of it.
double without_smearing(double slow, double slower) {
  const double ratio = std::pow(2.0, 2.0 / 3.0);
  return (ratio * slower - slow) / (ratio - 1.0);
}

TEST(RollingRingFig2, IsStickSlipAlready) {
  const double amplitude = 0.1 * std::abs(share(kParticles, 0.001));
  EXPECT_NEAR(4.0 * kPi * kPi * 0.1 / 2.0, 1.974, 5e-4);  // s, of three decimals
  // Friction stays as the driving slows down, up to v^(2/3), which two velocities take out.
  const double slow = mean_force(run_shipped(kFig2, {{"v", "2e-5"}}));
  const double slower = mean_force(run_shipped(kFig2, {{"v", "1e-5"}}));
  const double limit = without_smearing(slow, slower);
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

/// Fig. 3

/// Force of the driver over its position, there and back, and the work it has done.
struct Hysteresis {
  static constexpr std::size_t kEightPeriods = 800;  // samples

  std::vector<double> position, force;
  double work = 0.0;

  explicit Hysteresis(const char* scene, const std::vector<Setting>& settings = {}) {
    Trace trace;
    work = *run_shipped(scene, settings, &trace).driver(0)["work"];
    position = trace["driver.position.x"];
    force = trace["driver.force.x"];
  }

  std::size_t turn() const {
    const auto furthest = std::max_element(position.begin(), position.end());
    return static_cast<std::size_t>(furthest - position.begin());
  }

  /// Between the branches, from where the driver set out to where it turned round.
  double area() const {
    double area = 0.0;
    for (std::size_t n = 1; n < position.size() && position[n] >= 0.0; ++n) {
      area += 0.5 * (force[n] + force[n - 1]) * (position[n] - position[n - 1]);
    }
    return area;
  }

  /// Mean force over eight periods, from a sample on.
  double mean_from(std::size_t sample) const {
    double sum = 0.0;
    for (std::size_t n = sample; n < sample + kEightPeriods; ++n) sum += force[n];
    return sum / kEightPeriods;
  }
};

/// Largest difference of force at the same sample; their drivers are at the same position.
double difference(const Hysteresis& a, const Hysteresis& b) {
  double largest = 0.0;
  for (std::size_t n = 0; n < a.force.size(); ++n) {
    largest = std::max(largest, std::abs(a.force[n] - b.force[n]));
  }
  return largest;
}

constexpr double kLargestForce = 2.0 * kPi * 0.1;  // of the substrate

TEST(RollingRingFig3, IsTheRingThatIsMovedByHand) {
  constexpr int kSamples = 4000;
  constexpr int kSteps = 125;  // of 0.08 between two samples
  RigidRing ring;
  ring.radius = 0.001;
  ring.lambda = 0.01;
  ring.stiffness = 0.1;
  ring.reverse_above = 10.0;
  Trace trace;
  const auto result = run_shipped(kFig3, {{"lambda", "0.01"}}, &trace);
  const auto samples = ring.trace(kSamples, 0.01 / ring.velocity, kSteps);
  ASSERT_EQ(trace["time"].size(), samples.size());
  EXPECT_LT(difference_to(samples, trace), kSameTrace);
  EXPECT_NEAR(*result.driver(0)["work"] / samples.back().work, 1.0, 1e-8);
  EXPECT_EQ(result.group("events")["driver_reversals"], 1u);
  // A driver that turns round a little later leaves another trace.
  ring.reverse_above += 0.01;
  EXPECT_GT(difference_to(ring, trace, kSteps), 10.0 * kSameTrace);
}

TEST(RollingRingFig3, BranchesAndLoopAreThoseOfATip) {
  constexpr double kSameLoop = 1e-6;
  const Hysteresis ring(kFig3);
  const Hysteresis tip(kFig3Tip);
  EXPECT_NEAR(parameter_of(kFig3Tip, "V"), 0.1 * std::abs(share(kParticles, 0.001)), 1e-16);
  EXPECT_LT(difference(ring, tip) / kLargestForce, kSameLoop);
  EXPECT_NEAR(ring.work / tip.work, 1.0, kSameLoop);
  EXPECT_NEAR(ring.area() / tip.area(), 1.0, kSameLoop);
  EXPECT_NEAR(ring.position[ring.turn()] / tip.position[tip.turn()], 1.0, kSameLoop);
  // The plain tip, of amplitude V0, is another: by (2 pi R/a)^2/4 = 1e-5 in the amplitude.
  const Hysteresis plain(kFig3Tip, {{"R", "0"}});
  EXPECT_GT(difference(ring, plain) / kLargestForce, 100.0 * kSameLoop);
  EXPECT_GT(std::abs(ring.work / plain.work - 1.0), 3.0 * kSameLoop);
  EXPECT_LT(std::abs(ring.work / plain.work - 1.0), 1e-5);
}

TEST(RollingRingFig3, IsNearerToTheTipTheSmallerLambda) {
  const Hysteresis tip(kFig3Tip);
  double last = HUGE_VAL;
  for (const char* lambda : {"1e-2", "1e-3", "1e-4", "1e-5"}) {
    const double away = difference(Hysteresis(kFig3, {{"lambda", lambda}}), tip);
    EXPECT_LT(away, 0.2 * last) << "lambda = " << lambda;
    last = away;
  }
}

TEST(RollingRingFig3, LeavesTheSubstrateForLargeLambdaAndSlipsFurther) {
  // A slip from fold to rest is a little less than whole periods.
  for (const auto& [lambda, periods] :
       {std::pair("0", 1), std::pair("0.1", 3), std::pair("1", 2)}) {
    Trace trace;
    run_shipped(kFig3, {{"lambda", lambda}}, &trace);
    const auto& x = trace["ring.centre_of_mass.x"];
    double longest = 0.0;  // way while the driver moves by a twentieth of a period
    for (std::size_t n = 5; n < x.size(); ++n) longest = std::max(longest, x[n] - x[n - 5]);
    EXPECT_NEAR(longest, periods - 0.1, 0.1) << "lambda = " << lambda;
  }
}

TEST(RollingRingFig3, BranchesAreEachOthersMirrorImage) {
  // The substrate looks the same from both sides: once steady, the way back is the way there.
  // A sample of a slip may fall on either side of it: 0.1 of 0.6, once in a hundred samples.
  constexpr double kSampled = 2e-3;
  const Hysteresis ring(kFig3);
  ASSERT_GT(ring.turn(), 2 * Hysteresis::kEightPeriods);
  const double there = ring.mean_from(Hysteresis::kEightPeriods);
  const double back = ring.mean_from(ring.force.size() - Hysteresis::kEightPeriods);
  EXPECT_NEAR(there / -back, 1.0, kSampled);
}

TEST(RollingRingFig3, LoopIsAsWideAsSlipsAreLossy) {
  // For v -> 0 slips by single periods lose what is between the fold and the next position of rest.
  const auto forward = [](const char* v) {
    return mean_force(run_shipped(kFig3, {{"v", v},
                                          {"run.duration", "16 * a / v"},
                                          {"measure.from", "8 * a / v"},
                                          {"measure.to", "16 * a / v"}}));
  };
  const double loss = quasistatic_loss(0.1 * std::abs(share(kParticles, 0.001)), 0.1);
  EXPECT_NEAR(without_smearing(forward("2e-4"), forward("1e-4")) / loss, 1.0, 1e-4);
}

}  // namespace
}  // namespace tomlin::test
