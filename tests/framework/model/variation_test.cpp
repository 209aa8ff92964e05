// Parameters that differ between the particles of a body: lists, and expressions in their index.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

namespace tomlin::test {
namespace {

// Each particle of the body is compared with a body of its own that has the numbers of this
// particle alone.
constexpr int kParticles = 11;  // more than one group of eight, and no multiple of it

std::string run_part(const std::string& number_type, const std::string& integrator) {
  return "[run]\nduration = 3.0\nledger = true\nnumber_type = \"" + number_type +
         "\"\nintegrator = " + integrator + "\n";
}

double amplitude(int i) { return 0.1 + 0.02 * i; }
double coefficient(int i) { return 0.05 * (i + 1); }
double decay(int i) { return 0.5 + 0.1 * i; }

std::string particle_alone(int i) {
  const std::string name = "p" + std::to_string(i);
  const auto force = [&](const std::string& type, const std::string& rest) {
    return "[[force]]\nname = \"" + type + std::to_string(i) + "\"\ntype = \"" + type +
           "\"\nbody = \"" + name + "\"\n" + rest;
  };
  return "[[body]]\nname = \"" + name + "\"\ntype = \"point\"\nposition = [" + digits(0.3 * i) +
         ", 0.4]\nvelocity = [0.0, " + digits(0.01 * i) +
         "]\nparticle_mass = " + digits(1.0 + 0.25 * i) + "\n" +
         force("sinusoidal_substrate", "period = 1.0\namplitude = " + digits(amplitude(i)) +
                                           "\ndecay = " + digits(decay(i)) +
                                           "\noffset = " + digits(0.125 * i) + "\n") +
         force("viscous_damping", "coefficient = " + digits(coefficient(i)) + "\n") +
         force("constant_force", "force = [" + digits(0.01 * i) + ", -0.1]\n");
}

std::string listed(double (*value)(int)) {
  std::string list;
  for (int i = 0; i < kParticles; ++i) list += (i ? ", " : "[") + digits(value(i));
  return list + "]";
}

std::string particles_together() {
  std::string positions;
  for (int i = 0; i < kParticles; ++i) {
    positions += (i ? ", [" : "[[") + digits(0.3 * i) + ", 0.4]";
  }
  return "[[body]]\nname = \"all\"\ntype = \"particles\"\npositions = " + positions +
         "]\nvelocity = [0.0, \"0.01 * i\"]\nparticle_mass = \"1 + i / 4\"\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\nperiod = 1.0\namplitude = " +
         listed(amplitude) + "\ndecay = " + listed(decay) +
         "\noffset = \"0.125 * i\"\n"
         "[[force]]\ntype = \"viscous_damping\"\ncoefficient = " +
         listed(coefficient) +
         "\n[[force]]\ntype = \"constant_force\"\nforce = [\"0.01 * i\", -0.1]\n";
}

std::vector<double> ends_of(const RunResult& result, const std::string& prefix, int count) {
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    for (const char* axis : {".x", ".y"}) {
      numbers.push_back(
          observable(result, prefix + std::to_string(i) + ".centre_of_mass" + axis).value());
    }
  }
  return numbers;
}

struct Numbers {
  const char* number_type;
  const char* integrator;
};

class Varied : public testing::TestWithParam<Numbers> {};

TEST_P(Varied, EachParticleMovesAsOneAloneWithItsNumbers) {
  const std::string run = run_part(GetParam().number_type, GetParam().integrator);
  std::string apart;
  for (int i = 0; i < kParticles; ++i) apart += particle_alone(i);
  const RunResult alone = run_text(apart + run);
  // The mean of the particles, mass by mass, is what a body of them tells.
  const RunResult together = run_text(particles_together() + run);
  const std::vector<double> positions = ends_of(alone, "p", kParticles);
  double mean_x = 0.0;
  double mean_y = 0.0;
  double mass = 0.0;
  for (int i = 0; i < kParticles; ++i) {
    const double own = 1.0 + 0.25 * i;
    mean_x += own * positions[2 * i];
    mean_y += own * positions[2 * i + 1];
    mass += own;
  }
  constexpr double kRounding = 1e-13;  // of sums in another order
  EXPECT_NEAR(observable(together, "all.centre_of_mass.x").value(), mean_x / mass, kRounding);
  EXPECT_NEAR(observable(together, "all.centre_of_mass.y").value(), mean_y / mass, kRounding);
  for (const char* term : {"energy.kinetic", "energy.potential", "energy.heat_out"}) {
    const double expected = observable(alone, term).value();
    EXPECT_NE(expected, 0.0) << term;
    EXPECT_NEAR(observable(together, term).value(), expected, 10 * kRounding) << term;
  }
}

INSTANTIATE_TEST_SUITE_P(InEveryNumberType, Varied,
                         testing::Values(Numbers{"double", "{ type = \"rk4\", dt = 0.01 }"},
                                         Numbers{"quadruple", "{ type = \"rk4\", dt = 0.1 }"},
                                         Numbers{"double",
                                                 "{ type = \"velocity_verlet\", dt = 0.01 }"},
                                         Numbers{"double",
                                                 "{ type = \"dopri5\", absolute_tolerance = 1e-13, "
                                                 "relative_tolerance = 1e-13 }"}));

const std::string kRigid = tables(R"(
[[body]] | type = "ring" | count = 9 | radius = 0.7 | centre = [0.1, 0.8] | particle_mass = 0.1
coordinates = "rigid"
[[force]] | type = "sinusoidal_substrate" | amplitude = AMPLITUDE | period = 1.0 | decay = 0.3
[run] | duration = 2.0 | ledger = true | integrator = { type = "rk4", dt = 0.01 }
)");

std::string with(std::string text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what)) {
    text.replace(at, what.size(), by);
  }
  return text;
}

TEST(Varied, EqualNumbersAreOneNumberToTheLastBit) {
  const RunResult one = run_text(with(kRigid, "AMPLITUDE", "0.1"));
  const RunResult each = run_text(with(kRigid, "AMPLITUDE", "\"0.1 + 0 * i\""));
  for (const char* path : {"ring.centre_of_mass.x", "ring.centre_of_mass.y", "ring.rotation",
                           "energy.potential", "energy.kinetic"}) {
    EXPECT_EQ(observable(one, path).value(), observable(each, path).value()) << path;
  }
}

TEST(Varied, AnAmplitudeOfOneParticleOnlyTurnsTheRing) {
  const RunResult one = run_text(with(kRigid, "AMPLITUDE", "\"0.9 * floor(i / 8)\""));
  EXPECT_GT(std::abs(observable(one, "ring.rotation").value()), 1e-3);
  constexpr double kOrderFour = 1e-6;  // of rk4 with a step of 0.01
  EXPECT_NEAR(observable(one, "energy.numerical_work").value(), 0.0, kOrderFour);
}

TEST(Varied, CountIsThatOfTheBody) {
  const RunResult shared = run_text(with(kRigid, "AMPLITUDE", "\"0.9 / count\""));
  const RunResult typed = run_text(with(kRigid, "AMPLITUDE", "\"0.9 / 9\""));
  EXPECT_EQ(observable(shared, "ring.centre_of_mass.x").value(),
            observable(typed, "ring.centre_of_mass.x").value());
}

/// Also where values cannot differ between particles, and in lists; of one body, not of several.
TEST(Varied, CountIsKnownInEveryNumberOfAForce) {
  const std::string forces = tables(R"([[force]] | type = "driving_spring" | body = "ring"
stiffness = "2 / count" | velocity = ["count * 0.1", 0.0]
[[force]] | type = "lattice_substrate" | lattice = "line" | bodies = ["ring"]
period = "1 + 0 * count" | amplitudes = ["0.9 / count"]
)");
  const std::string text = with(kRigid, "AMPLITUDE", "0.1") + forces;
  const auto shared = scene_of(text);
  const auto typed =
      scene_of(with(text, "count *", "9 *"), {{"force.driving_spring.stiffness", "2 / 9"},
                                              {"force.lattice_substrate.amplitudes", "[0.1]"}});
  const auto again = scene_of(shared->effective_toml);
  for (const char* path : {"ring.centre_of_mass.x", "ring.rotation"}) {
    EXPECT_EQ(observable(run(shared), path).value(), observable(run(typed), path).value());
    EXPECT_EQ(observable(run(shared), path).value(), observable(run(again), path).value());
  }
  const auto refused = [&](const std::string& what, const std::string& by) {
    try {
      scene_of(with(text, what, by));
      ADD_FAILURE() << by;
    } catch (const InputError& error) {
      ASSERT_EQ(error.faults().size(), 1u) << by;
      EXPECT_EQ(error.faults().front().code, FaultCode::expression_unknown_name) << by;
      EXPECT_NE(error.faults().front().admissible, "") << by << ": keys that may differ";
    }
  };
  refused("2 / count", "2 / i");
  refused("1 + 0 * count", "1 + 0 * i");
  refused("radius = 0.7", "radius = \"count\"");
  EXPECT_THROW(scene_of(with(text, "duration = 2.0", "duration = \"count\"")), InputError);
}

TEST(Varied, DisplacementsMoveParticlesFromTheirShape) {
  const auto scene = scene_of(tables(R"(
[[body]] | type = "chain" | count = 3 | spacing = 1.0 | particle_mass = 1.0
displacement = ["0.1 * (i - 1) ^ 2"]
[run] | duration = 1.0 | integrator = { type = "rk4", dt = 0.5 }
)"));
  const RunResult result = run(scene);
  // (0.1 + 1 + 2.1)/3
  EXPECT_NEAR(observable(result, "chain.centre_of_mass.x").value(), 3.2 / 3.0, 1e-15);
}

TEST(Varied, TheStableStepIsThatOfTheStiffestParticle) {
  // k = amplitude (2 pi/a)^2: 4e4 for the last, whose limit of rk4 is 2.83/200.
  const std::string text = with(kRigid, "AMPLITUDE",
                                "[1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, "
                                "1e-3, 1e6]");
  const RunResult result = run_text(text);
  ASSERT_EQ(result.status, RunStatus::failed);
  EXPECT_EQ(result.failure->code, FaultCode::run_step_unstable);
}

/// The narrowest of several widths of dry friction, whatever the others are.
TEST(Varied, TheStableStepIsThatOfTheNarrowestFriction) {
  const auto status = [](const std::string& width) {
    return run_text(tables(R"([[body]] | type = "particles" | positions = [0.0, 5.0]
velocity = [0.01] | particle_mass = 1.0
[[force]] | type = "coulomb_friction" | force = 1.0 | width = )") +
                    width + "\n[run]\nduration = 1.0\nintegrator = " + fixed_step(2e-2) + "\n")
        .status;
  };
  EXPECT_EQ(status("[1e-4, 1.0]"), RunStatus::failed);
  EXPECT_EQ(status("[1.0, 1e-4]"), RunStatus::failed);
  EXPECT_EQ(status("[1.0, 0.5]"), RunStatus::finished);
}

void expect_fault(const std::string& amplitude, FaultCode code) {
  try {
    scene_of(with(kRigid, "AMPLITUDE", amplitude));
    ADD_FAILURE() << amplitude;
  } catch (const InputError& error) {
    ASSERT_EQ(error.faults().size(), 1u) << amplitude;
    EXPECT_EQ(error.faults().front().code, code) << amplitude;
    EXPECT_EQ(error.faults().front().key, "force.sinusoidal_substrate.amplitude") << amplitude;
  }
}

TEST(Varied, FaultsHaveTheirPlace) {
  expect_fault("[0.1, 0.2]", FaultCode::scene_wrong_count);
  expect_fault("\"1 / (i - 3)\"", FaultCode::expression_not_finite);
  expect_fault("\"0.1 * j\"", FaultCode::expression_unknown_name);
  expect_fault("[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, \"y\"]",
               FaultCode::expression_unknown_name);
}

TEST(Varied, WhatIsOneForAllRefusesALine) {
  const auto text = with(with(kRigid, "AMPLITUDE", "0.1"), "period = 1.0", "period = [1.0, 2.0]");
  EXPECT_THROW(scene_of(text), InputError);
  EXPECT_THROW(scene_of(with(with(kRigid, "AMPLITUDE", "0.1"), "count = 9", "count = \"i\"")),
               InputError);
}

TEST(Varied, AParameterKeepsItsNameBeforeTheIndex) {
  const std::string text = "[parameters]\ni = 2.0\n" + std::string(kRigid);
  const RunResult named = run_text(with(text, "AMPLITUDE", "\"0.05 * i\""));
  const RunResult typed = run_text(with(kRigid, "AMPLITUDE", "0.1"));
  EXPECT_EQ(observable(named, "ring.rotation").value(), observable(typed, "ring.rotation").value());
}

TEST(Varied, TheEffectiveSceneSaysTheSame) {
  const auto scene = scene_of(with(kRigid, "AMPLITUDE", "\"0.1 + 0.01 * i\""));
  const auto again = scene_of(scene->effective_toml);
  EXPECT_EQ(scene->effective_toml, again->effective_toml);
  EXPECT_EQ(observable(run(scene), "ring.rotation").value(),
            observable(run(again), "ring.rotation").value());
}

}  // namespace
}  // namespace tomlin::test
