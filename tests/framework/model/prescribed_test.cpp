#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/order.hpp"
#include "tests/support/ring_scenes.hpp"

// Bodies whose motion the scene gives: where they are, what keeps them going, what they do to
// others.

namespace tomlin::test {
namespace {

struct Wheel {
  std::string velocity = "[0.3, 0.0]";
  std::string angular_velocity = "0.0";
  double centre = 0.0;
  double friction = 0.25;  ///< of each of four particles
  double duration = 1.0;
  std::string more = "";

  std::string text(const std::string& integrator) const {
    return "[[body]]\nname = \"wheel\"\ntype = \"ring\"\ncount = 4\nradius = 0.5\n"
           "particle_mass = 1.0\ncentre = [" +
           digits(centre) +
           ", 0.5]\ncoordinates = \"prescribed\"\nmotion = { velocity = " + velocity +
           ", angular_velocity = " + angular_velocity +
           " }\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(friction) +
           "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n"
           "[run]\nduration = " +
           digits(duration) + "\nintegrator = " + integrator + "\n" + more;
  }
};

TEST(Prescribed, IsWhereItsMotionPutsItAfterAMillionSteps) {
  // 1e6 steps of 0.001 at the velocity 0.3, which no binary fraction is.
  for (const double centre : {0.0, 1e9}) {
    const Wheel wheel{.angular_velocity = "0.7", .centre = centre, .duration = 1000.0};
    const RunResult result = run_text(wheel.text(fixed_step(1e-3)));
    EXPECT_EQ(result.steps, 1'000'000u);
    const ResultGroup& body = result.body(0);
    EXPECT_NEAR(body["centre_of_mass"][0], centre + 300.0, 1.2e-16 * (centre + 600.0));
    EXPECT_NEAR(body["centre_of_mass"][1], 0.5, 1e-16);
    EXPECT_NEAR(*body["rotation"], 700.0, 2e-13);
    EXPECT_EQ(body["velocity"][0], 0.3);
    EXPECT_NEAR(body["mean_velocity"][0], 0.3, 1e-15);
    EXPECT_NEAR(*body["turns"], 700.0 / kTau, 1e-13);
  }
}

/// The wheel works against the drag C V of a fluid: the work is C V^2 t, all of it heat.
TEST(Prescribed, IsADriverOfItsOwn) {
  // With nothing free an adaptive scheme has no error to go by.
  for (const std::string& integrator : {fixed_step(0.01), adaptive_held_to(0.01), verlet(0.01)}) {
    Wheel wheel{.angular_velocity = "0.7", .duration = 10.0, .more = "ledger = true\n"};
    const RunResult result = run_text(wheel.text(integrator));
    ASSERT_EQ(result.status, RunStatus::finished);
    const ResultGroup& driver = driver_of(result, "wheel");
    const double drag = 4.0 * 0.25 * 0.3;
    EXPECT_NEAR(*driver["distance"], 3.0, 1e-12);
    const double spin = 4.0 * 0.25 * std::pow(0.7 * 0.5, 2);
    const ResultGroup& e = result.group("energy");
    EXPECT_NEAR(*e["heat_out"], (drag * 0.3 + spin) * 10.0, 1e-10) << integrator;
    EXPECT_EQ(*e["work_in"], *driver["work"]);
    EXPECT_NEAR(*driver["work"], *e["heat_out"] + *e["stored_change"],
                integrator == verlet(0.01) ? 1e-4 : 1e-8);
  }
}

/// Without a substrate it is drag and what accelerates the body; work is force times way, exactly.
TEST(Prescribed, PowerIsForceTimesVelocity) {
  const double mass = 1.7;
  const std::string scene =
      "[[body]]\nname = \"ball\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = " +
      digits(mass) +
      "\ncoordinates = \"prescribed\"\nmotion = { velocity = [\"0.4 * cos(2 * t)\"] }\n"
      "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.5\n"
      "[run]\nduration = 2.0\nledger = true\nintegrator = ";
  for (const std::string& integrator : {fixed_step(0.01), adaptive_held_to(0.01)}) {
    const RunResult result = run_text(scene + integrator + "\n");
    const ResultGroup& driver = driver_of(result, "ball");
    const double end = 0.4 * std::cos(4.0);
    EXPECT_NEAR(driver["final_force"][0], 1.5 * end - mass * 0.8 * std::sin(4.0), 1e-12);
    EXPECT_NEAR(driver["mean_force"][0],
                1.5 * 0.4 * std::sin(4.0) / 2.0 / 2.0 + mass * (end - 0.4) / 2.0, 1e-9);
    const double heat = 1.5 * 0.16 * (1.0 + std::sin(8.0) / 8.0);
    EXPECT_NEAR(*driver["work"], heat + 0.5 * mass * (end * end - 0.16), 1e-9);
    EXPECT_NEAR(*result.group("energy")["heat_out"], heat, 1e-9);
    EXPECT_NEAR(result.group("energy")["kinetic"].value(), 0.5 * mass * end * end, 1e-12);
    EXPECT_NEAR(*result.group("energy")["numerical_work"], 0.0, 1e-12);
  }
}

/// A wheel that speeds up, turns and jumps, in windows that begin and end anywhere: all that is put
/// in is heat or kinetic energy, and the mean force has the change of momentum.
TEST(Prescribed, InertiaIsInForceWorkAndKineticEnergy) {
  const auto square_wave = [](double t) { return std::floor(t) - 2.0 * std::floor(0.5 * t); };
  const double from = 0.35;
  const double to = 2.6;
  for (const std::string& integrator :
       {fixed_step(0.01), verlet(0.01), adaptive(1e-9), std::string("{ type = \"radau9\" }")}) {
    SCOPED_TRACE(integrator);
    const std::string motion =
        "{ velocity = [\"floor(t) - 2*floor(t/2)\", \"0.3*t^2\"], angular_velocity = "
        "\"2*sin(3*t)\" }";
    const std::string text =
        "[[body]]\nname = \"wheel\"\ntype = \"ring\"\ncount = 4\nradius = 0.5\n"
        "particle_mass = 2.0\ncentre = [0.0, 0.0]\ncoordinates = \"prescribed\"\nmotion = " +
        motion +
        "\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.1\n[run]\nduration = 3.0\n"
        "ledger = true\nintegrator = " +
        integrator + "\n[measure]\nfrom = 0.35\nto = 2.6\nin = \"time\"\n";
    const RunResult result = run_text(text);
    ASSERT_EQ(result.status, RunStatus::finished);
    const auto kinetic = [&](double t) {
      const double spin = 2.0 * std::sin(3.0 * t);
      return 4.0 * (std::pow(square_wave(t), 2) + std::pow(0.3 * t * t, 2)) +
             0.5 * 8.0 * 0.25 * spin * spin;
    };
    EXPECT_NEAR(result.group("energy")["kinetic"].value(), kinetic(3.0), 1e-9);
    EXPECT_NEAR(*result.group("energy")["stored_change"], kinetic(to) - kinetic(from), 1e-9);
    EXPECT_NEAR(*result.group("energy")["numerical_work"], 0.0, 1e-9);
    const ResultGroup& wheel = driver_of(result, "wheel");
    EXPECT_EQ(*wheel["work"], *result.group("energy")["work_in"]);
    const double momentum[2] = {8.0 * (square_wave(to) - square_wave(from)),
                                8.0 * 0.3 * (to * to - from * from)};
    const double drag = 0.4 * 0.1 * (to * to * to - from * from * from);
    EXPECT_NEAR(wheel["mean_force"][1] * (to - from), momentum[1] + drag, 1e-5);
    EXPECT_NEAR(wheel["mean_force"][0] * (to - from), momentum[0] + 0.4, 0.02) << "jumps in steps";
    // At the end: 8 times an acceleration of 0.6 t, and drag.
    EXPECT_NEAR(wheel["final_force"][1], 8.0 * 1.8 + 0.4 * 2.7, 1e-9);
    EXPECT_NEAR(*result.group("energy")["work_in"],
                *result.group("energy")["heat_out"] + kinetic(to) - kinetic(from), 1e-9);
  }
}

TEST(Prescribed, WithoutInertiaThereIsNone) {
  const std::string body =
      "[[body]]\nname = \"ball\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.7\n"
      "coordinates = \"prescribed\"\nmotion = { velocity = [\"0.4 * cos(2 * t)\"] }\n"
      "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.5\n"
      "[run]\nduration = 2.0\nledger = true\ndynamics = \"overdamped\"\nintegrator = ";
  const RunResult result = run_text(body + fixed_step(0.01) + "\n");
  EXPECT_NEAR(driver_of(result, "ball")["final_force"][0], 1.5 * 0.4 * std::cos(4.0), 1e-12);
  EXPECT_EQ(result.group("energy")["kinetic"].value(), 0.0);
  EXPECT_NEAR(*result.group("energy")["numerical_work"], 0.0, 1e-12);
}

/// A run that goes on from its middle knows as much.
TEST(Prescribed, InertiaSurvivesAResume) {
  Wheel wheel{.velocity = "[\"0.3 * cos(2 * t)\", \"0.1*floor(3*t)\"]",
              .angular_velocity = "\"0.5 * sin(t)\"",
              .duration = 3.0,
              .more = "ledger = true\n"};
  const auto scene = scene_of(wheel.text(fixed_step(0.01)));
  Engine whole(scene, {});
  const RunResult expected = whole.run();
  Engine first(scene, {});
  first.advance(137);
  Engine second(scene, {});
  second.resume(first.state().to_bytes());
  const RunResult found = second.run();
  EXPECT_EQ(*found.driver(0)["work"], *expected.driver(0)["work"]);
  EXPECT_EQ(found.driver(0)["mean_force"], expected.driver(0)["mean_force"]);
  EXPECT_EQ(*found.group("energy")["numerical_work"], *expected.group("energy")["numerical_work"]);
}

/// The position follows from the velocity's integral, with the order of the scheme.
TEST(Prescribed, AnOscillatingMotionIsIntegratedToTheSchemesOrder) {
  const double duration = 3.2;
  const Wheel wheel{.velocity = "[\"0.3 * cos(2 * t)\", 0.0]",
                    .angular_velocity = "\"0.5 * sin(t)\"",
                    .duration = duration};
  const double x = 0.15 * std::sin(2.0 * duration);
  const double angle = 0.5 * (1.0 - std::cos(duration));
  const auto order_of = [&](auto integrator) {
    std::vector<double> steps, errors;
    for (double h = 0.2; h > 0.02; h *= 0.5) {
      const ResultGroup body = run_text(wheel.text(integrator(h))).body(0);
      steps.push_back(h);
      errors.push_back(std::hypot(body["centre_of_mass"][0] - x, *body["rotation"] - angle));
    }
    return fitted_order(steps, errors, 1e-14);
  };
  const double rk4 = order_of(fixed_step);
  EXPECT_TRUE((Window{3.8, 4.2}.holds(rk4))) << rk4;
  const double split = order_of(verlet);
  EXPECT_TRUE((Window{1.9, 2.1}.holds(split))) << split;
}

/// A prescribed point that pulls a tip by a bond is a driving spring.
TEST(Prescribed, PullsLikeADrivingSpring) {
  const std::string tip =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.1]\nparticle_mass = 1.0\n";
  const auto rest = [](const std::string& integrator) {
    return "[[force]]\ntype = \"viscous_damping\"\nbody = \"tip\"\ncoefficient = 0.7\n"
           "[[force]]\ntype = \"sinusoidal_substrate\"\nbody = \"tip\"\namplitude = 0.1\n"
           "period = 1.0\n[run]\nduration = 12.0\nintegrator = " +
           integrator + "\n";
  };
  // The bond is long and keeps its direction, so its force is k (x1 - x0 - r0).
  const std::string puller =
      "[[body]]\nname = \"puller\"\ntype = \"point\"\nposition = [50.1]\nparticle_mass = 1.0\n"
      "coordinates = \"prescribed\"\nmotion = { velocity = [0.25] }\n"
      "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"tip\", \"puller\"]\npairs = [[0, 0]]\n"
      "stiffness = 2.0\n";
  const std::string spring =
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
      "velocity = [0.25]\n";
  for (const std::string& integrator : {fixed_step(0.01), verlet(0.01)}) {
    const RunResult a = run_text(tip + puller + rest(integrator));
    const RunResult b = run_text(tip + spring + rest(integrator));
    const ResultGroup& pulled = driver_of(a, "puller");
    const ResultGroup& driven = driver_of(b, "driver");
    EXPECT_NEAR(body_of(a, "tip")["centre_of_mass"][0], body_of(b, "tip")["centre_of_mass"][0],
                1e-11);
    EXPECT_NEAR(pulled["mean_force"][0], driven["mean_force"][0], 1e-11);
    EXPECT_NEAR(*pulled["work"], *driven["work"], 1e-11);
    EXPECT_NEAR(*pulled["distance"], 3.0, 1e-12);
  }
}

TEST(Prescribed, InQuadruplePrecision) {
  const Wheel wheel{
      .velocity = "[\"0.3 * cos(2 * t)\", 0.1]", .angular_velocity = "0.7", .duration = 3.0};
  Wheel other = wheel;
  other.more = "number_type = \"quadruple\"\n";
  const ResultGroup a = run_text(wheel.text(fixed_step(0.01))).body(0);
  const ResultGroup b = run_text(other.text(fixed_step(0.01))).body(0);
  constexpr double kRounding = 1e-13;
  for (int d = 0; d < 2; ++d) {
    EXPECT_NEAR(b["centre_of_mass"][d], a["centre_of_mass"][d], kRounding);
    EXPECT_NEAR(b["velocity"][d], a["velocity"][d], kRounding);
  }
  EXPECT_NEAR(*b["rotation"], *a["rotation"], kRounding);
  EXPECT_NEAR(*b["max_speed"], *a["max_speed"], kRounding);
}

}  // namespace
}  // namespace tomlin::test
