#include "framework/scene/scene.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/scene/scene_fixture.hpp"

namespace tomlin::test {
namespace {

TEST(Scene, IsReadWhole) {
  const auto scene = parsed(kRing);
  EXPECT_EQ(scene->file, "ring.toml");
  EXPECT_EQ(scene->name, "a ring");
  EXPECT_EQ(scene->dimension, 2);
  const std::vector<std::pair<std::string, double>> parameters = {
      {"N", 8.0}, {"R", 1.0}, {"k", 2.0}};
  EXPECT_EQ(scene->parameters, parameters);

  ASSERT_EQ(scene->bodies.size(), 1U);
  const SceneBody& ring = scene->bodies[0];
  EXPECT_EQ(ring.name, "ring");
  EXPECT_EQ(ring.record->name, "loop");
  const auto& loop = *static_cast<const Loop*>(ring.description.get());
  EXPECT_EQ(loop.count, 8);
  EXPECT_EQ(loop.radius, 1.0);
  EXPECT_EQ(loop.centre.components, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(loop.particle_mass.values, std::vector<double>{0.125});
  EXPECT_TRUE(loop.velocity.values.empty());
  EXPECT_EQ(loop.coordinates, Coordinates::particles);

  ASSERT_EQ(scene->forces.size(), 2U);
  EXPECT_EQ(scene->forces[0].name, "bonds");  // its type's
  EXPECT_EQ(scene->forces[0].bodies, std::vector<std::size_t>{0});
  const auto& bonds = *static_cast<const Bonds*>(scene->forces[0].description.get());
  EXPECT_EQ(bonds.pairs.kind, PairSelection::Kind::all);
  EXPECT_EQ(bonds.rest_lengths.word, "initial");
  const auto& pull = *static_cast<const Pull*>(scene->forces[1].description.get());
  EXPECT_EQ(pull.stiffness, 2.0);
  EXPECT_EQ(pull.velocity.components, (std::vector<double>{1e-3, 0.0}));
  EXPECT_EQ(pull.attach.kind, Attachment::Kind::centre_of_mass);

  EXPECT_EQ(scene->run.duration, 1e4);
  EXPECT_EQ(scene->run.seed, 0);
  EXPECT_EQ(scene->run.integrator.record->name, "euler");
  EXPECT_EQ(static_cast<const Euler*>(scene->run.integrator.description.get())->dt, 1e-4);
  EXPECT_EQ(scene->measure.unit, MeasureSettings::Unit::time);
  EXPECT_EQ(scene->measure.from, 1.0);
  EXPECT_EQ(scene->measure.to, 10.0);
  EXPECT_EQ(scene->output.every, 1.0);
}

TEST(Scene, KnowsWhereThingsStand) {
  const auto scene = parsed(kRing);
  EXPECT_EQ(scene->bodies[0].location.line, 8);
  EXPECT_EQ(scene->bodies[0].location_of("radius").line, 12);
  EXPECT_EQ(scene->bodies[0].location_of("radius").column, 10);
  EXPECT_EQ(scene->bodies[0].location_of("velocity").line, 8);  // not given: the table
  EXPECT_EQ(scene->run.integrator.location_of("dt").line, 27);
  EXPECT_EQ(scene->run.integrator.location_of("dt").column, 37);
  EXPECT_EQ(scene->run.location.line, 25);
  EXPECT_EQ(scene->measure.locations.at("to").line, 31);
}

TEST(Scene, LineEndsAndByteOrderMarkDoNotMatter) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : std::string(kRing)) text += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(parsed(text)->effective_toml, parsed(kRing)->effective_toml);
  text.replace(text.find("\"R\""), 3, "\"X\"");
  EXPECT_EQ(briefs_of(text),
            std::vector<std::string>{"12:11 body.ring.radius = \"X\" [expression.unknown_name]"});
}

TEST(Scene, WithoutMeasureTheWindowIsTheRun) {
  const auto scene = parsed(replaced("[measure]\nfrom = 1.0\nto = 10.0\nin = \"time\"\n", ""));
  EXPECT_EQ(scene->measure.unit, MeasureSettings::Unit::whole_run);
  EXPECT_EQ(scene->measure.from, 0.0);
  EXPECT_FALSE(scene->measure.to);
  EXPECT_EQ(scene->effective_toml.find("[measure]"), std::string::npos);
}

TEST(Scene, WindowIsInTimeUnlessSaidOtherwise) {
  EXPECT_EQ(parsed(replaced("in = \"time\"\n", ""))->measure.unit, MeasureSettings::Unit::time);
  const auto scene = parsed(replaced("in = \"time\"",
                                     "in = \"driver_periods\"\n"
                                     "driver = \"driver\"\nperiod = \"2 * R\""));
  EXPECT_EQ(scene->measure.unit, MeasureSettings::Unit::driver_periods);
  EXPECT_EQ(scene->measure.driver, "driver");
  EXPECT_EQ(scene->measure.period, 2.0);
}

TEST(Scene, ForceOfTheOnlyBodyNeedNotNameIt) {
  const auto scene = parsed(replaced("body = \"ring\"\npairs", "pairs"));
  EXPECT_EQ(scene->forces[0].bodies, std::vector<std::size_t>{0});
  EXPECT_EQ(scene->effective_toml, parsed(kRing)->effective_toml);
}

TEST(Scene, IntegerKeysTakeIntegralNumbersOfEveryForm) {
  for (const char* count : {"8", "8.0", "8e0", "\"N\"", "\"2 * N / 2\"", "0x8", "\"2^3\""}) {
    const auto scene = parsed(replaced("count = \"N\"", std::string("count = ") + count));
    EXPECT_EQ(static_cast<const Loop*>(scene->bodies[0].description.get())->count, 8) << count;
  }
}

TEST(Scene, EveryKindOfValueIsRead) {
  const auto bonds = [](const std::string& keys) {
    const auto scene = parsed(replaced("pairs = \"all\"", keys));
    return *static_cast<const Bonds*>(scene->forces[0].description.get());
  };
  EXPECT_EQ(bonds("pairs = \"neighbours\"").pairs.kind, PairSelection::Kind::neighbours);
  const auto list = bonds("pairs = [[0, 1], [\"N - 1\", 2]]").pairs;
  EXPECT_EQ(list.kind, PairSelection::Kind::list);
  EXPECT_EQ(list.list, (std::vector<std::array<std::int64_t, 2>>{{0, 1}, {7, 2}}));
  EXPECT_EQ(bonds("rest_lengths = 2").rest_lengths.numbers, std::vector<double>{2.0});
  EXPECT_EQ(bonds("rest_lengths = \"R\"").rest_lengths.numbers, std::vector<double>{1.0});
  EXPECT_EQ(bonds("rest_lengths = [1, \"k\", 3, 4, 5, 6, 7, 8]").rest_lengths.numbers.size(), 8U);
  EXPECT_EQ(bonds("charge = [1, -2, 3, 4, 5, 6, 7, \"8\"]").charge.values.back(), 8.0);

  const auto attach = [](const std::string& value) {
    const auto scene =
        parsed(replaced("velocity = [1e-3, 0.0]", "velocity = [1e-3, 0.0]\nattach = " + value));
    return static_cast<const Pull*>(scene->forces[1].description.get())->attach;
  };
  EXPECT_EQ(attach("\"each_particle\"").kind, Attachment::Kind::each_particle);
  EXPECT_EQ(attach("{ particle = \"N - 1\" }").particle, 7);

  const auto velocity = [](const std::string& value) {
    const auto scene = parsed(replaced("radius = \"R\"", "radius = 1\nvelocity = " + value));
    return static_cast<const Loop*>(scene->bodies[0].description.get())->velocity.values;
  };
  EXPECT_EQ(velocity("[1, 2]"), (std::vector<SpaceVector>{{{1.0, 2.0}}}));
  EXPECT_EQ(velocity("[[0, 0], [1, 0], [2, 0], [3, 0], [4, 0], [5, 0], [6, 0], [7, \"R\"]]")[7],
            (SpaceVector{{7.0, 1.0}}));
}

TEST(Scene, DimensionIsTheFirstBodysLengthOfVectors) {
  EXPECT_EQ(parsed(replaced_all(kDots, "[0.0]", "[0.0, 1.0, 2.0]"))->dimension, 3);
  EXPECT_EQ(parsed(kDots)->dimension, 1);
  EXPECT_EQ(parsed(kRow)->dimension, 1);
  EXPECT_EQ(parsed(std::string(kRow) + "[[body]]\ntype = \"dot\"\nparticle_mass = 1\n"
                                       "position = [3]\n")
                ->dimension,
            1);
  EXPECT_EQ(parsed(replaced(kRow, "count = 3", "count = 3\nvelocity = [1, 2]"))->dimension, 2);
}

TEST(Scene, NumbersKeepEveryBit) {
  const auto scene = parsed(replaced("R = 1.0", "R = 0.1234567890123456789e-7"));
  EXPECT_EQ(scene->parameters[1].second, 0.1234567890123456789e-7);
  EXPECT_EQ(parsed(scene->effective_toml)->parameters, scene->parameters);
}

}  // namespace
}  // namespace tomlin::test
