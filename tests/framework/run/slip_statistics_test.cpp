#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/window/blocked_series.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// Numbers of slips in the window, against the events that the run leaves, and the stiffness of what
// sticks, against that of spring and well in series.

namespace tomlin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A tip with the stick-slip parameter s, by its stiffness.
TipScene tip(double s, double velocity, double periods, const std::string& integrator,
             double damping = 2.0) {
  TipScene scene{.velocity = velocity,
                 .damping = damping,
                 .amplitude = 0.1,
                 .position = 0.5,  // a minimum
                 .duration = periods / velocity,
                 .integrator = integrator};
  scene.stiffness = 4.0 * kPi * kPi * scene.amplitude / s;
  return scene;
}

std::string window(double from, double to, const std::string& more = "") {
  return "[measure]\nin = \"driver_periods\"\nfrom = " + digits(from) + "\nto = " + digits(to) +
         "\n" + more;
}

struct Kept {
  RunResult result;
  KeptSamples kept;
};

Kept run_kept(const TipScene& scene, const std::vector<Setting>& settings = {}) {
  Kept kept;
  kept.result = run(scene_of(scene.text(), settings), watched_by(kept.kept));
  return kept;
}

/// Numbers of a quantity of slips as a list of them gives them.
void expect_numbers(const RunResult& result, const std::string& key,
                    const std::vector<double>& all) {
  constexpr double kRounding = 1e-12;
  const ResultGroup& driver = result.driver(0);
  double mean = 0.0;
  for (const double x : all) mean += x / static_cast<double>(all.size());
  double squares = 0.0;
  for (const double x : all) squares += (x - mean) * (x - mean);
  const double deviation = std::sqrt(squares / static_cast<double>(all.size() - 1));
  EXPECT_NEAR(*driver["mean_" + key], mean, kRounding * std::abs(mean)) << key;
  EXPECT_NEAR(*driver[key + "_deviation"], deviation, kRounding * std::abs(mean)) << key;
  EXPECT_EQ(*driver["min_" + key], *std::min_element(all.begin(), all.end())) << key;
  EXPECT_EQ(*driver["max_" + key], *std::max_element(all.begin(), all.end())) << key;
}

TEST(SlipStatistics, AreThoseOfTheEventsInTheWindow) {
  // Over two sinusoids, so that slips differ; the window begins and ends between slips.
  for (const std::string& integrator : {fixed_step(0.02), adaptive(1e-8)}) {
    TipScene scene = tip(8.0, 0.02, 60.0, integrator, 0.5);
    scene.more =
        "[[force]]\ntype = \"expression\"\nbody = \"tip\"\n"
        "energy = \"0.02 * cos(2 * pi * x / 0.618)\"\n"
        "[measure]\nin = \"time\"\nfrom = 665.0\nto = 2385.0\n";
    const Kept run = run_kept(scene);
    std::vector<double> lengths, forces, energies, waits;
    double last = 0.0;
    std::size_t outside = 0;
    for (const Event& slip : run.kept.of(EventKind::slip)) {
      if (slip.time < 665.0 || slip.time > 2385.0) {
        ++outside;
        continue;
      }
      if (!lengths.empty()) waits.push_back(slip.time - last);
      last = slip.time;
      lengths.push_back(slip.size);
      forces.push_back(slip.peak_force);
      energies.push_back(slip.energy_lost);
    }
    ASSERT_GT(lengths.size(), 4u);
    ASSERT_GT(outside, 2u);
    EXPECT_EQ(*run.result.driver(0)["slips"], static_cast<double>(lengths.size()));
    expect_numbers(run.result, "slip_length", lengths);
    expect_numbers(run.result, "slip_force", forces);
    expect_numbers(run.result, "slip_energy", energies);
    expect_numbers(run.result, "waiting_time", waits);
    EXPECT_TRUE(run.result.errors.empty());  // there is no noise
    // They do differ.
    EXPECT_GT(*run.result.driver(0)["slip_force_deviation"], 1e-3);
  }
}

TEST(SlipStatistics, OfFewSlips) {
  const RunResult none = run(scene_of(tip(0.5, 0.02, 4.0, fixed_step(0.02)).text()));
  EXPECT_EQ(none.driver(0)["slips"], 0.0);
  EXPECT_FALSE(none.driver(0)["mean_slip_length"]);
  EXPECT_FALSE(none.driver(0)["max_slip_force"]);
  EXPECT_FALSE(none.driver(0)["effective_stiffness"]);
  TipScene once = tip(6.0, 0.02, 4.0, fixed_step(0.02));
  once.more = window(2.1, 3.1);
  const RunResult one = run(scene_of(once.text()));
  ASSERT_EQ(one.driver(0)["slips"], 1.0);
  EXPECT_NEAR(*one.driver(0)["mean_slip_length"], 0.9, 0.2);
  EXPECT_EQ(*one.driver(0)["mean_slip_length"], *one.driver(0)["max_slip_length"]);
  EXPECT_FALSE(one.driver(0)["slip_length_deviation"]);
  EXPECT_FALSE(one.driver(0)["mean_waiting_time"]);
  // A body that is no spring's has none to look for.
  const std::string prescribed =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.5]\n"
      "coordinates = \"prescribed\"\nmotion = { velocity = [0.1] }\n[[force]]\n"
      "type = \"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n[run]\nduration = 1.0\n"
      "integrator = { type = \"rk4\", dt = 0.1 }\n";
  EXPECT_FALSE(run(scene_of(prescribed)).driver(0)["slips"]);
}

TEST(SlipStatistics, EnergyOfSlipsIsWhatIsDissipated) {
  // Slowly pulled, nearly all of it is dissipated in slips, one a period.
  TipScene scene = tip(6.0, 0.002, 9.0, fixed_step(0.05));
  scene.more = window(2.0, 8.0);
  const RunResult result = run(scene_of(scene.text(), {{"run.ledger", "true"}}));
  ASSERT_EQ(result.driver(0)["slips"], 6.0);
  const double per_period = *result.driver(0)["dissipated_per_period"];
  EXPECT_NEAR(*result.driver(0)["mean_slip_energy"] / per_period, 0.99, 0.015);
}

/// At the bottom of a well, spring and well in series: Socoliuc et al. (2004),
/// doi:10.1103/PhysRevLett.92.134301.
double in_series(const TipScene& scene) {
  const double well = 4.0 * kPi * kPi * scene.amplitude;
  return scene.stiffness * well / (scene.stiffness + well);
}

/// A run of a scene slips at least so often, with an effective stiffness between these parts of
/// that of spring and well in series.
RunResult expect_in_series(const TipScene& scene, const std::vector<Setting>& settings, double low,
                           double high = 1.003, double fewest_slips = 3.0) {
  const RunResult result = run(scene_of(scene.text(), settings));
  EXPECT_GE(*result.driver(0)["slips"], fewest_slips);
  const double part = *result.driver(0)["effective_stiffness"] / in_series(scene);
  EXPECT_GT(part, low) << scene.text();
  EXPECT_LT(part, high) << scene.text();
  return result;
}

TEST(EffectiveStiffness, IsThatOfSpringAndWellInSeries) {
  // A chord over a twentieth of a period near the bottom is less steep by up to half a percent.
  for (const double s : {2.0, 3.0, 4.0}) {
    for (const std::string& integrator : {fixed_step(0.05), adaptive(1e-9)}) {
      TipScene scene = tip(s, 0.001, 5.0, integrator);
      const RunResult result = expect_in_series(scene, {}, 0.99);
      // The spring alone is stiffer by far, the rise of the force over a period much softer.
      EXPECT_GT(scene.stiffness, 1.2 * in_series(scene));
      EXPECT_LT(result.driver(0)["peak_to_peak_force"][0], 0.95 * in_series(scene));
    }
  }
}

TEST(EffectiveStiffness, InEveryNumberTypeAndWithoutInertia) {
  const TipScene scene = tip(4.0, 0.001, 4.0, fixed_step(0.1));
  for (const auto& [key, word] :
       {std::pair("run.number_type", "\"quadruple\""), {"run.dynamics", "\"overdamped\""}}) {
    expect_in_series(scene, {{key, word}}, 0.99, 1.003, 2.0);
  }
}

TEST(EffectiveStiffness, InTheSlowLimit) {
  expect_in_series(tip(4.0, 0.001, 5.0, "{ type = \"continuation\" }"),
                   {{"run.dynamics", "\"quasistatic\""}}, 0.985);
}

TEST(EffectiveStiffness, DoesNotMindSwings) {
  // A slip leaves swings, faster than the driver at first; what is left of them once the point
  // moves with the driver makes less of a difference the slower that is.
  struct Case {
    double velocity, damping, low;
  };
  for (const Case& one : {Case{5e-4, 0.05, 0.995}, {5e-4, 0.1, 0.995}, {2e-3, 0.1, 0.98}}) {
    expect_in_series(tip(4.0, one.velocity, 5.0, fixed_step(0.05), one.damping), {}, one.low);
  }
  // A tip that swings until the next slip does not stick.
  const RunResult none = run(scene_of(tip(4.0, 0.01, 5.0, fixed_step(0.05), 0.1).text()));
  ASSERT_GE(*none.driver(0)["slips"], 3.0);
  EXPECT_FALSE(none.driver(0)["effective_stiffness"]);
}

TEST(EffectiveStiffness, ComesAlsoOfADriverOnItsWayBack) {
  expect_in_series(
      tip(4.0, 0.001, 12.0, fixed_step(0.05)),
      {{"force.driver.reverse", "{ when = \"driver.position.x\", above = 4.0, below = 0.5 }"},
       {"measure.from", "5.0"},
       {"measure.in", "\"driver_periods\""}},
      0.985, 1.005);
}

TEST(SlipStatistics, SamplesDoNotAlterThem) {
  for (const std::string& integrator : {fixed_step(0.3), fixed_step(0.02)}) {
    TipScene scene = tip(5.0, 0.02, 12.0, integrator);
    const RunResult alone = run(scene_of(scene.text()));
    scene.more = "[output]\nevery = 0.777\n";
    const RunResult sampled = run_kept(scene).result;
    ASSERT_GT(*alone.driver(0)["slips"], 3.0);
    for (const ResultValue& one : alone.driver(0).values) {
      const std::string& key = one.quantity().key;
      if (key.find("slip") == std::string::npos && key != "effective_stiffness") continue;
      // A tip keeps its state in registers or not: rounding.
      constexpr double kRounding = 1e-11;
      const ResultValue& other = sampled.driver(0)[key];
      ASSERT_EQ(one.has_value(), other.has_value()) << key;
      if (one) {
        EXPECT_NEAR(*one, *other, kRounding) << key << integrator;
      }
    }
  }
}

TEST(SlipStatistics, ResumeFromAnyStep) {
  for (const std::string& integrator : {fixed_step(0.3), adaptive(1e-6)}) {
    TipScene scene = tip(5.0, 0.02, 9.0, integrator);
    scene.more = window(1.7, 8.0);
    const auto parsed = scene_of(scene.text());
    const RunResult expected = run_as_bound(parsed);
    ASSERT_GT(*expected.driver(0)["slips"], 3.0);
    ASSERT_TRUE(expected.driver(0)["effective_stiffness"]);
    expect_same_driver_from(parsed, expected, 16, 112);
  }
}

/// The scene's damping as a bath, by default at a tenth of the barrier.
std::string in_a_bath(const TipScene& scene, double temperature = 0.02) {
  std::string text = scene.text();
  const std::string damping = "viscous_damping";
  text.replace(text.find(damping), damping.size(),
               "langevin\"\ntemperature = " + digits(temperature) + " #");
  return text;
}

/// A tip in contact with a crystal, at critical damping in its spring alone: without noise it slips
/// over two periods at once.
TipScene tip_of_double_slips(double periods, const std::string& integrator) {
  TipScene scene = tip(14.05, 2.8e-3, periods, integrator, 1.06);
  scene.more = window(4.0, periods);
  return scene;
}

/// Slips of a tip in a bath of next to no temperature are those without a bath: a slip over two
/// periods is one, from the largest force to where the tip stays.
TEST(SlipsUnderNoise, OfAColdTipAreThoseWithoutNoise) {
  constexpr double kPeriods = 24.0;
  constexpr double kPart = 0.01;  // of a slip: what is left of it at ten times the driver's speed
  const RunResult without = run(scene_of(tip_of_double_slips(kPeriods, adaptive(1e-8)).text()));
  const RunResult cold = run(
      scene_of(in_a_bath(tip_of_double_slips(kPeriods, R"({ type = "baoab", dt = 0.1 })"), 4e-8)));
  ASSERT_EQ(*without.driver(0)["slips"], 10.0);
  EXPECT_EQ(*cold.driver(0)["slips"], 10.0);
  for (const char* key : {"mean_slip_length", "min_slip_length", "max_slip_length",
                          "mean_slip_force", "min_slip_force", "mean_waiting_time"}) {
    EXPECT_NEAR(*cold.driver(0)[key] / *without.driver(0)[key], 1.0, kPart) << key;
  }
  // A count of single slips would have a shorter mean.
  EXPECT_GT(*without.driver(0)["mean_slip_length"], 1.5);
}

/// The end of a slip does not depend on the ends of steps.
TEST(SlipsUnderNoise, HaveTheLengthOfAnyStep) {
  constexpr double kPeriods = 250.0;
  constexpr double kSigmas = 4.0;
  constexpr double kLargestError = 0.02;  // of a period; the next end of a step adds 0.08
  const auto length = [](double dt) {
    const RunResult result = run(scene_of(in_a_bath(
        tip_of_double_slips(kPeriods, "{ type = \"baoab\", dt = " + digits(dt) + " }"), 0.013)));
    const ResultGroup& driver = result.driver(0);
    return std::pair(*driver["mean_slip_length"],
                     *driver["slip_length_deviation"] / std::sqrt(*driver["slips"]));
  };
  const auto [coarse, coarse_error] = length(0.47);
  const auto [fine, fine_error] = length(0.06);
  EXPECT_NEAR(coarse, fine, kSigmas * std::hypot(coarse_error, fine_error));
  EXPECT_LT(std::hypot(coarse_error, fine_error), kLargestError);
}

/// A spring that starts stretched pulls its tip back over periods, with noise and without. It is
/// not the driver's motion that does so, and the static force is that before the first slip.
TEST(SlipStatistics, RelaxationFromTheStartIsNoSlip) {
  constexpr double kRounding = 1e-12;
  const TipScene still = tip(5.0, 2e-3, 8.0, adaptive(1e-8));
  const TipScene shaking = tip(5.0, 2e-3, 8.0, R"({ type = "baoab", dt = 0.05 })");
  for (const std::string& text : {still.text(), in_a_bath(shaking, 1e-6)}) {
    for (const char* const start : {"[0.5]", "[-4.0]", "[-1.7]", "[4.5]"}) {
      KeptSamples kept;
      const RunResult result =
          run(scene_of(text, {{"force.driver.start", start}}), watched_by(kept));
      const std::vector<Event> slips = kept.of(EventKind::slip);
      ASSERT_FALSE(slips.empty()) << start;
      for (const Event& slip : slips) EXPECT_GT(slip.size, 0.5) << start;
      EXPECT_GT(slips.front().time, 0.1 / 2e-3) << start;
      EXPECT_GE(*result.driver(0)["static_force"], (1.0 - kRounding) * slips.front().peak_force)
          << start;
    }
  }
}

TEST(SlipsUnderNoise, LeadFromWellToWellHoweverFastThePointShakes) {
  constexpr double kPeriods = 12.0;
  const TipScene scene = tip(10.0, 1e-2, kPeriods, R"({ type = "baoab", dt = 0.05 })");
  KeptSamples kept;
  const RunResult result = run(scene_of(in_a_bath(scene)), watched_by(kept));
  ASSERT_EQ(result.status, RunStatus::finished);
  const ResultGroup& driver = result.driver(0);
  // The tip has not yet followed one or two of the last periods.
  EXPECT_GE(*driver["slips"], kPeriods - 3.0);
  EXPECT_LE(*driver["slips"], kPeriods);
  double before = 0.0;
  double largest = 0.0;
  for (const Event& slip : kept.events) {
    ASSERT_EQ(slip.kind, EventKind::slip);  // noise reverses the point at every other step
    EXPECT_GE(slip.time, before);
    EXPECT_GT(slip.duration, 0.0);
    EXPECT_TRUE(std::isnan(slip.energy_lost));
    before = slip.time + slip.duration;
    largest = std::max(largest, slip.peak_force);
  }
  EXPECT_LE(largest, driver["max_force"].at(0));
  EXPECT_GT(*driver["mean_slip_force"], 0.5 * driver["max_force"].at(0));
  EXPECT_EQ(*driver["static_force"], kept.events.front().peak_force);
}

TEST(SlipsUnderNoise, AreNotCountedWhereThereAreNoWells) {
  const TipScene scene = tip(0.5, 1e-2, 4.0, R"({ type = "baoab", dt = 0.05 })");
  const RunResult result = run(scene_of(in_a_bath(scene)));
  EXPECT_FALSE(result.driver(0)["slips"].has_value());
}

// ---- errors

/// A tip without inertia that slips now and then by the noise of its bath.
std::string thermal_slips(std::uint64_t stream, double periods) {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.5]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 0.4 | velocity = [0.02]
[[force]] | name = "bath" | type = "langevin" | coefficient = 1.0 | temperature = 0.01
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | dynamics = "overdamped" | integrator = { type = "euler_maruyama", dt = 0.04 }
stream = )") +
         std::to_string(stream) + "\nduration = " + digits(50.0 * periods) +
         "\n[measure]\nin = \"time\"\nfrom = 100.0\n";
}

/// Without inertia no heat is known of a slip in noise.
const std::vector<std::string> kMeansOfSlips = {"mean_slip_length", "mean_slip_force",
                                                "mean_waiting_time"};

/// The standard errors from blocks of slips agree with the scatter of means over streams.
TEST(SlipStatistics, ErrorsOfMeansInNoise) {
  constexpr int kStreams = 24;
  constexpr double kRounding = 1e-9;
  // The scatter of 24 streams has a standard deviation of 1 in 7, and blocks are about 16.
  constexpr double kLeastRatio = 0.6;
  constexpr double kMostRatio = 1.7;
  std::map<std::string, std::vector<double>> means;
  std::map<std::string, double> squares;
  for (std::uint64_t stream = 0; stream < kStreams; ++stream) {
    KeptSamples kept;
    const RunResult result = run(scene_of(thermal_slips(stream, 122.0)), watched_by(kept));
    for (const std::string& key : kMeansOfSlips) {
      means[key].push_back(*result.driver(0)[key]);
      squares[key] += std::pow(stated_error(result, "drivers.driver." + key).value(), 2) / kStreams;
    }
    std::vector<double> forces;
    for (const Event& slip : kept.of(EventKind::slip)) {
      if (slip.time >= 100.0) forces.push_back(slip.peak_force);
    }
    ASSERT_GT(forces.size(), 100u);
    EXPECT_NEAR(*stated_error(result, "drivers.driver.mean_slip_force"),
                *blocked_mean(forces).error, kRounding * *blocked_mean(forces).error);
  }
  for (const std::string& key : kMeansOfSlips) {
    double mean = 0.0;
    for (const double x : means[key]) mean += x / kStreams;
    double scatter = 0.0;
    for (const double x : means[key]) scatter += (x - mean) * (x - mean) / (kStreams - 1);
    const double ratio = std::sqrt(squares[key] / scatter);
    if (key == "mean_waiting_time") {
      // One slip for each period: what one waits longer the next one waits shorter, so that the
      // mean is known better than blocks show.
      EXPECT_GT(ratio, kLeastRatio) << key;
      continue;
    }
    EXPECT_GT(ratio, kLeastRatio) << key;
    EXPECT_LT(ratio, kMostRatio) << key;
  }
}

TEST(SlipStatistics, FewSlipsInNoiseHaveNoError) {
  const RunResult result = run_text(thermal_slips(0, 30.0));
  ASSERT_TRUE(result.driver(0)["mean_slip_force"]);
  for (const std::string& key : kMeansOfSlips)
    EXPECT_FALSE(stated_error(result, "drivers.driver." + key)) << key;
  EXPECT_EQ(count_of(FaultCode::run_error_not_estimated, result.warnings), 1U);
}

TEST(SlipStatistics, BlocksOfALongSeries) {
  std::vector<double> reals(BlockedSeries::kReals);
  std::vector<std::int64_t> integers(BlockedSeries::kIntegers);
  BlockedSeries series;
  series.attach(reals.data(), integers.data());
  std::vector<double> scratch(BlockedSeries::kBlocks);
  std::vector<double> all;
  std::uint64_t word = 1;
  for (std::size_t count = 1; count <= 5000; ++count) {
    word = word * 6364136223846793005ULL + 1442695040888963407ULL;
    all.push_back(static_cast<double>(word >> 40) * 0x1p-24);
    series.add(all.back());
    if (count % 97 != 0 && count != BlockedSeries::kBlocks) continue;
    std::size_t length = 1;
    while (count / length > BlockedSeries::kBlocks) length *= 2;
    std::vector<double> blocks;
    for (std::size_t k = 0; k + length <= count; k += length) {
      double sum = 0.0;
      for (std::size_t j = 0; j < length; ++j) sum += all[k + j];
      blocks.push_back(sum / static_cast<double>(length));
    }
    const BlockedMean expected = blocked_mean(blocks);
    const BlockedMean found = series.mean(scratch);
    ASSERT_EQ(found.error.has_value(), expected.error.has_value()) << count;
    if (found.error) {
      ASSERT_NEAR(*found.error, *expected.error, 1e-9 * *expected.error) << count;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
