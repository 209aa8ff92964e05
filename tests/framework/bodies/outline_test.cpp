#include "framework/bodies/outline.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/events/events.hpp"
#include "tests/framework/bodies/body_fixture.hpp"

// Particles as a closed outline, and how bodies roll that are not round.

namespace tomlin::test {
namespace {

constexpr double kRounding = 1e-15;

std::string outline_of(const std::string& positions, const std::string& outline = "closed") {
  return "positions = " + positions + "\noutline = \"" + outline + "\"";
}

TEST(ClosedOutline, HasThePerimeterOfThePolygonThroughItsParticles) {
  const std::string triangle = "[[1, 1], [4, 1], [1, 5]]";
  const BodyGeometry found = shape_of("particles", outline_of(triangle));
  EXPECT_NEAR(found.rolling_radius * kTau, 12.0, 12.0 * kRounding);
  // Its centre (2, 7/3) is farthest from (1, 5), and nearest to the long side.
  EXPECT_NEAR(found.rolling_rise, std::hypot(1.0, 8.0 / 3.0) - 0.8, 10.0 * kRounding);
  const BodyGeometry open = shape_of("particles", outline_of(triangle, "open"));
  EXPECT_EQ(open.rolling_radius, 0.0);
  EXPECT_EQ(open.relative, found.relative);
  EXPECT_EQ(open.relative, shape_of("particles", "positions = " + triangle).relative);
  // Outlines may have any size.
  const auto scaled = [](const std::string& factor) {
    return shape_of("particles", outline_of("[[0, 0], [\"3 * " + factor + "\", 0], [0, \"4 * " +
                                            factor + "\"]]"))
               .rolling_radius *
           kTau;
  };
  EXPECT_NEAR(scaled("1e-200") / 1e-200, 12.0, 12.0 * kRounding);
  EXPECT_NEAR(scaled("1e200") / 1e200, 12.0, 12.0 * kRounding);
}

TEST(ClosedOutline, IsThatOfThePolygonWithTheSameParticles) {
  const BodyGeometry polygon =
      shape_of("polygon", "corners = 5\ncount = 10\nradius = 1.3\ncentre = [0, 0]");
  std::string positions;
  for (const auto& particle : polygon.relative) {
    positions += "[" + digits(particle[0]) + ", " + digits(particle[1]) + "], ";
  }
  const BodyGeometry found = shape_of("particles", outline_of("[" + positions + "]"));
  EXPECT_NEAR(found.rolling_radius, polygon.rolling_radius, 4.0 * kRounding);
  EXPECT_NEAR(found.rolling_rise, polygon.rolling_rise, 4.0 * kRounding);
}

TEST(ClosedOutline, JoinsTheLastParticleToTheFirst) {
  const auto bonds = [](const char* outline, const char* lengths) {
    return faults_with("particles", outline_of("[[0, 0], [1, 0], [0, 1]]", outline),
                       std::string("[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
                                   "stiffness = 1\nrest_lengths = ") +
                           lengths + "\n")
        .size();
  };
  EXPECT_EQ(bonds("closed", "[1, 1, 1]"), 0U);
  EXPECT_EQ(bonds("closed", "[1, 1]"), 1U);
  EXPECT_EQ(bonds("open", "[1, 1]"), 0U);
  EXPECT_EQ(bonds("open", "[1, 1, 1]"), 1U);
}

TEST(ClosedOutline, FaultsHaveTheirPlace) {
  const auto faults = [](const std::string& positions) {
    return faults_with("particles", outline_of(positions));
  };
  using Lines = std::vector<std::string>;
  const auto at = [](const char* code) {
    return Lines{std::string("4:11 body.particles.outline = \"closed\" [") + code + "]"};
  };
  EXPECT_EQ(faults("[[0, 0], [1, 0], [0, 1]]"), Lines());
  EXPECT_EQ(faults("[[0, 0, 0], [1, 0, 0], [0, 1, 0]]"), Lines());
  EXPECT_EQ(faults("[[0, 0], [1, 0]]"), at("scene.wrong_count"));
  EXPECT_EQ(faults("[0, 1, 2]"), at("scene.conflict"));
  EXPECT_EQ(faults("[[0, 0], [1, 0], [1, 0]]"), at("component.invalid"));
  EXPECT_EQ(faults("[[0, 0], [1, 0], [0, 0]]"), at("component.invalid"));
  EXPECT_EQ(faults("[[0, 0], [1e308, 0], [0, 1e308], [1e308, 1e308], [0, -1e307], [1e308, 9e307], "
                   "[0, 1e307], [1e308, 0], [0, 9e307], [1e308, -1e307], [0, 3e307], [1e308, 1]]"),
            at("scene.not_finite"));
  EXPECT_EQ(faults_with("particles", outline_of("[[0, 0], [1, 0], [0, 1]]", "close")),
            Lines{"4:11 body.particles.outline = \"close\" [scene.unknown_choice] did you mean "
                  "closed"});
}

TEST(ClosedOutline, StandsInTheEffectiveScene) {
  EXPECT_TRUE(effective_scene_keeps("particles", outline_of("[[0, 0], [1, 0], [\"1/3\", 1]]")));
  EXPECT_EQ(shape_of("particles", "positions = [[0, 0], [3, 0], [0, 4]]",
                     {{"body.particles.outline", "\"closed\""}})
                .rolling_radius,
            shape_of("particles", outline_of("[[0, 0], [3, 0], [0, 4]]")).rolling_radius);
}

// ---- rolling

/// Bodies with a perimeter of their own.
struct RollingBody {
  std::string type;
  std::string keys;
};
const std::vector<RollingBody>& rolling_bodies() {
  static const std::vector<RollingBody> all = {
      {"ring", "radius = 0.9\ncount = 8\ncentre = [0.0, 1.0]\n"},
      {"ellipse", "semi_axes = [1.0, 0.8]\ncount = 9\ncentre = [0.0, 1.0]\n"},
      {"polygon", "corners = 6\ncount = 12\nradius = 1.0\ncentre = [0.0, 1.0]\n"},
      {"particles",
       "positions = [[0, 0.2], [0.6, 0.6], [0.6, 1.4], [0, 1.8], [-0.6, 1.4], [-0.6, 0.6]]\n"
       "outline = \"closed\"\n"}};
  return all;
}

/// A body that advances with this velocity and turns clockwise once in a unit of time.
std::string turning(const RollingBody& body, double velocity) {
  return "[[body]]\nname = \"body\"\ntype = \"" + body.type + "\"\n" + body.keys +
         "particle_mass = 1.0\ncoordinates = \"prescribed\"\nmotion = { velocity = [" +
         digits(velocity) +
         ", 0.0], angular_velocity = \"-2 * pi\" }\n"
         "[run]\nduration = 3.0\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
}

// One turn clockwise while it advances by its perimeter is rolling without sliding.
TEST(Rolling, IsOneWhereATurnAdvancesByThePerimeter) {
  for (const RollingBody& body : rolling_bodies()) {
    const double perimeter = kTau * shape_of(body.type, body.keys).rolling_radius;
    for (const double sliding : {0.0, 0.5}) {
      const RunResult result = run_text(turning(body, (1.0 + sliding) * perimeter));
      EXPECT_NEAR(*body_of(result, "body")["rolling"].begin(), 1.0 / (1.0 + sliding), 1e-12)
          << body.type;
      EXPECT_NEAR(*body_of(result, "body")["turns"].begin(), -3.0, 1e-12) << body.type;
    }
  }
}

/// A rigid body of this type, pulled over a substrate of period 1 by 1 in each 20 of time.
std::string pulled(const std::string& type, const std::string& keys, double amplitude,
                   double duration) {
  return "[[body]]\nname = \"body\"\ntype = \"" + type + "\"\n" + keys +
         "particle_mass = \"1 / 12\"\ncoordinates = \"rigid\"\n"
         "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
         "velocity = [0.05, 0.0]\n"
         "[[force]]\ntype = \"viscous_damping\"\ncoefficient = \"2 * sqrt(2) / 12\"\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\nperiod = 1.0\ndecay = 2.0\namplitude = " +
         digits(amplitude) + "\n[run]\nduration = " + digits(duration) +
         "\nintegrator = " + adaptive(1e-8) +
         "\n[measure]\nfrom = 12\nto = 24\nin = \"driver_periods\"\n[output]\nevery = 1.0\n";
}

// Twelve particles on a perimeter of twelve periods mesh with the substrate like the teeth of a
// gear with a rack: a body that is held to it rolls without sliding, round or not.
TEST(Rolling, ABodyThatMeshesWithTheSubstrateRollsWithoutSliding) {
  constexpr double kSame = 1e-6;  // of the scheme and of a motion that has become periodic
  // Perimeter of an ellipse of the semi-axes 1 and 0.8.
  const double scale = 12.0 / 5.6723335777948971;
  const std::string semi_axes =
      "semi_axes = [" + digits(scale) + ", " + digits(0.8 * scale) + "]\n";
  const std::string on_ellipse = semi_axes + "centre = [0.0, " + digits(0.8 * scale) + "]\n";
  struct Case {
    std::string type;
    std::string keys;
    double rolling;
  };
  const Case cases[] = {
      {"ellipse", on_ellipse + "count = 12\n", 1.0},
      {"polygon",
       "corners = 6\nradius = 2.0\ncount = 12\norientation = \"pi / 6\"\n"
       "centre = [0.0, \"sqrt(3)\"]\n",
       1.0},
      {"polygon",
       "corners = 4\nradius = \"1.5 * sqrt(2)\"\ncount = 12\norientation = \"pi / 4\"\n"
       "centre = [0.0, 1.5]\n",
       1.0},
      // The control: with a tooth too many it falls behind.
      {"ellipse", on_ellipse + "count = 13\n", 12.0 / 13.0}};
  for (const Case& body : cases) {
    KeptSamples kept;
    RunOptions options;
    options.sink = &kept;
    const RunResult result = run_text(pulled(body.type, body.keys, 0.5, 480.0), {}, options);
    const double tolerance = body.rolling == 1.0 ? kSame : 5e-3;
    EXPECT_NEAR(*body_of(result, "body")["rolling"].begin(), body.rolling, tolerance) << body.type;
    EXPECT_NEAR(*body_of(result, "body")["turns"].begin(), -body.rolling, 2.0 * tolerance);
    // A turn for each twelve periods, and no hop, though the centre rises by more than a fifth of
    // the rolling radius, 12 / (2 pi).
    EXPECT_EQ(kept.of(EventKind::hop).size(), 0U) << body.type;
    EXPECT_EQ(kept.of(EventKind::turn).size(), 1U) << body.type;
    double lowest = 1e300;
    double highest = 0.0;
    for (const auto& row : kept.rows) {
      lowest = std::min(lowest, row[kept.column("body.centre_of_mass.y")]);
      highest = std::max(highest, row[kept.column("body.centre_of_mass.y")]);
    }
    if (body.keys.find("corners = 4") != std::string::npos) {
      EXPECT_GT(highest - lowest, 0.25 * 12.0 / kTau);
    }
  }
}

// With the particles of a ring they move as it does; only the radius of rolling is their own.
TEST(Rolling, BodiesWithTheParticlesOfARingMoveAsItDoes) {
  const std::string rest = "count = 12\ncentre = [0.0, 1.0]\n";
  const RunResult ring = run_text(pulled("ring", "radius = 1.0\n" + rest, 0.01, 480.0));
  const RunResult ellipse = run_text(
      pulled("ellipse", "semi_axes = [1.0, 1.0]\nspacing = \"angle\"\n" + rest, 0.01, 480.0));
  const RunResult polygon =
      run_text(pulled("polygon", "corners = 12\nradius = 1.0\n" + rest, 0.01, 480.0));
  const double ratio = 12.0 / kTau * 2.0 * std::sin(kTau / 24.0);
  for (const RunResult* other : {&ellipse, &polygon}) {
    for (const char* quantity : {"rotation", "turns", "centre_of_mass", "velocity"}) {
      EXPECT_TRUE(same_bits(body_of(*other, "body")[quantity], body_of(ring, "body")[quantity]))
          << quantity;
    }
    EXPECT_TRUE(same_bits(driver_of(*other, "driver")["mean_force"],
                          driver_of(ring, "driver")["mean_force"]));
    const double wanted =
        *body_of(ring, "body")["rolling"].begin() * (other == &polygon ? ratio : 1.0);
    EXPECT_NE(wanted, 0.0);
    EXPECT_NEAR(*body_of(*other, "body")["rolling"].begin(), wanted, 1e-12);
  }
}

// The rise of a body that is not round as it rolls is no hop; a rise beyond that and a fifth of its
// rolling radius is one.
TEST(Rolling, ARiseOfTheOutlineIsNoHop) {
  constexpr double kRise = 0.3;
  for (const auto& [height, expected] : {std::pair(0.49, 0), std::pair(0.51, 3)}) {
    std::vector<double> reals(BodyWatch::kReals);
    std::vector<std::int64_t> integers(BodyWatch::kIntegers);
    BodyWatch watch(0, 1.0, kRise);
    watch.attach(reals.data(), integers.data());
    watch.start();
    int hops = 0;
    for (int k = 0; k <= 300; ++k) {
      const double t = 0.01 * k;  // three times up and down
      watch.add_height(t, 1.0 + height * 0.5 * (1.0 - std::cos(kTau * t)),
                       [&](const Event&) { ++hops; });
    }
    EXPECT_EQ(hops, expected) << height;
  }
}

}  // namespace
}  // namespace tomlin::test
