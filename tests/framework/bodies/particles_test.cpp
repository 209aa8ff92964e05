#include "framework/bodies/particles.hpp"

#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/register_forces.hpp"
#include "framework/bodies/register_bodies.hpp"
#include "framework/core/text/number_file.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/scene.hpp"
#include "integrators/register_integrators.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

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

using Lines = std::vector<std::string>;

Lines faults_of(const std::string& text) {
  return briefs_of([&] { (void)parsed(text); });
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

// A shape on the grid of doubles there, 2^-23 apart, is kept without rounding.
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
  const Lines missing = {"1:1 body.particles.positions [scene.missing_key]"};
  EXPECT_EQ(faults_of(scene_with("")), missing);
  EXPECT_EQ(faults_of(scene_with("file = \"\"")), missing);
  EXPECT_EQ(faults_of(scene_with("positions = []")),
            Lines{"3:13 body.particles.positions = [] [scene.wrong_count]"});
  EXPECT_EQ(faults_of(scene_with("positions = [[0, 0], [1]]")),
            Lines{"3:22 body.particles.positions = [1] [scene.wrong_count]"});
  for (const char* positions : {"[[0, 0], 1]", "[0, [1]]", "[[0, nan]]", "[[1, 2, 3, 4]]", "3"}) {
    EXPECT_NE(faults_of(scene_with(std::string("positions = ") + positions)), Lines()) << positions;
  }
  EXPECT_EQ(faults_of(scene_with("positions = [1e308, -1e308]")),
            Lines{"3:13 body.particles.positions = [1e308, -1e308] [scene.not_finite]"});
  EXPECT_EQ(faults_of(scene_with("positions = [0, 1]\nvelocity = [[1], [2], [3]]")),
            Lines{"4:12 body.particles.velocity = [[1], [2], [3]] [scene.wrong_count]"});
  EXPECT_EQ(faults_of("[[body]]\ntype = \"point\"\nposition = [0]\nparticle_mass = 1\n" +
                      scene_with("positions = [[0, 1]]")),
            Lines{"7:13 body.particles.positions = [[0, 1]] [scene.wrong_count]"});
}

// ---- in a file

NumberFile parsed_rows(const std::string& text) {
  return parse_numbers(text, "f", 3, ", but space has at most 3 dimensions");
}

PointList read(const std::string& text) {
  const NumberFile file = parsed_rows(text);
  EXPECT_EQ(file.faults, Lines());
  return {file.columns, file.numbers};
}

/// "LINE:COLUMN" of each fault; no column where the line as a whole is wrong.
Lines refused(const std::string& text) {
  static const std::regex form("f:([0-9]+): (?:column ([0-9]+) )?.*");
  Lines lines;
  for (const std::string& fault : parsed_rows(text).faults) {
    lines.push_back(std::regex_replace(fault, form, "$1:$2"));
  }
  return lines;
}

TEST(NumberFile, TakesColumnsCommentsAndBlankLines) {
  const PointList expected{2, {1.0, -2.0, 3e5, 0.25}};
  EXPECT_EQ(read("1 -2\n3e5 .25\n"), expected);
  EXPECT_EQ(read("# x y\n\n  \t\n 1\t-2 # the first\r\n3e5   0.25"), expected);
  EXPECT_EQ(read("1,-2\n3e5 , 0.25\n"), expected);
  EXPECT_EQ(read("\xEF\xBB\xBF+1 -2\n+3e+5 0.25"), expected);
  EXPECT_EQ(read("7"), (PointList{1, {7.0}}));
  EXPECT_EQ(read("1 2 3").dimension, 3U);
}

TEST(NumberFile, KeepsEveryBit) {
  EXPECT_EQ(read("0.1234567890123456789e-7 5e-324").coordinates,
            (std::vector<double>{0.1234567890123456789e-7, 5e-324}));
}

TEST(NumberFile, FaultsNameTheLineAndTheColumn) {
  for (const std::string text : {"", "# nothing\n\n", "1 2 3 4"}) {
    EXPECT_EQ(refused(text), Lines{"1:"}) << text;
  }
  for (const std::string& text :
       {std::string("x y\n1 2\n"), std::string("0x10"), std::string("+-1"), std::string("nan"),
        std::string("-inf"), std::string("1e999"), std::string(",1"), std::string("1;2"),
        std::string("\0\x7F\xFF\n", 4)}) {
    EXPECT_EQ(refused(text), Lines{"1:1"}) << text;
  }
  EXPECT_EQ(refused("1,,2"), Lines{"1:2"});
  EXPECT_EQ(refused("1,"), Lines{"1:2"});
  EXPECT_EQ(refused("1 2 three"), Lines{"1:3"});
  EXPECT_EQ(refused("\n1 2\n3\n"), Lines{"3:"});
  EXPECT_NE(parsed_rows("\n1 2\n3\n").faults[0].find("line 2"), std::string::npos);
  EXPECT_EQ(refused("a\n1 2\n3\nnan\n"), (Lines{"1:1", "3:", "4:1"}));
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
  std::vector<Fault> faults(const std::string& keys) const {
    return thrown_faults([&] { (void)scene_from(keys); });
  }
  Fault fault(const std::string& keys) const {
    const std::vector<Fault> found = faults(keys);
    EXPECT_EQ(found.size(), 1U) << keys;
    return found.empty() ? Fault(FaultCode::program_internal_error) : found.front();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// A fault of `file = "NAME"` in line 3 of the scene, in that line of the file.
  void expect_fault(const Fault& found, const std::string& name, const std::string& line,
                    const std::string& code) const {
    EXPECT_EQ(found.location.file, path("s.toml"));
    EXPECT_EQ(brief(found), "3:8 body.particles.file = \"" + name + "\" [" + code + "]");
    EXPECT_TRUE(found.why.starts_with(path(name) + ":" + line)) << found.why;
  }
  void expect_fault(const std::string& name, const std::string& line,
                    const std::string& code) const {
    expect_fault(fault("file = \"" + name + "\""), name, line, code);
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
  const std::string expected =
      "positions = [[0.0, 0.0], [1.0, 0.30000000000000004]]\noutline = \"open\"\n"
      "particle_mass = 1.0\n"
      "velocity = [[1, 0], [0, 1]]\n";
  EXPECT_NE(scene->effective_toml.find(expected), std::string::npos) << scene->effective_toml;
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
  expect_fault("none.dat", "", "file.cannot_read");
  std::filesystem::create_directory(folder_ / "below");
  expect_fault("below", "", "file.cannot_read");
  write(folder_ / "empty.dat", "");
  expect_fault("empty.dat", "1:", "file.invalid");
  write(folder_ / "odd.dat", "1 2\n3 4 5\n");
  expect_fault("odd.dat", "2:", "file.invalid");
  write(folder_ / "binary.dat", std::string("\x7F\x45LF\0\1", 6));
  expect_fault("binary.dat", "1:", "file.invalid");
  write(folder_ / "large.dat", std::string((std::size_t{16} << 20) + 1, '\n'));
  expect_fault("large.dat", "", "scene.too_large");
  EXPECT_NE(fault("file = \"large.dat\"").admissible.find("16 MB"), std::string::npos);
  for (const std::string& name :
       {std::string("/dev/zero"), std::string("a\\u0000b"), std::string(100000, 'a')}) {
    EXPECT_EQ(fault("file = \"" + name + "\"").code, FaultCode::file_cannot_read);
  }
  write(folder_ / "p.dat", "1\n");
  const Fault both = fault("file = \"p.dat\"\npositions = [0]");
  EXPECT_EQ(both.location.file, path("s.toml"));
  EXPECT_EQ(brief(both), "3:8 body.particles.file = \"p.dat\" [scene.conflict]");
}

// A scene of somebody else's may name any file: what stands in it is nobody's business.
TEST_F(ParticlesFile, ThatHoldsNoPositionsIsNotRepeated) {
  const std::string secret = "TOPSECRET_token_0123";
  for (const std::string& text : {secret, "1 " + secret, secret + ",", "1\n" + secret + " 2"}) {
    write(folder_ / "key", text);
    const Fault found = fault("file = \"key\"");
    EXPECT_EQ(found.code, FaultCode::file_invalid);
    EXPECT_EQ(to_string(found).find(secret), std::string::npos) << to_string(found);
  }
}

// Nothing that only follows from the file is reported beside its own faults.
TEST_F(ParticlesFile, FaultsComeWithTheScenes) {
  write(folder_ / "p.dat", "1\nx\n2 3\n");
  const auto found = faults("file = \"p.dat\"\nvelocity = [[1], [2]]\nhold = [\"y\", 3]");
  ASSERT_EQ(found.size(), 3U);
  expect_fault(found[0], "p.dat", "2:", "file.invalid");
  expect_fault(found[1], "p.dat", "3:", "file.invalid");
  EXPECT_EQ(brief(found[2]), "5:14 body.particles.hold = 3 [scene.wrong_type]");
}

// The effective scene with all the positions must be readable again.
TEST_F(ParticlesFile, IsRefusedWhereWrittenOutItWouldBeTooMuch) {
  const std::string short_form = "1e15\n";  // 1000000000000000.0 where written out
  std::string text;
  while (text.size() < kLargestSceneFile / 3) text += short_form;
  write(folder_ / "p.dat", text);
  const Fault found = fault("file = \"p.dat\"");
  EXPECT_EQ(brief(found), "1:1 body [scene.too_large]");
  EXPECT_NE(found.admissible.find("16 MB"), std::string::npos) << to_string(found);
}

}  // namespace
}  // namespace tomlin::test
