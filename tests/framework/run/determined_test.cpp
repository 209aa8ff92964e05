#include "framework/run/guard/determined.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "framework/run/guard/disturbance.hpp"
#include "tests/support/memory_store.hpp"
#include "tests/support/ring_scenes.hpp"

// Is the result determined at all? Runs from starts that hardly differ.

namespace tomlin::test {
namespace {

std::string perturb(const std::string& more = "", int seed = 0) {
  return "seed = " + std::to_string(seed) + "\nperturb = { size = 1e-12, repeats = 3" + more +
         " }\n";
}

/// The rigid ring of the paper's Table I, only faster: at decay 0 its orientation is an unstable
/// symmetric equilibrium twice a period.
RingScene ring(double decay, const std::string& keys) {
  return {.coordinates = "rigid",
          .velocity = 0.02,
          .decay = decay,
          .duration = 500.0,
          .integrator = adaptive(1e-10),
          .more = keys + "[measure]\nin = \"driver_periods\"\nfrom = 1\n"};
}

const DeterminedResult& of(const RunResult& result, std::string_view path) {
  for (const DeterminedResult& one : result.determined) {
    if (one.path == path) return one;
  }
  throw std::logic_error(std::string(path));
}

constexpr const char* kForce = "drivers.driver.mean_force.x";

TEST(Determined, ASymmetryThatNothingBreaksIsNot) {
  // The ring is as slow as in Table I, so that the instability has time to grow from 1e-12.
  RingScene slow = ring(0.0, perturb());
  slow.velocity = 1e-3;
  slow.duration = 1e4;
  const RunResult result = run_text(slow.text());
  const DeterminedResult& force = of(result, kForce);
  EXPECT_LT(force.digits, kDigitsOfADeterminedResult);
  EXPECT_GT(force.spread, 1e-3 * force.max);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_EQ(brief(result.warnings[0]), std::string(kForce) + " [run.not_determined]");
}

TEST(Determined, ARollingRingIs) {
  const RunResult result = run_text(ring(1.0, perturb()).text());
  const DeterminedResult& force = of(result, kForce);
  EXPECT_GE(force.digits, 8.0);
  EXPECT_GT(force.spread, 0.0) << "the starts do differ";
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_EQ(*force.value, result.driver(0)["mean_force"][0]);
  EXPECT_GE(*force.value, force.min);
  EXPECT_LE(*force.value, force.max);
  EXPECT_EQ(force.spread, force.max - force.min);
}

TEST(Determined, TheRunItselfIsTheUnperturbedOne) {
  const RunResult with = run_text(ring(1.0, perturb()).text());
  const RunResult without = run_text(ring(1.0, "").text());
  EXPECT_TRUE(same_bits(with.driver(0)["mean_force"], without.driver(0)["mean_force"]));
  EXPECT_TRUE(without.determined.empty());
}

TEST(Determined, SeedsAreReproducedAndDiffer) {
  const auto spread = [](int seed) {
    return of(run_text(ring(1.0, perturb("", seed)).text()), kForce).max;
  };
  EXPECT_TRUE(same_bits(spread(1), spread(1)));
  EXPECT_NE(spread(1), spread(2));
}

/// The noise is of the stated size, on every coordinate of the bodies named and on no other.
TEST(Determined, APerturbedStartDiffersByTheSize) {
  const auto scene = scene_of(RingScene{.duration = 1.0}.text());
  RunOptions options;
  const double size = 1e-3;
  options.perturbation = Perturbation{{0}, size, 5, 1};
  Engine plain(scene, {});
  Engine noisy(scene, options);
  options.perturbation->bodies = {};
  Engine other(scene, options);
  const auto x = field_of(plain, "position");
  const auto y = field_of(noisy, "position");
  EXPECT_TRUE(same_bits(x, field_of(other, "position")));
  double largest = 0.0;
  int moved = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    largest = std::max(largest, std::abs(y[i] - x[i]));
    moved += y[i] != x[i];
  }
  EXPECT_EQ(moved, 16);
  EXPECT_LE(largest, size);
  EXPECT_GT(largest, 0.5 * size);
}

TEST(Determined, OtherObservablesOnRequest) {
  const RunResult result = run_text(ring(1.0, perturb(", observables = [\"ring.turns\"]")).text());
  ASSERT_EQ(result.determined.size(), 1u);
  EXPECT_EQ(*result.determined[0].value, *result.body(0)["turns"]);
  EXPECT_THROW(run_text(ring(1.0, perturb(", observables = [\"ring.turnips\"]")).text()),
               InputError);
}

/// So is the noise on the way, whatever the scene's own length.
TEST(Determined, ADisturbanceOnTheWayIsOfTheSize) {
  constexpr double kLength = 1e-9;
  Model model(
      scene_of("[[body]]\ntype = \"chain\"\ncount = 16\nspacing = 1e-9\norigin = [0.0]\n"
               "particle_mass = 1.0\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 1.0\n"
               "period = 1e-9\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1e9\n"
               "[run]\nduration = 1e-9\nintegrator = { type = \"rk4\", dt = 1e-12 }\n"));
  StateLayout layout;
  model.declare(layout);
  RunState state(layout);
  model.attach(state);
  model.start();
  const double size = 1e-3 * kLength;
  const double* position = model.system().view.position;
  const std::vector<double> before(position, position + 16);
  disturb({{0}, size, 5, 1}, 1, model);
  double largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    largest = std::max(largest, std::abs(position[i] - before[i]));
  }
  EXPECT_LE(largest, size);
  EXPECT_GT(largest, 0.5 * size);
}

/// A well that splits in two long after friction has made one state of all starts.
TEST(Determined, NotByStartsThatRelaxToOneState) {
  const char* const dopri5 = "\"inertial\"\nintegrator = { type = \"dopri5\" }\n";
  const char* const rk4 = "\"inertial\"\nintegrator = { type = \"rk4\", dt = 0.02 }\n";
  const char* const overdamped = "\"overdamped\"\nintegrator = { type = \"rk4\", dt = 0.02 }\n";
  for (const char* dynamics : {dopri5, rk4, overdamped}) {
    SCOPED_TRACE(dynamics);
    const std::string text =
        "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
        "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 0.2\n"
        "velocity = [0.0]\nstart = [0.0]\n[[force]]\ntype = \"expression\"\n"
        "energy = \"(0.8 - 0.01*t)*x^2/2 + x^4/4 + 0.0015*max(0, t - 160)*x\"\n"
        "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"
        "[run]\nduration = 300.0\nperturb = { size = 1e-6, repeats = 8 }\ndynamics = " +
        std::string(dynamics);
    const RunResult result = run_text(text);
    ASSERT_EQ(result.status, RunStatus::finished);
    EXPECT_LT(of(result, kForce).digits, kDigitsOfADeterminedResult);
  }
}

/// A start beyond the end of a formula's domain.
TEST(Determined, AStartThatFailsIsLeftOut) {
  const RunResult result = run_text(
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.01]\nparticle_mass = 1.0\n"
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\n"
      "velocity = [0.0]\n[[force]]\ntype = \"expression\"\nenergy = \"0 - 0.01*sqrt(x)\"\n"
      "[run]\nduration = 0.02\nintegrator = { type = \"rk4\", dt = 0.01 }\n"
      "perturb = { size = 0.1, repeats = 8 }\n");
  ASSERT_EQ(result.status, RunStatus::finished);
  const std::size_t failed = count_of(FaultCode::run_perturb_failed, result.warnings);
  EXPECT_GT(failed, 0U);
  EXPECT_LT(failed, 8U);
  EXPECT_EQ(brief(result.warnings.front()), "run.perturb [run.perturb_failed]");
}

// ---- interrupted

TEST(Interrupted, IsAStatusAndNoWindow) {
  std::atomic<bool> stop{true};
  RunOptions options;
  options.stop = &stop;
  const RunResult result = run_text(ring(1.0, perturb()).text(), {}, options);
  EXPECT_EQ(result.status, RunStatus::interrupted);
  EXPECT_LT(result.end_time, 500.0);
  EXPECT_TRUE(result.driver(0)["mean_force"].empty());
  EXPECT_TRUE(result.determined.empty());
  EXPECT_FALSE(result.driver(0)["final_force"].empty());
}

/// Stopped while it repeats: the run itself is complete, what was asked on top is not.
TEST(Interrupted, WhileItRepeatsRuns) {
  std::atomic<bool> stop{false};
  class Stopper : public RunSink {
   public:
    explicit Stopper(std::atomic<bool>& stop) : stop_(stop) {}
    void begin(const RunLayout&) override {}
    void sample(const std::vector<double>& values) override {
      if (values[0] >= 500.0) stop_ = true;  // the last sample of the run itself
    }

   private:
    std::atomic<bool>& stop_;
  };
  Stopper stopper(stop);
  RunOptions options;
  options.sink = &stopper;
  options.stop = &stop;
  const RunResult result =
      run_text(ring(1.0, perturb()).text() + "[output]\nevery = 100.0\n", {}, options);
  EXPECT_EQ(result.status, RunStatus::interrupted);
  EXPECT_FALSE(result.driver(0)["mean_force"].empty());
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_EQ(brief(result.warnings.back()), "run.perturb [run.comparison_stopped]");
}

/// A start that is over is over at once: it keeps its end again, and no start before it.
TEST(Determined, WhatIsInTheStoreIsNotRepeated) {
  const auto scene = scene_of(ring(1.0, perturb()).text());
  MemoryStore store;
  RunOptions options;
  options.store = &store;
  const RunResult alone = run(scene);
  const RunResult first = run(scene, options);
  const std::map<std::string, int> twice = {
      {"perturbed start 1", 2}, {"perturbed start 2", 2}, {"perturbed start 3", 2}};
  EXPECT_EQ(store.counts, twice);
  store.counts.clear();
  const RunResult second = run(scene, options);
  const std::map<std::string, int> once = {
      {"perturbed start 1", 1}, {"perturbed start 2", 1}, {"perturbed start 3", 1}};
  EXPECT_EQ(store.counts, once);
  for (const RunResult* result : {&first, &second}) {
    EXPECT_TRUE(same_bits(of(*result, kForce).min, of(alone, kForce).min));
    EXPECT_TRUE(same_bits(of(*result, kForce).max, of(alone, kForce).max));
  }
}

}  // namespace
}  // namespace tomlin::test
