#include "framework/run/guard/trial.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// A trial is a piece of the run, and takes no longer than it is told.

namespace tomlin::test {
namespace {

constexpr double kLong = 60.0;  // seconds; none of these runs takes as many

TEST(TryOut, AShortRunIsRunWhole) {
  for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-8)}) {
    const TipScene tip{.duration = 20.005, .integrator = integrator};
    const Trial trial = try_out(scene_of(tip.text()), kLong);
    const RunResult result = run_text(tip.text());
    EXPECT_TRUE(trial.finished);
    EXPECT_FALSE(trial.failure);
    EXPECT_EQ(trial.steps, result.steps);
    EXPECT_EQ(trial.evaluations, result.force_evaluations);
    EXPECT_EQ(trial.time, 20.005);
    EXPECT_LT(trial.seconds, kLong);
  }
}

TEST(TryOut, ARunThatEndsWhenItIsSteadyIsWholeToo) {
  const RingScene ring{
      .coordinates = "rigid", .velocity = 0.02, .duration = 5000.0, .integrator = adaptive(1e-9)};
  const Trial trial =
      try_out(scene_of(ring.text(),
                       {{"run.until", "{ steady = \"driver.mean_force.x\", tolerance = 1e-4 }"}}),
              kLong);
  EXPECT_TRUE(trial.finished);
  EXPECT_FALSE(trial.failure);
  EXPECT_LT(trial.time, 5000.0);
}

TEST(TryOut, ALongRunIsLeftEarly) {
  const Trial trial = try_out(scene_of(TipScene{.duration = 1e9}.text()), 0.01);
  EXPECT_FALSE(trial.finished);
  EXPECT_FALSE(trial.failure);
  EXPECT_GT(trial.steps, 0u);
  EXPECT_LT(trial.time, 1e9);
  EXPECT_GE(trial.seconds, 0.01);
  EXPECT_EQ(try_out(scene_of(TipScene{}.text()), 0.0).steps, 0u);
}

TEST(TryOut, AStepThatIsTooLongIsNotTaken) {
  const Trial valid = try_out(scene_of(TipScene{}.text()), 0.0);
  EXPECT_TRUE(valid.step_is_stable);
  const std::string text = TipScene{.integrator = fixed_step(1.01 * valid.stable_step)}.text();
  for (const char* insists : {"false", "true"}) {
    const Trial trial = try_out(scene_of(text, {{"run.allow_unstable", insists}}), kLong);
    EXPECT_FALSE(trial.step_is_stable);
    EXPECT_EQ(trial.stable_step, valid.stable_step);
    EXPECT_EQ(trial.steps, 0u);
  }
  EXPECT_TRUE(std::isinf(
      try_out(scene_of(TipScene{.integrator = adaptive(1e-8)}.text()), 0.0).stable_step));
}

TEST(TryOut, RefusesWhatARunRefuses) {
  const std::string window = "[measure]\nfrom = 0.0\nto = 100.0\nin = \"time\"\n";
  EXPECT_THROW(try_out(scene_of(TipScene{.more = window}.text()), 0.0), InputError);
}

}  // namespace
}  // namespace tomlin::test
