#include "framework/study/accuracy/accuracy.hpp"

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/memory_store.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kTip = R"(
[parameters]
v = 0.01
xi = 2.0
k = 1.0
[[body]]
type = "point"
name = "tip"
position = [0.0]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = "k"
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = "xi"
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = "6 / v"
accuracy = 1e-4
[measure]
from = 2.0
to = 6.0
in = "driver_periods"
)";

constexpr const char* kRing = R"(
[parameters]
lambda = 1.0
[[body]]
type = "ring"
name = "ring"
count = 8
radius = 1.0
particle_mass = 0.125
centre = [0.0, 1.0]
coordinates = "rigid"
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [1e-2, 0.0]
[[force]]
type = "viscous_damping"
coefficient = "2 * sqrt(2) / 8"
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.0125
period = 1.0
decay = "lambda"
[run]
duration = 400.0
accuracy = 1e-4
[measure]
from = 1.0
to = 4.0
in = "driver_periods"
)";

constexpr const char* kMeanForce = "driver.mean_force.x";

/// So fine that its own error is nothing beside those that are looked at.
double true_mean_force(const char* text, std::vector<Setting> settings) {
  settings.push_back({"run.integrator", test::adaptive(1e-12)});
  return *observable(test::run_text(text, settings), kMeanForce);
}

double estimated(const RunResult& result) {
  for (const ErrorEstimate& one : result.errors) {
    if (one.path == std::string("drivers.") + kMeanForce) return one.error.value();
  }
  ADD_FAILURE() << "no estimate";
  return 0.0;
}

struct Case {
  const char* text;
  std::vector<Setting> settings;
};

/// Below the smallest estimate the reference's own error may show.
constexpr double kErrorOfTruth = 1e-9;
/// Relative to the accuracy asked for: if run and companion are both that much better, it is chance
/// which of them is the better one.
constexpr double kFarBelowAsked = 1e-4;

class Accuracy : public testing::TestWithParam<double> {};

TEST_P(Accuracy, IsKeptAndTheErrorIsNotHeldTooSmall) {
  const double asked = GetParam();
  const std::vector<Case> cases = {
      {kTip, {}},               // sticks and slips
      {kTip, {{"k", "6.0"}}},   // slides smoothly
      {kTip, {{"xi", "0.4"}}},  // underdamped
      {kTip, {{"run.dynamics", "\"overdamped\""}}},
      {kRing, {}},                    // rolls
      {kRing, {{"lambda", "0.01"}}},  // rolls in jumps
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(std::string(one.text == kTip ? "tip" : "ring") +
                 (one.settings.empty() ? "" : ", " + one.settings.front().path));
    std::vector<Setting> settings = one.settings;
    settings.push_back({"run.accuracy", test::digits(asked)});
    const RunResult result = run(test::scene_of(one.text, settings));
    ASSERT_EQ(result.status, RunStatus::finished);
    const double truth = true_mean_force(one.text, one.settings);
    const double error = std::abs(*observable(result, kMeanForce) - truth);
    EXPECT_LE(error, asked * std::abs(truth));
    const double unseen = std::max(kErrorOfTruth, kFarBelowAsked * asked);
    EXPECT_LE(error, estimated(result) + unseen * std::abs(truth));
    EXPECT_LE(estimated(result), asked * std::abs(truth));
    EXPECT_EQ(test::briefs(result.warnings), std::vector<std::string>{});
    const double cost = static_cast<double>(result.force_evaluations + result.jacobian_columns);
    EXPECT_LE(static_cast<double>(result.accuracy->companion_cost),
              kMostForCompanions * cost + static_cast<double>(result.accuracy->pilot_cost));
    EXPECT_GT(result.accuracy->companion_cost, 0U);
    // The integrators that are cited are those that ran.
    const AccuracyResult& taken = *result.accuracy;
    ASSERT_TRUE(taken.scheme && taken.companion_scheme);
    EXPECT_NE(taken.integrator.find('"' + taken.scheme->name + '"'), std::string::npos);
    const bool other = taken.companion_scheme != taken.scheme;
    EXPECT_NE((other ? taken.second_companion : taken.companion)
                  .find('"' + taken.companion_scheme->name + '"'),
              std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Asked, Accuracy, testing::Values(1e-2, 1e-4, 1e-6));

TEST(AccuracyOf, TheSameSceneIsTheSameEveryTime) {
  const auto scene = test::scene_of(kTip);
  const ChosenIntegrator first = choose_integrator(scene, test::standard());
  const ChosenIntegrator second = choose_integrator(scene, test::standard());
  EXPECT_EQ(first.text, second.text);
  ASSERT_EQ(first.companions.size(), second.companions.size());
  for (std::size_t k = 0; k < first.companions.size(); ++k) {
    EXPECT_EQ(first.companions[k].text, second.companions[k].text);
  }
  EXPECT_EQ(first.pilot_cost, second.pilot_cost);
  // The effective scene asks for the accuracy again.
  EXPECT_EQ(first.scene->effective_toml, scene->effective_toml);
  EXPECT_NE(scene->effective_toml.find("accuracy = 0.0001"), std::string::npos);
  EXPECT_EQ(scene->effective_toml.find("integrator"), std::string::npos);
}

TEST(AccuracyOf, MoreAccuracyCostsMore) {
  std::uint64_t before = 0;
  for (const char* asked : {"1e-2", "1e-5", "1e-9"}) {
    const RunResult result = run(test::scene_of(kTip, {{"run.accuracy", asked}}));
    const std::uint64_t cost = result.force_evaluations + result.jacobian_columns;
    EXPECT_GT(cost, before);
    before = cost;
  }
}

/// Whatever else is asked for, an observable and its error are the same; those of a difference are
/// the sum of its parts'.
TEST(AccuracyOf, WhatIsNotAskedForIsLeftOutInTheEnd) {
  const auto all = run(parse_scene(kTip, "tip.toml", test::standard()));
  for (const std::string path : {"driver.work", "forces.driver.on.tip.mean_force.x"}) {
    const std::string text = std::string(kTip) + "observables = [\"" + path + "\"]\n";
    const auto one = run(parse_scene(text, "tip.toml", test::standard()));
    ASSERT_EQ(one.groups.size(), 1u);
    const std::string full = full_path(one, path);
    const auto errors_of = [](const RunResult& result, const std::string& of) {
      std::vector<std::optional<double>> errors;
      for (const ErrorEstimate& error : result.errors) {
        if (error.path == of) errors.push_back(error.error);
      }
      return errors;
    };
    ASSERT_EQ(errors_of(one, full).size(), 1u) << full;
    if (path != "driver.work") continue;
    EXPECT_EQ(observable(one, path), observable(all, path));
    EXPECT_EQ(errors_of(one, full), errors_of(all, full));
    EXPECT_EQ(one.errors.size(), 1u);
    const auto error = [&](const char* key) {
      return *errors_of(all, std::string("drivers.driver.") + key + ".x").at(0);
    };
    EXPECT_EQ(error("peak_to_peak_force"), error("max_force") + error("min_force"));
  }
}

TEST(AccuracyOf, AnIntegratorAndAnAccuracyAreOneTooMany) {
  const std::string text = std::string(kTip) + "\n";
  const std::string both = test::replaced(
      text, "accuracy = 1e-4", "accuracy = 1e-4\nintegrator = { type = \"rk4\", dt = 1e-2 }");
  EXPECT_THROW(test::scene_of(both), InputError);
  // The one that is set last is meant.
  EXPECT_FALSE(test::scene_of(text, {{"run.integrator", test::fixed_step(1e-2)}})->run.accuracy);
  const auto scene =
      test::scene_of(text, {{"run.integrator", test::fixed_step(1e-2)}, {"run.accuracy", "1e-3"}});
  EXPECT_EQ(scene->run.accuracy, 1e-3);
}

/// For v to 0 the mean force over a period is the energy lost in its slip; the scheme's finest
/// tolerance is the reference.
TEST(AccuracyOf, QuasistaticDynamicsHaveItToo) {
  const std::vector<Setting> slow = {{"run.dynamics", "\"quasistatic\""}};
  const RunResult result = run(test::scene_of(kTip, slow));
  ASSERT_EQ(result.status, RunStatus::finished);
  std::vector<Setting> fine = slow;
  fine.push_back({"run.integrator", "{ type = \"continuation\", tolerance = 1e-12 }"});
  const double truth = *observable(test::run_text(kTip, fine), kMeanForce);
  const double error = std::abs(*observable(result, kMeanForce) - truth);
  EXPECT_LE(error, 1e-4 * std::abs(truth));
  EXPECT_LE(error, estimated(result) + kErrorOfTruth * std::abs(truth));
  EXPECT_LE(estimated(result), 1e-4 * std::abs(truth));
}

/// If every trial takes more than it may, nothing is known, which is reported; the run continues
/// with the integrator that the scene was bound with.
TEST(AccuracyOf, IsNotPromisedWhereNothingGetsThroughThePilot) {
  constexpr double kNextToNothing = 10.0;
  const auto scene = test::scene_of(kTip);
  const ChosenIntegrator chosen =
      choose_integrator(scene, test::standard(), nullptr, kNextToNothing);
  EXPECT_EQ(chosen.scene->run.integrator.record, scene->run.integrator.record);
  EXPECT_TRUE(chosen.companions.empty());
  EXPECT_EQ(chosen.text, "{ type = \"" + scene->run.integrator.record->name + "\" }");
  EXPECT_EQ(test::briefs(chosen.warnings),
            std::vector<std::string>{"run.accuracy [run.accuracy_no_pilot]"});
  RunResult result = run_as_bound(chosen.scene);
  EXPECT_EQ(result.status, RunStatus::finished);
  estimate_errors(chosen, {}, result);
  EXPECT_TRUE(result.errors.empty());
  EXPECT_EQ(test::briefs(result.warnings),
            (std::vector<std::string>{"run.accuracy [run.accuracy_no_pilot]",
                                      "run.accuracy [run.error_not_estimated]"}));
}

/// Between nothing and enough, coarse steps get through and nothing that they could be compared
/// with.
TEST(AccuracyOf, IsNotPromisedWithoutAReference) {
  constexpr double kForCoarseSteps = 30.0;
  const auto scene = test::scene_of(kTip, {{"run.accuracy", "1e-8"}});
  test::MemoryStore store;
  const auto choose = [&] {
    return choose_integrator(scene, test::standard(), nullptr, kForCoarseSteps, &store);
  };
  const ChosenIntegrator chosen = choose();
  EXPECT_EQ(test::briefs(chosen.warnings),
            std::vector<std::string>{"run.accuracy [run.accuracy_no_reference]"});
  // The choice that is kept has its warnings.
  const ChosenIntegrator kept = choose();
  EXPECT_EQ(test::briefs(kept.warnings), test::briefs(chosen.warnings));
  EXPECT_EQ(texts_of(kept.warnings), texts_of(chosen.warnings));
}

TEST(AccuracyOf, BeyondRoundingIsNotReached) {
  const RunResult result = run(test::scene_of(kTip, {{"run.accuracy", "1e-15"}}));
  EXPECT_GT(test::count_of(FaultCode::run_accuracy_not_reached, result.warnings), 0U);
}

/// Evaluations and columns that a pilot may cost where the scene is not stiff and its slips are
/// short.
constexpr std::uint64_t kMostOfPilot = 100'000;

/// Cheap settings first: 9 thousand for the ring, where trials without an order came to 26
/// thousand; for the chain 72 thousand, where trials one scheme after the other came to 207.
TEST(AccuracyOf, ThePilotTriesLittleThatCannotWin) {
  constexpr std::uint64_t kMost = 15'000;
  EXPECT_LT(choose_integrator(test::scene_of(kRing), test::standard()).pilot_cost, kMost);
  const std::string chain = std::string(paths::source) + "/scenarios/frenkel_kontorova/driven.toml";
  const auto scene = read_scene(chain, test::standard(), {{"run.accuracy", "1e-3"}});
  EXPECT_LT(choose_integrator(scene, test::standard()).pilot_cost, kMostOfPilot);
}

/// A run that is a hundred times as good as asked for would cost more than it should. With both
/// factors of ten it is that good.
TEST(AccuracyOf, IsNotFarBetterThanAskedFor) {
  constexpr std::uint64_t kEnough = 8000;
  const RunResult result = run(test::scene_of(kTip));
  EXPECT_LT(result.force_evaluations + result.jacobian_columns, kEnough);
}

TEST(AccuracyOf, StoppedInThePilotIsInterrupted) {
  const std::atomic<bool> stop = true;
  RunOptions options;
  options.stop = &stop;
  const RunResult result = run(test::scene_of(kTip), options);
  EXPECT_EQ(result.status, RunStatus::interrupted);
}

/// The choice and the companion's end are kept: told to stop at once, a second look has both.
TEST(AccuracyOf, WhatIsInTheStoreIsNotLookedForAgain) {
  const auto scene = test::scene_of(kTip);
  test::MemoryStore store;
  RunOptions options;
  options.store = &store;
  const RunResult alone = run(scene);
  const RunResult first = run(scene, options);
  const std::atomic<bool> stop = true;
  const ChosenIntegrator chosen =
      choose_integrator(scene, test::standard(), &stop, kMostPilotWork, &store);
  EXPECT_FALSE(chosen.interrupted);
  EXPECT_EQ(chosen.text, alone.accuracy->integrator);
  ASSERT_EQ(chosen.companions.size(), kCompanions + 1);
  EXPECT_TRUE(chosen.companions.back().other_family);
  EXPECT_EQ(chosen.companions.front().text, alone.accuracy->companion);
  EXPECT_EQ(chosen.pilot_cost, alone.accuracy->pilot_cost);
  store.counts.clear();
  const RunResult second = run(scene, options);
  const std::map<std::string, int> once = {
      {"companion", 1},
      {"second_companion", 1},
      {"other_family", 1}};  // their ends, and no start before them
  EXPECT_EQ(store.counts, once);
  for (const RunResult* result : {&first, &second}) {
    ASSERT_EQ(result->errors.size(), alone.errors.size());
    for (std::size_t k = 0; k < alone.errors.size(); ++k) {
      EXPECT_EQ(result->errors[k].error, alone.errors[k].error) << alone.errors[k].path;
    }
  }
}

/// A scheme that loses the corrugation does so at every setting: its own companions agree with it,
/// the one of another family does not.
TEST(AccuracyOf, WhatOneFamilyLosesTheOtherSees) {
  const auto valid = test::scene_of(kTip);
  ChosenIntegrator chosen = choose_integrator(valid, test::standard());
  ASSERT_EQ(chosen.companions.size(), kCompanions + 1);
  ASSERT_TRUE(chosen.companions.back().other_family);
  EXPECT_NE(chosen.companions.back().scene->run.integrator.record->needs_tangent,
            chosen.scene->run.integrator.record->needs_tangent);
  const RunResult right = run_as_bound(chosen.scene);
  const auto flat = test::scene_of(kTip, {{"force.sinusoidal_substrate.amplitude", "1e-6"}});
  const auto without_corrugation = [&](const std::shared_ptr<const Scene>& scene) {
    auto lost = std::make_shared<Scene>(*flat);
    lost->run.integrator = scene->run.integrator;
    return lost;
  };
  chosen.scene = without_corrugation(chosen.scene);
  for (Companion& one : chosen.companions) {
    if (!one.other_family) one.scene = without_corrugation(one.scene);
  }
  const auto with_errors = [&] {
    RunResult planted = run_as_bound(chosen.scene);
    estimate_errors(chosen, {}, planted);
    return planted;
  };
  const RunResult planted = with_errors();
  const double off = std::abs(*observable(planted, kMeanForce) - *observable(right, kMeanForce));
  EXPECT_GT(off, 0.1 * std::abs(*observable(right, kMeanForce)));
  EXPECT_GE(estimated(planted), off);
  EXPECT_GT(test::count_of(FaultCode::run_accuracy_not_reached, planted.warnings), 0U);
  chosen.companions.pop_back();
  EXPECT_LT(estimated(with_errors()), 0.01 * off);
}

/// A force that begins in the middle of a run does so in the middle of its pilot.
TEST(AccuracyOf, ThePilotSeesWhatBeginsLater) {
  for (const std::string active : {"{ from = \"1 / v\" }", "{ from = \"5 / v\" }",
                                   "{ from = \"2 / v\", until = \"5 / v\" }"}) {
    SCOPED_TRACE(active);
    std::string text = kTip;
    const std::string key = "velocity = [\"v\"]\n";
    text.insert(text.find(key) + key.size(), "active = " + active + "\n");
    text.erase(text.find("[measure]"));
    const RunResult result = run(test::scene_of(text));
    ASSERT_EQ(result.status, RunStatus::finished);
    EXPECT_EQ(test::count_of(FaultCode::run_accuracy_no_pilot, result.warnings), 0U);
    const double truth = true_mean_force(text.c_str(), {});
    const double error = std::abs(*observable(result, kMeanForce) - truth);
    EXPECT_LE(error, estimated(result) + kErrorOfTruth * std::abs(truth));
    EXPECT_LE(error, 1e-4 * std::abs(truth));
  }
}

TEST(AccuracyOf, ADamagedChoiceIsNone) {
  const auto scene = test::scene_of(kTip);
  test::MemoryStore store;
  const auto bytes = [](const std::string& text) {
    const auto view = std::as_bytes(std::span(text));
    return std::vector<std::byte>(view.begin(), view.end());
  };
  const std::atomic<bool> stop = true;
  for (const std::string& text :
       {std::string("x"), std::string(100, '\0'),
        std::string("\x14\0\0\0\0\0\0\0{ type = \"nothing\" }", 28) + std::string(24, '\0')}) {
    store.all["integrator"] = bytes(text);
    EXPECT_TRUE(
        choose_integrator(scene, test::standard(), &stop, kMostPilotWork, &store).interrupted);
  }
}

/// The companion is stopped when its first checkpoint is kept: the run proper is over.
TEST(AccuracyOf, StoppedInTheCompanionIsInterrupted) {
  std::atomic<bool> stop = false;
  class StopsAtCompanion : public test::MemoryStore {
   public:
    explicit StopsAtCompanion(std::atomic<bool>& stop) : stop_(stop) {}
    void keep(const std::string& name, std::vector<std::byte> bytes) override {
      if (name == "companion") stop_ = true;
      MemoryStore::keep(name, std::move(bytes));
    }

   private:
    std::atomic<bool>& stop_;
  } store(stop);
  RunOptions options;
  options.stop = &stop;
  options.store = &store;
  // Seconds, of which a stop leaves none.
  const std::string slow = test::replaced(kTip, "6 / v", "1e3 / v");
  const RunResult result = run(test::scene_of(slow), options);
  EXPECT_EQ(result.status, RunStatus::interrupted);
  EXPECT_TRUE(result.errors.empty());
  EXPECT_EQ(test::brief(result.warnings.back()), "run.accuracy [run.comparison_stopped]");
}

}  // namespace
}  // namespace tomlin
