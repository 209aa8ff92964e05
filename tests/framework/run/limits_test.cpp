#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/support/scenes.hpp"

// Runs of scenes that ask for more than they can have.

namespace tomlin::test {
namespace {

/// A body that is moved over a substrate; nothing else is free.
std::string pushed(const std::string& velocity, const std::string& run) {
  return "[[body]]\ntype = \"point\"\nname = \"slider\"\nposition = [0.0]\nparticle_mass = 1.0\n"
         "coordinates = \"prescribed\"\nmotion = { velocity = [" +
         velocity +
         "] }\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n"
         "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.5\n"
         "[run]\nduration = 5.0\nledger = true\n" +
         run;
}

const std::vector<std::string> kSchemes = {
    "integrator = { type = \"rk4\", dt = 0.01 }\n",
    "integrator = { type = \"velocity_verlet\", dt = 0.01 }\n",
    "integrator = { type = \"dopri5\" }\n"};

TEST(PrescribedMotion, ThatLeavesTheNumbersEndsTheRunThere) {
  constexpr double kAStep = 0.011;  // the failing step starts at most one step before
  for (const std::string& scheme : kSchemes) {
    for (const char* type : {"double", "quadruple"}) {
      const RunResult result =
          run_text(pushed("\"sqrt(2 - t)\"", scheme + "number_type = \"" + type + "\"\n"));
      ASSERT_EQ(result.status, RunStatus::failed) << scheme << type;
      EXPECT_EQ(result.failure->body, "slider") << scheme << type;
      EXPECT_NE(result.failure->what.find("no finite value"), std::string::npos);
      EXPECT_NEAR(result.end_time, 2.0, kAStep) << scheme << type;
    }
  }
}

TEST(PrescribedMotion, AloneIsFollowedInStepsThatSeeTheSubstrate) {
  // Simpson-like quadrature at a fiftieth of a period: far below; unbounded steps miss by percents.
  constexpr double kBalance = 1e-6;
  const RunResult result = run_text(pushed("0.7", kSchemes.back()));
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(*result.group("energy")["heat_out"], 0.5 * 0.7 * 0.7 * 5.0, kBalance);
  EXPECT_NEAR(*result.group("energy")["numerical_work"], 0.0, kBalance);
}

/// The way from its velocity, and the work from the energy at its end, whatever the scheme.
TEST(PrescribedMotion, OfAnyVelocityIsFollowedToTheTolerance) {
  // Some 900 steps add up errors of 1e-12 each; a scheme that does not watch the way is off by more
  // than the way itself.
  constexpr double kWay = 1e-9;
  constexpr double kWork = 1e-10;  // a fiftieth of a period a step, fifth order at least
  const double end = 17.3;
  for (const char* scheme : {"dopri5", "dop853", "radau9"}) {
    SCOPED_TRACE(scheme);
    std::string scene =
        pushed("\"0.3 + 0.2 * cos(t)\"",
               std::string("integrator = { type = \"") + scheme +
                   "\", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }\n");
    scene.replace(scene.find("duration = 5.0"), 14, "duration = 17.3");
    const RunResult result = run_text(scene);
    ASSERT_EQ(result.status, RunStatus::finished);
    const double way = 0.3 * end + 0.2 * std::sin(end);
    EXPECT_NEAR(result.body(0)["centre_of_mass"][0], way, kWay);
    // The drag 0.5 v dissipates 0.5 v^2: the integral of 0.5 (0.3 + 0.2 cos t)^2.
    const double heat =
        0.5 * (0.09 * end + 0.12 * std::sin(end) + 0.04 * (0.5 * end + 0.25 * std::sin(2.0 * end)));
    const double last = 0.3 + 0.2 * std::cos(end);
    const double stored =
        0.1 * (std::cos(2.0 * std::acos(-1.0) * way) - 1.0) + 0.5 * (last * last - 0.5 * 0.5);
    EXPECT_NEAR(*result.group("energy")["heat_out"], heat, kWork);
    EXPECT_NEAR(*result.group("energy")["work_in"] - heat, stored, kWork + kWay);
  }
}

/// The implicit scheme watches the way of what pulls beside what is pulled, which hardly feels it.
TEST(PrescribedMotion, BesideAFreeBodyIsFollowedToTheTolerance) {
  constexpr double kWay = 1e-8;  // of absolute tolerance 1e-10, some hundred steps
  const RunResult result = run_text(
      "[[body]]\ntype = \"point\"\nname = \"slider\"\nposition = [0.0]\nparticle_mass = 1.0\n"
      "coordinates = \"prescribed\"\nmotion = { velocity = [\"cos(3 * t)\"] }\n"
      "[[body]]\ntype = \"point\"\nname = \"free\"\nposition = [0.0]\nparticle_mass = 1.0\n"
      "[[force]]\ntype = \"viscous_damping\"\nbody = \"free\"\ncoefficient = 1.0\n"
      "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"slider\", \"free\"]\n"
      "pairs = [[0, 0]]\nstiffness = 1e-13\nrest_lengths = 0.0\n"
      "[run]\nduration = 20.0\n"
      "integrator = { type = \"radau9\", absolute_tolerance = 1e-10, relative_tolerance = 1e-10 "
      "}\n");
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], std::sin(60.0) / 3.0, kWay);
}

TEST(PrescribedMotion, HasItsOwnLargestSpeedInEveryNumberType) {
  for (const std::string& scheme : kSchemes) {
    for (const char* type : {"double", "quadruple"}) {
      const RunResult result =
          run_text(pushed("\"0.2 * cos(t)\"", scheme + "number_type = \"" + type + "\"\n"));
      // At the start: the vertex of a parabola through the first steps would exceed it.
      EXPECT_NEAR(*result.body(0)["max_speed"], 0.2, 1e-6) << scheme << type;
    }
  }
}

std::string tip(const std::string& body, const std::string& run) {
  return "[[body]]\ntype = \"point\"\nposition = [1.0]\nparticle_mass = 1.0\n" + body +
         "[[force]]\ntype = \"driving_spring\"\nstiffness = 1.0\nvelocity = [0.0]\n"
         "start = [0.0]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"
         "[run]\nduration = 1.0\n" +
         run;
}

TEST(Warnings, VelocityWithoutInertia) {
  const std::string fixed = "integrator = { type = \"rk4\", dt = 0.01 }\n";
  const std::string drift = "dynamics = \"overdamped\"\n" + fixed;
  EXPECT_EQ(briefs(run_text(tip("velocity = [1.0]\n", drift)).warnings),
            std::vector<std::string>{"body.point.velocity [scene.velocity_unused]"});
  EXPECT_TRUE(run_text(tip("", drift)).warnings.empty());
  EXPECT_TRUE(run_text(tip("velocity = [1.0]\n", fixed)).warnings.empty());
}

TEST(Perturb, HowFastARunWasIsNoResult) {
  const std::string run =
      "integrator = { type = \"rk4\", dt = 0.01 }\nperturb = { size = 1e-9, "
      "repeats = 1, observables = [\"";
  EXPECT_THROW(run_text(tip("", run + "performance.wall_seconds\"] }\n")), InputError);
  EXPECT_NO_THROW(run_text(tip("", run + "energy.kinetic\"] }\nledger = true\n")));
}

TEST(SplitFriction, OfSlowDecayIsNotBiased) {
  // A rounded factor near one errs alike in each of 2e5 half-steps: 8e-13 at the end, when planted.
  // What is left is a random walk of rounding, and the rounding of the closed form.
  constexpr double kWalk = 3e-13;
  const RunResult result = run_text(
      "[[body]]\ntype = \"point\"\nposition = [0.0]\nvelocity = [1.0]\nparticle_mass = 1.0\n"
      "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.01\n"
      "[run]\nduration = 100.0\nintegrator = { type = \"velocity_verlet\", dt = 1e-3 }\n");
  EXPECT_NEAR(result.body(0)["velocity"][0], std::exp(-1.0), kWalk);
}

}  // namespace
}  // namespace tomlin::test
