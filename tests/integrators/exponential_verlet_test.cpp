#include "integrators/exponential_verlet.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "integrators/modal_flow.hpp"
#include "tests/support/order.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/ring_scenes.hpp"

// Bonds and friction as an operator: exact alone, of second order with the rest, and no limit to
// the step however stiff.

namespace tomlin::test {
namespace {

constexpr Window kSecond{1.9, 2.15};

std::string scheme(double dt) { return held_to("exponential_verlet", dt); }

// ---- one mode

/// Exact at any frequency, friction and step: two steps of h are one of 2 h, and short ones add up.
TEST(ModeFlow, IsAFlow) {
  constexpr double kRounding = 2e-14;
  for (const double square : {0.0, 1e-8, 1.0, 0.25, 1e6, 1e12}) {
    for (const double rate : {0.0, 1e-6, 1.0, 2.0, 1e3, 1e8}) {
      for (const double h : {1e-3, 0.3}) {
        SCOPED_TRACE(digits(square) + ", " + digits(rate) + ", " + digits(h));
        const ModeFlow once = mode_flow(square, rate, h);
        const ModeFlow twice = mode_flow(square, rate, 2.0 * h);
        // Phases of many turns round in proportion to them.
        const double size = kRounding * (1.0 + std::sqrt(square) * h);
        const double b_size = std::abs(once.b) + 1e-300;
        EXPECT_NEAR(twice.a, once.a * once.a + once.b * once.c, size);
        EXPECT_NEAR(twice.d, once.d * once.d + once.b * once.c, size);
        EXPECT_NEAR(twice.b / b_size, (once.a + once.d) * once.b / b_size, 10.0 * size);
        EXPECT_LE(std::abs(once.filter), 1.0);
      }
    }
  }
}

TEST(ModeFlow, IsTheMotionOfADampedOscillator) {
  const Oscillator o{.m = 1.0, .k = 2.1, .c = 0.4, .pull = 0.0, .x0 = 0.7, .v0 = -0.2};
  for (const double h : {1e-4, 0.1, 6.4}) {
    const ModeFlow flow = mode_flow(o.k, o.c, h);
    EXPECT_NEAR(flow.a * o.x0 + flow.b * o.v0, o.at(h).x, 1e-15);
    EXPECT_NEAR(flow.c * o.x0 + flow.d * o.v0, o.at(h).v, 2e-15);
  }
}

// ---- chains

std::string chain(double stiffness, const std::string& integrator, double spacing = 1.1) {
  return tables(R"([[body]] | type = "chain" | count = 6 | spacing = )") + digits(spacing) +
         tables(R"(
particle_mass = 1.0 | velocity = [[0.3], [0.1], [-0.2], [0.0], [0.4], [0.1]]
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | rest_lengths = 1.0 | stiffness = )") +
         digits(stiffness) + tables(R"(
[[force]] | type = "viscous_damping" | coefficient = 0.3
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [0.4]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.05 | period = 1.0
[run] | duration = 4.0 | integrator = )") +
         integrator + "\n";
}

std::string bonds_alone(double stiffness, const std::string& integrator) {
  std::string text = chain(stiffness, integrator);
  const auto from = text.find("[[force]]\nname = \"driver\"");
  return text.erase(from, text.find("[run]") - from);
}

std::vector<double> positions(const std::string& text) {
  Engine engine(scene_of(text), {});
  engine.run();
  const SystemView<double>& view = engine.model().system().view;
  std::vector<double> all(view.position, view.position + view.coordinates);
  all.insert(all.end(), view.velocity, view.velocity + view.coordinates);
  return all;
}

/// A stretched chain that swings and dies down: nothing but the operator, exact at any step.
TEST(ExponentialChain, BondsAndFrictionAloneAreExact) {
  constexpr double kRounding = 1e-11;
  const std::vector<double> exact = positions(bonds_alone(30.0, adaptive(1e-14, "dop853")));
  for (const double h : {0.01, 0.5, 4.0}) {
    EXPECT_LT(largest_difference(positions(bonds_alone(30.0, scheme(h))), exact), kRounding) << h;
  }
}

/// Heat is that of the flow, and not of velocities at the steps' ends.
TEST(ExponentialChain, HeatOfBondsAndFrictionAloneIsExact) {
  constexpr double kRounding = 1e-10;
  const auto heat = [](const std::string& integrator) {
    return *run_text(bonds_alone(30.0, integrator), {{"run.ledger", "true"}})
                .group("energy")["heat_out"];
  };
  const double exact = heat(adaptive(1e-13, "dop853"));
  EXPECT_GT(exact, 0.1);
  for (const double h : {0.01, 0.5, 4.0}) EXPECT_NEAR(heat(scheme(h)), exact, kRounding) << h;
}

/// A hundred times the friction that stops a motion within a step.
TEST(ExponentialChain, StrongFrictionDragsAtTheTerminalSpeed) {
  const std::vector<Setting> strong = {{"force.viscous_damping.coefficient", "2000.0"},
                                       {"run.ledger", "true"},
                                       {"run.duration", "400.0"}};
  const RunResult exact = run_text(chain(10.0, adaptive(1e-10, "radau9"), 1.0), strong);
  const RunResult found = run_text(chain(10.0, scheme(0.05), 1.0), strong);
  constexpr double kStepError = 2e-3;  // of first order in step * stiffness / friction
  const auto near = [&](double a, double b) { EXPECT_NEAR(a, b, kStepError * std::abs(b)); };
  near(found.body(0)["velocity"][0], exact.body(0)["velocity"][0]);
  near(found.driver(0)["mean_force"][0], exact.driver(0)["mean_force"][0]);
  near(*found.group("energy")["heat_out"], *exact.group("energy")["heat_out"]);
}

/// Between the ends of a step in which friction has stopped a motion: no cubic follows that.
TEST(ExponentialVerlet, DenseOutputFollowsMotionsThatStopWithinAStep) {
  Oscillator o;
  o.k = o.pull = 0.0;
  o.v0 = 1.0;
  o.duration = 1.0;
  for (const double damped : {0.9, 1.1, 30.0, 1e4}) {
    o.c = damped * o.m / 0.25;
    KeptSamples samples;
    run_text(o.scene(scheme(0.25), "[output]\nevery = 0.03125\n"), {}, watched_by(samples));
    ASSERT_EQ(samples.rows.size(), 33u);
    const double rate = o.c / o.m;
    // A cubic's error where it is one.
    const double allowed = damped < 1.0 ? 2e-3 : 1e-12;
    for (const auto& row : samples.rows) {
      const double x = row[samples.column("tip.centre_of_mass.x")];
      EXPECT_NEAR(x, o.at(row[0]).x, allowed / rate) << row[0] << ", " << damped;
    }
  }
}

TEST(ExponentialChain, IsOfSecondOrder) {
  const RunResult exact = run_text(chain(10.0, adaptive(1e-13, "dop853")));
  std::vector<double> steps, errors, means;
  for (double h = 0.05; h > 0.005; h *= 0.5) {
    const RunResult result = run_text(chain(10.0, scheme(h)));
    steps.push_back(h);
    errors.push_back(
        std::abs(result.body(0)["centre_of_mass"][0] - exact.body(0)["centre_of_mass"][0]));
    means.push_back(std::abs(result.driver(0)["mean_force"][0] - exact.driver(0)["mean_force"][0]));
  }
  EXPECT_TRUE(kSecond.holds(fitted_order(steps, errors))) << fitted_order(steps, errors);
  EXPECT_TRUE(kSecond.holds(fitted_order(steps, means))) << fitted_order(steps, means);
}

/// Steps many times those that bonds allow others, without a resonance.
TEST(ExponentialChain, StiffBondsLimitNoStep) {
  std::vector<double> ends;
  for (const double stiffness : {1e6, 1e8, 1e10}) {
    const RunResult result = run_text(chain(stiffness, scheme(0.01), 1.0));
    ASSERT_EQ(result.status, RunStatus::finished);
    ends.push_back(result.body(0)["centre_of_mass"][0]);
  }
  EXPECT_NEAR(ends[1], ends[2], 1e-7);
  EXPECT_NE(refusal(chain(1e10, verlet(0.01))) +
                run_text(chain(1e10, verlet(0.01))).failure.value_or(RunFailure{}).what,
            "")
      << "velocity Verlet is refused there";
}

// ---- rings

RingScene ring(double bonds, const std::string& integrator) {
  return {.coordinates = "particles",
          .bonds = bonds,
          .velocity = 0.6,
          .duration = 4.0,
          .integrator = integrator};
}

std::vector<double> numbers_of(const RunResult& result) {
  const ResultGroup& body = result.body(0);
  return {body["centre_of_mass"][0], body["centre_of_mass"][1], *body["rotation"],
          body["velocity"][0], result.driver(0)["mean_force"][0]};
}

TEST(ExponentialRing, IsOfSecondOrder) {
  const std::vector<double> exact =
      numbers_of(run_text(ring(40.0, adaptive(1e-13, "dop853")).text()));
  std::vector<double> steps, errors;
  for (double h = 0.02; h > 0.002; h *= 0.5) {
    steps.push_back(h);
    errors.push_back(largest_difference(numbers_of(run_text(ring(40.0, scheme(h)).text())), exact));
  }
  EXPECT_TRUE(kSecond.holds(fitted_order(steps, errors))) << fitted_order(steps, errors);
}

/// At the steps of the rigid ring the flexible one is it, to the error of the step.
TEST(ExponentialRing, GoesToTheRigidOne) {
  constexpr double kStepError = 1e-4;  // of second order at this speed and step
  RingScene rigid = ring(0.0, adaptive(1e-12));
  rigid.coordinates = "rigid";
  rigid.bonds = 1.0;
  const std::vector<double> exact = numbers_of(run_text(rigid.text()));
  std::vector<double> last;
  for (const double bonds : {1e6, 1e8, 1e10}) {
    const RunResult result = run_text(ring(bonds, scheme(0.01)).text());
    ASSERT_EQ(result.status, RunStatus::finished);
    EXPECT_EQ(result.force_evaluations, result.steps + 1);
    const std::vector<double> found = numbers_of(result);
    EXPECT_LT(largest_difference(found, exact), kStepError) << bonds;
    if (!last.empty()) {
      EXPECT_LT(largest_difference(found, last), 1e-6) << bonds;
    }
    last = found;
  }
}

// ---- refusals

const std::string kUnsuitable =
    "run.integrator.type = \"exponential_verlet\" [integrator.unsuitable]";

TEST(ExponentialRefuses, RigidBodiesAndFrictionOutOfProportion) {
  RingScene rigid = ring(1.0, scheme(0.01));
  rigid.coordinates = "rigid";
  EXPECT_EQ(brief_refusal(rigid.text()), "28:14 " + kUnsuitable);
  EXPECT_NE(refusal(rigid.text()).find("\"ring\""), std::string::npos);
  std::string uneven = chain(10.0, scheme(0.01));
  const std::string mass = "particle_mass = 1.0";
  uneven.replace(uneven.find(mass), mass.size(), "particle_mass = [1.0, 2.0, 1.0, 1.0, 1.0, 1.0]");
  EXPECT_EQ(brief_refusal(uneven), "26:14 " + kUnsuitable);
  EXPECT_NE(refusal(uneven).find("\"chain\""), std::string::npos) << refusal(uneven);
}

TEST(ExponentialRefuses, BodiesOfTooManyCoordinates) {
  std::string large = chain(10.0, scheme(0.01));
  const std::string count = "count = 6";
  large.replace(large.find(count), count.size(), "count = 257");
  const auto from = large.find("velocity = [[");
  large.erase(from, large.find('\n', from) + 1 - from);
  EXPECT_EQ(brief_refusal(large), "25:14 " + kUnsuitable);
  EXPECT_NE(refusal(large).find("256"), std::string::npos) << refusal(large);
}

}  // namespace
}  // namespace tomlin::test
