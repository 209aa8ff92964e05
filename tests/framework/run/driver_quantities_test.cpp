#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// Components of mean forces along and across the pull, how much forces vary, what is dissipated in
// a period, and the load of a body, each against a closed form.

namespace tomlin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDamping = 0.8;

std::string vector_of(const std::vector<double>& numbers) {
  std::string list;
  for (const double x : numbers) list += (list.empty() ? "" : ", ") + digits(x);
  return "[" + list + "]";
}

/// A particle that is dragged through a viscous medium, with one more constant force on it.
RunResult dragged(const std::vector<double>& velocity, const std::vector<double>& force,
                  const std::string& reverse = "") {
  const std::vector<double> zeros(velocity.size(), 0.0);
  std::string text =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = " +
      vector_of(zeros) +
      "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
      "velocity = " +
      vector_of(velocity) + "\n" + reverse +
      "[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(kDamping) +
      "\n[[force]]\ntype = \"constant_force\"\nforce = " + vector_of(force) +
      "\n[run]\nduration = 120.0\nintegrator = { type = \"rk4\", dt = 0.05 }\n"
      "[measure]\nin = \"time\"\nfrom = 80.0\n";  // swings decay to exp(-32)
  return run(scene_of(text));
}

constexpr double kRounding = 1e-11;

TEST(MeanForce, AlongAndAcrossThePull) {
  const RunResult line = dragged({-0.2}, {0.05});
  EXPECT_NEAR(*line.driver(0)["mean_force_along"], kDamping * 0.2 + 0.05, kRounding);
  EXPECT_FALSE(line.driver(0)["mean_force_across"]);
  // The spring holds against the other force.
  const RunResult plane = dragged({0.3, 0.4}, {0.0, 0.0});
  EXPECT_NEAR(*plane.driver(0)["mean_force_along"], kDamping * 0.5, kRounding);
  EXPECT_NEAR(*plane.driver(0)["mean_force_across"], 0.0, kRounding);
  const RunResult up = dragged({0.0, 0.2}, {0.07, 0.01});
  EXPECT_NEAR(*up.driver(0)["mean_force_along"], kDamping * 0.2 - 0.01, kRounding);
  EXPECT_NEAR(*up.driver(0)["mean_force_across"], 0.07, kRounding);  // counter-clockwise: -x
  const RunResult space = dragged({0.0, 0.2, 0.0}, {0.03, 0.0, -0.04});
  EXPECT_NEAR(*space.driver(0)["mean_force_along"], kDamping * 0.2, kRounding);
  EXPECT_NEAR(*space.driver(0)["mean_force_across"], 0.05, kRounding);
}

TEST(MeanForce, OfADriverWithoutADirection) {
  const RunResult rests = dragged({0.0, 0.0}, {0.1, 0.0});
  EXPECT_NEAR(rests.driver(0)["mean_force"][0], -0.1, kRounding);
  EXPECT_FALSE(rests.driver(0)["mean_force_along"]);
  EXPECT_FALSE(rests.driver(0)["mean_force_across"]);
}

TEST(MeanForce, KeepsItsDirectionWhereTheDriverReverses) {
  // It reverses once, before the window.
  const RunResult back =
      dragged({0.2}, {0.0}, "reverse = { when = \"driver.position.x\", above = 1.0 }\n");
  EXPECT_NEAR(*back.driver(0)["mean_force_along"], -kDamping * 0.2, kRounding);
}

/// A prescribed point over a sinusoid: its force is that of the substrate, a sine of time.
std::string moved(const std::string& integrator, double offset, const std::string& observables) {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.0]\n"
         "coordinates = \"prescribed\"\nmotion = { velocity = [0.25] }\n[[force]]\n"
         "type = \"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n[[force]]\n"
         "type = \"constant_force\"\nforce = [" +
         digits(offset) + "]\n[run]\nduration = 20.0\nintegrator = " + integrator +
         "\n[measure]\nin = \"time\"\nfrom = 3.13\nto = 15.13\n" + observables;
}
const std::string kDeviation = "observables = [\"tip.force_deviation.x\", \"tip.mean_force.x\"]\n";

TEST(ForceDeviation, OfASineIsItsAmplitudeByRootTwo) {
  const double closed = 2.0 * kPi * 0.1 / std::sqrt(2.0);
  // A mean 1e6 times as large leaves 1e-10 of its own rounding in each force; the difference of two
  // means of squares would be off by 1e-4 of them.
  for (const double offset : {0.0, 1e6}) {
    for (const std::string& integrator : {fixed_step(0.05), adaptive(1e-10)}) {
      const RunResult result = run(scene_of(moved(integrator, offset, kDeviation)));
      const double tolerance = offset == 0.0 ? 1e-9 : 1e-8;
      EXPECT_NEAR(result.driver(0)["force_deviation"][0], closed, tolerance) << integrator;
      EXPECT_NEAR(result.driver(0)["mean_force"][0], -offset, 1e-8 * std::max(1.0, offset));
    }
  }
  const auto in_quadruple =
      scene_of(moved(fixed_step(0.05), 0.0, kDeviation), {{"run.number_type", "\"quadruple\""}});
  EXPECT_NEAR(run(in_quadruple).driver(0)["force_deviation"][0], closed, 1e-9);
}

TEST(ForceDeviation, OfASlipsForce) {
  // Against fine samples.
  TipScene tip{.stiffness = 0.5, .duration = 30.0};
  tip.more =
      "[output]\nevery = 0.001\n[measure]\nin = \"time\"\nfrom = 10.0\nto = 30.0\n"
      "observables = [\"driver.force_deviation.x\"]\n";
  KeptSamples kept;
  for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-9)}) {
    kept = KeptSamples();
    tip.integrator = integrator;
    const RunResult result = run(scene_of(tip.text()), watched_by(kept));
    const std::size_t force = kept.column("driver.force.x");
    double sum = 0.0, squares = 0.0, weights = 0.0;
    for (std::size_t k = 10'000; k <= 30'000; ++k) {
      const double weight = k == 10'000 || k == 30'000 ? 0.5 : 1.0;  // the trapezoidal rule
      sum += weight * kept.rows[k][force];
      squares += weight * kept.rows[k][force] * kept.rows[k][force];
      weights += weight;
    }
    const double mean = sum / weights;
    EXPECT_NEAR(result.driver(0)["force_deviation"][0], std::sqrt(squares / weights - mean * mean),
                1e-7);
  }
}

TEST(ForceDeviation, IsLookedAtOnlyWhereItIsAskedFor) {
  const RunResult all = run(scene_of(moved(fixed_step(0.05), 0.0, "")));
  EXPECT_EQ(all.driver(0).find("force_deviation"), nullptr);
}

TEST(ForceDeviation, ResumesFromACheckpoint) {
  for (const std::string& integrator : {fixed_step(0.05), adaptive(1e-8)}) {
    const auto scene = scene_of(moved(integrator, 3.0, kDeviation));
    const RunResult whole = run_as_bound(scene);
    ASSERT_TRUE(whole.driver(0)["force_deviation"]);
    expect_same_driver_from(scene, whole, whole.steps / 2, whole.steps);
  }
}

TEST(ForceDeviation, OfOnePeriodAfterAnother) {
  TipScene tip{.stiffness = 8.0,
               .more = "[measure]\nobservables = [\"driver.force_deviation.x\"]\n"};
  std::string text = tip.text();
  const std::string key = "duration = " + digits(tip.duration);
  text.replace(text.find(key), key.size(),
               "until = { steady = \"driver.mean_force.x\", tolerance = 1e-6, max = 400.0 }");
  const RunResult until = run(scene_of(text));
  ASSERT_GT(until.steady->periods, 2u);
  tip.duration = 80.0;
  tip.more =
      "[measure]\nin = \"driver_periods\"\nfrom = 19.0\nto = 20.0\n"
      "observables = [\"driver.force_deviation.x\"]\n";
  EXPECT_NEAR(until.driver(0)["force_deviation"][0],
              run(scene_of(tip.text())).driver(0)["force_deviation"][0], 1e-6);
}

TEST(DissipatedPerPeriod, IsHeatByPeriods) {
  TipScene tip{.stiffness = 8.0, .duration = 60.0};
  tip.more = "[measure]\nin = \"driver_periods\"\nfrom = 5.0\nto = 15.0\n";
  const RunResult result = run(scene_of(tip.text(), {{"run.ledger", "true"}}));
  const double heat = *observable(result, "energy.heat_out") / 10.0;
  EXPECT_NEAR(*result.driver(0)["dissipated_per_period"], heat, 1e-8);
  // With another period, half as much.
  const RunResult half = run(scene_of(tip.text(), {{"run.ledger", "true"},
                                                   {"measure.period", "0.5"},
                                                   {"measure.from", "10.0"},
                                                   {"measure.to", "30.0"}}));
  EXPECT_NEAR(*half.driver(0)["dissipated_per_period"], 0.5 * heat, 1e-8);
  EXPECT_FALSE(run(scene_of(tip.text())).driver(0)["dissipated_per_period"]);
}

TEST(DissipatedPerPeriod, CountsWhatIsStored) {
  // A window over half a period of a tip whose spring is loaded meanwhile: the work is not lost.
  TipScene tip{.velocity = 0.01, .stiffness = 0.5, .position = 0.5, .duration = 100.0};
  tip.more = "[measure]\nin = \"time\"\nfrom = 10.0\nto = 30.0\n";
  const RunResult result = run(scene_of(tip.text(), {{"run.ledger", "true"}}));
  const double periods = 0.01 * 20.0;
  const double work = *result.driver(0)["work"];
  const double heat = *observable(result, "energy.heat_out");
  EXPECT_NEAR(*result.driver(0)["dissipated_per_period"] * periods, heat, 1e-8);
  EXPECT_GT(work, 10.0 * heat);
}

TEST(Load, IsWhatTheSubstrateCarries) {
  // A tip that is pressed with a constant force on a soft wall and pulled along it: over whole
  // periods the wall carries the load, whatever the height does meanwhile.
  const double load = 0.3;
  const std::string text =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.5, 1.0]\n"
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 8.0\naxes = [\"x\"]\n"
      "velocity = [0.25, 0.0]\n[[force]]\nname = \"surface\"\ntype = \"expression\"\n"
      "body = \"tip\"\nenergy = \"exp(-3 * y) * (1 + 0.2 * cos(2 * pi * x))\"\n[[force]]\n"
      "type = \"viscous_damping\"\ncoefficient = 1.0\n[[force]]\nname = \"weight\"\n"
      "type = \"constant_force\"\nforce = [0.0, -0.3]\n[run]\nduration = 80.0\n"
      "integrator = { type = \"rk4\", dt = 0.02 }\n[measure]\nin = \"driver_periods\"\n"
      "period = 1.0\nfrom = 10.0\nto = 20.0\nobservables = [\"surface.on.tip.mean_force.x\", "
      "\"driver.mean_force_along\"]\n";
  const RunResult result = run(scene_of(text));
  const double normal = *observable(result, "forces.surface.on.tip.mean_force.y");
  EXPECT_NEAR(normal, load, 1e-8);
  // The medium takes its part of the force that resists the pull.
  const double along = *observable(result, "driver.mean_force_along");
  const double of_surface = -*observable(result, "forces.surface.on.tip.mean_force.x");
  EXPECT_NEAR(along - of_surface, 1.0 * 0.25, 1e-8);
  EXPECT_GT(of_surface / normal, 1e-3);
}

}  // namespace
}  // namespace tomlin::test
