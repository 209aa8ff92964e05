#include "forcefields/lattice_substrate.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/sinusoidal_substrate.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/force.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/random_description.hpp"
#include "tests/support/scenes.hpp"

// The crystalline surface against closed forms, its symmetries, other forces, and a sum in
// quadruple precision far away.

namespace tomlin::test {
namespace {

using Surface = LatticeSubstrateDescription;

/// Some roundings of numbers of order 1, and of the phases of positions within a few cells.
constexpr double kFewRoundings = 2e-14;
constexpr std::uint64_t kSeedsOfPoints[] = {1, 20240611, 77};
constexpr int kPoints = 200;

Surface named(SurfaceLattice lattice, double amplitude = 1.0, double period = 1.0,
              double misfit = 0.0) {
  Surface d;
  d.lattice = lattice;
  d.period = period;
  d.amplitude = amplitude;
  d.misfit = misfit;
  return d;
}

Surface with_harmonics(SurfaceLattice lattice, const std::vector<double>& pairs,
                       const std::vector<double>& amplitudes) {
  Surface d = named(lattice);
  d.amplitude = Surface::kAbsent;
  d.harmonics = {2, pairs};
  d.amplitudes.numbers = amplitudes;
  return d;
}

constexpr SurfaceLattice kPlane[] = {SurfaceLattice::square, SurfaceLattice::hexagonal,
                                     SurfaceLattice::honeycomb};

/// The evaluator at a position relative to an origin.
template <class E, class T, int D>
struct Evaluated {
  T energy;
  Vec<T, D> force;
};

template <class E, class T = double, int D>
Evaluated<E, T, D> evaluate(const Surface& d, const Vec<T, D>& position,
                            const Origin& origin = {}) {
  auto p = E::template parameters<T, D>(d);
  E::template rebase<T, D>(p, d, origin);
  Site<T, D> site{};
  site.position = position;
  return {E::energy(p, site), E::force(p, site)};
}

double energy(const Surface& d, double x, double y) {
  return evaluate<LatticeHigher>(d, Vec<double, 2>{{x, y}}).energy;
}

Vec<double, 2> force(const Surface& d, double x, double y) {
  return evaluate<LatticeHigher>(d, Vec<double, 2>{{x, y}}).force;
}

/// `check` at random positions.
template <class Check>
void everywhere(Check&& check) {
  for (const std::uint64_t seed : kSeedsOfPoints) {
    Random random(seed);
    for (int k = 0; k < kPoints; ++k) check(uniform(random, -3.0, 3.0), uniform(random, -3.0, 3.0));
  }
}

/// The largest difference of two functions of the plane.
template <class One, class Other>
double largest_difference(One&& one, Other&& other) {
  double largest = 0.0;
  everywhere(
      [&](double x, double y) { largest = std::max(largest, std::abs(one(x, y) - other(x, y))); });
  return largest;
}

// ---- closed forms -------------------------------------------------------------------------------

/// Verhoeven, Dienwiebel and Frenken, Phys. Rev. B 70, 165418 (2004).
double graphite(double x, double y, double v0, double a) {
  const double across = kTau * y / (a * std::numbers::sqrt3);
  return -v0 * (2.0 * std::cos(kTau * x / a) * std::cos(across) + std::cos(2.0 * across));
}

TEST(LatticeSubstrate, HoneycombIsTheSurfaceOfGraphite) {
  for (const double a : {1.0, 0.246, 3.7}) {
    const Surface surface = named(SurfaceLattice::honeycomb, 0.7, a);
    EXPECT_LT(largest_difference([&](double x, double y) { return energy(surface, x, y); },
                                 [&](double x, double y) { return graphite(x, y, 0.7, a); }),
              kFewRoundings / a);
  }
  // The third cosine with the difference of the phases in place of their sum.
  const Surface wrong =
      with_harmonics(SurfaceLattice::hexagonal, {1, 0, 0, 1, 1, -1}, {-0.7, -0.7, -0.7});
  EXPECT_GT(largest_difference([&](double x, double y) { return energy(wrong, x, y); },
                               [&](double x, double y) { return graphite(x, y, 0.7, 1.0); }),
            0.5)
      << "negative control";
}

struct Extreme {
  double n1, n2;  ///< in lattice vectors
  double energy;  ///< in amplitudes
};

/// Atoms, hollows and bridges, whatever the misfit; and nothing is beyond the first two.
TEST(LatticeSubstrate, ExtremesStandWhereTheyAreExpected) {
  const std::vector<std::vector<Extreme>> extremes = {
      {{0.0, 0.0, 2.0}, {0.5, 0.5, -2.0}, {0.5, 0.0, 0.0}},
      {{0.0, 0.0, 3.0}, {1.0 / 3, 1.0 / 3, -1.5}, {2.0 / 3, 2.0 / 3, -1.5}, {0.5, 0.0, -1.0}},
      {{1.0 / 3, 1.0 / 3, 1.5}, {0.0, 0.0, -3.0}, {2.0 / 3, 2.0 / 3, 1.5}, {0.5, 0.5, 1.0}}};
  for (std::size_t k = 0; k < 3; ++k) {
    for (const double misfit : {0.0, 0.3}) {
      const Surface surface = named(kPlane[k], 0.2, 1.7, misfit);
      const double turn = kPlane[k] == SurfaceLattice::square ? 0.25 : 1.0 / 6;
      const auto at = [&](double n1, double n2) {
        const double second = misfit + kTau * turn;
        return std::array{1.7 * (n1 * std::cos(misfit) + n2 * std::cos(second)),
                          1.7 * (n1 * std::sin(misfit) + n2 * std::sin(second))};
      };
      for (const Extreme& extreme : extremes[k]) {
        const auto [x, y] = at(extreme.n1, extreme.n2);
        EXPECT_NEAR(energy(surface, x, y), 0.2 * extreme.energy, kFewRoundings);
        const auto pull = force(surface, x, y);
        EXPECT_NEAR(std::hypot(pull[0], pull[1]), 0.0, kFewRoundings);
      }
      const double first = 0.2 * extremes[k][0].energy;
      const double second = 0.2 * extremes[k][1].energy;
      everywhere([&](double x, double y) {
        EXPECT_LE(energy(surface, x, y), std::max(first, second) + kFewRoundings);
        EXPECT_GE(energy(surface, x, y), std::min(first, second) - kFewRoundings);
      });
    }
  }
}

TEST(LatticeSubstrate, TurningByTheSymmetryOfTheLatticeChangesNothing) {
  const auto change = [](const Surface& surface, double angle) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return largest_difference(
        [&](double x, double y) { return energy(surface, x, y); },
        [&](double x, double y) { return energy(surface, c * x - s * y, s * x + c * y); });
  };
  for (const SurfaceLattice lattice : kPlane) {
    const double own = kTau / (lattice == SurfaceLattice::square ? 4.0 : 6.0);
    Surface surface = named(lattice);
    EXPECT_LT(change(surface, own), kFewRoundings);
    surface.amplitude = Surface::kAbsent;
    surface.amplitudes.numbers = {0.5, -0.3, 0.2,
                                  0.1};  // the fourth has vectors out of all mirrors
    EXPECT_LT(change(surface, own), 4.0 * kFewRoundings);
    EXPECT_GT(change(surface, 0.5 * own), 0.1) << "negative control";
  }
  const Surface wrong =
      with_harmonics(SurfaceLattice::hexagonal, {1, 0, 0, 1, 1, -1}, {1.0, 1.0, 1.0});
  EXPECT_GT(change(wrong, kTau / 6.0), 0.5) << "negative control";
}

TEST(LatticeSubstrate, AMisfitTurnsForces) {
  for (const SurfaceLattice lattice : kPlane) {
    for (const double angle : {0.1, -1.0, std::numbers::pi / 6.0, 4.0}) {
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      const Surface straight = named(lattice);
      const Surface turned = named(lattice, 1.0, 1.0, angle);
      everywhere([&](double x, double y) {
        const auto before = force(straight, x, y);
        const auto after = force(turned, c * x - s * y, s * x + c * y);
        EXPECT_NEAR(after[0], c * before[0] - s * before[1], 20.0 * kFewRoundings);
        EXPECT_NEAR(after[1], s * before[0] + c * before[1], 20.0 * kFewRoundings);
      });
    }
  }
}

// ---- stars --------------------------------------------------------------------------------------

TEST(LatticeSubstrate, StarsAreWholeAndInOrderOfLength) {
  const auto sizes = [](Surface surface, std::size_t stars) {
    std::vector<std::size_t> found;
    std::size_t before = 0;
    for (std::size_t k = 1; k <= stars; ++k) {
      surface.amplitude = Surface::kAbsent;
      surface.amplitudes.numbers.assign(k, 1.0);
      const std::size_t now = lattice_harmonics(surface).size();
      found.push_back(now - before);
      before = now;
    }
    return found;
  };
  using Sizes = std::vector<std::size_t>;
  // Squares of lengths 1, 2, 4, 5, 8, 9, 10, 13, and in units of the first 1, 3, 4, 7, 9.
  EXPECT_EQ(sizes(named(SurfaceLattice::square), 8), (Sizes{2, 2, 2, 4, 2, 2, 4, 4}));
  EXPECT_EQ(sizes(named(SurfaceLattice::hexagonal), 5), (Sizes{3, 3, 3, 6, 3}));
  EXPECT_EQ(sizes(named(SurfaceLattice::hexagonal, 1.0, 0.3, 0.7), 5), (Sizes{3, 3, 3, 6, 3}));
  EXPECT_EQ(sizes(named(SurfaceLattice::line), 3), (Sizes{1, 1, 1}));
  Surface oblique = named(SurfaceLattice::given);
  oblique.lattice_vectors = {2, {1.0, 0.0, 0.3, 1.2}};
  EXPECT_EQ(sizes(oblique, 4), (Sizes{1, 1, 1, 1}));
  Surface rectangular = oblique;
  rectangular.lattice_vectors = {2, {1.0, 0.0, 0.0, 1.2}};
  EXPECT_EQ(sizes(rectangular, 3), (Sizes{1, 1, 2}));
}

/// The potential is the same by other vectors of the same lattice, and term by term.
TEST(LatticeSubstrate, WaysToDescribeALatticeAgree) {
  Surface surface = named(SurfaceLattice::hexagonal);
  surface.amplitude = Surface::kAbsent;
  surface.amplitudes.numbers = {0.4, 0.3};
  Surface given = surface;
  given.lattice = SurfaceLattice::given;
  given.lattice_vectors = {2, {0.5, 0.5 * std::numbers::sqrt3, -0.5, 0.5 * std::numbers::sqrt3}};
  const Surface terms =
      with_harmonics(SurfaceLattice::hexagonal, {1, 0, 0, -1, -1, -1, 2, 1, 1, 2, -1, 1},
                     {0.4, 0.4, 0.4, 0.3, 0.3, 0.3});
  for (const Surface& other : {given, terms}) {
    EXPECT_LT(largest_difference([&](double x, double y) { return energy(surface, x, y); },
                                 [&](double x, double y) { return energy(other, x, y); }),
              4.0 * kFewRoundings);
  }
  // In a honeycomb all stars raise the atoms: 3 (0.4/2 + 0.3).
  surface.lattice = SurfaceLattice::honeycomb;
  EXPECT_NEAR(energy(surface, 0.5, 0.5 / std::numbers::sqrt3), 1.5, kFewRoundings);
}

TEST(LatticeSubstrate, BothEvaluatorsAgree) {
  for (const SurfaceLattice lattice : kPlane) {
    const Surface surface = named(lattice, 0.8, 1.3, 0.2);
    everywhere([&](double x, double y) {
      const Vec<double, 2> position{{x, y}};
      const auto first = evaluate<LatticeFirst>(surface, position);
      const auto higher = evaluate<LatticeHigher>(surface, position);
      EXPECT_NEAR(first.energy, higher.energy, kFewRoundings);
      EXPECT_NEAR(first.force[0], higher.force[0], 10.0 * kFewRoundings);
      EXPECT_NEAR(first.force[1], higher.force[1], 10.0 * kFewRoundings);
    });
  }
}

// ---- forces -------------------------------------------------------------------------------------

/// Against the energy's derivatives by dual numbers, which are exact.
template <class E, int D>
double largest_error_of_gradient(const Surface& d, Random& random) {
  auto p = E::template parameters<double, D>(d);
  E::template rebase<double, D>(p, d, Origin{});
  double largest = 0.0;
  for (int k = 0; k < kPoints; ++k) {
    Site<double, D> site{};
    for (int axis = 0; axis < D; ++axis) site.position[axis] = uniform(random, -1.0, 1.0);
    const auto energy = E::energy(in_type<E, Dual<double, D>, double, D>(p), differentiable(site));
    const auto force = E::force(p, site);
    for (int axis = 0; axis < D; ++axis) {
      largest = std::max(largest, std::abs(force[axis] + energy.derivative[axis]));
    }
  }
  return largest;
}

TEST(LatticeSubstrate, ForcesAreTheGradient) {
  // Amplitudes of 1 times wave numbers up to 2 pi 6, some 20 of them.
  constexpr double kRoundingOfForces = 1e3 * 1e-15 * 40.0;
  Random random(5);
  Surface oblique = named(SurfaceLattice::given);
  oblique.lattice_vectors = {2, {1.0, 0.2, -0.3, 1.2}};
  oblique.amplitude = Surface::kAbsent;
  std::vector<double> pairs;
  for (int m = -3; m <= 3; ++m) {
    for (int n = -3; n <= 3; ++n) {
      if (m < 0 || (m == 0 && n <= 0)) continue;
      pairs.insert(pairs.end(), {static_cast<double>(m), static_cast<double>(n)});
      oblique.amplitudes.numbers.push_back(uniform(random, -1.0, 1.0));
      oblique.decay.numbers.push_back(uniform(random, 0.1, 2.0));
    }
  }
  oblique.harmonics = {2, pairs};
  oblique.repulsion = 0.7;
  oblique.repulsion_decay = 1.3;
  ASSERT_EQ(lattice_harmonics(oblique).size(), 24u);
  Surface line = named(SurfaceLattice::line);
  line.amplitude = Surface::kAbsent;
  line.amplitudes.numbers = {0.3, -0.4, 0.5};
  line.decay.numbers = {0.2, 0.9, 1.4};
  line.repulsion = 0.2;
  line.repulsion_decay = 1.1;
  Surface hexagonal = named(SurfaceLattice::hexagonal, 0.6, 1.1, 0.4);
  hexagonal.decay.numbers = {1.7};
  hexagonal.repulsion = 0.7;
  hexagonal.repulsion_decay = 1.9;
  const double errors[] = {largest_error_of_gradient<LatticeHigher, 1>(line, random),
                           largest_error_of_gradient<LatticeHigher, 2>(line, random),
                           largest_error_of_gradient<LatticeHigher, 2>(oblique, random),
                           largest_error_of_gradient<LatticeHigher, 3>(oblique, random),
                           largest_error_of_gradient<LatticeFirst, 2>(hexagonal, random),
                           largest_error_of_gradient<LatticeFirst, 3>(hexagonal, random),
                           largest_error_of_gradient<LatticeFirstAtHeight, 3>(hexagonal, random),
                           largest_error_of_gradient<LatticeHigherAtHeight, 3>(oblique, random),
                           largest_error_of_gradient<LatticeHigherAtHeight, 2>(line, random),
                           largest_error_of_gradient<LatticeStarsAtHeight, 2>(line, random),
                           largest_error_of_gradient<LatticeStarsAtHeight, 3>(oblique, random)};
  for (const double error : errors) {
    EXPECT_LT(error, kRoundingOfForces);
    EXPECT_GT(error, 0.0) << "the two ways have different roundings";
  }
}

/// On a line, and on one in the plane, it is the sinusoidal substrate.
TEST(LatticeSubstrate, OneHarmonicOnALineIsTheSinusoidalSubstrate) {
  SinusoidalSubstrateDescription other;
  other.amplitude = 0.4;
  other.period = 1.3;
  const Surface line = named(SurfaceLattice::line, 0.4, 1.3);
  const auto compare = [&]<int D>(const Vec<double, D>& position) {
    Site<double, D> site{};
    site.position = position;
    site.frame = frame_at<SinusoidalSubstrate, double, D>(other, {});
    const auto p = SinusoidalSubstrate::parameters<double, D>(other);
    const auto found = evaluate<LatticeFirst>(line, position);
    EXPECT_NEAR(found.energy, SinusoidalSubstrate::energy(p, site), kFewRoundings);
    const auto expected = SinusoidalSubstrate::force(p, site);
    for (int axis = 0; axis < D; ++axis) {
      EXPECT_NEAR(found.force[axis], expected[axis], kFewRoundings);
    }
  };
  everywhere([&](double x, double y) {
    compare(Vec<double, 1>{{x}});
    compare(Vec<double, 2>{{x, y}});
    compare(Vec<double, 3>{{x, y, 0.3}});
  });
}

// ---- height -------------------------------------------------------------------------------------

/// With one decay for all, the direction of the force does not depend on the height.
TEST(LatticeSubstrate, LateralAndNormalForceAreProportional) {
  Surface surface = named(SurfaceLattice::hexagonal, 0.1);
  surface.repulsion = 2.0;
  surface.repulsion_decay = 3.0;
  surface.decay.numbers = {3.0};
  const auto ratio = [&](double x, double y, double z) {
    const auto pull = evaluate<LatticeFirstAtHeight>(surface, Vec<double, 3>{{x, y, z}}).force;
    return std::array{pull[0] / pull[2], pull[1] / pull[2]};
  };
  double changed = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    everywhere([&](double x, double y) {
      const auto low = ratio(x, y, -1.0);
      const auto high = ratio(x, y, 2.0);
      changed = std::max({changed, std::abs(low[0] - high[0]), std::abs(low[1] - high[1])});
      // Against the closed form: lateral force over normal force per energy of the surface.
      const auto flat = force(surface, x, y);
      const double all = 3.0 * (surface.repulsion + energy(surface, x, y));
      if (pass == 0) {
        EXPECT_NEAR(high[0], flat[0] / all, kFewRoundings);
        EXPECT_NEAR(high[1], flat[1] / all, kFewRoundings);
      }
    });
    if (pass == 0) {
      EXPECT_LT(changed, kFewRoundings);
    } else {
      EXPECT_GT(changed, 0.1) << "negative control";
    }
    surface.decay.numbers = {4.0};
  }
}

/// A side view is a cut through a surface: of a square one along its rows.
TEST(LatticeSubstrate, ASideViewIsACutThroughTheSurface) {
  Surface square = with_harmonics(SurfaceLattice::square, {1, 0, 2, 0}, {0.4, 0.3});
  square.repulsion = 1.0;
  square.repulsion_decay = 2.0;
  square.decay.numbers = {1.0, 1.5};
  Surface side = square;
  side.lattice = SurfaceLattice::line;
  side.harmonics = {};
  side.height = HeightAxis::y;
  everywhere([&](double x, double y) {
    const auto whole = evaluate<LatticeStarsAtHeight>(square, Vec<double, 3>{{x, 0.0, y}});
    const auto cut = evaluate<LatticeStarsAtHeight>(side, Vec<double, 2>{{x, y}});
    const double size = std::exp(-2.0 * std::min(y, 0.0));
    EXPECT_NEAR(whole.energy, cut.energy, kFewRoundings * size);
    EXPECT_NEAR(whole.force[0], cut.force[0], 10.0 * kFewRoundings * size);
    EXPECT_NEAR(whole.force[2], cut.force[1], 10.0 * kFewRoundings * size);
  });
}

/// An exponential that overflows makes no NaN if its amplitude is zero.
TEST(LatticeSubstrate, OnlyWhatDivergesOverflows) {
  Surface surface = named(SurfaceLattice::hexagonal, 0.1);
  surface.decay.numbers = {0.1};
  surface.repulsion_decay = 10.0;
  const auto low = evaluate<LatticeFirstAtHeight>(surface, Vec<double, 3>{{0.1, 0.2, -100.0}});
  EXPECT_TRUE(std::isfinite(low.energy));
  EXPECT_NE(low.energy, 0.0);
  surface.repulsion = 1.0;
  const auto beyond = evaluate<LatticeFirstAtHeight>(surface, Vec<double, 3>{{0.1, 0.2, -100.0}});
  EXPECT_EQ(beyond.force[2], std::numeric_limits<double>::infinity());
}

// ---- periods, and positions far away
// ---------------------------------------------------------------

TEST(LatticeSubstrate, PeriodsAlongTheAxesAreThoseOfTheRectangularCell) {
  const auto periods = [](const Surface& d) {
    return std::array{lattice_period(d, 0), lattice_period(d, 1), lattice_period(d, 2)};
  };
  using Periods = std::array<double, 3>;
  EXPECT_EQ(periods(named(SurfaceLattice::square, 1.0, 0.3)), (Periods{0.3, 0.3, 0.0}));
  EXPECT_EQ(periods(named(SurfaceLattice::hexagonal)), (Periods{1.0, std::sqrt(3.0), 0.0}));
  EXPECT_EQ(periods(named(SurfaceLattice::line)), (Periods{1.0, 0.0, 0.0}));
  EXPECT_EQ(periods(named(SurfaceLattice::hexagonal, 1.0, 1.0, 0.1)), (Periods{}));
  Surface oblique = named(SurfaceLattice::given);
  oblique.lattice_vectors = {2, {2.0, 0.0, 0.5, 1.5}};
  EXPECT_EQ(periods(oblique), (Periods{2.0, 6.0, 0.0}));
  oblique.lattice_vectors = {2, {2.0, 0.1, 0.5, 1.5}};
  EXPECT_EQ(periods(oblique), (Periods{}));
}

/// Along both lattice vectors, which in general lie on no axis.
TEST(LatticeSubstrate, ALatticeVectorChangesNothing) {
  Surface oblique = named(SurfaceLattice::given, 1.0, Surface::kAbsent, 0.8);
  oblique.lattice_vectors = {2, {1.0, 0.0, 0.3, 1.2}};
  oblique.amplitude = Surface::kAbsent;
  oblique.amplitudes.numbers = {1.0, 0.7};
  const double c = std::cos(0.8);
  const double s = std::sin(0.8);
  const std::array<double, 2> vectors[] = {{c, s}, {0.3 * c - 1.2 * s, 0.3 * s + 1.2 * c}};
  for (const auto& vector : vectors) {
    const double x0 = vector[0];
    const double y0 = vector[1];
    const auto change = [&](double part) {
      return largest_difference(
          [&](double x, double y) { return energy(oblique, x, y); },
          [&](double x, double y) { return energy(oblique, x + part * x0, y + part * y0); });
    };
    EXPECT_LT(change(1.0), kFewRoundings);
    EXPECT_LT(change(-3.0), 4.0 * kFewRoundings);
    EXPECT_GT(change(0.5), 0.01) << "negative control";
  }
}

/// An origin that moves by whole cells leaves every number as it was.
TEST(LatticeSubstrate, WholeCellsChangeNoBit) {
  for (const SurfaceLattice lattice : kPlane) {
    for (const double period : {1.0, 0.246, 1.0 / 3.0}) {
      const Surface surface = named(lattice, 0.3, period);
      const auto phases = [&](std::int64_t nx, std::int64_t ny, double part = 1.0) {
        Origin origin;
        origin.unit = {lattice_period(surface, 0), part * lattice_period(surface, 1), 0.0};
        origin.cells = {nx, ny, 0};
        auto p = LatticeFirst::parameters<double, 2>(surface);
        LatticeFirst::rebase<double, 2>(p, surface, origin);
        return p.phase;
      };
      const auto same = [&](const Vec<double, 2>& one) {
        return one[0] == phases(0, 0)[0] && one[1] == phases(0, 0)[1];
      };
      for (const std::int64_t far : {1LL, -7LL, 2000000011LL, 1000000000000LL}) {
        EXPECT_TRUE(same(phases(far, 0)));
        EXPECT_TRUE(same(phases(0, far)));
        EXPECT_TRUE(same(phases(far, -3 * far)));
      }
      EXPECT_FALSE(same(phases(0, 3, 0.9))) << "negative control";
    }
  }
}

/// Sums the harmonics in quadruple precision, with all digits of the position.
Quad energy_of_sum(const Surface& d, Quad x, Quad y) {
  const auto reciprocal = reciprocal_lattice(d);
  Quad total(0.0);
  for (const LatticeHarmonic& harmonic : lattice_harmonics(d)) {
    Quad turns(0.0);
    for (std::size_t j = 0; j < 2; ++j) {
      const Quad along = x * from_double_double<Quad>(reciprocal[j][0]) +
                         y * from_double_double<Quad>(reciprocal[j][1]);
      turns = turns + Quad(static_cast<double>(j == 0 ? harmonic.m : harmonic.n)) * along;
    }
    total = total + Quad(harmonic.amplitude) * cos_turns(turns - round(turns));
  }
  return total;
}

/// Along lattice vectors that lie on no axis, from cells that fit none.
TEST(LatticeSubstrate, FarAwayItIsAsExactAsNearby) {
  for (const double misfit : {0.0, 0.2, -1.1}) {
    for (const SurfaceLattice lattice : kPlane) {
      const Surface surface = named(lattice, 1.0, 0.7, misfit);
      const double second = misfit + kTau / (lattice == SurfaceLattice::square ? 4.0 : 6.0);
      const std::array<double, 2> ways[] = {
          {std::cos(misfit), std::sin(misfit)},
          {std::cos(second), std::sin(second)},
          {std::cos(misfit) + std::cos(second), std::sin(misfit) + std::sin(second)}};
      Random random(11);
      for (const auto& way : ways) {
        for (const double cells : {1e3, 1e6, 1e9, 1e12}) {
          Origin origin;
          origin.unit = {0.7, 0.7, 0.0};
          Vec<double, 2> position;
          Quad full[2] = {};
          for (std::size_t axis = 0; axis < 2; ++axis) {
            origin.cells[axis] = std::llround(cells * way[axis]);
            position[static_cast<int>(axis)] = uniform(random, -0.7, 0.7);
            full[axis] = Quad(static_cast<double>(origin.cells[axis])) * Quad(0.7) +
                         Quad(position[static_cast<int>(axis)]);
          }
          const double exact = static_cast<double>(energy_of_sum(surface, full[0], full[1]));
          EXPECT_NEAR(evaluate<LatticeFirst>(surface, position, origin).energy, exact,
                      kFewRoundings)
              << cells;
          // A position that is stored as one double has an error of some 1e-16 of it.
          const double stored =
              energy(surface, static_cast<double>(full[0]), static_cast<double>(full[1]));
          if (cells == 1e12) {
            EXPECT_GT(std::abs(stored - exact), 1e-6) << "negative control";
          }
        }
      }
    }
  }
}

// ---- scenes -------------------------------------------------------------------------------------

const std::string kTip = tables(R"([[body]] | name = "tip" | type = "point"
position = [0.31, 0.12] | velocity = [0.7, 0.4] | particle_mass = 1.0
)");

std::string surface_text(const std::string& keys) {
  return "[[force]]\nname = \"surface\"\ntype = \"lattice_substrate\"\n" + keys;
}

std::string run_for(double duration, const std::string& integrator) {
  return "[run]\nduration = " + digits(duration) + "\nledger = true\nintegrator = " + integrator +
         "\n";
}

/// A point and a rigid body, in plane and space, by a fixed step and an adaptive one.
TEST(LatticeSubstrate, EnergyIsConserved) {
  const std::string flat = surface_text("lattice = \"hexagonal\"\nperiod = 1.0\namplitude = 0.1\n");
  const std::string misfit = surface_text(
      "lattice = \"honeycomb\"\nperiod = 1.0\namplitudes = [0.1, 0.05]\nmisfit = 0.3\n");
  const std::string ring = tables(R"([[body]] | type = "ring" | count = 6 | radius = 0.8
particle_mass = 0.3 | centre = [0.2, 0.1] | velocity = [0.5, 0.3] | coordinates = "rigid"
)");
  const std::string ball = tables(R"([[body]] | name = "ball" | type = "point"
position = [0.3, 0.1, 1.0] | velocity = [0.4, 0.3, -0.5] | particle_mass = 1.0
)");
  const std::string wall = surface_text(
      "lattice = \"square\"\nperiod = 1.0\namplitudes = [0.1, 0.05]\nmisfit = 0.2\n"
      "decay = [2.0, 3.0]\nrepulsion = 1.0\nrepulsion_decay = 2.5\n");
  const std::vector<std::pair<std::string, std::string>> scenes = {
      {"tip", kTip + flat}, {"tip", kTip + misfit}, {"ring", ring + misfit}, {"ball", ball + wall}};
  for (const auto& [body, scene] : scenes) {
    for (const std::string& integrator : {fixed_step(2e-3), adaptive(1e-12)}) {
      const RunResult result = run_text(scene + run_for(20.0, integrator));
      ASSERT_EQ(result.status, RunStatus::finished);
      EXPECT_NEAR(result.group("energy")["numerical_work"].value(), 0.0, 1e-9);
      const double fastest = observable(result, body + ".max_speed").value();
      EXPECT_GT(fastest - std::abs(observable(result, body + ".velocity.x").value()), 0.1)
          << "it has met something";
    }
  }
}

/// The origin follows the tip over a lattice that has no period along the axes, as a formula, which
/// declares none, has it.
TEST(LatticeSubstrate, ATipThatIsDraggedOverAMisfitLatticeFindsTheSameSurface) {
  const std::string driver = tables(R"([[force]] | name = "driver" | type = "driving_spring"
stiffness = 2.0 | velocity = [1.0, 0.7]
[[force]] | type = "viscous_damping" | coefficient = 1.0
)");
  const std::string formula = R"--([[force]]
name = "surface"
type = "expression"
energy = "0.1*(cos(2*pi*(x*cos(0.3)+y*sin(0.3))) + cos(2*pi*(-x*sin(0.3)+y*cos(0.3))))"
)--";
  const std::string built_in =
      surface_text("lattice = \"square\"\nperiod = 1.0\namplitude = 0.1\nmisfit = 0.3\n");
  const std::string end = run_for(60.0, adaptive(1e-12));
  const RunResult one = run_text(kTip + driver + built_in + end);
  const RunResult other = run_text(kTip + driver + formula + end);
  for (const char* path : {"tip.centre_of_mass.x", "tip.centre_of_mass.y", "driver.mean_force.x"}) {
    const double found = observable(one, path).value();
    EXPECT_NEAR(found, observable(other, path).value(), 1e-9 * std::abs(found)) << path;
  }
}

/// The keys of the force begin in line 10.
std::string refused(const std::string& keys, const std::string& position = "0.3, 0.1",
                    const std::string& more = "") {
  return brief_refusal("[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [" + position +
                       "]\nvelocity = [" + position + "]\nparticle_mass = 1.0\n" +
                       surface_text(keys) + run_for(1.0, fixed_step(1e-3)) + more);
}

const std::string kHexagonal = "lattice = \"hexagonal\"\nperiod = 1.0\n";

TEST(LatticeSubstrate, WhatDoesNotFitIsRefused) {
  const std::string amplitude = "amplitude = 0.1\n";
  EXPECT_EQ(refused(kHexagonal + amplitude), "");
  EXPECT_EQ(refused(amplitude), "7:1 force.surface.lattice [scene.missing_key]");
  EXPECT_EQ(refused("lattice = \"cubic\"\n" + amplitude),
            "10:11 force.surface.lattice = \"cubic\" [scene.unknown_choice]");
  EXPECT_EQ(refused("lattice = \"square\"\n" + amplitude),
            "7:1 force.surface.period [scene.missing_key]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "lattice_vectors = [[1, 0], [0, 1]]\n"),
            "13:19 force.surface.lattice_vectors = [[1, 0], [0, 1]] [scene.conflict]");
  EXPECT_EQ(refused("lattice_vectors = [[1, 2], [2, 4]]\n" + amplitude),
            "10:19 force.surface.lattice_vectors = [[1, 2], [2, 4]] [component.invalid]");
  EXPECT_EQ(refused("lattice_vectors = [[1, 2, 0], [2, 4, 1]]\n" + amplitude),
            "10:19 force.surface.lattice_vectors = [[1, 2, 0], [2, 4, 1]] [scene.wrong_count]");
  EXPECT_EQ(refused("lattice_vectors = [[1, 2], [0, 1]]\nperiod = 1.0\n" + amplitude),
            "11:10 force.surface.period = 1.0 [scene.conflict]");
  EXPECT_EQ(refused(kHexagonal), "7:1 force.surface.amplitude [scene.missing_key]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "amplitudes = [0.1]\n"),
            "13:14 force.surface.amplitudes = [0.1] [scene.conflict]");
  EXPECT_EQ(refused(kHexagonal + "amplitudes = [1, 1, 1, 1, 1, 1]\n"),
            "12:14 force.surface.amplitudes = [1, 1, 1, 1, 1, 1] [scene.wrong_count]");
  EXPECT_EQ(refused(kHexagonal + "amplitudes = [1, 1]\nharmonics = [[1, 0]]\n"),
            "12:14 force.surface.amplitudes = [1, 1] [scene.wrong_count]");
  EXPECT_EQ(refused(kHexagonal + "amplitudes = [1, 1]\nharmonics = [[1, 0], [-1, 0]]\n"),
            "13:13 force.surface.harmonics = [[1, 0], [-1, 0]] [component.invalid]");
  EXPECT_EQ(refused(kHexagonal + "amplitudes = 1\nharmonics = [[4, 0]]\n"),
            "13:13 force.surface.harmonics = [[4, 0]] [component.invalid]");
  EXPECT_EQ(refused(kHexagonal + "amplitudes = 1\nharmonics = [[0, 0]]\n"),
            "13:13 force.surface.harmonics = [[0, 0]] [component.invalid]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "decay = 1.0\nrepulsion = 1.0\n"),
            "13:9 force.surface.decay = 1.0 [component.unsuitable]\n14:13 force.surface.repulsion "
            "= 1.0 [component.unsuitable]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "height = \"y\"\nmisfit = 0.1\n"),
            "10:11 force.surface.lattice = \"hexagonal\" [component.unsuitable]\n14:10 "
            "force.surface.misfit = 0.1 [component.unsuitable]");
  EXPECT_EQ(refused(kHexagonal + amplitude, "0.3"),
            "10:11 force.surface.lattice = \"hexagonal\" [component.unsuitable]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "repulsion = 1.0\ndecay = [1.0, 2.0]\n", "0, 0, 1"),
            "7:1 force.surface.repulsion_decay [scene.missing_key]\n14:9 force.surface.decay = "
            "[1.0, 2.0] [scene.wrong_count]");
  EXPECT_EQ(refused(kHexagonal + amplitude + "height = \"y\"\n", "0, 0, 1"),
            "13:10 force.surface.height = \"y\" [component.unsuitable]");
}

TEST(LatticeSubstrate, ABoxHasToFit) {
  const std::string amplitude = "amplitude = 0.1\n";
  const auto box = [](const std::string& lengths, const std::string& periodic) {
    return "[box]\nlengths = [" + lengths + "]\nperiodic = [" + periodic + "]\n";
  };
  const std::string plane = "0.3, 0.1";
  const std::string both = "true, true";
  const std::string heights = digits(3.0 * std::sqrt(3.0));
  EXPECT_EQ(refused(kHexagonal + amplitude, plane, box("2.0, " + heights, both)), "");
  EXPECT_EQ(refused(kHexagonal + amplitude, plane, box("2.0, 3.0", both)),
            "18:11 box.lengths = [2.0, 3.0] [box.invalid]");
  EXPECT_EQ(refused(kHexagonal + amplitude, plane, box("2.0, 3.0", "true, false")), "");
  EXPECT_EQ(
      refused(kHexagonal + amplitude + "misfit = 0.1\n", plane, box("2.0, 3.0", "true, false")),
      "13:10 force.surface.misfit = 0.1 [box.invalid]");
  // The commensurate cell of a square lattice turned by the angle of 3 and 4.
  const std::string turned =
      "lattice = \"square\"\nperiod = 1.0\namplitude = 0.1\nmisfit = \"atan2(3, 4)\"\n";
  EXPECT_EQ(refused(turned, plane, box("5.0, 10.0", both)), "");
  EXPECT_EQ(refused(turned, plane, box("5.0, 4.0", both)),
            "13:10 force.surface.misfit = \"atan2(3, 4)\" [box.invalid]");
  const std::string high = kHexagonal + amplitude + "decay = 1.0\n";
  EXPECT_EQ(refused(high, "0, 0, 1", box("2.0, 1.0, 1.0", "true, false, true")),
            "13:9 force.surface.decay = 1.0 [box.invalid]");
  EXPECT_EQ(refused(high, "0, 0, 1", box("2.0, 1.0, 1.0", "true, false, false")), "");
}

/// A run knows its position in a lattice that lies across the axes as well as in one along them.
TEST(LatticeSubstrate, ARunFarAwayIsThatOfTheSamePlaceNearby) {
  const double x = 1e9;
  const double y = 0.25;
  const auto b = reciprocal_lattice(named(SurfaceLattice::square, 0.1, 1.0, 0.3));
  double part[2];
  for (std::size_t j = 0; j < 2; ++j) {
    const Quad turns =
        Quad(x) * from_double_double<Quad>(b[j][0]) + Quad(y) * from_double_double<Quad>(b[j][1]);
    part[j] = static_cast<double>(turns - round(turns));
  }
  const auto velocity = [](double from_x, double from_y) {
    const RunResult result = run_text(
        "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [" + digits(from_x) + ", " +
        digits(from_y) + "]\nvelocity = [0.7, 0.4]\nparticle_mass = 1.0\n" +
        surface_text("lattice = \"square\"\nperiod = 1.0\namplitude = 0.1\nmisfit = 0.3\n") +
        run_for(5.0, adaptive(1e-12)));
    return std::array{observable(result, "tip.velocity.x").value(),
                      observable(result, "tip.velocity.y").value()};
  };
  constexpr double kSameRun = 1e-10;  // a hundred times the tolerance; positions there have 1e-7
  const auto far = velocity(x, y);
  const auto near = velocity(part[0] * std::cos(0.3) - part[1] * std::sin(0.3),
                             part[0] * std::sin(0.3) + part[1] * std::cos(0.3));
  EXPECT_NEAR(far[0], near[0], kSameRun);
  EXPECT_NEAR(far[1], near[1], kSameRun);
  EXPECT_GT(std::abs(far[0] - 0.7), 0.01) << "the surface acts";
}

TEST(LatticeSubstrate, FarBelowTheSurfaceTheRunNamesTheForce) {
  const RunResult result = run_text(
      tables(R"([[body]] | type = "point" | position = [0.3, 0.1, -200.0] | particle_mass = 1.0
)") + surface_text("lattice = \"square\"\nperiod = 1.0\namplitude = 0.1\ndecay = 5.0\n") +
      "[run]\nduration = 1.0\nallow_unstable = true\nintegrator = " + fixed_step(1e-3) + "\n");
  EXPECT_EQ(result.status, RunStatus::failed);
  ASSERT_TRUE(result.failure.has_value());
  EXPECT_NE(to_string(*result.failure).find("surface"), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
