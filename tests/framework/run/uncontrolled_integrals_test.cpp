#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"

// Means, work and extremes of forces that act on nothing that is integrated, beside a body that
// hardly moves and lets adaptive schemes take steps over several periods.

namespace tomlin::test {
namespace {

/// Tolerances that a mean force may be off, in parts of the largest force: every step is as exact
/// as one of them, and at the edges of the window, within steps, the dense output is less so (20
/// are found under radau9).
constexpr double kTolerancesOfMeans = 40.0;
/// Rounding of means and works of some thousand steps.
constexpr double kRounding = 1e-12;
/// The largest force is found on the dense output, to the square of how well its position is.
constexpr double kOfExtremes = 1e-6;

constexpr double kFrom = 3.1;
constexpr double kTo = 37.3;
constexpr double kVelocity = 0.2;
constexpr double kAmplitude = 0.1;
constexpr double kFrequency = 1.3;

struct Control {
  std::string type;
  double tolerance = 0.0;
};

const std::vector<Control> kControls = {{"dopri5", 1e-3},      {"dopri5", 1e-6}, {"dopri5", 1e-10},
                                        {"dop853", 1e-3},      {"dop853", 1e-6}, {"dop853", 1e-10},
                                        {"radau9", 1e-3},      {"radau9", 1e-6}, {"radau9", 1e-10},
                                        {"continuation", 1e-6}};

std::string slow_body(bool damped) {
  return "[[body]]\nname = \"slow\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [5.0]\n"
         "velocity = [0.01]\n[[force]]\nname = \"pull\"\ntype = \"driving_spring\"\n"
         "body = \"slow\"\nstiffness = 0.01\nvelocity = [0.01]\n" +
         std::string(damped ? "[[force]]\ntype = \"viscous_damping\"\nbody = \"slow\"\n"
                              "coefficient = 1e-3\n"
                            : "");
}

std::string run_of(const Control& control) {
  const bool quasistatic = control.type == "continuation";
  return "[run]\nduration = 100.0\nledger = true\n" +
         (quasistatic ? "dynamics = \"quasistatic\"\n"
                      : "integrator = " + adaptive(control.tolerance, control.type) + "\n") +
         "[measure]\nfrom = " + digits(kFrom) + "\nto = " + digits(kTo) + "\n";
}

/// The energy of a body at x = v t in a corrugation, along its way.
double corrugation(double time) { return kAmplitude * std::cos(kTau * kVelocity * time); }

struct Expected {
  double mean = 0.0;
  double work = 0.0;
  double largest = 0.0;
};

void expect_found(const ResultGroup& driver, const Expected& expected, double tolerance) {
  const double of_mean = kTolerancesOfMeans * tolerance * expected.largest + kRounding;
  EXPECT_NEAR(driver["mean_force"][0], expected.mean, of_mean);
  EXPECT_NEAR(*driver["work"], expected.work,
              of_mean * (kTo - kFrom) * std::max(kVelocity, kFrequency));
  EXPECT_NEAR(driver["max_force"][0], expected.largest, kOfExtremes * expected.largest);
  EXPECT_NEAR(driver["min_force"][0], -expected.largest, kOfExtremes * expected.largest);
}

std::string title(const Control& control) {
  return control.type + ", " + digits(control.tolerance);
}

TEST(UncontrolledIntegrals, OfAPrescribedBody) {
  const std::string body =
      "[[body]]\nname = \"moved\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.0]\n"
      "coordinates = \"prescribed\"\nmotion = { velocity = [0.2] }\n";
  const std::string declared =
      "[[force]]\ntype = \"sinusoidal_substrate\"\nbody = \"moved\"\namplitude = 0.1\n"
      "period = 1.0\n";
  const std::string formula =
      "[[force]]\ntype = \"expression\"\nbody = \"moved\"\nenergy = \"0.1*cos(2*pi*x)\"\n";
  const double work = corrugation(kTo) - corrugation(kFrom);
  const Expected expected = {work / (kVelocity * (kTo - kFrom)), work, kTau * kAmplitude};
  for (const Control& control : kControls) {
    for (const bool damped : {false, true}) {
      for (const bool is_formula : {false, true}) {
        SCOPED_TRACE(title(control) + (damped ? ", damped" : "") + (is_formula ? ", formula" : ""));
        const RunResult found = run_text(body + (is_formula ? formula : declared) +
                                         slow_body(damped) + run_of(control));
        expect_found(found.group("drivers", "moved"), expected, control.tolerance);
        EXPECT_NEAR(
            *found.group("energy")["numerical_work"], 0.0,
            kTolerancesOfMeans * control.tolerance * expected.largest * kVelocity * (kTo - kFrom) +
                kRounding);
      }
    }
  }
}

/// A declared driver on a body that is fixed, or held: V = V0 x cos(w t).
TEST(UncontrolledIntegrals, OfADriverOnWhatIsHeld) {
  constexpr double kPosition = 0.5;
  const double change = std::sin(kFrequency * kTo) - std::sin(kFrequency * kFrom);
  const double turn = std::cos(kFrequency * kTo) - std::cos(kFrequency * kFrom);
  const Expected expected = {-kAmplitude * change / (kFrequency * (kTo - kFrom)),
                             kAmplitude * kPosition * turn, kAmplitude};
  for (const std::string held : {"coordinates = \"fixed\"\n", "hold = [\"x\"]\n"}) {
    for (const Control& control : kControls) {
      SCOPED_TRACE(title(control) + ", " + held);
      const std::string scene =
          "[[body]]\nname = \"still\"\ntype = \"point\"\nparticle_mass = 1.0\n"
          "position = [0.5]\n" +
          held +
          "[[force]]\nname = \"shaken\"\ntype = \"expression\"\nbody = \"still\"\ndriver = true\n"
          "energy = \"0.1*x*cos(1.3*t)\"\n" +
          slow_body(true) + run_of(control);
      expect_found(run_text(scene).group("drivers", "shaken"), expected, control.tolerance);
    }
  }
}

/// A prescribed body that passes a fixed one: its work is none, and its force is along both axes.
TEST(UncontrolledIntegrals, OfAPrescribedBodyBesideAFixedOne) {
  for (const Control& control : kControls) {
    SCOPED_TRACE(title(control));
    const RunResult found = run_text(
        "[[body]]\nname = \"moved\"\ntype = \"point\"\nparticle_mass = 1.0\n"
        "position = [-4.04, 1.0]\ncoordinates = \"prescribed\"\n"
        "motion = { velocity = [0.2, 0.0] }\n"
        "[[body]]\nname = \"still\"\ntype = \"point\"\nparticle_mass = 1.0\n"
        "position = [0.0, 0.0]\ncoordinates = \"fixed\"\n"
        "[[force]]\ntype = \"lennard_jones\"\nbodies = [\"moved\", \"still\"]\nepsilon = 1.0\n"
        "sigma = 0.9\ncutoff = 3.0\n"
        "[[body]]\nname = \"slow\"\ntype = \"point\"\nparticle_mass = 1.0\n"
        "position = [50.0, 0.0]\nvelocity = [0.01, 0.0]\n[[force]]\nname = \"pull\"\n"
        "type = \"driving_spring\"\nbody = \"slow\"\nstiffness = 0.01\nvelocity = [0.01, 0.0]\n" +
        run_of(control));
    const ResultGroup& moved = found.group("drivers", "moved");
    const double largest = moved["max_force"][1];
    const double allowed = kTolerancesOfMeans * control.tolerance * largest + kRounding;
    EXPECT_NEAR(moved["mean_force"][0], 0.0, allowed);  // symmetric about the middle
    EXPECT_NEAR(*moved["work"], 0.0, allowed * kVelocity * (kTo - kFrom));
  }
}

/// Jumps are stepped over at no less than the tolerance, and end no run.
TEST(UncontrolledIntegrals, OfAForceThatJumps) {
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    SCOPED_TRACE(tolerance);
    const RunResult found = run_text(
        "[[body]]\nname = \"moved\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.0]\n"
        "coordinates = \"prescribed\"\nmotion = { velocity = [0.2] }\n"
        "[[force]]\ntype = \"expression\"\nbody = \"moved\"\n"
        "force = [\"0.3 - step(sin(2*pi*x))\"]\n" +
        slow_body(true) + run_of({"dopri5", tolerance}));
    ASSERT_EQ(found.status, RunStatus::finished);
    // In the 6.84 periods from 0.62 to 7.46 the sine is positive in 6 halves and 0.46 of a period.
    const double mean = 0.3 - (6 * 0.5 + 0.46) / (kVelocity * (kTo - kFrom));
    EXPECT_NEAR(std::abs(found.group("drivers", "moved")["mean_force"][0]), std::abs(mean),
                kTolerancesOfMeans * tolerance);
  }
}

}  // namespace
}  // namespace tomlin::test
