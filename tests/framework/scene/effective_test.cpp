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

void expect_same(const TimeFunction& a, const TimeFunction& b) {
  EXPECT_EQ(a.text, b.text);
  EXPECT_EQ(a.is_constant(), b.is_constant());
  for (const double t : {0.0, 0.3, 1e6}) EXPECT_EQ(a(t), b(t)) << t;
}

void expect_same(const SceneBody& a, const SceneBody& b) {
  expect_same_description(a, b);
  EXPECT_EQ(a.hold, b.hold);
  ASSERT_EQ(a.motion.has_value(), b.motion.has_value());
  if (!a.motion) return;
  ASSERT_EQ(a.motion->velocity.size(), b.motion->velocity.size());
  for (std::size_t d = 0; d < a.motion->velocity.size(); ++d) {
    expect_same(a.motion->velocity[d], b.motion->velocity[d]);
  }
  expect_same(a.motion->angular_velocity, b.motion->angular_velocity);
}

void expect_same(const RunSettings& a, const RunSettings& b) {
  expect_same_description(a.integrator, b.integrator);
  EXPECT_EQ(a.dynamics, b.dynamics);
  EXPECT_EQ(a.duration, b.duration);
  EXPECT_EQ(a.number_type, b.number_type);
  EXPECT_EQ(a.ledger, b.ledger);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.allow_unstable, b.allow_unstable);
  ASSERT_EQ(a.perturb.has_value(), b.perturb.has_value());
  if (!a.perturb) return;
  EXPECT_EQ(a.perturb->bodies, b.perturb->bodies);
  EXPECT_EQ(a.perturb->size, b.perturb->size);
  EXPECT_EQ(a.perturb->repeats, b.perturb->repeats);
  EXPECT_EQ(a.perturb->observables, b.perturb->observables);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.parameters, b.parameters);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    expect_same(a.bodies[i], b.bodies[i]);
  }
  ASSERT_EQ(a.forces.size(), b.forces.size());
  for (std::size_t i = 0; i < a.forces.size(); ++i) {
    expect_same_description(a.forces[i], b.forces[i]);
    EXPECT_EQ(a.forces[i].bodies, b.forces[i].bodies);
  }
  expect_same(a.run, b.run);
  EXPECT_EQ(a.box.lengths, b.box.lengths);
  EXPECT_EQ(a.box.periodic, b.box.periodic);
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
start_temperature = 0.0
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
stream = 0
repeats = 1
checkpoint_every = 60.0
allow_unstable = false

[measure]
from = 1.0
to = 10.0
in = "time"

[output]
every = 1.0
trajectory = false
trajectory_format = "h5md"
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
      replaced("radius = \"R\"",
               "radius = 1\ncoordinates = \"rigid\"\nhold = [\"x\", \"rotation\"]"),
      replaced("radius = \"R\"", "radius = 1\nhold = []"),
      replaced(
          "radius = \"R\"",
          "radius = 1\ncoordinates = \"prescribed\"\nmotion = { angular_velocity = \"k * t\" }"),
      replaced("radius = \"R\"",
               "radius = 1\ncoordinates = \"prescribed\"\nmotion = { velocity = [1, \"-k\"] }"),
      replaced("[scene]", "[box]\nlengths = [\"N\", 0.1]\nperiodic = [true, false]\n[scene]"),
      replaced("duration = 1e4",
               "duration = 1e4\ndynamics = \"overdamped\"\nnumber_type = \"quadruple\"\n"
               "ledger = true\nperturb = { size = \"R / 3\" }"),
      replaced(kDots, "duration = 1\n",
               "duration = 1\nperturb = { size = 1e-12, repeats = 5, bodies = [\"two\"], "
               "observables = [\"one.velocity.x\", \"two.velocity.x\"] }\n"),
      std::string(kDots) +
          "[[force]]\ntype = \"bonds\"\nbodies = [\"two\", \"one\"]\npairs = [[0, 0]]",
      std::string(kDots) + "[[force]]\ntype = \"bonds\"\nbodies = [\"two\"]",
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
  EXPECT_EQ(text(PointList{}), "(absent)");
  EXPECT_EQ(text(PointList{1, {1.0, 2.0}}), "[1.0, 2.0]");
  EXPECT_EQ(text(PointList{2, {1.0, 2.0, 3.0, 4.0}}), "[[1.0, 2.0], [3.0, 4.0]]");
  EXPECT_EQ(text(WordList{}), "(absent)");
  EXPECT_EQ(text(WordList{{"a", "b"}}), R"(["a", "b"])");
  EXPECT_EQ(text(FlagList{}), "(absent)");
  EXPECT_EQ(text(FlagList{{true, false}}), "[true, false]");
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
