#include "framework/bodies/polygon.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/framework/bodies/body_fixture.hpp"

namespace tomlin::test {
namespace {

/// Some roundings of numbers of order one.
constexpr double kSomeRoundings = 2e-15;

std::string polygon(int corners, int count, const std::string& more = "") {
  return "corners = " + std::to_string(corners) + "\ncount = " + std::to_string(count) +
         "\nradius = 1.7\ncentre = [0, 0]\n" + more;
}

BodyGeometry polygon_shape(int corners, int count, const std::string& more = "") {
  return shape_of("polygon", polygon(corners, count, more));
}

TEST(Polygon, WithAParticleAtEachCornerAloneIsARing) {
  for (const int count : {3, 4, 6, 7, 100}) {
    const BodyGeometry ring =
        shape_of("ring", "radius = 1.7\ncentre = [0, 0]\ncount = " + std::to_string(count));
    const BodyGeometry found = polygon_shape(count, count);
    for (std::size_t i = 0; i < ring.relative.size(); ++i) {
      EXPECT_TRUE(same_bits(found.relative[i], ring.relative[i])) << count << " " << i;
    }
  }
}

TEST(Polygon, ParticlesAreEquallySpacedAlongItsEdges) {
  for (const int corners : {3, 4, 5, 12}) {
    for (const int on_edge : {1, 2, 3, 10}) {
      const BodyGeometry found = polygon_shape(corners, corners * on_edge);
      const std::size_t count = found.relative.size();
      const double edge = 2.0 * 1.7 * std::sin(kTau / 2 / corners);
      for (std::size_t i = 0; i < count; ++i) {
        const auto& from = found.relative[i];
        const auto& to = found.relative[(i + 1) % count];
        EXPECT_NEAR(std::hypot(to[0] - from[0], to[1] - from[1]), edge / on_edge, kSomeRoundings);
      }
      EXPECT_NEAR(found.rolling_radius * kTau, corners * edge, 10.0 * kSomeRoundings);
      EXPECT_NEAR(found.rolling_rise, 1.7 - 1.7 * std::cos(kTau / 2 / corners), kSomeRoundings);
      EXPECT_NEAR(mean_of(found)[0], 0.0, kSomeRoundings);
      EXPECT_NEAR(mean_of(found)[1], 0.0, kSomeRoundings);
    }
  }
}

// With m particles an edge, each at a part t = j/m of it, the mean of t (1 - t) is (1 - 1/m^2)/6.
TEST(Polygon, HasTheInertiaOfItsParticles) {
  for (const int corners : {3, 4, 9}) {
    for (const int on_edge : {1, 2, 5}) {
      const double sine = std::sin(kTau / 2 / corners);
      const double count = corners * on_edge;
      const double expected =
          count * 1.7 * 1.7 * (1.0 - 2.0 / 3.0 * (1.0 - 1.0 / (on_edge * on_edge)) * sine * sine);
      EXPECT_NEAR(inertia_of("polygon", polygon(corners, corners * on_edge)), expected,
                  1e-14 * expected);
    }
  }
}

TEST(Polygon, IsTurnedByItsOrientation) {
  // A square that stands on an edge.
  const BodyGeometry found = polygon_shape(4, 4, "orientation = \"pi / 4\"");
  const double half = 1.7 / std::sqrt(2.0);
  const std::vector<std::vector<double>> expected = {
      {half, half}, {-half, half}, {-half, -half}, {half, -half}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.relative[i][0], expected[i][0], kSomeRoundings);
    EXPECT_NEAR(found.relative[i][1], expected[i][1], kSomeRoundings);
  }
}

TEST(Polygon, FaultsHaveTheirPlace) {
  const auto faults = [](const std::string& keys) {
    return faults_with("polygon", keys + "\nradius = 1\ncentre = [0, 0]");
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(faults("corners = 4\ncount = 12"), Lines());
  EXPECT_EQ(faults("corners = 2\ncount = 4"),
            Lines{"3:11 body.polygon.corners = 2 [scene.out_of_range]"});
  EXPECT_EQ(faults("corners = 4\ncount = 10"),
            Lines{"4:9 body.polygon.count = 10 [scene.wrong_count]"});
  EXPECT_EQ(faults("corners = 4.5\ncount = 8"),
            Lines{"3:11 body.polygon.corners = 4.5 [scene.out_of_range]"});
  EXPECT_EQ(faults_with("polygon", "corners = 3\ncount = 3\nradius = 1\ncentre = [0]"),
            Lines{"6:10 body.polygon.centre = [0] [scene.wrong_count]"});
  const auto admissible = [](int count) {
    const auto fault = first_fault([&] { (void)scene_of(one_body("polygon", polygon(4, count))); });
    return fault ? fault->admissible : "";
  };
  EXPECT_EQ(admissible(10), "8 or 12 or another multiple");
  EXPECT_EQ(admissible(3), "4 or another multiple");
}

TEST(Polygon, StandsInTheEffectiveSceneAndTakesSettings) {
  EXPECT_TRUE(effective_scene_keeps("polygon", polygon(5, 15, "orientation = \"pi / 7\"")));
  const BodyGeometry set = shape_of("polygon", polygon(3, 3),
                                    {{"body.polygon.corners", "5"},
                                     {"body.polygon.count", "10"},
                                     {"body.polygon.radius", "1.7"},
                                     {"body.polygon.orientation", "0.3"}});
  EXPECT_EQ(set.relative, polygon_shape(5, 10, "orientation = 0.3").relative);
  const BodyGeometry space =
      shape_of("polygon", "corners = 4\ncount = 8\nradius = 1\ncentre = [1, 2, 3]");
  for (const auto& particle : space.relative) EXPECT_EQ(particle[2], 0.0);
}

}  // namespace
}  // namespace tomlin::test
