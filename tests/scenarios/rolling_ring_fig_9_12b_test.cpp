#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 9 and 12b of Sircar and Patra: small rings, which hop, and a large one.
namespace tomlin::test {
namespace {

/// Fig. 9

TEST(RollingRingFig9, IsTheRingThatIsMovedByHand) {
  for (const double radius : {0.001, 0.01, 0.1}) {
    RigidRing ring;
    ring.radius = radius;
    ring.lambda = 1.0;
    const auto trace = two_periods(kFig9, {{"R", text_of(radius)}});
    EXPECT_LT(difference_to(ring, trace, 1000), kSameTrace) << "R = " << radius;
  }
}

/// The samples after the first of ten periods.
std::vector<double> steady(const std::vector<double>& column) {
  return {column.begin() + static_cast<std::ptrdiff_t>(column.size() / 10), column.end()};
}

/// How often values rise through a level.
int rises(const std::vector<double>& values, double level) {
  int count = 0;
  for (std::size_t n = 1; n < values.size(); ++n) {
    if (values[n - 1] < level && level <= values[n]) ++count;
  }
  return count;
}

struct SmallRing {
  const char* radius;
  int slips;  ///< per period
};

TEST(RollingRingFig9, HopsAndDoesNotTurn) {
  // "A hopping event is followed with intermittent dragging" at 0.001 and 0.01, and the force
  // changes abruptly twice; at 0.1 "the hopping is continuous".
  for (const SmallRing ring : {SmallRing{"0.001", 2}, SmallRing{"0.01", 2}, SmallRing{"0.1", 1}}) {
    Trace trace;
    const auto result = run_shipped(kFig9, {{"R", ring.radius}}, &trace);
    EXPECT_NEAR(turns(result), 0.0, 1e-3) << "R = " << ring.radius;
    const auto y = steady(trace["ring.centre_of_mass.y"]);
    const auto [low, high] = std::minmax_element(y.begin(), y.end());
    EXPECT_EQ(rises(y, 0.5 * (*low + *high)), 9) << "R = " << ring.radius;
    const auto vx = steady(trace["ring.velocity.x"]);
    const auto vy = steady(trace["ring.velocity.y"]);
    std::vector<double> speed;
    for (std::size_t n = 0; n < vx.size(); ++n) speed.push_back(std::hypot(vx[n], vy[n]));
    EXPECT_EQ(rises(speed, 20.0 * 1e-3), 9 * ring.slips) << "R = " << ring.radius;
  }
  // The large ring of Table I rolls.
  EXPECT_NEAR(turns(run_shipped(kFig9, {{"R", "1"}})), -9.0 / kParticles, 1e-8);
}

TEST(RollingRingFig9, SmallestRingIsPulledDownToTheSubstrate) {
  // In the middle of a well, to first order in y: k (y - R) = -2 b V0 y, b = lambda/R.
  Trace trace;
  run_shipped(kFig9, {{"R", "0.001"}}, &trace);
  const auto x = steady(trace["ring.centre_of_mass.x"]);
  const auto y = steady(trace["ring.centre_of_mass.y"]);
  const auto from_middle = [](double place) { return std::abs(place - std::floor(place) - 0.5); };
  std::size_t middle = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (from_middle(x[n]) < from_middle(x[middle])) middle = n;
  }
  EXPECT_NEAR(y[middle] / (2.0 * 0.001 / (2.0 + 2.0 * 1000.0 * 0.1)), 1.0, 5e-3);
}

}  // namespace
}  // namespace tomlin::test
