#include "framework/run/window/blocking.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/normal_numbers.hpp"
#include "tests/support/scenes.hpp"

// Standard errors of means of correlated series: intervals of one standard error hold the truth in
// 68 of 100 series, of series whose exact error is known, and of runs.

namespace tomlin::test {
namespace {

constexpr int kSeries = 400;
/// The share of 400 series whose intervals hold the truth with probability 0.68 has a standard
/// deviation of 2.3 in 100.
constexpr double kFewestHeld = 0.63;
constexpr double kMostHeld = 0.73;

std::vector<double> white_noise(std::uint64_t stream, std::size_t count) {
  const std::size_t length = (count + 2 * kGroup - 1) / (2 * kGroup) * 2 * kGroup;
  std::vector<double> numbers(length);
  fill_normals({99, stream}, {}, length, kGroup, numbers.data());
  numbers.resize(count);
  return numbers;
}

/// x' = f x + sqrt(1 - f^2) z, of variance 1 and mean 0.
struct CorrelatedSeries {
  double correlation_time = 0.0;

  double kept() const { return correlation_time > 0.0 ? std::exp(-1.0 / correlation_time) : 0.0; }
  std::vector<double> draw(std::uint64_t stream, std::size_t count) const {
    std::vector<double> series = white_noise(stream, count);
    const double f = kept();
    const double rest = std::sqrt(1.0 - f * f);
    for (std::size_t k = 1; k < count; ++k) series[k] = f * series[k - 1] + rest * series[k];
    return series;
  }
  double exact_error(std::size_t count) const {
    const double f = kept();
    const auto n = static_cast<double>(count);
    return std::sqrt(
        ((1.0 + f) / (1.0 - f) - 2.0 * f * (1.0 - std::pow(f, n)) / (n * (1.0 - f) * (1.0 - f))) /
        n);
  }
};

struct Coverage {
  int stated = 0;
  int held = 0;
  double squares = 0.0;  ///< of stated errors

  void add(double off, const std::optional<double>& error) {
    if (!error) return;
    ++stated;
    held += std::abs(off) <= *error ? 1 : 0;
    squares += *error * *error;
  }
  double share() const { return static_cast<double>(held) / stated; }
  double error() const { return std::sqrt(squares / stated); }
};

double mean_of(const std::vector<double>& series) {
  double sum = 0.0;
  for (const double x : series) sum += x;
  return sum / static_cast<double>(series.size());
}

Coverage coverage(const CorrelatedSeries& of, std::size_t count) {
  Coverage all;
  for (int k = 0; k < kSeries; ++k) {
    const std::vector<double> series = of.draw(static_cast<std::uint64_t>(k), count);
    all.add(mean_of(series), blocked_mean(series).error);
  }
  return all;
}

TEST(Blocking, IntervalsHoldTheTruthOfWhiteNoise) {
  for (const std::size_t count : {200U, 1000U, 1024U, 5000U}) {
    const Coverage found = coverage({}, count);
    EXPECT_EQ(found.stated, kSeries) << count;
    EXPECT_GE(found.share(), kFewestHeld) << count;
    EXPECT_LE(found.share(), kMostHeld) << count;
  }
}

TEST(Blocking, IntervalsHoldTheTruthOfACorrelatedSeries) {
  // Allows for the remaining correlation of neighbouring blocks, and for the scatter of the mean
  // square over series (below 2 in 100).
  constexpr double kErrorOfErrors = 0.06;
  const CorrelatedSeries series{20.0};
  for (const std::size_t count : {8000U, 16000U}) {
    const Coverage found = coverage(series, count);
    EXPECT_GE(found.stated, kSeries - 2) << count;
    EXPECT_GE(found.share(), kFewestHeld) << count;
    EXPECT_LE(found.share(), kMostHeld) << count;
    EXPECT_NEAR(found.error() / series.exact_error(count), 1.0, kErrorOfErrors) << count;
  }
}

/// Its sum is correlated over 40 numbers: 100 times as many are enough, with a few wide blocks.
TEST(Blocking, AHundredCorrelationTimesAreEnough) {
  const Coverage found = coverage({20.0}, 4000);
  EXPECT_GE(found.stated, 0.98 * kSeries);
  EXPECT_GE(found.share(), kFewestHeld - 0.03);
  EXPECT_LE(found.share(), kMostHeld);
  EXPECT_NEAR(found.error() / CorrelatedSeries{20.0}.exact_error(4000), 1.0, 0.1);
}

/// Errors computed as for independent numbers are six times too small.
TEST(Blocking, ErrorsWithoutBlocksWouldBeSeen) {
  const CorrelatedSeries series{20.0};
  Coverage found;
  for (int k = 0; k < kSeries; ++k) {
    const std::vector<double> one = series.draw(static_cast<std::uint64_t>(k), 16000);
    found.add(mean_of(one), 1.0 / std::sqrt(16000.0));
  }
  EXPECT_LT(found.share(), 0.2);
}

TEST(Blocking, NothingIsSaidOfShortSeries) {
  EXPECT_FALSE(blocked_mean({}).error);
  EXPECT_FALSE(blocked_mean(std::vector<double>{1.0}).error);
  EXPECT_FALSE(blocked_mean(white_noise(1, 49)).error);
  // 10 and 20 times the 40 numbers that its sum is correlated over; chance shortens them.
  EXPECT_LE(coverage({20.0}, 400).stated, 0.02 * kSeries);
  EXPECT_LE(coverage({20.0}, 800).stated, 0.1 * kSeries);
}

TEST(Blocking, AConstantHasNoError) {
  EXPECT_EQ(blocked_mean(std::vector<double>(100, 0.3)).error, 0.0);
}

// ---- through runs

/// A particle in the trap of its driver: the mean force is that of friction.
std::string trapped(std::uint64_t stream, double duration) {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.0]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [0.2]
[[force]] | name = "bath" | type = "langevin" | coefficient = 1.0 | temperature = 0.5
[run] | seed = 1 | stream = )") +
         std::to_string(stream) + "\nduration = " + digits(duration) +
         "\nintegrator = { type = \"baoab\", dt = 0.1 }\n[measure]\nin = \"time\"\nfrom = 20.0\n" +
         "to = " + digits(duration) + "\n";
}

TEST(Blocking, ErrorsOfMeansOverARun) {
  // c v by h gamma/2 coth(h gamma/2), as baoab drags.
  const double damped = 0.1;
  const double exact = 0.2 * std::tanh(0.5 * damped) / (0.5 * damped);
  Coverage found;
  double squares = 0.0;
  for (std::uint64_t stream = 0; stream < kSeries; ++stream) {
    const RunResult result = run_text(trapped(stream, 1000.0));
    const double off = result.driver(0)["mean_force"][0] - exact;
    squares += off * off;
    found.add(off, stated_error(result, "drivers.driver.mean_force.x"));
  }
  const double scatter = std::sqrt(squares / kSeries);
  // The scatter of 400 has a standard deviation of 1 in 28; four of them, and the bias of blocks.
  constexpr double kOfScatter = 0.2;
  EXPECT_EQ(found.stated, kSeries);
  EXPECT_NEAR(found.error() / scatter, 1.0, kOfScatter);
  EXPECT_GE(found.share(), kFewestHeld);
  EXPECT_LE(found.share(), kMostHeld);
}

/// Too few correlation times: no error, and a warning.
TEST(Blocking, AShortRunStatesNoError) {
  const RunResult result = run_text(trapped(0, 60.0));
  EXPECT_FALSE(stated_error(result, "drivers.driver.mean_force.x"));
  EXPECT_EQ(count_of(FaultCode::run_error_not_estimated, result.warnings), 1U);
  const auto warning = std::find_if(
      result.warnings.begin(), result.warnings.end(),
      [](const Warning& one) { return one.code == FaultCode::run_error_not_estimated; });
  ASSERT_NE(warning, result.warnings.end());
  EXPECT_NE(warning->text.find(" times as long is the least"), std::string::npos) << warning->text;
}

TEST(Blocking, WithoutNoiseThereIsNoStatisticalError) {
  const RunResult result = run_text(trapped(0, 60.0), {{"force.bath.temperature", "0.0"}});
  EXPECT_TRUE(result.errors.empty());
  EXPECT_EQ(count_of(FaultCode::run_error_not_estimated, result.warnings), 0U);
}

/// A series that swings back, y_k = z_k - z_k-1, has the mean (z_n - z_0)/n, of error sqrt(2)/n.
/// Blocks that are long enough by their correlation alone, of eight, have sqrt(n/8) = 11 times
/// that; blocks of which there are 16 have four times.
TEST(Blocking, WhatSwingsBackHasASmallerError) {
  constexpr std::size_t kCount = 1024;
  constexpr std::uint64_t kStreams = 20;
  constexpr double kBetween = 8.0;
  const double exact = std::sqrt(2.0) / static_cast<double>(kCount);
  double sum = 0.0;
  for (std::uint64_t stream = 0; stream < kStreams; ++stream) {
    const std::vector<double> z = white_noise(stream, kCount + 1);
    std::vector<double> series(kCount);
    for (std::size_t k = 0; k < kCount; ++k) series[k] = z[k + 1] - z[k];
    const BlockedMean mean = blocked_mean(series);
    ASSERT_TRUE(mean.error) << stream;
    EXPECT_GT(*mean.error, exact) << stream;
    sum += *mean.error / exact;
  }
  EXPECT_LT(sum / static_cast<double>(kStreams), kBetween);
}

}  // namespace
}  // namespace tomlin::test
