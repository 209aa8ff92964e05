#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/constant_force.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "tests/forcefields/only_energy.hpp"
#include "tests/support/random_description.hpp"
#include "tests/support/scenes.hpp"

// Forces written by hand against the exact derivative of their energy.

namespace tomlin::test {
namespace {

// Energy and force are rounded differently: some units in the last place of their size.
constexpr double kDualRounding = 64.0 * std::numeric_limits<double>::epsilon();

template <int D>
Site<double, D> site_at(const std::array<double, 3>& x, Random& random) {
  Site<double, D> site{};
  for (int d = 0; d < D; ++d) {
    site.position[d] = x[d];
    site.velocity[d] = uniform(random, -1.0, 1.0);
    site.start[d] = uniform(random, -1.0, 1.0);
  }
  site.elapsed = 0.25;
  return site;
}

template <class E, int D>
void expect_site_force_is_gradient(const ForceRecord& record) {
  Random random(31);
  // Random points, quarter periods of a corrugation, and far from everything.
  std::vector<std::array<double, 3>> points;
  for (int k = 0; k < 200; ++k) {
    points.push_back({uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)});
  }
  for (const double x : {0.0, -0.0, 0.25, 0.5, 1e-300, 1e6, -1e9}) {
    for (const double y : {0.0, 1e-200, 5.0, 30.0, -1e4}) points.push_back({x, y, 0.0});
  }
  for (int draw = 0; draw < 20; ++draw) {
    const auto description = random_description(record, {.dimension = D, .count = 3}, random);
    ASSERT_NE(description, nullptr);
    const auto p = E::template parameters<double, D>(
        *static_cast<const typename E::Description*>(description.get()));
    for (const auto& point : points) {
      const Site<double, D> site = site_at<D>(point, random);
      const auto force = E::force(p, site);
      const auto exact = force_on<OnlyEnergyOnSites<E>, double, D>(p, site);
      double size = 0.0;
      for (int d = 0; d < D; ++d) size = std::max(size, std::abs(exact[d]));
      for (int d = 0; d < D; ++d) {
        EXPECT_TRUE(std::isfinite(force[d]));
        EXPECT_NEAR(force[d], exact[d], kDualRounding * (size + 1e-300))
            << record.name << " at " << point[0] << ", " << point[1];
      }
    }
  }
}

template <class E>
void expect_site_force_is_gradient() {
  std::string name;
  for (const auto& record : standard().forces()) {
    if (record->make_description == &make_description<typename E::Description>) {
      expect_site_force_is_gradient<E, 1>(*record);
      expect_site_force_is_gradient<E, 2>(*record);
      expect_site_force_is_gradient<E, 3>(*record);
      return;
    }
  }
  FAIL() << "not in the registry";
}

/// A relative error of 1e-5, far below what a plot shows.
struct SlightlyTooStrong : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1.0 + 1e-5) * SinusoidalSubstrate::force(p, site);
  }
};

TEST(Evaluators, AForceOffByLittleIsSeen) {
  // Central differences at h = 0.0025 see 1e-3; the exact derivative sees the last digits.
  const auto p = SinusoidalSubstrate::parameters<double, 2>({1.0, 1.0, 0.5});
  Site<double, 2> site{};
  site.position = {0.3, 0.4};
  const auto right = force_on<OnlyEnergyOnSites<SinusoidalSubstrate>, double, 2>(p, site);
  EXPECT_GT(std::abs(SlightlyTooStrong::force(p, site)[0] - right[0]),
            kDualRounding * std::abs(right[0]));
}

TEST(Evaluators, ForcesAreTheExactDerivativeOfTheEnergy) {
  expect_site_force_is_gradient<ConstantForce>();
  expect_site_force_is_gradient<DrivingSpring>();
  expect_site_force_is_gradient<SinusoidalSubstrate>();
}

template <class E>
struct OnlyEnergyOnPairs {
  using Description = typename E::Description;
  template <class T, int D>
  using Parameters = typename E::template Parameters<T, D>;
  template <class T, int D>
  static auto energy(const typename E::template Parameters<T, D>& p, const Pair<T, D>& pair) {
    return E::energy(p, pair);
  }
};

template <int D>
void expect_bond_is_gradient() {
  Random random(32);
  HarmonicBondsDescription description;
  description.stiffness = 3.7;
  const auto p = HarmonicBonds::parameters<double, D>(description);
  for (const double size : {1e-8, 1e-3, 1.0, 1e8}) {
    for (int k = 0; k < 100; ++k) {
      Pair<double, D> pair{};
      for (int d = 0; d < D; ++d) pair.separation[d] = size * uniform(random, -1.0, 1.0);
      pair.datum = k % 4 == 0 ? 0.0 : uniform(random, 0.0, 2.0);
      const auto force = HarmonicBonds::force(p, pair);
      const auto exact = force_on<OnlyEnergyOnPairs<HarmonicBonds>, double, D>(p, pair);
      const double scale = description.stiffness * (distance(pair.separation) + pair.datum);
      for (int d = 0; d < D; ++d) EXPECT_NEAR(force[d], exact[d], kDualRounding * scale);
    }
  }
}

TEST(Evaluators, BondsAreTheExactDerivativeOfTheEnergy) {
  expect_bond_is_gradient<1>();
  expect_bond_is_gradient<2>();
  expect_bond_is_gradient<3>();
}

}  // namespace
}  // namespace tomlin::test
