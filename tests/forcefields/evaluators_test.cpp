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
#include "forcefields/morse_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "framework/core/elements/site_force.hpp"
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
    const auto& d = *static_cast<const typename E::Description*>(description.get());
    const auto p = E::template parameters<double, D>(d);
    for (const auto& point : points) {
      Site<double, D> site = site_at<D>(point, random);
      site.frame = frame_at<E, double, D>(d, {.cells = {7, -3, 1}, .unit = {1.25, 0.5, 2.0}});
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
  const SinusoidalSubstrateDescription d{1.0, 1.0, 0.5};
  const auto p = SinusoidalSubstrate::parameters<double, 2>(d);
  Site<double, 2> site{};
  site.frame = frame_at<SinusoidalSubstrate, double, 2>(d, {});
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

/// `stiffness` is the largest in the range of separations: forces are sums of numbers of the size
/// of stiffness times length.
template <class E, int D>
void expect_bond_is_gradient(const typename E::Description& description, double stiffness) {
  Random random(32);
  const auto p = E::template parameters<double, D>(description);
  for (const double size : {1e-8, 1e-3, 1.0, 1e8}) {
    for (int k = 0; k < 100; ++k) {
      Pair<double, D> pair{};
      for (int d = 0; d < D; ++d) pair.separation[d] = size * uniform(random, -1.0, 1.0);
      pair.datum = k % 4 == 0 ? 0.0 : uniform(random, 0.0, 2.0);
      const auto force = E::force(p, pair);
      const auto exact = force_on<OnlyEnergyOnPairs<E>, double, D>(p, pair);
      const double scale = stiffness * (distance(pair.separation) + pair.datum);
      for (int d = 0; d < D; ++d) EXPECT_NEAR(force[d], exact[d], kDualRounding * scale);
    }
  }
}

/// Near its minimum a Morse bond is a spring of stiffness 2 D a^2; far away it does not pull.
TEST(Evaluators, AMorseBondIsASpringThatBreaks) {
  MorseBondsDescription description;
  description.depth = 1.3;
  description.inverse_width = 0.9;
  const auto p = MorseBonds::parameters<double, 1>(description);
  const auto at = [&](double r) { return Pair<double, 1>{{{r}}, 1.5}; };
  constexpr double kSmall = 1e-4;  // anharmonic by 3/2 a kSmall
  EXPECT_NEAR(MorseBonds::force(p, at(1.5 + kSmall))[0] / (2.0 * 1.3 * 0.81 * kSmall), 1.0, 2e-4);
  EXPECT_EQ(MorseBonds::force(p, at(1.5))[0], 0.0);
  EXPECT_NEAR(MorseBonds::energy(p, at(60.0)), 1.3, 1e-15);
  EXPECT_LT(MorseBonds::force(p, at(60.0))[0], 1e-20);
  EXPECT_LT(MorseBonds::force(p, at(1.0))[0], 0.0) << "pushes when compressed";
}

TEST(Evaluators, BondsAreTheExactDerivativeOfTheEnergy) {
  HarmonicBondsDescription harmonic;
  harmonic.stiffness = 3.7;
  expect_bond_is_gradient<HarmonicBonds, 1>(harmonic, 3.7);
  expect_bond_is_gradient<HarmonicBonds, 2>(harmonic, 3.7);
  expect_bond_is_gradient<HarmonicBonds, 3>(harmonic, 3.7);
  MorseBondsDescription morse;
  morse.depth = 1.3;
  morse.inverse_width = 0.9;
  // Compressed by two at most: 2 D a^2 (2 exp(2 * 2 a) - exp(2 a)).
  const double steepest = 2.0 * 1.3 * 0.9 * 0.9 * 2.0 * std::exp(3.6);
  expect_bond_is_gradient<MorseBonds, 1>(morse, steepest);
  expect_bond_is_gradient<MorseBonds, 2>(morse, steepest);
  expect_bond_is_gradient<MorseBonds, 3>(morse, steepest);
}

}  // namespace
}  // namespace tomlin::test
