#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/model/properties.hpp"
#include "framework/model/single_force.hpp"
#include "framework/plugin/kim/kim_citation.hpp"
#include "framework/plugin/kim/kim_surroundings.hpp"
#include "tests/framework/plugin/kim/kim_scenes.hpp"
#include "tests/framework/plugin/kim/test_models.hpp"
#include "tests/support/lammps.hpp"

// Energies and forces of models by the KIM API: against the same potentials that are built in,
// against their formulas, and against the slopes of their energies.

namespace tomlin::test {
namespace {

constexpr unsigned kSeedsOfCrystals[] = {4, 77, 2061};
/// Two programs that compute the same formula may differ by this: in parts of the energy, and in
/// eV/Angstrom.
constexpr double kSameEnergy = 1e-10;
constexpr double kSameForce = 1e-10;
/// Some thousand roundings of numbers around 1.
constexpr double kRoundings = 1e-12;

struct Found {
  double energy = 0.0;
  std::vector<double> forces;
};

/// Returns the energy of one force of a scene, and its forces on the free coordinates.
Found found_in(const Scene& scene, std::size_t force) {
  SingleForce alone(scene, force);
  Found found;
  found.energy = alone.energy(0.0);
  const double* f = alone.forces(0.0);
  for (const auto& variable : alone.variables()) found.forces.push_back(f[variable.at]);
  return found;
}

void add_to(Found& sum, const Found& more) {
  sum.energy += more.energy;
  sum.forces.resize(std::max(sum.forces.size(), more.forces.size()), 0.0);
  for (std::size_t k = 0; k < more.forces.size(); ++k) sum.forces[k] += more.forces[k];
}

void expect_same(const Found& found, const Found& expected) {
  EXPECT_NEAR(found.energy, expected.energy, kSameEnergy * std::abs(expected.energy));
  ASSERT_EQ(found.forces.size(), expected.forces.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < found.forces.size(); ++k) {
    EXPECT_NEAR(found.forces[k], expected.forces[k], kSameForce) << k;
    largest = std::max(largest, std::abs(expected.forces[k]));
  }
  EXPECT_GT(largest, 1e-3) << "forces that say nothing";
}

/// The pair potential of test_models.hpp, built in.
std::string same_pairs(const std::string& name, const std::string& bodies) {
  std::string entries;
  for (const auto& [pair, k] :
       std::map<std::string, int>{{"Ar Ar", 0}, {"Ar Kr", 1}, {"Kr Kr", 2}}) {
    entries += pair + " " + digits(kDepth[k]) + " " + digits(kSize[k]) + "\\n";
  }
  return "[[force]]\nname = \"" + name + "\"\ntype = \"lennard_jones\"\nbodies = " + bodies +
         "\nentries = \"" + entries + "\"\ncutoff = " + digits(kPairCutoff) + "\n";
}

const std::string kPeriodic[] = {"[true, true, true]", "[true, false, true]",
                                 "[false, false, false]"};
constexpr std::array<double, 3> kBox = {14.8, 14.4, 15.1};

/// Atoms in a box, and atoms that are far outside of it, each by lengths of its own.
TEST(KimModel, PairsHaveTheForcesOfTheSamePotentialBuiltIn) {
  for (const unsigned seed : kSeedsOfCrystals) {
    const AtomPositions inside = crystal({4, 4, 4}, 3.65, 0.3, seed);
    AtomPositions outside = inside;
    for (std::size_t i = 0; i < outside.size(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) {
        outside[i][d] += kBox[d] * static_cast<double>((i * 7 + d * 3) % 11) - 5.0 * kBox[d];
      }
    }
    const auto compare = [](const AtomPositions& positions, const std::string& periodic) {
      const auto scene = kim_scene(
          kMetal + box_of(kBox, periodic) + atoms("a", positions, "Ar", "Kr") +
          kim_force("tomlin_test_pair", "[\"a\"]") + same_pairs("same", "[\"a\"]") + kShortRun);
      expect_same(found_in(*scene, 0), found_in(*scene, 1));
    };
    for (const std::string& periodic : kPeriodic) compare(inside, periodic);
    compare(outside, kPeriodic[0]);
  }
}

/// A body and one that is fixed, in either order: one configuration, and no force on what is fixed.
TEST(KimModel, BodiesAreOneConfiguration) {
  for (const unsigned seed : kSeedsOfCrystals) {
    const std::string one = atoms("a", crystal({4, 4, 2}, 3.65, 0.3, seed), "Ar", "Kr");
    const AtomPositions others = crystal({4, 4, 1}, 3.65, 0.3, seed + 1, {0.2, 0.1, 7.3});
    const std::string fixed = atoms("b", others, "Kr", "Ar", "coordinates = \"fixed\"\n");
    for (const char* order : {"[\"a\", \"b\"]", "[\"b\", \"a\"]"}) {
      const std::string box = kMetal + box_of(kBox, kPeriodic[1]);
      const auto scene = kim_scene(box + one + fixed + kim_force("tomlin_test_pair", order) +
                                   same_pairs("within", "[\"a\"]") +
                                   same_pairs("between", "[\"a\", \"b\"]") + kShortRun);
      Found expected = found_in(*scene, 1);
      add_to(expected, found_in(*scene, 2));
      // The fixed atoms among themselves add their energy, a constant.
      const auto alone = kim_scene(box + atoms("b", others, "Kr", "Ar") +
                                   same_pairs("within", "[\"b\"]") + kShortRun);
      expected.energy += found_in(*alone, 0).energy;
      expect_same(found_in(*scene, 0), expected);
    }
  }
}

TEST(KimModel, ARigidBodysForcesAreThoseOnItsParticles) {
  const AtomPositions positions = crystal({3, 3, 2}, 3.65, 0.3, 12);
  const AtomPositions others = crystal({3, 3, 1}, 3.65, 0.2, 13, {0.4, 0.3, 7.3});
  const auto scene = kim_scene(
      kMetal +
      atoms("a", positions, "Ar", "Kr", "coordinates = \"rigid\"\nhold = [\"rotation\"]\n") +
      atoms("b", others, "Kr", "Ar") + kim_force("tomlin_test_pair", "[\"a\", \"b\"]") +
      same_pairs("between", "[\"a\", \"b\"]") + same_pairs("within", "[\"b\"]") + kShortRun);
  Found expected = found_in(*scene, 1);
  add_to(expected, found_in(*scene, 2));
  const Found found = found_in(*scene, 0);
  ASSERT_EQ(found.forces.size(), expected.forces.size());
  for (std::size_t k = 0; k < found.forces.size(); ++k) {
    EXPECT_NEAR(found.forces[k], expected.forces[k], kSameForce) << k;
  }
}

/// sum_i sum_j phi(r_ij) (1 + c n_j), by all images of all atoms.
double coordinated_energy(const AtomPositions& positions, const std::array<double, 3>& box) {
  struct Image {
    std::size_t atom;
    std::array<double, 3> at;
  };
  std::vector<Image> images;
  const auto range = [&](std::size_t d) { return box[d] > 0.0 ? 1 : 0; };
  for (int i = -range(0); i <= range(0); ++i) {
    for (int j = -range(1); j <= range(1); ++j) {
      for (int k = -range(2); k <= range(2); ++k) {
        for (std::size_t a = 0; a < positions.size(); ++a) {
          images.push_back({a,
                            {positions[a][0] + i * box[0], positions[a][1] + j * box[1],
                             positions[a][2] + k * box[2]}});
        }
      }
    }
  }
  const auto apart = [](const std::array<double, 3>& x, const std::array<double, 3>& y) {
    return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
  };
  std::vector<double> coordinations;
  for (const auto& at : positions) {
    double n = -coordination(0.0).value;  // itself
    for (const Image& image : images) n += coordination(apart(at, image.at)).value;
    coordinations.push_back(n);
  }
  double energy = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (const Image& image : images) {
      const double r = apart(positions[i], image.at);
      if (r == 0.0) continue;
      const int species = (i % 3 == 1 ? 1 : 0) + (image.atom % 3 == 1 ? 1 : 0);
      energy += phi(species, r).value * (1.0 + kCoordinationWeight * coordinations[image.atom]);
    }
  }
  return energy;
}

constexpr std::array<double, 3> kWideBox = {20.8, 20.5, 21.1};
std::array<double, 3> lengths_in(const std::string& periodic) {
  std::array<double, 3> box = kWideBox;
  if (periodic == kPeriodic[1]) box[1] = 0.0;
  if (periodic == kPeriodic[2]) box = {};
  return box;
}

/// A potential of the neighbours of neighbours is right, across the sides of a box, too.
TEST(KimModel, NeighboursOfNeighboursAreSeen) {
  for (const std::string& periodic : kPeriodic) {
    const AtomPositions positions = crystal({7, 7, 7}, 2.95, 0.3, 5);
    const auto scene =
        kim_scene(kMetal + box_of(kWideBox, periodic) + atoms("a", positions, "Ar", "Kr") +
                  kim_force("tomlin_test_coordinated", "[\"a\"]") + kShortRun);
    const Found found = found_in(*scene, 0);
    const double expected = coordinated_energy(positions, lengths_in(periodic));
    EXPECT_NEAR(found.energy, expected, kRoundings * std::abs(expected));
    // Differences of that energy, of a few coordinates.
    for (const std::size_t k : {std::size_t{0}, std::size_t{400}, std::size_t{1000}}) {
      constexpr double kMove = 1e-3;
      const auto moved = [&](double by) {
        AtomPositions all = positions;
        all[k / 3][k % 3] += by;
        return coordinated_energy(all, lengths_in(periodic));
      };
      const double wide = (moved(kMove) - moved(-kMove)) / (2.0 * kMove);
      const double narrow = (moved(0.5 * kMove) - moved(-0.5 * kMove)) / kMove;
      const double slope = (4.0 * narrow - wide) / 3.0;
      // Energies of 1e4 eV, rounded, over 1e-3 A.
      const SingleForce alone(*scene, 0);
      bool looked = false;
      for (std::size_t v = 0; v < alone.variables().size(); ++v) {
        const BodySlot<double>& slot = alone.model().bodies()[0].bound.slot;
        if (alone.variables()[v].at != slot.offset + (k % 3) * slot.stride + k / 3) continue;
        EXPECT_NEAR(found.forces[v], -slope, 2e-7) << k;
        looked = true;
      }
      EXPECT_TRUE(looked);
    }
  }
}

/// By the suite of `tomlin check`: slopes of the energy, second derivatives, sums, repeated bits.
void expect_verified(const std::string& text) {
  for (const PropertyResult& result : check_properties(*kim_scene(text), {.displaced_states = 2})) {
    EXPECT_TRUE(result.holds) << result.property << ": " << result.error << " of " << result.allowed
                              << " " << result.worst.text();
  }
}

bool has_property(const std::string& text, const std::string& name) {
  for (const PropertyResult& result : check_properties(*kim_scene(text), {.displaced_states = 1})) {
    if (result.property == name) return result.states > 0;
  }
  return false;
}

TEST(KimModel, HasVerifiedProperties) {
  const std::string few = atoms("a", crystal({2, 2, 2}, 3.65, 0.2, 8), "Ar", "Kr");
  const std::string below = atoms("b", crystal({2, 2, 1}, 3.65, 0.1, 9, {0.3, 0.2, 7.2}), "Ar",
                                  "Ar", "coordinates = \"fixed\"\n");
  for (const char* model : {"tomlin_test_pair", "tomlin_test_coordinated"}) {
    SCOPED_TRACE(model);
    const std::string alone = kMetal + few + kim_force(model, "[\"a\"]") + kShortRun;
    expect_verified(alone);
    EXPECT_TRUE(has_property(alone, "conservative"));
    EXPECT_TRUE(has_property(alone, "hessian"));
    EXPECT_TRUE(has_property(alone, "internal"));
    expect_verified(kMetal + few + below + kim_force(model, "[\"a\", \"b\"]") + kShortRun);
    expect_verified(kMetal + box_of({20.5, 20.3, 20.6}, kPeriodic[1]) + few +
                    kim_force(model, "[\"a\"]") + kShortRun);
  }
}

bool same_numbers(const Found& a, const Found& b) {
  return std::memcmp(&a.energy, &b.energy, sizeof a.energy) == 0 &&
         a.forces.size() == b.forces.size() &&
         std::memcmp(a.forces.data(), b.forces.data(), a.forces.size() * sizeof(double)) == 0;
}

Found found_at_present(SingleForce& force) {
  Found found;
  const double* f = force.forces(0.0);
  for (const auto& variable : force.variables()) found.forces.push_back(f[variable.at]);
  found.energy = force.energy(0.0);
  return found;
}

/// Along a random walk, by lists that are kept and by lists that are made at each position.
void expect_bits_of_fresh_lists(const std::string& text, unsigned seed) {
  const auto scene = kim_scene(text);
  SingleForce kept(*scene, 0);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 40; ++k) {
    for (const auto& variable : kept.variables()) {
      kept.position(variable) += 0.03 * normal(random) * (k % 20 == 19 ? 20.0 : 1.0);
    }
    SingleForce fresh(*scene, 0);
    for (const auto& variable : fresh.variables()) {
      fresh.position(variable) = kept.position(variable);
    }
    ASSERT_TRUE(same_numbers(found_at_present(kept), found_at_present(fresh))) << "place " << k;
  }
}

TEST(KimModel, HasTheBitsOfFreshListsWhereverItHasBeen) {
  for (const unsigned seed : kSeedsOfCrystals) {
    const std::string one = atoms("a", crystal({4, 4, 2}, 3.65, 0.3, seed), "Ar", "Kr");
    const std::string fixed = atoms("b", crystal({4, 4, 1}, 3.65, 0.3, seed + 1, {0.2, 0.1, 7.3}),
                                    "Kr", "Ar", "coordinates = \"fixed\"\n");
    for (const std::string& periodic : kPeriodic) {
      expect_bits_of_fresh_lists(kMetal + box_of(kBox, periodic) + one + fixed +
                                     kim_force("tomlin_test_pair", "[\"a\", \"b\"]") + kShortRun,
                                 seed);
      expect_bits_of_fresh_lists(kMetal + box_of(kWideBox, periodic) + one +
                                     kim_force("tomlin_test_coordinated", "[\"a\"]") + kShortRun,
                                 seed);
    }
  }
}

// ---- planted faults: what the comparisons above see

/// Atoms of one body without a scene, and what a model makes of them.
class Bench {
 public:
  Bench(const std::string& model, const AtomPositions& positions, const std::array<double, 3>& box)
      : model_(model) {
    body_.name = "atoms";
    body_.slot.count = positions.size();
    body_.slot.stride = positions.size();
    for (std::size_t d = 0; d < 3; ++d) {
      for (const auto& at : positions) position_.push_back(at[d]);
    }
    stage_.position = position_.data();
    around_ = std::make_unique<kim::Surroundings>(std::vector<const BoundBody<double>*>{&body_},
                                                  model_.facts().reach(), box);
    std::vector<int> codes;
    for (std::size_t i = 0; i < positions.size(); ++i) codes.push_back(i % 3 == 1 ? 1 : 0);
    seen_ = std::make_unique<kim::Configuration>(model_, codes);
    EXPECT_TRUE(around_->update(stage_));
    seen_->assemble(*around_);
  }

  kim::SeenParticles& seen() { return seen_->seen(); }
  std::size_t count() const { return around_->count(); }

  Found compute(bool fold_back = true) {
    Found found;
    std::vector<double> on_seen;
    EXPECT_TRUE(model_.compute(seen_->seen(), found.energy, on_seen));
    found.forces.assign(3 * count(), 0.0);
    for (std::size_t k = 0; k < seen_->seen().count(); ++k) {
      if (k >= count() && !fold_back) continue;
      for (std::size_t d = 0; d < 3; ++d) {
        found.forces[3 * seen_->atom_of(k) + d] += on_seen[3 * k + d];
      }
    }
    return found;
  }

 private:
  kim::PortableModel model_;
  BoundBody<double> body_;
  std::vector<double> position_;
  Stage<double> stage_;
  std::unique_ptr<kim::Surroundings> around_;
  std::unique_ptr<kim::Configuration> seen_;
};

double total_along(const Found& found, std::size_t axis) {
  double total = 0.0;
  for (std::size_t k = axis; k < found.forces.size(); k += 3) total += found.forces[k];
  return total;
}

double largest_difference(const Found& a, const Found& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.forces.size(); ++k) {
    largest = std::max(largest, std::abs(a.forces[k] - b.forces[k]));
  }
  return largest;
}

TEST(KimModel, AForceThatIsNotFoldedBackIsSeen) {
  with_kim();
  Bench bench("tomlin_test_pair", crystal({4, 4, 4}, 3.65, 0.3, 4), kBox);
  const Found valid = bench.compute();
  const Found planted = bench.compute(false);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(total_along(valid, d), 0.0, kRoundings);
  }
  EXPECT_GT(largest_difference(valid, planted), 1e-2);
}

/// Neighbours that come behind a particle alone.
kim::ModelList half_of(const kim::ModelList& whole) {
  kim::ModelList half;
  half.start.assign(1, 0);
  for (std::size_t i = 0; i + 1 < whole.start.size(); ++i) {
    for (std::size_t k = whole.start[i]; k < whole.start[i + 1]; ++k) {
      if (static_cast<std::size_t>(whole.neighbours[k]) > i) {
        half.neighbours.push_back(whole.neighbours[k]);
      }
    }
    half.start.push_back(half.neighbours.size());
  }
  return half;
}

TEST(KimModel, ListsOfHalfThePairsAreSeen) {
  with_kim();
  Bench bench("tomlin_test_coordinated", crystal({7, 7, 7}, 2.95, 0.3, 5), kWideBox);
  const Found valid = bench.compute();
  for (kim::ModelList& list : bench.seen().lists) {
    const kim::ModelList whole = list;
    list = half_of(whole);
    EXPECT_GT(std::abs(bench.compute().energy - valid.energy), 1.0);
    list = whole;
  }
}

/// Atoms of other images have neighbours, too, if a model asks for them.
TEST(KimModel, ListsWithoutThoseOfImagesAreSeen) {
  with_kim();
  const AtomPositions positions = crystal({7, 7, 7}, 2.95, 0.3, 5);
  Bench bench("tomlin_test_coordinated", positions, kWideBox);
  EXPECT_GT(bench.seen().count(), bench.count());
  EXPECT_EQ(bench.seen().lists[0].start.size(), bench.count() + 1) << "it does not ask for these";
  EXPECT_EQ(bench.seen().lists[1].start.size(), bench.seen().count() + 1);
  const Found valid = bench.compute();
  const double expected = coordinated_energy(positions, kWideBox);
  EXPECT_NEAR(valid.energy, expected, kRoundings * std::abs(expected));
  kim::ModelList& list = bench.seen().lists[1];
  for (std::size_t i = bench.count(); i < bench.seen().count(); ++i) {
    list.start[i + 1] = list.start[bench.count()];
  }
  EXPECT_GT(std::abs(bench.compute().energy - valid.energy), 1.0);
}

/// Neighbours ascend, whatever list they come from.
TEST(KimModel, NeighboursAscend) {
  with_kim();
  Bench bench("tomlin_test_pair", crystal({4, 4, 4}, 3.65, 0.3, 4), {});
  const kim::ModelList& list = bench.seen().lists[0];
  EXPECT_EQ(bench.seen().count(), bench.count());
  for (std::size_t i = 0; i + 1 < list.start.size(); ++i) {
    for (std::size_t k = list.start[i] + 1; k < list.start[i + 1]; ++k) {
      EXPECT_LT(list.neighbours[k - 1], list.neighbours[k]);
    }
  }
}

TEST(KimModel, CitesThePrimarySource) {
  const std::string spec = R"({
 "source-citations" [
  { "author" "Some One" "year" 1999 "title" "A {B}ook" }
  { "author" "J. {T}ersoff" "doi" "10.1/2" "journal" "Phys. Rev. B" "pages" "1--2"
    "recordprimary" "recordprimary" "title" "With \"quotes\" and [brackets]" "volume" "38"
    "year" "1988" } ]
 "species" [ "Si" ] })";
  EXPECT_EQ(kim::citation_of(spec), "J. Tersoff, Phys. Rev. B 38, 1-2 (1988), doi:10.1/2");
  EXPECT_EQ(kim::citation_of("{\"source-citations\" [{\"author\" \"Some One\" \"year\" 1999}]}"),
            "Some One (1999)");
  EXPECT_EQ(kim::citation_of("{\"species\" [\"Si\"]}"), "");
  EXPECT_EQ(kim::citation_of("\"source-citations\" [{\"author"), "");
}

// ---- LAMMPS, which has the KIM API, too

bool lammps_has_kim() {
  static const bool found =
      has_lammps() && std::system("lmp -h 2>/dev/null | grep -qw KIM >/dev/null 2>&1") == 0;
  return found;
}

/// A crystal in a periodic box, of argon and krypton.
LammpsState by_lammps(const std::string& model, const AtomPositions& positions,
                      const std::array<double, 3>& box) {
  std::string data = "atoms\n\n" + std::to_string(positions.size()) + " atoms\n2 atom types\n";
  for (std::size_t d = 0; d < 3; ++d) {
    const std::string axis(1, "xyz"[d]);
    data += "0 " + digits(box[d]) + " " + axis + "lo " + axis + "hi\n";
  }
  data += "\nAtoms\n\n";
  for (std::size_t i = 0; i < positions.size(); ++i) {
    data += std::to_string(i + 1) + (i % 3 == 1 ? " 2" : " 1");
    for (const double x : positions[i]) data += " " + digits(x);
    data += "\n";
  }
  return run_lammps({{"atoms.data", data},
                     {"in.lmp", "kim init " + model + " metal\nboundary p p p\n" +
                                    "read_data atoms.data\nkim interactions Ar Kr\n"
                                    "mass * 39.948\nrun 0\n"}},
                    0);
}

TEST(KimModel, LammpsHasTheSameForces) {
  if (!lammps_has_kim()) GTEST_SKIP() << "no LAMMPS with the KIM API";
  with_kim();
  const struct {
    const char* model;
    std::array<int, 3> cells;
    double spacing;
    std::array<double, 3> box;
  } cases[] = {{"tomlin_test_pair", {4, 4, 4}, 3.65, kBox},
               {"tomlin_test_coordinated", {7, 7, 7}, 2.95, kWideBox}};
  for (const auto& one : cases) {
    SCOPED_TRACE(one.model);
    const AtomPositions positions = crystal(one.cells, one.spacing, 0.3, 11);
    const LammpsState theirs = by_lammps(one.model, positions, one.box);
    const auto scene =
        kim_scene(kMetal + box_of(one.box, kPeriodic[0]) + atoms("a", positions, "Ar", "Kr") +
                  kim_force(one.model, "[\"a\"]") + kShortRun);
    SingleForce alone(*scene, 0);
    EXPECT_NEAR(alone.energy(0.0), theirs.energy, kSameEnergy * std::abs(theirs.energy));
    const double* f = alone.forces(0.0);
    const BodySlot<double>& slot = alone.model().bodies()[0].bound.slot;
    ASSERT_EQ(theirs.force.size(), positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(f[slot.offset + d * slot.stride + i], theirs.force[i][d], kSameForce) << i;
      }
    }
  }
}

// ---- models of openkim-models, where they are installed

bool is_installed(const std::string& model) {
  with_kim();
  return kim::examine_model(model).why.empty();
}

#define TOMLIN_NEEDS(model) \
  if (!is_installed(model)) GTEST_SKIP() << "no " << model << ": it is in openkim-models"

TEST(OpenKim, TersoffsPotentialIsThatBuiltIn) {
  const std::string silicon = "Tersoff_LAMMPS_Tersoff_1988T3_Si__MO_186459956893_003";
  const std::string carbide = "Tersoff_LAMMPS_Tersoff_1989_SiC__MO_171585019474_003";
  TOMLIN_NEEDS(silicon);
  TOMLIN_NEEDS(carbide);
  const std::string of_silicon =
      "Si Si Si 3 1 1.7322 1.0039e5 16.218 -0.59826 0.78734 1.0999e-6 1.7322 471.18 2.85 0.15 "
      "2.4799 1830.8";
  const std::string of_carbide =
      "C C C 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.74 1.9500000000000002 "
      "0.15000000000000002 3.4879 1393.6 "
      "C C Si 3 1 0 38049 4.3484 -0.57058 0 0 0 0 2.3572604240535435 0.15271965554868316 0 0 "
      "C Si C 3 1 0 38049 4.3484 -0.57058 0 0 0 0 1.9500000000000002 0.15000000000000002 0 0 "
      "C Si Si 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 1.9720499999999999 "
      "395.14508945028996 2.3572604240535435 0.15271965554868316 2.9839 1597.3111406360376 "
      "Si C C 3 1 0 1.0039e5 16.217 -0.59825 0.78734 1.1e-6 1.9720499999999999 "
      "395.14508945028996 2.3572604240535435 0.15271965554868316 2.9839 1597.3111406360376 "
      "Si C Si 3 1 0 1.0039e5 16.217 -0.59825 0 0 0 0 2.85 0.1499999999999999 0 0 "
      "Si Si C 3 1 0 1.0039e5 16.217 -0.59825 0 0 0 0 2.3572604240535435 0.15271965554868316 0 0 "
      "Si Si Si 3 1 0 1.0039e5 16.217 -0.59825 0.78734 1.1e-6 1.7322 471.18 2.85 "
      "0.1499999999999999 2.4799 1830.8";
  const struct {
    std::string model;
    std::string entries;
    std::string other;
    double spacing;
  } cases[] = {{silicon, of_silicon, "Si", 2.5}, {carbide, of_carbide, "C", 2.1}};
  for (const auto& one : cases) {
    SCOPED_TRACE(one.model);
    for (const unsigned seed : kSeedsOfCrystals) {
      for (const std::string& periodic : kPeriodic) {
        const double length = 5.0 * one.spacing;
        const auto scene =
            kim_scene(kMetal + box_of({length, length, length}, periodic) +
                      atoms("a", crystal({5, 5, 5}, one.spacing, 0.2, seed), "Si", one.other) +
                      kim_force(one.model, "[\"a\"]") +
                      "[[force]]\nname = \"same\"\ntype = \"tersoff\"\nentries = \"" + one.entries +
                      "\"\n" + kShortRun);
        expect_same(found_in(*scene, 0), found_in(*scene, 1));
      }
    }
  }
}

TEST(OpenKim, LennardJonesPotentialIsThatBuiltIn) {
  const std::string model = "LJ_Shifted_Bernardes_1958MedCutoff_Ar__MO_126566794224_004";
  TOMLIN_NEEDS(model);
  for (const unsigned seed : kSeedsOfCrystals) {
    const auto scene = kim_scene(
        kMetal + box_of({32.0, 31.5, 33.0}, kPeriodic[1]) +
        atoms("a", crystal({6, 6, 6}, 3.7, 0.3, seed), "Ar", "Ar") + kim_force(model, "[\"a\"]") +
        "[[force]]\nname = \"same\"\ntype = \"lennard_jones\"\nepsilon = 0.0104\n"
        "sigma = 3.4\ncutoff = 13.5\nat_cutoff = \"shift\"\n" +
        kShortRun);
    expect_same(found_in(*scene, 0), found_in(*scene, 1));
  }
}

TEST(OpenKim, PotentialsOfManyKindsHaveVerifiedProperties) {
  const struct {
    std::string model;
    std::string species;
    double spacing;
  } cases[] = {{"SW_StillingerWeber_1985_Si__MO_405512056662_005", "Si", 2.5},
               {"EAM_Dynamo_ErcolessiAdams_1994_Al__MO_123629422045_005", "Al", 2.6}};
  for (const auto& one : cases) {
    SCOPED_TRACE(one.model);
    TOMLIN_NEEDS(one.model);
    const auto positions = crystal({2, 2, 2}, one.spacing, 0.1, 3);
    const auto scene = kim_scene(kMetal + atoms("a", positions, one.species, one.species) +
                                 kim_force(one.model, "[\"a\"]") + kShortRun);
    for (const PropertyResult& result : check_properties(*scene, {.displaced_states = 2})) {
      EXPECT_TRUE(result.holds) << result.property << ": " << result.error << " of "
                                << result.allowed << " " << result.worst.text();
    }
  }
}

}  // namespace
}  // namespace tomlin::test
