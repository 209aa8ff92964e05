#include "framework/bodies/particles.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/register.hpp"
#include "framework/bodies/position_file.hpp"
#include "framework/bodies/register.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/scene.hpp"
#include "integrators/register.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin::test {
namespace {

Registry all_components() {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry);
  return registry;
}

std::string scene_with(const std::string& keys) {
  return "[[body]]\ntype = \"particles\"\n" + keys +
         "\nparticle_mass = 1.0\n[run]\nduration = 1.0\n"
         "integrator = { type = \"rk4\", dt = 0.01 }\n";
}

std::shared_ptr<const Scene> parsed(const std::string& text) {
  static const Registry registry = all_components();
  return parse_scene(text, "s.toml", registry);
}

std::string faults_of(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const PointList& positions_of(const Scene& scene) {
  return static_cast<const ParticlesDescription*>(scene.bodies[0].description.get())->positions;
}

BodyGeometry geometry_of(const Scene& scene) {
  const SceneBody& body = scene.bodies[0];
  return body.record->build(body.description.get(), scene.dimension);
}

BodyEnds ends_of(const Scene& scene) {
  const SceneBody& body = scene.bodies[0];
  return body.record->ends(body.description.get(), scene.dimension);
}

// ---- in the scene

TEST(Particles, StandWhereTheListSays) {
  const auto scene = parsed(scene_with("positions = [[1.0, 2], [\"1 + 1\", -3], [0, 0]]"));
  EXPECT_EQ(scene->dimension, 2);
  EXPECT_EQ(scene->bodies[0].record->count(scene->bodies[0].description.get()), 3);
  const BodyGeometry geometry = geometry_of(*scene);
  EXPECT_EQ(geometry.anchor, (std::vector<double>{1.0, 2.0}));
  const std::vector<std::vector<double>> relative = {{0.0, 0.0}, {1.0, -5.0}, {-1.0, -2.0}};
  EXPECT_EQ(geometry.relative, relative);
  EXPECT_FALSE(ends_of(*scene).closed);
  EXPECT_EQ(ends_of(*scene).open_along, -1);
}

TEST(Particles, OfALineMayBeAListOfNumbers) {
  const auto plain = parsed(scene_with("positions = [1.0, 2.0, 4.0, 8.0]"));
  EXPECT_EQ(plain->dimension, 1);
  EXPECT_EQ(positions_of(*plain), (PointList{1, {1.0, 2.0, 4.0, 8.0}}));
  EXPECT_EQ(positions_of(*parsed(scene_with("positions = [[1.0], [2.0], [4.0], [8.0]]"))),
            positions_of(*plain));
  EXPECT_EQ(ends_of(*plain).open_along, -1) << "only a chain is closed by a box";
}

// Where doubles are 2^-23 apart a shape given on that grid is kept without rounding.
TEST(Particles, KeepTheirShapeFarAway) {
  const auto scene =
      parsed(scene_with("positions = [1e9, \"1e9 + 2^-23\", \"1e9 + 3 * 2^-22\", 1000000100.5]"));
  const BodyGeometry geometry = geometry_of(*scene);
  EXPECT_EQ(geometry.anchor[0], 1e9);
  EXPECT_EQ(geometry.relative[1][0], 0x1p-23);
  EXPECT_EQ(geometry.relative[2][0], 0x3p-22);
  EXPECT_EQ(geometry.relative[3][0], 100.5);
}

TEST(Particles, ListFaultsHaveTheirPlace) {
  const std::string missing =
      "s.toml:1:1: error: body.particles.positions: missing; admissible: positions = [[..], ..] or "
      "file = \"..\"";
  EXPECT_EQ(faults_of(scene_with("")), missing);
  EXPECT_EQ(faults_of(scene_with("file = \"\"")), missing);
  EXPECT_EQ(faults_of(scene_with("positions = []")),
            "s.toml:3:13: error: body.particles.positions = []: the list is empty; admissible: a "
            "list of points, each a list with a number per dimension");
  EXPECT_EQ(faults_of(scene_with("positions = [[0, 0], [1]]")),
            "s.toml:3:22: error: body.particles.positions = [1]: point 1 has 1 coordinate, the "
            "first has 2; admissible: a list of points, each a list with a number per dimension");
  EXPECT_NE(faults_of(scene_with("positions = [[0, 0], 1]")), "");
  EXPECT_NE(faults_of(scene_with("positions = [0, [1]]")), "");
  EXPECT_NE(faults_of(scene_with("positions = [[0, nan]]")), "");
  EXPECT_NE(faults_of(scene_with("positions = [[1, 2, 3, 4]]")), "");
  EXPECT_NE(faults_of(scene_with("positions = 3")), "");
  EXPECT_EQ(faults_of(scene_with("positions = [1e308, -1e308]")),
            "s.toml:3:13: error: body.particles.positions = [1e308, -1e308]: particle 1 is "
            "infinitely far from the first");
  EXPECT_EQ(faults_of(scene_with("positions = [0, 1]\nvelocity = [[1], [2], [3]]")),
            "s.toml:4:12: error: body.particles.velocity = [[1], [2], [3]]: 3 entries, but the "
            "body has 2 particles");
  EXPECT_EQ(faults_of("[[body]]\ntype = \"point\"\nposition = [0]\nparticle_mass = 1\n" +
                      scene_with("positions = [[0, 1]]")),
            "s.toml:7:13: error: body.particles.positions = [[0, 1]]: mixed dimensions: points of "
            "2, but the scene has 1, by its first body");
}

// ---- in a file

PointList read(const std::string& text) {
  PositionFile file = parse_positions(text, "f");
  EXPECT_EQ(file.faults, std::vector<std::string>());
  return file.positions;
}

std::vector<std::string> refused(const std::string& text) {
  return parse_positions(text, "f").faults;
}

TEST(PositionFile, TakesColumnsCommentsAndBlankLines) {
  const PointList due{2, {1.0, -2.0, 3e5, 0.25}};
  EXPECT_EQ(read("1 -2\n3e5 .25\n"), due);
  EXPECT_EQ(read("# x y\n\n  \t\n 1\t-2 # the first\r\n3e5   0.25"), due);
  EXPECT_EQ(read("1,-2\n3e5 , 0.25\n"), due);
  EXPECT_EQ(read("\xEF\xBB\xBF+1 -2\n+3e+5 0.25"), due);
  EXPECT_EQ(read("7"), (PointList{1, {7.0}}));
  EXPECT_EQ(read("1 2 3").dimension, 3U);
}

TEST(PositionFile, KeepsEveryBit) {
  EXPECT_EQ(read("0.1234567890123456789e-7 5e-324").coordinates,
            (std::vector<double>{0.1234567890123456789e-7, 5e-324}));
}

TEST(PositionFile, FaultsNameTheLine) {
  using Faults = std::vector<std::string>;
  EXPECT_EQ(refused(""), Faults{"f:1: there are no positions in it"});
  EXPECT_EQ(refused("# nothing\n\n"), Faults{"f:1: there are no positions in it"});
  EXPECT_EQ(refused("\n1 2\n3\n"), Faults{"f:3: 1 column, but line 2 has 2"});
  EXPECT_EQ(refused("1 2 3 4"), Faults{"f:1: 4 columns, but space has at most 3 dimensions"});
  EXPECT_EQ(refused("x y\n1 2\n"), Faults{"f:1: column 1 is not a number"});
  EXPECT_EQ(refused("0x10"), Faults{"f:1: column 1 is not a number"});
  EXPECT_EQ(refused("+-1"), Faults{"f:1: column 1 is not a number"});
  EXPECT_EQ(refused("nan"), Faults{"f:1: column 1 is not a finite number"});
  EXPECT_EQ(refused("-inf"), Faults{"f:1: column 1 is not a finite number"});
  EXPECT_EQ(refused("1e999"), Faults{"f:1: column 1 is too large or too small for a double"});
  EXPECT_EQ(refused("1,,2"), Faults{"f:1: column 2 is empty"});
  EXPECT_EQ(refused(",1"), Faults{"f:1: column 1 is empty"});
  EXPECT_EQ(refused("1,"), Faults{"f:1: column 2 is empty"});
  EXPECT_EQ(refused("1;2"), Faults{"f:1: column 1 is not a number"});
  EXPECT_EQ(refused(std::string("\0\x7F\xFF\n", 4)), Faults{"f:1: column 1 is not a number"});
  EXPECT_EQ(refused("1 2 three"), Faults{"f:1: column 3 is not a number"});
  EXPECT_EQ(refused("a\n1 2\n3\nnan\n"),
            (Faults{"f:1: column 1 is not a number", "f:3: 1 column, but line 2 has 2",
                    "f:4: column 1 is not a finite number"}));
  std::string junk;
  for (int i = 0; i < 1000; ++i) junk += "?\n";
  EXPECT_EQ(refused(junk).size(), 10U);
}

class ParticlesFile : public testing::Test {
 protected:
  std::shared_ptr<const Scene> scene_from(const std::string& keys) const {
    write(folder_ / "s.toml", scene_with(keys));
    return read_scene((folder_ / "s.toml").string(), all_components());
  }
  std::string faults(const std::string& keys) const {
    try {
      (void)scene_from(keys);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The fault of `file = "NAME"` in line 3.
  std::string fault(const std::string& name, const std::string& why) const {
    return path("s.toml") + ":3:8: error: body.particles.file = \"" + name + "\": " + path(name) +
           why;
  }

  TemporaryFolder folder_;
};

TEST_F(ParticlesFile, LiesBesideTheScene) {
  std::filesystem::create_directory(folder_ / "below");
  write(folder_ / "below" / "p.dat", "0 0\n1 0.1\n");
  const auto scene = scene_from("file = \"below/p.dat\"");
  EXPECT_EQ(positions_of(*scene), (PointList{2, {0.0, 0.0, 1.0, 0.1}}));
  EXPECT_EQ(scene->dimension, 2);
  EXPECT_EQ(positions_of(*scene_from("file = \"" + path("below/p.dat") + "\"")),
            positions_of(*scene));
}

TEST_F(ParticlesFile, StandsInTheEffectiveScene) {
  write(folder_ / "p.dat", "0 0\n1 0.30000000000000004\n");
  const auto scene = scene_from("file = \"p.dat\"\nvelocity = [[1, 0], [0, 1]]");
  const std::string due =
      "positions = [[0.0, 0.0], [1.0, 0.30000000000000004]]\nparticle_mass = 1.0\n"
      "velocity = [[1, 0], [0, 1]]\n";
  EXPECT_NE(scene->effective_toml.find(due), std::string::npos) << scene->effective_toml;
  EXPECT_EQ(scene->effective_toml.find("file"), std::string::npos);
  std::filesystem::remove(folder_ / "p.dat");
  const auto again = parsed(scene->effective_toml);
  EXPECT_EQ(positions_of(*again), positions_of(*scene));
  EXPECT_EQ(again->effective_toml, scene->effective_toml);
}

TEST_F(ParticlesFile, OfALineStandsInTheEffectiveScene) {
  write(folder_ / "p.dat", "0\n1\n");
  const auto scene = scene_from("file = \"p.dat\"");
  EXPECT_NE(scene->effective_toml.find("positions = [0.0, 1.0]\n"), std::string::npos);
  EXPECT_EQ(parsed(scene->effective_toml)->effective_toml, scene->effective_toml);
}

TEST_F(ParticlesFile, ThatCannotBeReadIsRefused) {
  EXPECT_EQ(faults("file = \"none.dat\""), fault("none.dat", ": there is no such file"));
  std::filesystem::create_directory(folder_ / "below");
  EXPECT_EQ(faults("file = \"below\""), fault("below", ": a directory, where a file is expected"));
  write(folder_ / "empty.dat", "");
  EXPECT_EQ(faults("file = \"empty.dat\""), fault("empty.dat", ":1: there are no positions in it"));
  write(folder_ / "odd.dat", "1 2\n3 4 5\n");
  EXPECT_EQ(faults("file = \"odd.dat\""), fault("odd.dat", ":2: 3 columns, but line 1 has 2"));
  write(folder_ / "binary.dat", std::string("\x7F\x45LF\0\1", 6));
  EXPECT_EQ(faults("file = \"binary.dat\""), fault("binary.dat", ":1: column 1 is not a number"));
  write(folder_ / "large.dat", std::string((std::size_t{16} << 20) + 1, '\n'));
  EXPECT_EQ(faults("file = \"large.dat\""),
            fault("large.dat", ": the file is too large; admissible: at most 16 MB"));
  EXPECT_NE(faults("file = \"/dev/zero\"").find("a device or a socket, where a file is expected"),
            std::string::npos);
  EXPECT_NE(faults("file = \"a\\u0000b\"").find("not the name of a file"), std::string::npos);
  EXPECT_NE(faults("file = \"" + std::string(100000, 'a') + "\"").find("cannot be read"),
            std::string::npos);
  write(folder_ / "p.dat", "1\n");
  EXPECT_EQ(faults("file = \"p.dat\"\npositions = [0]"),
            path("s.toml") +
                ":3:8: error: body.particles.file = \"p.dat\": positions are given too; "
                "admissible: one of the two");
}

// A scene of somebody else's may name any file: what stands in it is nobody's business.
TEST_F(ParticlesFile, ThatHoldsNoPositionsIsNotRepeated) {
  const std::string secret = "TOPSECRET_token_0123";
  for (const std::string& text : {secret, "1 " + secret, secret + ",", "1\n" + secret + " 2"}) {
    write(folder_ / "key", text);
    const std::string found = faults("file = \"key\"");
    EXPECT_NE(found.find("is not a number"), std::string::npos) << found;
    EXPECT_EQ(found.find(secret), std::string::npos) << found;
  }
}

// Nothing that only follows from the file is told beside its own faults.
TEST_F(ParticlesFile, FaultsComeWithTheScenes) {
  write(folder_ / "p.dat", "1\nx\n2 3\n");
  const std::string found = faults("file = \"p.dat\"\nvelocity = [[1], [2]]\nhold = [\"y\", 3]");
  EXPECT_EQ(found, fault("p.dat", ":2: column 1 is not a number") + "\n" +
                       fault("p.dat", ":3: 2 columns, but line 1 has 1") + "\n" + path("s.toml") +
                       ":5:14: error: body.particles.hold = 3: found an integer; admissible: a "
                       "list of \"x\", \"y\", \"z\" or \"rotation\"");
}

// What the effective scene would say must be readable again.
TEST_F(ParticlesFile, IsRefusedWhereWrittenOutItWouldBeTooMuch) {
  const std::string short_form = "1e15\n";  // 1000000000000000.0 where written out
  std::string text;
  while (text.size() < kLargestSceneFile / 3) text += short_form;
  write(folder_ / "p.dat", text);
  const std::string found = faults("file = \"p.dat\"");
  EXPECT_NE(found.find("with all positions written out the scene takes "), std::string::npos)
      << found;
  EXPECT_NE(found.find("admissible: at most 16 MB"), std::string::npos) << found;
}

}  // namespace
}  // namespace tomlin::test
