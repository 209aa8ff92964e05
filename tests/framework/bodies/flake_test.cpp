#include "framework/bodies/flake.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/framework/bodies/body_fixture.hpp"

namespace tomlin::test {
namespace {

/// Some roundings of positions of a few lattice constants.
constexpr double kRoundings = 1e-14;

std::string flake(const std::string& lattice, const std::string& shape, const std::string& size,
                  const std::string& more = "") {
  return "lattice = \"" + lattice + "\"\nshape = \"" + shape + "\"\nsize = " + size +
         "\nlattice_constant = 1\ncentre = [0, 0]\n" + more;
}

using Positions = std::vector<std::vector<double>>;

Positions positions_in(const std::string& keys) { return shape_of("flake", keys).relative; }

std::size_t count_in(const std::string& lattice, const std::string& shape,
                     const std::string& size) {
  return positions_in(flake(lattice, shape, size)).size();
}

std::string number(int n) { return std::to_string(n); }

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

double bond_length(const std::string& lattice) {
  return lattice == "honeycomb" ? 1.0 / std::sqrt(3.0) : 1.0;
}

/// All that the flakes of these tests are.
struct Kind {
  const char* lattice;
  const char* shape;
};
constexpr Kind kKinds[] = {
    {"hexagonal", "hexagon"},  {"hexagonal", "circle"},   {"hexagonal", "square"},
    {"hexagonal", "triangle"}, {"honeycomb", "hexagon"},  {"honeycomb", "circle"},
    {"honeycomb", "square"},   {"honeycomb", "triangle"}, {"square", "circle"},
    {"square", "square"},
};

TEST(Flake, HasAsManyParticlesAndBondsAsCountedByHand) {
  const auto check = [](const char* lattice, const char* shape, int n, int particles, int bonds) {
    const std::string keys = flake(lattice, shape, number(n));
    EXPECT_EQ(positions_in(keys).size(), particles) << lattice << " " << shape << " " << n;
    EXPECT_EQ(bonds_of("flake", keys).size(), bonds) << lattice << " " << shape << " " << n;
  };
  for (int n = 1; n <= 6; ++n) {
    check("hexagonal", "hexagon", n, 3 * n * (n + 1) + 1, 9 * n * n + 3 * n);
    check("honeycomb", "hexagon", n, 6 * n * n, 9 * n * n - 3 * n);
    check("hexagonal", "triangle", n, (n + 1) * (n + 2) / 2, 3 * n * (n + 1) / 2);
    check("honeycomb", "triangle", n, n * n + 4 * n + 1, 3 * n * (n + 3) / 2);
    check("square", "square", n, (n + 1) * (n + 1), 2 * n * (n + 1));
  }
  check("hexagonal", "hexagon", 0, 1, 0);
  // Flakes of Verhoeven, Dienwiebel and Frenken.
  const std::size_t flakes[] = {6, 24, 54, 96, 150};
  for (int n = 1; n <= 5; ++n) {
    EXPECT_EQ(count_in("honeycomb", "hexagon", number(n)), flakes[n - 1]);
  }
  EXPECT_EQ(count_in("square", "rectangle", "[3, 1]"), 8U);
  EXPECT_EQ(count_in("square", "rectangle", "[3, 0]"), 4U);
  EXPECT_EQ(count_in("square", "square", "2.9"), 9U);
  EXPECT_EQ(count_in("hexagonal", "rectangle", "[2, \"sqrt(3)\"]"), 7U);
}

// Shells of the hexagonal lattice: 6 at 1, 6 at sqrt(3), 6 at 2, 12 at sqrt(7).
TEST(Flake, OfACircleHasWhatStandsOnItsBorderHoweverRounded) {
  const auto count = [](const std::string& size) { return count_in("hexagonal", "circle", size); };
  EXPECT_EQ(count("2.6457513110645906"), 31U);
  const double root = std::sqrt(7.0);
  for (const double size : {root, std::nextafter(root, 0.0), std::nextafter(root, 9.0)}) {
    EXPECT_EQ(count(digits(size)), 31U);
  }
  EXPECT_EQ(count("\"sqrt(7)\""), 31U);
  EXPECT_EQ(count("\"3 * sqrt(7) / 3 * (1 - 1e-8)\""), 19U);
  EXPECT_EQ(count("0"), 1U);
  // The first hexagon of a honeycomb, at 1/sqrt(3).
  EXPECT_EQ(count_in("honeycomb", "circle", "\"1 / sqrt(3)\""), 6U);
}

TEST(Flake, BondsAreAllPairsAtTheDistanceOfNearestNeighbours) {
  for (const auto& [lattice, shape] : kKinds) {
    const double bond = bond_length(lattice);
    for (const int n : {1, 2, 3, 4}) {
      const std::string keys = flake(lattice, shape, number(n), "misfit = 0.4");
      const Positions found = positions_in(keys);
      std::vector<IndexPair> expected;
      for (std::size_t i = 0; i < found.size(); ++i) {
        for (std::size_t j = i + 1; j < found.size(); ++j) {
          const double distance = apart(found[i], found[j]);
          EXPECT_GT(distance, bond - kRoundings);
          if (distance < 1.1 * bond) {
            EXPECT_NEAR(distance, bond, kRoundings);
            expected.push_back({static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)});
          }
        }
      }
      EXPECT_EQ(bonds_of("flake", keys), expected) << lattice << " " << shape << " " << n;
    }
  }
}

TEST(Flake, ParticlesInsideHaveTheCoordinationOfTheLattice) {
  const std::map<std::string, int> coordination = {
      {"hexagonal", 6}, {"honeycomb", 3}, {"square", 4}};
  for (const auto& [lattice, bonds] : coordination) {
    const std::string keys = flake(lattice, "circle", "6");
    const Positions found = positions_in(keys);
    std::vector<int> bonded(found.size(), 0);
    for (const auto& pair : bonds_of("flake", keys)) {
      for (const std::int64_t i : pair) ++bonded[static_cast<std::size_t>(i)];
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::hypot(found[i][0], found[i][1]) < 5.0) {
        EXPECT_EQ(bonded[i], bonds) << lattice;
      }
      EXPECT_LE(bonded[i], bonds) << lattice;
    }
    EXPECT_LT(*std::min_element(bonded.begin(), bonded.end()), bonds) << lattice;
  }
}

TEST(Flake, IsInOrderRowByRowAboutItsCentre) {
  for (const auto& [lattice, shape] : kKinds) {
    const BodyGeometry found = shape_of("flake", flake(lattice, shape, "3"));
    for (std::size_t i = 1; i < found.relative.size(); ++i) {
      const auto& before = found.relative[i - 1];
      const auto& here = found.relative[i];
      EXPECT_TRUE(here[1] > before[1] || (here[1] == before[1] && here[0] > before[0])) << i;
    }
    EXPECT_NEAR(mean_of(found)[0], 0.0, kRoundings) << lattice << " " << shape;
    EXPECT_NEAR(mean_of(found)[1], 0.0, kRoundings) << lattice << " " << shape;
  }
  // A lattice vector along x: in the row of a benzene ring's upper sides.
  const Positions ring = positions_in(flake("honeycomb", "hexagon", "1"));
  EXPECT_NEAR(ring[1][0] - ring[2][0], -1.0, kRoundings);
  EXPECT_EQ(ring[1][1], ring[2][1]);
}

/// The largest distance of a particle of one from the nearest of the other.
double largest_distance(const Positions& one, const Positions& other) {
  double worst = 0.0;
  for (const auto& particle : one) {
    double nearest = 1e300;
    for (const auto& candidate : other) nearest = std::min(nearest, apart(particle, candidate));
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(Flake, IsTheSameAfterATurnThatIsASymmetry) {
  const auto turned = [](const char* lattice, const char* shape, const std::string& angle) {
    return largest_distance(positions_in(flake(lattice, shape, "4", "misfit = " + angle)),
                            positions_in(flake(lattice, shape, "4")));
  };
  for (const char* lattice : {"hexagonal", "honeycomb"}) {
    for (const char* angle : {"\"pi / 3\"", "\"-2 * pi / 3\"", "\"pi\"", "\"2 * pi\""}) {
      EXPECT_LT(turned(lattice, "hexagon", angle), kRoundings) << lattice << angle;
      EXPECT_LT(turned(lattice, "circle", angle), kRoundings) << lattice << angle;
    }
    EXPECT_LT(turned(lattice, "triangle", "\"2 * pi / 3\""), kRoundings);
    EXPECT_GT(turned(lattice, "triangle", "\"pi / 3\""), 0.1);
    EXPECT_GT(turned(lattice, "hexagon", "\"pi / 6\""), 0.1);
  }
  EXPECT_LT(turned("square", "square", "\"pi / 2\""), kRoundings);
  EXPECT_GT(turned("square", "square", "\"pi / 4\""), 0.1);
}

TEST(Flake, IsTurnedCounterClockwiseByItsMisfit) {
  const Positions plain = positions_in(flake("hexagonal", "triangle", "2"));
  const Positions turned = positions_in(flake("hexagonal", "triangle", "2", "misfit = 0.3"));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(turned[i][0], std::cos(0.3) * plain[i][0] - std::sin(0.3) * plain[i][1],
                kRoundings);
    EXPECT_NEAR(turned[i][1], std::sin(0.3) * plain[i][0] + std::cos(0.3) * plain[i][1],
                kRoundings);
  }
}

// ---- bonds of a flexible flake

/// A flake of 24 atoms with these forces, the first of which moves.
std::string flexible(const std::string& forces, const std::string& lattice = "honeycomb") {
  return "[[body]]\nname = \"flake\"\ntype = \"flake\"\n" + flake(lattice, "hexagon", "2") +
         "particle_mass = 1.0\nvelocity = [0.0, 0.0]\n" + forces +
         "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\n"
         "velocity = [0.3, 0.1]\nattach = { particle = 3 }\n"
         "[run]\nduration = 3.0\nintegrator = { type = \"rk4\", dt = 0.01 }\nledger = true\n";
}

std::string listed_bonds() {
  std::string list;
  for (const auto& [i, j] : bonds_of("flake", flake("honeycomb", "hexagon", "2"))) {
    list += "[" + std::to_string(i) + ", " + std::to_string(j) + "], ";
  }
  return "[" + list + "]";
}

std::vector<double> ends_of(const std::string& scene) {
  const RunResult result = run_text(scene);
  return {*driver_of(result, "driver")["final_force"].begin(),
          *body_of(result, "flake")["rotation"].begin()};
}

TEST(FlexibleFlake, BondsAreItsNearestNeighbours) {
  const auto scene = [](const std::string& pairs, const std::string& more = "") {
    return flexible("[[force]]\ntype = \"harmonic_bonds\"\nstiffness = 10.0\npairs = " + pairs +
                    "\n" + more);
  };
  const auto found = ends_of(scene("\"neighbours\""));
  EXPECT_TRUE(same_bits(found, ends_of(scene(listed_bonds()))));
  EXPECT_GT(std::abs(found[1]), 1e-3) << "it turns";
  // The control: consecutive particles.
  std::string consecutive;
  for (int i = 0; i < 23; ++i) consecutive += "[" + number(i) + ", " + number(i + 1) + "], ";
  EXPECT_FALSE(same_bits(found, ends_of(scene("[" + consecutive + "]"))));
  // A periodic box does not change them.
  EXPECT_TRUE(same_bits(found, ends_of(scene("\"neighbours\"",
                                             "[box]\nlengths = [64, 64]\n"
                                             "periodic = [true, true]\n"))));
}

TEST(FlexibleFlake, TakesARestLengthForEachBond) {
  const auto refused = [](int lengths) {
    std::string list;
    for (int k = 0; k < lengths; ++k) list += "1, ";
    return faults_with("flake", flake("honeycomb", "hexagon", "2"),
                       "[[force]]\ntype = \"harmonic_bonds\"\nstiffness = 1\npairs = "
                       "\"neighbours\"\nrest_lengths = [" +
                           list + "]\n")
        .size();
  };
  EXPECT_EQ(refused(30), 0U);
  EXPECT_EQ(refused(29), 1U);
  EXPECT_EQ(refused(23), 1U);
}

TEST(FlexibleFlake, TakesFormulasOfItsBondsAndOfTheAnglesBetweenThem) {
  const auto bonds = [](const std::string& pairs) {
    return flexible(
        "[[force]]\ntype = \"expression\"\nenergy = \"5 * (r - 0.6)^2\"\npairs = " + pairs + "\n");
  };
  EXPECT_TRUE(same_bits(ends_of(bonds("\"neighbours\"")), ends_of(bonds(listed_bonds()))));
  // Three angles about each atom with three bonds, one about one with two.
  const auto angles = [](const std::string& given) {
    return flexible(
        "[[force]]\ntype = \"harmonic_bonds\"\nstiffness = 10.0\npairs = \"neighbours\"\n"
        "[[force]]\ntype = \"expression\"\nenergy = \"(theta - 2 * pi / 3)^2\"\nangles = " +
        given + "\n");
  };
  const auto pairs = bonds_of("flake", flake("honeycomb", "hexagon", "2"));
  std::string list;
  int count = 0;
  for (std::int64_t vertex = 0; vertex < 24; ++vertex) {
    std::vector<std::int64_t> ends;
    for (const auto& [i, j] : pairs) {
      if (i == vertex || j == vertex) ends.push_back(i == vertex ? j : i);
    }
    for (std::size_t a = 0; a < ends.size(); ++a) {
      for (std::size_t b = a + 1; b < ends.size(); ++b, ++count) {
        list += "[" + std::to_string(ends[a]) + ", " + std::to_string(vertex) + ", " +
                std::to_string(ends[b]) + "], ";
      }
    }
  }
  EXPECT_EQ(count, 12 * 3 + 12);
  EXPECT_TRUE(same_bits(ends_of(angles("\"neighbours\"")), ends_of(angles("[" + list + "]"))));
  // Bonds in line with each other have no direction to bend in.
  EXPECT_NE(brief_refusal(
                flexible("[[force]]\ntype = \"expression\"\nenergy = \"theta\"\n", "hexagonal")),
            "");
}

// ---- faults

TEST(Flake, FaultsHaveTheirPlace) {
  const auto faults = [](const std::string& keys) { return faults_with("flake", keys); };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(faults(flake("square", "circle", "3")), Lines());
  EXPECT_EQ(faults(flake("square", "hexagon", "3")),
            Lines{"4:9 body.flake.shape = \"hexagon\" [scene.conflict]"});
  EXPECT_EQ(faults(flake("hexagon", "hexagon", "3")),
            Lines{"3:11 body.flake.lattice = \"hexagon\" [scene.unknown_choice] did you mean "
                  "hexagonal"});
  EXPECT_EQ(faults(flake("hexagonal", "hexagon", "2.5")),
            Lines{"5:8 body.flake.size = 2.5 [component.invalid]"});
  EXPECT_EQ(faults(flake("hexagonal", "hexagon", "[2, 3]")),
            Lines{"5:8 body.flake.size = [2, 3] [scene.wrong_count]"});
  EXPECT_EQ(faults(flake("hexagonal", "circle", "-1")),
            Lines{"5:8 body.flake.size = -1 [scene.out_of_range]"});
  EXPECT_EQ(faults(flake("honeycomb", "circle", "0.5")),
            Lines{"5:8 body.flake.size = 0.5 [scene.out_of_range]"});
  EXPECT_EQ(faults(flake("hexagonal", "circle", "1", "misfit = 7")),
            Lines{"8:10 body.flake.misfit = 7 [scene.out_of_range]"});
  EXPECT_EQ(faults("lattice = \"square\"\nshape = \"square\"\nsize = 1\nlattice_constant = 1\n"
                   "centre = [0]"),
            Lines{"7:10 body.flake.centre = [0] [scene.wrong_count]"});
}

TEST(Flake, OfTooManyParticlesIsRefusedAtOnce) {
  for (const char* size : {"2000", "1e5", "1e12", "1e300"}) {
    for (const auto& [lattice, shape] : kKinds) {
      if (std::string(size) == "2000" && std::string(shape) != "hexagon") continue;
      EXPECT_EQ(faults_with("flake", flake(lattice, shape, size)),
                std::vector<std::string>{"5:8 body.flake.size = " + std::string(size) +
                                         " [scene.too_large]"})
          << lattice << " " << shape;
    }
  }
  EXPECT_EQ(faults_with("flake", flake("square", "rectangle", "[0, 3e7]")).size(), 1U);
  EXPECT_EQ(faults_with("flake", flake("square", "rectangle", "[1e300, 1e300]")).size(), 1U);
}

TEST(Flake, StandsInTheEffectiveSceneAndTakesSettings) {
  EXPECT_TRUE(effective_scene_keeps(
      "flake", flake("honeycomb", "circle", "\"sqrt(7)\"", "misfit = \"pi / 7\"")));
  const BodyGeometry set = shape_of("flake", flake("honeycomb", "circle", "3"),
                                    {{"body.flake.lattice", "\"square\""},
                                     {"body.flake.shape", "\"rectangle\""},
                                     {"body.flake.size", "[2, 4]"},
                                     {"body.flake.lattice_constant", "1.0"},
                                     {"body.flake.misfit", "0.2"}});
  EXPECT_EQ(set.relative, positions_in(flake("square", "rectangle", "[2, 4]", "misfit = 0.2")));
}

TEST(Flake, LiesInAPlaneOfSpaceTooAndScalesWithItsLatticeConstant) {
  const Positions plane = positions_in(flake("honeycomb", "hexagon", "2"));
  const BodyGeometry space = shape_of("flake",
                                      "lattice = \"honeycomb\"\nshape = \"hexagon\"\nsize = 2\n"
                                      "lattice_constant = 4\ncentre = [1, 2, 3]");
  EXPECT_EQ(space.anchor, (std::vector<double>{1.0, 2.0, 3.0}));
  for (std::size_t i = 0; i < plane.size(); ++i) {
    EXPECT_EQ(space.relative[i], (std::vector<double>{4.0 * plane[i][0], 4.0 * plane[i][1], 0.0}));
  }
  EXPECT_EQ(space.rolling_radius, 0.0);
}

}  // namespace
}  // namespace tomlin::test
