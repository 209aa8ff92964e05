#include "framework/bodies/nanotube.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/framework/bodies/body_fixture.hpp"
#include "tests/framework/bodies/honeycomb_checks.hpp"

namespace tomlin::test {
namespace {

constexpr double kCarbon = 1.42;
/// A few roundings in tubes some tens of bonds long.
constexpr double kTubeRounding = 1e-13;

/// Zigzag, armchair and chiral tubes, and the smallest ones whose atoms do not coincide.
constexpr std::array<std::array<int, 2>, 13> kTubes = {{{10, 0},
                                                        {9, 0},
                                                        {3, 0},
                                                        {5, 5},
                                                        {2, 2},
                                                        {6, 6},
                                                        {4, 2},
                                                        {8, 2},
                                                        {7, 3},
                                                        {6, 4},
                                                        {5, 1},
                                                        {10, 9},
                                                        {9, 6}}};

std::string tube(int n, int m, const std::string& cells, const std::string& more = "") {
  return fmt::format("chirality = [{}, {}]\nbond_length = 1.42\n{}\n{}", n, m, cells, more);
}

/// The closed forms, in another way: by brute force and with the C library.
struct ClosedForms {
  double radius = 0.0;
  double cell = 0.0;
  std::size_t particles = 0;
};

ClosedForms closed_forms(int n, int m) {
  int divisor = 1;
  for (int k = 1; k <= 2 * n + m; ++k) {
    if ((2 * n + m) % k == 0 && (2 * m + n) % k == 0) divisor = k;
  }
  const double square = n * n + n * m + m * m;
  const double around = kCarbon * std::sqrt(3.0) * std::sqrt(square);
  return {around / (2.0 * std::acos(-1.0)), std::sqrt(3.0) * around / divisor,
          static_cast<std::size_t>(4 * (n * n + n * m + m * m) / divisor)};
}

/// Unrolled: along the circumference and along the axis x.
ParticlePositions unrolled(const ParticlePositions& positions, double radius) {
  ParticlePositions flat;
  for (const auto& x : positions) flat.push_back({radius * std::atan2(x[2], x[1]), x[0]});
  return flat;
}

TEST(Nanotube, HasTheClosedFormsOfItsChirality) {
  for (const auto& [n, m] : kTubes) {
    const ClosedForms expected = closed_forms(n, m);
    const BodyGeometry shape = shape_of("nanotube", tube(n, m, "cells = 3"));
    EXPECT_NEAR(shape.rolling_radius, expected.radius, kTubeRounding) << n << " " << m;
    ASSERT_EQ(shape.relative.size(), 3 * expected.particles) << n << " " << m;
    for (const auto& x : shape.relative) {
      EXPECT_NEAR(std::hypot(x[1], x[2]), expected.radius, kTubeRounding);
    }
    // A cell is the one before, moved along the axis.
    for (std::size_t i = expected.particles; i < shape.relative.size(); ++i) {
      const auto& here = shape.relative[i];
      const auto& before = shape.relative[i - expected.particles];
      EXPECT_NEAR(here[0] - before[0], expected.cell, kTubeRounding) << n << " " << m;
      EXPECT_EQ(here[1], before[1]);
      EXPECT_EQ(here[2], before[2]);
    }
  }
}

TEST(Nanotube, HasThreeNeighboursOfEachAtomAtTheBondLengthOfTheSheet) {
  for (const auto& [n, m] : kTubes) {
    const ClosedForms form = closed_forms(n, m);
    const int cells = static_cast<int>(std::ceil(8.0 / form.cell));
    const ParticlePositions positions =
        shape_of("nanotube", tube(n, m, "cells = " + std::to_string(cells))).relative;
    const ParticlePositions flat = unrolled(positions, form.radius);
    for (const bool periodic : {true, false}) {
      const double length = periodic ? cells * form.cell : 0.0;
      const std::vector<double> sheet = {kTau * form.radius, length};
      const auto near = pairs_within(flat, sheet, 1.2 * kCarbon);
      const auto numbers = partners(near, positions.size());
      if (periodic) {
        EXPECT_EQ(count_with(numbers, 3), positions.size()) << n << " " << m;
      }
      for (const auto& [i, j] : near) {
        const auto bond = to_nearest_image(flat[i], flat[j], sheet);
        EXPECT_NEAR(length_of(bond), kCarbon, kTubeRounding) << n << " " << m;
        // In space the arc becomes its chord.
        const double chord =
            std::hypot(2.0 * form.radius * std::sin(bond[0] / (2.0 * form.radius)), bond[1]);
        EXPECT_NEAR(length_of(to_nearest_image(positions[i], positions[j], {length, 0.0, 0.0})),
                    chord, kTubeRounding);
        EXPECT_LE(chord, kCarbon + kTubeRounding);
      }
      EXPECT_EQ(pairs_within(flat, sheet, std::sqrt(3.0) * kCarbon - 1e-9), near) << n << " " << m;
      EXPECT_EQ(
          bonds_of("nanotube", tube(n, m, "cells = " + std::to_string(cells)), {length, 0.0, 0.0}),
          near)
          << n << " " << m << (periodic ? " periodic" : "");
    }
  }
}

// An open tube: of a zigzag one each end atom has lost one bond, of an armchair one too.
TEST(Nanotube, EndsWithTwoNeighboursOfEachAtomThere) {
  for (const int n : {5, 6, 10}) {
    for (const int m : {0, n}) {
      const auto bonds = bonds_of("nanotube", tube(n, m, "cells = 4"));
      const auto numbers = partners(bonds, 16 * static_cast<std::size_t>(n));
      const auto cut = static_cast<std::size_t>(m == 0 ? n : 2 * n);
      EXPECT_EQ(bonds.size(), 24 * static_cast<std::size_t>(n) - cut);
      EXPECT_EQ(count_with(numbers, 2), 2 * cut);
      EXPECT_EQ(count_with(numbers, 3), numbers.size() - 2 * cut);
    }
  }
}

/// The sheet rolled up without whole numbers: all lattice points of a large parallelogram, those
/// kept whose position along the tube is in one cell, each once.
ParticlePositions rolled_up(int n, int m) {
  const ClosedForms form = closed_forms(n, m);
  const double a = std::sqrt(3.0) * kCarbon;
  const std::array<double, 2> chiral = {a * (n + 0.5 * m), a * 0.5 * std::sqrt(3.0) * m};
  const double around = std::hypot(chiral[0], chiral[1]);
  ParticlePositions found;
  const int reach = 6 * (n + m) + 6;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (const double part : {0.0, 1.0 / 3.0}) {
        const double x = a * (i + part + 0.5 * (j + part));
        const double y = a * 0.5 * std::sqrt(3.0) * (j + part);
        const double s = (x * chiral[0] + y * chiral[1]) / around;
        const double z = (y * chiral[0] - x * chiral[1]) / around;
        if (s < -1e-9 || s > around - 1e-9 || z < -1e-9 || z > form.cell - 1e-9) continue;
        found.push_back(
            {z, form.radius * std::cos(s / form.radius), form.radius * std::sin(s / form.radius)});
      }
    }
  }
  return found;
}

// From outside, axis up, the first lattice vector points right: neither is the other's image in a
// mirror. Tubes differ by a turn and a shift along the axis, which one atom gives.
TEST(Nanotube, IsTheSheetRolledUpWithItsHandedness) {
  for (const auto& [n, m] : kTubes) {
    if (n + m > 8) continue;  // every pair is looked at
    const ClosedForms form = closed_forms(n, m);
    const ParticlePositions expected = rolled_up(n, m);
    const ParticlePositions found = shape_of("nanotube", tube(n, m, "cells = 1")).relative;
    ASSERT_EQ(found.size(), expected.size()) << n << " " << m;
    const auto worst_after = [&](const std::vector<double>& from, double mirror) {
      const double turn = std::atan2(from[2], from[1]);
      double worst = 0.0;
      for (const auto& x : found) {
        const double y = std::cos(turn) * x[1] + std::sin(turn) * x[2];
        const double z = mirror * (std::cos(turn) * x[2] - std::sin(turn) * x[1]);
        double nearest = 1e300;
        for (const auto& candidate : expected) {
          nearest = std::min(nearest, length_of(to_nearest_image({x[0] - from[0], y, z}, candidate,
                                                                 {form.cell, 0.0, 0.0})));
        }
        worst = std::max(worst, nearest);
      }
      return worst;
    };
    // Both kinds of atoms are among the first eight.
    const auto best = [&](double mirror) {
      double least = 1e300;
      for (std::size_t i = 0; i < 8; ++i) least = std::min(least, worst_after(found[i], mirror));
      return least;
    };
    EXPECT_LT(best(1.0), 1e-12) << n << " " << m;
    if (m > 0 && m < n) {
      EXPECT_GT(best(-1.0), 0.1) << n << " " << m;
    }
  }
}

TEST(Nanotube, LiesAlongAnyAxisAndIsRolledCounterClockwise) {
  const ParticlePositions along_x = shape_of("nanotube", tube(4, 2, "cells = 1")).relative;
  const ParticlePositions along_y =
      shape_of("nanotube", tube(4, 2, "cells = 1", "axis = \"y\"")).relative;
  const ParticlePositions along_z =
      shape_of("nanotube", tube(4, 2, "cells = 1", "axis = \"z\"")).relative;
  const ParticlePositions rolled =
      shape_of("nanotube", tube(4, 2, "cells = 1", "roll = 0.3")).relative;
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    const auto& x = along_x[i];
    EXPECT_EQ(along_y[i], (std::vector<double>{x[2], x[0], x[1]}));
    EXPECT_EQ(along_z[i], (std::vector<double>{x[1], x[2], x[0]}));
    EXPECT_EQ(rolled[i][0], x[0]);
    EXPECT_NEAR(rolled[i][1], std::cos(0.3) * x[1] - std::sin(0.3) * x[2], kTubeRounding);
    EXPECT_NEAR(rolled[i][2], std::sin(0.3) * x[1] + std::cos(0.3) * x[2], kTubeRounding);
  }
  for (const auto& [n, m] : kTubes) {
    const BodyGeometry shape = shape_of("nanotube", tube(n, m, "cells = 2", "centre = [1, 2, 3]"));
    EXPECT_EQ(shape.anchor, (std::vector<double>{1.0, 2.0, 3.0}));
    for (const double mean : mean_of(shape)) EXPECT_NEAR(mean, 0.0, kTubeRounding) << n << " " << m;
    // Without a roll some atom is in the direction of the next axis.
    const auto is_there = [&](const std::vector<double>& x) {
      return x[2] == 0.0 && x[1] == shape.rolling_radius;
    };
    EXPECT_TRUE(std::any_of(shape.relative.begin(), shape.relative.end(), is_there));
  }
  EXPECT_EQ(shape_of("nanotube", tube(4, 2, "cells = 1")).anchor, std::vector<double>(3, 0.0));
}

// The tube of the paper: (10,0), 100 Angstrom long, ten atoms in each ring; with half the zigzag
// period of the sheet as unit of length its radius is 10/pi, which the paper has as 3.1910.
TEST(Nanotube, IsThatOfThePaper) {
  const BodyGeometry shape = shape_of("nanotube", tube(10, 0, "length = 100"));
  EXPECT_EQ(shape.relative.size(), 23U * 40U);
  const double half_period = 0.5 * std::sqrt(3.0) * kCarbon;
  EXPECT_NEAR(shape.rolling_radius / half_period, 10.0 / (0.5 * kTau), kTubeRounding);
  EXPECT_NEAR(shape.rolling_radius / half_period, 3.1910, 0.01);
  std::vector<double> heights;
  for (const auto& x : shape.relative) heights.push_back(x[0]);
  std::sort(heights.begin(), heights.end());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    EXPECT_EQ(heights[i], heights[i - i % 10]) << "rings of ten";
    if (i % 10 != 0 || i == 0) continue;
    const double gap = heights[i] - heights[i - 1];
    EXPECT_NEAR(gap, (i / 10) % 2 == 1 ? 0.5 * kCarbon : kCarbon, kTubeRounding);
  }
}

TEST(Nanotube, FillsALengthWithWholeCells) {
  const auto count = [](int n, int m, const std::string& length) {
    return shape_of("nanotube", tube(n, m, "length = " + length)).relative.size();
  };
  EXPECT_EQ(count(10, 0, "4.26"), 40U);
  EXPECT_EQ(count(10, 0, "4.27"), 40U);
  EXPECT_EQ(count(10, 0, "8.5"), 40U);
  EXPECT_EQ(count(10, 0, "\"7 * (3 * 1.42)\""), 7U * 40U);
  EXPECT_EQ(count(5, 5, "\"3 * 1.42 * 7 / sqrt(3)\""), 7U * 20U);
  EXPECT_EQ(count(4, 2, "\"3 * 1.42 * sqrt(7) * 5 * (1 - 1e-6)\""), 4U * 56U);
}

// Cells by number along the axis, and in each cell eight consecutive atoms within a box whose
// diagonal is at most about seven bonds: two slabs of three bonds, and half a group around.
TEST(Nanotube, KeepsEightConsecutiveAtomsTogether) {
  for (const auto& [n, m] : kTubes) {
    ParticlePositions positions = shape_of("nanotube", tube(n, m, "length = 80")).relative;
    const double limit = 7.0 * kCarbon;
    EXPECT_LE(largest_group_of_eight(positions), limit) << n << " " << m;
    // The control: in another order they are not.
    std::shuffle(positions.begin(), positions.end(), std::mt19937_64(11));
    EXPECT_GT(largest_group_of_eight(positions), 2.0 * limit) << n << " " << m;
  }
}

TEST(Nanotube, TellsTheLengthOfABoxThatItFills) {
  const std::string note = note_of("nanotube", tube(4, 2, "cells = 3", "axis = \"z\""));
  const ClosedForms form = closed_forms(4, 2);
  EXPECT_NE(note.find(fmt::format("radius {:.6g}", form.radius)), std::string::npos) << note;
  EXPECT_NE(note.find("with 56 particles each"), std::string::npos) << note;
  EXPECT_NE(note.find(fmt::format("{:.12g}", 3.0 * form.cell)), std::string::npos) << note;
  EXPECT_NE(note.find("along z"), std::string::npos) << note;
}

TEST(Nanotube, FaultsHaveTheirPlace) {
  using Lines = std::vector<std::string>;
  const auto faults = [](const std::string& keys) { return faults_with("nanotube", keys); };
  EXPECT_EQ(faults(tube(10, 0, "cells = 1")), Lines());
  for (const char* chirality :
       {"[0, 0]", "[5, 6]", "[5, 2.5]", "[5.5, 2]", "[5]", "5", "[5, 2, 1]"}) {
    EXPECT_EQ(
        faults("bond_length = 1\ncells = 1\nchirality = " + std::string(chirality)),
        Lines{"5:13 body.nanotube.chirality = " + std::string(chirality) + " [component.invalid]"});
  }
  EXPECT_EQ(faults(tube(5, -1, "cells = 1")),
            Lines{"3:17 body.nanotube.chirality = -1 [scene.out_of_range]"});
  EXPECT_EQ(faults(tube(2000000, 0, "cells = 1")),
            Lines{"3:14 body.nanotube.chirality = 2000000 [scene.out_of_range]"});
  EXPECT_EQ(faults("bond_length = 1\ncells = 1"),
            Lines{"1:1 body.nanotube.chirality [scene.missing_key]"});
  EXPECT_EQ(faults(tube(5, 1, "")), Lines{"1:1 body.nanotube.cells [scene.missing_key]"});
  EXPECT_EQ(faults(tube(5, 1, "cells = 1\nlength = 90")),
            Lines{"6:10 body.nanotube.length = 90 [scene.conflict]"});
  EXPECT_EQ(faults(tube(5, 1, "cells = 0")),
            Lines{"5:9 body.nanotube.cells = 0 [scene.out_of_range]"});
  EXPECT_EQ(faults(tube(5, 1, "cells = 1.5")),
            Lines{"5:9 body.nanotube.cells = 1.5 [scene.out_of_range]"});
  EXPECT_EQ(faults(tube(5, 1, "length = 20")),
            Lines{"5:10 body.nanotube.length = 20 [scene.out_of_range]"})
      << "a cell is 23.7 long";
  EXPECT_EQ(faults(tube(5, 1, "cells = 1", "axis = \"w\"")),
            Lines{"6:8 body.nanotube.axis = \"w\" [scene.unknown_choice]"});
  EXPECT_EQ(faults(tube(5, 1, "cells = 1", "roll = 7")),
            Lines{"6:8 body.nanotube.roll = 7 [scene.out_of_range]"});
  EXPECT_EQ(faults(tube(5, 1, "cells = 1", "centre = [0, 0]")),
            Lines{"6:10 body.nanotube.centre = [0, 0] [scene.wrong_count]"});
  EXPECT_EQ(faults(tube(999999, 999998, "cells = 1000000000000")),
            Lines{"5:9 body.nanotube.cells = 1000000000000 [scene.too_large]"});
  EXPECT_EQ(faults(tube(10, 0, "length = 1e300")),
            Lines{"5:10 body.nanotube.length = 1e300 [scene.too_large]"});
}

TEST(Nanotube, StandsInTheEffectiveScene) {
  EXPECT_TRUE(effective_scene_keeps(
      "nanotube", tube(7, 3, "length = 50", "roll = \"pi / 7\"\naxis = \"y\"\nspecies = \"C\"")));
}

}  // namespace
}  // namespace tomlin::test
