#include "framework/bodies/ellipse.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/framework/bodies/body_fixture.hpp"

namespace tomlin::test {
namespace {

/// Some roundings of numbers of order one.
constexpr double kFewRoundings = 2e-15;

std::string ellipse(double a, double b, int count, const std::string& more = "") {
  return "semi_axes = [" + digits(a) + ", " + digits(b) + "]\ncount = " + std::to_string(count) +
         "\ncentre = [0, 0]\n" + more;
}

BodyGeometry ellipse_shape(double a, double b, int count, const std::string& more = "") {
  return shape_of("ellipse", ellipse(a, b, count, more));
}

/// The length of an ellipse between two parametric angles by Simpson's rule, ever finer where it
/// bends.
class LengthBySimpson {
 public:
  LengthBySimpson(double a, double b) : a_(a), b_(b) {}

  long double between(long double from, long double to) const {
    const long double whole = simpson(from, to);
    return refined(from, to, whole, 60);
  }

 private:
  long double speed(long double t) const {
    const long double x = a_ * std::sin(t);
    const long double y = b_ * std::cos(t);
    return std::sqrt(x * x + y * y);
  }
  long double simpson(long double from, long double to) const {
    return (to - from) / 6.0L * (speed(from) + 4.0L * speed(0.5L * (from + to)) + speed(to));
  }
  long double refined(long double from, long double to, long double whole, int depth) const {
    const long double middle = 0.5L * (from + to);
    const long double left = simpson(from, middle);
    const long double right = simpson(middle, to);
    const long double change = left + right - whole;
    const long double enough = 1e-15L * (a_ + b_) * (to - from);
    if (depth == 0 || std::fabs(change) < enough) return left + right + change / 15.0L;
    return refined(from, middle, left, depth - 1) + refined(middle, to, right, depth - 1);
  }

  long double a_;
  long double b_;
};

/// The largest deviation of the arc lengths between neighbours from their mean.
double unevenness(double a, double b, const BodyGeometry& geometry) {
  const LengthBySimpson length(a, b);
  const std::size_t count = geometry.relative.size();
  const long double expected =
      geometry.rolling_radius * static_cast<long double>(kTau) / static_cast<long double>(count);
  double worst = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& from = geometry.relative[i];
    const auto& to = geometry.relative[(i + 1) % count];
    const long double start = std::atan2(from[1] / static_cast<long double>(b), from[0] / a);
    long double end = std::atan2(to[1] / static_cast<long double>(b), to[0] / a);
    if (!(end > start)) end += 2.0L * std::acos(-1.0L);
    const long double found = length.between(start, end);
    worst = std::fmax(worst, static_cast<double>(std::fabs(found - expected)));
  }
  return worst;
}

// Values of 4 E(1 - b^2) to 20 digits, from arithmetic of 40.
TEST(Ellipse, HasThePerimeterOfTables) {
  const std::pair<double, double> known[] = {{1.0, 6.2831853071795864769},
                                             {0.999999, 6.2831821655873254961},
                                             {0.5, 4.8442241102738380992},
                                             {1e-6, 4.0000000000294036098},
                                             {1e-9, 4.0000000000000000432}};
  for (const auto& [b, perimeter] : known) {
    EXPECT_NEAR(ellipse_shape(1.0, b, 5).rolling_radius * kTau, perimeter, kFewRoundings) << b;
    EXPECT_NEAR(ellipse_shape(b, 1.0, 5).rolling_radius * kTau, perimeter, kFewRoundings) << b;
  }
  EXPECT_EQ(ellipse_shape(3e300, 3e300, 4).rolling_radius, 3e300);
}

TEST(Ellipse, ParticlesAreEquallyFarApartAlongIt) {
  for (const auto& [a, b] : {std::pair(1.0, 0.5), std::pair(0.5, 1.0), std::pair(3.0, 2.9),
                             std::pair(1.0, 1e-3), std::pair(1.0, 1e-6), std::pair(1e-9, 1.0)}) {
    for (const int count : {1, 3, 4, 7, 50}) {
      EXPECT_LT(unevenness(a, b, ellipse_shape(a, b, count)), 2.0 * kFewRoundings * std::fmax(a, b))
          << a << " " << b << " " << count;
    }
  }
  // The control: equal angles are something else.
  EXPECT_GT(unevenness(1.0, 0.5, ellipse_shape(1.0, 0.5, 12, "spacing = \"angle\"")), 0.05);
}

TEST(Ellipse, BeginsOnItsFirstAxisAndRunsCounterClockwise) {
  const BodyGeometry wide = ellipse_shape(2.0, 0.5, 4);
  const std::vector<std::vector<double>> corners = {
      {2.0, 0.0}, {0.0, 0.5}, {-2.0, 0.0}, {0.0, -0.5}};
  EXPECT_EQ(wide.relative, corners);
  const BodyGeometry turned = ellipse_shape(2.0, 0.5, 4, "orientation = \"pi / 2\"");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(turned.relative[i][0], -corners[i][1], kFewRoundings);
    EXPECT_NEAR(turned.relative[i][1], corners[i][0], kFewRoundings);
  }
}

TEST(Ellipse, WithEqualAxesIsARing) {
  for (const int count : {1, 2, 3, 5, 8, 13, 100}) {
    const BodyGeometry ring =
        shape_of("ring", "radius = 1.7\ncentre = [0, 0]\ncount = " + std::to_string(count));
    const BodyGeometry by_angle = ellipse_shape(1.7, 1.7, count, "spacing = \"angle\"");
    const BodyGeometry by_arc = ellipse_shape(1.7, 1.7, count);
    for (std::size_t i = 0; i < ring.relative.size(); ++i) {
      EXPECT_TRUE(same_bits(by_angle.relative[i], ring.relative[i])) << count << " " << i;
      for (std::size_t d = 0; d < 2; ++d) {
        EXPECT_NEAR(by_arc.relative[i][d], ring.relative[i][d], kFewRoundings) << count << " " << i;
      }
    }
    EXPECT_NEAR(by_arc.rolling_radius, ring.rolling_radius, kFewRoundings);
    EXPECT_EQ(by_arc.rolling_rise, 0.0);
  }
}

TEST(Ellipse, IsItsOwnMirrorImageToTheBit) {
  for (const int count : {3, 8, 17}) {
    const BodyGeometry found = ellipse_shape(1.3, 0.4, count);
    for (std::size_t i = 1; i < found.relative.size(); ++i) {
      const auto& other = found.relative[found.relative.size() - i];
      EXPECT_EQ(found.relative[i][0], other[0]) << i;
      EXPECT_EQ(found.relative[i][1], -other[1]) << i;
    }
  }
}

TEST(Ellipse, CentreOfMassIsTheCentreUnlessAnOddCountIsSpacedAlongTheArc) {
  for (const int count : {2, 3, 7, 8, 50}) {
    const double by_angle = mean_of(ellipse_shape(2.0, 1.0, count, "spacing = \"angle\""))[0];
    const std::vector<double> by_arc = mean_of(ellipse_shape(2.0, 1.0, count));
    EXPECT_NEAR(by_angle, 0.0, kFewRoundings) << count;
    EXPECT_NEAR(by_arc[1], 0.0, kFewRoundings) << count;
    if (count % 2 == 0) {
      EXPECT_NEAR(by_arc[0], 0.0, kFewRoundings) << count;
    }
  }
  // The others are at (-x, +-y) with x of some -0.94, where the arc from the first one is P/3.
  EXPECT_GT(mean_of(ellipse_shape(2.0, 1.0, 3))[0], 0.02);
}

TEST(Ellipse, HasTheInertiaOfItsParticles) {
  constexpr double kRelative = 1e-13;  // sums of some hundred terms
  // At equal angles it is half the sum of the squared axes per particle, for any count from 3 on.
  for (const int count : {3, 4, 11, 200}) {
    const double expected = 0.5 * count * (1.3 * 1.3 + 0.4 * 0.4);
    EXPECT_NEAR(inertia_of("ellipse", ellipse(1.3, 0.4, count, "spacing = \"angle\"")), expected,
                kRelative * expected);
  }
  // At equal arcs the sum converges exponentially to the inertia of a uniform wire.
  double wire = 0.0;
  double length = 0.0;
  for (int k = 0; k < 4096; ++k) {
    const double c = std::cos(kTau * k / 4096);
    const double s = std::sin(kTau * k / 4096);
    const double speed = std::sqrt(1.69 * s * s + 0.64 * c * c);
    wire += speed * (1.69 * c * c + 0.64 * s * s);
    length += speed;
  }
  EXPECT_NEAR(inertia_of("ellipse", ellipse(1.3, 0.8, 400)) / 400.0, wire / length, kRelative);
  // The control: equal angles are not uniform.
  EXPECT_GT(std::abs(0.5 * (1.69 + 0.64) - wire / length), 0.02);
}

TEST(Ellipse, FaultsHaveTheirPlace) {
  const auto faults = [](const std::string& keys) { return faults_with("ellipse", keys); };
  using Lines = std::vector<std::string>;
  const std::string rest = "\ncount = 3\ncentre = [0, 0]";
  EXPECT_EQ(faults("semi_axes = [1, 0.5]" + rest), Lines());
  EXPECT_EQ(faults("semi_axes = 1" + rest),
            Lines{"3:13 body.ellipse.semi_axes = 1 [scene.wrong_count]"});
  EXPECT_EQ(faults("semi_axes = [1, 2, 3]" + rest),
            Lines{"3:13 body.ellipse.semi_axes = [1, 2, 3] [scene.wrong_count]"});
  EXPECT_EQ(faults("semi_axes = [1, 0]" + rest),
            Lines{"3:17 body.ellipse.semi_axes = 0 [scene.out_of_range]"});
  EXPECT_EQ(faults("semi_axes = [1, 1e-10]" + rest),
            Lines{"3:13 body.ellipse.semi_axes = [1, 1e-10] [scene.out_of_range]"});
  EXPECT_EQ(faults("semi_axes = [1, 2]\norientation = 6.3" + rest),
            Lines{"4:15 body.ellipse.orientation = 6.3 [scene.out_of_range]"});
  EXPECT_EQ(faults("semi_axes = [1, 2]\nspacing = \"arcs\"" + rest),
            Lines{"4:11 body.ellipse.spacing = \"arcs\" [scene.unknown_choice] did you mean arc"});
  EXPECT_EQ(faults("semi_axes = [1, 2]\ncount = 3\ncentre = [0]"),
            Lines{"5:10 body.ellipse.centre = [0] [scene.wrong_count]"});
  EXPECT_EQ(faults("semi_axes = [1, 2]\ncount = 0\ncentre = [0, 0]"),
            Lines{"4:9 body.ellipse.count = 0 [scene.out_of_range]"});
  // All at once.
  EXPECT_EQ(faults("semi_axes = [1]\ncount = 3\ncentre = [0]").size(), 2U);
}

TEST(Ellipse, StandsInTheEffectiveSceneAndTakesSettings) {
  EXPECT_TRUE(effective_scene_keeps(
      "ellipse", ellipse(1.3, 0.1, 9, "orientation = \"pi / 7\"\nspacing = \"arc\"")));
  EXPECT_TRUE(effective_scene_keeps("ellipse", ellipse(1.3, 0.1, 9)));
  const BodyGeometry set = shape_of("ellipse", ellipse(1.0, 1.0, 3),
                                    {{"body.ellipse.semi_axes", "[2.0, 0.5]"},
                                     {"body.ellipse.count", "5"},
                                     {"body.ellipse.orientation", "0.3"},
                                     {"body.ellipse.spacing", "\"angle\""}});
  const BodyGeometry written = ellipse_shape(2.0, 0.5, 5, "orientation = 0.3\nspacing = \"angle\"");
  EXPECT_EQ(set.relative, written.relative);
}

TEST(Ellipse, LiesInAPlaneOfSpaceToo) {
  const BodyGeometry plane = ellipse_shape(1.2, 0.7, 6, "orientation = 0.5");
  const BodyGeometry space = shape_of("ellipse",
                                      "semi_axes = [1.2, 0.7]\ncount = 6\n"
                                      "orientation = 0.5\ncentre = [1, 2, 3]");
  EXPECT_EQ(space.anchor, (std::vector<double>{1.0, 2.0, 3.0}));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(space.relative[i][0], plane.relative[i][0]);
    EXPECT_EQ(space.relative[i][1], plane.relative[i][1]);
    EXPECT_EQ(space.relative[i][2], 0.0);
  }
  // "neighbours" closes it: six bonds of six particles.
  const auto bonds = [](const char* lengths) {
    return faults_with("ellipse", "semi_axes = [1.2, 0.7]\ncount = 6\ncentre = [1, 2, 3]",
                       std::string("[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
                                   "stiffness = 1\nrest_lengths = ") +
                           lengths + "\n");
  };
  EXPECT_EQ(bonds("[1, 1, 1, 1, 1, 1]"), std::vector<std::string>());
  EXPECT_EQ(bonds("[1, 1, 1, 1, 1]").size(), 1U);
}

}  // namespace
}  // namespace tomlin::test
