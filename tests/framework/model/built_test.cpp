#include <string>

#include <gtest/gtest.h>

#include "framework/model/model.hpp"
#include "tests/support/ring_scenes.hpp"

// Nothing is built that the scene did not ask for.

namespace tomlin::test {
namespace {

std::vector<std::string> names(const Model& model) {
  std::vector<std::string> names;
  for (const Model::Force& force : model.forces()) names.push_back(force.name);
  return names;
}

using Names = std::vector<std::string>;

/// Builds with assertions fill the force arrays with NaN before every evaluation.
#ifdef NDEBUG
constexpr std::size_t kFilling = 0;
#else
constexpr std::size_t kFilling = 1;
#endif

TEST(Built, ATipIsOneCoordinateAndItsForces) {
  Model model(scene_of(TipScene{}.text()));
  EXPECT_EQ(model.dimension(), 1);
  EXPECT_EQ(model.coordinate_count(), 1u);
  EXPECT_EQ(names(model), (Names{"driver", "viscous_damping", "sinusoidal_substrate"}));
  EXPECT_TRUE(model.left_out().empty());
  // One call a force, and none to clear what the first of them sets.
  EXPECT_EQ(model.system().view.operation_count, 3u + kFilling);
  EXPECT_EQ(model.system().view.dofs, kGroup);
  // The driver's force along x, and its power.
  EXPECT_EQ(model.system().view.rates, kGroup);
  EXPECT_EQ(model.system().view.own, 0u);
}

TEST(Built, AFreeParticleHasNoForcesAndNoIntegrals) {
  Model model(
      scene_of("[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
               "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 0.1 }\n"));
  EXPECT_TRUE(model.forces().empty());
  EXPECT_EQ(model.system().view.used_rates, 0u);
  EXPECT_LE(model.system().view.operation_count, 1u + kFilling);
  EXPECT_EQ(model.origin().unit[0], 0.0) << "no period, no cells";
}

TEST(Built, ARigidRingIsThreeCoordinatesWithoutItsBonds) {
  RingScene ring{.coordinates = "rigid"};
  Model model(scene_of(ring.text()));
  EXPECT_EQ(model.coordinate_count(), 3u);
  EXPECT_EQ(names(model), (Names{"driver", "viscous_damping", "sinusoidal_substrate"}));
  ASSERT_EQ(model.left_out().size(), 1u);
  EXPECT_EQ(model.left_out()[0].force, "harmonic_bonds");
  EXPECT_NE(model.left_out()[0].why.find("rigid"), std::string::npos);
  // Place the particles, two forces on them, gather; the driver acts on the centre.
  EXPECT_EQ(model.system().view.operation_count, 5u + kFilling);
  const RunResult result = run_text(RingScene{.coordinates = "rigid", .duration = 0.1}.text());
  ASSERT_EQ(result.left_out.size(), 1u);
  EXPECT_EQ(result.left_out[0].first, "harmonic_bonds");
}

TEST(Built, AFlexibleRingIsItsParticles) {
  Model model(scene_of(RingScene{}.text()));
  EXPECT_EQ(model.coordinate_count(), 16u);
  EXPECT_EQ(model.forces().size(), 4u);
  EXPECT_EQ(model.system().view.operation_count, 4u + kFilling);
  EXPECT_TRUE(model.left_out().empty());
}

TEST(Built, WhatIsFixedFeelsNothing) {
  RingScene ring{.coordinates = "fixed"};
  Model model(scene_of(ring.text()));
  EXPECT_EQ(model.coordinate_count(), 0u);
  EXPECT_EQ(names(model), (Names{"driver"})) << "a driver's force is an observable all the same";
  EXPECT_EQ(model.left_out().size(), 3u);
  ring.duration = 2.0;
  const RunResult result = run_text(ring.text());
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.body(0)["centre_of_mass"][0], 0.0);
  // Stiffness 2, pulled 0.25 * 2 along.
  EXPECT_NEAR(result.driver(0)["final_force"][0], 1.0, 1e-12);
  EXPECT_NEAR(result.driver(0)["mean_force"][0], 0.5, 1e-12);
}

TEST(Built, EvaluationsPerStep) {
  // Whatever is in the scene, a step evaluates all forces as often as its scheme says, no more.
  for (const char* coordinates : {"particles", "rigid"}) {
    RingScene ring{.coordinates = coordinates, .duration = 1.0};
    const RunResult fixed = run_text(ring.text());
    EXPECT_EQ(fixed.steps, 500u);
    EXPECT_EQ(fixed.force_evaluations, 4 * fixed.steps);
    ring.integrator = adaptive(1e-6);
    const RunResult adapted = run_text(ring.text());
    EXPECT_EQ(adapted.force_evaluations, 6 * (adapted.steps + adapted.refused_steps) + 1);
  }
}

TEST(Built, NoSamplesUnlessAsked) {
  KeptSamples kept;
  run(scene_of(TipScene{.duration = 1.0}.text()), watched_by(kept));
  EXPECT_TRUE(kept.names.empty());
  EXPECT_TRUE(kept.rows.empty());
}

// ---- generalised forces of rigid bodies: virtual work

/// A rigid ring under one force: the generalised forces are minus the gradient of the potential
/// energy in x, y and the rotation (in turns), by central differences.
void expect_virtual_work(const std::string& force) {
  SCOPED_TRACE(force);
  Model model(scene_of(
      "[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 5\nradius = 0.8\ncentre = [0.2, 0.7]\n"
      "particle_mass = [1.0, 2.0, 0.5, 1.5, 1.0]\ncoordinates = \"rigid\"\n[[force]]\n" +
      force + "[run]\nduration = 1.0\nintegrator = { type = \"dopri5\" }\n"));
  RunState state = [&] {
    StateLayout layout;
    model.declare(layout);
    return RunState(layout);
  }();
  model.attach(state);
  model.start();
  const SystemView<double>& view = model.system().view;
  const std::size_t centre = model.bodies()[0].bound.slot.centre;
  std::vector<double> rates(view.rates + 2 * kGroup, 0.0);
  constexpr double kStep = 1e-4;        // in lengths and in turns
  constexpr double kDifference = 2e-5;  // h^2 (2 pi/a)^3 R^3 amplitude/6, with room
  const DoubleDouble time(0.7);
  view.position[centre] += 0.13;
  view.position[centre + 1] -= 0.21;
  view.position[centre + 2] += 0.077;
  double largest = 0.0;
  for (int d = 0; d < 3; ++d) {
    model.evaluate_at(time, view.position, view.velocity, view.integrals, rates.data());
    const double generalised = view.force[centre + d];
    double& q = view.position[centre + d];
    const double here = q;
    q = here + kStep;
    const double above = model.potential_energy(time, view.position, view.velocity, view.integrals);
    q = here - kStep;
    const double under = model.potential_energy(time, view.position, view.velocity, view.integrals);
    q = here;
    EXPECT_NEAR(generalised, -(above - under) / (2.0 * kStep), kDifference) << d;
    largest = std::max(largest, std::abs(generalised));
  }
  EXPECT_GT(largest, 0.1) << "nothing was tested";
}

TEST(VirtualWork, OnRigidBodies) {
  expect_virtual_work(
      "type = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.3\ndecay = 0.8\n");
  expect_virtual_work("type = \"constant_force\"\nforce = [0.3, -0.4]\n");
  expect_virtual_work("type = \"driving_spring\"\nstiffness = 1.7\nvelocity = [0.6, 0.1]\n");
  expect_virtual_work(
      "type = \"driving_spring\"\nstiffness = 1.7\nvelocity = [0.6, 0.1]\nattach = { particle = 3 "
      "}\n");
  expect_virtual_work(
      "type = \"driving_spring\"\nstiffness = 1.7\nvelocity = [0.6, 0.1]\n"
      "attach = \"each_particle\"\n");
}

/// A rigid ring's damping: c N on the centre and c sum r^2 on the rotation.
TEST(VirtualWork, DampingOfARigidRing) {
  const double c = 0.3;
  const double duration = 2.0;
  const double omega = 1.5;
  std::string velocities;
  for (int i = 0; i < 6; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / 6;
    velocities += std::string(i > 0 ? ", " : "") + "[" + digits(0.4 - omega * std::sin(angle)) +
                  ", " + digits(-0.2 + omega * std::cos(angle)) + "]";
  }
  const RunResult result = run_text(
      "[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 6\nradius = 1.0\ncentre = [0.0, 0.0]\n"
      "particle_mass = 0.5\ncoordinates = \"rigid\"\nvelocity = [" +
      velocities + "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(c) +
      "\n[run]\nduration = " + digits(duration) + "\nintegrator = " + fixed_step(0.01) + "\n");
  constexpr double kScheme = 1e-10;  // (c/m h)^4
  const double gone = -std::expm1(-c / 0.5 * duration) / (c / 0.5);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], 0.4 * gone, kScheme);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][1], -0.2 * gone, kScheme);
  EXPECT_NEAR(*result.body(0)["rotation"], omega * gone, kScheme);
}

}  // namespace
}  // namespace tomlin::test
