// scenarios/disorder: a chain on random pinning depins as a saddle-node bifurcation does.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

double velocity_of_chain(double force, std::vector<Setting> settings = {}) {
  settings.push_back({"F", text_of(force)});
  const RunResult result = run_shipped("disorder/chain.toml", settings);
  return observable(result, "chain.mean_velocity.x").value();
}

TEST(Disorder, InOrderAChainIsOneParticle) {
  const std::vector<Setting> in_order = {{"force.pinning.offset", "0.0"}};
  for (const double force : {1.05, 1.25, 2.0}) {
    const double expected = std::sqrt(force * force - 1.0);
    // The window is no number of periods.
    EXPECT_NEAR(velocity_of_chain(force, in_order), expected, 1e-3) << force;
  }
  EXPECT_NEAR(velocity_of_chain(0.99, in_order), 0.0, 1e-9);
}

TEST(Disorder, HoldsTheChainBelowOneForceAndEachSampleBelowItsOwn) {
  EXPECT_NEAR(velocity_of_chain(0.709), 0.0, 1e-7);
  EXPECT_GT(velocity_of_chain(0.712), 0.02);
  const std::vector<Setting> other = {{"seed", "3"}};
  EXPECT_NEAR(velocity_of_chain(0.74, other), 0.0, 1e-7);
  EXPECT_GT(velocity_of_chain(0.77, other), 0.02);
}

TEST(Disorder, TheVelocityGrowsAsTheRootOfTheForceBeyond) {
  // v^2 is linear in F, with the threshold 0.7101984 as its zero.
  const double near = velocity_of_chain(0.71023);
  const double far = velocity_of_chain(0.71031);
  const double slope = (far * far - near * near) / (0.71031 - 0.71023);
  EXPECT_NEAR(0.71023 - near * near / slope, 0.7101984, 1e-5);
}

}  // namespace
}  // namespace tomlin::test
