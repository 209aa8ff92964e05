#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/study/compare.hpp"
#include "tests/scenarios/scenario_fixture.hpp"
#include "tests/support/paths.hpp"

/// The three questions of scenarios/comparison, against what is known without the program.
namespace tomlin::test {
namespace {

using Verdict = ComparedModel::Verdict;

Comparison compared(const std::vector<std::string>& files, double tolerance,
                    const std::vector<Setting>& settings = {}) {
  std::vector<std::shared_ptr<const Scene>> scenes;
  for (const std::string& file : files) {
    scenes.push_back(read_scene(std::string(paths::source) + "/scenarios/comparison/" + file,
                                registry(), settings));
  }
  return compare_models(scenes, {"driver.mean_force.x", tolerance});
}

double value(const Comparison& comparison, std::size_t k) {
  return comparison.models.at(k).value.value();
}

/// All scenes ask for this accuracy; two of them may differ by twice as much.
constexpr double kAccuracy = 2e-6;

TEST(Comparison, ARingIsATipWhereItIsSmallAndTheForceDoesNotDieOff) {
  const Comparison found = compared({"tip.toml", "ring_small.toml", "ring_small_decay.toml"}, 1e-3);
  // Averaged over the ring the corrugation loses 1 - J0(2 pi R/a), and the mean force follows.
  const double lost = 1.0 - std::cyl_bessel_j(0.0, 2.0 * kPi * 1e-3);
  const double less = 1.0 - value(found, 1) / value(found, 0);
  EXPECT_GT(less, lost);
  EXPECT_LT(less, 3.0 * lost);
  // The force as it is with the amplitude lowered by that.
  const Comparison lowered =
      compared({"tip.toml", "tip.toml"}, 1e-3, {{"V0", text_of(0.1 * (1.0 - lost))}});
  EXPECT_NEAR(value(lowered, 0), value(found, 1), kAccuracy * value(found, 1));
  EXPECT_LT(value(found, 2), 0.95 * value(found, 0));
}

TEST(Comparison, AFlexibleRingIsARigidOneAsItsSpringsStiffen) {
  const Comparison soft = compared({"ring_rigid.toml", "ring_flexible.toml"}, 1e-4);
  EXPECT_EQ(soft.reference, 1U);
  EXPECT_EQ(soft.simplest, 0U);
  EXPECT_EQ(soft.models[0].coordinates, 3U);
  EXPECT_EQ(soft.models[1].coordinates, 16U);
}

TEST(Comparison, AChainIsSoManyTipsUnlessItsSpringsAreStiffAndItsSpacingIsWrong) {
  const Comparison found = compared({"tip_for_tips.toml", "tips.toml", "chain_in_step.toml",
                                     "chain_soft.toml", "chain_stiff.toml"},
                                    1e-2);
  const Comparison tip = compared({"tip.toml", "tip.toml"}, 1e-2);
  const double all = 13.0 * value(tip, 0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(value(found, k), all, kAccuracy * all) << k;
  // Soft springs change little, stiff ones leave the drag N xi v and a thousandth more.
  EXPECT_LT(value(found, 3), 0.99 * all);
  EXPECT_GT(value(found, 3), 0.95 * all);
  const double drag = 13.0 * 2.0 * std::sqrt(2.0) * 0.01;
  EXPECT_GT(value(found, 4), drag);
  EXPECT_LT(value(found, 4), 1.002 * drag);
}

}  // namespace
}  // namespace tomlin::test
