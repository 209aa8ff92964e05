#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"

// Bonds between two bodies, and molecules in space: momentum, angular momentum, energy,
// frequencies.

namespace tomlin::test {
namespace {

std::string point(const std::string& name, double x, double mass, const std::string& more = "") {
  return "[[body]]\nname = \"" + name + "\"\ntype = \"point\"\nposition = [" + digits(x) +
         "]\nparticle_mass = " + digits(mass) + "\n" + more;
}

std::string bond(const std::string& a, const std::string& b, double stiffness, double length) {
  return "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"" + a + "\", \"" + b +
         "\"]\npairs = \"all\"\nstiffness = " + digits(stiffness) +
         "\nrest_lengths = " + digits(length) + "\n";
}

std::string timed(double duration, const std::string& integrator, const std::string& more = "") {
  return "[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" + more;
}

/// The separation swings with omega = sqrt(k / mu) about the rest length; the centre moves on.
TEST(TwoBodies, SwingWithTheReducedMass) {
  const double m1 = 1.3, m2 = 0.4, k = 2.7, stretch = 0.2, speed = 0.15;
  const double omega = std::sqrt(k * (m1 + m2) / (m1 * m2));
  for (const double turns : {0.5, 1.25, 3.0}) {
    const double t = turns * kTau / omega;
    const RunResult result =
        run_text(point("a", 0.0, m1, "velocity = [" + digits(speed) + "]\n") +
                 point("b", 2.0 + stretch, m2, "velocity = [" + digits(speed) + "]\n") +
                 bond("a", "b", k, 2.0) + timed(t, adaptive(1e-12)));
    const double a = result.body(0)["centre_of_mass"][0];
    const double b = result.body(1)["centre_of_mass"][0];
    EXPECT_NEAR(b - a, 2.0 + stretch * std::cos(omega * t), 1e-9);
    EXPECT_NEAR((m1 * a + m2 * b) / (m1 + m2), m2 * (2.0 + stretch) / (m1 + m2) + speed * t, 1e-12);
    const double momentum = m1 * result.body(0)["velocity"][0] + m2 * result.body(1)["velocity"][0];
    EXPECT_NEAR(momentum, (m1 + m2) * speed, 1e-14);
  }
}

TEST(TwoBodies, OnePartnerMayBeFixed) {
  const double m = 0.4, k = 2.7, stretch = 0.2;
  const double t = 3.3;
  const RunResult result =
      run_text(point("wall", 0.0, 1.0, "coordinates = \"fixed\"\n") + point("b", 2.0 + stretch, m) +
               bond("wall", "b", k, 2.0) + timed(t, adaptive(1e-12)));
  EXPECT_EQ(result.body(0)["centre_of_mass"][0], 0.0);
  EXPECT_NEAR(result.body(1)["centre_of_mass"][0], 2.0 + stretch * std::cos(std::sqrt(k / m) * t),
              1e-9);
}

// ---- a rigid ring and a flexible chain of points in the plane

std::string ring_and_tip(const std::string& integrator) {
  return tables(R"([[body]] | name = "ring" | type = "ring" | count = 5 | radius = 0.8
particle_mass = [0.1, 0.7, 0.3, 0.2, 0.4] | centre = [0.1, 0.3]
velocity = [[0.3, 0.0], [0.1, 0.2], [0.0, -0.4], [0.2, 0.1], [0.5, 0.3]] | coordinates = "rigid"
[[body]] | name = "tip" | type = "point" | position = [2.2, 1.0] | velocity = [-0.2, 0.4]
particle_mass = 0.6
[[force]] | type = "harmonic_bonds" | bodies = ["ring", "tip"] | pairs = [[0, 0], [2, 0]]
stiffness = 3.0 | rest_lengths = [1.0, 2.0]
[run] | duration = 7.0 | ledger = true | integrator = )") +
         integrator + "\n";
}

/// Momentum, angular momentum about the origin and energy from the state of an engine.
struct Invariants {
  std::array<double, 2> momentum{};
  double angular_momentum = 0.0;
  double energy = 0.0;
};

Invariants invariants_of(Engine& engine) {
  Model& model = engine.model();
  const SystemView<double>& view = model.system().view;
  Invariants found;
  found.energy = model.kinetic_energy(view.position, view.velocity) +
                 model.potential_energy(DoubleDouble(engine.time()), view.position, view.velocity,
                                        view.integrals);
  for (const Model::Body& body : model.bodies()) {
    double x[3], v[3];
    model.centre(body.bound.index, view.position, x);
    model.centre_velocity(body.bound.index, view.velocity, v);
    const double m = body.total_mass;
    for (int d = 0; d < 2; ++d) found.momentum[d] += m * v[d];
    found.angular_momentum += m * (x[0] * v[1] - x[1] * v[0]);
    if (body.bound.slot.rigid) {
      const double turns = view.velocity[body.bound.slot.centre + kRotation];
      found.angular_momentum += body.inertia * kTau * turns;
    }
  }
  return found;
}

TEST(TwoBodies, ARigidRingAndATipKeepWhatTheyHave) {
  for (const auto& [integrator, tolerance] :
       {std::pair(adaptive(1e-12), 1e-10), std::pair(fixed_step(0.002), 1e-10),
        std::pair(verlet(0.0005), 1e-6)}) {
    Engine engine(scene_of(ring_and_tip(integrator)), {});
    const Invariants before = invariants_of(engine);
    const double rotation = engine.model().rotation(0, engine.state().reals("position"));
    engine.run();
    const Invariants after = invariants_of(engine);
    for (int d = 0; d < 2; ++d) EXPECT_NEAR(after.momentum[d], before.momentum[d], 1e-12);
    EXPECT_NEAR(after.angular_momentum, before.angular_momentum, tolerance) << integrator;
    EXPECT_NEAR(after.energy, before.energy, tolerance) << integrator;
    EXPECT_GT(std::abs(engine.model().rotation(0, engine.state().reals("position")) - rotation),
              0.02)
        << "it should turn";
  }
}

// ---- a molecule in space

const std::string kMolecule = tables(R"([[body]] | type = "particles"
positions = [[0.0, 0.0, 0.0], [1.1, 0.1, 0.0], [0.2, 1.0, 0.3], [0.3, 0.2, 1.2]]
velocity = [[0.1, 0.0, 0.2], [0.0, 0.3, -0.1], [-0.2, 0.1, 0.1], [0.1, -0.1, 0.0]]
particle_mass = [1.0, 2.0, 0.5, 1.5]
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 5.0 | rest_lengths = 1.2
[run] | duration = 6.0 | ledger = true | integrator = )");

struct Spatial {
  std::array<double, 3> momentum{};
  std::array<double, 3> angular{};
};

Spatial spatial_of(Engine& engine) {
  const Model::Body& body = engine.model().bodies()[0];
  const BodySlot<double>& slot = body.bound.slot;
  const double* x = engine.state().reals("position") + slot.offset;
  const double* v = engine.state().reals("velocity") + slot.offset;
  Spatial found;
  for (std::size_t i = 0; i < slot.count; ++i) {
    const double m = body.bound.mass[i];
    for (int d = 0; d < 3; ++d) {
      const std::size_t e = (d + 1) % 3 * slot.stride + i;
      const std::size_t f = (d + 2) % 3 * slot.stride + i;
      found.momentum[d] += m * v[d * slot.stride + i];
      found.angular[d] += m * (x[e] * v[f] - x[f] * v[e]);
    }
  }
  return found;
}

TEST(Molecule, InSpaceKeepsWhatItHas) {
  for (const auto& [integrator, tolerance] :
       {std::pair(adaptive(1e-12), 1e-9), std::pair(fixed_step(0.002), 1e-9),
        std::pair(verlet(0.0005), 1e-5)}) {
    Engine engine(scene_of(kMolecule + integrator + "\n"), {});
    const Spatial before = spatial_of(engine);
    const RunResult result = engine.run();
    ASSERT_EQ(result.status, RunStatus::finished);
    const Spatial after = spatial_of(engine);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(after.momentum[d], before.momentum[d], 1e-12);
      // Bonds pull along separations: velocity Verlet keeps angular momentum, too.
      EXPECT_NEAR(after.angular[d], before.angular[d], tolerance < 1e-6 ? 1e-10 : 1e-12)
          << integrator;
    }
    EXPECT_LT(std::abs(*result.group("energy")["numerical_work"]), tolerance) << integrator;
    EXPECT_GT(result.group("energy")["potential"].value(), 1e-3) << "it should swing";
  }
}

}  // namespace
}  // namespace tomlin::test
