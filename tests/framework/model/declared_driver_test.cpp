// Forces of any kind that a scene declares to be drivers.

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "framework/model/model.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

namespace tomlin::test {
namespace {

// Prandtl and Tomlinson's tip, in stick-slip, with a driver to be filled in.
std::string tip_with(const std::string& driver, const std::string& run) {
  return tables(R"(
[parameters] | k = 1.0 | v = 0.05
[[body]] | name = "tip" | type = "point" | position = [0.25] | particle_mass = 1.0
[[force]] | type = "viscous_damping" | coefficient = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
)") + driver +
         "[run]\nduration = 100.0\nledger = true\n" + run +
         "[measure]\nfrom = 2\nto = 5\nin = \"driver_periods\"\n";
}

constexpr const char* kDrivingSpring =
    "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = \"k\"\nvelocity = "
    "[\"v\"]\n";
constexpr const char* kFormulaOfSpring =
    "[[force]]\nname = \"driver\"\ntype = \"expression\"\nenergy = \"k/2 * (xc - 0.25 - v*t)^2\"\n"
    "driver = true\n";

const std::string kRk4 = "integrator = { type = \"rk4\", dt = 0.01 }\n";

// Two formulas of the same spring may differ by this after some thousand steps of a stable motion.
constexpr double kSame = 1e-9;

void expect_same_driver(const std::string& run) {
  const RunResult spring = run_text(tip_with(kDrivingSpring, run));
  const RunResult formula = run_text(tip_with(kFormulaOfSpring, run));
  for (const char* path :
       {"driver.mean_force.x", "driver.max_force.x", "driver.min_force.x", "driver.work",
        "driver.distance", "driver.work_per_distance", "driver.static_force", "events.slips",
        "energy.work_in", "energy.heat_out", "energy.potential"}) {
    const auto expected = observable(spring, path);
    const auto found = observable(formula, path);
    ASSERT_TRUE(expected && found) << path;
    EXPECT_NE(*expected, 0.0) << path;
    EXPECT_NEAR(*found, *expected, kSame * std::abs(*expected)) << path;
  }
  const double change = observable(spring, "energy.stored_change").value();
  EXPECT_NEAR(observable(formula, "energy.stored_change").value(), change, kSame);
  EXPECT_GE(observable(spring, "events.slips").value(), 2.0);
}

TEST(DeclaredDriver, AFormulaOfASpringIsADrivingSpring) { expect_same_driver(kRk4); }

TEST(DeclaredDriver, InEverySchemeAndDynamics) {
  expect_same_driver("integrator = { type = \"velocity_verlet\", dt = 0.01 }\n");
  expect_same_driver(
      "integrator = { type = \"dopri5\", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 "
      "}\n");
  expect_same_driver("dynamics = \"overdamped\"\n" + kRk4);
}

const std::string kFalling = tables(R"(
[[body]] | name = "ring" | type = "ring" | count = 5 | radius = 1.0 | centre = [0.0, 0.0]
particle_mass = 0.2 | coordinates = COORDINATES | velocity = [0.3, 0.1]
[[force]] | name = "pull" | type = "constant_force" | force = [0.02, -0.01] | driver = true
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 10.0
[run] | duration = 4.0 | ledger = true | integrator = INTEGRATOR
)");

std::string falling(const std::string& coordinates, const std::string& integrator) {
  std::string text = kFalling;
  text.replace(text.find("COORDINATES"), 11, coordinates);
  text.replace(text.find("INTEGRATOR"), 10, integrator);
  return text;
}

// A body of mass 1 under F = (0.1, -0.05): x = v t + F t^2/2, and the work F.x all goes into it.
TEST(DeclaredDriver, AConstantForceDoesItsWork) {
  for (const char* coordinates : {"\"particles\"", "\"rigid\""}) {
    for (const char* integrator :
         {"{ type = \"rk4\", dt = 0.01 }", "{ type = \"dopri5\", relative_tolerance = 1e-10 }"}) {
      const RunResult result = run_text(falling(coordinates, integrator));
      const double x = 0.3 * 4 + 0.5 * 0.1 * 16;
      const double y = 0.1 * 4 - 0.5 * 0.05 * 16;
      const double work = 0.1 * x - 0.05 * y;
      const double rounding = 1e-12;
      EXPECT_NEAR(observable(result, "pull.mean_force.x").value(), 0.1, rounding) << integrator;
      EXPECT_NEAR(observable(result, "pull.mean_force.y").value(), -0.05, rounding);
      EXPECT_NEAR(observable(result, "pull.work").value(), work, rounding)
          << coordinates << integrator;
      EXPECT_NEAR(observable(result, "energy.work_in").value(), work, rounding);
      EXPECT_NEAR(observable(result, "energy.numerical_work").value(), 0.0, rounding);
      EXPECT_FALSE(observable(result, "pull.distance"));  // there is no support that moves
    }
  }
}

// Their forces are evaluated at velocities of half a step before.
TEST(DeclaredDriver, SchemesThatWouldFallToFirstOrderInItsWorkRefuseIt) {
  for (const char* integrator :
       {"{ type = \"velocity_verlet\", dt = 0.01 }", "{ type = \"blanes_moan\", dt = 0.01 }"}) {
    try {
      run_text(falling("\"particles\"", integrator));
      ADD_FAILURE() << integrator;
    } catch (const InputError& error) {
      EXPECT_EQ(error.faults().front().code, FaultCode::integrator_order_reduction) << integrator;
    }
  }
}

TEST(DeclaredDriver, ASupportThatSwingsIsNotSteady) {
  const RunResult result = run_text(tables(R"(
[[body]] | type = "point" | position = [0.0] | particle_mass = 1.0
[[force]] | name = "driver" | type = "expression" | energy = "0.5 * (x - 0.3 * sin(0.7*t))^2"
driver = true
[run] | duration = 20.0 | ledger = true | integrator = { type = "rk4", dt = 0.01 }
)"));
  EXPECT_FALSE(observable(result, "driver.distance"));
  EXPECT_NE(observable(result, "driver.work").value(), 0.0);
  EXPECT_NEAR(observable(result, "energy.numerical_work").value(), 0.0, 1e-9);
}

void expect_refused(const std::string& force, const char* dynamics = "\"inertial\"") {
  const std::string text = tables(R"(
[[body]] | type = "chain" | count = 3 | spacing = 1.0 | particle_mass = 1.0
[[force]] | driver = true
)") + force +
                           "[run]\nduration = 1.0\ndynamics = " + dynamics +
                           "\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
  try {
    run_text(text);
    ADD_FAILURE() << force;
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().front().code, FaultCode::component_unsuitable) << force;
  }
}

/// Whatever its period: neither one that divides the run nor one far below it looks steady.
TEST(DeclaredDriver, ASupportWhosePeriodDividesTheRunIsNotSteady) {
  for (const char* period : {"1", "10", "100", "7.3", "0.01"}) {
    const std::string swings =
        "[[force]]\nname = \"driver\"\ntype = \"expression\"\nenergy = "
        "\"(x - 0.05*t - 0.3*sin(2*pi*t/" +
        std::string(period) + "))^2\"\ndriver = true\n";
    std::string text = tip_with(swings, kRk4);
    text.erase(text.find("[measure]"));
    const auto scene = scene_of(text);
    const Model model(scene);
    ASSERT_EQ(model.drivers().size(), 1U);
    EXPECT_FALSE(model.drivers()[0].drive->steady) << period;
  }
}

/// A formula of the centre of mass takes hold there, also where the masses differ.
TEST(DeclaredDriver, TheSupportIsWhereTheFormulaHasIt) {
  for (const char* coordinates : {"particles", "rigid"}) {
    for (const auto& [variable, wanted] : {std::pair{"xc", 5.0}, {"x", 5.0}}) {
      const auto scene = scene_of(
          tables(R"([[body]] | name = "pair" | type = "particles"
positions = [[0.0, 0.0], [1.0, 0.0]] | particle_mass = [1.0, 3.0] | coordinates = ")") +
          std::string(coordinates) +
          "\"\n[[force]]\nname = \"pull\"\ntype = \"expression\"\ndriver = true\nenergy = \"(" +
          variable + " - 5 - 0.1*t)^2\"\n[run]\nduration = 1.0\nintegrator = " + fixed_step(1e-2) +
          "\n");
      const Model model(scene);
      EXPECT_NEAR(model.drivers()[0].drive->start[0], wanted, kSame) << coordinates << variable;
    }
  }
}

TEST(DeclaredDriver, WhatDrivesNothingIsRefused) {
  expect_refused("type = \"viscous_damping\"\ncoefficient = 1.0\n");
  expect_refused("type = \"memory_damping\"\ncoefficient = 1.0\nmemory_time = 1.0\n");
  expect_refused("type = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1.0\n");
}

// A spring along x that leaves y free, against a formula of the same.
TEST(DrivingSpring, LeavesFreeWhereItHasNoStiffness) {
  const auto scene = [](const std::string& stiffness) {
    return tables(R"(
[[body]] | type = "point" | position = [0.0, 0.0] | velocity = [0.0, 0.2] | particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | velocity = [0.1, 0.0]
)") + stiffness +
           "[run]\nduration = 5.0\nledger = true\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
  };
  for (const char* stiffness : {"stiffness = [2.0, 0.0]\n", "stiffness = 2.0\naxes = [\"x\"]\n",
                                "stiffness = [2.0, 7.0]\naxes = [\"x\"]\n"}) {
    const RunResult result = run_text(scene(stiffness));
    const double w = std::sqrt(2.0);
    constexpr double kOrderFour = 1e-8;
    EXPECT_NEAR(observable(result, "point.centre_of_mass.y").value(), 1.0, 1e-13) << stiffness;
    EXPECT_NEAR(observable(result, "point.centre_of_mass.x").value(),
                0.1 * (5.0 - std::sin(5.0 * w) / w), kOrderFour);
    EXPECT_NEAR(observable(result, "energy.numerical_work").value(), 0.0, kOrderFour);
  }
  // Two frequencies.
  const RunResult both = run_text(scene("stiffness = [2.0, 8.0]\n"));
  EXPECT_NEAR(observable(both, "point.centre_of_mass.y").value(),
              0.2 * std::sin(5.0 * std::sqrt(8.0)) / std::sqrt(8.0), 1e-8);
  for (const char* wrong :
       {"stiffness = [0.0, 0.0]\n", "stiffness = 0.0\n", "stiffness = [1.0, 1.0, 1.0]\n",
        "stiffness = 1.0\naxes = [\"z\"]\n", "stiffness = [0.0, 1.0]\naxes = [\"x\"]\n",
        "stiffness = [-1.0, 1.0]\n"}) {
    EXPECT_THROW(scene_of(scene(wrong)), InputError) << wrong;
  }
}

}  // namespace
}  // namespace tomlin::test
