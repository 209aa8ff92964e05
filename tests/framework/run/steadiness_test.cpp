#include "framework/run/window/steadiness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>

#include <gtest/gtest.h>

namespace tomlin {
namespace {

constexpr double kMost = 6000.0;  ///< periods that there are

struct Found {
  double periods = 0.0;  ///< 0: not found to be steady
  double value = 0.0;
};

/// When a series is found to be steady to a tolerance relative to its value.
Found steady_at(const std::function<double(double)>& value, double tolerance,
                double slowest = 0.0) {
  std::array<double, Steadiness::kNumbers> numbers{};
  Steadiness steadiness;
  steadiness.attach(numbers.data());
  for (double n = 1.0; n <= kMost; n += 1.0) {
    const double now = value(n);
    steadiness.add(now);
    const auto distance = steadiness.distance(slowest, kMost - n);
    if (distance && *distance <= tolerance * std::abs(now)) return {n, now};
  }
  return {};
}

/// A fast and a slow transient of random amplitudes and signs decay to 1, which turns the value
/// round in every other case: never found too early, nor much later than all values stay within the
/// tolerance and the slow time has passed twice.
TEST(Steadiness, IsFoundWhereTransientsHaveDecayed) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> amplitude(-0.5, 0.5);
  std::uniform_real_distribution<double> logarithm(0.0, 1.0);
  constexpr double kTolerance = 1e-2;
  constexpr double kToATenth = 1.1;  // an estimate
  constexpr double kLate = 2.0;      // an eighth of all periods, and one more window
  constexpr double kAtOnce = 8.0;
  int early = 0;
  for (int k = 0; k < 1000; ++k) {
    const double fast = std::pow(10.0, logarithm(random));
    const double slow = std::pow(10.0, 1.0 + 1.5 * logarithm(random));
    const double a = amplitude(random);
    const double b = amplitude(random);
    const auto value = [=](double n) {
      return 1.0 + a * std::exp(-n / fast) + b * std::exp(-n / slow);
    };
    const Found found = steady_at(value, kTolerance, slow);
    ASSERT_GT(found.periods, 0.0);
    EXPECT_LE(std::abs(found.value - 1.0), kToATenth * kTolerance)
        << fast << ' ' << slow << ' ' << a << ' ' << b;
    double last = 0.0;
    for (double n = 1.0; n <= kMost; n += 1.0) {
      if (std::abs(value(n) - 1.0) > kTolerance) last = n;
    }
    const double needed = std::max(last, Steadiness::kTimesSlowest * slow);
    EXPECT_LE(found.periods, kAtOnce + kLate * needed);
    // The control: without the slow time the turn is taken for the end.
    if (std::abs(steady_at(value, kTolerance).value - 1.0) > 2.0 * kTolerance) ++early;
  }
  EXPECT_GT(early, 100);
}

/// Changes that do not shrink are no steady state, however small each is; the rule that took two
/// small changes in a row for one (the control) ends here after three periods.
TEST(Steadiness, ADriftIsNone) {
  constexpr double kTolerance = 1e-2;
  const auto drifts = [](double n) { return 1.0 + 1e-3 * n; };
  EXPECT_LT(std::abs(drifts(2.0) - drifts(1.0)), kTolerance);
  EXPECT_EQ(steady_at(drifts, kTolerance).periods, 0.0);
}

/// A memory of 200 periods, at each of which a part of 0.005 of the rest is made up for.
TEST(Steadiness, ASlowApproachIsWaitedFor) {
  constexpr double kSlow = 200.0;
  const auto value = [](double n) { return 0.6 - 0.3 * std::exp(-n / kSlow); };
  for (const double tolerance : {1e-1, 1e-2, 1e-4}) {
    const double needed = kSlow * std::log(0.5 / tolerance);
    for (const double known : {0.0, kSlow}) {
      const Found found = steady_at(value, tolerance, known);
      EXPECT_GE(found.periods, 0.9 * needed);
      EXPECT_LE(found.periods, 2.0 * needed);
    }
  }
}

TEST(Steadiness, WhatAlternatesIsSteadyToItsRangeOnly) {
  const auto value = [](double n) { return 1.0 + 0.01 * std::cos(3.14159265358979 * n); };
  EXPECT_EQ(steady_at(value, 1e-2).periods, 0.0);
  EXPECT_GT(steady_at(value, 3e-2).periods, 0.0);
  EXPECT_LT(steady_at(value, 3e-2).periods, 20.0);
}

/// Rounding and tolerances of steps leave noise, which is no drift.
TEST(Steadiness, NoiseDelaysLittle) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> noise(-1e-5, 1e-5);
  const Found found = steady_at([&](double) { return 1.0 + noise(random); }, 1e-2);
  EXPECT_EQ(found.periods, 4.0);
  const Found fine = steady_at([&](double) { return 1.0 + noise(random); }, 1e-4);
  EXPECT_GT(fine.periods, 0.0);
  EXPECT_LT(fine.periods, 300.0);
}

/// The slowest motion known of the scene must have had its time, whatever is seen before.
TEST(Steadiness, WaitsForTheSlowestTimeThatIsKnown) {
  const auto value = [](double n) {
    return n < 90.0 ? 1.0 : 1.0 + 0.2 * (1.0 - std::exp((90.0 - n) / 20.0));
  };
  EXPECT_LT(steady_at(value, 1e-3, 0.0).periods, 10.0);  // the control
  EXPECT_NEAR(steady_at(value, 1e-3, 100.0).value, 1.2, 1.2e-3);
}

}  // namespace
}  // namespace tomlin
