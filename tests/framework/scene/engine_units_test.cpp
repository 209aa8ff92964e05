#include "framework/scene/engine_units.hpp"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/faults.hpp"
#include "tests/support/scenes.hpp"

// What scenes in metal units become in the engine's, and back.

namespace tomlin::test {
namespace {

constexpr auto kMetal = UnitSystem::metal;

// ---- units and their names

/// CODATA 2018 by other ways: the energy equivalent of u, 931.49410242(28) MeV, and the
/// Rydberg-free quotient R/F = 8.314462618/96485.33212 of the molar constants.
TEST(MetalUnits, HaveCodatasConstants) {
  constexpr double kLight = 2997924.58;                     // A/ps
  constexpr double kMass = 931494102.42 / kLight / kLight;  // eV ps^2/A^2
  constexpr double kBoltzmann = 8.314462618 / 96485.33212;  // eV/K
  constexpr double kDigitsGiven = 1e-9;
  EXPECT_NEAR(scene_unit(kMetal, dimension::mass) / kMass, 1.0, kDigitsGiven);
  EXPECT_NEAR(scene_unit(kMetal, dimension::temperature) / kBoltzmann, 1.0, kDigitsGiven);
  // u is known to 3e-10; the rounded constant of LAMMPS is another number.
  EXPECT_GT(std::abs(scene_unit(kMetal, dimension::mass) / 1.0364269e-4 - 1.0), 1e-8);
}

TEST(MetalUnits, ConvertMassesAndTemperaturesAlone) {
  const double u = scene_unit(kMetal, dimension::mass);
  const double kelvin = scene_unit(kMetal, dimension::temperature);
  EXPECT_EQ(scene_unit(kMetal, {.mass = 1, .length = 2}), u);   // moment of inertia
  EXPECT_EQ(scene_unit(kMetal, {.mass = 1, .length = -3}), u);  // density
  EXPECT_EQ(scene_unit(kMetal, {.mass = -1}), 1.0 / u);
  EXPECT_EQ(scene_unit(kMetal, {1, 2, -2, -1}), 1.0 / kelvin);  // heat capacity, eV/K
  for (const Dimension& dimension :
       {dimension::none, dimension::length, dimension::time, dimension::velocity, dimension::rate,
        dimension::force, dimension::energy, dimension::stiffness, dimension::friction,
        dimension::inverse_area}) {
    EXPECT_EQ(scene_unit(kMetal, dimension), 1.0) << to_string(dimension);
    EXPECT_EQ(scene_unit(UnitSystem::reduced, dimension), 1.0);
  }
  EXPECT_EQ(scene_unit(UnitSystem::reduced, dimension::mass), 1.0);
  EXPECT_EQ(scene_unit(UnitSystem::reduced, dimension::temperature), 1.0);
}

struct NamedUnit {
  Dimension dimension;
  std::string metal;
  std::string spelled;
  std::string in_reduced_tables;
};

TEST(MetalUnits, HaveSymbols) {
  const NamedUnit cases[] = {
      {dimension::none, "1", "1", "1"},
      {dimension::mass, "u", "mass", "mass"},
      {dimension::length, "A", "length", "length"},
      {dimension::time, "ps", "time", "time"},
      {dimension::temperature, "K", "temperature", "energy"},
      {dimension::velocity, "A/ps", "length/time", "length/time"},
      {dimension::rate, "1/ps", "1/time", "1/time"},
      {dimension::energy, "eV", "mass*length^2/time^2", "energy"},
      {dimension::force, "eV/A", "mass*length/time^2", "force"},
      {dimension::stiffness, "eV/A^2", "mass/time^2", "mass/time^2"},
      {dimension::friction, "eV*ps/A^2", "mass/time", "mass/time"},
      {{.mass = 1, .length = 2}, "u*A^2", "mass*length^2", "mass*length^2"},
      {{1, 2, -3, 0}, "eV/ps", "mass*length^2/time^3", "mass*length^2/time^3"}};
  for (const NamedUnit& one : cases) {
    EXPECT_EQ(unit_symbol(kMetal, one.dimension), one.metal);
    EXPECT_EQ(to_string(one.dimension), one.spelled);
    EXPECT_EQ(unit_in_tables(UnitSystem::reduced, one.dimension), one.in_reduced_tables);
    EXPECT_EQ(unit_in_tables(kMetal, one.spelled), one.metal);
    EXPECT_EQ(unit_in_tables(UnitSystem::reduced, one.spelled), one.spelled);
    ASSERT_TRUE(dimension_named(one.spelled)) << one.spelled;
    EXPECT_EQ(*dimension_named(one.spelled), one.dimension) << one.spelled;
  }
  EXPECT_EQ(dimension_named("force*length"), dimension::energy);
  EXPECT_EQ(dimension_named("energy/temperature"), (Dimension{1, 2, -2, -1}));
}

/// Any other unit of an observer's number is left as it is.
TEST(MetalUnits, LeaveOtherTextsAlone) {
  for (const std::string text : {"", "rad", "1/s", "length^", "length^x", "length^99999999999",
                                 "*length", "length*", "length//time", "Length", "s", "mass*rad"}) {
    EXPECT_FALSE(dimension_named(text)) << text;
    EXPECT_EQ(unit_in_tables(kMetal, text), text);
  }
}

// ---- numbers

/// What the engine has is written as a number that is read back as the same bits, and as the one
/// that was given where that has few digits.
TEST(EngineUnits, RoundTrip) {
  std::mt19937_64 random(5);
  const auto part = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const double unit : {kAtomicMassInMetal, kBoltzmannInMetal, 1.0}) {
    for (int k = 0; k < 20000; ++k) {
      const double given = std::exp(40.0 * part() - 20.0);
      const double engine = given * unit;
      EXPECT_EQ(scene_number(engine, unit) * unit, engine) << given;
    }
    for (const double given : {1.0, 12.011, 28.0855, 1e-3, 300.0, 0.1, 1e300}) {
      EXPECT_EQ(scene_number(given * unit, unit), given);
    }
  }
  EXPECT_EQ(scene_number(0.0, kBoltzmannInMetal), 0.0);
  EXPECT_TRUE(std::isnan(scene_number(std::nan(""), kBoltzmannInMetal)));
}

TEST(EngineUnits, ChangeNumbersAlone) {
  const auto twice = [](const ParameterValue& value) { return in_engine_units(value, 2.0); };
  EXPECT_EQ(twice(1.5), ParameterValue(3.0));
  EXPECT_EQ(twice(SpaceVector{{1.0, 2.0}}), ParameterValue(SpaceVector{{2.0, 4.0}}));
  EXPECT_EQ(twice(PerParticle{{1.0, 3.0}}), ParameterValue(PerParticle{{2.0, 6.0}}));
  EXPECT_EQ(twice(PerParticleVector{{SpaceVector{{1.0}}}}),
            ParameterValue(PerParticleVector{{SpaceVector{{2.0}}}}));
  EXPECT_EQ(twice(WordOrNumbers{"", {1.0}}), ParameterValue(WordOrNumbers{"", {2.0}}));
  EXPECT_EQ(twice(PointList{1, {1.0}}), ParameterValue(PointList{1, {2.0}}));
  EXPECT_EQ(twice(NumberTable{1, {1.0}}), ParameterValue(NumberTable{1, {2.0}}));
  const Passing passing{"x", 1.0, {}, 1};
  EXPECT_EQ(twice(passing), ParameterValue(passing));
  EXPECT_EQ(twice(std::int64_t{3}), ParameterValue(std::int64_t{3}));
  EXPECT_EQ(twice(std::string("word")), ParameterValue(std::string("word")));
}

// ---- scenes

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
  EXPECT_EQ(scene->units, kMetal);
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

std::string with(std::string text, const std::string& before, const std::string& after) {
  text.replace(text.find(before), before.size(), after);
  return text;
}

TEST(MetalScene, Faults) {
  struct Case {
    std::string before, after, fault, part;
  };
  const Case cases[] = {
      {"units = \"metal\"", "units = \"metall\"",
       "test.toml:2:9: scene.units = \"metall\" [scene.unknown_choice]", "u, K"},
      {"units = \"metal\"", "units = \"real\"",
       "test.toml:2:9: scene.units = \"real\" [scene.not_in_this_version]", "\"metal\""},
      {"units = \"metal\"", "units = \"metal\"\naxes = { length = \"a\" }",
       "test.toml:3:1: scene.axes [scene.conflict]", "reduced"},
      {"\"m / 3\"", "0.0", "test.toml:17:17: body.one.particle_mass = 0.0 [scene.out_of_range]",
       "> 0"},
      {"\"m / 3\"", "1e-322",
       "test.toml:17:17: body.one.particle_mass = 1e-322 [scene.out_of_range]", "engine"},
      {"[\"T\", 250]", "-1.0",
       "test.toml:30:15: force.bath.temperature = -1.0 [scene.out_of_range]", ">= 0"}};
  for (const Case& one : cases) {
    const std::string found = refusal(with(kAtoms, one.before, one.after));
    EXPECT_NE(abridged(found).find(one.fault), std::string::npos) << one.fault << "\n" << found;
    EXPECT_NE(found.find(one.part), std::string::npos) << one.part << "\n" << found;
  }
}

}  // namespace
}  // namespace tomlin::test
