#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/plain_chain.hpp"
#include "tests/scenarios/scenario_fixture.hpp"
#include "tests/scenarios/trace.hpp"

/// The Frenkel-Kontorova chain against closed forms, the standard map, and plain loops.
namespace tomlin::test {
namespace {

const std::string kFolder = "frenkel_kontorova/";

/// The substrate's largest force on one particle.
double largest_force(double K) { return K / (2.0 * kPi); }

double mean_velocity(const RunResult& result) { return result.body(0)["mean_velocity"].at(0); }

/// 2 pi over the period of a signal that starts at zero, from its last change of sign.
double angular_frequency(const std::vector<double>& time, const std::vector<double>& signal) {
  int changes = 0;
  double last = 0.0;
  for (std::size_t n = 1; n + 1 < signal.size(); ++n) {  // the first sample is the zero itself
    if ((signal[n] < 0.0) == (signal[n + 1] < 0.0)) continue;
    ++changes;
    last = time[n] + (time[n + 1] - time[n]) * signal[n] / (signal[n] - signal[n + 1]);
  }
  return kPi * changes / last;
}

TEST(FrenkelKontorova, PhononsOfTheCommensurateChain) {
  constexpr int kParticles = 8;
  constexpr double kTolerance = 1e-6;  // straight lines between samples: 1e-7; dopri5: 1e-9
  for (const double K : {0.2, 1.0, 3.0}) {
    for (int n = 0; n <= kParticles / 2; ++n) {
      Trace trace;
      run_shipped(kFolder + "phonons.toml", {{"K", text_of(K)}, {"n", std::to_string(n)}}, &trace);
      const double half_wave = std::sin(kPi * n / kParticles);
      const double omega = std::sqrt(K + 4.0 * half_wave * half_wave);
      EXPECT_NEAR(angular_frequency(trace["time"], trace["probe.force.x"]) / omega, 1.0, kTolerance)
          << "K = " << K << ", n = " << n;
    }
  }
}

TEST(FrenkelKontorova, CommensurateChainMovesAsOneParticle) {
  const double F_c = largest_force(1.0);
  constexpr double kTolerance = 1e-7;  // 1e-11 per step, a thousand steps, slow at the bottleneck
  for (const double part : {1.001, 1.1, 3.0}) {
    const double F = part * F_c;
    const auto result = run_shipped(kFolder + "commensurate.toml", {{"F", text_of(F)}});
    EXPECT_NEAR(mean_velocity(result) / std::sqrt(F * F - F_c * F_c), 1.0, kTolerance)
        << "F/F_c = " << part;
  }
  const auto held = run_shipped(kFolder + "commensurate.toml", {{"F", text_of(0.999 * F_c)}});
  const double moved = held.body(0)["centre_of_mass"].at(0) - 3.5;
  EXPECT_GT(moved, 0.1);
  EXPECT_LT(moved, std::asin(0.999) / (2.0 * kPi));  // where the force balances, from below
}

struct Approximant {
  std::size_t particles;
  std::size_t periods;
};

std::vector<Setting> golden(const Approximant& chain, double K, double F) {
  return {{"N", std::to_string(chain.particles)},
          {"L", std::to_string(chain.periods)},
          {"K", text_of(K)},
          {"F", text_of(F)}};
}

const std::string kGoldenMean = kFolder + "golden_mean.toml";
constexpr double kSmallForce = 1e-5;
constexpr double kLong = 4000.0;  // for the plain chain to settle: the slowest rates are some 1e-2

TEST(FrenkelKontorova, GoldenMeanIsPinnedAboveAubrysTransition) {
  // These hold 6.9, 3.8 and 3.0 times the force.
  for (const Approximant chain : {Approximant{21, 13}, Approximant{34, 21}, Approximant{55, 34}}) {
    const auto result = run_shipped(kGoldenMean, golden(chain, 1.05, kSmallForce));
    // The approach to the pinned shape leaves this, at rates of some 1e-2 after 3000.
    EXPECT_LT(std::abs(mean_velocity(result)), 1e-6 * kSmallForce) << chain.particles;
  }
}

TEST(FrenkelKontorova, GoldenMeanSlidesBelowAubrysTransition) {
  constexpr double K = 0.9;
  constexpr double kTolerance = 1e-4;  // it holds 1e-8; what is left is of first order in F
  const Approximant chain = {55, 34};
  const double mobility = mean_mobility(K, chain.particles, static_cast<double>(chain.periods));
  for (const double F : {5e-6, kSmallForce}) {
    auto settings = golden(chain, K, F);
    // Six periods of its landscape.
    const double window = 6.0 / static_cast<double>(chain.particles) / (mobility * F);
    settings.push_back({"run.duration", text_of(3000.0 + window)});
    settings.push_back({"measure.to", text_of(3000.0 + window)});
    const auto result = run_shipped(kGoldenMean, settings);
    EXPECT_NEAR(mean_velocity(result) / (mobility * F), 1.0, kTolerance) << "F = " << F;
  }
  EXPECT_LT(mobility, 0.95);  // not just a free chain
}

TEST(FrenkelKontorova, PinnedShapeIsTheGroundState) {
  constexpr double K = 1.05;
  for (const Approximant chain : {Approximant{21, 13}, Approximant{55, 34}}) {
    PlainChain plain(K, chain.particles, static_cast<double>(chain.periods));
    plain.relax(kLong);
    const auto result = run_shipped(kGoldenMean, golden(chain, K, 0.0));
    ASSERT_NE(result.find("energy"), nullptr);
    const double deepest = -static_cast<double>(chain.particles) * K / (4.0 * kPi * kPi);
    // Both settle until rounding is all that is left: 1e-15 for each particle.
    EXPECT_NEAR(result.group("energy")["potential"].value() - deepest, plain.energy(), 1e-12)
        << chain.particles;
  }
}

TEST(FrenkelKontorova, GoldenMeanLetsGoAtTheForceOfItsLandscape) {
  struct Case {
    double K;
    Approximant chain;
    double margin;  ///< how near to the force sought; a tenth at K = 0.9, where all takes long
    double settle;
    double window;  ///< long enough for more than a period of the landscape, when sliding
  };
  for (const Case& at :
       {Case{1.05, {21, 13}, 0.02, 3000.0, 9000.0}, Case{1.05, {55, 34}, 0.02, 3000.0, 9000.0},
        Case{0.9, {21, 13}, 0.1, 20000.0, 60000.0}}) {
    const auto count = static_cast<double>(at.chain.particles);
    const double F_d =
        depinning_force(at.K, at.chain.particles, static_cast<double>(at.chain.periods));
    const auto moved = [&](double F) {  // in periods of the landscape
      auto settings = golden(at.chain, at.K, F);
      settings.push_back({"run.duration", text_of(at.settle + at.window)});
      settings.push_back({"measure.from", text_of(at.settle)});
      settings.push_back({"measure.to", text_of(at.settle + at.window)});
      return mean_velocity(run_shipped(kGoldenMean, settings)) * at.window * count;
    };
    EXPECT_LT(moved((1.0 - at.margin) * F_d), 0.1) << "K = " << at.K << ", N = " << count;
    EXPECT_GT(moved((1.0 + at.margin) * F_d), 1.0) << "K = " << at.K << ", N = " << count;
  }
}

TEST(FrenkelKontorova, KinkHasTheEnergyOfSineGordon) {
  for (const double K : {0.04, 0.08, 0.16}) {
    const auto result = run_shipped(kFolder + "kink.toml", {{"K", text_of(K)}});
    const double count = parameter_of(kFolder + "kink.toml", "N");
    ASSERT_NE(result.find("energy"), nullptr);
    const double energy =
        result.group("energy")["potential"].value() + count * K / (4.0 * kPi * kPi);
    const double continuum = 2.0 * std::sqrt(K) / (kPi * kPi);
    // The lattice takes K/72 off to first order; the next order is some K of that.
    EXPECT_NEAR((1.0 - energy / continuum) / (K / 72.0), 1.0, 0.03 + 0.1 * K) << "K = " << K;
  }
}

TEST(FrenkelKontorova, KinkDriftsAtTheSpeedOfItsDissipation) {
  // A force F moves a kink of energy E at F/E: F per site gained, E v^2 per time lost.
  const std::vector<double> strengths = {0.04, 0.08, 0.16};
  std::vector<double> short_by;
  for (const double K : strengths) {
    const auto result =
        run_shipped(kFolder + "kink.toml", {{"K", text_of(K)}, {"F", text_of(kSmallForce)}});
    const double speed = mean_velocity(result) * parameter_of(kFolder + "kink.toml", "N");
    const double continuum = kSmallForce * kPi * kPi / (2.0 * std::sqrt(K));
    short_by.push_back(1.0 - speed / continuum);
    EXPECT_LT(std::abs(short_by.back()), 0.05 * K) << "K = " << K;
  }
  EXPECT_NEAR(fitted_power(strengths, short_by), 1.0, 0.03);  // the lattice, to first order in K
}

const std::string kDriven = kFolder + "driven.toml";

TEST(FrenkelKontorova, StaticFrictionInStepIsThatOfEveryParticle) {
  for (const int count : {13, 55}) {
    const auto result = run_shipped(kDriven, {{"b", "1.0"}, {"N", std::to_string(count)}});
    const double each = *result.driver(0)["static_force"] / count;
    const double drag = 0.5 * 1e-3;  // xi v
    // To first order in v; what is next is some per cent of the drag.
    EXPECT_NEAR((each - largest_force(0.5)) / drag, 1.0, 0.1) << count;
  }
}

TEST(FrenkelKontorova, StaticFrictionAtTheGoldenMeanIsThatOfTheEnds) {
  const std::vector<Approximant> chains = {{34, 21}, {55, 34}, {144, 89}};
  std::vector<double> counts;
  std::vector<double> holds;
  for (const auto& [particles, periods] : chains) {
    const auto count = static_cast<double>(particles);
    const auto result = run_shipped(
        kDriven,
        {{"N", std::to_string(particles)}, {"b", text_of(static_cast<double>(periods) / count)}});
    counts.push_back(count);
    holds.push_back(result.driver(0)["max_force"].at(0) - count * 0.5 * 1e-3);
    EXPECT_LT(holds.back(), largest_force(0.5)) << particles;  // less than one particle in step
    EXPECT_GT(holds.back(), 0.5 * largest_force(0.5)) << particles;
  }
  // In step it grows with the number of particles, power 1; here not at all. The drag of the shape
  // itself, some 1e-2 of xi v for each particle, is what is left.
  EXPECT_LT(std::abs(fitted_power(counts, holds)), 0.02);
}

/// The driven chain by classical Runge-Kutta, std::sin and a running sum: the mean of all springs.
double plain_driven(std::size_t count, double b, double K, double k, double xi, double v) {
  using Numbers = std::vector<double>;
  constexpr double kStep = 0.05;
  const auto rates = [&](double t, const Numbers& y) {  // y: displacements, then velocities
    Numbers dy(y.size());
    for (std::size_t i = 0; i < count; ++i) {
      double f = k * (v * t - y[i]) - xi * y[count + i];
      if (i > 0) f += y[i - 1] - y[i];
      if (i + 1 < count) f += y[i + 1] - y[i];
      f -= K / (2.0 * kPi) * std::sin(2.0 * kPi * (b * static_cast<double>(i) + y[i]));
      dy[i] = y[count + i];
      dy[count + i] = f;
    }
    return dy;
  };
  const auto moved = [](Numbers y, const Numbers& dy, double h) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * dy[i];
    return y;
  };
  Numbers y(2 * count, 0.0);
  double sum = 0.0;
  const auto steps = static_cast<int>(std::lround(10.0 / v / kStep));
  const int half = steps / 2;
  for (int n = 0; n < steps; ++n) {
    const double t = n * kStep;
    if (n >= half) {
      for (std::size_t i = 0; i < count; ++i) sum += k * (v * t - y[i]);
    }
    const auto k1 = rates(t, y);
    const auto k2 = rates(t + 0.5 * kStep, moved(y, k1, 0.5 * kStep));
    const auto k3 = rates(t + 0.5 * kStep, moved(y, k2, 0.5 * kStep));
    const auto k4 = rates(t + kStep, moved(y, k3, kStep));
    for (std::size_t i = 0; i < y.size(); ++i) {
      y[i] += kStep / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
  }
  return sum / (steps - half);
}

TEST(FrenkelKontorova, DrivenChainIsThatOfAPlainLoop) {
  constexpr std::size_t kCount = 13;
  for (const double b : {8.0 / 13.0, 1.0}) {
    const auto result = run_shipped(kDriven, {{"N", std::to_string(kCount)}, {"b", text_of(b)}});
    // The two steps differ by a factor of two, and the loop adds up left ends: v t per step, 5e-5
    // of a period, of springs that change by k times the period.
    const double expected = plain_driven(kCount, b, 0.5, 0.05, 0.5, 1e-3);
    EXPECT_NEAR(mean_force(result) / expected, 1.0, 1e-5) << "b = " << b;
  }
}

TEST(FrenkelKontorova, DrivenChainsLedgerCloses) {
  for (const std::string b : {"34 / 55", "1.0"}) {
    const auto result = run_shipped(kDriven, {{"b", b}});
    ASSERT_NE(result.find("energy"), nullptr);
    const double work = result.group("energy")["work_in"].value();
    EXPECT_GT(work, 0.1);
    // rk4 at 0.04 of the stable step, slips included.
    EXPECT_LT(std::abs(result.group("energy")["numerical_work"].value()), 1e-6 * work) << b;
    // Steady: what comes in goes out as heat. Mean force times distance is the same work.
    EXPECT_NEAR(result.group("energy")["heat_out"].value() / work, 1.0, 1e-6) << b;
    EXPECT_NEAR(mean_force(result) * 5.0 / work, 1.0, 1e-9) << b;
  }
}

/// The largest pull that the end of a half-infinite chain in step with the substrate stands: its
/// positions at rest are orbits of the standard map that leave the fixed point, and the pull on the
/// last particle is the step that would come next.
double pull_of_the_standard_map(double K) {
  const double growth = 1.0 + 0.5 * K + std::sqrt(K + 0.25 * K * K);
  constexpr int kOrbits = 2000;
  double largest = 0.0;
  for (int orbit = 0; orbit < kOrbits; ++orbit) {
    double before = 1e-8 * std::pow(growth, static_cast<double>(orbit) / kOrbits);
    double position = before * growth;
    while (position < 0.75) {  // the first kink: beyond, the chain has let go
      const double next =
          2.0 * position - before + K / (2.0 * kPi) * std::sin(2.0 * kPi * position);
      largest = std::max(largest, next - position);
      before = position;
      position = next;
    }
  }
  return largest;
}

TEST(FrenkelKontorova, PulledEndLetsGoWhereTheStandardMapSays) {
  for (const double K : {0.1, 0.2, 0.4}) {
    const double held = pull_of_the_standard_map(K);
    std::vector<double> beyond;
    // So slow that letting go is ten times as fast, and so a slip.
    const double slow = K < 0.2 ? 1e-5 : 5e-5;
    for (const double v : {slow, 2.0 * slow}) {
      const auto result = run_shipped(kFolder + "pulled_end.toml", {{"K", text_of(K)},
                                                                    {"v", text_of(v)},
                                                                    {"k", "0.2"},
                                                                    {"run.duration", "2 / v"},
                                                                    {"measure.from", "0"},
                                                                    {"measure.to", "2"}});
      beyond.push_back(*result.driver(0)["static_force"] - held);
      // The drag of the half kink that moves with the end, xi v/sqrt(K) in the continuum.
      EXPECT_NEAR(beyond.back() * std::sqrt(K) / v, 1.0, 0.1) << "K = " << K << ", v = " << v;
    }
    EXPECT_NEAR(2.0 * beyond[0] - beyond[1], 0.0, 2e-5 * held) << "K = " << K;
  }
}

TEST(FrenkelKontorova, PulledEndHoldsNoMoreForALongerChain) {
  const auto hold = [](const char* count) {
    return *run_shipped(kFolder + "pulled_end.toml",
                        {{"N", count}, {"run.duration", "5 / v"}, {"measure.to", "5"}})
                .driver(0)["static_force"];
  };
  // The far end matters as exp(-2 N sqrt(K)): 3e-16 at N = 40.
  EXPECT_NEAR(hold("80") / hold("40"), 1.0, 1e-9);
  EXPECT_GT(std::abs(hold("3") / hold("40") - 1.0), 1e-3);  // the check can tell
}

}  // namespace
}  // namespace tomlin::test
