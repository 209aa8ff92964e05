#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"

// Smooth sliding that is far slower than the scene relaxes: the mean force of the driver is what is
// left of large parts that cancel. Implicit steps reach over all of it, and must know.

namespace tomlin::test {
namespace {

/// Relative error of a mean force under default tolerances of 1e-7, which hold for each step.
constexpr double kMeanError = 1e-6;
/// The error if rounding limits it: F is known to 1e-16 or so, and averages over steps.
constexpr double kRoundedError = 1e-4;
/// Friction of order v^3, relative to that of order v: times v squared.
constexpr double kNextOrder = 100.0;

struct Slow {
  double s = 0.53;  ///< 4 pi^2 V0/(k a^2)
  double xi = 1.3;
  double k = 1.5;
  double m = 1.0;
  double v = 1e-6;
  bool inertial = true;
  std::string integrator = "{ type = \"radau9\" }";

  double V0() const { return s * k / (kTau * kTau); }
  double mean_force() const { return xi * v / std::sqrt(1.0 - s * s); }

  std::string settings() const {
    return std::string("[run]\ndynamics = ") + (inertial ? "\"inertial\"" : "\"overdamped\"") +
           "\nduration = " + digits(3.0 / v) + "\nledger = true\nintegrator = " + integrator +
           "\n[measure]\nfrom = 1.0\nto = 3.0\nin = \"driver_periods\"\n";
  }
  /// Forces that `count` particles share evenly.
  std::string forces(int count) const {
    const double n = count;
    return "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " + digits(k) +
           "\nvelocity = [" + digits(v) +
           "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(xi / n) +
           "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " + digits(V0() / n) +
           "\nperiod = 1.0\n";
  }
  std::string tip() const {
    return "[[body]]\ntype = \"point\"\nposition = [0.5]\nparticle_mass = " + digits(m) + "\n" +
           forces(1) + settings();
  }
  /// One particle in each well: it moves as one.
  std::string chain(int count) const {
    return "[[body]]\ntype = \"chain\"\ncount = " + std::to_string(count) +
           "\nspacing = 1.0\norigin = [0.5]\nparticle_mass = " + digits(m / count) +
           "\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 3.0\n" +
           forces(count) + settings();
  }
  /// A rigid ring that may not turn, its corrugation that of all particles together.
  std::string ring() const {
    constexpr int kCount = 8;
    constexpr double kRadius = 0.1;
    double share = 0.0;
    for (int i = 0; i < kCount; ++i) {
      share += std::cos(kTau * kRadius * std::cos(kTau * i / kCount)) / kCount;
    }
    Slow stronger = *this;
    stronger.s = s / share;
    std::string text = stronger.forces(kCount);
    const std::string velocity = "velocity = [" + digits(v);
    text.insert(text.find(velocity) + velocity.size(), ", 0.0");
    return "[[body]]\ntype = \"ring\"\ncount = 8\nradius = 0.1\ncentre = [0.5, 0.0]\n"
           "coordinates = \"rigid\"\nhold = [\"rotation\", \"y\"]\nparticle_mass = " +
           digits(m / kCount) + "\n" + text + settings();
  }
};

void expect_mean_force(const Slow& slow, const std::string& text, double allowed) {
  const RunResult result = run_text(text);
  ASSERT_EQ(result.status, RunStatus::finished) << to_string(*result.failure);
  const double truth = slow.mean_force();
  EXPECT_NEAR(result.driver(0)["mean_force"][0], truth,
              (allowed + kNextOrder * slow.v * slow.v) * truth);
  EXPECT_LT(std::abs(*result.group("energy")["numerical_work"]),
            allowed * *result.group("energy")["heat_out"]);
  EXPECT_LT(result.steps, 2000u);
}

TEST(SlowMotion, MeanForceIsThatOfTheClosedForm) {
  for (const double v : {1e-4, 1e-6, 1e-8}) {
    for (const bool inertial : {true, false}) {
      SCOPED_TRACE("v = " + digits(v) + (inertial ? "" : ", overdamped"));
      const Slow slow{.v = v, .inertial = inertial};
      expect_mean_force(slow, slow.tip(), v < 1e-7 ? kRoundedError : kMeanError);
    }
  }
}

TEST(SlowMotion, RandomScenes) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::mt19937_64 random(seed);
    const auto between = [&](double low, double high) {
      return low + (high - low) * std::uniform_real_distribution<double>()(random);
    };
    for (int n = 0; n < 12; ++n) {
      Slow slow;
      slow.s = between(0.05, 0.9);
      slow.xi = std::exp(between(-1.0, 2.0));
      slow.k = std::exp(between(-1.0, 2.0));
      slow.m = std::exp(between(-2.0, 1.0));
      slow.v = std::pow(10.0, between(-7.0, -4.0));
      slow.inertial = n % 2 == 0;
      SCOPED_TRACE("seed " + std::to_string(seed) + ", scene " + std::to_string(n) +
                   ", v = " + digits(slow.v) + ", s = " + digits(slow.s) +
                   ", xi = " + digits(slow.xi) + ", k = " + digits(slow.k));
      const std::string text = n % 3 == 0   ? slow.tip()
                               : n % 3 == 1 ? slow.chain(2 + n)
                                            : slow.ring();
      expect_mean_force(slow, text, 10.0 * kMeanError);
    }
  }
}

/// A run reports that double precision does not resolve the dissipated energy.
TEST(SlowMotion, SaysWhereRoundingIsAll) {
  const Slow slow{.v = 1e-14};
  const RunResult result = run_text(slow.tip());
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(count_of(FaultCode::run_work_rounding, result.warnings), 1U);
  const RunResult faster = run_text(Slow{.v = 1e-6}.tip());
  EXPECT_EQ(count_of(FaultCode::run_work_rounding, faster.warnings), 0U);
}

/// Between slips next to nothing is dissipated: what the error of the last step's rates is held
/// against may be far more than that of the next. Runs of coarse tolerances get through all the
/// same, from any start, and their errors are known.
TEST(SlowMotion, StickSlipGetsThroughAtCoarseTolerances) {
  constexpr double kCoarse = 1e-4;
  constexpr double kMany = 10.0;  // tolerances: errors of all steps of a run
  const auto text = [](double start, const std::string& integrator) {
    return TipScene{.velocity = 0.1,
                    .stiffness = 1.0,
                    .damping = 0.5,
                    .amplitude = 1.0,
                    .position = start,
                    .duration = 1200.0,
                    .integrator = integrator}
        .text();
  };
  for (const double start : {0.01, 0.03, 0.04, 0.07}) {
    SCOPED_TRACE(start);
    const RunResult found = run_text(text(start, adaptive(kCoarse, "radau9")));
    ASSERT_EQ(found.status, RunStatus::finished) << to_string(*found.failure);
    const double exact =
        run_text(text(start, adaptive(1e-11, "dop853"))).driver(0)["mean_force"][0];
    EXPECT_NEAR(found.driver(0)["mean_force"][0], exact, kMany * kCoarse * exact);
  }
}

/// At a jump of a force a shorter step errs by as much, beside what it dissipates: the step is
/// accepted all the same.
TEST(SlowMotion, StepsOverAJumpOfAForce) {
  const RunResult found = run_text(R"toml(
body = [{ name = "tip", type = "point", position = [0.0], particle_mass = 1.0 }]
force = [
  { name = "driver", type = "driving_spring", stiffness = 1.0, velocity = [0.1] },
  { type = "viscous_damping", coefficient = 2.0 },
  { type = "expression", energy = "0.1*floor(t/31)*x" },
]
run = { duration = 100.0, integrator = { type = "radau9" } }
)toml");
  ASSERT_EQ(found.status, RunStatus::finished) << to_string(*found.failure);
  // Critically damped: what is left of the last jump, seven time units before the end.
  const double left = 0.1 * (1.0 + 7.0) * std::exp(-7.0);
  EXPECT_NEAR(found.driver(0)["final_force"][0], 2.0 * 0.1 + 0.1 * 3.0 - left, 1e-6);
}

/// Explicit schemes are held to the time in which the scene relaxes, and need no such care.
TEST(SlowMotion, ExplicitStepsAreShort) {
  const Slow slow{.v = 1e-4, .integrator = "{ type = \"dopri5\" }"};
  const RunResult result = run_text(slow.tip());
  EXPECT_NEAR(result.driver(0)["mean_force"][0], slow.mean_force(),
              10.0 * kMeanError * slow.mean_force());
}

}  // namespace
}  // namespace tomlin::test
