#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/faults.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/text.hpp"

// How scenes in metal units are read, and what they are written as.

namespace tomlin::test {
namespace {

const std::string kAtoms = R"([scene]
units = "metal"
[parameters]
m = 12.011
T = "3 * 100"
[[body]]
name = "pair"
type = "chain"
count = 2
spacing = 1.42
particle_mass = ["m", 28.0855]
start_temperature = "T"
[[body]]
name = "one"
type = "point"
position = [3.0]
particle_mass = "m / 3"
[[body]]
name = "three"
type = "chain"
count = 3
spacing = 1.0
origin = [9.0]
particle_mass = "m * (i + 1) / count"
[[force]]
name = "bath"
type = "langevin"
body = "pair"
coefficient = 0.001
temperature = ["T", 250]
[[force]]
name = "springs"
type = "harmonic_bonds"
pairs = "neighbours"
body = "pair"
stiffness = 2.5
[run]
duration = 1.0
integrator = { type = "baoab", dt = 1e-3 }
)";

template <class Value>
Value value_of(const Scene& scene, const std::string& body, const std::string& key) {
  for (const SceneBody& one : scene.bodies) {
    if (one.name != body) continue;
    for (const Parameter& row : one.record->parameters) {
      if (row.key == key) return std::get<Value>(row.read(one.description.get()));
    }
  }
  throw std::logic_error("no " + body + "." + key);
}

TEST(MetalScene, IsReadIntoTheEnginesUnits) {
  const auto scene = scene_of(kAtoms);
  const double u = kAtomicMassInMetal;
  EXPECT_EQ(scene->units, UnitSystem::metal);
  EXPECT_EQ(value_of<PerParticle>(*scene, "pair", "particle_mass").values,
            (std::vector<double>{12.011 * u, 28.0855 * u}));
  EXPECT_EQ(value_of<PerParticle>(*scene, "one", "particle_mass").values,
            (std::vector<double>{12.011 / 3 * u}));
  EXPECT_EQ(value_of<PerParticle>(*scene, "three", "particle_mass").values,
            (std::vector<double>{12.011 * 1 / 3 * u, 12.011 * 2 / 3 * u, 12.011 * 3 / 3 * u}));
  EXPECT_EQ(value_of<double>(*scene, "pair", "start_temperature"), 300.0 * kBoltzmannInMetal);
  EXPECT_EQ(value_of<double>(*scene, "pair", "spacing"), 1.42);
  const SceneForce& bath = scene->forces.front();
  ASSERT_EQ(bath.variations.size(), 1u);
  EXPECT_EQ(std::get<PerParticle>(bath.variations[0].values).values,
            (std::vector<double>{300.0 * kBoltzmannInMetal, 250.0 * kBoltzmannInMetal}));
  // Parameters are numbers as given.
  EXPECT_EQ(scene->parameters,
            (std::vector<std::pair<std::string, double>>{{"m", 12.011}, {"T", 300.0}}));
}

/// The effective scene has what was given, and is read back as the same numbers.
TEST(MetalScene, EffectiveSceneIsInItsUnits) {
  const auto scene = scene_of(kAtoms);
  const std::string& text = scene->effective_toml;
  for (const char* line :
       {"units = \"metal\"", "particle_mass = [\"m\", 28.0855]", "start_temperature = \"T\"",
        "temperature = [\"T\", 250]", "start_temperature = 0.0"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  }
  const auto again = scene_of(text);
  EXPECT_EQ(again->effective_toml, text);
  for (const char* body : {"pair", "one", "three"}) {
    EXPECT_EQ(value_of<PerParticle>(*again, body, "particle_mass"),
              value_of<PerParticle>(*scene, body, "particle_mass"));
  }
}

TEST(MetalScene, SettingsAreInItsUnits) {
  const auto scene = scene_of(kAtoms, {{"T", "10"}, {"body.one.particle_mass", "2"}});
  EXPECT_EQ(value_of<double>(*scene, "pair", "start_temperature"), 10.0 * kBoltzmannInMetal);
  EXPECT_EQ(value_of<PerParticle>(*scene, "one", "particle_mass").values,
            (std::vector<double>{2.0 * kAtomicMassInMetal}));
}

/// The heading may stand anywhere.
TEST(MetalScene, HeadingAtTheEnd) {
  std::string text = kAtoms;
  text.erase(0, text.find("[parameters]"));
  text += "[scene]\nunits = \"metal\"\n";
  EXPECT_EQ(value_of<double>(*scene_of(text), "pair", "start_temperature"),
            300.0 * kBoltzmannInMetal);
}

TEST(MetalScene, Faults) {
  struct Case {
    std::string before, after, fault, part;
  };
  const Case cases[] = {
      {"units = \"metal\"", "units = \"metall\"",
       "test.toml:2:9: scene.units = \"metall\" [scene.unknown_choice]", "u, K"},
      {"units = \"metal\"", "units = \"real\"",
       "test.toml:2:9: scene.units = \"real\" [scene.unknown_choice]", "\"metal\""},
      {"units = \"metal\"", "units = \"metal\"\naxes = { length = \"a\" }",
       "test.toml:3:1: scene.axes [scene.conflict]", "reduced"},
      {"\"m / 3\"", "0.0", "test.toml:17:17: body.one.particle_mass = 0.0 [scene.out_of_range]",
       "> 0"},
      {"\"m / 3\"", "1e-322",
       "test.toml:17:17: body.one.particle_mass = 1e-322 [scene.out_of_range]", "engine"},
      {"[\"T\", 250]", "-1.0",
       "test.toml:30:15: force.bath.temperature = -1.0 [scene.out_of_range]", ">= 0"}};
  for (const Case& one : cases) {
    const std::string found = refusal(replaced(kAtoms, one.before, one.after));
    EXPECT_NE(abridged(found).find(one.fault), std::string::npos) << one.fault << "\n" << found;
    EXPECT_NE(found.find(one.part), std::string::npos) << one.part << "\n" << found;
  }
}

}  // namespace
}  // namespace tomlin::test
