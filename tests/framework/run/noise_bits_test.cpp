#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/scenes.hpp"

// Noise has the same bits on every run and instruction set, and after every resumption: no
// generator is part of a run's state. Streams repeat a run with other noise.

namespace tomlin::test {
namespace {

struct NoisyScene {
  std::string what;
  std::string text;
};

std::string noisy_run(const std::string& scheme, const std::string& more = "") {
  const bool inertial = standard().integrator(scheme)->with_inertia;
  return "[run]\nseed = 6\nduration = 12.32\nledger = true\nintegrator = { type = \"" + scheme +
         "\", dt = 0.05 }\n" + (inertial ? "" : "dynamics = \"overdamped\"\n") + more +
         "[measure]\nin = \"time\"\nfrom = 1.5\nto = 11.0\n";
}

std::string noisy_tip(const std::string& driver = "") {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.1]
particle_mass = 1.0 | start_temperature = 0.2
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.5]
)") + driver +
         tables(R"([[force]] | name = "bath" | type = "langevin" | coefficient = 1.0
temperature = 0.2
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.2 | period = 1.0
)");
}

std::string noisy_ring(const std::string& coordinates, const std::string& coefficient) {
  return tables(R"([[body]] | name = "ring" | type = "ring" | count = 11 | radius = 1.0
centre = [0.0, 1.0] | particle_mass = 0.1 | start_temperature = 0.002 | coordinates = ")") +
         coordinates + tables(R"("
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 0.05
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.9, 0.0]
[[force]] | name = "bath" | type = "langevin" | coefficient = )") +
         coefficient + tables(R"(
temperature = 0.002
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.01 | period = 1.0 | decay = 1.0
)");
}

std::vector<NoisyScene> noisy_scenes() {
  const std::string off_centre = "[0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.1, 0.2]";
  std::vector<NoisyScene> all;
  for (const std::string scheme :
       {"baoab", "gjf", "velocity_verlet", "leimkuhler_matthews", "euler_maruyama"}) {
    const bool inertial = standard().integrator(scheme)->with_inertia;
    for (const std::string type : {"double", "quadruple"}) {
      const std::string run = noisy_run(scheme, "number_type = \"" + type + "\"\n");
      const std::string what = scheme + ", " + type;
      all.push_back({"tip, " + what, noisy_tip() + run});
      all.push_back({"tip, there and back, " + what,
                     noisy_tip("reverse = { when = \"bodies.tip.centre_of_mass.x\", above = 0.6, "
                               "below = -0.2 }\n") +
                         run});
      if (type == "quadruple") continue;  // slow
      all.push_back(
          {"rigid ring, " + what, noisy_ring("rigid", inertial ? off_centre : "0.2") + run});
      all.push_back({"flexible ring, " + what, noisy_ring("particles", off_centre) + run});
    }
  }
  return all;
}

/// Stopped and resumed twenty times, each time by an engine that has seen nothing before.
TEST(NoiseBits, SurviveTwentyResumptions) {
  std::mt19937_64 random(17);
  for (const NoisyScene& scene : noisy_scenes()) {
    SCOPED_TRACE(scene.what);
    const auto parsed = scene_of(scene.text);
    Engine whole(parsed, {});
    const RunResult expected = whole.run();
    ASSERT_EQ(expected.status, RunStatus::finished)
        << (expected.failure ? to_string(*expected.failure) : "");
    std::vector<std::byte> numbers;
    for (int k = 0; k < 20; ++k) {
      Engine part(parsed, {});
      if (!numbers.empty()) part.resume(numbers);
      part.advance(1 + random() % 22);
      numbers = part.state().to_bytes();
    }
    Engine last(parsed, {});
    last.resume(numbers);
    expect_same_numbers(last.run(), expected);
    EXPECT_TRUE(Motion(last) == Motion(whole));
    EXPECT_EQ(last.state().to_bytes(), whole.state().to_bytes());
  }
}

TEST(NoiseBits, AreThoseOfEveryInstructionSet) {
  for (const NoisyScene& scene : noisy_scenes()) {
    SCOPED_TRACE(scene.what);
    RunOptions baseline;
    baseline.instruction_set = InstructionSet::baseline;
    Engine plain(scene_of(scene.text), baseline);
    const RunResult expected = plain.run();
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;  // by this processor
      RunOptions options;
      options.instruction_set = set;
      Engine wide(scene_of(scene.text), options);
      expect_same_numbers(wide.run(), expected);
      EXPECT_EQ(plain.state().to_bytes(), wide.state().to_bytes());
    }
  }
}

/// Numbers are those of the stream, the seed and the name: of noise, and of velocities at the
/// start.
TEST(NoiseBits, OfOtherStreamsDiffer) {
  const std::vector<std::vector<Setting>> without = {
      {{"body.tip.start_temperature", "0.0"}},  // noise alone
      {{"force.bath.temperature", "0.0"}}};     // the start alone
  for (std::size_t what = 0; what < without.size(); ++what) {
    std::vector<Motion> all;
    const auto end_with = [&](const std::string& path, const std::string& value) {
      std::vector<Setting> settings = without[what];
      settings.push_back({path, value});
      return motion_at_end(noisy_tip() + noisy_run("baoab"), settings);
    };
    for (const char* stream : {"0", "1", "2"}) all.push_back(end_with("run.stream", stream));
    all.push_back(end_with("run.seed", "7"));
    if (what == 0) all.push_back(end_with("force.bath.name", "\"other\""));
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) EXPECT_FALSE(all[a] == all[b]) << a << ", " << b;
    }
    EXPECT_TRUE(end_with("run.stream", "0") == all[0]);
  }
}

/// How many of these runs another one repeats, whatever streams and repeats they are of.
std::size_t shared_among(std::vector<double> results, double rounding) {
  std::sort(results.begin(), results.end());
  std::size_t shared = 0;
  for (std::size_t k = 1; k < results.size(); ++k) {
    shared += results[k] - results[k - 1] < rounding ? 1 : 0;
  }
  return shared;
}

/// Runs with `[run] repeats` of different streams have no run in common: their means are
/// independent, so that the error of a mean over streams is what the streams scatter by.
TEST(NoiseBits, StreamsWithRepeatsShareNoRun) {
  constexpr int kStreams = 12;
  constexpr int kRepeats = 4;
  constexpr double kRounding = 1e-12;  // of differences of sums of numbers of size 1
  const auto mean_of = [](int stream, int repeats) {
    const RunResult result = run_text(
        noisy_tip() + noisy_run("baoab"),
        {{"run.stream", std::to_string(stream)}, {"run.repeats", std::to_string(repeats)}});
    return observable(result, "driver.mean_force.x").value();
  };
  std::vector<double> all;
  std::vector<double> shifted;  // a planted fault: repeats that are streams further on
  for (int stream = 0; stream < kStreams; ++stream) {
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      // The sum over one run more, less that of those before.
      const double before = repeat == 0 ? 0.0 : repeat * mean_of(stream, repeat);
      all.push_back((repeat + 1) * mean_of(stream, repeat + 1) - before);
      shifted.push_back(repeat == 0 ? all.back() : mean_of(stream * kRepeats + repeat, 1));
    }
  }
  EXPECT_EQ(shared_among(all, kRounding), 0U);
  EXPECT_GT(shared_among(shifted, kRounding), 0U);
}

/// With temperature 0 a langevin force is viscous damping, to the last bit.
TEST(NoiseBits, WithoutTemperatureItIsViscousDamping) {
  for (const std::string scheme : {"velocity_verlet", "rk4", "baoab", "gjf"}) {
    for (const std::string& body :
         {noisy_tip(), noisy_ring("rigid", "0.2"), noisy_ring("particles", "0.2")}) {
      std::string cold = body + noisy_run(scheme);
      const std::string bath = "type = \"langevin\"";
      const std::size_t at = cold.find(bath);
      const std::string name = "temperature = 0.2\n[[force]]";
      std::string damped = cold;
      damped.replace(at, bath.size(), "type = \"viscous_damping\"");
      const std::size_t key = damped.find("\ntemperature");
      damped.erase(key, damped.find('\n', key + 1) - key);
      EXPECT_TRUE(motion_at_end(cold, {{"force.bath.temperature", "0"}}) == motion_at_end(damped))
          << scheme;
    }
  }
}

/// Samples, and whatever else looks at a run, change nothing.
TEST(NoiseBits, DoNotDependOnSamples) {
  for (const std::string scheme : {"baoab", "leimkuhler_matthews"}) {
    const std::string text = noisy_tip() + noisy_run(scheme);
    Engine plain(scene_of(text), {});
    plain.run();
    KeptSamples samples;
    Engine sampled(scene_of(text + "[output]\nevery = 0.15\n"), watched_by(samples));
    sampled.run();
    EXPECT_GT(samples.rows.size(), 80U);
    EXPECT_TRUE(Motion(plain) == Motion(sampled)) << scheme;
  }
}

/// A driver reverses at the end of the step in which its value was passed.
TEST(NoiseBits, DriversReverseAtTheEndsOfSteps) {
  constexpr double kDt = 0.05;
  for (const std::string scheme : {"baoab", "gjf", "velocity_verlet", "leimkuhler_matthews"}) {
    KeptSamples samples;
    const RunResult result =
        run_text(noisy_tip("reverse = { when = \"bodies.tip.centre_of_mass.x\", above = 0.6, "
                           "below = -0.2 }\n") +
                     noisy_run(scheme) + "[output]\nevery = 0.05\n",
                 {{"run.duration", "60.0"}}, watched_by(samples));
    ASSERT_EQ(result.status, RunStatus::finished);
    const std::vector<Event> events = samples.of(EventKind::driver_reversal);
    EXPECT_GT(events.size(), 4U) << scheme;
    const std::size_t time = samples.column("time");
    const std::size_t position = samples.column("tip.centre_of_mass.x");
    bool above = true;
    for (const Event& event : events) {
      const double steps = event.time / kDt;
      EXPECT_NEAR(steps, std::round(steps), 1e-9) << scheme;
      // The first sample beyond the value is the one at that time.
      const auto row = static_cast<std::size_t>(std::lround(steps));
      ASSERT_LT(row, samples.rows.size());
      EXPECT_NEAR(samples.rows[row][time], event.time, 1e-9);
      EXPECT_EQ(samples.rows[row][position] > 0.6, above) << scheme;
      EXPECT_EQ(samples.rows[row][position] < -0.2, !above) << scheme;
      above = !above;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
