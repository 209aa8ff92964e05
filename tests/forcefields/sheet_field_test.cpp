#include "forcefields/sheet_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/model/single_force.hpp"
#include "tests/support/conformance.hpp"
#include "tests/support/scenes.hpp"

// The field of a sheet against sums over its atoms, against its symmetries, and against Steele's
// closed form of the first harmonic.

namespace tomlin::test {
namespace {

constexpr unsigned kSeedsOfPoints[] = {3, 58, 1917};
constexpr double kBond = 1.42;
constexpr double kEpsilon = 0.002411;
constexpr double kSigma = 3.4;
constexpr double kCutoff = 10.0;
/// A sheet of graphene of this bond has a well this deep and an attraction this strong at most, to
/// a part in a hundred.
constexpr double kDepth = 0.035;
constexpr double kPull = 0.0216;
/// At other positions than those at which the error was measured it may be larger, by hardly more.
constexpr double kElsewhere = 1.5;
/// Some hundred roundings of energies and forces of the order of the well, in it and above.
constexpr double kRoundingOfField = 1e-15;

using Space = std::array<double, 3>;

std::string graphene(const std::string& more = "coordinates = \"fixed\"\n",
                     const std::string& periodic = "[true, true, false]") {
  return "[box]\nlengths = [" + digits(8 * 3 * kBond) + ", " + digits(12 * std::sqrt(3.0) * kBond) +
         ", 60.0]\nperiodic = " + periodic +
         "\n[[body]]\nname = \"sheet\"\ntype = \"graphene\"\nbond_length = 1.42\ncells = [8, "
         "12]\nparticle_mass = 12.0\ncentre = [0.1, 0.2, 0.3]\n" +
         more;
}

std::string atoms_at(const std::vector<Space>& positions) {
  std::string list;
  for (const Space& x : positions) {
    list += "[" + digits(x[0]) + ", " + digits(x[1]) + ", " + digits(x[2]) + "], ";
  }
  return "[[body]]\nname = \"atoms\"\ntype = \"particles\"\nparticle_mass = 12.0\npositions = [" +
         list + "]\n";
}

std::string with_sheet(const std::string& type, const std::string& more = "") {
  return "[[force]]\ntype = \"" + type +
         "\"\nbodies = [\"atoms\", \"sheet\"]\nepsilon = " + digits(kEpsilon) +
         "\nsigma = 3.4\ncutoff = 10.0\n" + more;
}

std::string field_of_sheet(double tolerance) {
  return with_sheet("sheet_field", "tolerance = " + digits(tolerance) + "\n");
}

const std::string kRunOfAtoms = "[run]\nduration = 1.0\nintegrator = " + verlet(0.01) + "\n";

/// One force on one atom that is put anywhere.
class OnAtom {
 public:
  explicit OnAtom(const std::string& force, const std::string& sheet = graphene())
      : scene_(scene_of(sheet + atoms_at({{0.0, 0.0, 4.0}}) + force + kRunOfAtoms)),
        force_(*scene_, 0) {}

  double energy(const Space& x) {
    put(x);
    return force_.energy(0.0);
  }
  Space force(const Space& x) {
    put(x);
    const double* f = force_.forces(0.0);
    Space found{};
    for (const auto& variable : force_.variables()) {
      found[static_cast<std::size_t>(variable.axis)] = f[variable.at];
    }
    return found;
  }
  std::string note() { return force_.force().diagnosis->note(); }

 private:
  void put(const Space& x) {
    for (const auto& variable : force_.variables()) {
      force_.position(variable) = x[static_cast<std::size_t>(variable.axis)];
    }
  }

  std::shared_ptr<const Scene> scene_;
  SingleForce force_;
};

/// Positions on both sides of a sheet at the height 0.3, from the nearest to a little beyond the
/// cutoff, more of them near.
std::vector<Space> random_positions(unsigned seed, std::size_t count,
                                    double lowest = 0.61 * kSigma) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Space> positions;
  for (std::size_t k = 0; k < count; ++k) {
    const double u = uniform(random);
    const double z = lowest + (1.02 * kCutoff - lowest) * u * u;
    const double x = 100.0 * uniform(random) - 50.0;
    const double y = 100.0 * uniform(random) - 50.0;
    positions.push_back({x, y, 0.3 + (k % 2 == 0 ? z : -z)});
  }
  return positions;
}

void expect_within(OnAtom& field, OnAtom& pairs, const Space& x, double tolerance, double depth,
                   double pull) {
  const double energy = pairs.energy(x);
  EXPECT_NEAR(field.energy(x), energy, kElsewhere * tolerance * std::max(depth, std::abs(energy)))
      << x[0] << " " << x[1] << " " << x[2];
  const Space expected = pairs.force(x);
  const Space found = field.force(x);
  const double allowed = kElsewhere * tolerance * std::max(pull, std::abs(expected[2]));
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(found[d], expected[d], allowed) << x[2] << " " << d;
}

TEST(SheetField, AgreesWithLennardJonesToItsTolerance) {
  OnAtom pairs(with_sheet("lennard_jones"));
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 2e-5}) {
    OnAtom field(field_of_sheet(tolerance));
    for (const unsigned seed : kSeedsOfPoints) {
      for (const Space& x : random_positions(seed, 200)) {
        expect_within(field, pairs, x, tolerance, kDepth, kPull);
      }
    }
  }
}

/// A loose tolerance is used: the field is not better than it needs to be.
TEST(SheetField, IsNoMoreExactThanAsked) {
  OnAtom pairs(with_sheet("lennard_jones"));
  OnAtom field(field_of_sheet(1e-2));
  double worst = 0.0;
  for (const Space& x : random_positions(kSeedsOfPoints[0], 400)) {
    const Space expected = pairs.force(x);
    const Space found = field.force(x);
    for (std::size_t d = 0; d < 3; ++d) {
      worst = std::max(worst,
                       std::abs(found[d] - expected[d]) / std::max(kPull, std::abs(expected[2])));
    }
  }
  EXPECT_GT(worst, 1e-4);
}

TEST(SheetField, EndsAtTheCutoff) {
  OnAtom pairs(with_sheet("lennard_jones"));
  OnAtom field(field_of_sheet(1e-4));
  for (const double side : {1.0, -1.0}) {
    for (const double beyond : {0.0, 1e-9, 1.0, 1e6}) {
      const Space x = {0.4, 0.7, 0.3 + side * (kCutoff + beyond + 1e-12)};
      EXPECT_EQ(field.energy(x), 0.0);
      for (const double f : field.force(x)) EXPECT_EQ(f, 0.0);
    }
    for (const double before : {1e-6, 1e-3, 0.03}) {
      const Space x = {0.4, 0.7, 0.3 + side * (kCutoff - before)};
      // The energy falls with the third power of the distance from the cutoff.
      EXPECT_NEAR(field.energy(x), pairs.energy(x), 1e-4 * kDepth * std::min(1.0, 10.0 * before));
      EXPECT_NEAR(field.force(x)[2], pairs.force(x)[2],
                  1e-4 * kPull * std::min(1.0, 10.0 * before));
    }
  }
}

TEST(SheetField, HasTheSymmetriesOfGraphene) {
  OnAtom field(field_of_sheet(1e-4));
  // In the corner of the sheet, whose first atom is at 0 and -s of this: the middle of a hexagon.
  const double h = 0.5 * std::sqrt(3.0) * kBond;
  const Space middle = {0.1 + 0.5 * kBond * (-2.0 - 21.0) + kBond, 0.2 - 0.5 * h * 23.0, 0.3};
  for (const unsigned seed : kSeedsOfPoints) {
    for (const Space& x : random_positions(seed, 40, kSigma)) {
      const double energy = field.energy(x);
      const Space force = field.force(x);
      const auto expect_same = [&](const Space& position, const Space& expected, const char* what) {
        EXPECT_NEAR(field.energy(position), energy, kRoundingOfField) << what;
        const Space found = field.force(position);
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_NEAR(found[d], expected[d], 10.0 * kRoundingOfField) << what << d;
        }
      };
      expect_same({x[0], x[1] + 2.0 * h, x[2]}, force, "lattice vector along zigzag");
      expect_same({x[0] + 1.5 * kBond, x[1] - h, x[2]}, force, "another");
      expect_same({x[0], x[1], 0.6 - x[2]}, {force[0], force[1], -force[2]}, "mirror across z");
      expect_same({2.0 * middle[0] - x[0], x[1], x[2]}, {-force[0], force[1], force[2]},
                  "mirror across x");
      const double c = 0.5;
      const double s = 0.5 * std::sqrt(3.0);
      const double u = x[0] - middle[0];
      const double v = x[1] - middle[1];
      expect_same({middle[0] + c * u - s * v, middle[1] + s * u + c * v, x[2]},
                  {c * force[0] - s * force[1], s * force[0] + c * force[1], force[2]},
                  "sixth of a turn");
      // It is no symmetry about an atom.
      EXPECT_EQ(std::abs(field.energy({x[0] + 0.3, x[1], x[2]}) - energy) < kRoundingOfField,
                std::abs(x[2] - 0.3) >= kCutoff);
    }
  }
}

TEST(SheetField, PullsDownItsEnergy) {
  OnAtom field(field_of_sheet(1e-4));
  constexpr double kStep = 1e-4;
  for (const unsigned seed : kSeedsOfPoints) {
    for (const Space& x : random_positions(seed, 100)) {
      const Space force = field.force(x);
      for (std::size_t d = 0; d < 3; ++d) {
        const auto energy = [&](double steps) {
          Space moved = x;
          moved[d] += steps * kStep;
          return field.energy(moved);
        };
        const double slope =
            (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * kStep);
        // Rounding of the energy over the step, and jumps of the third derivative.
        EXPECT_NEAR(force[d], -slope, 1e-8 * std::max(kPull, std::abs(force[2]))) << x[2];
      }
    }
  }
}

/// Less than a group of particles, a whole one and more, free and rigid, near the sheet and through
/// the cutoff.
TEST(SheetField, HasItsVerifiedProperties) {
  const ForceRecord& record = *standard().force("sheet_field");
  Conformance check(record);
  for (const std::uint64_t seed : {20240611u, 7u, 424242u}) check.examine_example(seed);
  for (const std::size_t count : {1, 6, 8, 11}) {
    const std::string coordinates =
        count % 3 == 0 ? "coordinates = \"rigid\"\nhold = [\"rotation\"]\n" : "";
    check.examine(
        *scene_of(graphene() + atoms_at(random_positions(kSeedsOfPoints[count % 3], count, 3.0)) +
                  coordinates + field_of_sheet(1e-3) + kRunOfAtoms),
        count);
  }
  EXPECT_EQ(check.broken(), (std::map<std::string, std::string>{}));
}

/// The others in its group of eight, and their need for more harmonics, do not affect a particle.
TEST(SheetField, OfAParticleHasTheBitsOfThatParticleAlone) {
  for (const unsigned seed : kSeedsOfPoints) {
    const std::vector<Space> positions = random_positions(seed, 37);
    const auto scene =
        scene_of(graphene() + atoms_at(positions) + field_of_sheet(1e-4) + kRunOfAtoms);
    SingleForce together(*scene, 0);
    const double* f = together.forces(0.0);
    OnAtom alone(field_of_sheet(1e-4));
    const auto& variables = together.variables();
    for (std::size_t i = 0; i < positions.size(); ++i) {
      Space x{};
      for (std::size_t d = 0; d < 3; ++d)
        x[d] = together.position(variables[d * positions.size() + i]);
      const Space expected = alone.force(x);
      for (std::size_t d = 0; d < 3; ++d)
        EXPECT_EQ(f[variables[d * positions.size() + i].at], expected[d]);
    }
  }
}

TEST(SheetField, ConservesEnergyToTheSquareOfTheStep) {
  const auto lost = [](double dt) {
    const RunResult result = run_text(
        graphene() +
        "[[body]]\nname = \"atoms\"\ntype = \"particles\"\nparticle_mass = 1.0\npositions = "
        "[[0.1, 0.3, 3.4], [5.0, 1.0, 4.4], [2.0, 2.0, -3.2]]\nvelocity = [0.05, 0.02, 0.0]\n" +
        field_of_sheet(1e-4) + "[run]\nduration = 96.0\nledger = true\nintegrator = " + verlet(dt) +
        "\n");
    return std::abs(*result.group("energy")["numerical_work"]);
  };
  const double coarse = lost(0.4);
  const double fine = lost(0.2);
  const double finer = lost(0.1);
  EXPECT_GT(coarse, 1e-8);
  EXPECT_NEAR(coarse / fine, 4.0, 0.6);
  EXPECT_NEAR(fine / finer, 4.0, 0.3);
}

SheetAtoms atoms_of_graphene() {
  std::vector<SheetPoint> atoms;
  const double h = 0.5 * std::sqrt(3.0) * kBond;
  for (int row = 0; row < 8; ++row) {
    for (int position = 0; position < 12; ++position) {
      const double s = 3.0 * kBond * row;
      const double t = 2.0 * h * position;
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.5, 1.0}, {1.5, 1.0}, {2.0, 0.0}}) {
        atoms.push_back({s + x * kBond, t + y * h});
      }
    }
  }
  return {atoms, {24.0 * kBond, 24.0 * h}};
}

SheetLaw law_with_cutoff(double cutoff) {
  LennardJonesDescription d;
  d.epsilon = kEpsilon;
  d.sigma = kSigma;
  d.cutoff = cutoff;
  const auto p = LennardJonesSmooth::parameters<double, 3>(d);
  return {p.four_epsilon, p.sigma_squared, p.at_cutoff, p.slope, p.cutoff};
}

/// Steele's coefficients for a pair energy without a cutoff:
///   V_G(z) = 4 epsilon/A (2 pi sigma^12/5! (g/2z)^5 K_5(g z) - 2 pi sigma^6/2! (g/2z)^2 K_2(g z))
/// times the sum over the atoms of a cell; g = 2 pi |G|.
TEST(SheetField, HasSteelesFirstHarmonic) {
  const FoundLattice found = find_lattice(atoms_of_graphene());
  ASSERT_EQ(found.fault, "");
  const SheetLattice& lattice = found.lattice;
  EXPECT_NEAR(lattice.area, 1.5 * std::sqrt(3.0) * kBond * kBond, 1e-12);
  ASSERT_EQ(lattice.atoms.size(), 2u);
  const double g = 4.0 * M_PI / (3.0 * kBond);
  const auto steele = [&](double z) {
    const double half = g / (2.0 * z);
    const double repulsion =
        std::pow(kSigma, 12) / 120.0 * std::pow(half, 5) * std::cyl_bessel_k(5.0, g * z);
    const double attraction =
        std::pow(kSigma, 6) / 2.0 * half * half * std::cyl_bessel_k(2.0, g * z);
    return 8.0 * M_PI * kEpsilon / lattice.area * (repulsion - attraction);
  };
  const SheetTable table = make_sheet_table(lattice, law_with_cutoff(16.0), kSigma, 1e-4, 0);
  // From the middle of a hexagon the two atoms of a cell are at phases of 120 degrees either way:
  // cosines of -1/2, and each counts for G and -G. Atoms are maxima where they repel.
  EXPECT_NEAR(table.first, -2.0 * steele(table.equilibrium), 2e-3 * std::abs(table.first));
  const double h = 1e-3;
  const double decay = (std::log(std::abs(steele(table.equilibrium - h))) -
                        std::log(std::abs(steele(table.equilibrium + h)))) /
                       (2.0 * h);
  EXPECT_NEAR(table.first_decay, decay, 1e-2 * decay);
}

/// A harmonic that is lost or another one, or a number of the spline.
TEST(SheetField, MeasuresTheErrorOfAFault) {
  const SheetAtoms atoms = atoms_of_graphene();
  const SheetLattice lattice = find_lattice(atoms).lattice;
  constexpr double kTolerance = 1e-3;
  const SheetTable valid =
      make_sheet_table(lattice, law_with_cutoff(kCutoff), kSigma, kTolerance, 0);
  EXPECT_LT(measure_sheet_error(valid, atoms).relative, kTolerance);
  ASSERT_GE(valid.stars(), 4u);
  const auto heights = static_cast<std::size_t>(valid.numbers[1]);
  const std::size_t row = SheetTable::kKnot * valid.stars();
  for (std::size_t lost = 0; lost < valid.stars(); ++lost) {
    SheetTable without = valid;
    for (std::size_t at = heights + SheetTable::kKnot * lost; at < valid.numbers.size();
         at += row) {
      std::fill_n(without.numbers.begin() + static_cast<std::ptrdiff_t>(at), SheetTable::kKnot,
                  0.0);
    }
    EXPECT_GT(measure_sheet_error(without, atoms).relative, 1.5 * kTolerance) << "star " << lost;
  }
  SheetTable turned = valid;
  double& n = turned.numbers[SheetTable::kHead + SheetTable::kStarHead + 1];
  n = n == 0.0 ? 1.0 : -n;
  EXPECT_GT(measure_sheet_error(turned, atoms).relative, 0.01);
  SheetTable bent = valid;
  bent.numbers[heights + 8 * row] *= 1.5;
  EXPECT_GT(measure_sheet_error(bent, atoms).relative, kTolerance);
}

/// Other lattices of one or two atoms a cell, some of them oblique.
TEST(SheetField, KnowsOtherLattices) {
  struct CellOfLattice {
    const char* name;
    double width, length;           // of a rectangle that the box repeats
    std::vector<SheetPoint> atoms;  // in it, in parts
    std::size_t in_cell;
  };
  const std::vector<CellOfLattice> cells = {
      {"square", 2.9, 2.9, {{0.1, 0.2}}, 1},
      {"rectangular", 2.5, 3.6, {{0.0, 0.0}}, 1},
      {"centred", 3.1, 4.3, {{0.0, 0.0}, {0.5, 0.5}}, 1},
      {"two in a cell", 3.3, 3.9, {{0.1, 0.1}, {0.4, 0.35}}, 2},
      {"oblique", 5.2, 4.8, {{0.0, 0.0}, {1.0 / 3.0, 1.0 / 3.0}, {2.0 / 3.0, 2.0 / 3.0}}, 1}};
  for (const CellOfLattice& cell : cells) {
    const int along = static_cast<int>(24.0 / cell.width) + 1;
    const int across = static_cast<int>(24.0 / cell.length) + 1;
    std::string list;
    std::vector<SheetPoint> plane;
    for (int i = 0; i < along; ++i) {
      for (int j = 0; j < across; ++j) {
        for (const SheetPoint& atom : cell.atoms) {
          plane.push_back({(i + atom[0]) * cell.width, (j + atom[1]) * cell.length});
          list += "[" + digits(plane.back()[0]) + ", " + digits(plane.back()[1]) + ", 0.3], ";
        }
      }
    }
    const SheetPoint box = {along * cell.width, across * cell.length};
    const FoundLattice found = find_lattice(SheetAtoms(plane, box));
    ASSERT_EQ(found.fault, "") << cell.name;
    EXPECT_EQ(found.lattice.atoms.size(), cell.in_cell) << cell.name;
    EXPECT_NEAR(found.lattice.area * static_cast<double>(plane.size()),
                static_cast<double>(cell.in_cell) * box[0] * box[1], 1e-9)
        << cell.name;
    const std::string sheet = "[box]\nlengths = [" + digits(box[0]) + ", " + digits(box[1]) +
                              ", 60.0]\nperiodic = [true, true, true]\n[[body]]\nname = "
                              "\"sheet\"\ntype = \"particles\"\nparticle_mass = 1.0\ncoordinates = "
                              "\"fixed\"\npositions = [" +
                              list + "]\n";
    constexpr double kLoose = 1e-3;
    OnAtom pairs(with_sheet("lennard_jones"), sheet);
    OnAtom field(field_of_sheet(kLoose), sheet);
    // Nearer to these sheets a force is far from the mean at its height, of which the tolerance is.
    for (const Space& x : random_positions(kSeedsOfPoints[1], 100, 0.8 * kSigma)) {
      expect_within(field, pairs, x, kLoose, kDepth, kPull);
      const Space image = {x[0], x[1], x[2] + 120.0};
      EXPECT_NEAR(field.energy(image), field.energy(x), 1e-9 * std::abs(field.energy(x)) + 1e-15);
    }
  }
}

TEST(SheetField, FailsWhereItDoesNotKnowItself) {
  const RunResult result = run_text(
      graphene() +
      "[[body]]\nname = \"atoms\"\ntype = \"particles\"\nparticle_mass = 1.0\npositions = [[0.1, "
      "0.3, 6.0], [0.2, 0.3, 3.0]]\nvelocity = [[0.0, 0.0, 0.0], [0.0, 0.0, -5.0]]\n" +
      field_of_sheet(1e-3) + kRunOfAtoms);
  ASSERT_EQ(result.status, RunStatus::failed);
  EXPECT_NE(result.failure->cause.find("particle 1 of \"atoms\""), std::string::npos)
      << result.failure->cause;
  EXPECT_NE(result.failure->cause.find("from the sheet \"sheet\""), std::string::npos)
      << result.failure->cause;
}

TEST(SheetField, SaysWhatItFound) {
  OnAtom field(field_of_sheet(1e-4));
  const std::string note = field.note();
  for (const char* part : {"lattice vectors of 2.45951 and 2.45951", "2 particles a cell",
                           "well at", "first harmonics", "measured error"}) {
    EXPECT_NE(note.find(part), std::string::npos) << note;
  }
}

/// The sheet is at the height 0.3, and its field begins at 0.6 sigma = 2.04 from it.
TEST(SheetField, RefusesStartsWithinIt) {
  const auto refused = [](const std::vector<Space>& positions) {
    return refusal(graphene() + atoms_at(positions) + field_of_sheet(1e-3) + kRunOfAtoms);
  };
  EXPECT_EQ(refused({{0.3, 0.2, 2.35}, {0.0, 0.0, -1.75}}), "");
  const std::string near = refused({{0.3, 0.2, 3.3}, {0.0, 0.0, 2.33}, {0.0, 1.0, 2.335}});
  EXPECT_NE(near.find("particle 1 of \"atoms\" is 2.03 from the sheet \"sheet\" at the start"),
            std::string::npos)
      << near;
  EXPECT_EQ(near.find("passes through"), std::string::npos) << near;
  const std::string through = refused({{0.0, 0.0, 3.3}, {0.0, 0.0, -2.7}, {0.0, 0.0, -0.2}});
  EXPECT_NE(through.find("\"atoms\" passes through \"sheet\": particle 2 of"), std::string::npos)
      << through;
}

TEST(SheetField, IsRefusedWhereThereIsNoSheet) {
  const std::string rest = atoms_at({{0.0, 0.0, 4.0}}) + field_of_sheet(1e-4) + kRunOfAtoms;
  const auto brief = [&](const std::string& sheet) { return brief_refusal(sheet + rest); };
  const auto whole = [&](const std::string& sheet) { return refusal(sheet + rest); };
  const std::string bodies = " force.sheet_field.bodies [component.unsuitable]";
  EXPECT_EQ(brief(graphene()), "");
  EXPECT_EQ(brief(graphene("")), "18:10" + bodies);
  EXPECT_EQ(
      brief(graphene("coordinates = \"prescribed\"\nmotion = { velocity = [0.1, 0.0, 0.0] }\n")),
      "20:10" + bodies);
  EXPECT_EQ(brief(graphene("coordinates = \"fixed\"\n", "[true, false, false]")),
            "19:10 force.sheet_field.bodies = [\"atoms\", \"sheet\"] [component.unsuitable]");
  std::string displaced = "displacement = [";
  for (int i = 0; i < 8 * 12 * 4; ++i)
    displaced += i == 217 ? "[1e-3, 0.0, 0.0]," : "[0.0, 0.0, 0.0],";
  EXPECT_EQ(brief(graphene("coordinates = \"fixed\"\n" + displaced + "]\n")), "20:10" + bodies);
  EXPECT_NE(whole(graphene("coordinates = \"fixed\"\n" + displaced + "]\n")).find("particle 217"),
            std::string::npos);
  std::string lifted = "displacement = [";
  for (int i = 0; i < 8 * 12 * 4; ++i) lifted += i == 5 ? "[0.0, 0.0, 1e-3]," : "[0.0, 0.0, 0.0],";
  EXPECT_NE(whole(graphene("coordinates = \"fixed\"\n" + lifted + "]\n")).find("particle 5 "),
            std::string::npos);
  std::string in_a_longer_box = graphene();
  const std::string length = digits(8 * 3 * kBond);
  in_a_longer_box.replace(in_a_longer_box.find(length), length.size(), "34.1");
  EXPECT_NE(whole(in_a_longer_box).find("34.08"), std::string::npos) << whole(in_a_longer_box);
}

TEST(SheetField, SaysWhichToleranceCanBeReached) {
  const std::string position = atoms_at({{0.0, 0.0, 4.0}});
  const std::string text = refusal(graphene() + position + field_of_sheet(2e-8) + kRunOfAtoms);
  const std::size_t at = text.find("expected: ");
  ASSERT_NE(at, std::string::npos) << text;
  const double reachable = std::stod(text.substr(at + std::strlen("expected: ")));
  EXPECT_GT(reachable, 1e-7);
  EXPECT_LT(reachable, 5e-5);
  EXPECT_EQ(brief_refusal(graphene() + position + field_of_sheet(reachable) + kRunOfAtoms), "");
  EXPECT_EQ(brief_refusal(graphene() + position +
                          with_sheet("sheet_field", "tolerance = 1e-3\nat_cutoff = \"cut\"\n") +
                          kRunOfAtoms),
            "24:13 force.sheet_field.at_cutoff = \"cut\" [component.unsuitable]");
}

}  // namespace
}  // namespace tomlin::test
