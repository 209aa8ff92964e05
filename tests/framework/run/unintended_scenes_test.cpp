#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

// Scenes that are valid and probably not what was meant have a warning; valid neighbours have none.

namespace tomlin::test {
namespace {

struct Atoms {
  std::string units = "units = \"metal\"\n";
  std::string species = "species = \"C\"\n";
  std::string numbers = "parameters = \"lindsay_broido_2010\"\n";

  std::string text() const {
    return "[scene]\n" + units +
           "[[body]]\nname = \"atoms\"\ntype = \"particles\"\npositions = [[0.0, 0.0, 0.0], "
           "[1.6, 0.0, 0.0], [0.8, 1.38, 0.0]]\n" +
           species + "particle_mass = 12.011\n[[force]]\nname = \"bonds\"\ntype = \"tersoff\"\n" +
           numbers +
           "[run]\nduration = 0.01\nintegrator = { type = \"velocity_verlet\", dt = 1e-4 }\n";
  }
};

std::vector<std::string> warnings_of(const std::string& scene) {
  return briefs(run_text(scene).warnings);
}

const std::string kEntries =
    "entries = \"C C C 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.74 1.95 0.15 "
    "3.4879 1393.6\"\n";

TEST(UnintendedScenes, AtomsWithoutSpeciesBesideAPotentialThatKnowsThem) {
  const std::vector<std::string> expected = {"body.atoms.species [component.no_species]"};
  EXPECT_EQ(warnings_of(Atoms{.species = ""}.text()), expected);
  EXPECT_EQ(warnings_of(Atoms{.species = "", .numbers = kEntries}.text()), expected);
  EXPECT_TRUE(warnings_of(Atoms{}.text()).empty());
  EXPECT_TRUE(warnings_of(Atoms{.numbers = kEntries}.text()).empty());
  const std::string text = run_text(Atoms{.species = ""}.text()).warnings.at(0).text;
  EXPECT_NE(text.find("species = \"C\""), std::string::npos) << text;
}

/// The fault stands at the species, with those that the potential knows.
TEST(UnintendedScenes, SpeciesThatAPotentialDoesNotKnow) {
  const std::string scene = Atoms{.species = "species = \"c\"\n"}.text();
  EXPECT_EQ(brief_refusal(scene), "7:11 body.atoms.species = \"c\" [component.unsuitable]");
  EXPECT_NE(refusal(scene).find("expected: C"), std::string::npos) << refusal(scene);
}

TEST(UnintendedScenes, PublishedNumbersInReducedUnits) {
  const RunResult reduced = run_text(Atoms{.units = ""}.text());
  EXPECT_EQ(briefs(reduced.warnings),
            std::vector<std::string>{"force.bonds.parameters [component.other_units]"});
  const std::string& text = reduced.warnings.at(0).text;
  EXPECT_NE(text.find("units = \"metal\""), std::string::npos) << text;
  // Numbers of the scene's own are in its units, whatever these are.
  EXPECT_TRUE(warnings_of(Atoms{.units = "", .numbers = kEntries}.text()).empty());
  // The scene that a run writes says the same.
  EXPECT_EQ(warnings_of(scene_of(Atoms{.units = ""}.text())->effective_toml),
            briefs(reduced.warnings));
}

struct HotTip {
  std::string temperature;
  std::string substrate = "type = \"sinusoidal_substrate\"\namplitude = 0.5\nperiod = 1.0\n";
  std::string body = "type = \"point\"\nposition = [0.0]\n";
  std::string units = "";

  std::string text() const {
    return units + "[[body]]\nname = \"tip\"\n" + body +
           "particle_mass = 1.0\n[[force]]\nname = \"surface\"\n" + substrate +
           "[[force]]\ntype = \"langevin\"\ncoefficient = 1.0\ntemperature = " + temperature +
           "\n[run]\nduration = 1.0\nallow_unstable = true\n"
           "integrator = { type = \"baoab\", dt = 1e-3 }\n";
  }
};

bool is_too_hot(const HotTip& tip) {
  return count_of(FaultCode::run_far_above_barriers, run_text(tip.text()).warnings) == 1;
}

/// The barrier of a sine of amplitude 0.5 is 1, and the threshold 100 of them.
TEST(UnintendedScenes, TemperaturesFarAboveTheBarriers) {
  EXPECT_TRUE(is_too_hot({.temperature = "300.0"}));
  EXPECT_TRUE(is_too_hot({.temperature = "101.0"}));
  EXPECT_FALSE(is_too_hot({.temperature = "99.0"}));
  EXPECT_FALSE(is_too_hot({.temperature = "0.1"}));
  const RunResult hot = run_text(HotTip{.temperature = "300.0"}.text());
  EXPECT_EQ(brief(hot.warnings.at(0)), "body.tip [run.far_above_barriers]");
  EXPECT_NE(hot.warnings.at(0).text.find("k_B T"), std::string::npos) << hot.warnings.at(0).text;
  // A free particle has no barriers, nor is it known how high those of a formula are.
  const std::string force = "type = \"constant_force\"\nforce = [0.1]\n";
  EXPECT_FALSE(is_too_hot({.temperature = "300.0", .substrate = force}));
  const std::string formula = "type = \"expression\"\nenergy = \"0.5*cos(2*pi*x)\"\n";
  EXPECT_FALSE(is_too_hot({.temperature = "300.0", .substrate = formula}));
  // The barriers of the particles of a rigid body may add up.
  const std::string flake = "type = \"chain\"\ncount = 4\nspacing = 1.0\ncoordinates = \"rigid\"\n";
  EXPECT_FALSE(is_too_hot({.temperature = "300.0", .body = flake}));
  EXPECT_TRUE(is_too_hot({.temperature = "401.0", .body = flake}));
  // A temperature in metal units is in K: 300 K are 0.026 eV.
  const std::string metal = "[scene]\nunits = \"metal\"\n";
  EXPECT_FALSE(is_too_hot({.temperature = "300.0", .units = metal}));
}

}  // namespace
}  // namespace tomlin::test
