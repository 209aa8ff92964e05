#include "tests/support/lammps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/lammps/lammps_input.hpp"
#include "framework/model/single_force.hpp"
#include "tests/support/scenes.hpp"

// LAMMPS computes the same energies and forces from what `tomlin export` writes, and its velocity
// Verlet the same motion. Scenes with tersoff are in eV, Angstrom and ps.

namespace tomlin::test {
namespace {

using Position3 = std::array<double, 3>;

/// Tolerance of energies, relative, and of each force: two programs that round differently, in sums
/// of some hundred terms.
constexpr double kSame = 1e-10;
/// The mass of carbon, 12.0107 u, in eV ps^2/Angstrom^2.
constexpr double kCarbon = 12.0107 * 1.03642696e-4;

#define TOMLIN_NEEDS_LAMMPS() \
  if (!has_lammps()) GTEST_SKIP() << "there is no program lmp (Debian's package lammps)"

std::string positions_text(const std::vector<Position3>& positions, int dimension = 3) {
  std::string text = "positions = [";
  for (const Position3& x : positions) {
    text += "[" + digits(x[0]);
    for (int d = 1; d < dimension; ++d) text += ", " + digits(x[d]);
    text += "], ";
  }
  return text + "]\n";
}

std::string particles(const std::string& name, const std::vector<Position3>& positions,
                      const std::string& more = "", int dimension = 3) {
  return "[[body]]\nname = \"" + name + "\"\ntype = \"particles\"\n" +
         positions_text(positions, dimension) +
         (more.find("particle_mass") == std::string::npos
              ? "particle_mass = " + digits(kCarbon) + "\n"
              : "") +
         more;
}

std::string tersoff(const std::string& body = "",
                    const std::string& parameters = "lindsay_broido_2010") {
  return "[[force]]\nname = \"bonds_" + parameters + body + "\"\ntype = \"tersoff\"\n" +
         (body.empty() ? "" : "body = \"" + body + "\"\n") + "parameters = \"" + parameters +
         "\"\n";
}

std::string steps_of(double dt, int steps = 1) {
  return "[run]\nduration = " + digits(dt * steps) + "\nintegrator = " + verlet(dt) + "\n";
}

/// Returns a sine of a large argument: numbers without a pattern, between -1 and 1.
double jitter(std::size_t k) { return std::sin(12.9898 * static_cast<double>(k + 1) + 78.233); }

std::vector<Position3> displaced(std::vector<Position3> positions, double size) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) positions[i][d] += size * jitter(3 * i + d);
  }
  return positions;
}

/// A zigzag tube (n, 0) along x: rings of n atoms, at distances of half a bond and of a bond by
/// turns, those of every second pair turned by half an angle.
std::vector<Position3> zigzag_tube(int n, int rings, double bond) {
  const double radius = std::sqrt(3.0) * bond * n / kTau;
  std::vector<Position3> positions;
  double x = 0.0;
  for (int ring = 0; ring < rings; ++ring) {
    const double turn = (ring + 1) / 2 % 2 == 0 ? 0.0 : 0.5;
    for (int i = 0; i < n; ++i) {
      const double angle = kTau * (i + turn) / n;
      positions.push_back({x, radius * std::cos(angle), radius * std::sin(angle)});
    }
    x += ring % 2 == 0 ? 0.5 * bond : bond;
  }
  return positions;
}

/// A rectangular cell of four atoms, repeated; x along the armchair direction.
std::vector<Position3> graphene(int along, int across, double bond, Position3& box) {
  const double width = std::sqrt(3.0) * bond;
  box = {3.0 * bond * along, width * across, 20.0};
  std::vector<Position3> positions;
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < across; ++j) {
      const double x = 3.0 * bond * i;
      const double y = width * j;
      positions.push_back({x, y, 0.0});
      positions.push_back({x + bond, y, 0.0});
      positions.push_back({x + 1.5 * bond, y + 0.5 * width, 0.0});
      positions.push_back({x + 2.5 * bond, y + 0.5 * width, 0.0});
    }
  }
  return positions;
}

std::string box_text(const Position3& box, const std::string& periodic) {
  return "[box]\nlengths = [" + digits(box[0]) + ", " + digits(box[1]) + ", " + digits(box[2]) +
         "]\nperiodic = " + periodic + "\n";
}

/// How many pairs are between two distances.
int pairs_within(const std::vector<Position3>& positions, double from, double to) {
  int found = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t j = i + 1; j < positions.size(); ++j) {
      const double r =
          std::hypot(positions[i][0] - positions[j][0], positions[i][1] - positions[j][1],
                     positions[i][2] - positions[j][2]);
      found += r > from && r < to ? 1 : 0;
    }
  }
  return found;
}

/// Forces on all particles that move, [atom][axis], and the energy, at the start.
struct OwnState {
  double energy = 0.0;
  std::vector<Position3> force;
};

OwnState own_state(const Scene& scene) {
  OwnState own;
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    SingleForce single(scene, k);
    if (!single.built()) continue;
    own.energy += single.energy(0.0);
    const double* const force = single.forces(0.0);
    std::size_t atom = 0;
    for (const Model::Body& body : single.model().bodies()) {
      const auto& slot = body.bound.slot;
      own.force.resize(std::max(own.force.size(), atom + slot.count));
      for (std::size_t i = 0; i < slot.count; ++i, ++atom) {
        for (int d = 0; d < scene.dimension; ++d) {
          // Nothing moves there, and LAMMPS shows what is left of its force.
          if (slot.mapped || body.held[d]) continue;
          own.force[atom][d] += force[slot.offset + d * slot.stride + i];
        }
      }
    }
  }
  return own;
}

/// The largest difference between forces of tomlin and of LAMMPS on the scene, and between the
/// energies, relative.
struct Difference {
  double force = 0.0;
  double energy = 0.0;
  double largest_force = 0.0;
};

using ChangeOfFiles = std::function<void(std::vector<LammpsFile>&)>;

/// In these units, or else in those of the scene.
Difference difference(const std::string& text, const std::optional<LammpsUnits>& units = {},
                      const ChangeOfFiles& change = {}) {
  const auto scene = scene_of(text);
  const OwnState own = own_state(*scene);
  std::vector<LammpsFile> files = lammps_input(scene, units.value_or(lammps_units(*scene)));
  if (change) change(files);
  const LammpsState other = run_lammps(files, 0);
  EXPECT_EQ(own.force.size(), other.force.size());
  Difference found;
  if (own.energy != other.energy) {
    found.energy = std::abs(own.energy - other.energy) / std::abs(own.energy);
  }
  for (std::size_t i = 0; i < std::min(own.force.size(), other.force.size()); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      found.force = std::max(found.force, std::abs(own.force[i][d] - other.force[i][d]));
      found.largest_force = std::max(found.largest_force, std::abs(own.force[i][d]));
    }
  }
  return found;
}

/// The largest force at the start that both agree on.
double expect_same(const std::string& text, const std::optional<LammpsUnits>& units = {}) {
  const Difference found = difference(text, units);
  EXPECT_LE(found.energy, kSame) << text.substr(0, 2000);
  EXPECT_LE(found.force, kSame) << text.substr(0, 2000);
  return found.largest_force;
}

/// Positions at the end of the scene's run, [atom][axis].
std::vector<Position3> own_end(const std::string& text) {
  Engine engine(scene_of(text), {});
  EXPECT_EQ(engine.run().status, RunStatus::finished);
  const Model& model = engine.model();
  std::vector<Position3> positions;
  for (const Model::Body& body : model.bodies()) {
    std::vector<double> own(body.bound.slot.count * model.dimension());
    model.place_particles(body.bound.index, model.system().view.position, own.data());
    for (std::size_t i = 0; i < body.bound.slot.count; ++i) {
      Position3& x = positions.emplace_back();
      for (int d = 0; d < model.dimension(); ++d) x[d] = own[i * model.dimension() + d];
    }
  }
  return positions;
}

/// The largest distance along an axis between the ends of both runs.
double distance_at_end(const std::string& text, long steps,
                       const std::optional<LammpsUnits>& units = {}) {
  const std::vector<Position3> own = own_end(text);
  const auto scene = scene_of(text);
  const LammpsState other =
      run_lammps(lammps_input(scene, units.value_or(lammps_units(*scene))), steps);
  EXPECT_EQ(own.size(), other.position.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      largest = std::max(largest, std::abs(own[i][d] - other.position[i][d]));
    }
  }
  return largest;
}

// ---- tersoff

/// Each set, on a tube whose atoms are off their positions.
TEST(Lammps, TersoffOfADisplacedTube) {
  TOMLIN_NEEDS_LAMMPS();
  struct Set {
    const char* name;
    double bond;
  };
  for (const Set& set : {Set{"lindsay_broido_2010", 1.44}, Set{"tersoff_1989_carbon", 1.46},
                         Set{"tersoff_1989_silicon", 2.3}}) {
    const auto positions = displaced(zigzag_tube(10, 8, set.bond), 0.07);
    EXPECT_GT(expect_same(particles("tube", positions) + tersoff("", set.name) + steps_of(1e-3)),
              1.0)
        << set.name;
  }
}

/// Bonds in the taper, between R - D and R + D, and beyond it.
TEST(Lammps, TersoffInTheTaper) {
  TOMLIN_NEEDS_LAMMPS();
  for (const double stretch : {1.4, 1.44, 1.48}) {
    const auto positions = displaced(zigzag_tube(6, 6, 1.42 * stretch), 0.16);
    EXPECT_GE(pairs_within(positions, 1.8, 2.1), 20);
    EXPECT_GE(pairs_within(positions, 2.1, 2.4), 5);
    EXPECT_GT(expect_same(particles("tube", positions) + tersoff() + steps_of(1e-3)), 1.0);
  }
}

/// No neighbour, or one: zeta = 0; in the taper, too. And a chain of three.
TEST(Lammps, TersoffOfFewAtoms) {
  TOMLIN_NEEDS_LAMMPS();
  const std::vector<Position3> positions = {{0.0, 0.0, 0.0},   {9.0, 0.1, 0.2},  {10.3, 0.3, -0.2},
                                            {20.0, 0.0, 0.0},  {20.5, 1.8, 0.4}, {30.0, 0.0, 0.0},
                                            {30.1, 1.3, -0.1}, {30.4, 2.6, 0.5}};
  EXPECT_GT(expect_same(particles("atoms", positions) + tersoff() + steps_of(1e-3)), 1.0);
}

TEST(Lammps, TersoffOfAPeriodicSheet) {
  TOMLIN_NEEDS_LAMMPS();
  Position3 box{};
  const auto flat = graphene(3, 5, 1.43, box);
  for (const std::string periodic : {"[true, true, false]", "[true, true, true]"}) {
    const std::string in_box = box_text(box, periodic);
    for (const double size : {0.0, 0.07}) {
      auto positions = displaced(flat, size);
      // Images elsewhere are the same atoms.
      positions[7][0] += box[0];
      positions[11][1] -= 2.0 * box[1];
      expect_same(in_box + particles("sheet", positions) + tersoff() + steps_of(1e-3));
    }
  }
}

/// Two bodies with potentials of their own are not bonded to each other.
TEST(Lammps, TersoffOfTwoBodies) {
  TOMLIN_NEEDS_LAMMPS();
  const auto one = displaced(zigzag_tube(5, 4, 1.44), 0.05);
  auto other = displaced(zigzag_tube(5, 4, 1.5), 0.04);
  for (Position3& x : other) x[0] += 1.0;
  ASSERT_GT(expect_same(particles("one", one) + particles("other", other) + tersoff("one") +
                        tersoff("other", "tersoff_1989_carbon") + steps_of(1e-3)),
            1.0);
}

/// Three species, all triples of which have numbers of their own, but for those that belong to a
/// bond: LAMMPS takes the repulsion of a pair from one of its two entries. In the units of the
/// scene and in two orders; atoms of two masses.
TEST(Lammps, TersoffOfThreeSpecies) {
  TOMLIN_NEEDS_LAMMPS();
  const std::vector<std::string> names = {"B", "C", "N"};
  std::string entries;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t triple = 9 * i + 3 * j + k;
        const std::size_t bond = 3 * std::min(i, j) + std::max(i, j);  // the same either way
        const auto near = [](double number, std::size_t which) {
          return digits(number * (1.0 + 0.03 * jitter(which)));
        };
        // Zeros are as good as any other number in what does not belong to a bond.
        const auto of_bond = [&](double number, std::size_t which) {
          return j != k && triple % 3 == 1 ? std::string("0") : near(number, which);
        };
        entries += names[i] + " " + names[j] + " " + names[k] + (triple % 2 == 0 ? " 3 " : " 1 ") +
                   near(1.0, triple + 100) + " " + near(1.3, triple + 200) + " " +
                   near(38049.0, triple + 300) + " " + near(4.3484, triple + 400) + " " +
                   near(-0.93, triple + 500) + " " + of_bond(0.72751, triple + 600) + " " +
                   of_bond(1.5724e-7, triple + 700) + " " + of_bond(2.2119, bond + 800) + " " +
                   of_bond(430.0, bond + 900) + " " + near(1.95, (j == k ? bond : triple) + 1000) +
                   " " + near(0.15, (j == k ? bond : triple) + 1100) + " " +
                   of_bond(3.4879, bond + 1200) + " " + of_bond(1393.6, bond + 1300) + "\n";
      }
    }
  }
  const auto positions = displaced(zigzag_tube(8, 8, 1.5), 0.1);
  std::string species = "species = [";
  std::string masses = "particle_mass = [";
  for (std::size_t i = 0; i < positions.size(); ++i) {
    species += "\"" + names[i * i % 7 % 3] + "\", ";
    masses += i % 5 == 0 ? "13.0, " : "11.5, ";
  }
  const std::string scene = "[scene]\nunits = \"metal\"\n" +
                            particles("tube", positions, species + "]\n" + masses + "]\n") +
                            "[[force]]\ntype = \"tersoff\"\nentries = \"\"\"\n" + entries +
                            "\"\"\"\n" + steps_of(1e-3);
  EXPECT_GT(expect_same(scene), 1.0);
}

/// A published potential of two species, whose numbers go by pairs.
TEST(Lammps, TersoffOfSiliconCarbide) {
  TOMLIN_NEEDS_LAMMPS();
  const std::string entries =
      "C C C 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.74 1.95 0.15 3.4879 1393.6\n"
      "C C Si 3 1 0 38049 4.3484 -0.57058 0 0 0 0 2.36 0.15 0 0\n"
      "C Si C 3 1 0 38049 4.3484 -0.57058 0 0 0 0 1.95 0.15 0 0\n"
      "C Si Si 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 1.97205 395.145 2.36 0.15 2.9839 "
      "1597.311\n"
      "Si C C 3 1 0 100390 16.217 -0.59825 0.78734 1.1e-6 1.97205 395.145 2.36 0.15 2.9839 "
      "1597.311\n"
      "Si C Si 3 1 0 100390 16.217 -0.59825 0 0 0 0 2.85 0.15 0 0\n"
      "Si Si C 3 1 0 100390 16.217 -0.59825 0 0 0 0 2.36 0.15 0 0\n"
      "Si Si Si 3 1 0 100390 16.217 -0.59825 0.78734 1.1e-6 1.7322 471.18 2.85 0.15 2.4799 "
      "1830.8\n";
  for (const double bond : {1.5, 1.8, 2.0}) {
    const auto positions = displaced(zigzag_tube(6, 8, bond), 0.15);
    std::string species = "species = [";
    for (std::size_t i = 0; i < positions.size(); ++i)
      species += i % 3 == 0 ? "\"Si\", " : "\"C\", ";
    EXPECT_GT(expect_same("[scene]\nunits = \"metal\"\n" +
                          particles("tube", positions, species + "]\nparticle_mass = 12.0\n") +
                          "[[force]]\ntype = \"tersoff\"\nentries = \"\"\"\n" + entries +
                          "\"\"\"\n" + steps_of(1e-3)),
              1.0);
  }
}

/// A number of the potential that is off by 1e-7 is seen.
TEST(Lammps, APlantedFaultIsSeen) {
  TOMLIN_NEEDS_LAMMPS();
  const auto positions = displaced(zigzag_tube(6, 5, 1.44), 0.05);
  const auto planted = [](std::vector<LammpsFile>& files) {
    for (LammpsFile& file : files) {
      const auto at = file.text.find(" 3.4879 ");
      if (at != std::string::npos) file.text.replace(at, 8, " 3.4879003 ");
    }
  };
  const Difference found = difference(particles("tube", positions) + tersoff() + steps_of(1e-3),
                                      kLammpsReduced, planted);
  EXPECT_GT(found.energy, 10.0 * kSame);
  EXPECT_GT(found.force, 10.0 * kSame);
}

// ---- lennard_jones

std::string lennard_jones(const std::string& name, const std::string& bodies,
                          const std::string& at_cutoff, double cutoff = 2.5) {
  return "[[force]]\nname = \"" + name + "\"\ntype = \"lennard_jones\"\n" + bodies +
         "\nepsilon = 0.7\nsigma = 1.1\ncutoff = " + digits(cutoff) + "\nat_cutoff = \"" +
         at_cutoff + "\"\n";
}

std::vector<Position3> lump(int side, double spacing, double jitter_size, const Position3& at) {
  std::vector<Position3> positions;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        positions.push_back({at[0] + spacing * i, at[1] + spacing * j, at[2] + spacing * k});
      }
    }
  }
  return displaced(std::move(positions), jitter_size);
}

TEST(Lammps, LennardJonesWithinAndBetween) {
  TOMLIN_NEEDS_LAMMPS();
  const std::string mass = "particle_mass = 1.0\n";
  const std::string bodies = particles("a", lump(3, 1.2, 0.1, {0.0, 0.0, 0.0}), mass) +
                             particles("b", lump(3, 1.3, 0.1, {3.7, 0.3, 0.2}), mass) +
                             particles("c", lump(2, 1.2, 0.1, {0.2, 0.1, 3.8}), mass);
  for (const std::string at_cutoff : {"cut", "shift", "smooth"}) {
    // Within one body; between two, in either order; several times between the same.
    EXPECT_GT(
        expect_same(bodies + lennard_jones("one", "body = \"b\"", at_cutoff) + steps_of(1e-3)),
        1.0);
    EXPECT_GT(
        expect_same(bodies + lennard_jones("one", "bodies = [\"a\", \"b\"]", at_cutoff) +
                    lennard_jones("two", "bodies = [\"c\", \"a\"]", at_cutoff, 3.1) +
                    lennard_jones("three", "bodies = [\"a\", \"c\"]", "cut", 1.9) + steps_of(1e-3)),
        1.0);
  }
}

/// Numbers by species, all of them given or mixed, within a body and between two in either order.
TEST(Lammps, LennardJonesBySpecies) {
  TOMLIN_NEEDS_LAMMPS();
  const auto of_species = [](const std::vector<std::string>& cycle, std::size_t count) {
    std::string list = "particle_mass = 1.0\nspecies = [";
    for (std::size_t i = 0; i < count; ++i) list += "\"" + cycle[i % cycle.size()] + "\", ";
    return list + "]\n";
  };
  const std::string bodies =
      particles("a", lump(3, 1.2, 0.1, {0.0, 0.0, 0.0}), of_species({"A", "B", "C", "B"}, 27)) +
      particles("b", lump(2, 1.3, 0.1, {3.7, 0.3, 0.2}), of_species({"C", "A"}, 8));
  const auto force = [](const std::string& name, const std::string& on,
                        const std::string& entries) {
    return "[[force]]\nname = \"" + name + "\"\ntype = \"lennard_jones\"\n" + on +
           "\nentries = \"\"\"\n" + entries + "cutoff = 2.5\n";
  };
  const std::string mixed =
      "A A 0.7 1.1\nB B 0.3 0.9\nC C 1.2 1.0\nB A 0.9 1.05\n\"\"\"\nmixing = "
      "\"lorentz_berthelot\"\n";
  const std::string given =
      "A A 0.7 1.1\nB C 0.3 0.9\nC C 1.2 1.0\nB A 0.9 1.05\nC A 0.1 1.2\n\"\"\"\n";
  for (const std::string& on :
       {std::string("bodies = [\"a\", \"b\"]"), std::string("bodies = [\"b\", \"a\"]")}) {
    EXPECT_GT(expect_same(bodies + force("within", "body = \"a\"", mixed) +
                          force("between", on, given) + steps_of(1e-3)),
              1.0);
  }
}

/// In a plane, in a box, with particles of several masses.
TEST(Lammps, LennardJonesInAPlane) {
  TOMLIN_NEEDS_LAMMPS();
  std::vector<Position3> positions;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) positions.push_back({1.2 * i, 1.2 * j, 0.0});
  }
  positions = displaced(positions, 0.1);
  std::string masses = "particle_mass = [";
  for (int i = 0; i < 36; ++i) masses += digits(1.0 + i % 3) + ", ";
  EXPECT_GT(expect_same("[box]\nlengths = [7.2, 7.3]\nperiodic = [true, false]\n" +
                        particles("a", positions, masses + "]\n", 2) +
                        lennard_jones("one", "body = \"a\"", "smooth") + steps_of(1e-3)),
            1.0);
}

/// A body that is fixed is acted on by nothing, and nothing acts within it; a body with a tersoff
/// potential of its own takes part.
TEST(Lammps, TubeOnAFixedSheet) {
  TOMLIN_NEEDS_LAMMPS();
  Position3 box{};
  auto sheet = graphene(5, 8, 1.44, box);
  auto tube = displaced(zigzag_tube(5, 4, 1.44), 0.05);
  for (Position3& x : tube) x = {x[0] + 5.0, x[1] + 8.0, x[2] + 5.2};
  const std::string scene =
      box_text(box, "[true, true, false]") + particles("tube", tube) +
      particles("sheet", sheet, "coordinates = \"fixed\"\n") + tersoff("tube") + tersoff("sheet") +
      "[[force]]\ntype = \"lennard_jones\"\nbodies = [\"tube\", \"sheet\"]\nepsilon = "
      "0.002411\nsigma = 3.4\ncutoff = 5.3\n" +
      steps_of(1e-3);
  EXPECT_GT(expect_same(scene), 1.0);
  EXPECT_GT(expect_same(scene, kLammpsMetal), 1.0);
}

// ---- bonds, drivers, damping, substrates

std::string bonds(const std::string& type, const std::string& more) {
  return "[[force]]\ntype = \"" + type + "\"\n" + more + "\n";
}

TEST(Lammps, BondsInEachDimension) {
  TOMLIN_NEEDS_LAMMPS();
  for (const int dimension : {1, 2, 3}) {
    std::vector<Position3> positions;
    for (int i = 0; i < 9; ++i) positions.push_back({1.1 * i, 0.0, 0.0});
    positions = displaced(positions, 0.2);
    const std::string body = particles("chain", positions, "particle_mass = 2.0\n", dimension);
    const std::string harmonic =
        bonds("harmonic_bonds",
              "name = \"next\"\npairs = \"neighbours\"\nstiffness = 3.0\nrest_lengths = 1.0");
    const std::string morse = bonds(
        "morse_bonds", "pairs = \"all\"\ndepth = 0.8\ninverse_width = 0.9\nrest_lengths = 1.2");
    const std::string initial =
        bonds("harmonic_bonds", "pairs = [[0, 4], [1, 8], [2, 3]]\nstiffness = 3.0\nname = \"a\"");
    EXPECT_GT(expect_same(body + (dimension == 2 ? morse : harmonic) + steps_of(1e-2)), 0.1);
    EXPECT_GT(expect_same(body + harmonic + morse + initial + steps_of(1e-2)), 0.1);
  }
}

/// The last bond of a chain passes through the side of the box, and bonds join two bodies.
TEST(Lammps, BondsThroughTheBoxAndBetweenBodies) {
  TOMLIN_NEEDS_LAMMPS();
  const std::string chain = R"([box]
lengths = [11.0]
periodic = [true]
[[body]]
name = "chain"
type = "chain"
count = 10
spacing = 1.1
displacement = [[0.1], [0.0], [-0.1], [0.2], [0.1], [0.0], [0.0], [-0.3], [0.0], [0.2]]
particle_mass = 1.0
)";
  EXPECT_GT(expect_same(chain +
                        bonds("harmonic_bonds",
                              "pairs = \"neighbours\"\nstiffness = 2.0\nrest_lengths = 1.0") +
                        steps_of(1e-2)),
            0.1);
  const std::string two = particles("a", lump(2, 1.2, 0.1, {0.0, 0.0, 0.0})) +
                          particles("b", lump(2, 1.3, 0.1, {0.5, 3.0, 0.2}));
  EXPECT_GT(expect_same(two +
                        bonds("morse_bonds",
                              "bodies = [\"a\", \"b\"]\npairs = \"all\"\ndepth = 0.8\n"
                              "inverse_width = 0.9\nrest_lengths = 2.5") +
                        steps_of(1e-2)),
            0.1);
}

std::string moving_ring(int dimension, const std::string& more = "") {
  std::vector<Position3> positions;
  for (int i = 0; i < 5; ++i) {
    positions.push_back({1.3 + std::cos(kTau * i / 5), 0.4 + std::sin(kTau * i / 5), 0.2});
  }
  std::string velocities = "velocity = [";
  for (std::size_t i = 0; i < 5; ++i) {
    velocities += "[" + digits(jitter(i));
    for (int d = 1; d < dimension; ++d) velocities += ", " + digits(jitter(10 * d + i));
    velocities += "], ";
  }
  return particles("ring", positions,
                   velocities + "]\nparticle_mass = [1.0, 2.0, 0.5, 1.0, 3.0]\n" + more, dimension);
}

/// `text` of a vector, of as many numbers as there are dimensions.
std::string first_of(const std::vector<double>& numbers, int dimension) {
  std::string text = "[" + digits(numbers[0]);
  for (int d = 1; d < dimension; ++d) text += ", " + digits(numbers[d]);
  return text + "]";
}

TEST(Lammps, DriversAndForcesOnParticles) {
  TOMLIN_NEEDS_LAMMPS();
  for (const int dimension : {1, 2, 3}) {
    const std::string velocity = "velocity = " + first_of({0.3, -0.1, 0.2}, dimension) + "\n";
    const std::string start = "start = " + first_of({0.5, 1.5, -0.2}, dimension) + "\n";
    const auto spring = [&](const std::string& name, const std::string& more) {
      return "[[force]]\nname = \"" + name + "\"\ntype = \"driving_spring\"\nstiffness = 2.0\n" +
             velocity + more;
    };
    const std::string on_centre = spring("one", start);
    const std::string on_particles = spring("two", start + "attach = \"each_particle\"\n") +
                                     spring("three", start + "attach = { particle = 3 }\n") +
                                     spring("four", start + "axes = [\"x\"]\n") +
                                     spring("five", "");
    const std::string fields =
        "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.7\n"
        "[[force]]\ntype = \"constant_force\"\nforce = " +
        first_of({0.3, -0.7, 0.1}, dimension) +
        "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = -0.3\nperiod = 1.7\noffset = "
        "0.2\n" +
        (dimension > 1 ? "decay = 0.4\n" : "");
    for (const std::string& forces : {on_centre, on_particles, fields}) {
      EXPECT_GT(expect_same(moving_ring(dimension) + forces + steps_of(1e-2)), 0.1);
    }
  }
}

/// At temperature 1e-40 noise is less than rounding, and friction is left, the same coefficient
/// for each mass.
TEST(Lammps, FrictionOfAThermostat) {
  TOMLIN_NEEDS_LAMMPS();
  const std::string scene =
      moving_ring(2) +
      "[[force]]\ntype = \"langevin\"\ncoefficient = 0.7\ntemperature = 1e-40\n[run]\nduration = "
      "1.0\nintegrator = { type = \"baoab\", dt = 1e-2 }\n";
  EXPECT_GT(expect_same(scene), 0.1);
  EXPECT_GT(expect_same(scene, kLammpsMetal), 0.1);
}

// ---- motion

/// 1000 steps of half a femtosecond at several hundred kelvin: in metal units, too, where the
/// rounded constants of LAMMPS are compensated.
TEST(Lammps, TheSameMotionOfATube) {
  TOMLIN_NEEDS_LAMMPS();
  constexpr double kNear = 1e-10;        // Angstrom
  constexpr double kTemperature = 0.06;  // eV; half of it goes into the bonds: 350 K
  const std::string scene = particles("tube", zigzag_tube(10, 8, 1.44),
                                      "start_temperature = " + digits(kTemperature) + "\n") +
                            tersoff() + steps_of(5e-4, 1000);
  EXPECT_LT(distance_at_end(scene, 1000), kNear);
  EXPECT_LT(distance_at_end(scene, 1000, kLammpsMetal), kNear);
  const std::string in_metal =
      "[scene]\nunits = \"metal\"\n" +
      particles("tube", zigzag_tube(10, 8, 1.44),
                "particle_mass = 12.0107\nspecies = \"C\"\nstart_temperature = 700.0\n") +
      tersoff() + steps_of(5e-4, 1000);
  EXPECT_LT(distance_at_end(in_metal, 1000), kNear);
  // Uncompensated masses would be seen.
  LammpsUnits codata = kLammpsMetal;
  codata.mass = 1.03642696e-4 * (1.0 + 1e-7);
  EXPECT_GT(distance_at_end(scene, 1000, codata), 10.0 * kNear);
}

/// Bodies that are fixed, moved, or held along an axis; a driver whose end moves; a chain in a box
/// that leaves it.
TEST(Lammps, TheSameMotionOfDrivenBodies) {
  TOMLIN_NEEDS_LAMMPS();
  constexpr double kNear = 1e-10;
  const std::string mass = "particle_mass = 1.0\n";
  const std::string slider = particles("slider", lump(3, 1.2, 0.05, {0.0, 0.0, 0.0}),
                                       mass + "hold = [\"y\"]\nvelocity = [0.5, 0.0, 0.1]\n");
  const std::string base = "particle_mass = 1.0\ncoordinates = \"fixed\"\n";
  const std::string moved =
      "particle_mass = 1.0\ncoordinates = \"prescribed\"\nmotion = { velocity = [0.2, -0.1, 0.0] "
      "}\n";
  const std::string forces =
      lennard_jones("within", "body = \"slider\"", "smooth") +
      lennard_jones("between", "bodies = [\"slider\", \"base\"]", "smooth") +
      "[[force]]\ntype = \"driving_spring\"\nbody = \"slider\"\nstiffness = 4.0\nvelocity = [0.3, "
      "0.0, 0.0]\n" +
      steps_of(2e-3, 1000);
  for (const std::string& more : {base, moved}) {
    EXPECT_LT(
        distance_at_end(
            slider + particles("base", lump(3, 1.2, 0.05, {0.1, 0.2, -3.6}), more) + forces, 1000),
        kNear);
  }
  const std::string chain = R"([box]
lengths = [8.0]
periodic = [true]
[[body]]
type = "chain"
count = 5
spacing = 1.6
displacement = [[0.1], [0.0], [-0.1], [0.2], [0.1]]
velocity = [5.0]
particle_mass = 1.0
[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.2
period = 2.0
[[force]]
type = "driving_spring"
stiffness = 0.3
velocity = [4.0]
attach = "each_particle"
)";
  EXPECT_LT(distance_at_end(chain + steps_of(4e-3, 1000), 1000), kNear);
}

#undef TOMLIN_NEEDS_LAMMPS

}  // namespace
}  // namespace tomlin::test
