#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 7 and 8 of Sircar and Patra: slow and fast rings.
namespace tomlin::test {
namespace {

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
  // Where rolling ends friction falls with the velocity.
  EXPECT_GT(mean_force(run_shipped(kFig7, {{"v", "0.01"}})),
            1.05 * mean_force(run_shipped(kFig7, {{"v", "0.02"}})));
}

/// What the corrugation adds to the mean force of a ring in fast motion: it is shaken at the
/// washboard frequency along x, y and its rotation, and each loses to drag.
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

}  // namespace
}  // namespace tomlin::test
