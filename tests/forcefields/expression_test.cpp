#include "forcefields/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/engine.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/scenes.hpp"

// Forces given as formulas: against built-in forces of the same law, at the borders of where they
// are defined.

namespace tomlin::test {
namespace {

// ---- against built-in forces --------------------------------------------------------------------

std::string ring(const std::string& substrate, const std::string& coordinates,
                 const std::string& centre = "[0.0, 1.0]") {
  return tables(R"(
[parameters] | N = 8 | V0 = 0.1 | lambda = 1.0 | a = 1.0
[[body]] | type = "ring" | count = "N" | radius = 1.0 | particle_mass = "1 / N" | centre = )") +
         centre + "\ncoordinates = \"" + coordinates + tables(R"("
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 100.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [1e-2, 0.0]
[[force]] | type = "viscous_damping" | coefficient = "2 * sqrt(2) / N"
[[force]] | name = "substrate"
)") + substrate +
         tables(R"(
[run] | duration = 20.0 | ledger = true | integrator = { type = "rk4", dt = 5e-3 }
)");
}

const std::string kBuiltIn = R"(type = "sinusoidal_substrate"
amplitude = "V0 / N"
period = "a"
decay = "lambda"
)";
const std::string kFormula = R"--(type = "expression"
energy = "V0/N * exp(-lambda * y^2) * cos(2*pi*x/a)"
period = "a"
)--";

/// Two evaluations of the same law that round differently, over 4000 steps of a smooth motion.
constexpr double kSameLaw = 1e-11;

TEST(Expression, SubstrateMovesARingAsTheBuiltInOneDoes) {
  for (const char* coordinates : {"particles", "rigid"}) {
    for (const char* centre : {"[0.0, 1.0]", "[1e9, 1.0]"}) {
      SCOPED_TRACE(std::string(coordinates) + centre);
      const RunResult expected = run_text(ring(kBuiltIn, coordinates, centre));
      const RunResult found = run_text(ring(kFormula, coordinates, centre));
      ASSERT_EQ(found.status, RunStatus::finished);
      EXPECT_NEAR(found.driver(0)["mean_force"][0], expected.driver(0)["mean_force"][0], kSameLaw);
      EXPECT_NEAR(found.body(0)["velocity"][0], expected.body(0)["velocity"][0], kSameLaw);
      EXPECT_NEAR(*found.body(0)["rotation"], *expected.body(0)["rotation"], kSameLaw);
      EXPECT_NEAR(found.group("energy")["potential"].value(),
                  expected.group("energy")["potential"].value(), kSameLaw);
      EXPECT_EQ(found.force_evaluations, expected.force_evaluations);
    }
  }
}

/// Without a period positions far out keep what a double has there: 1e9 to 1e-7.
TEST(Expression, WithoutAPeriodDigitsAreLostFarOut) {
  std::string scene = ring(kFormula, "rigid", "[1e9, 1.0]");
  scene.erase(scene.find("period = \"a\""), 12);
  const RunResult expected = run_text(ring(kBuiltIn, "rigid", "[1e9, 1.0]"));
  const RunResult found = run_text(scene);
  const double off =
      std::abs(found.driver(0)["mean_force"][0] - expected.driver(0)["mean_force"][0]);
  EXPECT_GT(off, 1e-10);
  EXPECT_LT(off, 1e-6);
}

TEST(Expression, BondsAsAFormulaMoveARingAsTheBuiltInOnesDo) {
  std::string scene = ring(kBuiltIn, "particles");
  const std::string bonds = "type = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = 100.0\n";
  const auto at = scene.find(bonds);
  const double side = 2.0 * std::sin(M_PI / 8.0);
  scene.replace(
      at, bonds.size(),
      "type = \"expression\"\nname = \"bonds\"\npairs = \"neighbours\"\nenergy = \"50*(r - " +
          digits(side) + ")^2\"\n");
  std::string twin = ring(kBuiltIn, "particles");
  twin.replace(at, bonds.size(),
               "type = \"harmonic_bonds\"\nname = \"bonds\"\npairs = \"neighbours\"\n"
               "stiffness = 100.0\nrest_lengths = " +
                   digits(side) + "\n");
  const RunResult expected = run_text(twin);
  const RunResult found = run_text(scene);
  EXPECT_NEAR(found.driver(0)["mean_force"][0], expected.driver(0)["mean_force"][0], kSameLaw);
  EXPECT_NEAR(found.group("energy")["potential"].value(),
              expected.group("energy")["potential"].value(), kSameLaw);
}

std::string point(const std::string& force, const std::string& more = "",
                  const std::string& position = "[1.0]") {
  return "[[body]]\ntype = \"point\"\nposition = " + position +
         "\nparticle_mass = 1.0\n[[force]]\ntype = \"expression\"\n" + force +
         "\n[run]\nduration = 3.0\nintegrator = " + adaptive(1e-12, "dop853") + "\n" + more;
}

/// A tolerance of 1e-12 over a few oscillations.
constexpr double kExact = 1e-9;

TEST(Expression, AForceWithFrictionFollowsItsClosedForm) {
  const RunResult found = run_text(point("force = [\"-4*x - 0.4*vx\"]", "ledger = true\n"));
  const double rate = 0.2, frequency = std::sqrt(4.0 - rate * rate), t = 3.0;
  const double x =
      std::exp(-rate * t) * (std::cos(frequency * t) + rate / frequency * std::sin(frequency * t));
  const double v = -4.0 / frequency * std::exp(-rate * t) * std::sin(frequency * t);
  EXPECT_NEAR(found.body(0)["centre_of_mass"][0], x, kExact);
  EXPECT_NEAR(found.body(0)["velocity"][0], v, kExact);
  // No energy is known of it: what it does is heat, all of it.
  EXPECT_NEAR(*found.group("energy")["heat_out"], -0.5 * v * v, kExact);
  EXPECT_NEAR(*found.group("energy")["numerical_work"], 0.0, kExact);
}

/// V = -x cos(t): x = 1 + 1 - cos(t). What its change in time puts in is the integral of
/// dV/dt = x sin(t).
TEST(Expression, AnEnergyThatChangesWithTimeClosesTheLedger) {
  const RunResult found = run_text(point("energy = \"-x*cos(t)\"", "ledger = true\n"));
  EXPECT_NEAR(found.body(0)["centre_of_mass"][0], 2.0 - std::cos(3.0), kExact);
  const double put_in = 2.0 * (1.0 - std::cos(3.0)) - 0.5 * std::pow(std::sin(3.0), 2);
  EXPECT_NEAR(*found.group("energy")["work_in"], put_in, kExact);
  EXPECT_NEAR(*found.group("energy")["heat_out"], 0.0, kExact);
  EXPECT_NEAR(*found.group("energy")["numerical_work"], 0.0, kExact);
}

TEST(Expression, TheCentreOfMassMovesAsAPointOfTheWholeMass) {
  for (const char* coordinates : {"particles", "rigid"}) {
    SCOPED_TRACE(coordinates);
    const RunResult found = run_text(
        "[[body]]\ntype = \"ring\"\ncount = 5\nradius = 1.0\nparticle_mass = 0.4\ncentre = [1.0, "
        "2.0]\ncoordinates = \"" +
        std::string(coordinates) +
        "\"\n[[force]]\ntype = \"expression\"\nenergy = \"2*xc^2 + 0.5*(yc - 1)^2\"\n[run]\n"
        "duration = 3.0\nintegrator = " +
        adaptive(1e-12, "dop853") + "\n");
    EXPECT_NEAR(found.body(0)["centre_of_mass"][0], std::cos(std::sqrt(2.0) * 3.0), kExact);
    EXPECT_NEAR(found.body(0)["centre_of_mass"][1], 1.0 + std::cos(std::sqrt(0.5) * 3.0), kExact);
    EXPECT_NEAR(*found.body(0)["rotation"], 0.0, kExact);
  }
}

/// Small bending of three particles with bonds of length 1 and V = (k/2)(theta - pi)^2: the mode
/// (1, -2, 1) e across the bonds has theta - pi = 6 e, and the frequency sqrt(36 k / (6 m)).
TEST(Expression, AStraightChainBendsWithItsFrequency) {
  constexpr double kSmall = 1e-4;
  constexpr double kAnharmonic = 1e-3;  // bonds that stretch take 4e-5 of the energy
  constexpr double kBend = 3.0;
  for (const double end : {0.7, 2.0}) {
    const RunResult found =
        run_text(tables(R"--(
[[body]] | type = "particles" | positions = [[-1.0, 1e-4], [0.0, -2e-4], [1.0, 1e-4]]
particle_mass = 1.0
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = 1e4
rest_lengths = 1.0
[[force]] | type = "expression" | energy = "0.5*3*(theta - pi)^2"
[run] | ledger = true | duration = )--") +
                 digits(end) + "\nintegrator = " + adaptive(1e-12, "dop853") + "\n");
    ASSERT_EQ(found.status, RunStatus::finished);
    const double angle = 6.0 * kSmall * std::cos(std::sqrt(6.0 * kBend) * end);
    const double whole = 0.5 * kBend * 36.0 * kSmall * kSmall;
    EXPECT_NEAR(found.group("energy")["potential"].value(), 0.5 * kBend * angle * angle,
                kAnharmonic * whole);
    EXPECT_NEAR(
        found.group("energy")["kinetic"].value() + found.group("energy")["potential"].value(),
        whole, kAnharmonic * whole);
  }
}

// ---- what is refused ----------------------------------------------------------------------------

/// Without wording.
std::string faults_of(const std::string& scene) { return abridged(refusal(scene)); }

TEST(Expression, RefusesWhatMeansNothingAndNamesTheColumn) {
  struct Case {
    std::string force;
    std::string key;  ///< and its position before it, its value behind it
    std::string code;
  };
  const std::string unknown = "[expression.unknown_name]";
  const std::string not_finite = "[expression.not_finite]";
  const std::string invalid = "[component.invalid]";
  const std::vector<Case> cases = {
      {"energy = \"2*y^2\"", "7:13: energy = \"2*y^2\"", unknown},
      {"energy = \"x + vx\"", "7:15: energy = \"x + vx\"", unknown},
      {"energy = \"x + xc\"", "7:11: energy = \"x + xc\"", invalid},
      {"energy = \"r*theta\"", "7:13: energy = \"r*theta\"", invalid},
      {"energy = \"t\"", "7:10: energy = \"t\"", invalid},
      {"energy = \"x +\"", "7:14: energy = \"x +\"", "[expression.syntax]"},
      {"energy = \"K*x\"", "7:11: energy = \"K*x\"", unknown},
      {"energy = \"sine(x)\"", "7:11: energy = \"sine(x)\"", unknown + " did you mean sin"},
      {"force = [\"-x\", \"0\"]", "7:9: force = [\"-x\", \"0\"]", "[scene.wrong_count]"},
      {"force = [\"-r\"]", "7:12: force = \"-r\"", unknown},
      {"energy = \"x\"\nforce = [\"1\"]", "7:10: energy = \"x\"", "[scene.conflict]"},
      {"", "5:1: energy", "[scene.missing_key]"},
      {"energy = \"cos(x)\"\nperiod = 1.0", "8:10: period = 1.0", invalid},
      {"energy = \"r^2\"\nperiod = 1.0", "8:10: period = 1.0", "[scene.conflict]"},
      {"energy = \"cos(2*pi*x)\"\nperiod = [1.0, 1.0]", "8:10: period = [1.0, 1.0]",
       "[scene.wrong_count]"},
      {"energy = \"cos(x)\"\npairs = \"neighbours\"", "8:9: pairs = \"neighbours\"",
       "[scene.conflict]"},
      {"energy = \"x*0/0\"", "7:14: energy", not_finite},
      {"energy = \"(x - x)/(x - x) + x\"", "7:18: energy", not_finite},
      {"energy = \"0.1*cos(2*pi*x)*(1 + max(0, x - 100))\"\nperiod = 1.0", "8:10: period = 1.0",
       invalid},
      {"energy = \"log(x - 1)\"", "7:11: energy", not_finite},
      {"energy = \"1/(x - 1)\"", "7:12: energy", not_finite},
      {"energy = \"sqrt(x - 1)\"", "7:11: energy", not_finite},
  };
  for (Case one : cases) {
    SCOPED_TRACE(one.force);
    one.key.insert(one.key.find(": ") + 2, "force.expression.");
    EXPECT_EQ(faults_of(point(one.force)), "test.toml:" + one.key + " " + one.code);
  }
  EXPECT_NE(refusal(point("energy = \"log(x - 1)\"")).find("particle 0"), std::string::npos);
}

/// Its power would be taken at a velocity of half a step before: an error of first order in the
/// heat.
TEST(Expression, ALedgerWithAForceThatIsNoGradientTakesASchemeWithStages) {
  const std::string law = "force = [\"-4*x + 0.1*cos(2*t)\"]";
  const std::string by_dop853 = adaptive(1e-12, "dop853");
  for (const char* scheme : {"velocity_verlet", "exponential_verlet", "blanes_moan"}) {
    SCOPED_TRACE(scheme);
    for (const bool ledger : {true, false}) {
      std::string scene = point(law, ledger ? "ledger = true\n" : "");
      scene.replace(scene.find(by_dop853), by_dop853.size(),
                    std::string("{ type = \"") + scheme + "\", dt = 1e-2 }");
      const std::string faults = faults_of(scene);
      EXPECT_EQ(faults.ends_with("run.integrator.type = \"" + std::string(scheme) +
                                 "\" [integrator.order_reduction]"),
                ledger)
          << faults;
    }
  }
  EXPECT_EQ(refusal(point(law, "ledger = true\n")), "");
}

TEST(Expression, ARunThatLeavesTheFormulasRangeNamesTheParticle) {
  const RunResult found = run_text(tables(R"--(
[[body]] | name = "tips" | type = "particles" | positions = [5.0, 1.0, 7.0]
velocity = [[0.0], [-1.0], [0.0]] | particle_mass = 1.0
[[force]] | type = "expression" | energy = "0.01*log(x)"
[run] | duration = 10.0 | integrator = { type = "rk4", dt = 0.3 }
)--"));
  ASSERT_EQ(found.status, RunStatus::failed);
  EXPECT_NE(found.failure->cause.find("particle 1 of \"tips\""), std::string::npos)
      << found.failure->cause;
  EXPECT_NE(found.failure->cause.find("column 6"), std::string::npos) << found.failure->cause;
}

/// An undefined value that a slope no longer shows, or a sine without a phase, ends a run as an
/// undefined energy does: on every instruction set, since a NaN is a NaN.
TEST(Expression, ARunEndsWhereTheEnergyDoes) {
  struct Case {
    const char* law;
    double from;
    double velocity;
    const char* why;
  };
  const std::vector<Case> cases = {
      {"energy = \"max(0, log(x))\"", 2.0, -1.0, "only positive numbers have a logarithm"},
      {"energy = \"min(log(x), 5)\"", 2.0, -1.0, "only positive numbers have a logarithm"},
      {"energy = \"sqrt(x)^2\"", 1.0, -1.0, "no real square root"},
      {"energy = \"asin(x) + acos(x) + x\"", 0.9, 1.0, "outside [-1, 1]"},
      {"force = [\"1e-2*sin(exp(x))\"]", 30.0, 1.0, "no phase left"},
      {"energy = \"0.1*x^(1 + t)\"", -0.5, 0.0, "column 6"},
      {"energy = \"1e-20*cos(exp(x))\"", 30.0, 1.0, "no phase left"},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.law);
    const RunResult found = run_text(fmt::format(R"--(
[[body]]
type = "point"
position = [{}]
velocity = [{}]
particle_mass = 1.0
[[force]]
type = "expression"
{}
[run]
duration = 10.0
integrator = {{ type = "rk4", dt = 1e-3 }}
)--",
                                                 one.from, one.velocity, one.law));
    ASSERT_EQ(found.status, RunStatus::failed);
    EXPECT_NE(found.failure->cause.find(one.why), std::string::npos) << found.failure->cause;
  }
}

/// In a box a barrier stands wherever an image of the fixed atom does, also where none was near at
/// the start: what has too little energy comes back.
TEST(Expression, PairsInABoxAreOfNearestImages) {
  const auto ending = [](double velocity) {
    return run_text(fmt::format(R"--(
[box]
lengths = [5.0]
periodic = [true]
[[body]]
name = "tip"
type = "point"
position = [1.0]
velocity = [{}]
particle_mass = 1.0
[[body]]
name = "atom"
type = "point"
position = [0.0]
particle_mass = 1.0
coordinates = "fixed"
[[force]]
type = "expression"
bodies = ["tip", "atom"]
energy = "0.2*exp(-4*r^2)"
[run]
duration = 20.0
ledger = true
integrator = {{ type = "dop853", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }}
)--",
                                velocity));
  };
  // 0.5 v^2 and 0.2 exp(-4), against 0.2.
  const RunResult bounced = ending(0.5);
  EXPECT_LT(bounced.body(0)["centre_of_mass"][0], 5.0);
  EXPECT_GT(bounced.body(0)["centre_of_mass"][0], 0.0);
  const RunResult passed = ending(0.7);
  EXPECT_GT(passed.body(0)["centre_of_mass"][0], 10.0);
  EXPECT_NEAR(*passed.group("energy")["numerical_work"], 0.0, kExact);
}

/// Without inertia the heat of a force is that of the velocities which the forces give; what a drag
/// takes out, the force has put in. On a rigid body, too, and with nothing else that asks for
/// velocities.
TEST(Expression, TheLedgerOfAForceClosesWithoutInertiaAndOnRigidBodies) {
  const std::string ring =
      "[[body]]\ntype = \"ring\"\ncount = 5\nradius = 1.0\ncentre = [0.0, 1.0]\n"
      "particle_mass = 0.2\ncoordinates = \"rigid\"\n";
  const std::string end = "[run]\nduration = 5.0\nledger = true\nintegrator = ";
  const std::string drag = "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.3\n";
  const RunResult point_alone =
      run_text("[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n" + drag +
               "[[force]]\ntype = \"expression\"\nforce = [\"0.3 + 0.2*sin(x)\"]\n" + end +
               adaptive(1e-12, "dop853") + "\ndynamics = \"overdamped\"\n");
  EXPECT_NEAR(*point_alone.group("energy")["heat_out"], 0.0, kExact);
  EXPECT_NEAR(*point_alone.group("energy")["numerical_work"], 0.0, kExact);
  const RunResult rolling = run_text(
      ring + drag + "[[force]]\ntype = \"expression\"\nforce = [\"0.3*sin(x) - y\", \"0.1*x\"]\n" +
      end + adaptive(1e-12, "dop853") + "\ndynamics = \"overdamped\"\n");
  EXPECT_NEAR(*rolling.group("energy")["heat_out"], 0.0, kExact);
  EXPECT_NEAR(*rolling.group("energy")["numerical_work"], 0.0, kExact);
  const RunResult pushed = run_text(
      ring + "[[force]]\ntype = \"driving_spring\"\nstiffness = 1.0\nvelocity = [0.1, 0.0]\n" +
      "[[force]]\ntype = \"expression\"\nforce = [\"0.1\", \"0.2\"]\n" + end +
      adaptive(1e-12, "dop853") + "\n");
  const auto& centre = pushed.body(0)["centre_of_mass"];
  EXPECT_NEAR(*pushed.group("energy")["heat_out"],
              -5.0 * (0.1 * centre[0] + 0.2 * (centre[1] - 1.0)), kExact);
  EXPECT_NEAR(*pushed.group("energy")["numerical_work"], 0.0, kExact);
}

/// A period is also tried where the particles are: here the formula is all but level elsewhere.
TEST(Expression, APeriodIsTriedWhereTheParticlesAre) {
  const auto faults = [](const std::string& energy, const std::string& period) {
    return faults_of(point("energy = \"" + energy + "\"\nperiod = " + period, "", "[0.3, 10.0]"));
  };
  const std::string wanted = "test.toml:8:10: force.expression.period [component.invalid]";
  const std::string well = "0.5*(y - 10)^2 + exp(-(y - 10)^2)*cos(2*pi*x)";
  EXPECT_EQ(faults(well, "0.7"), wanted);
  EXPECT_EQ(faults("sqrt(y - 5)*cos(2*pi*x)", "0.7"), wanted);
  EXPECT_EQ(faults("0.1*cos(2*pi*x)*(1 - exp(-(x - 20.5)^2)) + y", "1.0"), wanted);
  EXPECT_EQ(faults(well, "1.0"), "");
  EXPECT_EQ(faults(well, "[2.0, 0.0]"), "");
}

/// Powers of powers that no product could hold.
TEST(Expression, TowersOfPowersAreTaken) {
  const RunResult found =
      run_text(point("energy = \"(((((x^64)^64)^64)^64)^64)^2 + 0.5*x^2\"", "", "[0.5]"));
  EXPECT_EQ(found.status, RunStatus::finished);
}

/// The stiffness is 1 at the start and 1e6 a moment later: beyond 2.8e-3 rk4 is unstable.
TEST(Expression, AStepIsHeldAgainstTheStiffnessOfAllTimes) {
  std::string scene = point("energy = \"0.5*x^2*(1 + 1e6*sin(t)^2)\"");
  const std::string old = adaptive(1e-12, "dop853");
  scene.replace(scene.find(old), old.size(), fixed_step(1e-2));
  const RunResult refused = run_text(scene);
  ASSERT_EQ(refused.status, RunStatus::failed);
  EXPECT_NE(refused.failure->what.find("stability limit"), std::string::npos)
      << refused.failure->what;
  scene.replace(scene.find(fixed_step(1e-2)), fixed_step(1e-2).size(), fixed_step(1e-3));
  EXPECT_EQ(run_text(scene).status, RunStatus::finished);
}

TEST(Expression, PlacesFarOutWithoutAPeriodAreWarnedOf) {
  const auto warned = [](const std::string& period) {
    const RunResult found =
        run_text(point("energy = \"0.1*cos(2*pi*x)\"\n" + period, "", "[1e11]"));
    return count_of(FaultCode::number_type_coarse_positions, found.warnings);
  };
  EXPECT_EQ(warned(""), 1U);
  EXPECT_EQ(warned("period = 1.0"), 0U);
}

TEST(Expression, ParticlesInOnePlaceEncloseNoAngle) {
  const std::string scene = tables(R"--(
[[body]] | type = "particles" | positions = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]
particle_mass = 1.0
[[force]] | type = "expression" | energy = "cos(theta)"
[run] | duration = 1.0 | integrator = { type = "rk4", dt = 0.1 }
)--");
  EXPECT_EQ(faults_of(scene), "test.toml:8:10: force.expression.energy [component.unsuitable]");
}

// ---- number types and sets ----------------------------------------------------------------------

TEST(Expression, RunsInEveryNumberTypeWithTheSameLaw) {
  const auto mean = [&](const char* type) {
    const RunResult result =
        run_text(ring(kFormula, "particles"),
                 {{"run.number_type", "\"" + std::string(type) + "\""}, {"run.duration", "2.0"}});
    return result.driver(0)["mean_force"][0];
  };
  const double in_double = mean("double");
  EXPECT_NEAR(mean("quadruple"), in_double, 1e-11 * std::abs(in_double));
}

/// Second derivatives: the implicit scheme and equilibria take them.
TEST(Expression, SecondDerivativesServeTheImplicitScheme) {
  const auto with = [&](const std::string& substrate) {
    std::string scene = ring(substrate, "rigid");
    const std::string old = "{ type = \"rk4\", dt = 5e-3 }";
    scene.replace(scene.find(old), old.size(), adaptive(1e-9, "radau9"));
    return run_text(scene);
  };
  const RunResult expected = with(kBuiltIn);
  const RunResult found = with(kFormula);
  EXPECT_NEAR(found.driver(0)["mean_force"][0], expected.driver(0)["mean_force"][0], kSameLaw);
  // Errors of velocities are held to the scene's length by its time, which a formula does not say.
  EXPECT_NEAR(static_cast<double>(found.steps), static_cast<double>(expected.steps), 2.0);
}

}  // namespace
}  // namespace tomlin::test
