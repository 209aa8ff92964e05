#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_phases.hpp"
#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 7 and 8 of Sircar and Patra: slow and fast rings.
namespace tomlin::test {
namespace {

constexpr const char* kFig7 = "rolling_ring/fig_7.toml";
constexpr const char* kFig8 = "rolling_ring/fig_8.toml";

/// Fig. 7

/// Fig. 7

TEST(RollingRingFig7, IsTheRingThatIsMovedByHand) {
  for (const double v : {0.005, 0.05}) {
    RigidRing ring;
    ring.lambda = 0.01;
    ring.velocity = v;
    const auto trace = two_periods(kFig7, {{"v", text_of(v)}});
    EXPECT_LT(difference_to(ring, trace, 200), kSameTrace) << "v = " << v;
  }
}

TEST(RollingRingFig7, RollsWhenSlowAndIsDraggedWhenFast) {
  // Over ten periods, after ten to settle in.
  constexpr double kGear = 1.0 + (2.0 * kPi / kParticles) * (2.0 * kPi / kParticles);
  for (const double v : {0.0005, 0.001, 0.005, 0.01}) {
    const auto result = run_shipped(kFig7, {{"v", text_of(v)}});
    EXPECT_NEAR(turns(result), -10.0 / kParticles, 1e-6) << "v = " << v;
    EXPECT_GT(mean_force(result), kDamping * v * kGear) << "v = " << v;
  }
  for (const double v : {0.02, 0.05, 0.1}) {
    const auto result = run_shipped(kFig7, {{"v", text_of(v)}});
    EXPECT_NEAR(turns(result), 0.0, 1e-5) << "v = " << v;
    EXPECT_GT(mean_force(result), kDamping * v) << "v = " << v;
  }
  // At the paper's fast end no ring that rolls could have so little friction.
  EXPECT_LT(mean_force(run_shipped(kFig7, {{"v", "0.1"}})), kDamping * 0.1 * kGear);
  // Friction falls with the velocity at the end of rolling.
  EXPECT_GT(mean_force(run_shipped(kFig7, {{"v", "0.01"}})),
            1.05 * mean_force(run_shipped(kFig7, {{"v", "0.02"}})));
}

/// Returns the part of the corrugation in the mean force of a ring in fast motion: it is shaken at
/// the washboard frequency along x, y and its rotation, and each loses to drag.
double shaking(double v, double lambda) {
  using Complex = std::complex<double>;
  const double omega = 2.0 * kPi * v;
  Complex fx = 0.0, fy = 0.0, ft = 0.0;
  for (int i = 0; i < kParticles; ++i) {
    const double angle = 2.0 * kPi * i / kParticles;
    const double y = 1.0 + std::sin(angle);
    const Complex wave = 0.1 / kParticles * std::exp(-lambda * y * y) *
                         std::exp(Complex(0.0, 2.0 * kPi * std::cos(angle)));
    const Complex x_share = wave * Complex(0.0, -2.0 * kPi);  // sin is Re of -i exp
    const Complex y_share = wave * 2.0 * lambda * y;
    fx += x_share;
    fy += y_share;
    ft += std::cos(angle) * y_share - std::sin(angle) * x_share;
  }
  const auto lost = [&](Complex force, double stiffness) {
    const Complex answer = force / Complex(stiffness - omega * omega, kDamping * omega);
    return 0.5 * kDamping * omega * omega * std::norm(answer);
  };
  return (lost(fx, 2.0) + lost(fy, 2.0) + lost(ft, 0.0)) / v;
}

TEST(RollingRingFig7, IsOnlyShakenWhenVeryFast) {
  const double v = 1.0;
  const auto result = run_shipped(kFig7, {{"v", text_of(v)},
                                          {"run.duration", "40 * a / v"},
                                          {"measure.from", "20"},
                                          {"measure.to", "40"}});
  const double added = mean_force(result) - kDamping * v;
  // The next order is the square of how far the ring is shaken, 2 pi times 0.005 of a period.
  EXPECT_NEAR(added / shaking(v, 0.01), 1.0, 2e-3);
}

TEST(RollingRingFig7, HasKinksWhenSlowAndNoneWhenFast) {
  constexpr double kKink = 3.0;  // change of slope
  constexpr double kWithin = 0.01;
  constexpr int kPeriods = 20;
  const auto sharpest = [&](double v) {
    Trace trace;
    run_shipped(kFig7, {{"v", text_of(v)}}, &trace);
    return sharpest_kink(period(trace["driver.position.x"], kPeriods, kPeriods - 1),
                         period(trace["driver.force.x"], kPeriods, kPeriods - 1), kWithin);
  };
  for (const double v : {0.0005, 0.001, 0.005, 0.01}) {
    EXPECT_GT(sharpest(v), 1.5 * kKink) << "v = " << v;
  }
  // At 0.02, which the paper does not name, the ring does not roll: no kinks there either.
  for (const double v : {0.02, 0.05, 0.1}) EXPECT_LT(sharpest(v), 0.75 * kKink) << "v = " << v;
}

TEST(RollingRingFig7, AKinkIsSeenAndATurningPointIsNone) {
  std::vector<double> position, wave, saw;
  for (int n = 0; n <= 500; ++n) {
    position.push_back(0.002 * n);
    wave.push_back(std::sin(2.0 * kPi * position.back()));
    saw.push_back(n < 400 ? position.back() : 4.0 * (1.0 - position.back()));  // slopes 1 and -4
  }
  EXPECT_LT(sharpest_kink(position, wave, 0.01), 1.5);
  EXPECT_NEAR(sharpest_kink(position, saw, 0.01), 4.0, 1e-9);
}

/// Fig. 8

struct Motion {
  double v;
  std::size_t phases;  ///< a period
};

constexpr int kPeriodsOfFig8 = 11;

TEST(RollingRingFig8, IsDraggedAndRollsWhenSlow) {
  for (const Motion motion : {Motion{0.0005, 4}, Motion{0.001, 4}, Motion{0.005, 4},
                              Motion{0.01, 4}, Motion{0.02, 1}, Motion{0.05, 1}, Motion{0.1, 1}}) {
    Trace trace;
    const auto result = run_shipped(kFig8, {{"v", text_of(motion.v)}}, &trace);
    const auto phases = phases_of_a_period(trace, 1.0, kPeriodsOfFig8);
    EXPECT_EQ(phases.size(), motion.phases) << "v = " << motion.v;
    const bool rolls = motion.phases > 1;
    EXPECT_TRUE(rolls || !phases.front().rolls) << "v = " << motion.v;
    EXPECT_NEAR(turns(result), rolls ? -1.0 / kParticles : 0.0, 1e-6) << "v = " << motion.v;
  }
}

/// By how much a particle's way over a period differs from that of the centre.
double besides_translation(const Trace& trace) {
  const auto& x = trace["ring.centre_of_mass.x"];
  const auto& y = trace["ring.centre_of_mass.y"];
  const std::size_t first = x.size() - 1 - (x.size() - 1) / kPeriodsOfFig8;
  double largest = 0.0;
  for (std::size_t n = first; n < x.size(); ++n) {
    for (std::size_t i = 0; i < kParticles; ++i) {
      const double dx = trace.position(n, i, 0) - trace.position(first, i, 0) - (x[n] - x[first]);
      const double dy = trace.position(n, i, 1) - trace.position(first, i, 1) - (y[n] - y[first]);
      largest = std::max(largest, std::hypot(dx, dy));
    }
  }
  return largest;
}

TEST(RollingRingFig8, IsMovedWithoutTurningWhenFast) {
  // "A translation motion": the ring rocks a little under way, by 0.018 and 0.007 rad.
  const auto moved = [](const char* v) {
    Trace trace;
    run_shipped(kFig8, {{"v", v}}, &trace);
    return besides_translation(trace);
  };
  EXPECT_LT(moved("0.05"), 0.02);
  EXPECT_LT(moved("0.1"), 0.01);
  EXPECT_GT(moved("0.02"), 0.05);
  EXPECT_GT(moved("0.01"), 0.7);  // 2 sin(pi/8), the way of a turn by 1/8
}

TEST(RollingRingFig8, SlopeTellsRollingOnlyWhenSlow) {
  // "The slope of friction is more when rolling occurs than sliding": of both rolling phases up to
  // 0.001; of one of them from 0.005 on.
  for (const double v : {0.0005, 0.001, 0.005, 0.01}) {
    Trace trace;
    run_shipped(kFig8, {{"v", text_of(v)}}, &trace);
    double gentlest = HUGE_VAL;
    double steepest = 0.0;
    double dragging = 0.0;
    for (const Phase& phase : phases_of_a_period(trace, 1.0, kPeriodsOfFig8)) {
      if (!phase.rolls) {
        dragging = std::max(dragging, phase.slope);
      } else {
        gentlest = std::min(gentlest, phase.slope);
        steepest = std::max(steepest, phase.slope);
      }
    }
    EXPECT_GT(steepest, 2.0 * dragging) << "v = " << v;
    EXPECT_EQ(gentlest > dragging, v < 0.002) << "v = " << v;
  }
}

}  // namespace
}  // namespace tomlin::test
