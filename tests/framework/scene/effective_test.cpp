#include "framework/scene/effective.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/text.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

namespace tomlin::test {
namespace {

template <class Component>
void expect_same_description(const Component& a, const Component& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.record->name, b.record->name);
  for (const Parameter& row : a.record->parameters) {
    EXPECT_EQ(row.read(a.description.get()), row.read(b.description.get())) << row.key;
  }
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.parameters, b.parameters);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    expect_same_description(a.bodies[i], b.bodies[i]);
  }
  ASSERT_EQ(a.forces.size(), b.forces.size());
  for (std::size_t i = 0; i < a.forces.size(); ++i) {
    expect_same_description(a.forces[i], b.forces[i]);
    EXPECT_EQ(a.forces[i].bodies, b.forces[i].bodies);
  }
  expect_same_description(a.run.integrator, b.run.integrator);
  EXPECT_EQ(a.run.duration, b.run.duration);
  EXPECT_EQ(a.run.seed, b.run.seed);
  EXPECT_EQ(a.run.allow_unstable, b.run.allow_unstable);
  EXPECT_EQ(a.measure.unit, b.measure.unit);
  EXPECT_EQ(a.measure.from, b.measure.from);
  EXPECT_EQ(a.measure.to, b.measure.to);
  EXPECT_EQ(a.measure.driver, b.measure.driver);
  EXPECT_EQ(a.measure.period, b.measure.period);
  EXPECT_EQ(a.output.every, b.output.every);
}

TEST(EffectiveScene, FillsInEveryDefaultInDeclaredOrder) {
  EXPECT_EQ(parsed(kRing)->effective_toml, R"([scene]
name = "a ring"
source = ""
units = "reduced"

[parameters]
N = 8
R = 1.0
k = "2 * R"

[[body]]
name = "ring"
type = "loop"
count = "N"
radius = "R"
centre = [0.0, "R"]
particle_mass = "1 / N"
coordinates = "particles"

[[force]]
name = "bonds"
type = "bonds"
body = "ring"
pairs = "all"
rest_lengths = "initial"
charge = 1.0

[[force]]
name = "driver"
type = "pull"
body = "ring"
stiffness = "k"
velocity = [0.001, 0.0]
attach = "centre_of_mass"

[run]
integrator = { type = "euler", dt = 0.0001, verbose = false }
dynamics = "inertial"
duration = 10000.0
number_type = "double"
ledger = false
seed = 0
checkpoint_every = 60.0
allow_unstable = false

[measure]
from = 1.0
to = 10.0
in = "time"

[output]
every = 1.0
trajectory = false
)");
}

TEST(EffectiveScene, ReadsBackAsTheSameScene) {
  const std::vector<std::string> scenes = {
      kRing,
      kDots,
      kRow,
      replaced("pairs = \"all\"", "pairs = [[0, 1], [\"N - 1\", 2.0]]\nrest_lengths = [1, \"k\"]"),
      replaced("velocity = [1e-3, 0.0]", "velocity = [1, 0]\nattach = { particle = \"N - 1\" }"),
      replaced("in = \"time\"", "in = \"driver_periods\"\ndriver = \"driver\"\nperiod = 2"),
      replaced("R = 1.0",
               "R = 1e-300\nz_ = 5e-324\nbig = 1.7976931348623157e308\nminus = -0.0\n"
               "third = 0.3333333333333333\nmany = 1e22\nwhole = 1e15"),
      replaced("name = \"a ring\"", R"(name = "\"q\" \\ \t\n\u0001\u007f ä € 𝄞"
source = '''two
lines''')"),
      replaced("radius = \"R\"",
               "radius = 1\nvelocity = [[1, 2], [1, 2], [1, 2], [1, 2], "
               "[1, 2], [1, 2], [1, 2], [1, 2]]"),
      replaced("duration = 1e4",
               "duration = 1e4\nseed = 9223372036854775807\n"
               "allow_unstable = true\nledger = false"),
  };
  for (const std::string& text : scenes) {
    SCOPED_TRACE(text);
    ASSERT_EQ(faults_of(text), "");
    const auto scene = parsed(text);
    ASSERT_EQ(faults_of(scene->effective_toml), "");
    const auto again = parsed(scene->effective_toml);
    expect_same(*scene, *again);
    EXPECT_EQ(again->effective_toml, scene->effective_toml);
  }
}

TEST(EffectiveScene, NumbersAreShortAndStayNumbers) {
  const auto text = [](double x) { return value_text(Node{x, {}}); };
  EXPECT_EQ(text(1.0), "1.0");
  EXPECT_EQ(text(-0.0), "-0.0");
  EXPECT_EQ(text(0.1), "0.1");
  EXPECT_EQ(text(1e-4), "0.0001");
  EXPECT_EQ(text(1e22), "1e+22");
  EXPECT_EQ(text(5e-324), "5e-324");
  EXPECT_EQ(value_text(Node{std::int64_t{-3}, {}}), "-3");
}

TEST(EffectiveScene, DefaultsOfEveryKindHaveTheirForm) {
  const auto text = [](ParameterValue value) {
    const auto node = to_node(value);
    return node ? value_text(*node) : "(absent)";
  };
  EXPECT_EQ(text(2.0), "2.0");
  EXPECT_EQ(text(std::int64_t{2}), "2");
  EXPECT_EQ(text(true), "true");
  EXPECT_EQ(text(std::string("a \"b\"")), R"("a \"b\"")");
  EXPECT_EQ(text(SpaceVector{}), "(absent)");
  EXPECT_EQ(text(SpaceVector{{1.0, 2.0}}), "[1.0, 2.0]");
  EXPECT_EQ(text(PerParticle{}), "(absent)");
  EXPECT_EQ(text(PerParticle{{1.0}}), "1.0");
  EXPECT_EQ(text(PerParticle{{1.0, 2.0}}), "[1.0, 2.0]");
  EXPECT_EQ(text(PerParticleVector{{{{1.0}}}}), "[1.0]");
  EXPECT_EQ(text(PerParticleVector{{{{1.0}}, {{2.0}}}}), "[[1.0], [2.0]]");
  EXPECT_EQ(text(PairSelection{PairSelection::Kind::all, {}}), R"("all")");
  EXPECT_EQ(text(PairSelection{PairSelection::Kind::list, {{0, 1}}}), "[[0, 1]]");
  EXPECT_EQ(text(WordOrNumbers{"initial", {}}), R"("initial")");
  EXPECT_EQ(text(WordOrNumbers{"", {1.0}}), "1.0");
  EXPECT_EQ(text(Attachment{Attachment::Kind::particle, 3}), "{ particle = 3 }");
  EXPECT_EQ(text(Attachment{}), R"("centre_of_mass")");
}

TEST(Text, IsCutBetweenCharacters) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc...");
  EXPECT_EQ(shortened("ab\xC3\xA4", 3), "ab...");
  EXPECT_EQ(shortened("a \n\t  b  c", 20), "a b  c");
}

TEST(Text, KnowsUtf8) {
  EXPECT_EQ(valid_utf8_prefix("a\xC3\xA4\xE2\x82\xAC\xF0\x9D\x84\x9E"), 10U);
  for (const char* bad : {"\x80", "\xC0\xAF", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80", "\xF5\x80",
                          "\xF4\x90\x80\x80", "\xE2\x82"}) {
    EXPECT_EQ(valid_utf8_prefix(bad), 0U);
  }
}

}  // namespace
}  // namespace tomlin::test
