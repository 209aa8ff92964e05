#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/text.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// `--set PATH=VALUE`.
namespace tomlin::test {
namespace {

const Euler& euler_of(const Scene& scene) {
  return *static_cast<const Euler*>(scene.run.integrator.description.get());
}

const Pull& pull_of(const Scene& scene) {
  return *static_cast<const Pull*>(scene.forces.at(1).description.get());
}

const Loop& loop_of(const Scene& scene) {
  return *static_cast<const Loop*>(scene.bodies.at(0).description.get());
}

TEST(Settings, ParameterByName) {
  const auto scene = parsed(kRing, {{"R", "3"}, {"parameters.N", "4"}});
  EXPECT_EQ(loop_of(*scene).radius, 3.0);
  EXPECT_EQ(loop_of(*scene).count, 4);
  EXPECT_EQ(pull_of(*scene).stiffness, 6.0);
}

TEST(Settings, ValueIsTomlOrElseAnExpression) {
  EXPECT_EQ(loop_of(*parsed(kRing, {{"R", "2 * N"}})).radius, 16.0);
  EXPECT_EQ(loop_of(*parsed(kRing, {{"R", "\"2 * N\""}})).radius, 16.0);
  EXPECT_EQ(loop_of(*parsed(kRing, {{"body.ring.centre", "[1, \"N\"]"}})).centre.components[1],
            8.0);
  EXPECT_EQ(loop_of(*parsed(kRing, {{"body.ring.coordinates", "rigid"}})).coordinates, "rigid");
  EXPECT_TRUE(euler_of(*parsed(kRing, {{"run.integrator.verbose", "true"}})).verbose);
  EXPECT_EQ(parsed(kRing, {{"scene.name", "two words"}})->name, "two words");
}

TEST(Settings, DottedPathsReachEveryTable) {
  const auto scene = parsed(kRing, {{"run.integrator.dt", "0.5"},
                                    {"run.duration", "7e3"},
                                    {"measure.to", "5"},
                                    {"output.every", "R / 2"},
                                    {"body.ring.radius", "2"},
                                    {"force.driver.stiffness", "9"},
                                    {"force.bonds.pairs", "neighbours"}});  // the type's name
  EXPECT_EQ(euler_of(*scene).dt, 0.5);
  EXPECT_EQ(scene->run.duration, 7e3);
  EXPECT_EQ(scene->measure.to, 5.0);
  EXPECT_EQ(scene->output.every, 0.5);
  EXPECT_EQ(loop_of(*scene).radius, 2.0);
  EXPECT_EQ(pull_of(*scene).stiffness, 9.0);
}

TEST(Settings, MayAddWhatTheFileLeavesOut) {
  const auto row =
      parsed(kRow, {{"measure.from", "0.5"}, {"output.every", "0.1"}, {"run.seed", "3"}});
  EXPECT_EQ(row->measure.from, 0.5);
  EXPECT_EQ(row->measure.unit, MeasureSettings::Unit::time);
  EXPECT_EQ(row->output.every, 0.1);
  EXPECT_EQ(row->run.seed, 3);
  EXPECT_EQ(pull_of(*parsed(kRing, {{"force.driver.attach.particle", "3"}})).attach.particle, 3);
}

TEST(Settings, TheLastOneWins) {
  EXPECT_EQ(euler_of(*parsed(kRing, {{"run.integrator.dt", "1"}, {"run.integrator.dt", "2"}})).dt,
            2.0);
  const std::vector<Setting> whole = {{"run.integrator", "{ type = \"euler\", dt = 1 }"},
                                      {"run.integrator.dt", "3"}};
  EXPECT_EQ(euler_of(*parsed(kRing, whole)).dt, 3.0);
}

TEST(Settings, StandInTheEffectiveScene) {
  const auto scene = parsed(kRing, {{"k", "3 * R"}, {"measure.from", "2"}});
  EXPECT_NE(scene->effective_toml.find("k = \"3 * R\"\n"), std::string::npos);
  EXPECT_EQ(parsed(scene->effective_toml)->effective_toml, scene->effective_toml);
}

TEST(Settings, HealFaultsOfTheFile) {
  const auto spoilt = replaced("radius = \"R\"", "radius = -1");
  EXPECT_NE(faults_of(spoilt), "");
  EXPECT_EQ(faults_of(spoilt, {{"body.ring.radius", "1"}}), "");
}

struct Unfit {
  Setting setting;
  std::string fault;  ///< behind "--set PATH=VALUE: error: "; after "..." anything goes
};

TEST(Settings, FaultsNameTheSetting) {
  const std::string paths =
      "a parameter's name, scene.KEY, box.KEY, run.KEY, measure.KEY, output.KEY, body.NAME.KEY, "
      "force.NAME.KEY, observer.NAME.KEY";
  const std::vector<Unfit> all = {
      {{"run.integrator.dt", "-1"}, "run.integrator.dt = -1: out of range; admissible: > 0"},
      {{"run.integrator.dt", "nan"}, "run.integrator.dt = nan: not a finite number; ..."},
      {{"run.integrator.dt", "tiny"}, "run.integrator.dt = tiny: there is no parameter 'tiny'..."},
      {{"run.integrator.dt", ""}, "run.integrator.dt: the expression is empty..."},
      {{"run.integrator.td", "1"},
       R"(run.integrator.td: unknown key; admissible: type, dt, verbose; did you mean "dt"?)"},
      {{"run.integrator.type", "rk9"},
       "run.integrator.type = rk9: there is no such integrator; ..."},
      {{"run.integrator.dt.x", "1"},
       "run.integrator.dt.x = 1: dt is a number, which has no keys of its own"},
      {{"run.perturb.size", "-1"}, "run.perturb.size = -1: out of range; admissible: > 0"},
      {{"plugins.mine", "1"}, "plugins.mine = 1: there is no such table..."},
      {{"plugins", "[]"},
       "plugins = []: not set here; admissible: --plugin LIB, or the scene itself"},
      {{"K", "1"},
       R"(K = 1: there is no such parameter; admissible: N, R, k; or a dotted path; )"
       R"(did you mean "k"?)"},
      {{"parameters.M", "1"}, "parameters.M = 1: there is no such parameter; ..."},
      {{"parameters.R.x", "1"}, "parameters.R.x = 1: a parameter has no keys of its own; ..."},
      {{"R", "true"}, "parameters.R = true: found a boolean; ..."},
      {{"R", "2 *"}, "parameters.R = 2 *: ..."},
      {{"R", "R + 1"}, "parameters.R = R + 1: the parameter depends on itself..."},
      {{"run", "1"}, "run = 1: a table, not a value; admissible: " + paths},
      {{"body.ring", "1"}, "body.ring = 1: not a path to a value; admissible: " + paths},
      {{"body.rign.count", "1"},
       R"(body.rign.count = 1: there is no body of that name; admissible: ring; )"
       R"(did you mean "ring"?)"},
      {{"force.pull.stiffness", "1"},
       R"(force.pull.stiffness = 1: there is no force of that name; admissible: bonds, driver)"},
      {{"forces.driver.stiffness", "1"},
       R"(forces.driver.stiffness = 1: there is no such table; admissible: scene, parameters, )"
       R"(box, body, force, observer, run, measure, output; did you mean "force"?)"},
      {{"run..dt", "1"}, "run..dt = 1: not a path; admissible: " + paths},
      {{".", "1"}, ". = 1: not a path; admissible: " + paths},
      {{"", "1"}, "not a path; admissible: " + paths},
      {{"force.driver.name", "time"}, "force.time.name = time: a word of the summary..."},
      {{"force.driver.attach.particle", "9"},
       "force.driver.attach.particle = 9: there is no particle 9: indices are 0 to 7"},
      {{"run.seed", "1\nledger = true"}, "run.seed = 1 ledger = true: ..."},
      {{"temperature", "300"}, "temperature = 300: not in this version..."},
      {{"sweep.k", "1"}, "sweep.k = 1: not in this version..."},
      {{"run.integrator", "{type=euler,dt=0.1}"},
       R"(run.integrator = {type=euler,dt=0.1}: words, names and expressions are written in )"
       R"(quotes; admissible: "euler"; the whole option in single quotes)"},
      {{"force.driver.velocity", "[1, 2"},
       "force.driver.velocity = [1, 2: the closing ] of this list is missing; admissible: the "
       "whole option in single quotes"},
      {{"scene.name", "\xff"}, "scene.name = ?: not UTF-8 text"},
  };
  for (const Unfit& unfit : all) {
    SCOPED_TRACE(unfit.setting.path + "=" + unfit.setting.value);
    const std::string& path = unfit.setting.path;
    const std::string option = "--set " + shortened(path + "=" + unfit.setting.value, 60);
    std::string expected = option + ": error: " + unfit.fault;
    const std::string found = faults_of(kRing, {{"k", "1"}, unfit.setting});
    EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 1) << found;
    if (expected.ends_with("...")) {
      expected.resize(expected.size() - 3);
      EXPECT_EQ(found.substr(0, expected.size()), expected) << found;
    } else {
      EXPECT_EQ(found, expected + "\n");
    }
  }
}

TEST(Settings, FaultsOfTheFileComeFirst) {
  const auto found =
      faults_of(replaced("radius = \"R\"", "radius = -1"), {{"run.duration", "0"}, {"S", "1"}});
  const auto file = found.find("ring.toml:12:10: error: body.ring.radius");
  const auto first = found.find("--set run.duration=0: error: run.duration");
  const auto second = found.find("--set S=1: error: S");
  EXPECT_EQ(file, 0U);
  EXPECT_LT(first, second);
  EXPECT_NE(second, std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
