#include "framework/study/tradeoff/methods.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/study/tradeoff/trial_run.hpp"
#include "tests/support/ring_scenes.hpp"

namespace tomlin::test {
namespace {

std::vector<Method> ladder_of(const std::string& text) {
  return methods_for(Variants(scene_of(text), standard()));
}

const Method& named(const std::vector<Method>& methods, std::string_view name) {
  for (const Method& method : methods) {
    if (method.name == name) return method;
  }
  throw std::logic_error("no method " + std::string(name));
}

bool has(const std::vector<Method>& methods, const std::string& name) {
  return std::any_of(methods.begin(), methods.end(),
                     [&name](const Method& method) { return method.name == name; });
}

TEST(Ladder, HasEveryIntegrator) {
  const std::vector<Method> methods = ladder_of(TipScene().text());
  for (const auto& integrator : standard().integrators()) {
    if (integrator->follows_equilibria) continue;
    if (integrator->half_step_velocities || !integrator->with_inertia) {
      EXPECT_FALSE(has(methods, integrator->name)) << "for noise";
      continue;
    }
    EXPECT_TRUE(has(methods, integrator->name)) << integrator->name;
  }
}

TEST(Ladder, WhatASceneRefusesStaysWithItsReason) {
  const std::vector<Method> methods =
      ladder_of(TipScene{.more = "dynamics = \"overdamped\"\n"}.text());
  EXPECT_NE(named(methods, "velocity_verlet").refused, "");
  EXPECT_EQ(named(methods, "rk4").refused, "");
  EXPECT_FALSE(has(methods, "overdamped, rk4")) << "the scene is so already";
}

TEST(Ladder, FixedStepsKnowHowFarTheyMayGo) {
  // Velocity Verlet: 2/omega, omega^2 = stiffness + (2 pi / period)^2 amplitude.
  const double pi = std::acos(-1.0);
  const double omega = std::sqrt(2.0 + 0.1 * 4.0 * pi * pi);
  constexpr double kRounding = 1e-9;
  const std::vector<Method> methods = ladder_of(TipScene().text());
  EXPECT_NEAR(named(methods, "velocity_verlet").stable_step, 2.0 / omega, kRounding);
  EXPECT_TRUE(std::isinf(named(methods, "dopri5").stable_step));
}

TEST(Ladder, SimplerModelsOfAFlexibleRing) {
  const std::vector<Method> flexible = ladder_of(RingScene().text());
  EXPECT_EQ(named(flexible, "rigid, rk4").refused, "");
  EXPECT_EQ(named(flexible, "rigid, overdamped, rk4").refused, "");
  EXPECT_FALSE(named(flexible, "rigid, rk4").is_own_model());
  EXPECT_TRUE(named(flexible, "rk4").is_own_model());
  EXPECT_GT(named(flexible, "rigid, rk4").stable_step, 2.0 * named(flexible, "rk4").stable_step)
      << "its springs are gone";
  EXPECT_FALSE(has(ladder_of(RingScene{.coordinates = "rigid"}.text()), "rigid, rk4"));
  EXPECT_FALSE(has(ladder_of(TipScene().text()), "rigid, rk4")) << "a single particle";
}

TEST(Ladder, ARungIsItsLinesInTheScene) {
  const auto scene = scene_of(RingScene().text());
  const Variants variants(scene, standard());
  int rungs = 0;
  for (const Method& method : methods_for(variants)) {
    if (!method.refused.empty()) continue;
    ++rungs;
    const auto variant = variants.with(method.at(0.0078125));
    EXPECT_EQ(variant->run.integrator.name, method.integrator->name);
    EXPECT_EQ(variant->run.number_type, method.number_type);
    const void* description = variant->run.integrator.description.get();
    const double given = method.resolution == Resolution::step
                             ? method.integrator->step(description)
                             : method.integrator->tolerance(description);
    EXPECT_EQ(given, 0.0078125) << method.name;
  }
  EXPECT_GT(rungs, 10);
}

TEST(Ladder, AbsoluteTolerancesArePartsOfTheScenesLength) {
  TipScene tip{.integrator =
                   "{ type = \"dopri5\", absolute_tolerance = 1e-12, "
                   "relative_tolerance = 1e-9 }"};
  EXPECT_DOUBLE_EQ(named(ladder_of(tip.text()), "dopri5").absolute_share, 1.0);
  tip.period = 0.25;
  EXPECT_DOUBLE_EQ(named(ladder_of(tip.text()), "dopri5").absolute_share, 0.25);
}

TEST(TrialRun, IsTheRun) {
  const std::string text = TipScene().text();
  const TrialRun trial = try_run(scene_of(text));
  ASSERT_TRUE(trial.finished());
  const RunResult result = run_text(text);
  EXPECT_TRUE(same_bits(trial.result.driver(0)["mean_force"], result.driver(0)["mean_force"]));
  EXPECT_EQ(trial.cost(), result.force_evaluations + result.jacobian_columns);
  EXPECT_EQ(trial.part(), 1.0);
}

TEST(TrialRun, EndsWhenTimeIsUp) {
  constexpr double kLimit = 0.05;
  constexpr double kSoon =
      60.0;  // seconds on a busy machine: the whole run takes a quarter of an hour
  const TrialRun trial = try_run(scene_of(TipScene{.duration = 1e9}.text()), {.seconds = kLimit});
  EXPECT_EQ(trial.end, TrialRun::End::over_budget);
  EXPECT_GT(trial.cost(), 0U);
  EXPECT_GT(trial.part(), 0.0);
  EXPECT_LT(trial.part(), 1.0);
  EXPECT_LT(trial.seconds, kSoon);
}

TEST(TrialRun, SaysWhyItFailedOrWasRefused) {
  const TrialRun unstable = try_run(scene_of(TipScene{.integrator = fixed_step(10.0)}.text()));
  EXPECT_EQ(unstable.end, TrialRun::End::failed);
  EXPECT_NE(unstable.why.find("stability limit"), std::string::npos);
  const TrialRun refused = try_run(
      scene_of(TipScene{.integrator = verlet(0.01), .more = "dynamics = \"overdamped\"\n"}.text()));
  EXPECT_EQ(refused.end, TrialRun::End::refused);
  EXPECT_NE(refused.why, "");
}

TEST(TrialRun, ASignalStopsIt) {
  const std::atomic<bool> stop = true;
  const TrialRun trial = try_run(scene_of(TipScene{.duration = 1e9}.text()), {.stop = &stop});
  EXPECT_EQ(trial.end, TrialRun::End::interrupted);
}

}  // namespace
}  // namespace tomlin::test
