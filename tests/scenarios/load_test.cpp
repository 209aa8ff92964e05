// scenarios/load: a tip and a ring pressed on a surface that repels.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

const std::string kPressedTip = "load/tip.toml";
const std::string kPressedRing = "load/ring.toml";
constexpr double kDecay = 10.0;  // w
constexpr double kAlpha = 0.2;
constexpr double kSoftSpring = 0.05;  // k

double pull_of(const RunResult& result, const char* what) {
  return observable(result, std::string("driver.") + what + ".x").value();
}

TEST(Load, StaticFrictionOfATipObeysAmontonsLaw) {
  const double coefficient = 2.0 * kPi / kDecay * kAlpha / std::sqrt(1.0 - kAlpha * kAlpha);
  // Extremes between points of the path are those of its interpolation.
  constexpr double kInterpolated = 1e-7;
  for (const double load : {0.01, 0.1, 1.0, 3.0}) {
    const RunResult result = run_shipped(kPressedTip, {{"L", text_of(load)}});
    EXPECT_NEAR(pull_of(result, "max_force"), coefficient * load, kInterpolated * load) << load;
  }
}

TEST(Load, KineticFrictionNeedsAnInstability) {
  const double least = kSoftSpring * kDecay * (1.0 + kAlpha) / (4.0 * kPi * kPi * kAlpha);
  for (const double part : {0.5, 0.98}) {
    const RunResult below = run_shipped(kPressedTip, {{"L", text_of(part * least)}});
    EXPECT_EQ(observable(below, "events.slips").value(), 0.0) << part;
    EXPECT_NEAR(pull_of(below, "mean_force"), 0.0, 1e-10) << part;
  }
  for (const double part : {1.02, 2.0}) {
    const RunResult above = run_shipped(kPressedTip, {{"L", text_of(part * least)}});
    EXPECT_GE(observable(above, "events.slips").value(), 18.0) << part;
    EXPECT_GT(pull_of(above, "mean_force"), 1e-8) << part;
  }
}

TEST(Load, ASteeperCorrugationGrowsAsAPowerOfTheLoad) {
  for (const double ratio : {1.5, 2.0}) {
    for (const double load : {0.03, 0.1, 0.3}) {
      const RunResult result =
          run_shipped(kPressedTip, {{"L", text_of(load)},
                                    {"d", text_of(ratio) + " * w"},
                                    {"body.tip.position", "[\"a / 2\", \"log(W * w / L) / w\"]"}});
      const double expected = 2.0 * kPi * kAlpha * std::pow(load / kDecay, ratio);
      // First order in the corrugation at that height.
      const double second = 3.0 * kAlpha * std::pow(load / kDecay, ratio - 1.0);
      EXPECT_NEAR(pull_of(result, "max_force") / expected, 1.0, second) << ratio << ", " << load;
    }
  }
}

TEST(Load, ARingThatRollsPaysTheDragAlone) {
  for (const double load : {0.1, 1.0}) {
    const RunResult rolls = run_shipped(kPressedRing, {{"L", text_of(load)}});
    EXPECT_NEAR(pull_of(rolls, "mean_force"), 0.02, 2e-5) << load;
    EXPECT_NEAR(observable(rolls, "ring.rolling").value(), 1.0, 1e-6) << load;
  }
}

TEST(Load, ARingThatCannotTurnHasACoefficientOfFriction) {
  const std::vector<Setting> held = {{"body.ring.hold", "[\"rotation\"]"}};
  const auto friction = [&](double load) {
    std::vector<Setting> settings = held;
    settings.push_back({"L", text_of(load)});
    return pull_of(run_shipped(kPressedRing, settings), "mean_force") / load;
  };
  EXPECT_NEAR(friction(1.0), friction(10.0), 0.01);
  EXPECT_NEAR(friction(10.0), 0.12, 0.01);
}

}  // namespace
}  // namespace tomlin::test
