#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/guard/determined.hpp"
#include "tests/support/scenes.hpp"

// Quasistatic paths through instabilities of symmetric scenes: where nothing but rounding decides
// the run says so, and where anything else does it goes that way.

namespace tomlin::test {
namespace {

RunResult run_with(const std::string& text, KeptSamples& sink) {
  return run_text(text, {}, watched_by(sink));
}

bool warned_of_tie(const RunResult& result) {
  return count_of(FaultCode::run_tie, result.warnings) > 0;
}

/// A well that splits at t = 0.5 into two, at sqrt(2 t - 1) and - sqrt(2 t - 1); from t = 0.8 on
/// they differ. `tilt` is a steady force.
std::string splitting(double tilt) {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
         "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 0.2\n"
         "velocity = [0.0]\nstart = [0.0]\n[[force]]\ntype = \"expression\"\nenergy = "
         "\"(0.8 - 2*t)*x^2/2 + x^4/4 + 0.3*max(0, t - 0.8)*x - " +
         digits(std::abs(tilt)) + (tilt < 0.0 ? "*(0 - x)" : "*x") +
         "\"\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"
         "[run]\ndynamics = \"quasistatic\"\nduration = 1.5\n";
}

TEST(Ties, ASymmetricWellThatSplitsIsOne) {
  KeptSamples sink;
  const RunResult result = run_with(splitting(0.0), sink);
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.group("events")["ties"], 1u);
  EXPECT_TRUE(warned_of_tie(result));
  const std::vector<Event> ties = sink.of(EventKind::tie);
  ASSERT_EQ(ties.size(), 1u);
  EXPECT_NEAR(ties[0].time, 0.5, 1e-6);
  EXPECT_EQ(ties[0].name, "tip");
}

/// The smallest tilts are as good as any, and the path goes their way.
TEST(Ties, ATiltDecides) {
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12}) {
    for (const double sign : {1.0, -1.0}) {
      const RunResult result = run_text(splitting(sign * size));
      ASSERT_EQ(result.status, RunStatus::finished) << sign * size;
      EXPECT_EQ(result.group("events")["ties"], 0u) << sign * size;
      EXPECT_FALSE(warned_of_tie(result)) << sign * size;
      EXPECT_GT(result.body(0)["centre_of_mass"][0] * sign, 0.5) << sign * size;
    }
  }
}

/// Digits that the body's position at the end has in all of two (or more) disturbed runs, and the
/// mean forces.
double digits_of(const std::string& scene, const char* size, int repeats = 2,
                 const char* body = "tip") {
  const std::string perturb = std::string("{ size = ") + size +
                              ", repeats = " + std::to_string(repeats) + ", observables = [\"" +
                              body + ".centre_of_mass.x\", \"driver.mean_force.x\"] }";
  const RunResult result = run_text(scene, {{"run.perturb", perturb}});
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_FALSE(result.determined.empty());
  double fewest = 17.0;
  for (const DeterminedResult& one : result.determined) fewest = std::min(fewest, one.digits);
  return fewest;
}

/// Disturbances decide where they are stronger than the tilt, though all starts relax to one
/// equilibrium before. Two repeats leave to opposite sides wherever they decide, and the number of
/// runs is no reason to see one side only.
TEST(Ties, PerturbDisturbsOnTheWay) {
  EXPECT_LT(digits_of(splitting(0.0), "1e-12"), kDigitsOfADeterminedResult);
  for (const double tilt : {1e-10, -1e-10}) {
    EXPECT_LT(digits_of(splitting(tilt), "1e-6", 1), kDigitsOfADeterminedResult) << tilt;
  }
  for (const double tilt : {1e-8, -1e-8, 1e-7}) {
    EXPECT_LT(digits_of(splitting(tilt), "1e-6"), kDigitsOfADeterminedResult) << tilt;
  }
  EXPECT_LT(digits_of(splitting(1e-12), "1e-9"), kDigitsOfADeterminedResult);
}

/// Steady forces of 1e-6 move results by as much; extrapolated to none, by the square times what
/// the scene's curvatures make of it.
constexpr double kDigitsLeft = 8.0;
/// Near an instability curvatures fall to 3 e^(2/3), 1e-3 for a tilt of 1e-5: a tenth of that tilt
/// is no small change any more.
constexpr double kDigitsBesideATilt = 4.0;
/// Paths that turn within a hundredth of a natural unit have errors of 2e-8 at a tolerance of 1e-9,
/// and disturbed ones are made of other steps.
constexpr double kDigitsAtABend = 6.0;

/// A tilt that is stronger than the disturbances decides; they move the path by their own size.
TEST(Ties, ATiltAboveTheDisturbanceDecides) {
  EXPECT_GT(digits_of(splitting(1e-4), "1e-9"), kDigitsLeft);
  for (const double tilt : {1e-6, -1e-6}) {
    EXPECT_GT(digits_of(splitting(tilt), "1e-9"), kDigitsAtABend) << tilt;
  }
  EXPECT_GT(digits_of(splitting(-1e-5), "1e-6"), kDigitsBesideATilt);
}

/// Two bonds in a row that are pulled apart; `stronger` is what the second one's depth exceeds the
/// first one's by.
std::string bonds(double stronger) {
  const auto bond = [](const char* name, const char* pair, double depth) {
    return std::string("[[force]]\nname = \"") + name + "\"\ntype = \"morse_bonds\"\npairs = [" +
           pair + "]\ndepth = " + digits(depth) + "\ninverse_width = 2.0\n";
  };
  return "[[body]]\ntype = \"particles\"\nname = \"p\"\npositions = [0.0, 1.0, 2.0]\n"
         "particle_mass = 1.0\n" +
         bond("left", "[0, 1]", 0.2) + bond("right", "[1, 2]", 0.2 * (1.0 + stronger)) +
         "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 0.15\n"
         "velocity = [1.0]\nattach = { particle = 2 }\n[[force]]\nname = \"hold\"\n"
         "type = \"driving_spring\"\nstiffness = 3.0\nvelocity = [0.0]\n"
         "attach = { particle = 0 }\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.5\n"
         "[run]\ndynamics = \"quasistatic\"\nduration = 4.0\n";
}

/// Centre of mass where the right bond is broken, and the left one.
constexpr double kRightBroken = 2.333;
constexpr double kLeftBroken = 3.665;

TEST(Ties, TwoEqualBondsAreOne) {
  const RunResult result = run_text(bonds(0.0));
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_GE(result.group("events")["ties"].value(), 1u);
  EXPECT_TRUE(warned_of_tie(result));
  // The side that friction takes when the driver is slow.
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], kRightBroken, 0.01);
}

TEST(Ties, TheWeakerBondBreaks) {
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const RunResult left = run_text(bonds(size));
    const RunResult right = run_text(bonds(-size));
    EXPECT_EQ(left.group("events")["ties"], 0u) << size;
    EXPECT_EQ(right.group("events")["ties"], 0u) << size;
    EXPECT_NEAR(left.body(0)["centre_of_mass"][0], kLeftBroken, 0.02) << size;
    EXPECT_NEAR(right.body(0)["centre_of_mass"][0], kRightBroken, 0.02) << size;
  }
}

TEST(Ties, BondsThatAreNearlyEqualAreNotDetermined) {
  EXPECT_LT(digits_of(bonds(1e-10), "1e-6", 2, "p"), kDigitsOfADeterminedResult);
  EXPECT_LT(digits_of(bonds(-1e-10), "1e-6", 2, "p"), kDigitsOfADeterminedResult);
  EXPECT_GT(digits_of(bonds(1e-3), "1e-6", 2, "p"), kDigitsOfADeterminedResult);
  EXPECT_GT(digits_of(bonds(-1e-3), "1e-6", 2, "p"), kDigitsOfADeterminedResult);
}

/// A tip that sticks and slips: every fold comes a little earlier or later.
TEST(Ties, FoldsAreDetermined) {
  const std::string tip =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\n"
      "velocity = [1.0]\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.1\n"
      "period = 1.0\n[run]\ndynamics = \"quasistatic\"\nduration = 4.0\n[measure]\n"
      "from = 2.0\nto = 4.0\nin = \"driver_periods\"\n";
  ASSERT_GE(run_text(tip).group("events")["slips"].value(), 3u);
  EXPECT_GT(digits_of(tip, "1e-12"), kDigitsLeft);
  EXPECT_GT(digits_of(tip, "1e-6"), kDigitsLeft);
}

/// A freely rotating pair has no steady force on it: it would rotate the pair, or make it unstable
/// under compression.
TEST(Ties, WhatTurnsFreelyIsNotPushed) {
  for (const char* seed : {"1", "2", "3"}) {
    const RunResult result = run_text(
        "[[body]]\ntype = \"particles\"\nname = \"p\"\npositions = [[0.0, 0.0], [0.6, 0.8]]\n"
        "particle_mass = 1.0\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
        "stiffness = 2.0\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
        "stiffness = 1.0\nvelocity = [1.0, 0.0]\n[[force]]\ntype = \"expression\"\n"
        "energy = \"0.1*sin(xc)\"\n[run]\ndynamics = \"quasistatic\"\nduration = 4.0\n"
        "perturb = { size = 1e-6, repeats = 4 }\n",
        {{"run.seed", seed}});
    EXPECT_EQ(result.status, RunStatus::finished);
    ASSERT_FALSE(result.determined.empty());
    EXPECT_GT(result.determined[0].digits, kDigitsLeft);
    EXPECT_EQ(count_of(FaultCode::run_perturb_failed, result.warnings), 0U);
  }
}

/// A particle midway between two others becomes unstable there at t = 0.4, where nothing holds
/// the three of them: steady forces that sum to zero leave them where they are, and decide.
TEST(Ties, WhatSlidesFreelyIsPushed) {
  const auto point = [](const char* name, const char* at) {
    return std::string("[[body]]\nname = \"") + name + "\"\ntype = \"point\"\nposition = [" + at +
           "]\nparticle_mass = 1.0\n";
  };
  const auto between = [](const char* one, const char* other, const std::string& energy) {
    return std::string("[[force]]\nname = \"") + one + other +
           "\"\ntype = \"expression\"\nbodies = [\"" + one + "\", \"" + other + "\"]\nenergy = \"" +
           energy + "\"\n";
  };
  const std::string splits = "(0.8 - 2*t)*(r - 1)^2/2 + (r - 1)^4/4";
  for (const double tilt : {1e-10, 1e-3}) {
    const RunResult result =
        run_text(point("left", "0.0") + point("tip", "1.0") + point("right", "2.0") +
                     between("left", "tip", splits) +
                     between("tip", "right", splits + " + " + digits(tilt) + "*r") +
                     between("left", "right", "5*(r - 2)^2") +
                     "[run]\ndynamics = \"quasistatic\"\nduration = 0.6\n",
                 {{"run.perturb",
                   "{ size = 1e-6, repeats = 2, observables = [\"tip.centre_of_mass.x\"] }"}});
    ASSERT_EQ(result.status, RunStatus::finished) << tilt;
    ASSERT_EQ(result.determined.size(), 1u) << tilt;
    EXPECT_EQ(result.determined[0].digits < kDigitsOfADeterminedResult, tilt < 1e-6) << tilt;
  }
}

/// Chains of any spacing over a corrugation slip for reasons of their own.
TEST(Ties, NoneInScenesWithoutSymmetry) {
  std::uint64_t slips = 0;
  for (const unsigned seed : {11u, 12u, 13u}) {
    std::mt19937_64 random(seed);
    const auto between = [&](double low, double high) {
      return low + (high - low) * std::uniform_real_distribution<double>()(random);
    };
    for (int n = 0; n < 8; ++n) {
      const int count = 1 + n;
      const std::string text =
          "[[body]]\ntype = \"chain\"\ncount = " + std::to_string(count) +
          "\nspacing = " + digits(between(0.3, 1.7)) + "\norigin = [" + digits(between(0.0, 1.0)) +
          "]\nparticle_mass = 1.0\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
          "stiffness = " +
          digits(between(0.2, 3.0)) +
          "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
          digits(between(0.2, 2.0)) +
          "\nvelocity = [1.0]\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " +
          digits(between(0.02, 0.3)) +
          "\nperiod = 1.0\n[run]\ndynamics = \"quasistatic\"\nduration = 3.0\n";
      SCOPED_TRACE("seed " + std::to_string(seed) + ", scene " + std::to_string(n));
      const RunResult result = run_text(text);
      if (result.status != RunStatus::finished) continue;
      EXPECT_EQ(result.group("events")["ties"], 0u);
      slips += result.group("events")["slips"].value();
    }
  }
  EXPECT_GT(slips, 20u) << "nothing happened";
}

}  // namespace
}  // namespace tomlin::test
