// scenarios/nanotube: a carbon nanotube on graphene.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

const std::string kPulledTube = "nanotube/pull.toml";
const std::string kTubeOnField = "nanotube/field.toml";
const std::string kDraggedTube = "nanotube/dragged.toml";
const std::string kTubeAsRing = "nanotube/ring.toml";
const std::string kTubeAsRows = "nanotube/rows.toml";
constexpr double kAtomsFriction = 1e-3;  // eV ps/Angstrom^2

/// A free tube of which every particle goes straight on, as if it began to turn about its axis.
std::string turning_tube(const std::string& axis, const std::array<int, 2>& plane, double rate) {
  const std::string tube =
      "[[body]]\nname = \"tube\"\ntype = \"nanotube\"\nchirality = [6, 2]\n"
      "bond_length = 1.4\ncells = 2\nparticle_mass = 1.0\naxis = \"" +
      axis + "\"\n";
  const std::string run =
      "[run]\nduration = 2.0\nintegrator = { type = \"velocity_verlet\", dt = 0.01 }\n";
  const auto scene = parse_scene(tube + run, "scene.toml", registry());
  const SceneBody& body = scene->bodies.front();
  std::string velocities;
  for (const std::vector<double>& x : body.record->build(body.description.get(), 3).relative) {
    std::array<double, 3> v{};
    v[static_cast<std::size_t>(plane[0])] = -rate * x[static_cast<std::size_t>(plane[1])];
    v[static_cast<std::size_t>(plane[1])] = rate * x[static_cast<std::size_t>(plane[0])];
    velocities += "[" + text_of(v[0]) + ", " + text_of(v[1]) + ", " + text_of(v[2]) + "], ";
  }
  return tube + "velocity = [" + velocities + "]\n" + run;
}

TEST(Nanotube, TurnsAboutItsAxis) {
  constexpr double kRounding = 1e-12;
  constexpr double kRate = 0.7;
  const std::array<std::pair<const char*, std::array<int, 2>>, 3> tubes = {
      {{"x", {1, 2}}, {"y", {0, 2}}, {"z", {0, 1}}}};
  for (const auto& [axis, plane] : tubes) {
    for (const double rate : {kRate, -kRate}) {
      const RunResult result = run_text(turning_tube(axis, plane, rate));
      const double angle = std::atan(2.0 * rate);
      EXPECT_NEAR(observable(result, "tube.rotation").value(), angle, kRounding) << axis;
      EXPECT_NEAR(observable(result, "tube.turns").value(), angle / (2.0 * kPi), kRounding) << axis;
    }
  }
}

/// It rolls as a gear: the friction of its atoms is that of rolling, twice that of dragging. On the
/// atoms of the sheet, and on their field.
TEST(Nanotube, RollsOnTheSheet) {
  constexpr double kVelocity = 0.05;
  for (const std::string& scene : {kPulledTube, kTubeOnField}) {
    const RunResult result = run_shipped(scene, {{"cells", "6"},
                                                 {"rows", "10"},
                                                 {"v", text_of(kVelocity)},
                                                 {"run.integrator.dt", "2e-3"},
                                                 {"equilibration", "2.0"},
                                                 {"run.duration", "2.0 + 2 * a / v"},
                                                 {"measure.from", "2.0 + a / v"},
                                                 {"measure.to", "2.0 + 2 * a / v"}});
    const double dragging = 240.0 * kAtomsFriction * kVelocity;
    EXPECT_NEAR(observable(result, "tube.rolling").value(), 1.0, 0.04) << scene;
    EXPECT_NEAR(observable(result, "driver.mean_force.y").value() / (2.0 * dragging), 1.0, 0.05)
        << scene;
  }
}

/// Without rotation every atom moves with the centre; what exceeds their friction by the pull is
/// that of the way along the axis, around the maxima of the energy: 0.4 of it at low velocity.
TEST(Nanotube, IsDraggedWhereItCannotTurn) {
  constexpr double kVelocity = 0.01;
  const RunResult result = run_shipped(kDraggedTube, {{"cells", "6"}, {"rows", "10"}});
  const double ratio =
      observable(result, "driver.mean_force_along").value() / (240.0 * kAtomsFriction * kVelocity);
  EXPECT_GT(ratio, 1.35);
  EXPECT_LT(ratio, 1.45);
}

/// A gear turns once in ten periods of the sheet, and dissipates the friction of its centre and of
/// its rotation at least. A ring with both kinds of rows turns as evenly as the tube, one with ten
/// particles jerks from one to the next.
TEST(Nanotube, AsARingIsAGear) {
  constexpr double kTurns = -2.0 / 10.0;  // in the two periods of the window
  constexpr double kSteady = 1e-7;        // what is left of the start, and the scheme's tolerance
  for (const std::string& scene : {kTubeAsRing, kTubeAsRows}) {
    const auto parameter = [&](const char* name) { return parameter_of(scene, name); };
    const double round = 2.0 * kPi * parameter("R") / (10.0 * parameter("a"));
    for (const double v : {0.005, 0.01}) {
      const RunResult result = run_shipped(scene, {{"v", text_of(v)}});
      EXPECT_NEAR(observable(result, "tube.turns").value(), kTurns, kSteady) << scene;
      EXPECT_NEAR(observable(result, "tube.rolling").value(), round, 10.0 * kSteady) << scene;
      const double bound = parameter("atoms") * kAtomsFriction * v * (1.0 + round * round);
      const double ratio = observable(result, "driver.mean_force_along").value() / bound;
      EXPECT_GT(ratio, scene == kTubeAsRing ? 1.10 : 1.0) << scene;
      EXPECT_LT(ratio, scene == kTubeAsRing ? 1.20 : 1.01) << scene;
    }
  }
}

/// Energy of an atom on the sheet of the scenes.
double energy_on_sheet(const std::string& y, const std::string& z) {
  const std::string text =
      "[scene]\nunits = \"metal\"\n[parameters]\nb = 1.4388\na = \"sqrt(3) * b\"\n"
      "[box]\nlengths = [\"18 * b\", \"10 * a\", 60.0]\nperiodic = [true, true, false]\n"
      "[[body]]\nname = \"atom\"\ntype = \"point\"\nparticle_mass = 12.011\n"
      "position = [0.0, \"" +
      y + "\", " + z +
      "]\n"
      "[[body]]\nname = \"sheet\"\ntype = \"graphene\"\nbond_length = \"b\"\n"
      "cells = [6, 10]\narmchair = \"x\"\nparticle_mass = 12.011\ncoordinates = \"fixed\"\n"
      "[[force]]\ntype = \"lennard_jones\"\nbodies = [\"atom\", \"sheet\"]\n"
      "epsilon = 0.002411\nsigma = 3.4\ncutoff = 10.0\n"
      "[run]\nduration = 1e-6\nledger = true\n"
      "integrator = { type = \"velocity_verlet\", dt = 1e-6 }\n";
  return observable(run_text(text), "energy.potential").value();
}

/// V = f (cos(4 pi x / (3 b)) + 2 cos(2 pi x / (3 b)) cos(2 pi y / a)) from the middle of a
/// hexagon: above x = 0, where the bonds along x are, the energy varies by 2 f on either side of
/// its mean.
TEST(Nanotube, TheRingHasTheFirstHarmonicOfTheField) {
  constexpr double kHigherHarmonics = 5e-3;
  const double f = parameter_of(kTubeAsRing, "f");
  const double kappa = parameter_of(kTubeAsRing, "kappa");
  const auto harmonic = [](const std::string& z) {
    return (energy_on_sheet("a / 4", z) - energy_on_sheet("3 * a / 4", z)) / 4.0;
  };
  const double lowest = harmonic("3.113");
  EXPECT_NEAR(lowest / f, 1.0, kHigherHarmonics);
  // The exponential is that of the well, at 3.4, and steepens towards the sheet.
  EXPECT_NEAR(std::log(lowest / harmonic("3.404")) / 0.291, kappa, 0.05 * kappa);
  for (const std::string& scene : {kTubeAsRing, kTubeAsRows}) {
    EXPECT_EQ(parameter_of(scene, "V0"),
              parameter_of(scene, "atoms") * parameter_of(scene, "f") / 2);
  }
}

/// A rigid tube is the gear itself: its radius is that of the rolled up sheet, 2 pi R = n a, and
/// the force N xi v (1 + 1).
TEST(Nanotube, RigidTubeRollsAsAGear) {
  constexpr double kOfTheStart = 1e-4;  // what is left of it after the rest and a period
  for (const double v : {0.1, 0.2}) {
    const RunResult result = run_shipped(
        "nanotube/rigid.toml", {{"v", text_of(v)}, {"rest", "10.0"}, {"run.ledger", "true"}});
    const double dragging = 240.0 * 1e-3 * v;
    EXPECT_NEAR(observable(result, "tube.rolling").value(), 1.0, kOfTheStart);
    EXPECT_NEAR(observable(result, "driver.mean_force.y").value() / (2.0 * dragging), 1.0,
                kOfTheStart);
    const double work = observable(result, "energy.work_in").value();
    EXPECT_NEAR(observable(result, "energy.heat_out").value() / work, 1.0, kOfTheStart);
    EXPECT_NEAR(observable(result, "energy.numerical_work").value() / work, 0.0, kOfTheStart);
  }
}

}  // namespace
}  // namespace tomlin::test
