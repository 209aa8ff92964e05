#include "framework/run/window/time_scale.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

// Forces that depend on time, against the steps of every scheme: a fixed one that does not resolve
// them is warned of, an adaptive one resolves them.

namespace tomlin::test {
namespace {

std::string tip(const std::string& forces, const std::string& integrator,
                const std::string& dynamics = "inertial") {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.4]
particle_mass = 1.0
)") + forces +
         tables(R"([[force]] | type = "viscous_damping" | coefficient = 0.3
[run] | duration = 5.0 | dynamics = ")") +
         dynamics + "\"\nintegrator = " + integrator + "\n";
}

std::string formula(const std::string& energy) {
  return "[[force]]\nname = \"shake\"\ntype = \"expression\"\nenergy = \"" + energy + "\"\n";
}

using Keys = std::vector<std::string>;

/// Returns the keys whose change with time the steps do not resolve.
Keys unresolved(const RunResult& result) {
  Keys keys;
  for (const Warning& warning : result.warnings) {
    if (warning.code == FaultCode::integrator_unresolved_time) keys.push_back(warning.key);
  }
  return keys;
}

TEST(TimeScale, EveryFixedStepIsHeldAgainstFormulasOfTime) {
  for (const auto& scheme : standard().integrators()) {
    if (scheme->follows_equilibria || scheme->adaptive || scheme->conservative_only) continue;
    if (!scheme->with_inertia) continue;  // the tip has some
    SCOPED_TRACE(scheme->name);
    const auto warned = [&](const std::string& energy, double dt) {
      const auto keys = unresolved(run_text(tip(formula(energy), held_to(scheme->name, dt))));
      EXPECT_TRUE(keys.empty() || keys == Keys{"force.shake"});
      return !keys.empty();
    };
    EXPECT_TRUE(warned("0.1*cos(2*pi*x) + 5*sin(1000*t)*x", 0.01));
    EXPECT_TRUE(warned("5*sin(1000*t)*x", 0.01));
    EXPECT_TRUE(warned("0.1*cos(2*pi*(x - 50*t))", 0.02)) << "a wave, a period a step";
    EXPECT_TRUE(warned("0.1*(1 + sin(900*t))*cos(2*pi*(x - 0.4))", 0.01))
        << "no force at the start";
    EXPECT_TRUE(warned("-exp(-((t - 3.003) / 0.001)^2)*x", 0.01)) << "a pulse";
    // A step a twentieth of these.
    EXPECT_FALSE(warned("5*sin(1000*t)*x", 5e-5));
    EXPECT_FALSE(warned("0.1*cos(2*pi*x) + 5*sin(3*t)*x", 0.01));
    EXPECT_FALSE(warned("-exp(-((t - 3.003) / 0.1)^2)*x", 0.01));
    EXPECT_FALSE(warned("0.1*t*x", 0.01));
    EXPECT_FALSE(warned("(x - 0.2*t)^2", 0.01));
  }
}

TEST(TimeScale, DriversOfSteadyVelocityHaveNone) {
  Engine engine(scene_of(tip("[[force]]\ntype = \"driving_spring\"\nstiffness = 1.0\n"
                             "velocity = [0.1]\n",
                             fixed_step(0.01))),
                {});
  EXPECT_TRUE(time_dependences(engine.model()).empty());
}

TEST(TimeScale, PrescribedMotionsAreNamed) {
  const auto named = [](const std::string& motion) {
    return unresolved(run_text(
        "[[body]]\nname = \"stage\"\ntype = \"ring\"\nradius = 1.0\ncount = 4\n"
        "particle_mass = 1.0\ncentre = [0.0, 0.0]\ncoordinates = \"prescribed\"\nmotion = " +
        motion + "\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.5\n" +
        "[run]\nduration = 2.0\nintegrator = " + fixed_step(0.01) + "\n"));
  };
  EXPECT_EQ(named("{ velocity = [\"sin(1000*t)\", 0.0] }"), Keys{"body.stage.motion.velocity"});
  EXPECT_EQ(named("{ velocity = [0.0, 0.0], angular_velocity = \"sin(1000*t)\" }"),
            Keys{"body.stage.motion.angular_velocity"});
  EXPECT_EQ(named("{ velocity = [\"sin(10*t)\", 0.0] }"), Keys{});
}

/// A pulse while nothing else happens: steps grow, and would go over it.
TEST(TimeScale, AdaptiveSchemesSeePulses) {
  for (const auto& scheme : standard().integrators()) {
    if (scheme->follows_equilibria || !scheme->adaptive) continue;
    SCOPED_TRACE(scheme->name);
    const double width = 0.002;
    const RunResult result =
        run_text(tip(formula("-exp(-((t - 3.0) / 0.002)^2)*x"), adaptive(1e-8, scheme->name)));
    // Its momentum, and friction since.
    const double expected = std::sqrt(3.14159265358979) * width * std::exp(-0.3 * 2.0);
    EXPECT_NEAR(result.body(0)["velocity"][0], expected, 1e-4 * expected);
  }
}

/// A path of equilibria sees a pulse, or fails on it; it does not step over it.
TEST(TimeScale, PathsOfEquilibriaDoNotStepOverPulses) {
  int finished = 0;
  for (const char* width : {"0.003", "0.01", "0.2", "0.3"}) {
    SCOPED_TRACE(width);
    const std::string pulse = std::string("0.5*2*x^2 - exp(-((t - 3.0) / ") + width + ")^2)*x";
    KeptSamples samples;
    const RunResult result =
        run_text(tip(formula(pulse), "{ type = \"continuation\" }", "quasistatic") +
                     "[output]\nevery = 0.001\n",
                 {}, watched_by(samples));
    if (result.status != RunStatus::finished) continue;
    ++finished;
    double most = 0.0;
    for (const auto& row : samples.rows) {
      most = std::max(most, row[samples.column("tip.centre_of_mass.x")]);
    }
    EXPECT_NEAR(most, 0.5, 1e-3);
  }
  EXPECT_GT(finished, 0);
}

/// A force in proportion to a velocity is none where nothing moves.
TEST(TimeScale, ForcesOfAVelocityAreHeldAgainstSteps) {
  const auto warned = [](double dt) {
    return unresolved(run_text(
        tip("[[force]]\ntype = \"driving_spring\"\nstiffness = 2.0\nvelocity = [0.1]\n"
            "[[force]]\ntype = \"expression\"\nforce = [\"-vx*(1 + sin(628.3185307*t + 1.57))\"]\n",
            fixed_step(dt))));
  };
  EXPECT_EQ(warned(0.01), Keys{"force.expression"});
  EXPECT_EQ(warned(2e-4), Keys{});
}

/// A formula has a length if no force declares one, in any units.
TEST(TimeScale, OfAFormulaInSiUnitsIsSeen) {
  const auto text = [](double length, double time) {
    return "body = [{ name = \"tip\", type = \"point\", position = [0.0], particle_mass = 1.0 }]\n"
           "force = [{ type = \"viscous_damping\", coefficient = " +
           digits(0.3 / time) +
           " },\n"
           "{ type = \"expression\", energy = \"" +
           digits(length * length / time / time) + "*exp(-(x/" + digits(length) +
           ")^2)*sin(300*t/" + digits(time) +
           ")\" }]\n"
           "run = { duration = " +
           digits(5.0 * time) + ", integrator = " + fixed_step(0.1 * time) + " }\n";
  };
  EXPECT_EQ(unresolved(run_text(text(1.0, 1.0))), Keys{"force.expression"});
  EXPECT_EQ(unresolved(run_text(text(1e-9, 1e-12))), Keys{"force.expression"});
}

/// A run is not steady at a turning point of what changes with time.
TEST(TimeScale, AModulatedForceIsNotSteady) {
  for (const char* energy : {"0.1*sin(0.05*t)*x", "0.1*sin(0.01*t)*x", "0.1*sin(0.001*t)*x",
                             "0.05*sin(0.02*t)*cos(2*pi*x)"}) {
    SCOPED_TRACE(energy);
    const RunResult found = run_text(
        "body = [{ name = \"tip\", type = \"point\", position = [0.0], particle_mass = 1.0 }]\n"
        "force = [{ name = \"driver\", type = \"driving_spring\", stiffness = 1.0, velocity = "
        "[0.3] "
        "},\n{ type = \"viscous_damping\", coefficient = 1.0 },\n"
        "{ type = \"sinusoidal_substrate\", amplitude = 0.02, period = 1.0 },\n"
        "{ type = \"expression\", energy = \"" +
        std::string(energy) +
        "\" }]\n"
        "run = { integrator = { type = \"dop853\" }, until = { steady = \"driver.mean_force.x\", "
        "tolerance = 1e-2, max = 2000.0 } }\nmeasure = { in = \"driver_periods\", period = 1.0 "
        "}\n");
    ASSERT_TRUE(found.steady.has_value());
    EXPECT_FALSE(found.steady->reached);
  }
}

/// A step that is longer than a period does not end several of them.
TEST(TimeScale, StepsOfARunUntilItIsSteadyEndWithinAPeriod) {
  const RunResult found = run_text(
      "body = [{ name = \"tip\", type = \"point\", position = [0.0], particle_mass = 1.0 }]\n"
      "force = [{ name = \"driver\", type = \"driving_spring\", stiffness = 1.0, velocity = [1.0] "
      "},\n{ type = \"viscous_damping\", coefficient = 2.0 }]\n"
      "run = { integrator = { type = \"radau9\", largest_step = 7.3 }, until = { steady = "
      "\"driver.mean_force.x\", tolerance = 1e-3, max = 2000.0 } }\n"
      "measure = { in = \"driver_periods\", period = 1.0 }\n");
  EXPECT_TRUE(found.steady->reached);
  EXPECT_NEAR(found.driver(0)["mean_force"][0], 2.0, 2e-3);
}

}  // namespace
}  // namespace tomlin::test
