#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/order.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/scenes.hpp"

// Forces and operators that act between two times only, `active = { from, until }`, against closed
// forms on both sides of each time.

namespace tomlin::test {
namespace {

constexpr double kSpeed = 0.4;  // of the free particle
constexpr double kStiffness = 2.0;
constexpr double kPull = 0.25;  // velocity of the support
constexpr double kFrom = 1.0;
constexpr double kUntil = 3.1;
constexpr double kDuration = 5.0;

/// A free particle that a spring pulls meanwhile; times are given, whatever the step.
std::string pulled(const std::string& integrator, const std::string& active,
                   const std::string& more = "") {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.1]\n"
         "velocity = [" +
         digits(kSpeed) +
         "]\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
         digits(kStiffness) + "\nvelocity = [" + digits(kPull) + "]\n" + active +
         "[run]\nduration = " + digits(kDuration) + "\nintegrator = " + integrator + "\n" + more;
}

std::string active(double from, double until) {
  return "active = { from = " + digits(from) + ", until = " + digits(until) + " }\n";
}

/// Position and velocity at the end: free flight, the oscillation about a support that sets out
/// from the particle, free flight.
struct End {
  double x = 0.0, v = 0.0;
};
End exact_end(double from = kFrom, double until = kUntil) {
  const double w = std::sqrt(kStiffness);
  const double t = until - from;
  const double there = 0.1 + kSpeed * from;
  const double x = there + kPull * t + (kSpeed - kPull) / w * std::sin(w * t);
  const double v = kPull + (kSpeed - kPull) * std::cos(w * t);
  return {x + v * (kDuration - until), v};
}

End end_of(const std::string& text, const std::vector<Setting>& settings = {}) {
  Engine engine(scene_of(text, settings), {});
  const RunResult result = engine.run();
  EXPECT_EQ(result.status, RunStatus::finished);
  return {observable(result, "tip.centre_of_mass.x").value(), field_of(engine, "velocity").front()};
}

TEST(ActiveForce, ActsBetweenItsTimesToTheOrderOfTheScheme) {
  struct Case {
    std::string (*integrator)(double);
    Window window;
  };
  // Steps that end where the force begins and ceases to act, and steps that are cut there.
  for (const auto& steps : {std::vector<double>{0.1, 0.05, 0.025, 0.0125},
                            std::vector<double>{0.07, 0.035, 0.0175, 0.00875}}) {
    for (const Case& one : {Case{&fixed_step, {3.5, 4.6}}, Case{&verlet, {1.8, 2.3}}}) {
      std::vector<double> errors;
      for (const double dt : steps) {
        const double error =
            std::abs(end_of(pulled(one.integrator(dt), active(kFrom, kUntil))).x - exact_end().x);
        // The control: a force that acted a whole step longer would be off by far more.
        EXPECT_GT(std::abs(exact_end(kFrom, kUntil + dt).x - exact_end().x), 5.0 * error);
        errors.push_back(error);
      }
      EXPECT_TRUE(one.window.holds(fitted_order(steps, errors))) << fitted_order(steps, errors);
    }
  }
}

TEST(ActiveForce, AdaptiveStepsEndAtItsTimes) {
  constexpr double kOfTolerance = 1e-8;  // at 1e-11 a step, a few dozen steps
  for (const std::string& type : {std::string("dopri5"), std::string("radau9")}) {
    const End end = end_of(pulled(adaptive(1e-11, type), active(kFrom, kUntil)));
    EXPECT_NEAR(end.x, exact_end().x, kOfTolerance) << type;
    EXPECT_NEAR(end.v, exact_end().v, kOfTolerance) << type;
  }
}

TEST(ActiveForce, InQuadruplePrecision) {
  const End end = end_of(pulled(fixed_step(0.005), active(kFrom, kUntil)),
                         {{"run.number_type", "\"quadruple\""}});
  EXPECT_NEAR(end.x, exact_end().x, 1e-9);
}

TEST(ActiveForce, ASupportWhosePlaceIsGivenRestsThereAtFirst) {
  // The support rests at 0.6 until the spring acts, then pulls the particle from where it is.
  const std::string text = pulled(fixed_step(0.005), "start = [0.6]\n" + active(kFrom, kUntil));
  const double w = std::sqrt(kStiffness);
  const double t = kUntil - kFrom;
  const double lag = 0.1 + kSpeed * kFrom - 0.6;
  const double x = 0.6 + kPull * t + lag * std::cos(w * t) + (kSpeed - kPull) / w * std::sin(w * t);
  const double v = kPull - lag * w * std::sin(w * t) + (kSpeed - kPull) * std::cos(w * t);
  EXPECT_NEAR(end_of(text).x, x + v * (kDuration - kUntil), 1e-9);
}

/// Far from the origin the support sets out from the particle to its last digit.
TEST(ActiveForce, FarFromTheOriginToo) {
  const std::string text = pulled(fixed_step(0.005), active(kFrom, kUntil)) + "";
  const End near = end_of(text);
  const double far = 1073741824.0;
  const std::string moved = "position = [" + digits(far) + "]";
  std::string there = text;
  there.replace(there.find("position = [0.1]"), 16, moved);
  constexpr double kLastDigits = 1e-4;  // a thousand steps at a position of 1e9, in units of 1e-7
  EXPECT_NEAR(end_of(there).x - far, near.x - 0.1, kLastDigits);
}

TEST(ActiveForce, SwitchingIsNoWork) {
  constexpr double kOfScheme = 1e-9;  // rk4, a hundred steps a period
  for (const char* more : {"",
                           "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.3\n"
                           "period = 1.0\nactive = { from = 0.7, until = 2.9 }\n"
                           "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.3\n"
                           "active = { from = 2.0 }\n"}) {
    const RunResult result =
        run_text(pulled(fixed_step(0.005), active(kFrom, kUntil) + more), {{"run.ledger", "true"}});
    const ResultGroup& energy = result.group("energy");
    EXPECT_NEAR(energy["numerical_work"].value(), 0.0, kOfScheme);
    EXPECT_GT(std::abs(energy["work_in"].value()), 1e-3);
  }
}

/// A driver has no force before it acts; then its support moves from where the particle is.
TEST(ActiveForce, SamplesShowIt) {
  KeptSamples kept;
  run(scene_of(pulled(fixed_step(0.01), active(kFrom, kUntil), "[output]\nevery = 0.1\n")),
      watched_by(kept));
  const std::size_t force = kept.column("driver.force.x");
  const std::size_t end = kept.column("driver.position.x");
  const std::size_t x = kept.column("tip.centre_of_mass.x");
  ASSERT_GT(kept.rows.size(), 45u);
  for (const auto& row : kept.rows) {
    const double t = row[0];
    const double half = 0.05;
    if (t < kFrom + half || t > kUntil + half) {
      EXPECT_EQ(row[force], 0.0) << t;
    } else {
      const double position = 0.1 + kSpeed * kFrom + kPull * (t - kFrom);
      EXPECT_NEAR(row[end], position, 1e-12) << t;
      EXPECT_NEAR(row[force], kStiffness * (row[end] - row[x]), 1e-12) << t;
    }
  }
}

std::string chain_of(const std::string& thermostat, const std::string& integrator) {
  return "[[body]]\nname = \"chain\"\ntype = \"chain\"\ncount = 20\nspacing = 1.0\n"
         "particle_mass = 1.0\nstart_temperature = 0.002\n"
         "[[force]]\nname = \"bonds\"\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
         "stiffness = 1.0\n" +
         thermostat + "[run]\nduration = 20.0\nledger = true\nintegrator = " + integrator +
         "\n[output]\nevery = 0.5\n[measure]\nin = \"time\"\nfrom = 10.0\n";
}

/// Once a thermostat has ceased to act energy is conserved; while it acts it is not.
TEST(ActiveForce, AThermostatForTheFirstHalf) {
  const std::string times = "active = { until = 10.0 }\n";
  const std::string links =
      "[[force]]\ntype = \"nose_hoover_chain\"\nperiod = 3.0\ntemperature = 0.01\n";
  const std::string noise =
      "[[force]]\ntype = \"langevin\"\ncoefficient = 0.5\ntemperature = 0.01\n";
  constexpr double kOfScheme = 1e-3;  // of an energy of 0.2, at 60 steps of the shortest period
  for (const auto& [bath, scheme] :
       {std::pair(links, verlet(0.05)), std::pair(noise, verlet(0.05)),
        std::pair(noise, std::string("{ type = \"baoab\", dt = 0.05 }"))}) {
    for (const std::string& when : {times, std::string()}) {
      KeptSamples kept;
      const RunResult result = run(scene_of(chain_of(bath + when, scheme)), watched_by(kept));
      ASSERT_EQ(result.status, RunStatus::finished);
      const double heat = result.group("energy")["heat_out"].value();
      if (when.empty()) {
        EXPECT_GT(std::abs(heat), 1e-4) << scheme;
      } else {
        EXPECT_NEAR(heat, 0.0, 1e-12) << scheme;
        EXPECT_NEAR(result.group("energy")["numerical_work"].value(), 0.0, kOfScheme) << scheme;
      }
    }
  }
}

/// The bits of the run do not depend on where it was left and gone on with.
TEST(ActiveForce, GoesOnFromAnyStep) {
  const std::string links =
      "[[force]]\ntype = \"nose_hoover_chain\"\nperiod = 3.0\ntemperature = 0.01\n"
      "active = { from = 2.0, until = 10.03 }\n";
  const std::string noise =
      "[[force]]\ntype = \"langevin\"\ncoefficient = 0.5\ntemperature = 0.01\n"
      "active = { until = 10.03 }\n";
  for (const std::string& text :
       {pulled(fixed_step(0.07), active(kFrom, kUntil), "[output]\nevery = 0.21\n"),
        pulled(verlet(0.05), active(kFrom, kUntil), "[output]\nevery = 0.21\n"),
        pulled(adaptive(1e-7), active(kFrom, kUntil), "[output]\nevery = 0.21\n"),
        chain_of(links, verlet(0.1)), chain_of(noise, verlet(0.1))}) {
    SCOPED_TRACE(text);
    expect_same_from_any_step(scene_of(text), [](const RunResult&, const RunResult&) {});
  }
}

/// A driver that begins to act later finds the same slips, that much later.
TEST(ActiveForce, SlipsAreFoundOnceADriverActs) {
  constexpr double kLater = 20.0;
  constexpr double kOfSteps = 1e-9;
  const auto run_from = [](double from) {
    TipScene tip{.velocity = 0.05, .damping = 1.0, .position = 0.0, .duration = 100.0 + from};
    std::string text = tip.text();
    text.insert(text.find("[[force]]\ntype = \"viscous_damping\""),
                "active = { from = " + digits(from) + " }\n");
    return run_text(text);
  };
  const RunResult now = run_from(0.0);
  const RunResult later = run_from(kLater);
  EXPECT_GT(now.group("events")["slips"].value(), 3.0);
  EXPECT_EQ(now.group("events")["slips"].value(), later.group("events")["slips"].value());
  EXPECT_NEAR(now.driver(0)["static_force"].value(), later.driver(0)["static_force"].value(),
              kOfSteps);
  EXPECT_NEAR(now.driver(0)["max_force"].front(), later.driver(0)["max_force"].front(), kOfSteps);
  EXPECT_NEAR(now.driver(0)["distance"].value(), later.driver(0)["distance"].value(), kOfSteps);
}

TEST(ActiveForce, StepsReturnToTheGrid) {
  const auto steps = [](double dt, const std::string& when) {
    return run_text(pulled(fixed_step(dt), when)).steps;
  };
  EXPECT_EQ(steps(0.1, active(kFrom, kUntil)), 50u);
  EXPECT_EQ(steps(0.04, active(1.01, 3.11)), 127u);  // two of 125 are cut
}

TEST(ActiveForce, AnActiveForceFromStartToEndIsTheForce) {
  const std::string always = "active = { from = 0.0 }\n";
  EXPECT_EQ(end_of(pulled(fixed_step(0.01), always)).x, end_of(pulled(fixed_step(0.01), "")).x);
}

TEST(ActiveForce, WhatCannotBeIsRefused) {
  const auto said = [](const std::string& when, const std::vector<Setting>& settings = {},
                       const std::string& more = "") {
    try {
      Engine engine(scene_of(pulled(fixed_step(0.01), when + more), settings), {});
    } catch (const InputError& error) {
      Fault fault = error.faults().at(0);
      fault.value.clear();
      fault.location = {};  // in the middle of the scene
      return brief(fault);
    }
    return std::string();
  };
  const std::string key = "force.driver.active";
  EXPECT_EQ(said(active(2.0, 2.0)), key + ".until [scene.out_of_range]");
  EXPECT_EQ(said("active = 3.0\n"), key + " [scene.wrong_type]");
  EXPECT_EQ(said("active = { form = 3.0 }\n"), key + ".form [scene.unknown_key] did you mean from");
  EXPECT_EQ(said("active = { from = -1.0 }\n"), key + ".from [scene.out_of_range]");
  const std::string damped =
      "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\nactive = { until = 1.0 }\n";
  EXPECT_EQ(said("", {{"run.dynamics", "\"overdamped\""}}, damped),
            "force.viscous_damping.active [component.unsuitable]");
  const std::string formula =
      "[[force]]\ntype = \"constant_force\"\nforce = [1.0]\ndriver = true\n"
      "active = { until = 1.0 }\n";
  EXPECT_EQ(said("", {}, formula), "force.constant_force.active [component.unsuitable]");
  EXPECT_EQ(said(active(5.0, 6.0)), key + " [component.unsuitable]");
  EXPECT_EQ(said(active(1.0, 2.0), {{"force.driver.attach", "\"each_particle\""}}),
            key + " [component.unsuitable]");
  EXPECT_EQ(said(active(1.0, 2.0),
                 {{"force.driver.reverse", "{ when = \"tip.centre_of_mass.x\", above = 1.0 }"}}),
            key + " [component.unsuitable]");
  EXPECT_EQ(said(active(1.0, 2.0),
                 {{"run.until", "{ steady = \"driver.mean_force.x\", tolerance = 1e-3 }"}}),
            key + " [component.unsuitable]");
  EXPECT_EQ(said(active(1.0, 2.0), {{"run.dynamics", "\"quasistatic\""}}),
            key + " [component.unsuitable]");
}

}  // namespace
}  // namespace tomlin::test
