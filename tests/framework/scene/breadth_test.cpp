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

/// Returns the faults of a valid scene once `old_text` is `new_text`, without file and wording.
std::string spoilt(const std::string& scene, const std::string& old_text,
                   const std::string& new_text) {
  if (const std::string before = faults_of(scene); !before.empty()) return "before: " + before;
  return replaced_all(abridged(faults_of(replaced(scene, old_text, new_text))), "ring.toml:", "");
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
            "14:33: body.ring.motion.velocity = \"k * cos(x)\" [expression.unknown_name]\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "\"kk * t\""),
            "14:25: body.ring.motion.velocity = \"kk * t\" [expression.unknown_name]\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "\"1 / t\""),
            "14:27: body.ring.motion.velocity = \"1 / t\" [expression.not_finite]\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "nan"),
            "14:24: body.ring.motion.velocity = nan [scene.not_finite]\n");
  EXPECT_EQ(instead_of("\"k * cos(t)\"", "true"),
            "14:24: body.ring.motion.velocity = true [scene.wrong_type]\n");
  EXPECT_EQ(instead_of(", \"k / 4\"", ""),
            "14:23: body.ring.motion.velocity = [\"k * cos(t)\"] [scene.wrong_count]\n");
  EXPECT_EQ(instead_of("[\"k * cos(t)\", \"k / 4\"]", "[]"),
            "14:23: body.ring.motion.velocity = [] [scene.wrong_count]\n");
  EXPECT_EQ(instead_of("\"k / 4\"", "0, 0, 0"),
            "14:23: body.ring.motion.velocity = [\"k * cos(t)\", 0, 0, 0] [scene.wrong_count]\n");
  EXPECT_EQ(instead_of("[\"k * cos(t)\", \"k / 4\"]", "1"),
            "14:23: body.ring.motion.velocity = 1 [scene.wrong_type]\n");
  EXPECT_EQ(
      instead_of("angular_velocity", "angular_veloc"),
      "14:48: body.ring.motion.angular_veloc [scene.unknown_key] did you mean angular_velocity\n");
  EXPECT_EQ(instead_of("motion = {", "motion = 3 # {"),
            "14:10: body.ring.motion = 3 [scene.wrong_type]\n");
}

TEST(Motion, BelongsToPrescribedBodies) {
  EXPECT_EQ(spoilt(kSlider, "motion = {", "# {"),
            "8:1: body.ring.motion [body.invalid_coordinates]\n");
  EXPECT_EQ(spoilt(kSlider, "\"prescribed\"", "\"rigid\""),
            "14:1: body.ring.motion [body.invalid_coordinates]\n");
  EXPECT_EQ(spoilt(kSlider, "motion = {", "velocity = [1, 0]\nmotion = {"),
            "14:1: body.ring.velocity [body.invalid_coordinates]\n");
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
  EXPECT_EQ(spoilt(dot, "[1.0] }", "[1.0], angular_velocity = 0 }"),
            "10:49: body.one.motion.angular_velocity = 0 [body.invalid_coordinates]\n");
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
  EXPECT_EQ(instead("[\"z\"]"), "14:1: body.ring.hold [body.invalid_coordinates]\n");
  EXPECT_EQ(instead("[\"rotatoin\"]"),
            "14:9: body.ring.hold = \"rotatoin\" [scene.unknown_choice] did you mean rotation\n");
  EXPECT_EQ(instead("[\"y\", \"y\"]"), "14:14: body.ring.hold = \"y\" [scene.duplicate_key]\n");
  EXPECT_EQ(instead("\"y\""), "14:8: body.ring.hold = \"y\" [scene.wrong_type]\n");
  EXPECT_EQ(instead("[\"y\"]\nvelocity = [1.0, 0.5]"),
            "15:1: body.ring.velocity [body.invalid_coordinates]\n");
  EXPECT_EQ(instead("[\"y\"]\nvelocity = [1.0, 0.0]"), "");
}

TEST(Hold, FitsTheCoordinates) {
  const std::string rotation = held("[\"rotation\"]");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"particles\""),
            "14:1: body.ring.hold [body.invalid_coordinates]\n");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"fixed\""),
            "14:1: body.ring.hold [body.invalid_coordinates]\n");
  EXPECT_EQ(spoilt(rotation, "\"rigid\"", "\"prescribed\"\nmotion = {}"),
            "15:1: body.ring.hold [body.invalid_coordinates]\n");
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
  EXPECT_EQ(scene->box.location.line, 14);
  EXPECT_EQ(scene->box.locations.at("lengths").line, 15);
  EXPECT_TRUE(parsed(kRow)->box.lengths.empty());
}

// Three bonds join three particles on a circle, two on a line.
TEST(Box, ClosesARowAlongAPeriodicAxisOnly) {
  EXPECT_EQ(spoilt(kCircle, "[true]", "[false]"),
            "10:16: force.bonds.rest_lengths = [1, 2, 3] [component.invalid]\n");
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
  EXPECT_EQ(spoilt(kCircle, "period = 1.5", "period = 2"),
            "15:11: box.lengths = [3.0] [box.invalid]\n");
  EXPECT_EQ(spoilt(kCircle, "period = 1.5", "period = 4.5"),
            "15:11: box.lengths = [3.0] [box.invalid]\n");
  // The lengths next to it, which are positive.
  EXPECT_NE(faults_of(replaced(kCircle, "period = 1.5", "period = 2")).find("2 or 4"),
            std::string::npos);
  EXPECT_EQ(faults_of(replaced(kCircle, "period = 1.5", "period = 4.5")).find("or 4.5"),
            std::string::npos);
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
            "15:11: box.lengths = [3.0, 1] [scene.wrong_count]\n");
  EXPECT_EQ(spoilt(kCircle, "[true]", "[true, true]"),
            "16:12: box.periodic = [true, true] [scene.wrong_count]\n");
  EXPECT_EQ(spoilt(kCircle, "[3.0]", "[0]"), "15:12: box.lengths = 0 [scene.out_of_range]\n");
  EXPECT_EQ(spoilt(kCircle, "[true]", "[1]"), "16:13: box.periodic = 1 [scene.wrong_type]\n");
  EXPECT_EQ(spoilt(kCircle, "[true]", "true"), "16:12: box.periodic = true [scene.wrong_type]\n");
  EXPECT_EQ(spoilt(kCircle, "periodic = [true]\n", ""), "14:1: box.periodic [scene.missing_key]\n");
  EXPECT_EQ(spoilt(kCircle, "periodic", "period"),
            "14:1: box.periodic [scene.missing_key]\n"
            "16:1: box.period [scene.unknown_key] did you mean periodic\n");
  EXPECT_EQ(spoilt(kRow, "[run]", "box = 1\n[run]"), "1:7: box [scene.wrong_type]\n");
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
  EXPECT_EQ(given.locations.at("size").line, 3);
}

TEST(Perturb, FaultsHaveTheirPlace) {
  const auto instead = [](const std::string& value) {
    return spoilt(perturbed("{ size = 1 }"), "{ size = 1 }", value);
  };
  EXPECT_EQ(instead("{}"), "3:11: run.perturb.size [scene.missing_key]\n");
  EXPECT_EQ(instead("{ size = 0 }"), "3:20: run.perturb.size = 0 [scene.out_of_range]\n");
  EXPECT_EQ(instead("{ size = 1, repeats = 0 }"),
            "3:33: run.perturb.repeats = 0 [scene.out_of_range]\n");
  EXPECT_EQ(instead("{ size = 1, repeats = 1001 }"),
            "3:33: run.perturb.repeats = 1001 [scene.out_of_range]\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [\"tow\"] }"),
            "3:33: run.perturb.bodies = \"tow\" [scene.unknown_name] did you mean two\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [\"two\", \"two\"] }"),
            "3:40: run.perturb.bodies = \"two\" [scene.duplicate_key]\n");
  EXPECT_EQ(instead("{ size = 1, bodies = [] }"),
            "3:32: run.perturb.bodies = [] [scene.wrong_count]\n");
  EXPECT_EQ(instead("{ size = 1, observables = [1] }"),
            "3:38: run.perturb.observables = 1 [scene.wrong_type]\n");
  EXPECT_EQ(instead("{ size = 1, seeds = 3 }"), "3:23: run.perturb.seeds [scene.unknown_key]\n");
  EXPECT_EQ(instead("1e-12"), "3:11: run.perturb = 1e-12 [scene.wrong_type]\n");
}

// ---- [run]

TEST(RunSettings, TakesEveryNumberTypeDynamicsAndTheLedger) {
  for (const char* type : {"double", "quadruple"}) {
    const auto scene =
        parsed(replaced("duration = 1e4",
                        std::string("duration = 1\nnumber_type = \"") + type + "\"\nledger = true"),
               {{"measure.to", "1.0"}, {"measure.from", "0.0"}});
    EXPECT_STREQ(to_string(scene->run.number_type), type);
    EXPECT_TRUE(scene->run.ledger);
  }
  EXPECT_EQ(
      parsed(replaced("duration = 1e4", "duration = 1e4\ndynamics = \"overdamped\""))->run.dynamics,
      Dynamics::overdamped);
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
            "17:9: force.bonds.pairs = [[0, 0], [1, 2]] [scene.out_of_range]\n");
  EXPECT_EQ(pairs("[[0, 3]]"), "17:9: force.bonds.pairs = [[0, 3]] [scene.out_of_range]\n");
  // The body whose indices they are is named.
  EXPECT_NE(faults_of(replaced(kPair, "\"all\"", "[[0, 0], [1, 2]]")).find("\"one\""),
            std::string::npos);
  EXPECT_NE(faults_of(replaced(kPair, "\"all\"", "[[0, 3]]")).find("\"two\""), std::string::npos);
  EXPECT_EQ(pairs("[[0, -1]]"), "17:9: force.bonds.pairs = [[0, -1]] [scene.out_of_range]\n");
  EXPECT_EQ(pairs("[[0, 2], [0, 2]]"),
            "17:9: force.bonds.pairs = [[0, 2], [0, 2]] [scene.duplicate_key]\n");
  EXPECT_EQ(pairs("\"neighbours\""),
            "17:9: force.bonds.pairs = \"neighbours\" [component.unsuitable]\n");
}

TEST(TwoBodies, AreAsManyAsTheForceTakesAndDifferent) {
  const auto bodies = [](const std::string& value) {
    return spoilt(kPair, "bodies = [\"one\", \"two\"]", value);
  };
  EXPECT_EQ(bodies("bodies = [\"one\", \"one\"]"),
            "16:18: force.bonds.bodies = \"one\" [scene.duplicate_key]\n");
  EXPECT_EQ(bodies("bodies = [\"one\", \"tow\"]"),
            "16:18: force.bonds.bodies = \"tow\" [scene.unknown_name] did you mean two\n");
  EXPECT_EQ(bodies("bodies = []"), "16:10: force.bonds.bodies = [] [scene.wrong_count]\n");
  EXPECT_EQ(bodies("bodies = \"one\""), "16:10: force.bonds.bodies = \"one\" [scene.wrong_type]\n");
  EXPECT_EQ(bodies("body = \"one\"\nbodies = [\"one\", \"two\"]"),
            "17:1: force.bonds.bodies [scene.conflict]\n");
  EXPECT_EQ(spoilt(kPair, "type = \"bonds\"\nbodies = [\"one\", \"two\"]\npairs = \"all\"",
                   "type = \"wave\"\nperiod = 1\nbodies = [\"one\", \"two\"]"),
            "17:10: force.wave.bodies = [\"one\", \"two\"] [scene.wrong_count]\n");
}

TEST(TwoBodies, AreDueWhereAForceNeedsThem) {
  Registry registry;
  registry.add(dot());
  registry.add(euler());
  ForceRecord record = bonds();
  record.fewest_bodies = 2;
  registry.add(record);
  const auto found = [&registry](const std::string& text) {
    const auto faults = briefs_of([&] { (void)parse_scene(text, "s", registry); });
    return faults.size() == 1 ? faults[0] : "not one fault";
  };
  const std::string run =
      "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 0.1 }\n"
      "[[body]]\ntype = \"dot\"\nposition = [0]\nparticle_mass = 1\n"
      "[[force]]\ntype = \"bonds\"\n";
  EXPECT_EQ(found(run), "8:1 force.bonds.body [scene.wrong_count]");
  EXPECT_EQ(found(run + "body = \"dot\"\n"), "10:8 force.bonds.body = \"dot\" [scene.wrong_count]");
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
  const std::vector<std::string> expected = {
      "2:12 box.lengths = -1 [scene.out_of_range]",
      "3:13 box.periodic = 2 [scene.wrong_type]",
      "9:1 body.a.hold [body.invalid_coordinates]",
      "10:1 body.b.motion [body.invalid_coordinates]",
      "18:16 force.bonds.bodies = \"c\" [scene.unknown_name]",
      "22:20 run.perturb.size = -1 [scene.out_of_range]",
      "22:34 run.perturb.bodies = \"d\" [scene.unknown_name]"};
  EXPECT_EQ(briefs_of(scene), expected);
}

}  // namespace
}  // namespace tomlin::test
