// scenarios/thermal: means of runs with noise against quadrature, the Smoluchowski equation and
// theorems on work, within their own statistical errors.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/brownian_tip.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

/// One normal number in 16000 is farther out. Seeds are fixed.
constexpr double kSigmas = 4.0;

struct Estimate {
  double mean = 0.0;
  double error = 0.0;
};

Estimate estimate_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double x : values) mean += x / n;
  double squares = 0.0;
  for (const double x : values) squares += (x - mean) * (x - mean);
  return {mean, std::sqrt(squares / (n * (n - 1.0)))};
}

/// Mean over streams, with the error that the runs state.
Estimate mean_over_streams(const std::string& scene, const std::string& what, int streams,
                           std::vector<Setting> settings) {
  double sum = 0.0;
  double squares = 0.0;
  settings.push_back({"run.stream", ""});
  for (int stream = 0; stream < streams; ++stream) {
    settings.back().value = std::to_string(stream);
    const RunResult result = run_shipped("thermal/" + scene, settings);
    sum += observable(result, what).value();
    for (const ErrorEstimate& one : result.errors) {
      if (!one.path.ends_with(what)) continue;
      squares += one.error.value() * one.error.value();
    }
  }
  return {sum / streams, std::sqrt(squares) / streams};
}

Estimate washboard(double F, double T, int streams, std::vector<Setting> settings) {
  settings.push_back({"F", text_of(F)});
  settings.push_back({"T", text_of(T)});
  return mean_over_streams("washboard.toml", "tip.mean_velocity.x", streams, settings);
}

TEST(Thermal, TheVelocityOnAWashboardIsTheStratonovichIntegral) {
  constexpr double kAllTogether = 0.003;  // relative error of the mean over the twelve
  constexpr double kLeastChi = 1.5;       // of 12 numbers: one in 10^4 below, and as many
  constexpr double kMostChi = 39.0;       // above
  double chi = 0.0;
  double weights = 0.0;
  double deviation = 0.0;
  for (const double F : {0.3, 0.5, 0.7, 1.0}) {
    for (const double T : {0.05, 0.1, 0.2}) {
      const double exact = BrownianTip{.temperature = T, .force = F}.stratonovich_velocity();
      const Estimate found = washboard(F, T, 4, {{"run.duration", "15000.0"}});
      EXPECT_NEAR(found.mean, exact, kSigmas * found.error) << F << " " << T;
      const double weight = exact * exact / (found.error * found.error);
      chi += std::pow((found.mean - exact) / found.error, 2);
      weights += weight;
      deviation += weight * (found.mean / exact - 1.0);
    }
  }
  const double error = 1.0 / std::sqrt(weights);
  EXPECT_LT(error, kAllTogether);
  EXPECT_NEAR(deviation / weights, 0.0, kSigmas * error);
  EXPECT_GT(chi, kLeastChi);
  EXPECT_LT(chi, kMostChi);
}

/// At a long step the schemes differ from the integral, each as its chain says: the mean velocity
/// of `euler_maruyama` is of second order in the step, that of `leimkuhler_matthews` of first.
TEST(Thermal, AtALongStepEachSchemeHasTheVelocityOfItsChain) {
  constexpr double kStep = 0.05;
  const BrownianTip tip{.temperature = 0.1, .force = 0.5};
  const double exact = tip.stratonovich_velocity();
  const auto error_at = [&](double h, bool averaged) {
    return std::abs(tip.velocity_of_chain(h, averaged) - exact);
  };
  constexpr double kOfOrder = 0.1;
  EXPECT_NEAR(std::log2(error_at(kStep, false) / error_at(0.5 * kStep, false)), 2.0, kOfOrder);
  EXPECT_NEAR(std::log2(error_at(kStep, true) / error_at(0.5 * kStep, true)), 1.0, kOfOrder);
  for (const bool averaged : {false, true}) {
    const std::string name = averaged ? "leimkuhler_matthews" : "euler_maruyama";
    const Estimate found =
        washboard(0.5, 0.1, 4,
                  {{"run.duration", "40000.0"},
                   {"run.integrator", "{ type = \"" + name + "\", dt = " + text_of(kStep) + " }"}});
    EXPECT_NEAR(found.mean, tip.velocity_of_chain(kStep, averaged), kSigmas * found.error) << name;
    EXPECT_LT(kSigmas * found.error, 0.5 * error_at(kStep, true)) << name;
  }
}

TEST(Thermal, TheMeanForceOfADrivenTipIsThatOfTheSmoluchowskiEquation) {
  constexpr double kT = 0.02;
  constexpr double kStick = 5.0;
  constexpr double kRelativeError = 0.012;  // of what is compared
  for (const auto& [v, periods] : {std::pair{0.01, 400}, std::pair{0.1, 2000}}) {
    const std::vector<Setting> settings = {{"T", text_of(kT)},
                                           {"s", text_of(kStick)},
                                           {"v", text_of(v)},
                                           {"N", std::to_string(periods)},
                                           {"measure.observables", "[\"driver.mean_force.x\"]"}};
    const Estimate found = mean_over_streams("tip.toml", "driver.mean_force.x", 4, settings);
    const double k = parameter_of("thermal/tip.toml", "k", settings);
    // Cells and steps: relative error 3e-4, smaller than the statistical one by far.
    const double exact = SmoluchowskiTip(0.1, kT, k, v, 400, 1000).mean_force(3);
    EXPECT_NEAR(found.mean, exact, kSigmas * found.error) << v;
    EXPECT_LT(found.error, kRelativeError * exact) << v;
  }
}

/// The table of mean forces over the velocity, at its two fastest decades. The bias of its step,
/// 0.04, is -6e-5 at v = 0.01 and -1.1e-4 at 0.001 by the Markov chain of the scheme.
TEST(Thermal, TheMeanForceOfStickSlipIsThatOfTheSmoluchowskiEquation) {
  constexpr int kStreams = 24;
  constexpr int kPeriodsToLoad = 8;          // the spring is stretched by up to five periods
  constexpr double kRelativeError = 2.5e-3;  // of the mean over streams, at most
  for (const double v : {1e-3, 1e-2}) {
    std::vector<Setting> settings = {{"s", "30"},
                                     {"T", "0.004"},
                                     {"v", text_of(v)},
                                     {"run.integrator.dt", "0.04"},
                                     {"measure.observables", "[\"driver.mean_force.x\"]"},
                                     {"run.stream", ""}};
    std::vector<double> forces;
    for (int stream = 0; stream < kStreams; ++stream) {
      settings.back().value = std::to_string(stream);
      forces.push_back(
          observable(run_shipped("thermal/tip.toml", settings), "driver.mean_force.x").value());
    }
    const Estimate found = estimate_of(forces);
    const double k = parameter_of("thermal/tip.toml", "k", settings);
    // Cells and steps: relative error 1e-4, smaller than the statistical one by far.
    const double exact = SmoluchowskiTip(0.1, 0.004, k, v, 1200, 1000).mean_force(kPeriodsToLoad);
    EXPECT_NEAR(found.mean, exact, kSigmas * found.error) << v;
    EXPECT_LT(found.error, kRelativeError * exact) << v;
    // A planted fault: the mean force without noise is seen to be another.
    EXPECT_GT(std::abs(found.mean - 0.2 * kPi), kSigmas * found.error) << v;
  }
}

/// Mean peak force of the slips as (F_c - F)^(3/2), with its error.
Estimate reduced_peak_force(double v) {
  const double F_c = 0.2 * kPi;
  const RunResult result =
      run_shipped("thermal/tip.toml",
                  {{"s", "30"}, {"T", "0.004"}, {"run.integrator.dt", "0.04"}, {"v", text_of(v)}});
  const auto of_driver = [&](const char* key) { return *result.driver(0)[key]; };
  const double slips = of_driver("slips");
  // One for each period that the driver moves, but for those about to happen at either end.
  EXPECT_NEAR(slips, 50.0, 1.0) << v;
  const double below = F_c - of_driver("mean_slip_force");
  return {std::pow(below, 1.5),
          1.5 * std::sqrt(below) * of_driver("slip_force_deviation") / std::sqrt(slips)};
}

TEST(Thermal, ThePeakForceGrowsWithTheLogarithmOfTheVelocity) {
  const Estimate slow = reduced_peak_force(3e-4);
  const Estimate middle = reduced_peak_force(std::sqrt(3e-4 * 1e-2));
  const Estimate fast = reduced_peak_force(1e-2);
  EXPECT_NEAR(middle.mean, 0.5 * (slow.mean + fast.mean),
              kSigmas * std::hypot(middle.error, 0.5 * slow.error, 0.5 * fast.error));
  // The formula of Garg, without fluctuations of the spring's force: 3/4 sqrt(A) T with
  // A = 2 pi^2 F_c. Peaks of a noisy force are higher, the more so the longer the tip waits.
  const double slope = (slow.mean - fast.mean) / std::log(1e-2 / 3e-4);
  const double without_fluctuations = 0.75 * std::sqrt(0.4 * kPi * kPi * kPi) * 0.004;
  EXPECT_LT(slope, without_fluctuations);
  EXPECT_GT(slope, 0.6 * without_fluctuations);
}

/// The slips of an inertial tip by another scheme (OBABO), other random numbers and the definition
/// of a slip alone, applied to the whole trajectory afterwards.
class SlippingTip {
 public:
  struct Slip {
    double peak_force = 0.0;
    double wells = 0.0;
  };

  /// `apart`: a well that the tip leaves sooner, in periods of the driver, belongs to the same
  /// slip. Slips before the driver has moved `from` periods are left out.
  std::vector<Slip> slips(unsigned seed, int periods, int from, double apart) const {
    constexpr double kEntered = 0.2;  // periods from the barrier: 0.3 before the bottom
    const std::vector<double> x = trajectory(seed, periods);
    const auto period = static_cast<std::size_t>(std::llround(1.0 / (v * kStep)));
    std::vector<std::size_t> entries;  // the step at which each well is first entered
    for (std::size_t i = 0; i < x.size(); ++i) {
      while (x[i] > static_cast<double>(entries.size()) + 1.0 + kEntered) entries.push_back(i);
    }
    std::vector<Slip> found;
    Slip slip;
    std::size_t since = 0;
    for (std::size_t n = 0; n < entries.size(); ++n) {
      for (; since < entries[n]; ++since) {
        slip.peak_force = std::max(slip.peak_force, k * (support(since) - x[since]));
      }
      slip.wells += 1.0;
      const std::size_t next = n + 1 < entries.size() ? entries[n + 1] : x.size();
      if (static_cast<double>(next - since) < apart * static_cast<double>(period)) continue;
      if (since >= period * static_cast<std::size_t>(from)) found.push_back(slip);
      slip = {};
    }
    return found;
  }

  double temperature = 0.0, xi = 0.0, k = 0.0, v = 0.0;

 private:
  static constexpr double kV0 = 0.1, kStep = 0.05;

  double support(std::size_t i) const { return 0.5 + v * kStep * static_cast<double>(i); }

  std::vector<double> trajectory(unsigned seed, int periods) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const double kept = std::exp(-0.5 * xi * kStep);
    const double kick = std::sqrt(temperature * (1.0 - kept * kept));
    std::vector<double> positions(static_cast<std::size_t>(periods / (v * kStep)));
    double x = 0.5;
    double u = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto force = [&](std::size_t at) {
        return k * (support(at) - x) + 2.0 * kPi * kV0 * std::sin(2.0 * kPi * x);
      };
      positions[i] = x;
      u = kept * u + kick * normal(random) + 0.5 * kStep * force(i);
      x += kStep * u;
      u = kept * (u + 0.5 * kStep * force(i + 1)) + kick * normal(random);
    }
    return positions;
  }
};

/// Largest difference between the distribution functions of two samples, in units of what two
/// samples of one distribution have (Kolmogorov and Smirnov): above 1.95 for one pair in 1000.
double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  const auto part_below = [](const std::vector<double>& all, double x) {
    return static_cast<double>(std::upper_bound(all.begin(), all.end(), x) - all.begin()) /
           static_cast<double>(all.size());
  };
  double largest = 0.0;
  for (const std::vector<double>* one : {&a, &b}) {
    for (const double x : *one) {
      largest = std::max(largest, std::abs(part_below(a, x) - part_below(b, x)));
    }
  }
  const auto n = static_cast<double>(a.size());
  const auto m = static_cast<double>(b.size());
  return largest * std::sqrt(n * m / (n + m));
}

/// Peak forces and lengths of slips, of which half are double, over 8 streams of 100 periods each.
TEST(Thermal, SlipsHaveTheDistributionOfAnIndependentIntegrator) {
  constexpr int kStreams = 8;
  constexpr int kFrom = 4;
  constexpr int kPeriods = 100;
  constexpr double kMostKolmogorovSmirnov = 1.95;
  std::vector<Setting> settings = {{"s", "10"},
                                   {"xi", "0.6"},
                                   {"T", "0.004"},
                                   {"v", "3e-3"},
                                   {"N", std::to_string(kPeriods)},
                                   {"run.dynamics", "\"inertial\""},
                                   {"run.integrator", "{ type = \"baoab\", dt = 0.05 }"},
                                   {"run.stream", ""}};
  const SlippingTip tip{.temperature = 0.004,
                        .xi = 0.6,
                        .k = parameter_of("thermal/tip.toml", "k", {{"s", "10"}}),
                        .v = 3e-3};
  struct Slips : RunSink {
    void begin(const RunLayout& layout) override { (void)layout; }
    void sample(const std::vector<double>& row) override { (void)row; }
    void event(const Event& event) override {
      if (event.kind != EventKind::slip || event.time < from) return;
      peak_forces.push_back(event.peak_force);
      wells.push_back(std::round(event.size));
    }
    double from = 0.0;
    std::vector<double> peak_forces, wells;
  };
  Slips found;
  Slips expected;
  Slips of_single_wells;
  found.from = kFrom / tip.v;
  for (int stream = 0; stream < kStreams; ++stream) {
    settings.back().value = std::to_string(stream);
    run_shipped("thermal/tip.toml", settings, &found);
    // A planted fault: each well of a double slip counts as a slip of its own.
    for (const auto& [apart, slips] :
         {std::pair{0.1, &expected}, std::pair{0.0, &of_single_wells}}) {
      const auto seed = static_cast<unsigned>(11 + stream);
      for (const SlippingTip::Slip& slip : tip.slips(seed, kFrom + kPeriods, kFrom, apart)) {
        slips->peak_forces.push_back(slip.peak_force);
        slips->wells.push_back(slip.wells);
      }
    }
  }
  const auto difference = [](const std::vector<double>& one, const std::vector<double>& other) {
    const Estimate a = estimate_of(one);
    const Estimate b = estimate_of(other);
    return std::abs(a.mean - b.mean) / std::hypot(a.error, b.error);
  };
  EXPECT_LT(difference(found.peak_forces, expected.peak_forces), kSigmas);
  EXPECT_LT(difference(found.wells, expected.wells), kSigmas);
  EXPECT_LT(kolmogorov_smirnov(found.peak_forces, expected.peak_forces), kMostKolmogorovSmirnov);
  EXPECT_GT(difference(found.peak_forces, of_single_wells.peak_forces), kSigmas);
  EXPECT_GT(difference(found.wells, of_single_wells.wells), kSigmas);
  EXPECT_GT(kolmogorov_smirnov(found.peak_forces, of_single_wells.peak_forces),
            kMostKolmogorovSmirnov);
  // The statistical errors are small enough to see a hundredth of the force.
  const Estimate peak_force = estimate_of(found.peak_forces);
  EXPECT_LT(kSigmas * peak_force.error, 0.01 * peak_force.mean);
  EXPECT_GT(estimate_of(found.wells).mean, 1.2);
}

/// Table I's ring at lambda = 0, rigid, by another scheme and other random numbers: its centre
/// along x, and its angle. The substrate's energy is V0 S(phi) cos(2 pi x).
class RingInABath {
 public:
  RingInABath(double temperature, unsigned seed)
      : random_(seed), kick_(std::sqrt(2.0 * kXi * temperature * kStep)) {}

  /// Over the periods from the second on.
  double mean_force(int periods) {
    const auto steps = static_cast<long>(std::llround(1.0 / (kV * kStep)));
    double sum = 0.0;
    for (long n = 0; n < (1 + periods) * steps; ++n) {
      const double force = kK * (kV * kStep * static_cast<double>(n) - x_);
      if (n >= steps) sum += force;
      const double wave = std::cos(2.0 * kPi * x_);
      u_ += kStep * (force - kXi * u_ + 2.0 * kPi * kV0 * S() * std::sin(2.0 * kPi * x_)) +
            kick_ * normal_(random_);
      w_ += kStep * (-kXi * w_ - kV0 * slope_of_S() * wave) + kick_ * normal_(random_);
      x_ += kStep * u_;
      phi_ += kStep * w_;
    }
    return sum / static_cast<double>(periods * steps);
  }

 private:
  static constexpr double kV0 = 0.1, kK = 2.0, kV = 1e-3, kStep = 0.02;
  static constexpr double kXi = 2.8284271247461903;

  /// Averages over the four particles that are not mirror images.
  double S() const {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += std::cos(2.0 * kPi * std::cos(phi_ + 0.25 * kPi * i));
    return sum / 4.0;
  }
  double slope_of_S() const {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double angle = phi_ + 0.25 * kPi * i;
      sum += 2.0 * kPi * std::sin(angle) * std::sin(2.0 * kPi * std::cos(angle));
    }
    return sum / 4.0;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double kick_;
  double x_ = 0.0, u_ = 0.0, phi_ = 0.0, w_ = 0.0;
};

/// At a small temperature chance decides which way the ring turns, and temperature when: the force.
TEST(Thermal, TheRingWithoutDecayTurnsEitherWay) {
  constexpr int kPeriods = 9;
  constexpr int kStreams = 40;
  constexpr double kWhole = 0.05;  // of an eighth of a revolution, at a turn
  constexpr double kOfOtherScheme = 0.005;
  const RunResult cold = run_shipped("thermal/ring.toml", {{"T", "0.0"}});
  EXPECT_NEAR(observable(cold, "driver.mean_force.x").value(), 4.0966e-3, 1e-6);
  EXPECT_EQ(observable(cold, "ring.turns").value(), 0.0);
  int stream = 0;
  double before = INFINITY;
  std::vector<double> rotations;
  for (const double T : {1e-24, 1e-12, 1e-6}) {
    std::vector<double> forces;
    for (int k = 0; k < kStreams; ++k, ++stream) {
      const RunResult result =
          run_shipped("thermal/ring.toml", {{"T", text_of(T)}, {"run.stream", text_of(stream)}});
      forces.push_back(observable(result, "driver.mean_force.x").value());
      rotations.push_back(8.0 * observable(result, "ring.turns").value());
      if (T < 1e-15) continue;  // some are turning when the window ends
      EXPECT_NEAR(rotations.back(), std::round(rotations.back()), kWhole) << T;
    }
    const Estimate found = estimate_of(forces);
    EXPECT_LT(found.mean + kSigmas * found.error, before) << T;
    before = found.mean - kSigmas * found.error;
    if (T < 1e-15) continue;
    std::vector<double> others;
    for (unsigned k = 0; k < 4; ++k) others.push_back(RingInABath(T, 7 + k).mean_force(kPeriods));
    const Estimate other = estimate_of(others);
    EXPECT_NEAR(found.mean, other.mean,
                kSigmas * std::hypot(found.error, found.error * std::sqrt(kStreams / 4.0)) +
                    kOfOtherScheme * found.mean)
        << T;
  }
  // Eighteen fair coins of a half each: variance 4.5.
  const Estimate rotation = estimate_of(rotations);
  const auto count = static_cast<double>(rotations.size());
  EXPECT_NEAR(rotation.mean, 0.0, kSigmas * std::sqrt(4.5 / count));
  const double variance = rotation.error * rotation.error * count;
  EXPECT_NEAR(variance / 4.5, 1.0, kSigmas * std::sqrt(2.0 / (count - 1.0)));
}

/// Works of the dragged trap, one for each stream; a start of its own goes with each.
std::vector<double> works_of_trap(const std::vector<Setting>& settings) {
  constexpr int kStreams = 1000;
  std::vector<double> works;
  std::vector<Setting> all = settings;
  all.push_back({"run.stream", ""});
  all.push_back({"seed", ""});
  for (int stream = 0; stream < kStreams; ++stream) {
    all.back().value = all[all.size() - 2].value = std::to_string(stream);
    works.push_back(observable(run_shipped("thermal/trap.toml", all), "trap.work").value());
  }
  return works;
}

/// The work is normally distributed, its variance twice its mean in units of T, and what holds for
/// any work holds for it: <exp(-W/T)> = 1 (Jarzynski), P(-W) = P(W) exp(-W/T) (Crooks; dragging
/// backwards is the mirror image).
void expect_theorems(const std::vector<double>& works, double mean) {
  const Estimate found = estimate_of(works);
  EXPECT_NEAR(found.mean, mean,
              kSigmas * std::sqrt(2.0 * mean / static_cast<double>(works.size())));

  std::vector<double> squares;
  for (const double W : works) squares.push_back((W - mean) * (W - mean));
  const Estimate variance = estimate_of(squares);
  EXPECT_NEAR(variance.mean, 2.0 * mean, kSigmas * variance.error);

  std::vector<double> weights;
  for (const double W : works) weights.push_back(std::exp(-W));
  const Estimate jarzynski = estimate_of(weights);
  EXPECT_NEAR(jarzynski.mean, 1.0, kSigmas * jarzynski.error);

  for (const auto& [from, to] : {std::pair{0.0, 0.5}, std::pair{0.5, 1.0}, std::pair{1.0, 9.0}}) {
    std::vector<double> differences;
    for (const double W : works) {
      const bool inside = std::abs(W) >= from && std::abs(W) < to;
      differences.push_back(!inside ? 0.0 : W < 0.0 ? 1.0 : -std::exp(-W));
    }
    const Estimate crooks = estimate_of(differences);
    EXPECT_NEAR(crooks.mean, 0.0, kSigmas * crooks.error) << from << " to " << to;
  }
}

TEST(Thermal, TheWorkOfADraggedTrapObeysJarzynskiAndCrooks) {
  // Units of the scene: k, xi, T and m are 1. The stretch e of the spring obeys, on average,
  // m e'' + xi e' + k e = xi v; the work is k v times its integral.
  const double v = parameter_of("thermal/trap.toml", "v");
  const double tau = parameter_of("thermal/trap.toml", "tau");
  expect_theorems(works_of_trap({{"run.dynamics", "\"overdamped\""},
                                 {"body.particle.start_temperature", "0.0"},
                                 {"run.integrator.type", "\"leimkuhler_matthews\""}}),
                  v * v * (tau + std::expm1(-tau)));

  using Complex = std::complex<double>;
  const Complex one(-0.5, std::sqrt(0.75));
  const Complex other = std::conj(one);
  const Complex B = v * (1.0 + one) / (other - one);  // e = v + A exp(one t) + B exp(other t)
  const Complex A = -v - B;
  const auto integral = [tau](Complex rate) { return (std::exp(rate * tau) - 1.0) / rate; };
  expect_theorems(works_of_trap({}),
                  v * (v * tau + A * integral(one) + B * integral(other)).real());
}

}  // namespace
}  // namespace tomlin::test
