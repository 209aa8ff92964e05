#include "framework/output/extended_xyz.hpp"

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/text/xyz_file.hpp"
#include "framework/output/number_text.hpp"
#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/output/trajectory_fixture.hpp"

namespace tomlin::test {
namespace {

namespace fs = std::filesystem;

void write_file(const fs::path& file, const RunLayout& layout, std::size_t frames) {
  ExtendedXyzWriter writer(file, layout, some_facts());
  write_frames(writer, layout, frames);
  writer.finish();
}

TEST(ExtendedXyz, IsOneFrameAfterAnother) {
  const TemporaryFolder folder;
  RunLayout layout = two_bodies();
  ExtendedXyzWriter writer(folder / "t.xyz", layout, some_facts());
  writer.frame(std::vector<double>{0.0, 9.0, 1.0, 2.0, 0.1, -4.0, 5.0, 6.0, 7.0, 8e300});
  writer.frame(std::vector<double>{0.5, 9.0, 1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0});
  writer.finish();
  const std::string head =
      "4\nProperties=species:S:1:pos:R:3:body:I:1 Lattice=\"7.5 0 0 0 0 0 0 0 0\" pbc=\"T F F\" "
      "bodies=\"ring tip\" units=reduced dimension=2 scene=\"a \\\"test\\\"\" ";
  EXPECT_EQ(content(folder / "t.xyz"),
            head + "time=0\nX 1 2 0 0\nX 0.10000000000000001 -4 0 0\nX 5 6 0 0\n" +
                "X 7 8.0000000000000004e+300 0 1\n" + head +
                "time=0.5\nX 1 2 0 0\nX 3 -4 0 0\nX 5 6 0 0\nX 7 8 0 1\n");
}

TEST(ExtendedXyz, HasNoLatticeWithoutAPeriodicBox) {
  const TemporaryFolder folder;
  write_file(folder / "t.xyz", line_of(2), 1);
  const std::string text = content(folder / "t.xyz");
  EXPECT_EQ(text.find("Lattice"), std::string::npos);
  EXPECT_NE(text.find("pbc=\"F F F\""), std::string::npos);
}

TEST(ExtendedXyz, ReadsBackAsTheSameBits) {
  constexpr std::size_t kParticles = 3000;
  constexpr std::size_t kFrames = 7;
  const TemporaryFolder folder;
  write_file(folder / "t.xyz", line_of(kParticles), kFrames);
  std::istringstream text(content(folder / "t.xyz"));
  std::string line;
  for (std::size_t f = 0; f < kFrames; ++f) {
    ASSERT_TRUE(std::getline(text, line));
    EXPECT_EQ(line, std::to_string(kParticles));
    ASSERT_TRUE(std::getline(text, line));
    EXPECT_EQ(std::strtod(line.c_str() + line.find("time=") + 5, nullptr), time_of(f));
    for (std::size_t i = 0; i < kParticles; ++i) {
      std::string species;
      std::string x;
      std::string rest;
      text >> species >> x;
      std::getline(text, rest);
      ASSERT_EQ(species, "X");
      ASSERT_EQ(std::strtod(x.c_str(), nullptr), position_of(f, i));
      ASSERT_EQ(rest, " 0 0 0");
    }
  }
  EXPECT_FALSE(std::getline(text, line));
}

TEST(ExtendedXyz, NamesSpeciesAndIsReadAsItWasWritten) {
  const TemporaryFolder folder;
  write_file(folder / "t.xyz", with_species(), 3);
  const std::string text = content(folder / "t.xyz");
  for (std::int64_t f = 0; f < 3; ++f) {
    const XyzFrame frame = parse_xyz(text, "t.xyz", f);
    ASSERT_EQ(frame.faults, std::vector<std::string>());
    EXPECT_EQ(frame.dimension, 2U);
    EXPECT_EQ(frame.species, (std::vector<std::string>{"H", "C", "C", "X"}));
    ASSERT_EQ(frame.positions.size(), 8U);
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_EQ(frame.positions[k], position_of(static_cast<std::size_t>(f), k));
    }
  }
  EXPECT_GE(xyz_bytes_per_frame(with_species(), some_facts()), text.size() / 3);
  RunLayout space = line_of(1);
  space.dimension = 3;
  write_file(folder / "space.xyz", space, 1);
  EXPECT_EQ(content(folder / "space.xyz").find("dimension"), std::string::npos);
  EXPECT_EQ(parse_xyz(content(folder / "space.xyz"), "t.xyz", -1).dimension, 3U);
}

/// Another way to the same text: numbers of all sizes, seventeen digits.
TEST(NumberText, IsThatOfPrintf) {
  std::uint64_t bits = 0x9e3779b97f4a7c15U;
  for (int k = 0; k < 100000; ++k) {
    bits = bits * 6364136223846793005U + 1442695040888963407U;
    double number = 0.0;
    static_assert(sizeof number == sizeof bits);
    std::memcpy(&number, &bits, sizeof bits);
    if (!std::isfinite(number)) continue;
    std::string text = "behind ";
    append_number(text, number);
    char expected[64];
    std::snprintf(expected, sizeof expected, "behind %.17g", number);
    ASSERT_EQ(text, expected);
    ASSERT_EQ(text, fmt::format("behind {:.17g}", number));
  }
  for (const double number : {0.0, -0.0, 5e-324, -1.7976931348623157e308, 1e17, 1e16, 1e-4, 1e-5}) {
    std::string text;
    append_number(text, number);
    EXPECT_EQ(text, fmt::format("{:.17g}", number));
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), number);
  }
}

}  // namespace
}  // namespace tomlin::test
