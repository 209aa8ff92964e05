#include "integrators/velocity_verlet.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/order.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/pendulum.hpp"
#include "tests/support/quadratic_drag.hpp"
#include "tests/support/ring_scenes.hpp"

// Properties of velocity Verlet beyond its order for one particle (order_test.cpp): friction as an
// exact flow, second order for every kind of body, energy that does not drift, and refusals where
// it would be silently wrong.

namespace tomlin::test {
namespace {

constexpr Window kOrder{1.9, 2.1};

// ---- friction

/// Free flight with friction is the flow itself: velocities and heat are exact at any c dt / m,
/// however many steps. Positions are not where friction stops the flight within a step, and so it
/// is refused there unless insisted on.
TEST(Friction, FreeFlightKeepsTheExactVelocity) {
  constexpr double kDt = 0.5;
  constexpr int kSteps = 12;
  for (const double rate : {1e-6, 0.1, 2.0, 40.0}) {
    const Oscillator o{.m = 1.3, .k = 0.0, .c = 1.3 * rate, .v0 = 0.7, .duration = kSteps * kDt};
    EXPECT_EQ(run_text(o.scene(verlet(kDt))).status == RunStatus::failed, rate > 30.0) << rate;
    const RunResult result =
        run_text(o.scene(verlet(kDt)), {{"run.allow_unstable", "true"}, {"run.ledger", "true"}});
    const double v = result.body(0)["velocity"][0];
    const double exact = o.at(o.duration).v;
    // Each half step rounds exponent and product; the exponent's error grows with its size.
    const double rounding = 2.0 * kSteps * (2.0 + 0.5 * rate * kDt) * 1.2e-16;
    EXPECT_NEAR(v, exact, rounding * std::abs(exact)) << rate;
    const double lost = 0.5 * o.m * (o.v0 * o.v0 - v * v);
    EXPECT_NEAR(*result.group("energy")["heat_out"], lost, 1e-15) << rate;
  }
}

/// A friction far faster than the step: the scheme stays bounded up to h omega = 2, where an
/// explicit kick with the friction of the old velocity grows by (c dt / m) a step. Not accurate
/// there, and so refused unless insisted on.
TEST(Friction, StableHoweverStrong) {
  for (const double rate : {1.0, 30.0, 1e3, 1e6}) {
    const double omega = 1.1;
    const Oscillator o{.m = 1.0,
                       .k = omega * omega,
                       .c = rate,
                       .pull = 0.0,
                       .x0 = 1.0,
                       .v0 = 0.0,
                       .duration = 400.0};
    for (const double h_omega : {0.5, 1.9}) {
      const RunResult result =
          run_text(o.scene(verlet(h_omega / omega)), {{"run.allow_unstable", "true"}});
      ASSERT_EQ(result.status, RunStatus::finished) << rate;
      EXPECT_LE(std::abs(result.body(0)["centre_of_mass"][0]), 1.0) << rate << ", " << h_omega;
    }
    EXPECT_EQ(run_text(o.scene(verlet(2.1 / omega))).status, RunStatus::failed)
        << "the stability limit is refused";
  }
}

/// The drag error of the record is that of the scheme: the speed under a steady force.
TEST(Friction, DragIsOffByWhatTheRecordSays) {
  constexpr double kRounding = 1e-10;  // of positions, over the window
  const auto drag_error = standard().integrator("velocity_verlet")->drag_error;
  for (const double damped : {0.01, 0.25, 1.0, 5.0}) {  // whole steps in the window
    const std::string text =
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
        "[[force]]\ntype = \"constant_force\"\nforce = [1.0]\n"
        "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"
        "[run]\nduration = 1e4\nallow_unstable = true\nintegrator = " +
        verlet(damped) + "\n[measure]\nfrom = 5e3\nto = 1e4\nin = \"time\"\n";
    const RunResult result = run_text(text);
    ASSERT_EQ(result.status, RunStatus::finished) << damped;
    const double speed = result.body(0)["mean_velocity"][0];
    EXPECT_NEAR(speed, 1.0 + drag_error(damped), kRounding * speed) << damped;
    const std::vector<std::string> drag = {"run.integrator.dt [integrator.weak_drag]"};
    EXPECT_EQ(briefs(result.warnings), damped < 0.5 ? std::vector<std::string>{} : drag) << damped;
  }
}

// ---- order, for every kind of body

struct System {
  std::string what;
  std::function<std::string(const std::string& integrator)> text;
  double longest;  ///< step
};

/// Three particles of a rigid body with unequal masses and equal friction: not centred alike.
std::string lopsided(const std::string& integrator) {
  return tables(R"([[body]] | name = "ring" | type = "ring" | count = 5 | radius = 0.8
particle_mass = [0.1, 0.7, 0.3, 0.2, 0.4] | centre = [0.1, 0.8]
velocity = [[0.3, 0.0], [0.1, 0.2], [0.0, -0.4], [0.2, 0.1], [0.5, 0.3]] | coordinates = "rigid"
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.6, 0.1]
[[force]] | type = "viscous_damping" | coefficient = 0.35
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.05 | period = 1.0 | decay = 0.4
[run] | duration = 4.0 | integrator = )") +
         integrator + "\n";
}

/// A flexible ring, bonded to a tip, next to a rigid ring.
std::string several(const std::string& integrator) {
  return tables(R"([[body]] | name = "soft" | type = "ring" | count = 4 | radius = 0.5
particle_mass = 0.25 | centre = [0.1, 0.6]
[[body]] | name = "tip" | type = "point" | position = [0.2, 1.7] | particle_mass = 0.5
velocity = [0.3, 0.0]
[[body]] | name = "stiff" | type = "ring" | count = 6 | radius = 0.7 | particle_mass = 0.2
centre = [3.1, 0.7] | coordinates = "rigid"
[[force]] | name = "inside" | type = "harmonic_bonds" | body = "soft" | pairs = "all"
stiffness = 6.0
[[force]] | name = "between" | type = "harmonic_bonds" | bodies = ["soft", "tip"]
pairs = "all" | stiffness = 1.5
[[force]] | name = "pull" | type = "driving_spring" | body = "stiff" | stiffness = 1.0
velocity = [0.5, 0.0]
[[force]] | name = "drag_soft" | type = "viscous_damping" | body = "soft" | coefficient = 0.2
[[force]] | name = "drag_tip" | type = "viscous_damping" | body = "tip" | coefficient = 0.3
[[force]] | name = "drag_stiff" | type = "viscous_damping" | body = "stiff" | coefficient = 0.1
[[force]] | name = "under_soft" | type = "sinusoidal_substrate" | body = "soft"
amplitude = 0.02 | period = 1.0 | decay = 0.5
[[force]] | name = "under_stiff" | type = "sinusoidal_substrate" | body = "stiff"
amplitude = 0.03 | period = 1.0 | decay = 0.5
[run] | duration = 4.0 | integrator = )") +
         integrator + "\n";
}

std::vector<System> systems() {
  const auto ring = [](const std::string& coordinates) {
    return [coordinates](const std::string& integrator) {
      return RingScene{.coordinates = coordinates,
                       .bonds = 40.0,
                       .velocity = 0.6,
                       .duration = 4.0,
                       .integrator = integrator}
          .text();
    };
  };
  return {{"flexible ring", ring("particles"), 0.01},
          {"rigid ring", ring("rigid"), 0.04},
          {"rigid ring, friction beside the centre of mass", lopsided, 0.04},
          {"several bodies", several, 0.04}};
}

std::vector<double> numbers_of(const RunResult& result) {
  std::vector<double> all;
  for (const ResultGroup& body : result.family("bodies")) {
    all.insert(all.end(), body["centre_of_mass"].begin(), body["centre_of_mass"].end());
    all.insert(all.end(), body["velocity"].begin(), body["velocity"].end());
    if (body["rotation"]) all.push_back(*body["rotation"]);
  }
  for (const ResultGroup& driver : result.family("drivers")) {
    all.insert(all.end(), driver["mean_force"].begin(), driver["mean_force"].end());
    all.push_back(*driver["work"]);
  }
  return all;
}

TEST(VerletOrder, OfEveryKindOfBody) {
  for (const System& system : systems()) {
    const auto exact = numbers_of(run_text(system.text(adaptive(1e-12))));
    std::vector<double> steps;
    std::vector<double> errors;
    for (double h = system.longest; h > system.longest / 10.0; h *= 0.5) {
      const RunResult result = run_text(system.text(verlet(h)));
      ASSERT_EQ(result.status, RunStatus::finished) << system.what;
      steps.push_back(h);
      errors.push_back(largest_difference(numbers_of(result), exact));
    }
    const double order = fitted_order(steps, errors);
    EXPECT_TRUE(kOrder.holds(order)) << system.what << ": " << order;
    EXPECT_GT(errors.back(), 1e-9) << system.what << ": the reference is no better";
  }
}

// ---- energy

/// An anharmonic oscillator over 1e5 of its periods: the energy swings by O(h^2) and comes back.
TEST(VerletEnergy, StaysBoundedOverAHundredThousandPeriods) {
  constexpr double kDt = 0.2;  // some 30 steps a period
  constexpr std::uint64_t kSteps = 3'000'000;
  const Swings swings(verlet(kDt), kSteps);
  EXPECT_GT(swings.early, 1e-5) << "nothing to see";
  EXPECT_NEAR(swings.late / swings.early, 1.0, 0.02) << "a drift";

  Engine rk4(scene_of(pendulum(fixed_step(kDt))), {});
  rk4.advance(kSteps);
  EXPECT_GT(std::abs(energy_of(rk4) - swings.start), 10.0 * swings.late) << "the test sees a drift";
}

TEST(VerletEnergy, SwingsWithTheSquareOfTheStep) {
  const double order = power_of_swings("velocity_verlet", 0.2, 0.02);
  EXPECT_TRUE(kOrder.holds(order)) << order;
}

/// Symmetric: with velocities turned round, a run without friction goes back where it came from.
TEST(VerletEnergy, ARunCanBeRetraced) {
  const auto scene = [](double x, double v) {
    return TipScene{.velocity = 0.0,
                    .damping = 0.0,
                    .amplitude = 0.4,
                    .position = x,
                    .start_velocity = v,
                    .duration = 40.0,
                    .integrator = verlet(0.05)};
  };
  // The spring's end stays where it is on both ways.
  const auto at_rest = [](const TipScene& tip) {
    std::string text = tip.text();
    const std::string key = "velocity = [0]\n[[force]]\ntype = \"viscous";
    const auto found = text.find(key);
    EXPECT_NE(found, std::string::npos);
    return text.insert(found, "start = [0.0]\n");
  };
  const RunResult there = run_text(at_rest(scene(0.3, 0.2)));
  const RunResult back =
      run_text(at_rest(scene(there.body(0)["centre_of_mass"][0], -there.body(0)["velocity"][0])));
  constexpr double kRounding = 1e-10;  // 1600 steps
  EXPECT_NEAR(back.body(0)["centre_of_mass"][0], 0.3, kRounding);
  EXPECT_NEAR(back.body(0)["velocity"][0], -0.2, kRounding);
}

// ---- refusals

TEST(VerletRefuses, ForcesThatDependOnVelocityOtherwise) {
  const std::string text = with_drag("integrator = " + verlet(0.1));
  EXPECT_EQ(brief_refusal(text, drag_registry()),
            "11:14 run.integrator.type = \"velocity_verlet\" [integrator.order_reduction]");
  EXPECT_NE(refusal(text, drag_registry()).find("\"wind\""), std::string::npos);
  EXPECT_EQ(refusal(with_drag("integrator = " + fixed_step(0.1)), drag_registry()), "")
      << "rk4 takes it";
}

TEST(VerletRefuses, DynamicsWithoutInertia) {
  const TipScene tip{.integrator = verlet(0.01), .more = "dynamics = \"overdamped\"\n"};
  EXPECT_EQ(brief_refusal(tip.text()),
            "21:14 run.integrator.type = \"velocity_verlet\" [integrator.unsuitable]");
}

}  // namespace
}  // namespace tomlin::test
