#include "framework/model/stability.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// The largest stable step: known before the first step, refused beyond, and right. And what a run
// says that fails all the same.

namespace tomlin::test {
namespace {

const double kImaginaryLimit = 2.0 * std::sqrt(2.0);
constexpr double kRealLimit = 2.785293563405282;
// Bisection stops where |R| exceeds 1 by 1e-9, and |R| has slope of order one there.
constexpr double kBisection = 1e-8;

double limit_of(const std::string& text) {
  Engine engine(scene_of(text), {});
  return stable_step_of(engine);
}

std::string oscillator(double stiffness, double damping, double dt, double steps) {
  std::string text =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [1.0]\nparticle_mass = 2.0\n"
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nvelocity = [0.0]\nstart = [0.0]\n"
      "stiffness = " +
      digits(stiffness) + "\n";
  if (damping > 0.0) {
    text +=
        "[[force]]\nname = \"drag\"\ntype = \"viscous_damping\"\ncoefficient = " + digits(damping) +
        "\n";
  }
  return text + "[run]\nduration = " + digits(dt * steps) + "\nintegrator = " + fixed_step(dt) +
         "\n";
}

std::string free_ring(int count, double bonds, double mass, const std::string& extra = "") {
  return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 1.0\ncentre = [0.0, 0.0]\ncount = " +
         std::to_string(count) + "\nparticle_mass = " + digits(mass) +
         "\n[[force]]\nname = \"bonds\"\ntype = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = " +
         digits(bonds) + "\n" + extra + "[run]\nduration = 1.0\nintegrator = " + fixed_step(1e-6) +
         "\n";
}

TEST(StableStep, OfAnOscillator) {
  // omega = 3
  const double expected = kImaginaryLimit / 3.0;
  EXPECT_NEAR(limit_of(oscillator(18.0, 0.0, 1e-3, 1)), expected, kBisection * expected);
}

TEST(StableStep, OfStrongDamping) {
  // Overdamped: lambda = -(g/2) - sqrt(g^2/4 - w^2), with g = 50, w = 3.
  const double lambda = 25.0 + std::sqrt(25.0 * 25.0 - 9.0);
  // A mode without a spring decays at g, a little faster still, and is counted too.
  const double limit = limit_of(oscillator(18.0, 100.0, 1e-4, 1));
  EXPECT_LE(limit, kRealLimit / lambda * (1.0 + kBisection));
  EXPECT_GE(limit, kRealLimit / 50.0 * (1.0 - kBisection));
}

/// All pairs bonded: the fastest mode of the ring breathes at sqrt(N k/m), whatever N.
TEST(StableStep, OfAFlexibleRing) {
  for (const int count : {3, 5, 8, 12, 20}) {
    const double expected = kImaginaryLimit / std::sqrt(count * 1000.0 / 0.125);
    EXPECT_NEAR(limit_of(free_ring(count, 1000.0, 0.125)), expected, kBisection * expected)
        << count;
  }
}

/// A chain's fastest mode is 2 sqrt(k/m) sin(pi (N-1)/(2N)); beyond the exact calculation there is
/// a bound, 2 sqrt(k/m), never below it.
TEST(StableStep, OfAChain) {
  for (const int count : {2, 3, 50, 299, 1000}) {
    const std::string text =
        "[[body]]\ntype = \"chain\"\nspacing = 1.0\nparticle_mass = 0.5\ncount = " +
        std::to_string(count) +
        "\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 32.0\n"
        "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-3 }\n";
    const double omega = 16.0 * std::sin(std::acos(-1.0) * (count - 1) / (2.0 * count));
    const double limit = limit_of(text);
    EXPECT_LE(limit, kImaginaryLimit / omega * (1.0 + kBisection)) << count;
    EXPECT_GE(limit, kImaginaryLimit / 16.0 * (1.0 - kBisection)) << count;
  }
}

/// Springs to each particle of a rigid ring: k/m for the centre and for the rotation; to one
/// particle: k (1/M + R^2/I) = 2 k/M along its tangent.
TEST(StableStep, OfARigidRingOnSprings) {
  const auto text = [](const std::string& attach) {
    return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 1.3\ncentre = [0.0, 0.0]\ncount = "
           "8\n"
           "particle_mass = 0.5\ncoordinates = \"rigid\"\n"
           "[[force]]\ntype = \"driving_spring\"\nstiffness = 50.0\nvelocity = [0.1, 0.0]\n"
           "attach = " +
           attach + "\n[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-3 }\n";
  };
  const auto expect = [&](const std::string& attach, double squared) {
    const double expected = kImaginaryLimit / std::sqrt(squared);
    EXPECT_NEAR(limit_of(text(attach)), expected, kBisection * expected) << attach;
  };
  expect("\"centre_of_mass\"", 50.0 / 4.0);
  expect("\"each_particle\"", 50.0 / 0.5);
  expect("{ particle = 3 }", 2.0 * 50.0 / 4.0);
}

TEST(StableStep, JustBelowRunsAndJustAboveIsRefused) {
  const double limit = limit_of(oscillator(18.0, 0.0, 1e-3, 1));
  const RunResult below = run_text(oscillator(18.0, 0.0, 0.99 * limit, 20000));
  EXPECT_EQ(below.status, RunStatus::finished);
  EXPECT_LE(std::abs(below.body(0)["centre_of_mass"][0]), 1.0);

  const RunResult above = run_text(oscillator(18.0, 0.0, 1.01 * limit, 20000));
  EXPECT_EQ(above.status, RunStatus::failed);
  EXPECT_EQ(above.steps, 0u);
  ASSERT_TRUE(above.failure);
  EXPECT_EQ(above.failure->force, "driver");
  EXPECT_NE(above.failure->what.find("stability limit"), std::string::npos);
  EXPECT_NE(above.failure->cause.find("allow_unstable"), std::string::npos);
}

TEST(StableStep, InsistingEndsInAFailureThatIsExplained) {
  const double limit = limit_of(oscillator(18.0, 0.0, 1e-3, 1));
  const double dt = 1.01 * limit;
  const RunResult result =
      run_text(oscillator(18.0, 0.0, dt, 100000), {{"run.allow_unstable", "true"}});
  EXPECT_EQ(result.status, RunStatus::failed);
  EXPECT_EQ(briefs(result.warnings),
            std::vector<std::string>{"run.integrator.dt [integrator.beyond_stability]"});
  ASSERT_TRUE(result.failure);
  const RunFailure& failure = *result.failure;
  EXPECT_GT(failure.step, 10u);
  EXPECT_EQ(failure.step, result.steps);
  EXPECT_NEAR(failure.time, static_cast<double>(failure.step) * dt, 1e-9 * failure.time);
  EXPECT_EQ(failure.body, "tip");
  EXPECT_EQ(failure.particle, 0);
  EXPECT_EQ(failure.axis, "x");
  EXPECT_EQ(failure.force, "driver");
  EXPECT_NE(failure.cause.find("stability limit"), std::string::npos);
  const std::string sentence = to_string(failure);
  for (const char* part : {"step ", "time ", "particle 0", "driver"}) {
    EXPECT_NE(sentence.find(part), std::string::npos) << part;
  }
}

TEST(StableStep, OfATipIsBoundedByTheCorrugationEverywhere) {
  // (2 pi)^2 A/a^2 from the corrugation, although the tip starts where its curvature is small.
  TipScene tip{.stiffness = 2.0, .damping = 0.0, .amplitude = 25.0, .position = 0.25};
  tip.integrator = fixed_step(1e-3);
  const double squared = 2.0 + 25.0 * std::pow(2.0 * std::acos(-1.0), 2);
  EXPECT_NEAR(limit_of(tip.text()), kImaginaryLimit / std::sqrt(squared),
              kBisection * kImaginaryLimit);
}

/// An adaptive scheme has no such limit, and finds its own way.
TEST(StableStep, AdaptiveSchemesAreNotHeldToIt) {
  TipScene tip{.damping = 2000.0, .duration = 1.0};
  tip.integrator = adaptive(1e-4);
  const RunResult result = run_text(tip.text());
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_LT(std::abs(result.body(0)["centre_of_mass"][0] - 0.1), 0.01);
}

// ---- failures

/// A lower bound may be returned for a given step if the bound is beyond that step, and no other.
TEST(StableStep, ABoundBeyondAStepIsNoMoreThanTheLimit) {
  int bounds = 0;
  for (const char* scheme : {"rk4", "midpoint", "velocity_verlet"}) {
    for (const double damping : {0.0, 0.3, 2.0, 20.0, 400.0}) {
      for (const double part : {0.05, 0.5, 0.8, 0.99, 1.01}) {
        std::string text = oscillator(3.0, damping, 1e-3, 10.0);
        text.replace(text.find("rk4"), 3, scheme);
        Engine engine(scene_of(text), {});
        const IntegratorRecord& record = *standard().integrator(scheme);
        const double limit = stable_step_of(engine.model(), record);
        const double enough = part * (std::isfinite(limit) ? limit : 1.0);
        const double bound = stable_step_of(engine.model(), record, enough);
        EXPECT_LE(bound, limit * (1.0 + kBisection)) << scheme << ", " << damping << ", " << part;
        if (bound == limit) continue;
        EXPECT_GT(bound, enough) << scheme << ", " << damping << ", " << part;
        ++bounds;
      }
    }
  }
  EXPECT_GT(bounds, 0) << "a bound is found without a search somewhere";
}

TEST(Failure, ASpeedThatRunsAwayIsNoticedAtAPeriodAStep) {
  const std::string text =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
      "[[force]]\nname = \"tilt\"\ntype = \"constant_force\"\nforce = [5.0]\n"
      "[[force]]\nname = \"corrugation\"\ntype = \"sinusoidal_substrate\"\namplitude = 0.1\n"
      "period = 1.0\n[run]\nduration = 1e4\nintegrator = { type = \"rk4\", dt = 0.1 }\n";
  const RunResult result = run_text(text);
  EXPECT_EQ(result.status, RunStatus::failed);
  ASSERT_TRUE(result.failure);
  // v = 5 t reaches a period a step, 10, at t = 2: long before anything overflows.
  EXPECT_NEAR(result.failure->time, 2.0, 0.3);
  EXPECT_EQ(result.failure->body, "tip");
  EXPECT_EQ(result.failure->particle, 0);
  EXPECT_EQ(result.failure->force, "tilt");
  EXPECT_NE(result.failure->cause.find("diverges"), std::string::npos);
  EXPECT_LT(std::abs(result.body(0)["velocity"][0]), 15.0) << "the state is that before the step";
}

/// Two particles of a plane that meet head-on: their bond has no direction there.
TEST(Failure, CoincidentParticlesAreNamed) {
  const RunResult result = run_text(
      "[[body]]\nname = \"pair\"\ntype = \"chain\"\ncount = 2\nspacing = 1.0\n"
      "origin = [0.0, 0.0]\nvelocity = [[0.5, 0.0], [-0.5, 0.0]]\nparticle_mass = 1.0\n"
      "[[force]]\nname = \"bond\"\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
      "stiffness = 0.0\nrest_lengths = 1.0\n"
      "[run]\nduration = 10.0\nintegrator = { type = \"rk4\", dt = 0.5 }\n");
  EXPECT_EQ(result.status, RunStatus::failed);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->step, 1u);
  EXPECT_EQ(result.failure->time, 0.5);
  EXPECT_EQ(result.failure->body, "pair");
  EXPECT_EQ(result.failure->force, "bond");
  EXPECT_NE(result.failure->cause.find("coincide"), std::string::npos) << result.failure->cause;
}

TEST(Failure, AResultIsCompleteHoweverTheRunEnded) {
  TipScene tip{.duration = 100.0};
  tip.integrator = "{ type = \"dopri5\", most_steps = 10 }";
  const RunResult result = run_text(tip.text());
  EXPECT_EQ(result.status, RunStatus::failed);
  ASSERT_EQ(result.family("drivers").size(), 1u);
  EXPECT_TRUE(result.driver(0)["mean_force"].empty()) << "the window was not reached";
  EXPECT_EQ(result.driver(0)["final_force"].size(), 1u);
  EXPECT_EQ(result.body(0)["centre_of_mass"].size(), 1u);
  EXPECT_GT(result.end_time, 0.0);
  EXPECT_EQ(result.end_time, result.failure->time);
}

}  // namespace
}  // namespace tomlin::test
