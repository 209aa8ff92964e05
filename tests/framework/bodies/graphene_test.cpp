#include "framework/bodies/graphene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/framework/bodies/body_fixture.hpp"
#include "tests/framework/bodies/honeycomb_checks.hpp"

namespace tomlin::test {
namespace {

constexpr double kBond = 1.42;
/// A few roundings in sheets some tens of bonds wide.
constexpr double kSheetRounding = 1e-13;

std::string sheet(int along_x, int along_y, const std::string& more = "") {
  return "bond_length = 1.42\ncells = [" + std::to_string(along_x) + ", " +
         std::to_string(along_y) + "]\n" + more;
}

/// Lengths of the periodic box by the formula of the page.
std::vector<double> box_of_sheet(int along_x, int along_y, bool armchair_along_x = true) {
  const double armchair = 3.0 * kBond;
  const double zigzag = std::sqrt(3.0) * kBond;
  return {along_x * (armchair_along_x ? armchair : zigzag),
          along_y * (armchair_along_x ? zigzag : armchair), 0.0};
}

std::array<double, 3> as_array(const std::vector<double>& box) { return {box[0], box[1], box[2]}; }

TEST(Graphene, HasThreeNeighboursOfEachAtomAtTheBondLengthInAPeriodicBox) {
  for (const auto& [along_x, along_y] : {std::array{1, 2}, {1, 5}, {4, 6}, {3, 7}, {5, 2}}) {
    for (const bool along : {true, false}) {
      const std::string keys = sheet(along ? along_x : along_y, along ? along_y : along_x,
                                     along ? "" : "armchair = \"y\"");
      const auto box = box_of_sheet(along ? along_x : along_y, along ? along_y : along_x, along);
      const ParticlePositions positions = shape_of("graphene", keys).relative;
      ASSERT_EQ(positions.size(), 4U * along_x * along_y);
      const auto near = pairs_within(positions, box, 1.2 * kBond);
      EXPECT_EQ(count_with(partners(near, positions.size()), 3), positions.size()) << keys;
      for (const auto& [i, j] : near) {
        EXPECT_NEAR(length_of(to_nearest_image(positions[i], positions[j], box)), kBond,
                    kSheetRounding);
      }
      // No atom is nearer than the second neighbours but these.
      EXPECT_EQ(pairs_within(positions, box, std::sqrt(3.0) * kBond - 1e-9), near) << keys;
      EXPECT_EQ(bonds_of("graphene", keys, as_array(box)), near) << keys;
    }
  }
}

// Each edge cuts one bond of each of its particles; two of the four corners are cut twice.
TEST(Graphene, EndsInEdgesOfTwoNeighboursEach) {
  for (const auto& [along_x, along_y] : {std::array{1, 1}, {1, 4}, {6, 1}, {4, 5}}) {
    const ParticlePositions positions = shape_of("graphene", sheet(along_x, along_y)).relative;
    const auto near = pairs_within(positions, {0.0, 0.0, 0.0}, 1.2 * kBond);
    EXPECT_EQ(bonds_of("graphene", sheet(along_x, along_y)), near);
    const auto numbers = partners(near, positions.size());
    EXPECT_EQ(near.size(), 6U * along_x * along_y - along_y - 2U * along_x);
    EXPECT_EQ(count_with(numbers, 1), 2U);
    EXPECT_EQ(count_with(numbers, 0), 0U);
    EXPECT_EQ(count_with(numbers, 2), 4U * along_x + 2U * along_y - 4U);
    // Closed along one axis alone.
    const auto box = box_of_sheet(along_x, along_y);
    for (const std::size_t axis : {0U, 1U}) {
      if (axis == 1 && along_y < 2) continue;  // both neighbours would be one
      std::vector<double> one(3, 0.0);
      one[axis] = box[axis];
      EXPECT_EQ(bonds_of("graphene", sheet(along_x, along_y), as_array(one)),
                pairs_within(positions, one, 1.2 * kBond));
    }
  }
}

TEST(Graphene, IsOpenInABoxThatItDoesNotFill) {
  const auto open = bonds_of("graphene", sheet(3, 4));
  std::array<double, 3> box = as_array(box_of_sheet(3, 4));
  for (double& length : box) length *= 1.0 + 1e-6;
  EXPECT_EQ(bonds_of("graphene", sheet(3, 4), box), open);
  for (double& length : box) length /= (1.0 + 1e-6) * (1.0 + 1e-12);
  EXPECT_EQ(bonds_of("graphene", sheet(3, 4), box).size(), 3U * 4U * 6U);
}

TEST(Graphene, IsFlatAndAboutItsCentre) {
  const BodyGeometry plain = shape_of("graphene", sheet(3, 5));
  EXPECT_EQ(plain.anchor, std::vector<double>(3, 0.0));
  for (const double mean : mean_of(plain)) EXPECT_NEAR(mean, 0.0, kSheetRounding);
  for (const auto& particle : plain.relative) EXPECT_EQ(particle[2], 0.0);
  const BodyGeometry moved = shape_of("graphene", sheet(3, 5, "centre = [1e9, 2, -3]"));
  EXPECT_EQ(moved.anchor, (std::vector<double>{1e9, 2.0, -3.0}));
  EXPECT_EQ(moved.relative, plain.relative);
  EXPECT_EQ(plain.rolling_radius, 0.0);
}

TEST(Graphene, HasItsArmchairDirectionAlongEitherAxis) {
  const ParticlePositions along_x = shape_of("graphene", sheet(3, 5)).relative;
  const ParticlePositions along_y = shape_of("graphene", sheet(5, 3, "armchair = \"y\"")).relative;
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    EXPECT_EQ(along_x[i][0], along_y[i][1]);
    EXPECT_EQ(along_x[i][1], along_y[i][0]);
  }
  // A bond is along it.
  const auto bond = to_nearest_image(along_x[1], along_x[2], {0.0, 0.0, 0.0});
  EXPECT_NEAR(bond[0], kBond, kSheetRounding);
  EXPECT_EQ(bond[1], 0.0);
}

TEST(Graphene, FillsASizeWithWholeCells) {
  const auto count = [](const std::string& size) {
    return shape_of("graphene", "bond_length = 1.42\nsize = " + size).relative.size();
  };
  EXPECT_EQ(count("[4.27, 2.46]"), 4U);
  EXPECT_EQ(count("[8.51, 2.46]"), 4U);
  // However a whole number of cells is rounded.
  EXPECT_EQ(count("[\"3 * 1.42 * 7\", \"sqrt(3) * 1.42 * 9\"]"), 4U * 7U * 9U);
  EXPECT_EQ(count("[\"7 * (3 * 1.42)\", \"9 * 1.42 * sqrt(3)\"]"), 4U * 7U * 9U);
  EXPECT_EQ(count("[\"7 * (3 * 1.42) * (1 - 1e-6)\", 2.46]"), 4U * 6U);
  // The paper's sheet, 100 x 500 Angstrom: 23 cells of 4.26 and 203 of 2.4595.
  EXPECT_EQ(count("[100, 500]"), 4U * 23U * 203U);
}

// Two cells that share a side are 5/2 b x 3/2 sqrt(3) b in a row, where it turns 5 b x sqrt(3)/2 b.
TEST(Graphene, KeepsEightConsecutiveAtomsTogether) {
  const double turn = std::hypot(5.0, std::sqrt(0.75)) * kBond;
  for (const auto& [along_x, along_y] : {std::array{5, 8}, {5, 7}, {1, 9}, {9, 1}, {8, 3}}) {
    ParticlePositions positions = shape_of("graphene", sheet(along_x, along_y)).relative;
    EXPECT_LE(largest_group_of_eight(positions), turn + kSheetRounding);
    // The control: in another order they are not.
    std::shuffle(positions.begin(), positions.end(), std::mt19937_64(7));
    EXPECT_GT(largest_group_of_eight(positions), 1.2 * turn);
  }
  const ParticlePositions even = shape_of("graphene", sheet(5, 8)).relative;
  EXPECT_LE(largest_group_of_eight(even), std::hypot(2.0, std::sqrt(6.75)) * kBond + 1e-9);
}

TEST(Graphene, TellsTheLengthsOfABoxThatItFills) {
  const std::string note = note_of("graphene", sheet(4, 6));
  const auto box = box_of_sheet(4, 6);
  EXPECT_NE(note.find(fmt::format("lengths {:.12g} along x", box[0])), std::string::npos) << note;
  EXPECT_NE(note.find("and 14.7570728805 along y"), std::string::npos) << note;
  EXPECT_NEAR(box[1], 14.7570728805, 1e-10);
}

TEST(Graphene, FaultsHaveTheirPlace) {
  using Lines = std::vector<std::string>;
  const auto faults = [](const std::string& keys) { return faults_with("graphene", keys); };
  EXPECT_EQ(faults(sheet(2, 3)), Lines());
  EXPECT_EQ(faults("bond_length = 1.42"), Lines{"1:1 body.graphene.cells [scene.missing_key]"});
  EXPECT_EQ(faults("cells = [2, 3]"), Lines{"1:1 body.graphene.bond_length [scene.missing_key]"});
  EXPECT_EQ(faults(sheet(2, 3, "size = [9, 9]")),
            Lines{"5:8 body.graphene.size = [9, 9] [scene.conflict]"});
  EXPECT_EQ(faults("bond_length = 1\ncells = [2]"),
            Lines{"4:9 body.graphene.cells = [2] [scene.wrong_count]"});
  EXPECT_EQ(faults("bond_length = 1\nsize = [9, 9, 9]"),
            Lines{"4:8 body.graphene.size = [9, 9, 9] [scene.wrong_count]"});
  EXPECT_EQ(faults("bond_length = 1\ncells = [2, 2.5]"),
            Lines{"4:9 body.graphene.cells = [2, 2.5] [scene.out_of_range]"});
  EXPECT_EQ(faults(sheet(0, 3)), Lines{"4:10 body.graphene.cells = 0 [scene.out_of_range]"});
  EXPECT_EQ(faults("bond_length = 1\nsize = [9, 1]"),
            Lines{"4:8 body.graphene.size = [9, 1] [scene.out_of_range]"});
  EXPECT_EQ(faults("bond_length = 0\ncells = [1, 1]"),
            Lines{"3:15 body.graphene.bond_length = 0 [scene.out_of_range]"});
  EXPECT_EQ(faults(sheet(2, 3, "armchair = \"z\"")),
            Lines{"5:12 body.graphene.armchair = \"z\" [scene.unknown_choice]"});
  EXPECT_EQ(faults(sheet(2, 3, "centre = [0, 0]")),
            Lines{"5:10 body.graphene.centre = [0, 0] [scene.wrong_count]"});
  EXPECT_EQ(faults(sheet(30000, 40000)),
            Lines{"4:9 body.graphene.cells = [30000, 40000] [scene.too_large]"});
  EXPECT_EQ(faults("bond_length = 1e-300\nsize = [1e300, 1e300]"),
            Lines{"4:8 body.graphene.size = [1e300, 1e300] [scene.too_large]"});
  // Beside a body of the plane.
  const std::string ring =
      "[[body]]\ntype = \"ring\"\ncount = 3\nradius = 1\ncentre = [0, 0]\nparticle_mass = 1\n";
  EXPECT_EQ(briefs_of([&] { (void)scene_of(ring + one_body("graphene", sheet(2, 3))); }),
            Lines{"8:8 body.graphene.type = \"graphene\" [scene.wrong_count]"});
}

TEST(Graphene, StandsInTheEffectiveScene) {
  EXPECT_TRUE(effective_scene_keeps("graphene", sheet(2, 3, "species = \"C\"")));
  EXPECT_TRUE(effective_scene_keeps(
      "graphene",
      "bond_length = 1.42\nsize = [\"3 * 4\", 9]\narmchair = \"y\"\ncentre = [1, 2, 3]"));
}

// In a sheet without edges all bonds pull alike, and nothing moves; with edges it shrinks.
TEST(Graphene, IsBondedThroughAPeriodicBox) {
  constexpr double kStiffness = 2.0;
  constexpr double kStretch = 0.1;
  const auto energy = [&](const std::string& more) {
    const RunResult result = run_text(
        one_body("graphene", sheet(2, 3),
                 "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 2\n"
                 "rest_lengths = 1.32\n" +
                     more),
        {{"run.ledger", "true"}});
    return result.group("energy")["potential"].value();
  };
  const double of_a_bond = 0.5 * kStiffness * kStretch * kStretch;
  EXPECT_NEAR(energy("[box]\nlengths = [\"6 * 1.42\", \"3 * sqrt(3) * 1.42\", 9]\n"
                     "periodic = [true, true, false]\n"),
              36.0 * of_a_bond, 1e-12);
  EXPECT_LT(energy(""), 29.0 * of_a_bond - 1e-6);
}

}  // namespace
}  // namespace tomlin::test
