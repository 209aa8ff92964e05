#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/bodies/particles.hpp"
#include "framework/core/text/xyz_file.hpp"
#include "tests/framework/bodies/body_fixture.hpp"
#include "tests/framework/output/temporary_folder.hpp"

/// Files of extended XYZ: their columns, their faults, and what a body takes from them.
namespace tomlin::test {
namespace {

using XyzLines = std::vector<std::string>;

/// "LINE" of each fault, and its column where it has one.
XyzLines xyz_faults(const std::string& text, std::int64_t frame = -1) {
  static const std::regex form("f:([0-9]+): (?:column ([0-9]+) )?.*");
  XyzLines lines;
  for (const std::string& fault : parse_xyz(text, "f", frame).faults) {
    lines.push_back(std::regex_replace(fault, form, "$1:$2"));
  }
  return lines;
}

TEST(XyzFile, TakesTheColumnsThatPropertiesName) {
  const XyzFrame frame = parse_xyz(
      "2\nProperties=id:I:1:pos:R:3:flag:L:2:species:S:1:velo:R:3:masses:R:1 Lattice=\"1 0 0 0 1 0 "
      "0 0 1\"\n7 1 -2 3e1 T F C .1 .2 .3 12.5\n8\t0 0 0 F F H 0 0 -1 1 \r\n",
      "f", -1);
  EXPECT_EQ(frame.faults, XyzLines());
  EXPECT_EQ(frame.dimension, 3U);
  EXPECT_EQ(frame.positions, (std::vector<double>{1, -2, 30, 0, 0, 0}));
  EXPECT_EQ(frame.velocities, (std::vector<double>{0.1, 0.2, 0.3, 0, 0, -1}));
  EXPECT_EQ(frame.masses, (std::vector<double>{12.5, 1}));
  EXPECT_EQ(frame.species, (XyzLines{"C", "H"}));
}

TEST(XyzFile, IsPlainWithoutProperties) {
  for (const char* comment : {"", "a \"comment\" = with 'marks", "energy=3 pbc=\"T T"}) {
    const XyzFrame frame =
        parse_xyz("2\n" + std::string(comment) + "\nC 1 2 3\nN 4 5 6 0.5 -1\n", "f", -1);
    EXPECT_EQ(frame.faults, XyzLines()) << comment;
    EXPECT_EQ(frame.positions, (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(frame.species, (XyzLines{"C", "N"}));
    EXPECT_TRUE(frame.velocities.empty() && frame.masses.empty());
  }
  // "Not an element" is none.
  EXPECT_TRUE(parse_xyz("1\n\nX 0 0 0", "f", -1).species.empty());
  EXPECT_EQ(parse_xyz("2\n\nX 0 0 0\nC 0 0 1", "f", -1).species, (XyzLines{"X", "C"}));
}

TEST(XyzFile, HasFramesFromBothEnds) {
  const std::string text = "1\na\nC 0 0 0\n2\nb\nC 1 0 0\nC 2 0 0\n1\nc\nC 3 0 0\n\n \n";
  const auto first = [&](std::int64_t frame) {
    const XyzFrame found = parse_xyz(text, "f", frame);
    return found.positions.empty() ? -1.0 : found.positions.front();
  };
  EXPECT_EQ(first(0), 0.0);
  EXPECT_EQ(first(1), 1.0);
  EXPECT_EQ(first(-1), 3.0);
  EXPECT_EQ(first(-2), 1.0);
  EXPECT_EQ(first(-3), 0.0);
  for (const std::int64_t none : {std::int64_t{3}, std::int64_t{-4}, INT64_MAX, INT64_MIN}) {
    EXPECT_EQ(xyz_faults(text, none), XyzLines{"1:"}) << none;
  }
}

TEST(XyzFile, KeepsTheAxesOfTheDimension) {
  const XyzFrame plane =
      parse_xyz("1\nProperties=species:S:1:pos:R:3 dimension=2\nX 1 2 0\n", "f", -1);
  EXPECT_EQ(plane.dimension, 2U);
  EXPECT_EQ(plane.positions, (std::vector<double>{1, 2}));
  EXPECT_EQ(xyz_faults("1\ndimension=2\nX 1 2 1e-9\n"), XyzLines{"3:4"});
  EXPECT_EQ(xyz_faults("1\ndimension=4\nX 1 2 0\n"), XyzLines{"2:"});
}

TEST(XyzFile, FaultsNameTheLineAndTheColumn) {
  EXPECT_EQ(xyz_faults("1\n\nC 0 0 0\n"), XyzLines());
  for (const char* text : {"", "\n", "a\n\nC 0 0 0\n", "0\n\n", "-1\n\n", "1 2\n\nC 0 0 0\n",
                           "1.0\n", "99999999999999999999\n\nC 0 0 0\n"}) {
    EXPECT_EQ(xyz_faults(text), XyzLines{"1:"}) << text;
  }
  EXPECT_EQ(xyz_faults("3\n\nC 0 0 0\nC 0 0 1\n"), XyzLines{"4:"}) << "it ends too early";
  EXPECT_EQ(xyz_faults("1000000000000\n\nC 0 0 0\n"), XyzLines{"3:"});
  EXPECT_EQ(xyz_faults("1\n\nC 0 0 0\nC 0 0 1\n"), XyzLines{"4:"}) << "that is no second frame";
  EXPECT_EQ(xyz_faults("1\n\nC 0 0\n"), XyzLines{"3:4"}) << "it is missing";
  EXPECT_EQ(xyz_faults("2\n\nC 0 x 0\n6 0 nan 0\n"), (XyzLines{"3:3", "4:1"}));
  EXPECT_EQ(xyz_faults("1\n\nC 0 1e999 0\n"), XyzLines{"3:3"});
  const auto with = [](const std::string& properties) {
    return xyz_faults("1\nProperties=" + properties + "\nC 0 0 0\n");
  };
  EXPECT_EQ(with("species:S:1:pos:R:3"), XyzLines());
  for (const char* wrong :
       {"species:S:1", "pos:R:3:species:S", "pos:R:2:species:S:1:x:R:1", "species:R:1:pos:R:3",
        "species:S:1:pos:R:3:pos:R:3", "species:S:1:pos:Q:3", "species:S:0:pos:R:3",
        "pos:R:3:a:I:x", "mass:R:2:pos:R:3", "pos:R:3:velo:S:3", "", "pos:R:3:a:I:999999999999"}) {
    EXPECT_EQ(with(wrong), XyzLines{"2:"}) << wrong;
  }
  EXPECT_EQ(with("species:S:1:pos:R:3:extra:R:1"), XyzLines{"3:5"});
  EXPECT_EQ(with("a:S:1:pos:R:2:species:R:1"), XyzLines{"2:"});
  EXPECT_EQ(xyz_faults("1\nProperties=species:S:1:pos:R:3\nC 0 0 0 1\n"), XyzLines{"3:"});
  EXPECT_EQ(xyz_faults("1\nProperties=pos:R:3:mass:R:1\n0 0 0 0\n"), XyzLines{"3:4"});
  std::string junk = "1000\n\n";
  for (int i = 0; i < 1000; ++i) junk += "?\n";
  EXPECT_EQ(xyz_faults(junk).size(), 10U);
}

// ---- the body

class ParticlesXyz : public testing::Test {
 protected:
  std::shared_ptr<const Scene> scene(const std::string& keys, const std::string& more = "") const {
    write(folder_ / "s.toml",
          "[[body]]\ntype = \"particles\"\n" + keys + "\n" + more +
              "[run]\nduration = 0.1\nintegrator = { type = \"rk4\", dt = 0.01 }\n");
    return read_scene((folder_ / "s.toml").string(), standard());
  }
  const ParticlesDescription& description(const Scene& from) const {
    return *static_cast<const ParticlesDescription*>(from.bodies[0].description.get());
  }
  XyzLines faults(const std::string& keys) const {
    return briefs_of([&] { (void)scene(keys); });
  }
  /// The text of the only one.
  std::string why(const std::string& keys) const {
    const auto fault = first_fault([&] { (void)scene(keys); });
    return fault ? fault->why : "";
  }
  void write_file(const std::string& name, const std::string& text) const {
    write(folder_ / name, text);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

constexpr const char* kMolecule =
    "3\nProperties=species:S:1:pos:R:3:mass:R:1:velo:R:3\nO 0 0 0 16 0 0 1\nH 1 0 0 1 0 0 2\n"
    "H 0 1 0 1 0 0 3\n";

TEST_F(ParticlesXyz, HaveSpeciesMassesAndVelocities) {
  write_file("m.xyz", kMolecule);
  const auto read = scene("file = \"m.xyz\"");
  const ParticlesDescription& d = description(*read);
  EXPECT_EQ(d.positions, (PointList{3, {0, 0, 0, 1, 0, 0, 0, 1, 0}}));
  EXPECT_EQ(d.particle_mass.values, (std::vector<double>{16, 1, 1}));
  EXPECT_EQ(d.species.names, (XyzLines{"O", "H", "H"}));
  EXPECT_EQ(d.velocity.values[2].components, (std::vector<double>{0, 0, 3}));
  EXPECT_EQ(read->species, (XyzLines{"O", "H"}));
  // All of it stands in the effective scene, which needs no file.
  std::filesystem::remove(folder_ / "m.xyz");
  const auto again = scene_of(read->effective_toml);
  EXPECT_EQ(again->effective_toml, read->effective_toml);
  EXPECT_EQ(description(*again).species, d.species);
  EXPECT_EQ(description(*again).velocity, d.velocity);
}

TEST_F(ParticlesXyz, YieldToTheKeysOfTheScene) {
  write_file("m.xyz", kMolecule);
  const auto read =
      scene("file = \"m.xyz\"\nspecies = \"Q\"\nparticle_mass = \"1 + i\"\nvelocity = [7, 8, 9]");
  const ParticlesDescription& d = description(*read);
  EXPECT_EQ(d.species.names, XyzLines{"Q"});
  EXPECT_EQ(d.particle_mass.values, (std::vector<double>{1, 2, 3}));
  ASSERT_EQ(d.velocity.values.size(), 1U);
  EXPECT_EQ(d.velocity.values[0].components, (std::vector<double>{7, 8, 9}));
  EXPECT_EQ(scene_of(read->effective_toml)->effective_toml, read->effective_toml);
}

TEST_F(ParticlesXyz, HaveMassesInTheUnitsOfTheScene) {
  write_file("m.xyz", kMolecule);
  const std::string metal = "[scene]\nunits = \"metal\"\n";
  const auto from_file = scene("file = \"m.xyz\"", metal);
  const auto from_key = scene("file = \"m.xyz\"\nparticle_mass = [16, 1, 1]", metal);
  EXPECT_LT(description(*from_file).particle_mass.values[0], 0.01);  // eV ps^2/Angstrom^2
  EXPECT_EQ(description(*from_file).particle_mass, description(*from_key).particle_mass);
  EXPECT_NE(from_file->effective_toml.find("particle_mass = [16.0, 1.0, 1.0]"), std::string::npos);
}

TEST_F(ParticlesXyz, HaveOneSpeciesWhereAllAreAlike) {
  write_file("c.XYZ.extxyz", "2\n\nC 0 0 0\nC 1 0 0\n1\n\nC 5 5 5\n");
  const auto read = scene("file = \"c.XYZ.extxyz\"\nparticle_mass = 1\nframe = 0");
  EXPECT_EQ(description(*read).species.names, XyzLines{"C"});
  EXPECT_EQ(description(*read).positions.count(), 2U);
  EXPECT_EQ(read->effective_toml.find("frame"), std::string::npos) << read->effective_toml;
  EXPECT_EQ(description(*scene("file = \"c.XYZ.extxyz\"\nparticle_mass = 1")).positions.count(),
            1U);
}

TEST_F(ParticlesXyz, BareColumnsMayHaveTheName) {
  for (const char* text : {"0 0 0\n1 0 0\n", "# x y z\n0 0 0\n1 0 0\n", "0.5, 0, 0\n1, 0, 0\n"}) {
    write_file("bare.xyz", text);
    EXPECT_EQ(description(*scene("file = \"bare.xyz\"\nparticle_mass = 1")).positions.count(), 2U);
  }
}

TEST_F(ParticlesXyz, FaultsHaveTheirPlaceInBothFiles) {
  write_file("m.xyz", "2\n\nC 0 0 0\nC 0 zero 0\n");
  EXPECT_EQ(faults("file = \"m.xyz\"\nparticle_mass = 1"),
            XyzLines{"3:8 body.particles.file = \"m.xyz\" [file.invalid]"});
  EXPECT_TRUE(
      why("file = \"m.xyz\"\nparticle_mass = 1").starts_with(path("m.xyz") + ":4: column 3"));
  write_file("m.xyz", "1\n\nC 0 0 0\n");
  EXPECT_EQ(faults("file = \"m.xyz\""),
            XyzLines{"1:1 body.particles.particle_mass [scene.missing_key]"});
  EXPECT_EQ(faults("file = \"m.xyz\"\nparticle_mass = 1\nframe = 1"),
            XyzLines{"3:8 body.particles.file = \"m.xyz\" [file.invalid]"});
  EXPECT_EQ(faults("file = \"m.xyz\"\nparticle_mass = 1\nframe = 0.5"),
            XyzLines{"5:9 body.particles.frame = 0.5 [scene.out_of_range]"});
  EXPECT_EQ(faults("file = \"m.xyz\"\nparticle_mass = 1\nspecies = [\"C\", \"C\"]"),
            XyzLines{"5:11 body.particles.species = [\"C\", \"C\"] [scene.wrong_count]"});
  EXPECT_EQ(faults("file = \"none.xyz\"\nparticle_mass = 1"),
            XyzLines{"3:8 body.particles.file = \"none.xyz\" [file.cannot_read]"});
  write_file("m.dat", "0 0 0\n");
  EXPECT_EQ(faults("file = \"m.dat\"\nparticle_mass = 1\nframe = 0"),
            XyzLines{"5:9 body.particles.frame = 0 [scene.conflict]"});
  // Messages do not show the contents of a file that is not of this format.
  write_file("key.xyz", "1\nProperties=TOPSECRET:S:1\nTOPSECRET\n");
  EXPECT_EQ(why("file = \"key.xyz\"\nparticle_mass = 1").find("TOPSECRET"), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
