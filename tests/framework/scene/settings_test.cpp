#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/document.hpp"
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

/// Decimal numbers are read without the TOML library, and give what it gives, which a space behind
/// them asks for.
TEST(Settings, PlainNumbersAreThoseOfTheLibrary) {
  for (const char* text : {"0.5",
                           "-0.5",
                           "-0.0",
                           "12.25",
                           "0.1",
                           "1e5",
                           "-1e-5",
                           "1.5e300",
                           "4.9e-324",
                           "1e400",
                           "0.30000000000000004",
                           "2.2250738585072011e-308",
                           "01.5",
                           "1.",
                           ".5",
                           "1.e5",
                           "1e",
                           "+1.5",
                           "1_0.5",
                           "1.5x",
                           "1.5.5",
                           "1e5.5",
                           "inf",
                           "nan",
                           "-",
                           "",
                           "7",
                           "1E5",
                           "00.5",
                           "-01.5"}) {
    const Node plain = parse_setting(text, 1);
    const Node library = parse_setting(std::string(text) + ' ', 1);
    if (const auto* number = library.as<double>(); number != nullptr && !std::isnan(*number)) {
      ASSERT_NE(plain.as<double>(), nullptr) << text;
      EXPECT_EQ(*plain.as<double>(), *number) << text;
      EXPECT_EQ(std::signbit(*plain.as<double>()), std::signbit(*number)) << text;
    } else {
      EXPECT_EQ(plain.value.index(), library.value.index()) << text;
    }
  }
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
  EXPECT_EQ(loop_of(*parsed(kRing, {{"body.ring.coordinates", "rigid"}})).coordinates,
            Coordinates::rigid);
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
  std::string fault;  ///< behind "--set PATH=VALUE: ", see abridged()
};

TEST(Settings, FaultsNameTheSetting) {
  const std::vector<Unfit> all = {
      {{"run.integrator.dt", "-1"}, "run.integrator.dt = -1 [scene.out_of_range]"},
      {{"run.integrator.dt", "nan"}, "run.integrator.dt = nan [scene.not_finite]"},
      {{"run.integrator.dt", "tiny"}, "run.integrator.dt = tiny [expression.unknown_name]"},
      {{"run.integrator.dt", ""}, "run.integrator.dt [expression.syntax]"},
      {{"run.integrator.td", "1"}, "run.integrator.td [scene.unknown_key] did you mean dt"},
      {{"run.integrator.type", "rk9"}, "run.integrator.type = rk9 [scene.unknown_component]"},
      {{"run.integrator.dt.x", "1"}, "run.integrator.dt.x = 1 [scene.unknown_key]"},
      {{"run.perturb.size", "-1"}, "run.perturb.size = -1 [scene.out_of_range]"},
      {{"plugins.mine", "1"}, "plugins.mine = 1 [scene.unknown_key]"},
      {{"plugins", "[]"}, "plugins = [] [command.invalid_value]"},
      {{"K", "1"}, "K = 1 [scene.unknown_key] did you mean k"},
      {{"parameters.M", "1"}, "parameters.M = 1 [scene.unknown_key]"},
      {{"parameters.R.x", "1"}, "parameters.R.x = 1 [scene.unknown_key]"},
      {{"R", "true"}, "parameters.R = true [scene.wrong_type]"},
      {{"R", "2 *"}, "parameters.R = 2 * [expression.syntax]"},
      {{"R", "R + 1"}, "parameters.R = R + 1 [expression.cycle]"},
      {{"run", "1"}, "run = 1 [command.invalid_value]"},
      {{"body.ring", "1"}, "body.ring = 1 [command.invalid_value]"},
      {{"body.rign.count", "1"}, "body.rign.count = 1 [scene.unknown_name] did you mean ring"},
      {{"force.pull.stiffness", "1"}, "force.pull.stiffness = 1 [scene.unknown_name]"},
      {{"forces.driver.stiffness", "1"},
       "forces.driver.stiffness = 1 [scene.unknown_key] did you mean force"},
      {{"run..dt", "1"}, "run..dt = 1 [command.invalid_value]"},
      {{".", "1"}, ". = 1 [command.invalid_value]"},
      {{"", "1"}, "[command.invalid_value]"},
      {{"force.driver.name", "time"}, "force.time.name = time [scene.invalid_name]"},
      {{"force.driver.attach.particle", "9"},
       "force.driver.attach.particle = 9 [scene.out_of_range]"},
      {{"run.seed", "1\nledger = true"}, "run.seed = 1 ledger = true [expression.syntax]"},
      {{"sweep.k", "1"}, "sweep.k = 1 [command.invalid_value]"},
      {{"run.integrator", "{type=euler,dt=0.1}"},
       "run.integrator = {type=euler,dt=0.1} [scene.syntax]"},
      {{"force.driver.velocity", "[1, 2"}, "force.driver.velocity = [1, 2 [scene.syntax]"},
      {{"scene.name", "\xff"}, "scene.name = ? [scene.encoding]"},
  };
  for (const auto& [setting, fault] : all) {
    const std::string option = shortened(setting.path + "=" + setting.value, 60);
    EXPECT_EQ(abridged(faults_of(kRing, {{"k", "1"}, setting})),
              "--set " + option + ": " + fault + "\n");
  }
}

TEST(Settings, FaultsOfTheFileComeFirst) {
  EXPECT_EQ(abridged(faults_of(replaced("radius = \"R\"", "radius = -1"),
                               {{"run.duration", "0"}, {"S", "1"}})),
            "ring.toml:12:10: body.ring.radius = -1 [scene.out_of_range]\n"
            "--set run.duration=0: run.duration = 0 [scene.out_of_range]\n"
            "--set S=1: S = 1 [scene.unknown_key]\n");
}

}  // namespace
}  // namespace tomlin::test
