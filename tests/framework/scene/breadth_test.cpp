#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/motion.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// Boxes, held coordinates, prescribed motions, perturbed repeats and forces between two bodies.
namespace tomlin::test {
namespace {

/// What is wrong with a sound scene once `old_text` is `new_text`, without file and "error: ".
std::string spoilt(const std::string& scene, const std::string& old_text,
                   const std::string& new_text) {
  if (const std::string before = faults_of(scene); !before.empty()) return "before: " + before;
  return replaced_all(
      replaced_all(faults_of(replaced(scene, old_text, new_text)), "ring.toml:", ""),
      " error:", "");
}

// ---- motion

const std::string kSlider =
    replaced(kRing, "radius = \"R\"",
             "radius = \"R\"\ncoordinates = \"prescribed\"\n"
             "motion = { velocity = [\"k * cos(t)\", \"k / 4\"], angular_velocity = -3 }");

TEST(Motion, IsReadOverParametersAndTime) {
  const auto scene = parsed(kSlider);
  ASSERT_TRUE(scene->bodies[0].motion);
  const Motion& motion = *scene->bodies[0].motion;
  ASSERT_EQ(motion.velocity.size(), 2U);
  EXPECT_FALSE(motion.velocity[0].is_constant());
  EXPECT_EQ(motion.velocity[0](0.0), 2.0);
  EXPECT_NEAR(motion.velocity[0](1.0), 2.0 * std::cos(1.0), 1e-15);  // a rounding of each side
  EXPECT_EQ(motion.velocity[0].text, "k * cos(t)");
  EXPECT_TRUE(motion.velocity[1].is_constant());  // no t in it
  EXPECT_EQ(motion.velocity[1].constant, 0.5);
  EXPECT_EQ(motion.velocity[1](7.0), 0.5);
  EXPECT_EQ(motion.velocity[1].text, "k / 4");
  EXPECT_TRUE(motion.angular_velocity.is_constant());
  EXPECT_EQ(motion.angular_velocity(1e9), -3.0);
  EXPECT_FALSE(parsed(kRing)->bodies[0].motion);
}

TEST(Motion, OutlivesItsScene) {
  TimeFunction function = parsed(kSlider)->bodies[0].motion->velocity[0];
  EXPECT_EQ(function(0.0), 2.0);
}

TEST(Motion, HasNoValueWhereItsExpressionHasNone) {
  const auto scene = parsed(replaced(kSlider, "k * cos(t)", "sqrt(1 - t)"));
  const TimeFunction& function = scene->bodies[0].motion->velocity[0];
  EXPECT_EQ(function(1.0), 0.0);
  EXPECT_TRUE(std::isnan(function(1.5)));
  EXPECT_TRUE(std::isnan(function(NAN)));
}

TEST(Motion, IsZeroWhereNotGiven) {
  const auto motion_of = [](const std::string& text) {
    return *parsed(replaced(kSlider,
                            "velocity = [\"k * cos(t)\", \"k / 4\"], angular_velocity = -3", text))
                ->bodies[0]
                .motion;
  };
  for (const char* given : {"", "velocity = [0, 0.0]", "angular_velocity = 0"}) {
    const Motion motion = motion_of(given);
    ASSERT_EQ(motion.velocity.size(), 2U);
    for (const TimeFunction& component : motion.velocity) {
      EXPECT_TRUE(component.is_constant());
      EXPECT_EQ(component(1.0), 0.0);
    }
    EXPECT_EQ(motion.angular_velocity(1.0), 0.0);
  }
  EXPECT_EQ(motion_of("angular_velocity = \"t\"").angular_velocity(3.0), 3.0);
}

TEST(Motion, FaultsHaveTheirPlace) {
  const auto instead_of = [](const std::string& old_text, const std::string& new_text) {
    return spoilt(kSlider, old_text, new_text);
  };
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "\"k * cos(x)\""),
            "14:33: body.ring.motion.velocity = \"k * cos(x)\": 'x' is a variable; it has no value "
            "here\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "\"kk * t\""),
            "14:25: body.ring.motion.velocity = \"kk * t\": there is no parameter 'kk'\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "\"1 / t\""),
            "14:27: body.ring.motion.velocity = \"1 / t\": 1 / 0 is a division by zero\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "nan"),
            "14:24: body.ring.motion.velocity = nan: not a finite number; admissible: a number or "
            "an expression in t\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "true"),
            "14:24: body.ring.motion.velocity = true: found a boolean; admissible: a number or "
            "an expression in t\n");
  EXPECT_EQ(instead_of(", \"k / 4\"", ""),
            "14:23: body.ring.motion.velocity = [\"k * cos(t)\"]: mixed dimensions: 1 component, "
            "but the scene has 2, by its first body\n");
  EXPECT_EQ(instead_of("[\"k * cos(t)\", \"k / 4\"]", "[]"),
            "14:23: body.ring.motion.velocity = []: the list is empty; admissible: a list with a "
            "number or an expression in t per dimension\n");
  EXPECT_EQ(instead_of("\"k / 4\"", "0, 0, 0"),
            "14:23: body.ring.motion.velocity = [\"k * cos(t)\", 0, 0, 0]: space has at most three "
            "dimensions; admissible: a list with a number or an expression in t per dimension\n");
  EXPECT_EQ(instead_of("[\"k * cos(t)\", \"k / 4\"]", "1"),
            "14:23: body.ring.motion.velocity = 1: found an integer; admissible: a list with a "
            "number or an expression in t per dimension\n");
  EXPECT_EQ(instead_of("angular_velocity", "angular_veloc"),
            "14:48: body.ring.motion.angular_veloc: unknown key; admissible: velocity, "
            "angular_velocity; did you mean \"angular_velocity\"?\n");
  EXPECT_EQ(instead_of("motion = {", "motion = 3 # {"),
            "14:10: body.ring.motion = 3: found an integer; admissible: { velocity = [..], "
            "angular_velocity = .. }\n");
}

TEST(Motion, BelongsToPrescribedBodies) {
  EXPECT_EQ(spoilt(kSlider, "motion = {", "# {"),
            "8:1: body.ring.motion: missing: a prescribed body needs one; admissible: { velocity = "
            "[..], angular_velocity = .. }\n");
  EXPECT_EQ(spoilt(kSlider, "\"prescribed\"", "\"rigid\""),
            "14:1: body.ring.motion: only a prescribed body has one; admissible: coordinates = "
            "\"prescribed\"\n");
  EXPECT_EQ(spoilt(kSlider, "motion = {", "velocity = [1, 0]\nmotion = {"),
            "14:1: body.ring.velocity: a prescribed body has the velocity of its motion; "
            "admissible: motion = { velocity = [..] }\n");
}

TEST(Motion, TellsTheDimensionWhereTheShapeHasNoVectors) {
  const auto dimension = [](const std::string& motion) {
    return parsed(replaced(kRow, "count = 3",
                           "count = 3\ncoordinates = \"prescribed\"\nmotion = " + motion))
        ->dimension;
  };
  EXPECT_EQ(dimension("{ velocity = [\"t\", 0] }"), 2);
  EXPECT_EQ(dimension("{}"), 1);
}

TEST(Motion, OfAngleIsPlanar) {
  const std::string dot = replaced(kDots, "position = [0.0]",
                                   "position = [0.0]\ncoordinates = \"prescribed\"\n"
                                   "motion = { velocity = [1.0] }");
  EXPECT_EQ(
      spoilt(dot, "[1.0] }", "[1.0], angular_velocity = 0 }"),
      "10:49: body.one.motion.angular_velocity = 0: only a planar body turns by one number\n");
}

// ---- hold

std::string held(const std::string& names) {
  return replaced(kRing, "radius = \"R\"", "radius = 1\ncoordinates = \"rigid\"\nhold = " + names);
}

TEST(Hold, NamesCoordinates) {
  EXPECT_EQ(parsed(held(R"(["x", "rotation"])"))->bodies[0].hold,
            (std::vector<std::string>{"x", "rotation"}));
  EXPECT_TRUE(parsed(held("[]"))->bodies[0].hold.empty());
  EXPECT_TRUE(parsed(kRing)->bodies[0].hold.empty());
  EXPECT_EQ(parsed(replaced(kRow, "count = 3", "count = 3\nhold = [\"x\"]"))->bodies[0].hold,
            std::vector<std::string>{"x"});
}

TEST(Hold, FaultsHaveTheirPlace) {
  const auto instead = [](const std::string& names) {
    return spoilt(held("[\"y\"]"), "[\"y\"]", names);
  };
  EXPECT_EQ(instead("[\"z\"]"),
            "14:1: body.ring.hold: \"z\" is no axis of a scene of 2 dimensions\n");
  EXPECT_EQ(instead("[\"rotatoin\"]"),
            "14:9: body.ring.hold = \"rotatoin\": no such choice; admissible: a list of \"x\", "
            "\"y\", \"z\" or \"rotation\"; did you mean \"rotation\"?\n");
  EXPECT_EQ(instead("[\"y\", \"y\"]"),
            "14:14: body.ring.hold = \"y\": is given twice; admissible: a list of \"x\", \"y\", "
            "\"z\" or \"rotation\"\n");
  EXPECT_EQ(instead("\"y\""),
            "14:8: body.ring.hold = \"y\": found text; admissible: a list of \"x\", \"y\", \"z\" "
            "or \"rotation\"\n");
  EXPECT_EQ(instead("[\"y\"]\nvelocity = [1.0, 0.5]"),
            "15:1: body.ring.velocity: a held coordinate does not move: y is held; admissible: 0 "
            "along y\n");
  EXPECT_EQ(instead("[\"y\"]\nvelocity = [1.0, 0.0]"), "");
}

TEST(Hold, FitsTheCoordinates) {
  const std::string rotation = held("[\"rotation\"]");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"particles\""),
            "14:1: body.ring.hold: only a rigid body has a rotation; admissible: coordinates = "
            "\"rigid\"\n");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"fixed\""),
            "14:1: body.ring.hold: nothing of a fixed body is free; admissible: coordinates = "
            "\"particles\" or \"rigid\"\n");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"prescribed\"\nmotion = {}"),
            "15:1: body.ring.hold: nothing of a prescribed body is free; admissible: coordinates = "
            "\"particles\" or \"rigid\"\n");
}

TEST(Hold, RigidBodiesOfEveryDimensionAreLeftToTheModel) {
  EXPECT_EQ(faults_of(replaced(kRow, "count = 3", "count = 3\ncoordinates = \"rigid\"")), "");
  EXPECT_EQ(faults_of(replaced_all(kDots, "[0.0]",
                                   "[0.0, 0.0, 1.0]\ncoordinates = \"rigid\"\n"
                                   "hold = [\"z\", \"rotation\"]")),
            "");
}

// ---- box

const std::string kCircle = std::string(kRow) +
                            "[[force]]\ntype = \"bonds\"\nrest_lengths = [1, 2, 3]\n"
                            "[[force]]\ntype = \"wave\"\nperiod = 1.5\n"
                            "[box]\nlengths = [3.0]\nperiodic = [true]\n";

TEST(Box, IsRead) {
  const auto scene = parsed(kCircle);
  EXPECT_EQ(scene->box.lengths, std::vector<double>{3.0});
  EXPECT_EQ(scene->box.periodic, std::vector<bool>{true});
  EXPECT_EQ(scene->box.place.line, 14);
  EXPECT_EQ(scene->box.places.at("lengths").line, 15);
  EXPECT_TRUE(parsed(kRow)->box.lengths.empty());
}

// Three bonds join three particles on a circle, two on a line.
TEST(Box, ClosesARowAlongAPeriodicAxisOnly) {
  EXPECT_EQ(spoilt(kCircle, "[true]", "[false]"),
            "10:16: force.bonds.rest_lengths = [1, 2, 3]: not one for each bond; admissible: one "
            "number, or 2\n");
  EXPECT_EQ(faults_of(replaced(replaced(kCircle, "[true]", "[false]"), "[1, 2, 3]", "[1, 2]")), "");
}

TEST(Box, ForcesSeeItsPeriodicAxes) {
  static std::array<double, 3> seen{};
  Registry registry;
  registry.add(dot());
  registry.add(euler());
  ForceRecord record = wave();
  record.complaints = [](const void*, const SceneOutline& scene) {
    seen = scene.box;
    return std::vector<Complaint>();
  };
  registry.add(record);
  const std::string scene =
      "[[body]]\ntype = \"dot\"\nposition = [0, 0]\nparticle_mass = 1\n"
      "[[force]]\ntype = \"wave\"\nperiod = 1\n"
      "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 0.1 }\n";
  (void)parse_scene(scene, "s", registry);
  EXPECT_EQ(seen, (std::array{0.0, 0.0, 0.0}));
  (void)parse_scene(scene + "[box]\nlengths = [2, 5]\nperiodic = [true, false]\n", "s", registry);
  EXPECT_EQ(seen, (std::array{2.0, 0.0, 0.0}));
}

TEST(Box, PeriodsDivideItsLength) {
  EXPECT_EQ(
      spoilt(kCircle, "period = 1.5", "period = 2"),
      "15:11: box.lengths = [3.0]: along x the period 2 of \"wave\" does not divide the length "
      "3; admissible: 2 or 4\n");
  EXPECT_EQ(spoilt(kCircle, "period = 1.5", "period = 4.5"),
            "15:11: box.lengths = [3.0]: along x the period 4.5 of \"wave\" does not divide the "
            "length 3; admissible: 4.5\n");
  // On either side of the tolerance.
  EXPECT_EQ(faults_of(replaced(kCircle, "[3.0]", "[3.000000002]")), "");
  EXPECT_NE(faults_of(replaced(kCircle, "[3.0]", "[3.000000004]")), "");
  EXPECT_EQ(
      faults_of(replaced(replaced(kCircle, "[3.0]", "[\"14 * sqrt(2)\"]"), "1.5", "\"sqrt(2)\"")),
      "");
  // Any length will do along an axis that is not periodic.
  EXPECT_EQ(faults_of(replaced(replaced(kCircle, "[1, 2, 3]", "1"), "[3.0]\nperiodic = [true]",
                               "[3.1]\nperiodic = [false]")),
            "");
}

TEST(Box, FaultsHaveTheirPlace) {
  EXPECT_EQ(spoilt(kCircle, "[3.0]", "[3.0, 1]"),
            "15:11: box.lengths = [3.0, 1]: mixed dimensions: 2 given, but the scene has 1, by its "
            "first body\n");
  EXPECT_EQ(
      spoilt(kCircle, "[true]", "[true, true]"),
      "16:12: box.periodic = [true, true]: mixed dimensions: 2 given, but the scene has 1, by "
      "its first body\n");
  EXPECT_EQ(spoilt(kCircle, "[3.0]", "[0]"),
            "15:12: box.lengths = 0: out of range; admissible: > 0\n");
  EXPECT_EQ(spoilt(kCircle, "[true]", "[1]"),
            "16:13: box.periodic = 1: found an integer; admissible: a list with true or false per "
            "dimension\n");
  EXPECT_EQ(spoilt(kCircle, "[true]", "true"),
            "16:12: box.periodic = true: found a boolean; admissible: a list with true or false "
            "per dimension\n");
  EXPECT_EQ(spoilt(kCircle, "periodic = [true]\n", ""),
            "14:1: box.periodic: missing; admissible: a list with true or false per dimension\n");
  EXPECT_EQ(spoilt(kCircle, "periodic", "period"),
            "14:1: box.periodic: missing; admissible: a list with true or false per dimension\n"
            "16:1: box.period: unknown key; admissible: lengths, periodic; did you mean "
            "\"periodic\"?\n");
  EXPECT_EQ(spoilt(kRow, "[run]", "box = 1\n[run]"),
            "1:7: box: found an integer; admissible: a table, [box]\n");
}

// ---- perturb

std::string perturbed(const std::string& value) {
  return replaced(kDots, "duration = 1\n", "duration = 1\nperturb = " + value + "\n");
}

TEST(Perturb, IsReadWithItsDefaults) {
  EXPECT_FALSE(parsed(kDots)->run.perturb);
  const auto defaults = *parsed(perturbed("{ size = 1e-12 }"))->run.perturb;
  EXPECT_EQ(defaults.bodies, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(defaults.size, 1e-12);
  EXPECT_EQ(defaults.repeats, 3);
  EXPECT_TRUE(defaults.observables.empty());
  const auto given = *parsed(perturbed("{ bodies = [\"two\"], size = 1, repeats = 1000, "
                                       "observables = [\"driver.mean_force.x\"] }"))
                          ->run.perturb;
  EXPECT_EQ(given.bodies, std::vector<std::size_t>{1});
  EXPECT_EQ(given.repeats, 1000);
  EXPECT_EQ(given.observables, std::vector<std::string>{"driver.mean_force.x"});
  EXPECT_EQ(given.places.at("size").line, 3);
}

TEST(Perturb, FaultsHaveTheirPlace) {
  const auto instead = [](const std::string& value) {
    return spoilt(perturbed("{ size = 1 }"), "{ size = 1 }", value);
  };
  EXPECT_EQ(instead("{}"), "3:11: run.perturb.size: missing; admissible: a number > 0\n");
  EXPECT_EQ(instead("{ size = 0 }"), "3:20: run.perturb.size = 0: out of range; admissible: > 0\n");
  EXPECT_EQ(instead("{ size = 1, repeats = 0 }"),
            "3:33: run.perturb.repeats = 0: out of range; admissible: >= 1 and <= 1000\n");
  EXPECT_EQ(instead("{ size = 1, repeats = 1001 }"),
            "3:33: run.perturb.repeats = 1001: out of range; admissible: >= 1 and <= 1000\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [\"tow\"] }"),
            "3:33: run.perturb.bodies = \"tow\": there is no such body; admissible: one, two; did "
            "you mean \"two\"?\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [\"two\", \"two\"] }"),
            "3:40: run.perturb.bodies = \"two\": the body is named twice; admissible: different "
            "bodies\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [] }"),
            "3:32: run.perturb.bodies = []: the list is empty; admissible: a list of names of "
            "bodies\n");
  EXPECT_EQ(instead("{ size = 1, observables = [1] }"),
            "3:38: run.perturb.observables = 1: found an integer; admissible: a list of names\n");
  EXPECT_EQ(instead("{ size = 1, seeds = 3 }"),
            "3:23: run.perturb.seeds: unknown key; admissible: bodies, size, repeats, "
            "observables\n");
  EXPECT_EQ(instead("1e-12"),
            "3:11: run.perturb = 1e-12: found a number; admissible: { size = ..., ... }\n");
}

// ---- [run]

TEST(RunSettings, TakesEveryNumberTypeDynamicsAndTheLedger) {
  for (const char* type : {"double", "float", "quadruple"}) {
    const auto scene =
        parsed(replaced("duration = 1e4",
                        std::string("duration = 1\nnumber_type = \"") + type + "\"\nledger = true"),
               {{"measure.to", "1.0"}, {"measure.from", "0.0"}});
    EXPECT_EQ(scene->run.number_type, type);
    EXPECT_TRUE(scene->run.ledger);
  }
  EXPECT_EQ(
      parsed(replaced("duration = 1e4", "duration = 1e4\ndynamics = \"overdamped\""))->run.dynamics,
      "overdamped");
}

// ---- forces between two bodies

const std::string kPair =
    replaced(kDots,
             "name = \"two\"\ntype = \"dot\"\nparticle_mass = 1\n"
             "position = [0.0]\n",
             "name = \"two\"\ntype = \"row\"\ncount = 3\nparticle_mass = 1\n") +
    "[[force]]\ntype = \"bonds\"\nbodies = [\"one\", \"two\"]\npairs = \"all\"\n";

TEST(TwoBodies, StandInTheOrderNamed) {
  EXPECT_EQ(parsed(kPair)->forces[0].bodies, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(parsed(replaced(kPair, "\"one\", \"two\"", "\"two\", \"one\""))->forces[0].bodies,
            (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(parsed(replaced(kPair, "\"one\", \"two\"", "\"two\""))->forces[0].bodies,
            std::vector<std::size_t>{1});
}

TEST(TwoBodies, PairsJoinTheFirstToTheSecond) {
  const auto pairs = [](const std::string& value) { return spoilt(kPair, "\"all\"", value); };
  EXPECT_EQ(pairs("[[0, 0], [0, 1], [0, 2]]"), "");
  EXPECT_EQ(pairs("[[0, 0], [1, 2]]"),
            "17:9: force.bonds.pairs = [[0, 0], [1, 2]]: pair [1, 2]: indices of \"one\" are 0 to "
            "0\n");
  EXPECT_EQ(pairs("[[0, 3]]"),
            "17:9: force.bonds.pairs = [[0, 3]]: pair [0, 3]: indices of \"two\" are 0 to 2\n");
  EXPECT_EQ(pairs("[[0, -1]]"),
            "17:9: force.bonds.pairs = [[0, -1]]: pair [0, -1]: indices of \"two\" are 0 to 2\n");
  EXPECT_EQ(pairs("[[0, 2], [0, 2]]"),
            "17:9: force.bonds.pairs = [[0, 2], [0, 2]]: pair [0, 2] is given twice\n");
  EXPECT_EQ(pairs("\"neighbours\""),
            "17:9: force.bonds.pairs = \"neighbours\": particles of two bodies are no neighbours; "
            "give \"all\" or a list of index pairs\n");
}

TEST(TwoBodies, AreAsManyAsTheForceTakesAndDifferent) {
  const auto bodies = [](const std::string& value) {
    return spoilt(kPair, "bodies = [\"one\", \"two\"]", value);
  };
  EXPECT_EQ(bodies("bodies = [\"one\", \"one\"]"),
            "16:18: force.bonds.bodies = \"one\": the body is named twice; admissible: different "
            "bodies\n");
  EXPECT_EQ(bodies("bodies = [\"one\", \"tow\"]"),
            "16:18: force.bonds.bodies = \"tow\": there is no such body; admissible: one, two; did "
            "you mean \"two\"?\n");
  EXPECT_EQ(bodies("bodies = []"),
            "16:10: force.bonds.bodies = []: the list is empty; admissible: a list of names of "
            "bodies\n");
  EXPECT_EQ(bodies("bodies = \"one\""),
            "16:10: force.bonds.bodies = \"one\": found text; admissible: a list of names of "
            "bodies\n");
  EXPECT_EQ(bodies("body = \"one\"\nbodies = [\"one\", \"two\"]"),
            "17:1: force.bonds.bodies: body is given too; admissible: one of the two\n");
  EXPECT_EQ(spoilt(kPair, "type = \"bonds\"\nbodies = [\"one\", \"two\"]\npairs = \"all\"",
                   "type = \"wave\"\nperiod = 1\nbodies = [\"one\", \"two\"]"),
            "17:10: force.wave.bodies = [\"one\", \"two\"]: found 2 bodies, but wave acts on 1\n");
}

TEST(TwoBodies, AreDueWhereAForceNeedsThem) {
  Registry registry;
  registry.add(dot());
  registry.add(euler());
  ForceRecord record = bonds();
  record.fewest_bodies = 2;
  registry.add(record);
  const auto found = [&registry](const std::string& text) -> std::string {
    try {
      (void)parse_scene(text, "s", registry);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string run =
      "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 0.1 }\n"
      "[[body]]\ntype = \"dot\"\nposition = [0]\nparticle_mass = 1\n"
      "[[force]]\ntype = \"bonds\"\n";
  EXPECT_EQ(found(run), "s:8:1: error: force.bonds.body: found 1 body, but bonds acts on 2");
  EXPECT_EQ(found(run + "body = \"dot\"\n"),
            "s:10:8: error: force.bonds.body = \"dot\": found 1 body, but bonds acts on 2");
}

// ---- together

TEST(Breadth, AllFaultsTogetherByPlace) {
  const std::string scene = R"([box]
lengths = [-1]
periodic = [2]
[[body]]
name = "a"
type = "dot"
position = [0]
particle_mass = 1
hold = ["y"]
[[body]]
name = "b"
type = "dot"
position = [0]
particle_mass = 1
coordinates = "prescribed"
[[force]]
type = "bonds"
bodies = ["a", "c"]
[run]
duration = 1
integrator = { type = "euler", dt = 0.1 }
perturb = { size = -1, bodies = ["d"] }
)";
  const std::string found = faults_of(scene);
  std::size_t from = 0;
  for (const char* place :
       {":2:12: error: box.lengths", ":3:13: error: box.periodic", ":9:1: error: body.a.hold",
        ":10:1: error: body.b.motion", ":18:16: error: force.bonds.bodies",
        ":22:20: error: run.perturb.size", ":22:34: error: run.perturb.bodies"}) {
    const std::size_t at = found.find(place, from);
    EXPECT_NE(at, std::string::npos) << place << "\n" << found;
    if (at != std::string::npos) from = at;
  }
}

}  // namespace
}  // namespace tomlin::test
