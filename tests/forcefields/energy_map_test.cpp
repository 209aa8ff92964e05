#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/lattice_substrate.hpp"
#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/numbers/periodic_spline.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/random_description.hpp"
#include "tests/support/scenes.hpp"

// The energy on a grid against the closed form of a spline through a wave, and against the surface
// that the grid was taken from.

namespace tomlin::test {
namespace {

using Surface = LatticeSubstrateDescription;

/// Some roundings of numbers of order 1.
constexpr double kFewRoundings = 4e-15;
constexpr std::uint64_t kSeeds[] = {1, 42, 20240611};
constexpr int kRandomPoints = 300;

/// A periodic function of u and v in a cell, with waves in all directions.
double sampled(double u, double v) {
  return 0.3 * std::cos(kTau * u) + 0.2 * std::sin(kTau * (u + v)) +
         0.1 * std::cos(kTau * (u - 2.0 * v) + 0.4);
}

NumberTable grid_of(std::size_t rows, std::size_t columns) {
  NumberTable grid{columns, {}};
  for (std::size_t m = 0; m < rows; ++m) {
    for (std::size_t n = 0; n < columns; ++n) {
      grid.numbers.push_back(sampled(static_cast<double>(m) / static_cast<double>(rows),
                                     static_cast<double>(n) / static_cast<double>(columns)));
    }
  }
  return grid;
}

Surface surface_of(NumberTable grid, SurfaceLattice lattice = SurfaceLattice::hexagonal,
                   double misfit = 0.0) {
  Surface d;
  d.lattice = lattice;
  d.period = 1.0;
  d.misfit = misfit;
  d.map = std::make_shared<PeriodicSpline>(grid.columns, std::move(grid.numbers));
  return d;
}

template <class E, int D, class T = double>
auto parameters_of(const Surface& d, const Origin& origin = {}) {
  auto p = E::template parameters<T, D>(d);
  E::template rebase<T, D>(p, d, origin);
  return p;
}

template <int D, class T = double>
Site<T, D> site_at(const Surface& d, const Vec<T, D>& position) {
  Site<T, D> site{};
  site.position = position;
  site.table = d.map->table();
  return site;
}

/// Returns the energy of the map on a square lattice with the period 1: u and v are x and y.
double energy_at(const Surface& d, double u, double v) {
  return LatticeOfMap::energy(parameters_of<LatticeOfMap, 2>(d),
                              site_at(d, Vec<double, 2>{{u, v}}));
}

TEST(EnergyMap, PassesThroughTheValues) {
  for (const auto& [rows, columns] : {std::array<std::size_t, 2>{4, 4}, {5, 9}, {16, 7}}) {
    const NumberTable grid = grid_of(rows, columns);
    const Surface d = surface_of(grid, SurfaceLattice::square);
    for (std::size_t m = 0; m < rows; ++m) {
      for (std::size_t n = 0; n < columns; ++n) {
        // Whole cells away as well.
        const double u = static_cast<double>(m) / static_cast<double>(rows) - 2.0;
        const double v = static_cast<double>(n) / static_cast<double>(columns) + 3.0;
        EXPECT_NEAR(energy_at(d, u, v), grid.numbers[m * columns + n], 3.0 * kFewRoundings);
      }
    }
    // So little below a whole period that the rest is rounded to one.
    EXPECT_NEAR(energy_at(d, -1e-18, -1e-18), grid.numbers[0], 3.0 * kFewRoundings);
  }
}

/// Through the values of cos(2 pi u) at N points the spline is, half way between two of them, the
/// wave times the ratio of the sums of B(1/2), B(3/2) and of B(0), B(1) over it.
TEST(EnergyMap, OfAWaveItIsTheClosedForm) {
  for (const std::size_t points : {4U, 6U, 11U, 32U}) {
    NumberTable grid{1, {}};
    const auto count = static_cast<double>(points);
    for (std::size_t k = 0; k < points; ++k) {
      grid.numbers.push_back(std::cos(kTau * static_cast<double>(k) / count));
    }
    const Surface d = surface_of(grid, SurfaceLattice::line);
    const auto p = parameters_of<LatticeOfMap, 1>(d);
    const double step = kTau / count;
    const double ratio = (46.0 * std::cos(0.5 * step) + 2.0 * std::cos(1.5 * step)) / 48.0 /
                         ((4.0 + 2.0 * std::cos(step)) / 6.0);
    for (std::size_t k = 0; k < points; ++k) {
      const double u = (static_cast<double>(k) + 0.5) / count;
      EXPECT_NEAR(LatticeOfMap::energy(p, site_at(d, Vec<double, 1>{{u}})),
                  ratio * std::cos(kTau * u), kFewRoundings);
    }
    // The estimated error is that of the amplitude, at the largest of these cosines.
    double largest = 0.0;
    for (std::size_t k = 0; k < points; ++k) {
      largest =
          std::max(largest, std::abs(std::cos(kTau * (static_cast<double>(k) + 0.5) / count)));
    }
    EXPECT_NEAR(d.map->error().value, std::abs(1.0 - ratio) * largest, kFewRoundings);
    EXPECT_GT(d.map->error().value, 1e-7) << "negative control";
  }
}

struct Errors {
  double energy = 0.0;
  double slope = 0.0;
};

/// The largest over positions of the cell, of a map on a square lattice.
Errors errors_of(const Surface& d) {
  constexpr double kStep = 1e-5;  // of central differences, whose error is 1e-8
  Errors largest;
  const auto p = parameters_of<LatticeOfMap, 2>(d);
  for (const std::uint64_t seed : kSeeds) {
    Random random(seed);
    for (int k = 0; k < kRandomPoints; ++k) {
      const double u = uniform(random, 0.0, 1.0);
      const double v = uniform(random, 0.0, 1.0);
      const auto site = site_at(d, Vec<double, 2>{{u, v}});
      const double expected = (sampled(u + kStep, v) - sampled(u - kStep, v)) / (2.0 * kStep);
      largest.energy =
          std::max(largest.energy, std::abs(LatticeOfMap::energy(p, site) - sampled(u, v)));
      largest.slope = std::max(largest.slope, std::abs(LatticeOfMap::force(p, site)[0] + expected));
    }
  }
  return largest;
}

/// Fourth order in the energy, third in the force; and the map estimates its error from its own
/// values.
TEST(EnergyMap, ErrorsFallWithTheSpacingAndAreEstimated) {
  Errors before;
  for (const std::size_t points : {32U, 64U, 128U}) {
    const Surface d = surface_of(grid_of(points, points), SurfaceLattice::square);
    const Errors found = errors_of(d);
    const PeriodicSpline::Error estimated = d.map->error();
    // 900 random positions hit neither maximum exactly; of several waves the estimated one is at
    // grid positions.
    EXPECT_GT(estimated.value, 0.8 * found.energy);
    EXPECT_LT(estimated.value, 1.25 * found.energy);
    EXPECT_GT(estimated.slope_u, 0.7 * found.slope);
    EXPECT_LT(estimated.slope_u, 1.4 * found.slope);
    if (before.energy > 0.0) {
      EXPECT_NEAR(std::log2(before.energy / found.energy), 4.0, 0.3);
      EXPECT_NEAR(std::log2(before.slope / found.slope), 3.0, 0.3);
    }
    before = found;
  }
}

/// Against derivatives by dual numbers: in all dimensions, with and without height.
template <class E, int D>
double largest_error_of_gradient(const Surface& d, Random& random) {
  const auto p = parameters_of<E, D>(d);
  double largest = 0.0;
  for (int k = 0; k < kRandomPoints; ++k) {
    Vec<double, D> position;
    for (int axis = 0; axis < D; ++axis) position[axis] = uniform(random, -2.0, 2.0);
    const auto site = site_at(d, position);
    const auto energy = E::energy(in_type<E, Dual<double, D>, double, D>(p), differentiable(site));
    const auto force = E::force(p, site);
    for (int axis = 0; axis < D; ++axis) {
      largest = std::max(largest, std::abs(force[axis] + energy.derivative[axis]));
    }
  }
  return largest;
}

TEST(EnergyMap, ForcesAreTheGradient) {
  constexpr double kRoundingOfForces =
      1e-12;  // of sums of 16 products, times 20 rows, times exp(4)
  Random random(5);
  Surface plane = surface_of(grid_of(20, 12), SurfaceLattice::hexagonal, 0.4);
  plane.energy_scale = -1.7;
  Surface line = surface_of(grid_of(20, 1), SurfaceLattice::line);
  const auto at_height = [](Surface d) {
    d.decay.numbers = {1.1};
    d.repulsion = 0.3;
    d.repulsion_decay = 1.6;
    return d;
  };
  const double errors[] = {
      largest_error_of_gradient<LatticeOfMap, 1>(line, random),
      largest_error_of_gradient<LatticeOfMap, 2>(line, random),
      largest_error_of_gradient<LatticeOfMap, 2>(plane, random),
      largest_error_of_gradient<LatticeOfMap, 3>(plane, random),
      largest_error_of_gradient<LatticeOfMapAtHeight, 2>(at_height(line), random),
      largest_error_of_gradient<LatticeOfMapAtHeight, 3>(at_height(line), random),
      largest_error_of_gradient<LatticeOfMapAtHeight, 3>(at_height(plane), random)};
  for (const double error : errors) {
    EXPECT_LT(error, kRoundingOfForces);
    EXPECT_GT(error, 0.0) << "the two ways have different roundings";
  }
}

/// The second derivatives on both sides of the lines of the grid are the same; the third, in one of
/// which a spline jumps, are not.
TEST(EnergyMap, SecondDerivativesAreContinuous) {
  using Once = Dual<double, 2>;
  using Twice = Dual<Once, 2>;
  const Surface d = surface_of(grid_of(9, 7), SurfaceLattice::square);
  const auto p = parameters_of<LatticeOfMap, 2, Twice>(d);
  const auto curvature = [&](double u, double v) {
    Site<Twice, 2> site{};
    site.position = {
        {Twice::variable(Once::variable(u, 0), 0), Twice::variable(Once::variable(v, 1), 1)}};
    site.table = d.map->table();
    const Twice energy = LatticeOfMap::energy(p, site);
    return std::array{energy.derivative[0].derivative[0], energy.derivative[1].derivative[1],
                      energy.derivative[0].derivative[1]};
  };
  constexpr double kAside = 1e-7;
  double jump_of_third = 0.0;
  for (int m = 0; m <= 9; ++m) {
    const double u = m / 9.0;
    const auto left = curvature(u - kAside, 0.3);
    const auto right = curvature(u + kAside, 0.3);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(left[k], right[k], 2.0 * kAside * 1e3);  // third derivatives are below (2 pi)^3
    }
    const auto slope = [&](double from) {
      return (curvature(from + kAside, 0.3)[0] - curvature(from, 0.3)[0]) / kAside;
    };
    jump_of_third = std::max(jump_of_third, std::abs(slope(u + kAside) - slope(u - 2.0 * kAside)));
  }
  EXPECT_GT(jump_of_third, 1.0) << "negative control";
}

/// The bound on the curvature holds and is of the curvature's size, also if all curvature is along
/// a diagonal.
TEST(EnergyMap, CurvatureIsBounded) {
  using Slope = Dual<double, 2>;
  NumberTable diagonal{24, {}};
  for (int k = 0; k < 24 * 24; ++k) {
    diagonal.numbers.push_back(std::cos(kTau * (k / 24 + k % 24) / 24.0));
  }
  const Surface surfaces[] = {surface_of(grid_of(24, 24)),
                              surface_of(grid_of(24, 24), SurfaceLattice::hexagonal, 0.7),
                              surface_of(diagonal, SurfaceLattice::square)};
  for (const Surface& d : surfaces) {
    const auto p = parameters_of<LatticeOfMap, 2, Slope>(d);
    double along[2] = {};
    double any = 0.0;
    Random random(3);
    for (int k = 0; k < 4000; ++k) {
      Site<double, 2> plain =
          site_at(d, Vec<double, 2>{{uniform(random, 0.0, 2.0), uniform(random, 0.0, 2.0)}});
      const auto force = LatticeOfMap::force(p, differentiable(plain));
      const double xx = -force[0].derivative[0];
      const double yy = -force[1].derivative[1];
      const double xy = -force[0].derivative[1];
      along[0] = std::max(along[0], std::abs(xx));
      along[1] = std::max(along[1], std::abs(yy));
      any = std::max(any, 0.5 * std::abs(xx + yy) + std::hypot(0.5 * (xx - yy), xy));
    }
    const auto bound = lattice_curvatures(d);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      EXPECT_GE(bound[axis], along[axis]);
      EXPECT_LE(bound[axis], 3.0 * along[axis]);
    }
    EXPECT_GE(bound[2], any);
    EXPECT_LE(bound[2], 3.0 * any);
  }
}

/// An origin that moves by whole cells changes no bit, and what is no number stays that.
TEST(EnergyMap, WholeCellsChangeNoBit) {
  const Surface d = surface_of(grid_of(16, 16), SurfaceLattice::hexagonal);
  const auto at = [&](std::int64_t nx, std::int64_t ny, double x) {
    Origin origin;
    origin.unit = {lattice_period(d, 0), lattice_period(d, 1), 0.0};
    origin.cells = {nx, ny, 0};
    return LatticeOfMap::force(parameters_of<LatticeOfMap, 2>(d, origin),
                               site_at(d, Vec<double, 2>{{x, 0.2}}))[0];
  };
  for (const std::int64_t far : {1LL, -7LL, 1000000000000LL}) {
    EXPECT_EQ(at(far, -3 * far, 0.3), at(0, 0, 0.3));
  }
  EXPECT_NE(at(0, 0, 0.4), at(0, 0, 0.3)) << "negative control";
  for (const double x :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(std::isnan(at(0, 0, x)));
  }
}

// ---- scenes -------------------------------------------------------------------------------------

std::string rows_of(const NumberTable& grid, const char* open, const char* close,
                    const char* between) {
  std::string text;
  for (std::size_t m = 0; m < grid.rows(); ++m) {
    text += open;
    for (std::size_t n = 0; n < grid.columns; ++n) {
      text += (n == 0 ? "" : between) + digits(grid.numbers[m * grid.columns + n]);
    }
    text += close;
  }
  return text;
}

std::string inline_map(const NumberTable& grid) {
  return "energies = [" + rows_of(grid, "[", "], ", ", ") + "]\n";
}

std::string tip_on(const std::string& keys, const std::string& position = "0.3, 0.1",
                   const std::string& more = "") {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [" + position +
         "]\nparticle_mass = 1.0\n[[force]]\nname = \"surface\"\ntype = \"lattice_substrate\"\n" +
         keys + more + "[run]\nduration = 20.0\nledger = true\nintegrator = " + fixed_step(1e-2) +
         "\n";
}

/// The first star of a hexagonal surface on a grid is that surface, to the estimated error.
TEST(EnergyMap, InASceneItIsTheSurfaceThatItWasTakenFrom) {
  constexpr std::size_t kPoints = 64;
  NumberTable grid{kPoints, {}};
  for (std::size_t m = 0; m < kPoints; ++m) {
    for (std::size_t n = 0; n < kPoints; ++n) {
      const double p = kTau * static_cast<double>(m) / kPoints;
      const double q = kTau * static_cast<double>(n) / kPoints;
      grid.numbers.push_back(std::cos(p) + std::cos(q) + std::cos(p + q));
    }
  }
  const std::string pulled = tables(R"([[force]] | name = "driver" | type = "driving_spring"
stiffness = 2.0 | velocity = [1.0, 0.3]
[[force]] | type = "viscous_damping" | coefficient = 1.0
)");
  const std::string lattice = "lattice = \"hexagonal\"\nperiod = 1.0\nmisfit = 0.2\n";
  const RunResult map =
      run_text(tip_on(lattice + inline_map(grid) + "energy_scale = 0.1\n", "0.3, 0.1", pulled));
  const RunResult waves = run_text(tip_on(lattice + "amplitude = 0.1\n", "0.3, 0.1", pulled));
  constexpr double kErrorOfForces = 2e-5;  // estimated: 0.1 times 4e-5
  for (const char* path :
       {"tip.centre_of_mass.x", "tip.centre_of_mass.y", "driver.mean_force.x", "driver.work"}) {
    EXPECT_NEAR(observable(map, path).value(), observable(waves, path).value(), kErrorOfForces)
        << path;
    EXPECT_NE(observable(map, path).value(), observable(waves, path).value()) << path;
  }
  EXPECT_NEAR(map.group("energy")["numerical_work"].value(), 0.0, 1e-5);
}

TEST(EnergyMap, AFileIsTheSameAsAListAndStandsInTheEffectiveScene) {
  const TemporaryFolder folder;
  const NumberTable grid = grid_of(6, 5);
  write(folder / "map.dat", "# rows along a1\n" + rows_of(grid, "", "\n", " "));
  const std::string lattice = "lattice = \"square\"\nperiod = 1.0\n";
  write(folder / "s.toml", tip_on(lattice + "energy_map = \"map.dat\"\n"));
  const auto from_file = read_scene((folder / "s.toml").string(), standard());
  const auto listed = scene_of(tip_on(lattice + inline_map(grid)));
  EXPECT_EQ(from_file->effective_toml, listed->effective_toml);
  EXPECT_EQ(scene_of(from_file->effective_toml)->effective_toml, from_file->effective_toml);
  EXPECT_NE(from_file->effective_toml.find("energies = [[0.3"), std::string::npos);
}

std::string refused(const std::string& keys, const std::string& position = "0.3, 0.1") {
  try {
    scene_of(tip_on(keys, position));
  } catch (const InputError& error) {
    return fmt::format("{}", fmt::join(briefs(error), "\n"));
  }
  return "";
}

TEST(EnergyMap, WhatDoesNotFitIsRefused) {
  const std::string lattice = "lattice = \"square\"\nperiod = 1.0\n";
  const std::string map = inline_map(grid_of(4, 4));
  EXPECT_EQ(refused(lattice + map), "");
  const auto has = [&](const std::string& keys, const std::string& fault,
                       const std::string& position = "0.3, 0.1") {
    EXPECT_NE(refused(keys, position).find(fault), std::string::npos)
        << keys << refused(keys, position);
  };
  has(lattice + map + "amplitude = 1.0\n", "surface.amplitude = 1.0 [scene.conflict]");
  has(lattice + map + "harmonics = [[1, 0]]\n", "surface.harmonics = [[1, 0]] [scene.conflict]");
  has(lattice + map + "energy_map = \"no.dat\"\n", "energy_map = \"no.dat\" [scene.conflict]");
  has(lattice + "energy_map = \"no.dat\"\n", "energy_map = \"no.dat\" [file.cannot_read]");
  has(lattice + "energies = [[1, 2, 3, 4], [1, 2, 3]]\n", "[1, 2, 3] [scene.wrong_count]");
  has(lattice + "energies = [[1, 2], [3, 4]]\n", "[scene.wrong_count]");
  has(lattice + "energies = [1, 2, 3, 4]\n", "[scene.wrong_count]");
  has(lattice + "energies = []\n", "surface.energies = [] [scene.wrong_count]");
  has("lattice = \"line\"\nperiod = 1.0\n" + map, "[scene.wrong_count]", "0.3");
  has("lattice = \"hexagonal\"\nperiod = 1.0\n" + map + "decay = [1.0, 2.0]\n",
      "decay = [1.0, 2.0] [scene.wrong_count]", "0, 0, 1");
  EXPECT_EQ(refused("lattice = \"line\"\nperiod = 1.0\nenergies = [0.0, 0.1, 0.0, -0.1]\n", "0.3"),
            "");
}

}  // namespace
}  // namespace tomlin::test
