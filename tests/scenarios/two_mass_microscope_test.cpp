// scenarios/two_mass_microscope: a cantilever and a tip are springs in series.

#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

RunResult microscope(std::vector<Setting> settings) {
  settings.push_back({"v", "1e-3"});
  settings.push_back({"run.integrator.dt", "0.02"});
  return run_shipped("two_mass_microscope/microscope.toml", settings);
}

double mean_reading(const RunResult& result) {
  return observable(result, "support.mean_force.x").value();
}

TEST(TwoMassMicroscope, SlipsBelowTheThresholdOfTheSeries) {
  // 8 pi^2 V0 = 7.896.
  for (const char* stiffness : {"6", "7.5"}) {
    const RunResult result = microscope({{"K", stiffness}, {"kt", stiffness}});
    EXPECT_EQ(observable(result, "events.slips").value(), 20.0) << stiffness;
  }
  const RunResult smooth = microscope({{"K", "8.5"}, {"kt", "8.5"}});
  EXPECT_EQ(observable(smooth, "events.slips").value(), 0.0);
}

TEST(TwoMassMicroscope, TheMeanIsTheFrictionOfTheContactWhateverTheMass) {
  const double light = mean_reading(microscope({{"M", "0.1"}}));
  const double heavy = mean_reading(microscope({{"M", "10"}}));
  EXPECT_NEAR(heavy / light, 1.0, 0.01);
  EXPECT_GT(light, 0.3);
  // Shaken by a cantilever that rings it is less.
  EXPECT_LT(mean_reading(microscope({{"M", "100"}, {"Xi", "0.02"}})), 0.7 * light);
}

}  // namespace
}  // namespace tomlin::test
