// scenarios/nanotube: a carbon nanotube on graphene.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

const std::string kPulledTube = "nanotube/pull.toml";

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

/// It rolls as a gear: the friction of its atoms is that of rolling, twice that of dragging.
TEST(Nanotube, RollsOnTheSheet) {
  constexpr double kVelocity = 0.05;
  const RunResult result = run_shipped(kPulledTube, {{"cells", "6"},
                                                     {"rows", "10"},
                                                     {"v", text_of(kVelocity)},
                                                     {"run.integrator.dt", "2e-3"},
                                                     {"equilibration", "2.0"},
                                                     {"run.duration", "2.0 + 2 * a / v"},
                                                     {"measure.from", "2.0 + a / v"},
                                                     {"measure.to", "2.0 + 2 * a / v"}});
  const double dragging = 240.0 * 1e-3 * kVelocity;
  EXPECT_NEAR(observable(result, "tube.rolling").value(), 1.0, 0.04);
  EXPECT_NEAR(observable(result, "driver.mean_force.y").value() / (2.0 * dragging), 1.0, 0.05);
}

/// A rigid tube is the gear itself: its radius is that of the rolled up sheet, 2 pi R = n a, and
/// the force N xi v (1 + 1).
TEST(Nanotube, RigidTubeRollsAsAGear) {
  constexpr double kOfTheStart = 1e-4;  // what is left of it after the rest and a period
  for (const double v : {0.1, 0.2}) {
    const RunResult result = run_shipped("nanotube/rigid.toml", {{"v", text_of(v)},
                                                                 {"rest", "10.0"},
                                                                 {"run.ledger", "true"}});
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
