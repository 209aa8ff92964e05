#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "framework/run/steps/run_plan.hpp"
#include "framework/run/window/blocking.hpp"
#include "tests/support/scenes.hpp"

// [run] until = { error = ..., of = ... }: a run ends as soon as the statistical error of a mean is
// small enough.

namespace tomlin::test {
namespace {

constexpr double kDrag = 0.2;  // coefficient times velocity
constexpr double kStep = 0.1;

/// A particle in the trap of its driver: without other noise than that of its bath the error of the
/// mean force over a time t is sqrt(2 c T/t) = 1/sqrt(t).
std::string dragged(const std::string& until, std::uint64_t stream = 0,
                    const std::string& run = "") {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.0]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [0.2]
[[force]] | name = "bath" | type = "langevin" | coefficient = 1.0 | temperature = 0.5
[run] | duration = 2e5 | until = )") +
         until + "\nseed = 1\nstream = " + std::to_string(stream) +
         "\nintegrator = { type = \"baoab\", dt = 0.1 }\n" + run + "[measure]\nfrom = 20.0\n";
}

std::string within(double error, const std::string& of = "driver.mean_force.x") {
  return "{ error = " + digits(error) + ", of = \"" + of + "\" }";
}

/// c v by h gamma/2 coth(h gamma/2), as baoab drags.
double exact_force() { return kDrag * std::tanh(0.5 * kStep) / (0.5 * kStep); }

TEST(UntilError, ARunEndsWhenItsMeanIsKnownWellEnough) {
  constexpr double kAsked = 0.01;
  constexpr double kLeast = 0.9;  // of it: a look later the error is 1 % smaller, and may scatter
  constexpr double kFourSigma = 4.0;
  for (std::uint64_t stream = 0; stream < 8; ++stream) {
    SCOPED_TRACE(stream);
    const RunResult result = run_text(dragged(within(kAsked), stream));
    ASSERT_EQ(result.status, RunStatus::finished);
    ASSERT_TRUE(result.until_error);
    EXPECT_TRUE(result.until_error->reached);
    EXPECT_EQ(result.until_error->path, "driver.mean_force.x");
    const double error = stated_error(result, "drivers.driver.mean_force.x").value();
    EXPECT_EQ(result.until_error->error, error);
    EXPECT_LE(error, kAsked);
    EXPECT_GE(error, kLeast * kAsked);
    EXPECT_EQ(result.window_from, 20.0);
    EXPECT_EQ(result.window_to, result.end_time);
    EXPECT_NEAR(result.driver(0)["mean_force"][0], exact_force(), kFourSigma * error);
    EXPECT_EQ(count_of(FaultCode::run_until_error_not_reached, result.warnings), 0U);
  }
}

/// The time is that of the closed form. The means scatter by more than the error says, since a run
/// may end when its error is small by chance: measured over 400 runs of some 200 correlation times,
/// 1.22 times, so that intervals of one standard error hold the truth in 56 of 100.
TEST(UntilError, MeansScatterByTheErrorThatWasAskedFor) {
  constexpr double kAsked = 0.05;
  constexpr int kRuns = 200;
  constexpr double kOfTime = 0.2;  // the estimate of the error is known to a tenth
  // Four standard deviations of 200 about what was measured.
  constexpr double kLeastScatter = 1.0;
  constexpr double kMostScatter = 1.45;
  constexpr double kFewestHeld = 0.42;
  constexpr double kMostHeld = 0.70;
  double time = 0.0;
  double squares = 0.0;
  int held = 0;
  for (std::uint64_t stream = 0; stream < kRuns; ++stream) {
    const RunResult result = run_text(dragged(within(kAsked), stream));
    ASSERT_TRUE(result.until_error->reached);
    const double off = result.driver(0)["mean_force"][0] - exact_force();
    squares += off * off;
    held += std::abs(off) <= *result.until_error->error ? 1 : 0;
    time += (result.window_to - result.window_from) / kRuns;
  }
  EXPECT_NEAR(time * kAsked * kAsked, 1.0, kOfTime);
  EXPECT_GT(std::sqrt(squares / kRuns) / kAsked, kLeastScatter);
  EXPECT_LT(std::sqrt(squares / kRuns) / kAsked, kMostScatter);
  EXPECT_GE(held, kFewestHeld * kRuns);
  EXPECT_LE(held, kMostHeld * kRuns);
}

/// A mean over an incomplete period depends on where it ends.
TEST(UntilError, TheWindowHasWholePeriods) {
  const std::string substrate =
      "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.0\n";
  for (const double asked : {0.1, 0.05}) {
    std::string text = dragged(within(asked));
    text.insert(text.find("[run]"), substrate);
    const RunResult result = run_text(text);
    ASSERT_TRUE(result.until_error->reached);
    const double periods = 0.2 * (result.window_to - result.window_from);
    const double block = 0.2 * static_cast<double>(kBlock) * kStep;
    EXPECT_GE(periods, kFewestCorrelationTimes);
    EXPECT_LE(periods - std::floor(periods + 1e-9), block) << asked;
    EXPECT_EQ(count_of(FaultCode::run_window_not_whole, result.warnings), 0U);
  }
}

TEST(UntilError, TheDurationIsTheLimit) {
  for (const auto& [duration, known] : {std::pair{"500.0", true}, std::pair{"60.0", false}}) {
    for (const std::string key : {"run.duration", "run.until.max"}) {
      const RunResult result = run_text(dragged(within(1e-3)), {{key, duration}});
      ASSERT_TRUE(result.until_error);
      EXPECT_FALSE(result.until_error->reached);
      EXPECT_EQ(result.end_time, std::stod(duration));
      EXPECT_EQ(result.window_to, result.end_time);
      EXPECT_EQ(result.until_error->error.has_value(), known);
      EXPECT_EQ(count_of(FaultCode::run_until_error_not_reached, result.warnings), 1U);
    }
  }
}

/// Whatever has an error can be waited for, and is observed even where others are asked for.
TEST(UntilError, OfAnyMeanWithAnError) {
  const std::string slips =
      "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.0\n";
  for (const auto& [path, asked] :
       {std::pair{"drivers.driver.mean_force_along", 0.05}, std::pair{"tip.temperature", 0.02},
        std::pair{"bodies.tip.mean_velocity.x", 0.01}, std::pair{"driver.mean_slip_force", 0.03},
        std::pair{"driver.mean_waiting_time", 0.5}}) {
    SCOPED_TRACE(path);
    std::string text = dragged(within(asked, path)) + "observables = [\"tip.velocity.x\"]\n";
    text.insert(text.find("[run]"), slips);
    const RunResult result = run_text(text, {{"force.bath.temperature", "0.05"}});
    EXPECT_TRUE(result.until_error->reached);
    EXPECT_LE(*result.until_error->error, asked);
    EXPECT_TRUE(observable(result, path));
    EXPECT_LT(result.end_time, 2e5);
  }
}

TEST(UntilError, GoesOnFromAnyStep) {
  for (const std::string of : {"driver.mean_force.x", "driver.mean_slip_force"}) {
    std::string text = dragged(within(0.1, of));
    text.insert(text.find("[run]"),
                "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.0\n");
    const auto scene = scene_of(text);
    Engine whole(scene, {});
    const RunResult expected = whole.run();
    ASSERT_TRUE(expected.until_error->reached);
    for (std::uint64_t steps = 1; steps < expected.steps; steps += 1 + expected.steps / 37) {
      Engine engine(scene, {});
      engine.advance(steps);
      const std::vector<std::byte> bytes = engine.state().to_bytes();
      RunOptions options;
      options.resume_from = &bytes;
      Engine resumed(scene, options);
      const RunResult result = resumed.run();
      ASSERT_TRUE(Motion(resumed) == Motion(whole));
      ASSERT_EQ(result.end_time, expected.end_time);
      ASSERT_EQ(result.driver(0)["mean_force"], expected.driver(0)["mean_force"]);
      ASSERT_EQ(result.until_error->error, expected.until_error->error);
      ASSERT_TRUE(result.until_error->reached);
    }
  }
}

TEST(UntilError, WhatIsRefused) {
  const auto refused = [](std::string text) { return brief_refusal(text); };
  const std::string valid = within(0.01);
  EXPECT_EQ(refused(dragged(valid)), "");
  EXPECT_EQ(refused(dragged("{ error = 0.01, of = \"driver.mean_forces.x\" }")),
            "18:30 driver.mean_forces.x [observable.unknown] did you mean driver.mean_force.x");
  EXPECT_EQ(refused(dragged(within(0.01, "driver.max_force.x"))),
            "18:30 run.until.of = \"driver.max_force.x\" [run.until_never] did you mean "
            "drivers.driver.mean_force.x");
  EXPECT_EQ(refused(dragged("{ error = 0.01 }")), "18:9 run.until.of [scene.missing_key]");
  EXPECT_EQ(refused(dragged("{ of = \"driver.mean_force.x\" }")),
            "18:9 run.until.error [scene.missing_key]");
  EXPECT_EQ(refused(dragged("{ error = 0.0, of = \"driver.mean_force.x\" }")),
            "18:19 run.until.error = 0.0 [scene.out_of_range]");
  EXPECT_EQ(refused(dragged("{ error = 0.01, of = \"driver.mean_force.x\", tolerance = 1e-3 }")),
            "18:53 run.until.tolerance [scene.unknown_key]");
  EXPECT_EQ(refused(dragged(valid, 0, "repeats = 4\n")),
            "22:11 run.repeats = 4 [component.unsuitable]");
  EXPECT_EQ(refused(dragged(valid) + "to = 100.0\n"), "24:6 measure.to = 100.0 [scene.conflict]");
  std::string cold = dragged(valid);
  cold.replace(cold.find("temperature = 0.5"), 17, "temperature = 0.0");
  EXPECT_EQ(refused(cold), "18:9 run.until [run.until_never]");
}

}  // namespace
}  // namespace tomlin::test
