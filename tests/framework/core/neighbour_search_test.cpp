#include "framework/core/elements/neighbour_search.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

// The search by cells against looking at all particles.

namespace tomlin {
namespace {

constexpr unsigned kSeedsOfPoints[] = {1, 27, 20261126};

struct BoxOfPoints {
  int dimension;
  std::array<double, 3> box;  // 0: not periodic
  double spread;              // of the positions, beyond the box too
  double middle;
  std::size_t count;
};

/// Finds neighbours among all particles, by the nearest image.
std::vector<Neighbour> all_within(double reach, const BoxOfPoints& c,
                                  const std::vector<double>& positions,
                                  const std::array<double, 3>& position) {
  std::vector<Neighbour> found;
  for (std::size_t j = 0; j < c.count; ++j) {
    Neighbour near;
    near.particle = static_cast<std::uint32_t>(j);
    double squared = 0.0;
    for (int d = 0; d < c.dimension; ++d) {
      double apart = positions[d * c.count + j] - position[d];
      if (c.box[d] > 0.0) {
        near.shift[d] = -c.box[d] * std::floor(apart / c.box[d] + 0.5);
        apart += near.shift[d];
      }
      squared += apart * apart;
    }
    if (squared <= reach * reach) found.push_back(near);
  }
  return found;
}

TEST(NeighbourSearch, FindsWhatLookingAtAllFinds) {
  const BoxOfPoints cases[] = {
      {1, {0.0, 0.0, 0.0}, 40.0, 0.0, 200},   {1, {11.0, 0.0, 0.0}, 60.0, 5.0, 100},
      {2, {0.0, 0.0, 0.0}, 12.0, -3.0, 300},  {2, {7.0, 0.0, 0.0}, 20.0, 1e4, 300},
      {2, {2.0, 4.2, 0.0}, 9.0, 0.0, 150},    {3, {0.0, 0.0, 0.0}, 5.0, 0.0, 400},
      {3, {6.0, 2.0, 3.1}, 30.0, 100.0, 400}, {3, {0.0, 9.0, 0.0}, 1e8, 0.0, 300},
      {3, {4.5, 5.5, 0.0}, 6.0, -50.0, 400}};
  constexpr double kReach = 1.0;
  std::size_t neighbours = 0;
  for (const BoxOfPoints& c : cases) {
    for (const unsigned seed : kSeedsOfPoints) {
      std::mt19937_64 random(seed);
      std::uniform_real_distribution<double> uniform(c.middle - c.spread / 2.0,
                                                     c.middle + c.spread / 2.0);
      std::vector<double> positions(static_cast<std::size_t>(c.dimension) * c.count);
      for (double& x : positions) x = uniform(random);
      NeighbourSearch search(c.dimension, kReach, c.box);
      search.sort(positions, c.count);
      std::vector<Neighbour> found;
      for (std::size_t i = 0; i < c.count; ++i) {
        std::array<double, 3> position{};
        for (int d = 0; d < c.dimension; ++d) position[d] = positions[d * c.count + i];
        search.find(position, found);
        const std::vector<Neighbour> expected = all_within(kReach, c, positions, position);
        ASSERT_EQ(found.size(), expected.size()) << "particle " << i << ", seed " << seed;
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_EQ(found[k].particle, expected[k].particle);
          EXPECT_EQ(found[k].shift, expected[k].shift);
        }
        neighbours += found.size() - 1;
      }
    }
  }
  EXPECT_GT(neighbours, 10000U);  // there was something to find
}

TEST(NeighbourSearch, PlacesThatAreNoNumbersAreNearNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  NeighbourSearch search(3, 1.0, {0.0, 5.0, 0.0});
  search.sort({0.0, nan, infinity, 1e300, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
              5);
  std::vector<Neighbour> found;
  search.find({0.0, 0.0, 0.0}, found);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].particle, 0U);
  EXPECT_EQ(found[1].particle, 4U);
  search.find({nan, 0.0, 0.0}, found);
  EXPECT_TRUE(found.empty());
  search.find({1e300, 0.0, 0.0}, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].particle, 3U);
}

}  // namespace
}  // namespace tomlin
