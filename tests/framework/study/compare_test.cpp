#include "framework/study/compare.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/fault.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/text.hpp"

namespace tomlin {
namespace {

using Verdict = ComparedModel::Verdict;

constexpr const char* kForces = R"(
[[force]]
name = "NAME"
type = "driving_spring"
stiffness = 2.0
velocity = VELOCITY
[[force]]
type = "viscous_damping"
coefficient = "2 * sqrt(2) / N"
[[force]]
type = "sinusoidal_substrate"
amplitude = "V0 / N"
period = "a"
[run]
duration = 300.0
integrator = { type = "dopri5", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }
[measure]
from = 1.0
to = 3.0
in = "driver_periods"
)";

std::string with_forces(const std::string& body, const std::string& name,
                        const std::string& velocity) {
  return body + test::replaced(test::replaced(kForces, "NAME", name), "VELOCITY", velocity);
}

std::string tip(const std::string& amplitude, const std::string& more = "") {
  return with_forces("[parameters]\nN = 1\na = 1.0\nV0 = " + amplitude + "\n" + more +
                         "[[body]]\ntype = \"point\"\nname = \"tip\"\nposition = [0.0]\n"
                         "particle_mass = 1.0\n",
                     "spring", "[0.01]");
}

/// A ring whose rotation is held and that feels no decay is a tip of this amplitude (Notes of the
/// rolling ring: (V0/N) |sum_i exp(i 2 pi (R/a) cos theta_i)|).
constexpr int kCount = 8;
constexpr double kRadius = 0.3;
constexpr double kAmplitude = 0.1;

double amplitude_of_ring() {
  double real = 0.0;
  double imaginary = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double phase = kTau * kRadius * std::cos(kTau * i / kCount);
    real += std::cos(phase);
    imaginary += std::sin(phase);
  }
  return kAmplitude / kCount * std::hypot(real, imaginary);
}

std::string ring(const std::string& velocity = "[0.01, 0.0]") {
  return with_forces(
      "[parameters]\nN = 8\na = 1.0\nV0 = 0.1\n"
      "[[body]]\ntype = \"ring\"\nname = \"ring\"\ncount = 8\nradius = 0.3\n"
      "particle_mass = 0.125\ncentre = [0.0, 1.0]\ncoordinates = \"rigid\"\n"
      "hold = [\"rotation\"]\n",
      "driver", velocity);
}

std::shared_ptr<const Scene> scene(const std::string& text, const std::string& file,
                                   const std::vector<Setting>& settings = {}) {
  return parse_scene(text, file, test::standard(), settings);
}

Comparison compared(const std::vector<std::shared_ptr<const Scene>>& scenes,
                    double tolerance = 1e-6) {
  return compare_models(scenes, {"driver.mean_force.x", tolerance});
}

TEST(Compare, ARingThatIsATipIsOne) {
  const Comparison found = compared({scene(ring(), "ring.toml"),
                                     scene(tip(test::digits(amplitude_of_ring())), "tip.toml"),
                                     scene(tip("0.1"), "plain.toml")});
  ASSERT_EQ(found.models.size(), 3U);
  EXPECT_EQ(found.reference, 0U);
  EXPECT_EQ(found.simplest, 1U);
  EXPECT_EQ(found.models[0].verdict, Verdict::reference);
  EXPECT_EQ(found.models[0].coordinates, 2U);
  EXPECT_EQ(found.models[0].particles, 8U);
  EXPECT_EQ(found.models[1].verdict, Verdict::agrees);
  EXPECT_EQ(found.models[1].coordinates, 1U);
  // The ring's amplitude is far below that of its particles together.
  EXPECT_EQ(found.models[2].verdict, Verdict::differs);
  EXPECT_GT(std::abs(*found.models[2].difference), 0.1 * *found.models[0].value);
  ASSERT_TRUE(found.models[0].error);
  EXPECT_LT(*found.models[0].error, 1e-6 * *found.models[0].value);
  EXPECT_GT(*found.models[0].error, 0.0);
  // One of the two models compared with it has another ratio of curvature to stiffness.
  EXPECT_FALSE(found.notes.empty());
}

TEST(Compare, TheOverlayIsOfTheWindow) {
  const Comparison found = compared({scene(ring(), "ring.toml"), scene(tip("0.1"), "tip.toml")});
  ASSERT_EQ(found.models.size(), 2U);
  for (const ComparedModel& model : found.models) {
    ASSERT_GT(model.way.size(), 500U);
    ASSERT_EQ(model.way.size(), model.force.size());
    EXPECT_NEAR(model.way.front(), 1.0, 1e-2);
    EXPECT_NEAR(model.way.back(), 3.0, 1e-2);
    double mean = 0.0;
    for (const double force : model.force) mean += force / static_cast<double>(model.force.size());
    EXPECT_NEAR(mean, *model.value, 2e-2 * std::abs(*model.value));
  }
}

TEST(Compare, WhatIsDrivenOtherwiseIsRefused) {
  const auto faults = [](const std::string& text, const std::vector<Setting>& settings) {
    return test::briefs_of([&] {
      compared({scene(tip("0.1"), "tip.toml"), scene(text, "other.toml", settings)});
    });
  };
  using Briefs = std::vector<std::string>;
  EXPECT_EQ(faults(ring("[0.02, 0.0]"), {}),
            Briefs{"27:1 driving velocity = 0.02 [compare.different_setups]"});
  EXPECT_EQ(faults(ring("[0.01, 0.001]"), {}),
            Briefs{"27:1 driving velocity = 0.01, 0.001 [compare.different_setups]"});
  EXPECT_EQ(faults(ring(), {{"a", "1.5"}}),
            Briefs{"27:1 lattice periods = 1.5 [compare.different_setups]"});
  EXPECT_EQ(faults(ring(), {}), Briefs{});
}

/// A sheet of atoms declares no period, and in space the pull may have another axis.
TEST(Compare, ScenesOfOtherDimensionsAreComparedAlongThePull) {
  const auto pulled_along_y = [](const std::string& velocity) {
    return scene(
        "[[body]]\ntype = \"point\"\nname = \"tip\"\nposition = [0.0, 0.0]\nparticle_mass = 1.0\n"
        "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\n"
        "velocity = [0.0, " +
            velocity +
            "]\n"
            "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"
            "[[force]]\ntype = \"nose_hoover_chain\"\ntemperature = 0.1\nperiod = 1.0\n"
            "active = { until = 1.0 }\n"
            "[run]\nduration = 300.1\n"  // a 4000th of it is no multiple of the step
            "integrator = { type = \"velocity_verlet\", dt = 1e-2 }\n",
        "along_y.toml");
  };
  const Comparison found = compare_models({scene(tip("0.1"), "tip.toml"), pulled_along_y("0.01")},
                                          {"driver.mean_force_along", 1e-6});
  ASSERT_EQ(found.models.size(), 2U);
  EXPECT_NE(found.models[1].verdict, Verdict::failed);
  EXPECT_GT(found.models[1].way.size(), 500U);
  EXPECT_EQ(found.notes.size(), 3U);  // periods, velocity, curvature over stiffness
  EXPECT_EQ(test::briefs_of([&] {
              compared({scene(tip("0.1"), "tip.toml"), pulled_along_y("0.02")});
            }),
            std::vector<std::string>{"19:1 driving velocity = 0, 0.02 [compare.different_setups]"});
}

TEST(Compare, ErrorsLargerThanTheToleranceLeaveItOpen) {
  const std::vector<Setting> coarse = {{"run.integrator", test::adaptive(1e-3)}};
  const std::string same = test::digits(amplitude_of_ring());
  const Comparison found =
      compared({scene(ring(), "ring.toml"), scene(tip(same), "tip.toml", coarse)}, 1e-9);
  EXPECT_EQ(found.models[1].verdict, Verdict::undecided);
  EXPECT_EQ(found.simplest, 0U);
}

/// A scene compared with itself has no difference, but the errors of both prevent a verdict.
TEST(Compare, AgreementTakesTheErrorsOfBothIntoAccount) {
  const std::vector<std::shared_ptr<const Scene>> twice = {scene(tip("0.1"), "tip.toml"),
                                                           scene(tip("0.1"), "again.toml")};
  const Comparison found = compared(twice);
  const ComparedModel& model = found.models[1];
  ASSERT_EQ(*model.difference, 0.0);
  const double error = *model.error / std::abs(*model.value);
  ASSERT_GT(error, 0.0);
  EXPECT_EQ(compared(twice, 1.5 * error).models[1].verdict, Verdict::undecided);
  EXPECT_EQ(compared(twice, 2.5 * error).models[1].verdict, Verdict::agrees);
}

TEST(Compare, AModelThatFailsIsSaidToHave) {
  const std::vector<Setting> bad = {{"run.integrator", test::fixed_step(3.0)},
                                    {"run.allow_unstable", "true"}};
  const Comparison found =
      compared({scene(ring(), "ring.toml"), scene(tip("0.1"), "tip.toml", bad)});
  EXPECT_EQ(found.models[1].verdict, Verdict::failed);
  EXPECT_TRUE(found.models[1].result.failure);
  EXPECT_EQ(found.simplest, 0U);
}

TEST(Compare, AnUnknownObservableNamesTheScene) {
  const auto faults = test::thrown_faults([] {
    compare_models({scene(ring(), "ring.toml"), scene(tip("0.1"), "tip.toml")},
                   {"driver.mean_farce.x"});
  });
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].location.file, "ring.toml");
  EXPECT_EQ(test::brief(faults[0]),
            "driver.mean_farce.x [observable.unknown] did you mean driver.mean_force.x");
}

}  // namespace
}  // namespace tomlin
