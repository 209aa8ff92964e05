#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/scene/scene_fixture.hpp"

/// What a spoilt scene is told, to the letter.
namespace tomlin::test {
namespace {

struct Spoilt {
  const char* scene;
  std::string old_text;
  std::string new_text;
  /// All error lines without "ring.toml:" and "error: "; after "..." anything goes, where the
  /// wording is that of expressions.
  std::vector<std::string> faults;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bool matches(const std::string& line, std::string expected) {
  expected = "ring.toml:" + replaced(expected, ": ", ": error: ");
  if (!expected.ends_with("...")) return line == expected;
  return line.starts_with(expected.substr(0, expected.size() - 3));
}

void expect_faults(const std::vector<Spoilt>& scenes) {
  for (const Spoilt& spoilt : scenes) {
    SCOPED_TRACE(spoilt.old_text + " -> " + spoilt.new_text);
    ASSERT_EQ(faults_of(spoilt.scene), "");
    const auto lines =
        lines_of(faults_of(replaced(spoilt.scene, spoilt.old_text, spoilt.new_text)));
    ASSERT_EQ(lines.size(), spoilt.faults.size()) << testing::PrintToString(lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_TRUE(matches(lines[i], spoilt.faults[i]))
          << "found    " << lines[i] << "\nexpected " << spoilt.faults[i];
    }
  }
}

TEST(BadScene, UnknownKeys) {
  expect_faults({
      {kRing,
       "[measure]",
       "[measurement]",
       {"29:2: measurement: unknown key; admissible: plugins, scene, parameters, box, body, force, "
        "observer, run, "
        "measure, "
        "output"}},
      {kRing,
       R"(name = "a ring")",
       R"(nam = "a ring")",
       {R"(2:1: scene.nam: unknown key; admissible: name, source, units; did you mean "name"?)"}},
      {kRing,
       R"(radius = "R")",
       "radiu = 1\nradius = \"R\"",
       {R"(12:1: body.ring.radiu: unknown key; admissible: name, type, hold, motion, count, radius, centre, particle_mass, velocity, coordinates; did you mean "radius"?)"}},
      {kRing,
       R"(pairs = "all")",
       R"("odd key" = 1)",
       {R"(18:1: force.bonds."odd key": unknown key; admissible: name, type, body, bodies, pairs, rest_lengths, charge)"}},
      {kRing,
       "duration = 1e4",
       "durations = 1e4",
       {"25:1: run.duration: missing; admissible: a number > 0",
        R"(26:1: run.durations: unknown key; admissible: integrator, perturb, until, dynamics, duration, number_type, ledger, seed, checkpoint_every, allow_unstable, accuracy; did you mean "duration"?)"}},
      {kRing,
       "dt = 1e-4",
       "dtt = 1e-4",
       {"27:14: run.integrator.dt: missing; admissible: a number > 0",
        R"(27:32: run.integrator.dtt: unknown key; admissible: type, dt, verbose; did you mean "dt"?)"}},
      {kRing,
       R"(in = "time")",
       R"(unit = "time")",
       {"32:1: measure.unit: unknown key; admissible: from, to, in, driver, period, "
        "observables"}},
      {kRing,
       "every = 1.0",
       "each = 1.0",
       {"34:1: output.each: unknown key; admissible: every, trajectory, trajectory_format"}},
  });
}

TEST(BadScene, Plugins) {
  expect_faults({
      {kRing,
       "[scene]",
       "plugins = [\"/a/mine.so\"]\n[scene]",
       {"1:1: plugins: /a/mine.so has not been loaded; admissible: a program that loads plugins "
        "before it reads the scene"}},
      {kRing,
       "[scene]",
       "plugins = [\"\", 3]\n[scene]",
       {"1:12: plugins = \"\": not the name of a file; admissible: a list of shared libraries, "
        "[\"libmorse.so\"]",
        "1:16: plugins = 3: found an integer; admissible: a list of shared libraries, "
        "[\"libmorse.so\"]"}},
      {kRing,
       "[scene]",
       "[scene]\nplugins = [\"a.so\"]",
       {"2:1: scene.plugins: unknown key; admissible: plugins stands above the first [table]"}},
  });
}

TEST(BadScene, NotInThisVersion) {
  expect_faults({
      {kRing,
       R"(name = "a ring")",
       R"(units = "metal")",
       {R"(2:9: scene.units = "metal": not in this version; admissible: "reduced")"}},
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1e-3, 0.0]\nreverse = { above = 1 }",
       {"25:1: force.driver.reverse: not in this version (a turn of the pull)"}},
      {kDots,
       "position = [0.0]",
       "position = [0.0]\nfile = \"x\"",
       {"9:1: body.one.file: not in this version (positions from a file)"}},
      {kRing,
       "duration = 1e4",
       "duration = 1e4\naccuracy = 1e-6",
       {"27:1: run.accuracy: stands in place of an integrator, and there is one; admissible: one "
        "of the two"}},
      {kRing,
       "every = 1.0",
       "trajectory = true",
       {"34:14: output.trajectory = true: positions come with samples, and there are none; "
        "admissible: with every, the sampling interval"}},
      {kRing,
       R"(pairs = "all")",
       R"(rest_lengths = "relaxed")",
       {R"(18:16: force.bonds.rest_lengths = "relaxed": not in this version; admissible: "initial", a number > 0 or a list of such)"}},
  });
}

TEST(BadScene, Types) {
  expect_faults({
      {kRing,
       R"(type = "loop")",
       R"(type = "lop")",
       {R"(10:8: body.ring.type = "lop": there is no such body; admissible: "dot", "loop", "row"; did you mean "loop"?)"}},
      {kRing,
       R"(type = "bonds")",
       "type = 3",
       {R"(16:8: force[0].type = 3: found an integer; admissible: "pull", "bonds", "wave")"}},
      {kRing,
       "type = \"pull\"\n",
       "",
       {R"(19:1: force.driver.type: missing; admissible: "pull", "bonds", "wave")"}},
      {kRing,
       R"(type = "euler", )",
       "",
       {R"(27:14: run.integrator.type: missing; admissible: "euler")"}},
      {kRing,
       R"({ type = "euler", dt = 1e-4 })",
       R"("euler")",
       {R"(27:14: run.integrator = "euler": found text; admissible: { type = ..., ... })"}},
  });
}

TEST(BadScene, Until) {
  const auto faults = [](const std::string& until) {
    return faults_of(replaced(kRing, "duration = 1e4", "duration = 1e4\nuntil = " + until));
  };
  const std::string sound = "steady = \"driver.mean_force.x\", tolerance = 1e-6";
  EXPECT_EQ(faults("{ " + sound + " }"), "");
  EXPECT_EQ(faults("{ " + sound + ", max = \"10 * R\" }"), "");
  EXPECT_NE(faults("3").find("run.until = 3: found an integer"), std::string::npos);
  EXPECT_NE(faults("{ steady = \"x\" }").find("run.until.tolerance: missing"), std::string::npos);
  EXPECT_NE(faults("{ tolerance = 1 }").find("run.until.steady: missing"), std::string::npos);
  EXPECT_NE(faults("{ " + sound + ", maxx = 3 }").find("did you mean \"max\""), std::string::npos);
  EXPECT_NE(faults("{ " + sound + ", max = 0 }").find("run.until.max"), std::string::npos);
}

TEST(BadScene, WrongTypesOfValues) {
  expect_faults({
      {kRing,
       R"(radius = "R")",
       "radius = true",
       {"12:10: body.ring.radius = true: found a boolean; admissible: a number > 0"}},
      {kRing,
       R"(radius = "R")",
       "radius = [1.0]",
       {"12:10: body.ring.radius = [1.0]: found a list; admissible: a number > 0"}},
      {kRing,
       R"(radius = "R")",
       "radius = {}",
       {"12:10: body.ring.radius = {}: found a table; admissible: a number > 0"}},
      {kRing,
       R"(radius = "R")",
       "radius = 2024-01-01",
       {"12:10: body.ring.radius = 2024-01-01: found a date or time; admissible: a number > 0"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = 3",
       {"14:10: body.ring.centre = 3: found an integer; admissible: a list with a number per "
        "dimension"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = []",
       {"14:10: body.ring.centre = []: the list is empty; admissible: a list with a number per "
        "dimension"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = [1, [2]]",
       {"14:14: body.ring.centre = [2]: found a list; admissible: a list with a number per "
        "dimension"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = [1, 2, 3, 4]",
       {"14:10: body.ring.centre = [1, 2, 3, 4]: 4 components, but space has at most 3 dimensions; "
        "admissible: a list with a number per dimension"}},
      {kRing,
       R"(particle_mass = "1 / N")",
       "particle_mass = []",
       {"13:17: body.ring.particle_mass = []: the list is empty; admissible: a number > 0, or a "
        "list of one per particle"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\nvelocity = 0.5",
       {"13:12: body.ring.velocity = 0.5: found a number; admissible: a list with a number per "
        "dimension, or a list of such lists"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\nvelocity = [[1, 0], 2]",
       {"13:21: body.ring.velocity = 2: found an integer; admissible: a list with a number per "
        "dimension, or a list of such lists"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\ncoordinates = \"rigd\"",
       {R"(13:15: body.ring.coordinates = "rigd": no such choice; admissible: "particles", "rigid", "fixed" or "prescribed"; did you mean "rigid"?)"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\ncoordinates = 1",
       {R"(13:15: body.ring.coordinates = 1: found an integer; admissible: "particles", "rigid", "fixed" or "prescribed")"}},
      {kRing,
       R"(name = "a ring")",
       "name = 1",
       {"2:8: scene.name = 1: found an integer; admissible: text"}},
      {kRing,
       "duration = 1e4",
       "duration = 1e4\nallow_unstable = \"yes\"",
       {R"(27:18: run.allow_unstable = "yes": found text; admissible: true or false)"}},
      {kRing,
       R"(pairs = "all")",
       R"(pairs = "neighbors")",
       {R"(18:9: force.bonds.pairs = "neighbors": no such choice; admissible: "all", "neighbours" or a list of index pairs; did you mean "neighbours"?)"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = 3",
       {R"(18:9: force.bonds.pairs = 3: found an integer; admissible: "all", "neighbours" or a list of index pairs)"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = []",
       {R"(18:9: force.bonds.pairs = []: the list is empty; admissible: "all", "neighbours" or a list of index pairs)"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[0, 1, 2]]",
       {R"(18:10: force.bonds.pairs = [0, 1, 2]: not a pair of indices; admissible: "all", "neighbours" or a list of index pairs)"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[0, 1.5]]",
       {R"(18:14: force.bonds.pairs = 1.5: an integer key needs an integral value; admissible: "all", "neighbours" or a list of index pairs)"}},
      {kRing,
       R"(pairs = "all")",
       R"(rest_lengths = "inital")",
       {R"(18:16: force.bonds.rest_lengths = "inital": no such choice; admissible: "initial", a number > 0 or a list of such; did you mean "initial"?)"}},
      {kRing,
       R"(pairs = "all")",
       R"(rest_lengths = "2 * S")",
       {R"(18:21: force.bonds.rest_lengths = "2 * S": ...)"}},
      {kRing,
       R"(pairs = "all")",
       "rest_lengths = false",
       {R"(18:16: force.bonds.rest_lengths = false: found a boolean; admissible: "initial", a number > 0 or a list of such)"}},
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1, 0]\nattach = \"center_of_mass\"",
       {R"(25:10: force.driver.attach = "center_of_mass": no such choice; admissible: "centre_of_mass", "each_particle" or { particle = INDEX }; did you mean "centre_of_mass"?)"}},
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1, 0]\nattach = { particel = 3 }",
       {R"(25:10: force.driver.attach = { particel = 3 }: a table here has the key particle and no other; admissible: "centre_of_mass", "each_particle" or { particle = INDEX })"}},
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1, 0]\nattach = 3",
       {R"(25:10: force.driver.attach = 3: found an integer; admissible: "centre_of_mass", "each_particle" or { particle = INDEX })"}},
      {kRing,
       "[output]\nevery = 1.0",
       "[[output]]\nevery = 1.0",
       {"33:1: output: found a list; admissible: a table, [output]"}},
      {kRing,
       "[[body]]",
       "[body]",
       {"8:1: body: found a table; admissible: a list of tables, [[body]]"}},
      {kRing,
       "[scene]\nname = \"a ring\"",
       "body = 1\n",
       {"8:1: body: [[body]] begins one of several, but body stands for itself, in line 1 too; "
        "admissible: [[body]] in all of these lines"}},
  });
}

TEST(BadScene, MissingKeys) {
  expect_faults({
      {kRing, "radius = \"R\"\n", "", {"8:1: body.ring.radius: missing; admissible: a number > 0"}},
      {kRing, "duration = 1e4\n", "", {"25:1: run.duration: missing; admissible: a number > 0"}},
      {kRing,
       "dt = 1e-4",
       "verbose = true",
       {"27:14: run.integrator.dt: missing; admissible: a number > 0"}},
      {kRing,
       "integrator = { type = \"euler\", dt = 1e-4 }\n",
       "",
       {"25:1: run.integrator: missing; admissible: { type = ..., ... }, or accuracy"}},
      {kRow,
       "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 0.1 }\n",
       "",
       {"1:1: run: missing: a scene needs [run]; admissible: a table with duration and "
        "integrator"}},
      {kRow,
       "[[body]]\ntype = \"row\"\ncount = 3\nparticle_mass = 1\n",
       "",
       {"1:1: body: missing: a scene needs at least one [[body]]"}},
  });
}

TEST(BadScene, NumbersOutOfRange) {
  expect_faults({
      {kRing,
       R"(particle_mass = "1 / N")",
       "particle_mass = 0",
       {"13:17: body.ring.particle_mass = 0: out of range; admissible: > 0"}},
      {kRing,
       R"(particle_mass = "1 / N")",
       R"(particle_mass = "-1 / N")",
       {R"(13:17: body.ring.particle_mass = "-1 / N": is -0.125, out of range; admissible: > 0)"}},
      {kRing,
       R"(particle_mass = "1 / N")",
       "particle_mass = [1, 1, 1, 1, -1, 1, 1, 1]",
       {"13:30: body.ring.particle_mass = -1: out of range; admissible: > 0"}},
      {kRing,
       R"(count = "N")",
       "count = 0",
       {"11:9: body.ring.count = 0: out of range; admissible: >= 2"}},
      {kRing,
       R"(count = "N")",
       "count = -3",
       {"11:9: body.ring.count = -3: out of range; admissible: >= 2"}},
      {kRing,
       R"(count = "N")",
       "count = 2.5",
       {"11:9: body.ring.count = 2.5: an integer key needs an integral value; admissible: an "
        "integer >= 2"}},
      {kRing,
       R"(count = "N")",
       R"(count = "N / 3")",
       {R"(11:9: body.ring.count = "N / 3": is 2.6666666666666665; an integer key needs an integral value; admissible: an integer >= 2)"}},
      {kRing,
       R"(count = "N")",
       "count = 1e300",
       {"11:9: body.ring.count = 1e300: too large for an integer; admissible: an integer >= 2"}},
      {kRing,
       R"(count = "N")",
       "count = inf",
       {"11:9: body.ring.count = inf: not a finite number; admissible: an integer >= 2"}},
      {kRing,
       R"(count = "N")",
       "count = 10000001",
       {"11:9: body.ring.count = 10000001: 10000001 particles would take about 5.8 GB; admissible: "
        "at most 10000000 particles in a scene"}},
      {kRing,
       "dt = 1e-4",
       "dt = 0",
       {"27:37: run.integrator.dt = 0: out of range; admissible: > 0"}},
      {kRing,
       "dt = 1e-4",
       "dt = nan",
       {"27:37: run.integrator.dt = nan: not a finite number; admissible: > 0"}},
      {kRing,
       "dt = 1e-4",
       "dt = -inf",
       {"27:37: run.integrator.dt = -inf: not a finite number; admissible: > 0"}},
      {kRing,
       "dt = 1e-4",
       "dt = 101",
       {"27:37: run.integrator.dt = 101: a step for the patient; admissible: <= 100"}},
      {kRing,
       "duration = 1e4",
       "duration = 0.0",
       {"26:12: run.duration = 0.0: out of range; admissible: > 0"}},
      {kRing,
       "duration = 1e4",
       "duration = -1",
       {"26:12: run.duration = -1: out of range; admissible: > 0"}},
      {kRing,
       "duration = 1e4",
       "duration = 1e4\nseed = -1",
       {"27:8: run.seed = -1: out of range; admissible: >= 0"}},
      {kRing,
       "duration = 1e4",
       "duration = 1e4\nseed = 0.5",
       {"27:8: run.seed = 0.5: an integer key needs an integral value; admissible: an integer >= "
        "0"}},
      {kRing,
       "every = 1.0",
       "every = 0",
       {"34:9: output.every = 0: out of range; admissible: > 0"}},
      {kRing,
       "every = 1.0",
       "every = inf",
       {"34:9: output.every = inf: not a finite number; admissible: > 0"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = [0.0, nan]",
       {"14:16: body.ring.centre = nan: not a finite number; admissible: any finite number"}},
  });
}

TEST(BadScene, ParametersAndExpressions) {
  expect_faults({
      {kRing, "R = 1.0", "R = nan", {"5:5: parameters.R = nan: ..."}},
      {kRing, "R = 1.0", "R = inf", {"5:5: parameters.R = inf: ..."}},
      {kRing, "R = 1.0", R"(R = "1 / 0")", {R"(5:8: parameters.R = "1 / 0": ...)"}},
      {kRing, "R = 1.0", "R = \"N / (N - 8)\"", {"5:8: parameters.R = \"N / (N - 8)\": ..."}},
      {kRing, "R = 1.0", R"(R = "2 *")", {R"(5:9: parameters.R = "2 *": ...)"}},
      {kRing, "R = 1.0", R"(R = "")", {R"(5:6: parameters.R = "": ...)"}},
      {kRing,
       "R = 1.0",
       "R = [1.0]",
       {"5:5: parameters.R = [1.0]: found a list; admissible: a number or an expression"}},
      {kRing, "R = 1.0", R"(R = "k / 2")", {R"(5:6: parameters.R = "k / 2": ...)"}},
      {kRing, "R = 1.0", "R = \"M\"\nMM = 1", {R"(5:6: parameters.R = "M": ...)"}},
      {kRing, "R = 1.0", "R = 1.0\nsqrt = 2", {"6:1: parameters.sqrt: ..."}},
      {kRing, "R = 1.0", "R = 1.0\nx = 2", {"6:1: parameters.x: ..."}},
      {kRing, "R = 1.0", "R = 1.0\npi = 3", {"6:1: parameters.pi: ..."}},
      {kRing, "R = 1.0", "R = 1.0\n\"a b\" = 2", {R"(6:1: parameters."a b": ...)"}},
      {kRing, R"(radius = "R")", R"(radius = "R R")", {R"(12:13: body.ring.radius = "R R": ...)"}},
      {kRing,
       R"(radius = "R")",
       "radius = \"sqrt(-R)\"",
       {"12:11: body.ring.radius = \"sqrt(-R)\": ..."}},
      {kRing, R"(radius = "R")", R"(radius = "r")", {R"(12:11: body.ring.radius = "r": ...)"}},
      {kRing,
       R"(radius = "R")",
       "radius = '  2 * (R'",
       {"12:17: body.ring.radius = '  2 * (R': ..."}},
  });
}

TEST(BadScene, Names) {
  expect_faults({
      {kDots,
       R"(name = "two")",
       R"(name = "one")",
       {R"(10:8: body.one.name = "one": the name "one" is taken by body.one in line 4)"}},
      {kDots, "name = \"two\"\n", "", {R"(9:1: body.dot.name: missing: 2 share the type "dot")"}},
      {kRing,
       R"(name = "driver")",
       R"(name = "ring")",
       {R"(20:8: force.ring.name = "ring": the name "ring" is taken by body.ring in line 8)"}},
      {kRing,
       R"(name = "driver")",
       R"(name = "bonds")",
       {R"(20:8: force.bonds.name = "bonds": the name "bonds" is taken by force.bonds in line 15)"}},
      {kRing,
       R"(name = "driver")",
       R"(name = "my.driver")",
       {R"(20:8: force."my.driver".name = "my.driver": not a name; admissible: letters, digits, _ and -, the first a letter or _)"}},
      {kRing,
       R"(name = "driver")",
       R"(name = "")",
       {R"(20:8: force[1].name = "": not a name; admissible: letters, digits, _ and -, the first a letter or _)"}},
      {kRing,
       R"(name = "driver")",
       "name = 3",
       {"20:8: force.pull.name = 3: found an integer; admissible: text"}},
      {kRing,
       R"(name = "driver")",
       R"(name = "energy")",
       {R"(20:8: force.energy.name = "energy": a word of the summary; choose another name)"}},
      {kRing,
       "name = \"driver\"\ntype = \"pull\"",
       R"(type = "bonds")",
       {R"(15:1: force.bonds.name: missing: 2 share the type "bonds")",
        R"(19:1: force.bonds.name: missing: 2 share the type "bonds")",
        "22:1: force.bonds.stiffness: unknown key; admissible: name, type, body, bodies, pairs, "
        "rest_lengths, charge",
        "23:1: force.bonds.velocity: unknown key; admissible: name, type, body, bodies, pairs, "
        "rest_lengths, charge"}},
      {kRing,
       "body = \"ring\"\npairs",
       "body = \"rign\"\npairs",
       {R"(17:8: force.bonds.body = "rign": there is no such body; admissible: ring; did you mean "ring"?)"}},
      {kRing,
       "body = \"ring\"\npairs",
       "body = [\"ring\"]\npairs",
       {R"(17:8: force.bonds.body = ["ring"]: found a list; admissible: the name of a body)"}},
  });
}

TEST(BadScene, DimensionsCountsAndIndices) {
  expect_faults({
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1e-3]",
       {"24:12: force.driver.velocity = [1e-3]: mixed dimensions: 1 component, but the scene has "
        "2, by its first body"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\nvelocity = [1, 2, 3]",
       {"13:12: body.ring.velocity = [1, 2, 3]: mixed dimensions: 3 components, but the scene has "
        "2, by its first body"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\nvelocity = [[1, 2], [3, 4]]",
       {"13:12: body.ring.velocity = [[1, 2], [3, 4]]: 2 entries, but the body has 8 particles"}},
      {kRing,
       R"(radius = "R")",
       "radius = 1\nvelocity = [[1, 2], [3], [1, 2], [1, 2], [1, 2], [1, 2], [1, 2], [1, 2]]",
       {"13:12: body.ring.velocity = [[1, 2], [3], [1, 2], [1, 2], [1, 2], [1, 2], [1, 2], [1, "
        "2]...: mixed dimensions: vector 1 has 1 component, but the scene has 2, by its first "
        "body"}},
      {kRing,
       R"(centre = [0.0, "R"])",
       "centre = [0.0, 1.0, 2.0]",
       {"14:10: body.ring.centre = [0.0, 1.0, 2.0]: a loop is planar; admissible: 2 components",
        "24:12: force.driver.velocity = [1e-3, 0.0]: mixed dimensions: 2 components, but the scene "
        "has 3, by its first body"}},
      {kDots,
       "position = [0.0]\n[[",
       "position = [0.0, 1.0]\n[[",
       {"13:12: body.two.position = [0.0]: mixed dimensions: 1 component, but the scene has 2, by "
        "its first body"}},
      {kRing,
       R"(particle_mass = "1 / N")",
       "particle_mass = [1, 2]",
       {"13:17: body.ring.particle_mass = [1, 2]: 2 entries, but the body has 8 particles"}},
      {kRing,
       R"(pairs = "all")",
       "charge = [1, 2, 3]",
       {"18:10: force.bonds.charge = [1, 2, 3]: 3 entries, but the body has 8 particles"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[0, 1], [7, 8]]",
       {"18:9: force.bonds.pairs = [[0, 1], [7, 8]]: pair [7, 8]: indices are 0 to 7"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[-1, 1]]",
       {"18:9: force.bonds.pairs = [[-1, 1]]: pair [-1, 1]: indices are 0 to 7"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[3, 3]]",
       {"18:9: force.bonds.pairs = [[3, 3]]: pair [3, 3]: a particle and itself"}},
      {kRing,
       R"(pairs = "all")",
       "pairs = [[0, 1], [1, 0]]",
       {"18:9: force.bonds.pairs = [[0, 1], [1, 0]]: pair [1, 0] is given twice"}},
      {kRing,
       R"(pairs = "all")",
       "rest_lengths = [1, 2, 3, 4, 5, 6, 7]",
       {"18:16: force.bonds.rest_lengths = [1, 2, 3, 4, 5, 6, 7]: not one for each bond; "
        "admissible: one number, or 8"}},
      {kRing,
       "velocity = [1e-3, 0.0]",
       "velocity = [1, 0]\nattach = { particle = 8 }",
       {"25:23: force.driver.attach.particle = 8: there is no particle 8: indices are 0 to 7"}},
  });
}

TEST(BadScene, Window) {
  expect_faults({
      {kRing,
       "to = 10.0",
       "to = 1.0",
       {"31:6: measure.to = 1.0: the window ends before it begins; admissible: > 1, the value of "
        "from"}},
      {kRing,
       "to = 10.0",
       R"(to = "10^5")",
       {R"(31:6: measure.to = "10^5": past the end of the run; admissible: <= 10000, the run's duration)"}},
      {kRing,
       "from = 1.0\nto = 10.0",
       "from = 1e4",
       {"30:8: measure.from = 1e4: past the end of the run; admissible: < 10000, the run's "
        "duration"}},
      {kRing,
       "from = 1.0",
       "from = -1",
       {"30:8: measure.from = -1: out of range; admissible: >= 0"}},
      {kRing,
       R"(in = "time")",
       R"(in = "periods")",
       {R"(32:6: measure.in = "periods": no such choice; admissible: "time" or "driver_periods"; did you mean "driver_periods"?)"}},
      {kRing,
       R"(in = "time")",
       "in = \"time\"\ndriver = \"driver\"",
       {R"(33:10: measure.driver = "driver": only counts where in = "driver_periods")"}},
      {kRing,
       R"(in = "time")",
       "in = \"driver_periods\"\ndriver = \"drivr\"",
       {R"(33:10: measure.driver = "drivr": there is no such force; admissible: bonds, driver; did you mean "driver"?)"}},
      {kRing,
       R"(in = "time")",
       "in = \"driver_periods\"\nperiod = 0",
       {"33:10: measure.period = 0: out of range; admissible: > 0"}},
  });
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
  const std::vector<std::string> expected = {
      R"(2:6: parameters.a = "b": ...)",
      R"(4:8: parameters.R = "1 / 0": ...)",
      "6:12: run.duration = -1: out of range; admissible: > 0",
      "7:14: run.integrator.dt: missing; admissible: a number > 0",
      R"(10:8: force.pull.body = "rin": there is no such body; admissible: ring; )"
      R"(did you mean "ring"?)",
      "13:1: body.ring.particle_mass: missing; admissible: a number > 0, or a list of one "
      "per "
      "particle",
      "16:9: body.ring.count = 2.5: an integer key needs an integral value; admissible: an "
      "integer "
      ">= 2",
      "18:14: body.ring.centre = nan: not a finite number; admissible: any finite number",
      "19:2: surprise: unknown key; admissible: plugins, scene, parameters, box, body, force, "
      "observer, run, "
      "measure, "
      "output",
  };
  const auto lines = lines_of(faults_of(text));
  ASSERT_EQ(lines.size(), expected.size()) << testing::PrintToString(lines);
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_TRUE(matches(lines[i], expected[i])) << lines[i];
}

// One key's fault must not hide another's, nor cause faults that are none.
TEST(BadScene, SoundKeysAreStillHeldAgainstTheBodies) {
  const auto text =
      replaced(replaced("stiffness = \"k\"", "stiffness = -1"), "velocity = [1e-3, 0.0]",
               "velocity = [1e-3]\nattach = { particle = 9 }");
  const auto lines = lines_of(faults_of(text));
  ASSERT_EQ(lines.size(), 3U) << testing::PrintToString(lines);
  EXPECT_TRUE(lines[0].starts_with("ring.toml:23:13: error: force.driver.stiffness"));
  EXPECT_TRUE(lines[1].starts_with("ring.toml:24:12: error: force.driver.velocity"));
  EXPECT_TRUE(lines[2].starts_with("ring.toml:25:23: error: force.driver.attach.particle"));
}

TEST(BadScene, ParticlesOfAllBodiesAreLimitedTogether) {
  const std::string more =
      "[[body]]\nname = \"more\"\ntype = \"row\"\ncount = 9000000\n"
      "particle_mass = 1\n";
  const auto text = replaced(kRow, "count = 3", "name = \"first\"\ncount = 1000001") + more;
  EXPECT_EQ(faults_of(replaced(text, "1000001", "1")), "");
  EXPECT_EQ(faults_of(text),
            "ring.toml:12:9: error: body.more.count = 9000000: 9000000 particles and the 1000001 "
            "of the bodies before would take about 4.2 GB; admissible: at most 10000000 particles "
            "in a scene\n");
}

TEST(BadScene, AnEmptyListOfBodiesIsNone) {
  const auto row = std::string(kRow);
  EXPECT_EQ(faults_of("body = []\n" + row.substr(0, row.find("[[body]]"))),
            "ring.toml:1:1: error: body: missing: a scene needs at least one [[body]]\n");
}

TEST(BadScene, ForcesOfABodyWithAnUnfitNameAreNotBlamed) {
  EXPECT_EQ(faults_of(replaced_all(kRing, "\"ring\"", "\"drivers\"")),
            "ring.toml:9:8: error: body.drivers.name = \"drivers\": a word of the summary; choose "
            "another name\n");
}

TEST(BadScene, SyntaxErrorStandsAlone) {
  EXPECT_EQ(lines_of(faults_of(replaced("radius = \"R\"", "radius = \"R\nN = -1"))).size(), 1U);
  EXPECT_TRUE(faults_of("[run]\nduration = = 3\n").starts_with("ring.toml:2:12: error: "));
  EXPECT_TRUE(faults_of("[run]\na = 1\na = 2\n").starts_with("ring.toml:3:1: error: a: "));
}

}  // namespace
}  // namespace tomlin::test
