#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/scene/scene_fixture.hpp"

/// Faults that are reported for a spoilt scene: location, key, value and code of each.
namespace tomlin::test {
namespace {

using Lines = std::vector<std::string>;

struct Spoilt {
  std::string text;
  /// All faults without wording, see brief().
  Lines faults;
};

/// The scene has these faults with each of the texts in place of `old_text`.
void expect_faults(const char* scene, const std::string& old_text, const std::vector<Spoilt>& all) {
  ASSERT_EQ(briefs_of(scene), Lines());
  for (const Spoilt& spoilt : all) {
    SCOPED_TRACE(old_text + " -> " + spoilt.text);
    EXPECT_EQ(briefs_of(replaced(scene, old_text, spoilt.text)), spoilt.faults);
  }
}

void expect_faults(const std::string& old_text, const std::vector<Spoilt>& all) {
  expect_faults(kRing, old_text, all);
}

TEST(BadScene, UnknownKeys) {
  expect_faults("[measure]", {{"[measurement]", {"29:2 measurement [scene.unknown_key]"}}});
  expect_faults(R"(name = "a ring")",
                {{R"(nam = "a ring")", {"2:1 scene.nam [scene.unknown_key] did you mean name"}}});
  expect_faults(R"(radius = "R")",
                {{"radiu = 1\nradius = \"R\"",
                  {"12:1 body.ring.radiu [scene.unknown_key] did you mean radius"}}});
  expect_faults(R"(pairs = "all")",
                {{R"("odd key" = 1)", {R"(18:1 force.bonds."odd key" [scene.unknown_key])"}}});
  expect_faults("duration = 1e4",
                {{"durations = 1e4",
                  {"25:1 run.duration [scene.missing_key]",
                   "26:1 run.durations [scene.unknown_key] did you mean duration"}}});
  expect_faults("dt = 1e-4", {{"dtt = 1e-4",
                               {"27:14 run.integrator.dt [scene.missing_key]",
                                "27:32 run.integrator.dtt [scene.unknown_key] did you mean dt"}}});
  expect_faults(R"(in = "time")",
                {{R"(unit = "time")", {"32:1 measure.unit [scene.unknown_key]"}}});
  expect_faults("every = 1.0", {{"each = 1.0", {"34:1 output.each [scene.unknown_key]"}}});
}

TEST(BadScene, Plugins) {
  expect_faults(
      "[scene]",
      {{"plugins = [\"/a/mine.so\"]\n[scene]", {"1:1 plugins [plugin.cannot_load]"}},
       {"plugins = [\"\", 3]\n[scene]",
        {R"(1:12 plugins = "" [plugin.cannot_load])", "1:16 plugins = 3 [scene.wrong_type]"}},
       {"[scene]\nplugins = [\"a.so\"]", {"2:1 scene.plugins [scene.unknown_key]"}}});
}

TEST(BadScene, OtherUnitsAreTheScenesOwn) {
  const std::string faults = faults_of(replaced("name = \"a ring\"", "units = \"SI\""));
  EXPECT_EQ(abridged(faults), "ring.toml:2:9: scene.units = \"SI\" [scene.unknown_choice]\n");
  EXPECT_NE(faults.find("\"reduced\""), std::string::npos) << faults;
  EXPECT_NE(faults.find("\"metal\""), std::string::npos) << faults;
}

/// A key of another table is refused with the name of that table.
TEST(BadScene, KeysOfOtherTables) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"every", "[output]"},
      {"from", "[measure]"},
      {"lengths", "[box]"},
      {"dt", "integrator = { type = ..., ... }"}};
  for (const auto& [key, table] : cases) {
    const std::string faults =
        faults_of(replaced("duration = 1e4", "duration = 1e4\n" + key + " = 1"));
    EXPECT_EQ(abridged(faults), "ring.toml:27:1: run." + key + " [scene.unknown_key]\n");
    EXPECT_NE(faults.find(table), std::string::npos) << faults;
  }
}

TEST(BadScene, KeysThatExcludeEachOther) {
  expect_faults("duration = 1e4",
                {{"duration = 1e4\naccuracy = 1e-6", {"27:1 run.accuracy [scene.conflict]"}}});
  expect_faults("every = 1.0",
                {{"trajectory = true", {"34:14 output.trajectory = true [scene.conflict]"}}});
}

TEST(BadScene, Types) {
  expect_faults(R"(type = "loop")",
                {{R"(type = "lop")",
                  {R"(10:8 body.ring.type = "lop" [scene.unknown_component] did you mean loop)"}}});
  expect_faults(R"(type = "bonds")", {{"type = 3", {"16:8 force[0].type = 3 [scene.wrong_type]"}}});
  expect_faults("type = \"pull\"\n", {{"", {"19:1 force.driver.type [scene.missing_key]"}}});
  expect_faults(R"(type = "euler", )", {{"", {"27:14 run.integrator.type [scene.missing_key]"}}});
  expect_faults(R"({ type = "euler", dt = 1e-4 })",
                {{R"("euler")", {R"(27:14 run.integrator = "euler" [scene.wrong_type])"}}});
}

TEST(BadScene, Until) {
  const auto faults = [](const std::string& until) {
    return briefs_of(replaced(kRing, "duration = 1e4", "duration = 1e4\nuntil = " + until));
  };
  const std::string valid = "steady = \"driver.mean_force.x\", tolerance = 1e-6";
  EXPECT_EQ(faults("{ " + valid + " }"), Lines());
  EXPECT_EQ(faults("{ " + valid + ", max = \"10 * R\" }"), Lines());
  EXPECT_EQ(faults("3"), Lines{"27:9 run.until = 3 [scene.wrong_type]"});
  EXPECT_EQ(faults("{ steady = \"x\" }"), Lines{"27:9 run.until.tolerance [scene.missing_key]"});
  EXPECT_EQ(faults("{ tolerance = 1 }"), Lines{"27:9 run.until.steady [scene.missing_key]"});
  EXPECT_EQ(faults("{ " + valid + ", maxx = 3 }"),
            Lines{"27:61 run.until.maxx [scene.unknown_key] did you mean max"});
  EXPECT_EQ(faults("{ " + valid + ", max = 0 }"),
            Lines{"27:67 run.until.max = 0 [scene.out_of_range]"});
  // The window ends with the run.
  const auto of_errors = [](const std::string& until) {
    const std::string open = replaced(kRing, "to = 10.0\n", "");
    return briefs_of(replaced(open, "duration = 1e4", "duration = 1e4\nuntil = " + until));
  };
  const std::string of_error = "error = 0.01, of = \"driver.mean_force.x\"";
  EXPECT_EQ(of_errors("{ " + of_error + " }"), Lines());
  EXPECT_EQ(of_errors("{ " + of_error + ", max = 10 }"), Lines());
  EXPECT_EQ(of_errors("{ error = 0.01 }"), Lines{"27:9 run.until.of [scene.missing_key]"});
  EXPECT_EQ(of_errors("{ of = \"x\" }"), Lines{"27:9 run.until.error [scene.missing_key]"});
  EXPECT_EQ(of_errors("{ " + of_error + ", steady = \"x\" }"),
            Lines{"27:53 run.until.steady [scene.unknown_key]"});
  EXPECT_EQ(of_errors("{ error = -1, of = \"x\" }"),
            Lines{"27:19 run.until.error = -1 [scene.out_of_range]"});
  EXPECT_EQ(faults("{ " + of_error + " }"), Lines{"32:6 measure.to = 10.0 [scene.conflict]"});
}

TEST(BadScene, WrongTypesOfValues) {
  expect_faults(
      R"(radius = "R")",
      {{"radius = true", {"12:10 body.ring.radius = true [scene.wrong_type]"}},
       {"radius = [1.0]", {"12:10 body.ring.radius = [1.0] [scene.wrong_type]"}},
       {"radius = {}", {"12:10 body.ring.radius = {} [scene.wrong_type]"}},
       {"radius = 2024-01-01", {"12:10 body.ring.radius = 2024-01-01 [scene.wrong_type]"}},
       {"radius = 1\nvelocity = 0.5", {"13:12 body.ring.velocity = 0.5 [scene.wrong_type]"}},
       {"radius = 1\nvelocity = [[1, 0], 2]", {"13:21 body.ring.velocity = 2 [scene.wrong_type]"}},
       {"radius = 1\ncoordinates = \"rigd\"",
        {R"(13:15 body.ring.coordinates = "rigd" [scene.unknown_choice] did you mean rigid)"}},
       {"radius = 1\ncoordinates = 1", {"13:15 body.ring.coordinates = 1 [scene.wrong_type]"}}});
  expect_faults(
      R"(centre = [0.0, "R"])",
      {{"centre = 3", {"14:10 body.ring.centre = 3 [scene.wrong_type]"}},
       {"centre = []", {"14:10 body.ring.centre = [] [scene.wrong_count]"}},
       {"centre = [1, [2]]", {"14:14 body.ring.centre = [2] [scene.wrong_type]"}},
       {"centre = [1, 2, 3, 4]", {"14:10 body.ring.centre = [1, 2, 3, 4] [scene.wrong_count]"}}});
  expect_faults(
      R"(particle_mass = "1 / N")",
      {{"particle_mass = []", {"13:17 body.ring.particle_mass = [] [scene.wrong_count]"}}});
  expect_faults(R"(name = "a ring")", {{"name = 1", {"2:8 scene.name = 1 [scene.wrong_type]"}}});
  expect_faults("duration = 1e4", {{"duration = 1e4\nallow_unstable = \"yes\"",
                                    {R"(27:18 run.allow_unstable = "yes" [scene.wrong_type])"}}});
  expect_faults(
      R"(pairs = "all")",
      {{R"(pairs = "neighbors")",
        {R"(18:9 force.bonds.pairs = "neighbors" [scene.unknown_choice] did you mean neighbours)"}},
       {"pairs = 3", {"18:9 force.bonds.pairs = 3 [scene.wrong_type]"}},
       {"pairs = []", {"18:9 force.bonds.pairs = [] [scene.wrong_count]"}},
       {"pairs = [[0, 1, 2]]", {"18:10 force.bonds.pairs = [0, 1, 2] [scene.wrong_count]"}},
       {"pairs = [[0, 1.5]]", {"18:14 force.bonds.pairs = 1.5 [scene.out_of_range]"}},
       {R"(rest_lengths = "inital")",
        {R"(18:16 force.bonds.rest_lengths = "inital" [scene.unknown_choice] did you mean initial)"}},
       {R"(rest_lengths = "2 * S")",
        {R"(18:21 force.bonds.rest_lengths = "2 * S" [expression.unknown_name])"}},
       {"rest_lengths = false", {"18:16 force.bonds.rest_lengths = false [scene.wrong_type]"}}});
  expect_faults(
      "velocity = [1e-3, 0.0]",
      {{"velocity = [1, 0]\nattach = \"center_of_mass\"",
        {R"(25:10 force.driver.attach = "center_of_mass" [scene.unknown_choice] did you mean centre_of_mass)"}},
       {"velocity = [1, 0]\nattach = { particel = 3 }",
        {"25:10 force.driver.attach = { particel = 3 } [scene.unknown_key]"}},
       {"velocity = [1, 0]\nattach = 3", {"25:10 force.driver.attach = 3 [scene.wrong_type]"}}});
  expect_faults("[output]\nevery = 1.0",
                {{"[[output]]\nevery = 1.0", {"33:1 output [scene.wrong_type]"}}});
  expect_faults("[[body]]", {{"[body]", {"8:1 body [scene.wrong_type]"}}});
  expect_faults("[scene]\nname = \"a ring\"",
                {{"body = 1\n", {"8:1  = [[body]] [scene.duplicate_key]"}}});
}

TEST(BadScene, MissingKeys) {
  expect_faults("radius = \"R\"\n", {{"", {"8:1 body.ring.radius [scene.missing_key]"}}});
  expect_faults("duration = 1e4\n", {{"", {"25:1 run.duration [scene.missing_key]"}}});
  expect_faults("dt = 1e-4", {{"verbose = true", {"27:14 run.integrator.dt [scene.missing_key]"}}});
  expect_faults("integrator = { type = \"euler\", dt = 1e-4 }\n",
                {{"", {"25:1 run.integrator [scene.missing_key]"}}});
  expect_faults(kRow, "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 0.1 }\n",
                {{"", {"1:1 run [scene.missing_key]"}}});
  expect_faults(kRow, "[[body]]\ntype = \"row\"\ncount = 3\nparticle_mass = 1\n",
                {{"", {"1:1 body [scene.missing_key]"}}});
}

TEST(BadScene, NumbersOutOfRange) {
  expect_faults(R"(particle_mass = "1 / N")",
                {{"particle_mass = 0", {"13:17 body.ring.particle_mass = 0 [scene.out_of_range]"}},
                 {R"(particle_mass = "-1 / N")",
                  {R"(13:17 body.ring.particle_mass = "-1 / N" [scene.out_of_range])"}},
                 {"particle_mass = [1, 1, 1, 1, -1, 1, 1, 1]",
                  {"13:30 body.ring.particle_mass = -1 [scene.out_of_range]"}}});
  expect_faults(R"(count = "N")",
                {{"count = 0", {"11:9 body.ring.count = 0 [scene.out_of_range]"}},
                 {"count = -3", {"11:9 body.ring.count = -3 [scene.out_of_range]"}},
                 {"count = 2.5", {"11:9 body.ring.count = 2.5 [scene.out_of_range]"}},
                 {R"(count = "N / 3")", {R"(11:9 body.ring.count = "N / 3" [scene.out_of_range])"}},
                 {"count = 1e300", {"11:9 body.ring.count = 1e300 [scene.out_of_range]"}},
                 {"count = inf", {"11:9 body.ring.count = inf [scene.not_finite]"}},
                 {"count = 10000001", {"11:9 body.ring.count = 10000001 [scene.too_large]"}}});
  expect_faults("dt = 1e-4", {{"dt = 0", {"27:37 run.integrator.dt = 0 [scene.out_of_range]"}},
                              {"dt = nan", {"27:37 run.integrator.dt = nan [scene.not_finite]"}},
                              {"dt = -inf", {"27:37 run.integrator.dt = -inf [scene.not_finite]"}},
                              {"dt = 101", {"27:37 run.integrator.dt = 101 [component.invalid]"}}});
  expect_faults("duration = 1e4",
                {{"duration = 0.0", {"26:12 run.duration = 0.0 [scene.out_of_range]"}},
                 {"duration = -1", {"26:12 run.duration = -1 [scene.out_of_range]"}},
                 {"duration = 1e4\nseed = -1", {"27:8 run.seed = -1 [scene.out_of_range]"}},
                 {"duration = 1e4\nseed = 0.5", {"27:8 run.seed = 0.5 [scene.out_of_range]"}}});
  expect_faults("every = 1.0", {{"every = 0", {"34:9 output.every = 0 [scene.out_of_range]"}},
                                {"every = inf", {"34:9 output.every = inf [scene.not_finite]"}}});
  expect_faults(R"(centre = [0.0, "R"])",
                {{"centre = [0.0, nan]", {"14:16 body.ring.centre = nan [scene.not_finite]"}}});
}

TEST(BadScene, ParametersAndExpressions) {
  expect_faults(
      "R = 1.0",
      {{"R = nan", {"5:5 parameters.R = nan [scene.not_finite]"}},
       {"R = inf", {"5:5 parameters.R = inf [scene.not_finite]"}},
       {R"(R = "1 / 0")", {R"(5:8 parameters.R = "1 / 0" [expression.not_finite])"}},
       {"R = \"N / (N - 8)\"", {"5:8 parameters.R = \"N / (N - 8)\" [expression.not_finite]"}},
       {R"(R = "2 *")", {R"(5:9 parameters.R = "2 *" [expression.syntax])"}},
       {R"(R = "")", {R"(5:6 parameters.R = "" [expression.syntax])"}},
       {"R = [1.0]", {"5:5 parameters.R = [1.0] [scene.wrong_type]"}},
       {R"(R = "k / 2")", {R"(5:6 parameters.R = "k / 2" [expression.cycle])"}},
       {"R = \"M\"\nMM = 1", {R"(5:6 parameters.R = "M" [expression.unknown_name])"}},
       {"R = 1.0\nsqrt = 2", {"6:1 parameters.sqrt [scene.invalid_name]"}},
       {"R = 1.0\nx = 2", {"6:1 parameters.x [scene.invalid_name]"}},
       {"R = 1.0\npi = 3", {"6:1 parameters.pi [scene.invalid_name]"}},
       {"R = 1.0\n\"a b\" = 2", {R"(6:1 parameters."a b" [scene.invalid_name])"}}});
  expect_faults(
      R"(radius = "R")",
      {{R"(radius = "R R")", {R"(12:13 body.ring.radius = "R R" [expression.syntax])"}},
       {"radius = \"sqrt(-R)\"", {"12:11 body.ring.radius = \"sqrt(-R)\" [expression.not_finite]"}},
       {R"(radius = "r")", {R"(12:11 body.ring.radius = "r" [expression.unknown_name])"}},
       {"radius = '  2 * (R'", {"12:17 body.ring.radius = '  2 * (R' [expression.syntax]"}}});
}

TEST(BadScene, Names) {
  expect_faults(kDots, R"(name = "two")",
                {{R"(name = "one")", {R"(10:8 body.one.name = "one" [scene.duplicate_name])"}}});
  expect_faults(kDots, "name = \"two\"\n", {{"", {"9:1 body.dot.name [scene.missing_key]"}}});
  expect_faults(
      R"(name = "driver")",
      {{R"(name = "ring")", {R"(20:8 force.ring.name = "ring" [scene.duplicate_name])"}},
       {R"(name = "bonds")", {R"(20:8 force.bonds.name = "bonds" [scene.duplicate_name])"}},
       {R"(name = "my.driver")",
        {R"(20:8 force."my.driver".name = "my.driver" [scene.invalid_name])"}},
       {R"(name = "")", {R"(20:8 force[1].name = "" [scene.invalid_name])"}},
       {"name = 3", {"20:8 force.pull.name = 3 [scene.wrong_type]"}},
       {R"(name = "energy")", {R"(20:8 force.energy.name = "energy" [scene.invalid_name])"}}});
  expect_faults(
      "name = \"driver\"\ntype = \"pull\"",
      {{R"(type = "bonds")",
        {"15:1 force.bonds.name [scene.missing_key]", "19:1 force.bonds.name [scene.missing_key]",
         "22:1 force.bonds.stiffness [scene.unknown_key]",
         "23:1 force.bonds.velocity [scene.unknown_key]"}}});
  expect_faults(
      "body = \"ring\"\npairs",
      {{"body = \"rign\"\npairs",
        {R"(17:8 force.bonds.body = "rign" [scene.unknown_name] did you mean ring)"}},
       {"body = [\"ring\"]\npairs", {R"(17:8 force.bonds.body = ["ring"] [scene.wrong_type])"}}});
}

TEST(BadScene, DimensionsCountsAndIndices) {
  expect_faults(
      "velocity = [1e-3, 0.0]",
      {{"velocity = [1e-3]", {"24:12 force.driver.velocity = [1e-3] [scene.wrong_count]"}},
       {"velocity = [1, 0]\nattach = { particle = 8 }",
        {"25:23 force.driver.attach.particle = 8 [scene.out_of_range]"}}});
  expect_faults(
      R"(radius = "R")",
      {{"radius = 1\nvelocity = [1, 2, 3]",
        {"13:12 body.ring.velocity = [1, 2, 3] [scene.wrong_count]"}},
       {"radius = 1\nvelocity = [[1, 2], [3, 4]]",
        {"13:12 body.ring.velocity = [[1, 2], [3, 4]] [scene.wrong_count]"}},
       {"radius = 1\nvelocity = [[1, 2], [3], [1, 2], [1, 2], [1, 2], [1, 2], [1, 2], [1, "
        "2]]",
        {"13:12 body.ring.velocity = [[1, 2], [3], [1, 2], [1, 2], [1, 2], [1, 2], [1, 2], "
         "[1, 2]... [scene.wrong_count]"}}});
  expect_faults(R"(centre = [0.0, "R"])",
                {{"centre = [0.0, 1.0, 2.0]",
                  {"14:10 body.ring.centre = [0.0, 1.0, 2.0] [component.invalid]",
                   "24:12 force.driver.velocity = [1e-3, 0.0] [scene.wrong_count]"}}});
  expect_faults(
      kDots, "position = [0.0]\n[[",
      {{"position = [0.0, 1.0]\n[[", {"13:12 body.two.position = [0.0] [scene.wrong_count]"}}});
  expect_faults(
      R"(particle_mass = "1 / N")",
      {{"particle_mass = [1, 2]", {"13:17 body.ring.particle_mass = [1, 2] [scene.wrong_count]"}}});
  expect_faults(
      R"(pairs = "all")",
      {{"charge = [1, 2, 3]", {"18:10 force.bonds.charge = [1, 2, 3] [scene.wrong_count]"}},
       {"pairs = [[0, 1], [7, 8]]",
        {"18:9 force.bonds.pairs = [[0, 1], [7, 8]] [scene.out_of_range]"}},
       {"pairs = [[-1, 1]]", {"18:9 force.bonds.pairs = [[-1, 1]] [scene.out_of_range]"}},
       {"pairs = [[3, 3]]", {"18:9 force.bonds.pairs = [[3, 3]] [component.invalid]"}},
       {"pairs = [[0, 1], [1, 0]]",
        {"18:9 force.bonds.pairs = [[0, 1], [1, 0]] [scene.duplicate_key]"}},
       {"rest_lengths = [1, 2, 3, 4, 5, 6, 7]",
        {"18:16 force.bonds.rest_lengths = [1, 2, 3, 4, 5, 6, 7] [component.invalid]"}}});
}

TEST(BadScene, Window) {
  expect_faults("to = 10.0",
                {{"to = 1.0", {"31:6 measure.to = 1.0 [run.invalid_window]"}},
                 {R"(to = "10^5")", {R"(31:6 measure.to = "10^5" [run.invalid_window])"}}});
  expect_faults("from = 1.0\nto = 10.0",
                {{"from = 1e4", {"30:8 measure.from = 1e4 [run.invalid_window]"}}});
  expect_faults("from = 1.0", {{"from = -1", {"30:8 measure.from = -1 [scene.out_of_range]"}}});
  expect_faults(
      R"(in = "time")",
      {{R"(in = "periods")",
        {R"(32:6 measure.in = "periods" [scene.unknown_choice] did you mean driver_periods)"}},
       {"in = \"time\"\ndriver = \"driver\"",
        {R"(33:10 measure.driver = "driver" [scene.conflict])"}},
       {"in = \"driver_periods\"\ndriver = \"drivr\"",
        {R"(33:10 measure.driver = "drivr" [scene.unknown_name] did you mean driver)"}},
       {"in = \"driver_periods\"\nperiod = 0", {"33:10 measure.period = 0 [scene.out_of_range]"}}});
}

TEST(BadScene, AllFaultsTogetherByPlace) {
  const std::string text = R"([parameters]
a = "b"
b = "a"
R = "1 / 0"
[run]
duration = -1
integrator = { type = "euler" }
[[force]]
type = "pull"
body = "rin"
stiffness = "a"
velocity = [1]
[[body]]
name = "ring"
type = "loop"
count = 2.5
radius = "R"
centre = [0, nan]
[surprise]
)";
  const Lines expected = {
      R"(2:6 parameters.a = "b" [expression.cycle])",
      R"(4:8 parameters.R = "1 / 0" [expression.not_finite])",
      "6:12 run.duration = -1 [scene.out_of_range]",
      "7:14 run.integrator.dt [scene.missing_key]",
      R"(10:8 force.pull.body = "rin" [scene.unknown_name] did you mean ring)",
      "13:1 body.ring.particle_mass [scene.missing_key]",
      "16:9 body.ring.count = 2.5 [scene.out_of_range]",
      "18:14 body.ring.centre = nan [scene.not_finite]",
      "19:2 surprise [scene.unknown_key]",
  };
  EXPECT_EQ(briefs_of(text), expected);
}

// One key's fault must not hide another's, nor cause faults that are none.
TEST(BadScene, SoundKeysAreStillHeldAgainstTheBodies) {
  const auto text =
      replaced(replaced("stiffness = \"k\"", "stiffness = -1"), "velocity = [1e-3, 0.0]",
               "velocity = [1e-3]\nattach = { particle = 9 }");
  EXPECT_EQ(briefs_of(text),
            (Lines{"23:13 force.driver.stiffness = -1 [scene.out_of_range]",
                   "24:12 force.driver.velocity = [1e-3] [scene.wrong_count]",
                   "25:23 force.driver.attach.particle = 9 [scene.out_of_range]"}));
}

TEST(BadScene, ParticlesOfAllBodiesAreLimitedTogether) {
  const std::string more =
      "[[body]]\nname = \"more\"\ntype = \"row\"\ncount = 9000000\n"
      "particle_mass = 1\n";
  const auto text = replaced(kRow, "count = 3", "name = \"first\"\ncount = 1000001") + more;
  EXPECT_EQ(briefs_of(replaced(text, "1000001", "1")), Lines());
  EXPECT_EQ(briefs_of(text), Lines{"12:9 body.more.count = 9000000 [scene.too_large]"});
  EXPECT_NE(faults_of(text).find("at most 10000000 particles"), std::string::npos);
}

TEST(BadScene, AnEmptyListOfBodiesIsNone) {
  const auto row = std::string(kRow);
  EXPECT_EQ(briefs_of("body = []\n" + row.substr(0, row.find("[[body]]"))),
            Lines{"1:1 body [scene.missing_key]"});
}

TEST(BadScene, ForcesOfABodyWithAnUnfitNameAreNotBlamed) {
  EXPECT_EQ(briefs_of(replaced_all(kRing, "\"ring\"", "\"drivers\"")),
            Lines{R"(9:8 body.drivers.name = "drivers" [scene.invalid_name])"});
}

TEST(BadScene, SyntaxErrorStandsAlone) {
  EXPECT_EQ(briefs_of(replaced("radius = \"R\"", "radius = \"R\nN = -1")),
            Lines{"12:12  = radius = \"R [scene.syntax]"});
  EXPECT_EQ(briefs_of("[run]\nduration = = 3\n"), Lines{"2:12  = duration = = 3 [scene.syntax]"});
  EXPECT_EQ(briefs_of("[run]\na = 1\na = 2\n"), Lines{"3:5  = a = 2 [scene.duplicate_key]"});
}

}  // namespace
}  // namespace tomlin::test
