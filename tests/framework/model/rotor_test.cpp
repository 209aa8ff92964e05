#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/numbers/rotation_vector.hpp"
#include "framework/model/principal_axes.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/scenes.hpp"

// Rigid bodies that rotate in space: free tops against closed forms, what is conserved, the orders
// of the schemes, the plane as a special case, stiff bonds as the limit of a flexible body.

namespace tomlin::test {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

struct Particle {
  Vector position;
  double mass = 1.0;
};

std::string list_of(const Vector& x) {
  return "[" + digits(x[0]) + ", " + digits(x[1]) + ", " + digits(x[2]) + "]";
}

/// A body of particles that begins with the velocities of a rotation about its centre of mass.
struct Top {
  std::vector<Particle> particles;
  Vector spin = Vector::Zero();
  Vector drift = Vector::Zero();
  std::string coordinates = "rigid";
  std::string more = "";  ///< keys of the body, forces

  Vector centre() const {
    Vector sum = Vector::Zero();
    double mass = 0.0;
    for (const Particle& p : particles) {
      sum += p.mass * p.position;
      mass += p.mass;
    }
    return sum / mass;
  }
  Matrix inertia() const {
    Matrix sum = Matrix::Zero();
    for (const Particle& p : particles) {
      const Vector r = p.position - centre();
      sum += p.mass * (r.squaredNorm() * Matrix::Identity() - r * r.transpose());
    }
    return sum;
  }
  std::string text(double duration, const std::string& integrator,
                   const std::string& run = "") const {
    std::string positions;
    std::string velocities;
    std::string masses;
    for (const Particle& p : particles) {
      positions += list_of(p.position) + ", ";
      velocities += list_of(drift + spin.cross(p.position - centre())) + ", ";
      masses += digits(p.mass) + ", ";
    }
    return "[[body]]\nname = \"top\"\ntype = \"particles\"\npositions = [" + positions +
           "]\nvelocity = [" + velocities + "]\nparticle_mass = [" + masses +
           "]\ncoordinates = \"" + coordinates + "\"\n" + more +
           "\n[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" + run;
  }
};

/// Four particles in general position: three different moments, axes that are none of space.
Top asymmetric() {
  Top top;
  top.particles = {{{0.0, 0.1, 0.3}, 1.0},
                   {{1.1, 0.2, -0.1}, 2.0},
                   {{0.4, 1.7, 0.2}, 0.7},
                   {{-0.3, 0.5, 0.9}, 1.4}};
  top.spin = {0.7, -0.4, 1.1};
  top.drift = {0.05, 0.0, -0.02};
  return top;
}

/// A triangular bipyramid, tilted: two equal moments about `axis`.
Top symmetric(const Vector& axis) {
  const Matrix turn = Eigen::Quaterniond::FromTwoVectors(Vector::UnitZ(), axis).toRotationMatrix();
  Top top;
  for (int k = 0; k < 3; ++k) {
    const double angle = kTau * k / 3.0;
    top.particles.push_back({turn * Vector(std::cos(angle), std::sin(angle), 0.0), 0.8});
  }
  top.particles.push_back({turn * Vector(0.0, 0.0, 1.5), 1.1});
  top.particles.push_back({turn * Vector(0.0, 0.0, -1.5), 1.1});
  top.spin = {0.9, 0.5, -0.6};
  return top;
}

std::vector<Vector> positions(Engine& engine) {
  const Model& model = engine.model();
  std::vector<double> numbers(3 * model.bodies()[0].bound.slot.count);
  model.place_particles(0, model.system().view.position, numbers.data());
  std::vector<Vector> all;
  for (std::size_t k = 0; k < numbers.size(); k += 3) {
    all.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  }
  return all;
}

std::vector<Vector> positions_after(const std::string& text) {
  Engine engine(scene_of(text), {});
  const RunResult result = engine.run();
  EXPECT_EQ(result.status, RunStatus::finished);
  return positions(engine);
}

double distance(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

/// Kinetic energy, and angular momentum about the centre, from positions and velocities of
/// particles.
struct Motions {
  double energy = 0.0;
  Vector momentum = Vector::Zero();
};

Motions motions_of(Engine& engine, const Top& top) {
  const Model& model = engine.model();
  const auto& slot = model.bodies()[0].bound.slot;
  const SystemView<double>& view = model.system().view;
  const std::vector<Vector> at = positions(engine);
  Motions found;
  found.energy = model.kinetic_energy(view.position, view.velocity);
  Vector centre(view.position[slot.centre], view.position[slot.centre + 1],
                view.position[slot.centre + 2]);
  Vector drift(view.velocity[slot.centre], view.velocity[slot.centre + 1],
               view.velocity[slot.centre + 2]);
  for (std::size_t i = 0; i < at.size(); ++i) {
    Vector v;
    for (int d = 0; d < 3; ++d) {
      v[d] = view.mapped_velocity[slot.offset + static_cast<std::size_t>(d) * slot.stride + i];
    }
    found.momentum += top.particles[i].mass * (at[i] - centre).cross(v - drift);
  }
  return found;
}

/// Makes the engine place velocities, and does nothing.
const char* const kNoForce =
    "\n[[force]]\nname = \"air\"\ntype = \"viscous_damping\"\nbody = \"top\"\ncoefficient = "
    "1e-300\n";

TEST(PrincipalAxes, DiagonalizeTensorsOfInertia) {
  constexpr double kRounding = 1e-13;
  for (const Top& top : {asymmetric(), symmetric({1.0, 0.0, 0.0}), symmetric({0.3, -0.5, 0.8}),
                         symmetric({0.0, 0.0, 1.0})}) {
    const Matrix inertia = top.inertia();
    Matrix3 rows;
    for (int k = 0; k < 9; ++k) rows[static_cast<std::size_t>(k)] = inertia(k / 3, k % 3);
    const Matrix3 axes = matrix_of(principal_axes(rows));
    const Matrix turn = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(axes.data());
    EXPECT_NEAR(turn.determinant(), 1.0, kRounding);
    const Matrix diagonal = turn.transpose() * inertia * turn;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(diagonal(k, (k + 1) % 3), 0.0, kRounding * inertia.trace());
    }
  }
  EXPECT_EQ(principal_axes({2.0, 0.0, 0.0, 0.0, 1e-17, 0.0, 0.0, 0.0, 2.0}),
            (Quaternion{1.0, 0.0, 0.0, 0.0}));
}

/// The rotation of a vector that changes at a rate turns at the angular velocity that belongs to
/// it, and the second derivative is that of the rate.
TEST(RotationVector, KinematicsAgreeWithDifferences) {
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-8;  // central differences, and rounding by the step
  const Matrix3 unit = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (const Vector& at : {Vector(0.0, 0.0, 0.0), Vector(0.3, -0.2, 0.5), Vector(1.1, 0.9, -1.3)}) {
    const Vec<double, 3> p = {{at[0], at[1], at[2]}};
    const Vec<double, 3> u = {{0.4, -0.7, 0.2}};
    const Vec<double, 3> b = {{-0.5, 0.3, 0.9}};  // d2p/dt2
    const auto matrix_at = [&](double t) {
      const Vec<double, 3> there = p + t * u + (0.5 * t * t) * b;
      Matrix m;
      Matrix3 rows;
      rotate_axes(unit.data(), there, rows.data());
      for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = rows[static_cast<std::size_t>(k)];
      return m;
    };
    const auto spin_at = [&](double t) {
      const Vec<double, 3> w = angular_velocity(p + t * u + (0.5 * t * t) * b, u + t * b);
      return Vector(w[0], w[1], w[2]);
    };
    const Matrix here = matrix_at(0.0);
    EXPECT_NEAR((here.transpose() * here - Matrix::Identity()).norm(), 0.0, 1e-14);
    const Matrix rate = here.transpose() * (matrix_at(kStep) - matrix_at(-kStep)) / (2.0 * kStep);
    const Vector spin = spin_at(0.0);
    EXPECT_NEAR(rate(2, 1), spin[0], kTolerance);
    EXPECT_NEAR(rate(0, 2), spin[1], kTolerance);
    EXPECT_NEAR(rate(1, 0), spin[2], kTolerance);
    const Vector angular = (spin_at(kStep) - spin_at(-kStep)) / (2.0 * kStep);
    const Vec<double, 3> again =
        acceleration_of_vector(p, u, {{angular[0], angular[1], angular[2]}});
    const Vec<double, 3> back = rate_of_vector(p, {{spin[0], spin[1], spin[2]}});
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(again[k], b[k], kTolerance);
      EXPECT_NEAR(back[k], u[k], 1e-14);
    }
  }
}

/// Its axis goes round the angular momentum L at |L| / I while it turns about itself (Landau and
/// Lifshitz, Mechanics, section 33); many turns, so that orientations follow many times.
TEST(Rotor, FreeSymmetricTopPrecesses) {
  constexpr double kTolerance = 2e-9;  // steps to 1e-12 over 60 radians
  for (const Vector& direction : {Vector(0.0, 0.0, 1.0), Vector(0.3, -0.5, 0.8)}) {
    const Vector axis = direction.normalized();
    Top top = symmetric(axis);
    top.drift = {0.02, -0.01, 0.03};
    const Matrix inertia = top.inertia();
    const Vector momentum = inertia * top.spin;
    const double about = axis.dot(inertia * axis);
    const double across = 0.5 * (inertia.trace() - about);
    const double own = axis.dot(top.spin) * (1.0 - about / across);
    for (const double t : {3.0, 50.0}) {
      const std::vector<Vector> found = positions_after(top.text(t, adaptive(1e-13, "dop853")));
      const Matrix turn = Eigen::AngleAxisd(momentum.norm() / across * t, momentum.normalized())
                              .toRotationMatrix() *
                          Eigen::AngleAxisd(own * t, axis).toRotationMatrix();
      std::vector<Vector> expected;
      for (const Particle& p : top.particles) {
        expected.push_back(top.centre() + top.drift * t + turn * (p.position - top.centre()));
      }
      EXPECT_LT(distance(found, expected), kTolerance) << t;
    }
  }
}

TEST(Rotor, RodTurnsSteadily) {
  Top rod;
  rod.particles = {{{0.0, 0.0, 0.0}, 1.0}, {{1.0, 2.0, 0.5}, 3.0}};
  const Vector along = (rod.particles[1].position - rod.particles[0].position).normalized();
  rod.spin = along.cross(Vector(0.4, 0.1, -0.9));  // no rotation about itself
  for (const double t : {1.0, 40.0}) {
    const Matrix turn =
        Eigen::AngleAxisd(rod.spin.norm() * t, rod.spin.normalized()).toRotationMatrix();
    std::vector<Vector> expected;
    for (const Particle& p : rod.particles) {
      expected.push_back(rod.centre() + turn * (p.position - rod.centre()));
    }
    EXPECT_LT(distance(positions_after(rod.text(t, adaptive(1e-13, "dop853"))), expected), 1e-9)
        << t;
  }
  Engine engine(scene_of(rod.text(1.0, adaptive(1e-6))), {});
  EXPECT_EQ(engine.model().bodies()[0].bound.freedom, 5);
}

/// About the middle axis the rotation is unstable: the top turns over again and again, and energy
/// and angular momentum stay. The distances between particles do to rounding.
TEST(Rotor, TopThatTurnsOverConservesEnergyAndAngularMomentum) {
  constexpr double kTolerance = 1e-9;  // steps to 1e-12 over 150 radians
  Top top = asymmetric();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(top.inertia());
  const Vector middle = solver.eigenvectors().col(1);
  top.spin = 1.5 * middle + 1e-3 * solver.eigenvectors().col(0);
  top.more = kNoForce;
  const double energy =
      0.5 * top.spin.dot(top.inertia() * top.spin) + 0.5 * 5.1 * top.drift.squaredNorm();
  const Vector momentum = top.inertia() * top.spin;
  Engine engine(scene_of(top.text(100.0, adaptive(1e-12, "dop853"))), {});
  double least = 1.0;
  while (!engine.done()) {
    engine.advance(10);
    const std::vector<Vector> at = positions(engine);
    // How far the direction that was the middle axis has turned.
    const Vector before = top.particles[1].position - top.particles[0].position;
    const Vector after = at[1] - at[0];
    EXPECT_NEAR(after.norm(), before.norm(), 1e-13);
    const SystemView<double>& view = engine.model().system().view;
    EXPECT_NEAR(engine.model().kinetic_energy(view.position, view.velocity), energy,
                kTolerance * energy);
    least = std::min(least, before.dot(after) / before.squaredNorm());
  }
  EXPECT_LT(least, -0.5);
  engine.end();
  const Motions found = motions_of(engine, top);
  EXPECT_NEAR((found.momentum - momentum).norm(), 0.0, kTolerance * momentum.norm());
}

/// Also with steps that turn the body far, for which orientations must follow every step.
TEST(Rotor, SchemesConvergeWithTheirOrder) {
  const Top top = asymmetric();
  const std::vector<Vector> exact = positions_after(top.text(4.0, adaptive(1e-13, "dop853")));
  const std::vector<std::pair<std::string, double>> schemes = {{"midpoint", 2.0}, {"rk4", 4.0}};
  for (const auto& scheme : schemes) {
    const std::string& name = scheme.first;
    const double order = scheme.second;
    const auto error = [&](double dt) {
      return distance(
          positions_after(top.text(4.0, "{ type = \"" + name + "\", dt = " + digits(dt) + " }")),
          exact);
    };
    const double slope = std::log2(error(0.04) / error(0.02));
    EXPECT_NEAR(slope, order, 0.25) << name;
    EXPECT_LT(error(0.2), 0.5) << name;  // a third of a radian in a step
  }
}

/// In the plane it is the planar body: the same forces, one of them on a particle, and friction.
TEST(Rotor, BodyInThePlaneIsThePlanarOne) {
  constexpr double kTolerance = 1e-9;  // two parametrisations, steps to 1e-12
  const auto scene = [](bool in_space) {
    const std::string zero = in_space ? ", 0.0" : "";
    std::string positions;
    std::string velocities;
    for (int k = 0; k < 7; ++k) {
      const double x = 1.2 * std::cos(kTau * k / 7.0);
      const double y = 1.2 * std::sin(kTau * k / 7.0);
      positions += "[" + digits(x) + ", " + digits(y) + zero + "], ";
      velocities += "[" + digits(0.3 - 1.5 * y) + ", " + digits(0.1 + 1.5 * x) + zero + "], ";
    }
    return "[[body]]\nname = \"ring\"\ntype = \"particles\"\npositions = [" + positions +
           "]\nparticle_mass = [1.0, 1.3, 0.7, 1.0, 2.0, 1.0, 0.4]\ncoordinates = \"rigid\"\n"
           "velocity = [" +
           velocities +
           "]\n"
           "[[force]]\nname = \"wall\"\ntype = \"expression\"\nbody = \"ring\"\n"
           "energy = \"0.4 * cos(2 * x) + 0.2 * y^2 + 0.1 * x * y\"\n"
           "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nbody = \"ring\"\n"
           "attach = { particle = 2 }\nstiffness = 0.8\nvelocity = [0.2, 0.0" +
           zero +
           "]\n"
           "[[force]]\nname = \"air\"\ntype = \"viscous_damping\"\nbody = \"ring\"\n"
           "coefficient = 0.01\n"
           "[run]\nduration = 60.0\nledger = true\nintegrator = " +
           adaptive(1e-12, "dop853");
  };
  const RunResult plane = run_text(scene(false));
  const RunResult space = run_text(scene(true));
  for (std::size_t d = 0; d < 2; ++d) {
    EXPECT_NEAR(space.body(0)["centre_of_mass"][d], plane.body(0)["centre_of_mass"][d], kTolerance);
    EXPECT_NEAR(space.body(0)["velocity"][d], plane.body(0)["velocity"][d], kTolerance);
  }
  EXPECT_NEAR(space.body(0)["centre_of_mass"][2], 0.0, 1e-14);
  for (const char* path : {"driver.mean_force.x", "driver.mean_force.y", "energy.work_in",
                           "energy.heat_out", "energy.stored_change"}) {
    EXPECT_NEAR(*observable(space, path), *observable(plane, path), kTolerance) << path;
  }
  // It has rotated, and the energy balance closes with the kinetic energy of the rotation.
  EXPECT_GT(std::abs(plane.body(0)["rotation"][0]), 1.0);
  EXPECT_NEAR(*observable(space, "energy.numerical_work"), 0.0, kTolerance);
}

/// Bonds of stiffness k keep the shape but for parts of the order 1/k.
TEST(Rotor, IsTheLimitOfStiffBonds) {
  Top top = asymmetric();
  top.more =
      "[[force]]\nname = \"trap\"\ntype = \"expression\"\nbody = \"top\"\n"
      "energy = \"0.1 * x^2 + 0.2 * (y - 0.3 * z)^2 + 0.15 * z^2\"\n";
  const std::vector<Vector> rigid = positions_after(top.text(5.0, adaptive(1e-11, "dop853")));
  std::vector<double> errors;
  for (const double stiffness : {1e3, 4e3}) {
    Top flexible = top;
    flexible.coordinates = "particles";
    flexible.more +=
        "[[force]]\nname = \"bonds\"\ntype = \"harmonic_bonds\"\nbody = \"top\"\npairs = \"all\"\n"
        "stiffness = " +
        digits(stiffness) + "\n";
    errors.push_back(
        distance(positions_after(flexible.text(5.0, adaptive(1e-11, "dop853"))), rigid));
  }
  EXPECT_LT(errors[0], 0.05);
  EXPECT_GT(errors[0], 1e-5);  // it does bend
  EXPECT_NEAR(errors[0] / errors[1], 4.0, 1.5);
}

/// Equipartition: kT/2 for each of the six coordinates, five of a rod.
TEST(Rotor, StartsWithTheTemperature) {
  constexpr int kSeeds = 600;
  constexpr double kTemperature = 0.3;
  Top rod;
  rod.particles = {{{0.0, 0.0, 0.0}, 1.0}, {{1.0, 2.0, 0.5}, 3.0}};
  Top general = asymmetric();
  general.spin = general.drift = Vector::Zero();
  for (auto [top, freedom] : {std::pair(general, 6.0), std::pair(rod, 5.0)}) {
    top.more = "start_temperature = " + digits(kTemperature) + "\n";
    double sum = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      Engine engine(scene_of(top.text(1.0, fixed_step(0.01), "seed = " + std::to_string(seed))),
                    {});
      const SystemView<double>& view = engine.model().system().view;
      sum += engine.model().kinetic_energy(view.position, view.velocity);
    }
    const double mean = sum / kSeeds / kTemperature;
    const double deviation = std::sqrt(0.5 * freedom / kSeeds);
    EXPECT_NEAR(mean, 0.5 * freedom, 4.0 * deviation);
  }
}

TEST(Rotor, RunResumesFromAnyStep) {
  Top top = asymmetric();
  top.spin = {2.0, -1.0, 3.0};
  top.more =
      "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nbody = \"top\"\nattach = { "
      "particle = 1 }\n"
      "stiffness = 0.8\nvelocity = [0.2, 0.0, 0.1]\n";
  for (const std::string& integrator : {fixed_step(0.04), adaptive(1e-6)}) {
    const auto scene =
        scene_of(top.text(4.0, integrator, "[output]\nevery = 0.1\ntrajectory = true\n"));
    expect_same_from_any_step(scene, [](const RunResult& expected, const RunResult& result) {
      EXPECT_EQ(result.body(0)["centre_of_mass"][0], expected.body(0)["centre_of_mass"][0]);
    });
  }
}

/// A tube that spins about its axis: whole turns are counted, and rolling is what it is.
TEST(Rotor, TubeRolls) {
  constexpr double kTolerance = 1e-8;
  const std::string body =
      "[[body]]\nname = \"tube\"\ntype = \"nanotube\"\nchirality = [5, 0]\nbond_length = 1.4\n"
      "cells = 2\naxis = \"x\"\ncentre = [0.0, 0.0, 5.0]\nparticle_mass = 1.0\n"
      "coordinates = \"rigid\"\n";
  const std::string run = "[run]\nduration = 100.0\nintegrator = " + adaptive(1e-11, "dop853");
  Engine still(scene_of(body + run), {});
  const Model& model = still.model();
  const double radius = model.bodies()[0].rolling_radius;
  still.run();
  const std::vector<Vector> at = positions(still);
  const Vector spin(0.8, 0.0, 0.0);
  const Vector drift(0.0, -0.8 * radius, 0.0);  // rolls without sliding on what is below
  std::string velocities = "velocity = [";
  for (const Vector& x : at) {
    velocities += list_of(drift + spin.cross(x - Vector(0.0, 0.0, 5.0))) + ", ";
  }
  const RunResult result = run_text(body + velocities + "]\n" + run + "\n[output]\nevery = 1.0\n");
  EXPECT_NEAR(std::abs(result.body(0)["turns"][0]), 80.0 / kTau, kTolerance);
  EXPECT_NEAR(result.body(0)["rolling"][0], 1.0, kTolerance);
  EXPECT_NEAR(std::abs(result.body(0)["rotation"][0]), 80.0, kTolerance);
}

/// A force that depends on velocities acts on the particles as in the plane: a cross that spins and
/// drifts under dry friction, whose law is not linear.
TEST(Rotor, ForcesOnItsParticlesKnowTheirVelocities) {
  constexpr double kTolerance = 1e-8;
  const auto scene = [](bool in_space) {
    const std::string zero = in_space ? ", 0.0" : "";
    return "[[body]]\nname = \"top\"\ntype = \"particles\"\npositions = [[1.0, 0.0" + zero +
           "], [-1.0, 0.0" + zero + "], [0.0, 1.0" + zero + "], [0.0, -1.0" + zero +
           "]]\nvelocity = [[0.1, 1.0" + zero + "], [0.1, -1.0" + zero + "], [-0.9, 0.0" + zero +
           "], [1.1, 0.0" + zero +
           "]]\nparticle_mass = 1.0\ncoordinates = \"rigid\"\n"
           "[[force]]\nname = \"dry\"\ntype = \"coulomb_friction\"\nbody = \"top\"\n"
           "force = 1.0\nwidth = 1e-2\n[run]\nduration = 0.2\nintegrator = " +
           adaptive(1e-11) +
           "\n[measure]\nobservables = [\"forces.dry.on.top.mean_force.x\", "
           "\"forces.dry.on.top.mean_force.y\", \"forces.dry.on.top.final_force.x\", "
           "\"forces.dry.on.top.max_force.x\"]";
  };
  const RunResult plane = run_text(scene(false));
  const RunResult space = run_text(scene(true));
  for (const char* key : {"mean_force.x", "mean_force.y", "final_force.x", "max_force.x"}) {
    const std::string path = std::string("forces.dry.on.top.") + key;
    EXPECT_NEAR(*observable(space, path), *observable(plane, path), kTolerance) << path;
  }
  EXPECT_LT(*observable(plane, "forces.dry.on.top.mean_force.x"), -0.1);
}

/// A driver on its centre besides a force on each particle: the centre swings as a point would, in
/// closed form, whatever the rotation does under the torque.
TEST(Rotor, ForceOnItsCentreAddsToThoseOnItsParticles) {
  constexpr double kStiffness = 2.5;
  constexpr double kSpeed = 0.3;
  constexpr double kDuration = 4.0;
  constexpr double kClose = 1e-10;  // of a run with tolerances of 1e-12
  const Vector pull(0.02, -0.05, 0.04);
  Top top = asymmetric();
  top.drift = Vector::Zero();
  top.more = "[[force]]\ntype = \"driving_spring\"\nstiffness = " + digits(kStiffness) +
             "\nvelocity = [" + digits(kSpeed) +
             ", 0.0, 0.0]\n[[force]]\ntype = \"constant_force\"\nforce = " + list_of(pull) + "\n";
  const std::string fine =
      "{ type = \"dop853\", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }";
  Engine engine(scene_of(top.text(kDuration, fine)), {});
  while (!engine.done()) engine.advance(1000);
  double mass = 0.0;
  Vector centre = Vector::Zero();
  const std::vector<Vector> now = positions(engine);
  for (std::size_t i = 0; i < now.size(); ++i) {
    mass += top.particles[i].mass;
    centre += top.particles[i].mass * now[i];
  }
  centre /= mass;
  const double omega = std::sqrt(kStiffness / mass);
  const double phase = omega * kDuration;
  const Vector total = static_cast<double>(now.size()) * pull;
  Vector wanted = top.centre() + total / kStiffness * (1.0 - std::cos(phase));
  wanted[0] += kSpeed * (kDuration - std::sin(phase) / omega);
  EXPECT_LT((centre - wanted).norm(), kClose);
}

/// A run that starts where another has ended finds the particles there, with their velocities, also
/// where other masses have other principal axes.
TEST(Rotor, StartsWhereAnotherHasEnded) {
  Top top = asymmetric();
  top.more = kNoForce;
  Engine first(scene_of(top.text(7.0, adaptive(1e-10))), {});
  first.run();
  const std::vector<Vector> there = positions(first);
  const FinalState end = final_state_of(first);
  Top other = top;
  std::swap(other.particles[0].mass, other.particles[1].mass);
  for (const Top& next : {top, other}) {
    RunOptions options;
    options.start_from = &end;
    Engine second(scene_of(next.text(1e-9, fixed_step(1e-9))), options);
    second.run();
    const std::vector<Vector> here = positions(second);
    // The centre is another one where the masses are.
    for (std::size_t i = 1; i < here.size(); ++i) {
      EXPECT_NEAR(((here[i] - here[0]) - (there[i] - there[0])).norm(), 0.0, 1e-8);
    }
    const auto spin_of = [](Engine& engine) {
      const FinalState::Rotor rotor = final_state_of(engine).rotors.front();
      return Vector(rotor.spin[0], rotor.spin[1], rotor.spin[2]);
    };
    EXPECT_NEAR((spin_of(second) - spin_of(first)).norm(), 0.0, 1e-8);
  }
  Top point = top;
  for (Particle& particle : point.particles) particle.position = Vector(1.0, 1.0, 1.0);
  RunOptions options;
  options.start_from = &end;
  EXPECT_FALSE(
      briefs_of([&] { Engine(scene_of(point.text(1.0, fixed_step(0.1))), options); }).empty());
}

/// About an axis of space that is none of its principal ones it is a pendulum of I = sum m r^2.
TEST(Rotor, RotatesAboutAnAxisOfSpaceAlone) {
  Top top = asymmetric();
  top.drift = Vector::Zero();
  const Vector axis(0.0, 0.0, 1.0);
  const double inertia = top.inertia()(2, 2);
  top.spin = 0.9 * axis;
  top.more = "hold = [\"rotation_x\", \"rotation_y\"]\n" + std::string(kNoForce);
  Engine engine(scene_of(top.text(9.0, adaptive(1e-12))), {});
  EXPECT_EQ(engine.model().bodies()[0].bound.freedom, 4);
  engine.run();
  const Matrix turn = Eigen::AngleAxisd(0.9 * 9.0, axis).toRotationMatrix();
  std::vector<Vector> expected;
  for (const Particle& p : top.particles) {
    expected.push_back(top.centre() + turn * (p.position - top.centre()));
  }
  EXPECT_LT(distance(positions(engine), expected), 1e-9);
  const SystemView<double>& view = engine.model().system().view;
  EXPECT_NEAR(engine.model().kinetic_energy(view.position, view.velocity), 0.5 * inertia * 0.81,
              1e-10);
  // One held rotation leaves two, of which the equations are others.
  const std::string one = top.text(1.0, adaptive(1e-6));
  const std::string two_left = std::string(one).replace(one.find(", \"rotation_y\""), 14, "");
  EXPECT_FALSE(briefs_of([&] { scene_of(two_left); }).empty());
}

/// The images of a tube that a periodic box continues would not meet it if it yawed.
TEST(Rotor, PeriodicTubeRotatesAboutItsAxis) {
  const auto scene = [](const std::string& hold, double length) {
    return "[box]\nlengths = [" + digits(length) +
           ", 100.0, 100.0]\n"
           "periodic = [true, false, false]\n"
           "[[body]]\nname = \"tube\"\ntype = \"nanotube\"\nchirality = [5, 0]\n"
           "bond_length = 1.4\ncells = 4\naxis = \"x\"\ncentre = [0.0, 0.0, 5.0]\n"
           "particle_mass = 1.0\ncoordinates = \"rigid\"\n" +
           hold + "[run]\nduration = 1.0\nintegrator = " + adaptive(1e-6);
  };
  const auto refused = [](const std::string& text) {
    return !briefs_of([&] { Engine(scene_of(text), {}); }).empty();
  };
  const double length = 4 * 3 * 1.4;
  EXPECT_TRUE(refused(scene("", length)));
  EXPECT_FALSE(refused(scene("", 3.0 * length)));
  EXPECT_FALSE(refused(scene("hold = [\"rotation_y\", \"rotation_z\"]\n", length)));
  EXPECT_TRUE(refused(scene("hold = [\"rotation_x\", \"rotation_z\"]\n", length)));
  EXPECT_FALSE(refused(scene("hold = [\"rotation\"]\n", length)));
}

TEST(Rotor, RefusesWhatCannotBe) {
  const Top top = asymmetric();
  const auto faults = [&](const std::string& integrator, const std::string& run) {
    return briefs_of([&] { Engine(scene_of(top.text(1.0, integrator, run)), {}); });
  };
  const auto about = [](const std::vector<std::string>& all, const std::string& key) {
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& one) { return one.find(key) != std::string::npos; });
  };
  EXPECT_TRUE(about(faults(verlet(0.01), ""), "run.integrator.type"));
  EXPECT_TRUE(about(faults(adaptive(1e-6), "dynamics = \"overdamped\"\n"), "run.dynamics"));
  EXPECT_TRUE(about(faults(adaptive(1e-6), "number_type = \"quadruple\"\n"),
                    "run.number_type = \"quadruple\""));
  EXPECT_TRUE(faults(adaptive(1e-6), "").empty());
}

/// A step of a radian or more fails and leaves numbers.
TEST(Rotor, StepsThatTurnItTooFarFail) {
  Top top = asymmetric();
  top.spin = {30.0, 0.0, 0.0};
  const RunResult result = run_text(top.text(10.0, fixed_step(0.1)));
  EXPECT_EQ(result.status, RunStatus::failed);
  EXPECT_TRUE(std::isfinite(result.body(0)["centre_of_mass"][0]));
}

}  // namespace
}  // namespace tomlin::test
