#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/lennard_jones.hpp"
#include "forcefields/tersoff.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/model/properties.hpp"
#include "framework/model/single_force.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

// Forces with a cutoff: their bits are those of sums over all pairs, whatever the neighbour lists
// have been through; Tersoff's potential against its formula, written down once more.

namespace tomlin::test {
namespace {

constexpr unsigned kSeedsOfClusters[] = {3, 58, 1917};
/// Some hundred roundings of energies and forces of order 1 to 100.
constexpr double kHundredsOfRoundings = 1e-12;

std::string list_of(const std::vector<std::array<double, 3>>& positions) {
  std::string list = "[";
  for (const auto& x : positions) {
    list += "[" + digits(x[0]) + ", " + digits(x[1]) + ", " + digits(x[2]) + "], ";
  }
  return list + "]";
}

/// A simple cubic cluster of about so many particles, each displaced.
std::vector<std::array<double, 3>> cluster(int side, double spacing, double disorder,
                                           unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-disorder, disorder);
  std::vector<std::array<double, 3>> positions;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        positions.push_back({spacing * i + uniform(random), spacing * j + uniform(random),
                             spacing * k + uniform(random)});
      }
    }
  }
  return positions;
}

std::string body(const std::string& name, const std::vector<std::array<double, 3>>& positions,
                 const std::string& more = "") {
  return "[[body]]\nname = \"" + name + "\"\ntype = \"particles\"\nparticle_mass = 1.0\n" + more +
         "positions = " + list_of(positions) + "\n";
}

const std::string kRunOfClusters = "[run]\nduration = 1.0\nintegrator = " + verlet(0.01) + "\n";

std::string lennard_jones(const std::string& where, const std::string& at_cutoff = "smooth") {
  return "[[force]]\ntype = \"lennard_jones\"\n" + where +
         "\nepsilon = 0.7\nsigma = 0.9\ncutoff = 1.9\nat_cutoff = \"" + at_cutoff + "\"\n";
}

/// Lindsay and Broido's numbers for carbon, Table I of their paper.
constexpr TersoffNumbers kLindsayBroido = {3.0,    1.0,     0.0,       38049.0, 4.3484,
                                           -0.930, 0.72751, 1.5724e-7, 2.2119,  430.0,
                                           1.95,   0.15,    3.4879,    1393.6};
const std::string kTersoff =
    "[[force]]\ntype = \"tersoff\"\nparameters = \"lindsay_broido_2010\"\n";

/// Silicon and carbon of Tersoff's paper of 1989, as files for LAMMPS have them: zeros in the
/// entries that do not belong to a bond, and names with parentheses.
const std::string kCarbide =
    "C C C  3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.74 1.95 0.15 3.4879 1393.6\n"
    "C C Si(D)  3 1 0 38049 4.3484 -0.57058 0 0 0 0 2.36 0.15 0 0\n"
    "C Si(D) C  3 1 0 38049 4.3484 -0.57058 0 0 0 0 1.95 0.15 0 0\n"
    "C Si(D) Si(D)  3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 1.97205 395.145 2.36 0.15 "
    "2.9839 1597.311\n"
    "Si(D) C C  3 1 0 100390 16.217 -0.59825 0.78734 1.1e-6 1.97205 395.145 2.36 0.15 "
    "2.9839 1597.311\n"
    "Si(D) C Si(D)  3 1 0 100390 16.217 -0.59825 0 0 0 0 2.85 0.15 0 0\n"
    "Si(D) Si(D) C  3 1 0 100390 16.217 -0.59825 0 0 0 0 2.36 0.15 0 0\n"
    "Si(D) Si(D) Si(D)  3 1 0 100390 16.217 -0.59825 0.78734 1.1e-6 1.7322 471.18 2.85 0.15 "
    "2.4799 1830.8\n";
std::size_t is_silicon(std::size_t i) { return static_cast<std::size_t>(i * i % 5 < 2); }

/// Silicon and carbon with other cutoffs: in the presence of a third particle a longer one than in
/// a bond, and in a bond from one side a shorter one than from the other.
std::string unlike_carbide() {
  std::string text = kCarbide;
  for (const auto& [old_text, new_text] :
       {std::pair("C Si(D) C  3 1 0 38049 4.3484 -0.57058 0 0 0 0 1.95",
                  "C Si(D) C  3 1 0 38049 4.3484 -0.57058 0 0 0 0 2.9"),
        std::pair("1.97205 395.145 2.36 0.15 2.9839 1597.311\nSi(D) C Si(D)",
                  "1.97205 395.145 1.9 0.15 2.9839 1597.311\nSi(D) C Si(D)"),
        std::pair("Si(D) Si(D) C  3 1 0 100390 16.217 -0.59825 0 0 0 0 2.36",
                  "Si(D) Si(D) C  3 1 0 100390 16.217 -0.59825 0 0 0 0 1.9")}) {
    const std::size_t at = text.find(old_text);
    EXPECT_NE(at, std::string::npos) << old_text;
    text.replace(at, std::string(old_text).size(), new_text);
  }
  return text;
}

/// Silicon and carbon at these positions.
std::string carbide(const std::vector<std::array<double, 3>>& positions,
                    const std::string& entries = kCarbide) {
  std::string species = "species = [";
  for (std::size_t i = 0; i < positions.size(); ++i) {
    species += is_silicon(i) != 0 ? "\"Si(D)\", " : "\"C\", ";
  }
  return body("a", positions, species + "]\n") +
         "[[force]]\ntype = \"tersoff\"\nentries = \"\"\"\n" + entries + "\"\"\"\n" +
         kRunOfClusters;
}

std::vector<double> forces_of(SingleForce& force) {
  const double* f = force.forces(0.0);
  std::vector<double> all;
  for (const auto& variable : force.variables()) all.push_back(f[variable.at]);
  return all;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// One particle is at no finite position, as in a trial step that is refused, when another has gone
/// so far that lists are made; then it is back.
void evaluate_astray(SingleForce& force, double astray, double way) {
  double& lost = force.position(force.variables().front());
  const double from = lost;
  lost = astray;
  force.position(force.variables().back()) += way;
  force.energy(0.0);
  force.forces(0.0);
  lost = from;
}

/// Forces along a random walk with short and long steps, by lists that are kept and by lists that
/// are made at each position.
void expect_bits_of_new_lists(const std::string& text, double step, unsigned seed) {
  const auto scene = scene_of(text);
  SingleForce kept(*scene, 0);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 60; ++k) {
    for (const auto& variable : kept.variables()) {
      kept.position(variable) += step * normal(random) * (k % 20 == 19 ? 30.0 : 1.0);
    }
    if (k % 3 == 2) {
      const double nowhere = k % 2 == 0 ? std::nan("") : std::numeric_limits<double>::infinity();
      evaluate_astray(kept, nowhere, k % 2 == 0 ? 3.0 : -3.0);
    }
    SingleForce fresh(*scene, 0);
    for (const auto& variable : fresh.variables()) {
      fresh.position(variable) = kept.position(variable);
    }
    const double energy = kept.energy(0.0);
    ASSERT_EQ(energy, fresh.energy(0.0)) << "place " << k;
    ASSERT_TRUE(same_bits(forces_of(kept), forces_of(fresh))) << "place " << k;
  }
}

TEST(CutoffForces, HaveTheBitsOfNewListsWhereverTheyHaveBeen) {
  const std::string box = "[box]\nlengths = [5.0, 4.6, 6.0]\nperiodic = [true, true, false]\n";
  for (const unsigned seed : kSeedsOfClusters) {
    const auto positions = cluster(4, 1.05, 0.1, seed);
    for (const char* at_cutoff : {"cut", "shift", "smooth"}) {
      expect_bits_of_new_lists(body("a", positions) + lennard_jones("", at_cutoff) + kRunOfClusters,
                               0.02, seed);
    }
    expect_bits_of_new_lists(box + body("a", positions) + lennard_jones("") + kRunOfClusters, 0.02,
                             seed);
    auto others = cluster(3, 1.3, 0.2, seed + 1);
    for (auto& x : others) x[2] -= 3.5;
    for (const char* more : {"", "coordinates = \"fixed\"\n"}) {
      expect_bits_of_new_lists(box + body("a", positions) + body("b", others, more) +
                                   lennard_jones("bodies = [\"a\", \"b\"]") + kRunOfClusters,
                               0.02, seed);
      expect_bits_of_new_lists(box + body("a", others, more) + body("b", positions) +
                                   lennard_jones("bodies = [\"a\", \"b\"]") + kRunOfClusters,
                               0.02, seed);
    }
    const auto carbon = cluster(4, 1.6, 0.15, seed);
    expect_bits_of_new_lists(body("a", carbon) + kTersoff + kRunOfClusters, 0.02, seed);
    expect_bits_of_new_lists("[box]\nlengths = [6.5, 6.6, 6.7]\nperiodic = [true, true, true]\n" +
                                 body("a", carbon) + kTersoff + kRunOfClusters,
                             0.02, seed);
    // One of these spacings puts second neighbours about as far away as the longest cutoff.
    for (const double spacing : {1.9, 2.12, 2.6}) {
      const auto atoms = cluster(4, spacing, 0.1, seed);
      expect_bits_of_new_lists(carbide(atoms), 0.02, seed);
      expect_bits_of_new_lists(carbide(atoms, unlike_carbide()), 0.02, seed);
    }
    expect_bits_of_new_lists("[box]\nlengths = [9.1, 9.3, 9.2]\nperiodic = [true, true, true]\n" +
                                 carbide(cluster(4, 2.12, 0.1, seed)),
                             0.02, seed);
  }
}

/// The sum over all others, particle j in partial sum j modulo 8.
template <class E>
std::array<double, 3> sum_over_all(const std::vector<std::array<double, 3>>& positions,
                                   std::size_t i, const LennardJonesDescription& d, double box) {
  const auto p = E::template parameters<double, 3>(d);
  InterleavedSum<double> sums[3];
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (j == i) continue;
    Pair<double, 3> pair{};
    for (int a = 0; a < 3; ++a) {
      const double apart = positions[j][a] - positions[i][a];
      pair.separation[a] = box > 0.0 ? apart - box * std::floor(apart / box + 0.5) : apart;
    }
    if (!(norm_squared(pair.separation) < d.cutoff * d.cutoff)) continue;
    const Vec<double, 3> force = E::force(p, pair);
    for (int a = 0; a < 3; ++a) sums[a].add(j, force[a]);
  }
  return {sums[0].total(), sums[1].total(), sums[2].total()};
}

TEST(CutoffForces, HaveTheBitsOfAllPairs) {
  for (const unsigned seed : kSeedsOfClusters) {
    for (const double box : {0.0, 4.5}) {
      for (const AtCutoff at_cutoff : {AtCutoff::cut, AtCutoff::smooth}) {
        auto positions = cluster(4, 1.1, 0.15, seed);
        const std::string in_box =
            box > 0.0 ? "[box]\nlengths = [4.5, 4.5, 4.5]\nperiodic = [true, true, true]\n" : "";
        const auto scene = scene_of(in_box + body("a", positions) +
                                    lennard_jones("", to_string(at_cutoff)) + kRunOfClusters);
        SingleForce force(*scene, 0);
        const std::vector<double> found = forces_of(force);
        for (std::size_t k = 0; k < force.variables().size(); ++k) {
          positions[k % positions.size()][k / positions.size()] =
              force.position(force.variables()[k]);
        }
        LennardJonesDescription d;
        d.epsilon = 0.7;
        d.sigma = 0.9;
        d.cutoff = 1.9;
        d.at_cutoff = at_cutoff;
        std::vector<double> expected(found.size());
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const auto sum = at_cutoff == AtCutoff::smooth
                               ? sum_over_all<LennardJonesSmooth>(positions, i, d, box)
                               : sum_over_all<LennardJones>(positions, i, d, box);
          for (std::size_t a = 0; a < 3; ++a) expected[a * positions.size() + i] = sum[a];
        }
        EXPECT_TRUE(same_bits(found, expected)) << "seed " << seed << ", box " << box;
      }
    }
  }
}

/// Energies at contact, well and cutoff.
TEST(LennardJones, HasItsWellAndEndsAsItIsTold) {
  const auto energy_at = [](double r, const char* at_cutoff) {
    const auto scene = scene_of(body("a", {{0.0, 0.0, 0.0}, {r, 0.0, 0.0}}) +
                                lennard_jones("", at_cutoff) + kRunOfClusters);
    SingleForce force(*scene, 0);
    return force.energy(0.0);
  };
  const double well = 0.9 * std::pow(2.0, 1.0 / 6.0);
  const double s6 = std::pow(0.9 / 1.9, 6);
  const double at_end = 4.0 * 0.7 * s6 * (s6 - 1.0);
  const double slope = -24.0 * 0.7 * s6 * (2.0 * s6 - 1.0) / 1.9;
  EXPECT_NEAR(energy_at(0.9, "cut"), 0.0, kHundredsOfRoundings);
  EXPECT_NEAR(energy_at(well, "cut"), -0.7, kHundredsOfRoundings);
  EXPECT_NEAR(energy_at(well, "shift"), -0.7 - at_end, kHundredsOfRoundings);
  EXPECT_NEAR(energy_at(well, "smooth"), -0.7 - at_end - (well - 1.9) * slope,
              kHundredsOfRoundings);
  EXPECT_NEAR(energy_at(1.9 - 1e-9, "cut"), at_end, 1e-8);
  EXPECT_NEAR(energy_at(1.9 - 1e-9, "shift"), 0.0, 1e-8);
  EXPECT_NEAR(energy_at(1.9 - 1e-6, "smooth"), 0.0, 1e-10);
  EXPECT_EQ(energy_at(1.9, "cut"), 0.0);
}

/// The formula as its paper has it, with the functions of the standard library. `of(i, j, k)` are
/// the numbers of particles i and j in the presence of k.
template <class Numbers>
double tersoff_energy(const std::vector<std::array<double, 3>>& positions, const Numbers& of) {
  const auto distance_of = [&](std::size_t i, std::size_t j) {
    return std::hypot(positions[j][0] - positions[i][0], positions[j][1] - positions[i][1],
                      positions[j][2] - positions[i][2]);
  };
  const auto cutoff = [](const TersoffNumbers& p, double r) {
    if (r < p.r - p.half_width) return 1.0;
    if (r > p.r + p.half_width) return 0.0;
    return 0.5 - 0.5 * std::sin(M_PI / 2.0 * (r - p.r) / p.half_width);
  };
  double energy = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (j == i) continue;
      const TersoffNumbers& bond = of(i, j, j);
      const double r = distance_of(i, j);
      if (cutoff(bond, r) == 0.0) continue;
      double zeta = 0.0;
      for (std::size_t k = 0; k < positions.size(); ++k) {
        if (k == i || k == j) continue;
        const TersoffNumbers& p = of(i, j, k);
        const double s = distance_of(i, k);
        if (cutoff(p, s) == 0.0) continue;
        double dot = 0.0;
        for (int a = 0; a < 3; ++a) {
          dot += (positions[j][a] - positions[i][a]) * (positions[k][a] - positions[i][a]);
        }
        const double apart = p.cos_theta0 - dot / (r * s);
        const double g =
            p.gamma * (1.0 + p.c * p.c / (p.d * p.d) - p.c * p.c / (p.d * p.d + apart * apart));
        zeta += cutoff(p, s) * g * std::exp(std::pow(p.lambda3 * (r - s), p.m));
      }
      const double order = std::pow(1.0 + std::pow(bond.beta * zeta, bond.n), -0.5 / bond.n);
      energy +=
          0.5 * cutoff(bond, r) *
          (bond.a * std::exp(-bond.lambda1 * r) - order * bond.b * std::exp(-bond.lambda2 * r));
    }
  }
  return energy;
}

TEST(Tersoff, HasTheEnergyOfItsFormula) {
  for (const unsigned seed : kSeedsOfClusters) {
    for (const double spacing : {1.5, 1.9, 2.4}) {
      const auto positions = cluster(3, spacing, 0.3, seed);
      const auto scene = scene_of(body("a", positions) + kTersoff + kRunOfClusters);
      SingleForce force(*scene, 0);
      const auto carbon = [](std::size_t, std::size_t, std::size_t) -> const TersoffNumbers& {
        return kLindsayBroido;
      };
      const double expected = tersoff_energy(positions, carbon);
      EXPECT_NEAR(force.energy(0.0), expected, kHundredsOfRoundings * 27.0 * 40.0);
    }
  }
}

/// Silicon of Tersoff's paper of 1988, doi:10.1103/PhysRevB.37.6991: the weight of a neighbour that
/// is much nearer than another one is up to 1e30, and its power of n = 22.956 is no number.
const std::string kSilicon1988 =
    "Si Si Si 3 1 1.3258 4.8381 2.0417 0 22.956 0.33675 1.3258 95.373 3 0.2 3.2394 3264.7\n";

TEST(Tersoff, HasTheEnergyOfItsFormulaWhereThePowerOverflows) {
  std::vector<std::string> faults;
  const TersoffNumbers silicon = parse_tersoff(kSilicon1988, "silicon", faults).front().numbers;
  ASSERT_TRUE(faults.empty());
  const auto numbers = [&](std::size_t, std::size_t, std::size_t) -> const TersoffNumbers& {
    return silicon;
  };
  const std::string potential = "[[force]]\ntype = \"tersoff\"\nentries = \"" +
                                kSilicon1988.substr(0, kSilicon1988.size() - 1) + "\"\n" +
                                kRunOfClusters;
  std::vector<std::vector<std::array<double, 3>>> all = {
      {{0.0, 0.0, 0.0}, {2.3, 0.0, 0.0}, {-1.3, 2.3, 0.0}}};
  for (const unsigned seed : kSeedsOfClusters) {
    for (const double spacing : {2.3, 2.6, 3.0}) all.push_back(cluster(3, spacing, 0.35, seed));
  }
  for (const auto& positions : all) {
    const std::string text = body("a", positions) + potential;
    const auto scene = scene_of(text);
    SingleForce force(*scene, 0);
    EXPECT_NEAR(force.energy(0.0), tersoff_energy(positions, numbers),
                kHundredsOfRoundings * 27.0 * 40.0);
    for (const double f : forces_of(force)) EXPECT_TRUE(std::isfinite(f));
    if (positions.size() > 3) continue;  // of the first, which is quick
    for (const PropertyResult& result : check_properties(*scene, {.displaced_states = 1})) {
      EXPECT_TRUE(result.holds) << result.property << ": " << result.error << " of "
                                << result.allowed << " " << result.worst.text();
    }
    const RunResult found = run_text(text + "number_type = \"quadruple\"\n");
    EXPECT_EQ(found.status, RunStatus::finished)
        << (found.failure ? to_string(*found.failure) : "");
  }
}

TEST(Tersoff, HasTheEnergyOfItsFormulaForTwoSpecies) {
  for (const std::string& text : {kCarbide, unlike_carbide()}) {
    std::vector<std::string> faults;
    const std::vector<TersoffEntry> entries = parse_tersoff(text, "carbide", faults);
    ASSERT_TRUE(faults.empty()) << faults.front();
    ASSERT_EQ(entries.size(), 8U);
    const auto numbers = [&](std::size_t i, std::size_t j, std::size_t k) -> const TersoffNumbers& {
      return entries[4 * is_silicon(i) + 2 * is_silicon(j) + is_silicon(k)].numbers;
    };
    for (const unsigned seed : kSeedsOfClusters) {
      for (const double spacing : {1.7, 2.1, 2.5}) {
        const auto positions = cluster(3, spacing, 0.3, seed);
        const auto scene = scene_of(carbide(positions, text));
        SingleForce force(*scene, 0);
        const double expected = tersoff_energy(positions, numbers);
        EXPECT_GT(std::abs(expected), 1.0);
        EXPECT_NEAR(force.energy(0.0), expected, kHundredsOfRoundings * 27.0 * 40.0);
      }
    }
  }
}

TEST(Tersoff, HasVerifiedPropertiesForTwoSpecies) {
  for (const std::string& text : {kCarbide, unlike_carbide()}) {
    const auto scene = scene_of(carbide(cluster(2, 2.2, 0.3, kSeedsOfClusters[0]), text));
    const auto results = check_properties(*scene, {.displaced_states = 3});
    EXPECT_GT(results.size(), 10U);
    for (const PropertyResult& result : results) {
      EXPECT_TRUE(result.holds) << result.property << ": " << result.error << " of "
                                << result.allowed << " " << result.worst.text();
    }
  }
}

/// Any two atoms may come to be neighbours, so that implicit schemes ask for the derivatives of all
/// by all. Asked by the sums over neighbours, with all atoms at one position, 125 would take
/// minutes.
TEST(Tersoff, HasTheMotionOfExplicitSchemesInImplicitOnes) {
  // Some hundred steps to a tolerance of 1e-9 each, and atoms that cross where the slope of the
  // force jumps, on which error estimates do not count.
  constexpr double kOfTolerances = 1e-4;
  const auto energy_of = [](const std::string& integrator) {
    const RunResult result = run_text(
        body("a", cluster(5, 1.5, 0.1, kSeedsOfClusters[0])) + kTersoff +
        "[run]\nduration = 0.02\nledger = true\nintegrator = { type = \"" + integrator + "\" }\n");
    EXPECT_EQ(result.status, RunStatus::finished);
    return observable(result, "energy.kinetic").value_or(0.0);
  };
  const double expected = energy_of("dop853");
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(energy_of("radau9"), expected, kOfTolerances * expected);
}

/// Numbers that belong to a bond are needed in its entry alone.
TEST(Tersoff, RefusesABondOfNoExponent) {
  std::vector<std::string> faults;
  parse_tersoff("C C C  3 1 0 38049 4.3484 -0.57058\n0 0 0 0 1.95 0.15 0 0\n", "some", faults);
  parse_tersoff("C Si C  3 1 0 38049 4.3484 -0.57058\n-1 0 0 0 1.95 0.15 0 0\n", "some", faults);
  EXPECT_EQ(faults,
            (std::vector<std::string>{"some:1: n is not positive", "some:1: n is negative"}));
}

/// Lindsay and Broido fitted it to graphene: their Table I has the lattice constant 2.492 Angstrom.
TEST(Tersoff, HasGraphenesLatticeConstant) {
  const auto energy_at = [](double a) {
    const double b = a / std::sqrt(3.0);
    std::vector<std::array<double, 3>> positions;
    constexpr int kAlong = 3;
    constexpr int kAcross = 4;
    for (int i = 0; i < kAcross; ++i) {
      for (int j = 0; j < kAlong; ++j) {
        const double x = a * i;
        const double y = 3.0 * b * j;
        positions.push_back({x, y, 0.0});
        positions.push_back({x + a / 2.0, y + b / 2.0, 0.0});
        positions.push_back({x + a / 2.0, y + 1.5 * b, 0.0});
        positions.push_back({x, y + 2.0 * b, 0.0});
      }
    }
    const std::string box = "[box]\nlengths = [" + digits(kAcross * a) + ", " +
                            digits(kAlong * 3.0 * b) + ", 20.0]\nperiodic = [true, true, true]\n";
    const auto scene = scene_of(box + body("a", positions) + kTersoff + kRunOfClusters);
    SingleForce force(*scene, 0);
    return force.energy(0.0) / static_cast<double>(positions.size());
  };
  double low = 2.4;
  double high = 2.6;
  while (high - low > 1e-6) {
    const double left = low + (high - low) / 3.0;
    const double right = high - (high - low) / 3.0;
    (energy_at(left) < energy_at(right) ? high : low) =
        energy_at(left) < energy_at(right) ? right : left;
  }
  EXPECT_NEAR(low, 2.492, 0.0005);  // its last digit
  EXPECT_NEAR(energy_at(low), -7.978, 0.01);
}

// ---- lennard_jones by species

std::string species_scene(const std::string& species, const std::string& numbers,
                          const std::string& more = "") {
  return "[[body]]\nname = \"a\"\ntype = \"particles\"\n"
         "positions = [[0.0, 0.0], [1.1, 0.2], [0.3, 1.2], [1.3, 1.4], [2.4, 0.7]]\n" +
         species + "particle_mass = 1.0\n[[force]]\ntype = \"lennard_jones\"\n" + numbers +
         "cutoff = 2.0\n[run]\nduration = 0.5\nintegrator = { type = \"velocity_verlet\", dt = "
         "1e-3 }\nledger = true\n" +
         more;
}

const std::string kFiveSpecies = "species = [\"A\", \"B\", \"A\", \"B\", \"A\"]\n";

/// Entries that are all alike have the bits of the numbers for all, in every number type.
TEST(LennardJones, BySpeciesHasTheBitsOfNumbersForAll) {
  for (const std::string number_type : {"double", "quadruple"}) {
    const std::string more = "number_type = \"" + number_type + "\"\n";
    const RunResult alike =
        run_text(species_scene(kFiveSpecies, "epsilon = 0.7\nsigma = 1.1\n", more));
    const RunResult listed = run_text(
        species_scene(kFiveSpecies, "entries = \"A A 0.7 1.1 B B 0.7 1.1 B A 0.7 1.1\"\n", more));
    const RunResult mixed = run_text(species_scene(
        kFiveSpecies, "entries = \"A A 0.7 1.1 B B 0.7 1.1\"\nmixing = \"lorentz_berthelot\"\n",
        more));
    const RunResult other = run_text(
        species_scene(kFiveSpecies, "entries = \"A A 0.7 1.1 B B 0.7 1.1 B A 0.7 1.0\"\n", more));
    const auto energy = [](const RunResult& result) {
      return result.group("energy")["kinetic"][0];
    };
    EXPECT_EQ(energy(alike), energy(listed)) << number_type;
    EXPECT_EQ(energy(alike), energy(mixed)) << number_type;
    EXPECT_NE(energy(alike), energy(other)) << number_type;
  }
}

/// The energy of a pair of two species is that of their mixed numbers, whichever comes first.
TEST(LennardJones, APairOfTwoSpeciesHasMixedNumbers) {
  for (const std::string species : {"[\"A\", \"B\"]", "[\"B\", \"A\"]"}) {
    const auto found = run_text(
        "[[body]]\ntype = \"particles\"\npositions = [[0.0], [1.2]]\nspecies = " + species +
        "\nparticle_mass = 1.0\n[[force]]\ntype = \"lennard_jones\"\n"
        "entries = \"A A 1.0 1.0 B B 4.0 1.5\"\nmixing = \"lorentz_berthelot\"\ncutoff = 4.0\n"
        "at_cutoff = \"shift\"\n[run]\nduration = 1e-5\nledger = true\n"
        "integrator = { type = \"velocity_verlet\", dt = 1e-5 }\n");
    // epsilon = sqrt(1 * 4), sigma = 1.25.
    const auto energy = [](double r) {
      const double part = std::pow(1.25 / r, 6);
      return 8.0 * part * (part - 1.0);
    };
    // The step moves the particles by some 1e-8, against a force of 80.
    EXPECT_NEAR(found.group("energy")["potential"][0], energy(1.2) - energy(4.0), 1e-5);
  }
}

TEST(LennardJones, FaultsOfEntriesHaveTheirPlace) {
  const auto faults = [](const std::string& numbers, const std::string& species = kFiveSpecies) {
    return brief_refusal(species_scene(species, numbers));
  };
  const std::string key = "force.lennard_jones.";
  EXPECT_EQ(faults("entries = \"A A 1 1 B B 1 1\"\n"),
            "9:11 " + key + "entries = \"A A 1 1 B B 1 1\" [component.unsuitable]");
  EXPECT_EQ(faults("entries = \"A A 1 1 B B 1\"\n"),
            "9:11 " + key + "entries = \"A A 1 1 B B 1\" [file.invalid]");
  EXPECT_EQ(faults("entries = \"A A 1 -1\"\n"),
            "9:11 " + key + "entries = \"A A 1 -1\" [file.invalid]");
  EXPECT_EQ(faults("entries = \"A A 1 1 B A 1 1 A B 1 1\"\n"),
            "9:11 " + key + "entries = \"A A 1 1 B A 1 1 A B 1 1\" [file.invalid]");
  EXPECT_EQ(faults("entries = \"A A 1 1\"\n", "velocity = [0.0, 0.0]\n"),
            "9:11 " + key + "entries = \"A A 1 1\" [component.unsuitable]");
  EXPECT_EQ(faults("entries = \"A A 1 1\"\nsigma = 1.0\n"),
            "10:9 " + key + "sigma = 1.0 [scene.conflict]");
  EXPECT_EQ(faults("epsilon = 1.0\n"), "7:1 " + key + "sigma [scene.missing_key]");
  EXPECT_EQ(faults("epsilon = 1.0\nsigma = 1.0\nmixing = \"lorentz_berthelot\"\n"),
            "11:10 " + key + "mixing = \"lorentz_berthelot\" [scene.conflict]");
}

TEST(CutoffForces, AreRefusedInBoxesTooShortForThem) {
  const auto two = cluster(2, 1.5, 0.0, 1);
  const std::string box = "[box]\nlengths = [4.0, 9.0, 9.0]\nperiodic = [true, false, true]\n";
  EXPECT_EQ(brief_refusal(box + body("a", two) + lennard_jones("") + kRunOfClusters),
            "14:10 force.lennard_jones.cutoff = 1.9 [scene.out_of_range]");
  EXPECT_EQ(brief_refusal(box + body("a", two) + kTersoff + kRunOfClusters),
            "11:14 force.tersoff.parameters = \"lindsay_broido_2010\" [scene.out_of_range]");
}

}  // namespace
}  // namespace tomlin::test
