#include "framework/scene/engine_units.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

// Units of scenes and those of the engine.

namespace tomlin::test {
namespace {

constexpr auto kMetal = UnitSystem::metal;

// ---- units and their names

/// CODATA 2018 by other ways: the energy equivalent of u, 931.49410242(28) MeV, and the
/// quotient R/F = 8.314462618/96485.33212 of the molar constants.
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

/// A number of the engine is written as one that is read back as the same bits, and as the one that
/// was given if that has few digits.
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

}  // namespace
}  // namespace tomlin::test
