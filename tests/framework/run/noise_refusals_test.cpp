#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

// Settings that conflict with noise are refused, at their location in the scene.

namespace tomlin::test {
namespace {

struct BathScene {
  std::string body = "position = [0.0]";  // line 3
  std::string temperature = "0.2";        // line 8
  std::string force = "";                 // from line 9 on
  std::string run = "integrator = { type = \"baoab\", dt = 0.01 }";
  std::string more = "";

  std::string text() const {
    return "[[body]]\ntype = \"point\"\n" + body +
           "\nparticle_mass = 1.0\n[[force]]\nname = \"bath\"\ntype = \"langevin\"\ntemperature "
           "= " +
           temperature + "\ncoefficient = 1.0\n" + force + "[run]\nduration = 1.0\n" + run + "\n" +
           more;
  }
};

std::string with_integrator(const std::string& integrator) { return "integrator = " + integrator; }

struct RefusedBath {
  BathScene scene;
  std::string faults;
};

const std::string kSpring =
    "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\nvelocity = [0.1]\n";
const std::string kOverdamped = "dynamics = \"overdamped\"\n";

std::vector<RefusedBath> refused_baths() {
  return {
      {{.run = with_integrator("{ type = \"rk4\", dt = 0.01 }")},
       "12:14 run.integrator.type = \"rk4\" [integrator.unsuitable]"},
      {{.run = with_integrator("{ type = \"dopri5\" }")},
       "12:14 run.integrator.type = \"dopri5\" [integrator.unsuitable]"},
      {{.run = with_integrator("{ type = \"exponential_verlet\", dt = 0.01 }")},
       "12:14 run.integrator.type = \"exponential_verlet\" [integrator.unsuitable]"},
      {{.run = kOverdamped + with_integrator("{ type = \"rk4\", dt = 0.01 }")},
       "13:14 run.integrator.type = \"rk4\" [integrator.unsuitable]"},
      {{.run = kOverdamped + with_integrator("{ type = \"baoab\", dt = 0.01 }")},
       "13:14 run.integrator.type = \"baoab\" [integrator.unsuitable]"},
      {{.run = kOverdamped + with_integrator("{ type = \"gjf\", dt = 0.01 }")},
       "13:14 run.integrator.type = \"gjf\" [integrator.unsuitable]"},
      {{.run = with_integrator("{ type = \"euler_maruyama\", dt = 0.01 }")},
       "12:14 run.integrator.type = \"euler_maruyama\" [integrator.unsuitable]"},
      {{.temperature = "0.0",
        .run = with_integrator("{ type = \"leimkuhler_matthews\", dt = 0.01 }")},
       "12:14 run.integrator.type = \"leimkuhler_matthews\" [integrator.unsuitable]"},
      {{.temperature = "-0.1"}, "8:15 force.bath.temperature = -0.1 [scene.out_of_range]"},
      {{.body = "position = [0.0]\nstart_temperature = -1.0"},
       "4:21 body.point.start_temperature = -1.0 [scene.out_of_range]"},
      {{.body = "position = [0.0]\ncoordinates = \"fixed\""},
       "9:15 force.bath.temperature [component.unsuitable]"},
      {{.body = "position = [0.0]\ncoordinates = \"prescribed\"\nmotion = { velocity = [1.0] }"},
       "10:15 force.bath.temperature [component.unsuitable]"},
      {{.force = "[[force]]\nname = \"second\"\ntype = \"langevin\"\ncoefficient = 1.0\n"
                 "temperature = 0.1\n"},
       "14:15 force.second.temperature [component.unsuitable]"},
      {{.more = "[output]\nevery = 0.025\n"}, "14:9 output.every = 0.025 [component.unsuitable]"},
      {{.more = "[output]\nevery = 0.001\n"}, "14:9 output.every = 0.001 [component.unsuitable]"},
      {{.force = kSpring,
        .run = with_integrator("{ type = \"baoab\", dt = 0.01 }\n") +
               "perturb = { size = 1e-6, repeats = 2 }"},
       "18:11 run.perturb [component.unsuitable]"},
      {{.force = kSpring,
        .run = with_integrator("{ type = \"baoab\", dt = 0.01 }\n") +
               "until = { steady = \"driver.mean_force.x\", tolerance = 1e-3, max = 9.0 }"},
       "18:9 run.until [component.unsuitable]"},
      {{.force = kSpring, .run = "accuracy = 1e-4"}, "17:12 run.accuracy [component.unsuitable]"},
      {{.force = kSpring, .run = "dynamics = \"quasistatic\""},
       "17:12 run.dynamics = \"quasistatic\" [component.unsuitable]"},
  };
}

TEST(NoiseRefusals, HavePlaceAndCode) {
  for (const RefusedBath& refused : refused_baths()) {
    EXPECT_EQ(brief_refusal(refused.scene.text()), refused.faults) << refused.scene.text();
    const auto in_a_run = briefs_of([&] { run_text(refused.scene.text()); });
    EXPECT_EQ(fmt::format("{}", fmt::join(in_a_run, "\n")), refused.faults);
  }
}

TEST(NoiseRefusals, WhatIsNotRefused) {
  const std::vector<BathScene> taken = {
      {},
      {.more = "[output]\nevery = 0.01\n"},
      {.more = "[output]\nevery = 0.03\n"},
      {.run = with_integrator("{ type = \"gjf\", dt = 0.01 }")},
      {.run = with_integrator("{ type = \"velocity_verlet\", dt = 0.01 }")},
      {.run = kOverdamped + with_integrator("{ type = \"leimkuhler_matthews\", dt = 0.01 }")},
      {.run = kOverdamped + with_integrator("{ type = \"euler_maruyama\", dt = 0.01 }")},
      {.temperature = "0.0", .run = with_integrator("{ type = \"rk4\", dt = 0.01 }")},
      {.temperature = "0.0",
       .run = with_integrator("{ type = \"dopri5\" }"),
       .more = "[output]\nevery = 0.025\n"},
      {.temperature = "0.0",
       .force = "[[force]]\nname = \"second\"\ntype = \"langevin\"\ncoefficient = 1.0\n"
                "temperature = 0.1\n"},
      {.force = "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"},
  };
  for (const BathScene& scene : taken) EXPECT_EQ(refusal(scene.text()), "") << scene.text();
}

/// Three particles of a body that moves as one.
std::string rigid_bath(const std::string& keys, const std::string& run) {
  return "[[body]]\ntype = \"ring\"\ncount = 3\nradius = 1.0\ncentre = [0.0, 1.0]\n"
         "particle_mass = 1.0\ncoordinates = \"rigid\"\n"
         "[[force]]\nname = \"bath\"\ntype = \"langevin\"\n" +
         keys + "\n[run]\nduration = 1.0\n" + run + "\n";
}

const std::string kInertialBath = "integrator = { type = \"baoab\", dt = 0.01 }";
const std::string kOverdampedBath =
    "dynamics = \"overdamped\"\nintegrator = { type = \"euler_maruyama\", dt = 0.01 }";

TEST(NoiseRefusals, OfRigidBodies) {
  const std::string off_centre = "coefficient = [1.0, 2.0, 3.0]\ntemperature = 0.1";
  EXPECT_EQ(refusal(rigid_bath(off_centre, kInertialBath)), "");
  EXPECT_EQ(brief_refusal(rigid_bath(off_centre, kOverdampedBath)),
            "12:15 force.bath.temperature [component.unsuitable]");
  const std::string centred = "coefficient = 1.0\ntemperature = 0.1";
  EXPECT_EQ(refusal(rigid_bath(centred, kOverdampedBath)), "");
  const std::string two_baths = "coefficient = 1.0\ntemperature = [0.1, 0.1, 0.2]";
  EXPECT_EQ(brief_refusal(rigid_bath(two_baths, kInertialBath)),
            "12:15 force.bath.temperature [component.unsuitable]");
}

/// Temperatures of particles, the first of which has none.
TEST(NoiseRefusals, TemperaturesOfParticles) {
  const std::string chain =
      "[[body]]\ntype = \"chain\"\ncount = 3\norigin = [0.0]\nspacing = 1.0\n"
      "particle_mass = 1.0\n[[force]]\nname = \"bath\"\ntype = \"langevin\"\ncoefficient = 1.0\n";
  for (const std::string temperature : {"[0.0, 0.1, 0.2]", "[0.1, 0.0, 0.2]"}) {
    const std::string text = chain + "temperature = " + temperature + "\n[run]\nduration = 1.0\n";
    EXPECT_EQ(refusal(text + kInertialBath + "\n"), "") << temperature;
    EXPECT_EQ(brief_refusal(text + "integrator = { type = \"rk4\", dt = 0.01 }\n"),
              "14:14 run.integrator.type = \"rk4\" [integrator.unsuitable]")
        << temperature;
  }
}

/// No friction, no noise.
TEST(NoiseRefusals, ACoefficientOfZero) {
  EXPECT_EQ(refusal(rigid_bath("coefficient = 0.0\ntemperature = 0.1", kInertialBath)), "");
  EXPECT_EQ(refusal(rigid_bath("coefficient = [0.0, 0.0, 1.0]\ntemperature = 0.1", kInertialBath)),
            "");
  const RunResult result =
      run_text(rigid_bath("coefficient = 0.0\ntemperature = 0.1", kInertialBath));
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.body(0)["velocity"][0], 0.0);
}

/// Noise that moves a particle by more than a sixth of a period in a step, in the root mean square,
/// sooner or later moves it by a period.
TEST(NoiseRefusals, StepsInWhichNoiseMovesTooFar) {
  const auto ended = [](const std::string& dt) {
    return run_text(
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n[[force]]\ntype = "
        "\"sinusoidal_substrate\"\namplitude = 0.01\nperiod = 1.0\n[[force]]\nname = "
        "\"bath\"\ntype = "
        "\"langevin\"\ncoefficient = 1.0\ntemperature = 0.3\n[run]\ndynamics = \"overdamped\"\n"
        "duration = 2.0\nintegrator = { type = \"euler_maruyama\", dt = " +
        dt + " }\n");
  };
  // sqrt(2 T dt) = 1/6 at dt = 0.0463.
  EXPECT_EQ(ended("0.045").status, RunStatus::finished);
  const RunResult refused = ended("0.048");
  ASSERT_TRUE(refused.failure);
  EXPECT_EQ(refused.failure->code, FaultCode::run_step_unstable);
  EXPECT_EQ(refused.failure->step, 0);
  EXPECT_NE(refused.failure->what.find("noise"), std::string::npos) << refused.failure->what;
}

/// A harmonic well of relaxation rate 1: euler_maruyama has the variance T/k / (1 - dt/2) of it,
/// wrong by a tenth at dt = 2/11.
TEST(NoiseWarnings, ADistributionThatIsTooWide) {
  const auto warns = [](const std::string& scheme, double dt, double temperature) {
    const RunResult result = run_text(
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n[[force]]\ntype = "
        "\"driving_spring\"\nstiffness = 2.0\nvelocity = [0.0]\n[[force]]\nname = \"bath\"\n"
        "type = \"langevin\"\ncoefficient = 2.0\ntemperature = " +
        digits(temperature) + "\n[run]\ndynamics = \"overdamped\"\nduration = 10.0\n" +
        "integrator = { type = \"" + scheme + "\", dt = " + digits(dt) + " }\n");
    EXPECT_EQ(result.status, RunStatus::finished);
    return count_of(FaultCode::integrator_wide_distribution, result.warnings);
  };
  constexpr double kLimit = 2.0 / 11.0;
  EXPECT_EQ(warns("euler_maruyama", 1.001 * kLimit, 0.1), 1U);
  EXPECT_EQ(warns("euler_maruyama", 0.999 * kLimit, 0.1), 0U);
  EXPECT_EQ(warns("euler_maruyama", 1.5, 0.1), 1U);
  EXPECT_EQ(warns("euler_maruyama", 1.001 * kLimit, 0.0), 0U);
  EXPECT_EQ(warns("leimkuhler_matthews", 1.001 * kLimit, 0.1), 0U);
  const auto error = standard().integrator("euler_maruyama")->variance_error;
  ASSERT_NE(error, nullptr);
  EXPECT_NEAR(error(kLimit), 0.1, 1e-15);
}

}  // namespace
}  // namespace tomlin::test
