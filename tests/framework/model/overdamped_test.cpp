#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/order.hpp"
#include "tests/support/ring_scenes.hpp"

// Dynamics without inertia: friction times velocity is the force.

namespace tomlin::test {
namespace {

// ---- a particle on a corrugation under a constant force

constexpr double kFriction = 1.3;
constexpr double kAmplitude = 0.2;
constexpr double kPeriod = 0.7;
constexpr double kDepinning = kTau * kAmplitude / kPeriod;  // F_c

std::string tilted(double force, double duration, const std::string& integrator,
                   const std::string& more = "") {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.1]\nparticle_mass = 1.0\n"
         "[[force]]\ntype = \"constant_force\"\nforce = [" +
         digits(force) +
         "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(kFriction) +
         "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " + digits(kAmplitude) +
         "\nperiod = " + digits(kPeriod) +
         "\n[run]\ndynamics = \"overdamped\"\nduration = " + digits(duration) +
         "\nintegrator = " + integrator + "\n" + more;
}

double mean_velocity(double force) {
  return std::sqrt(force * force - kDepinning * kDepinning) / kFriction;
}

/// Over whole periods the mean velocity is sqrt(F^2 - F_c^2)/xi.
TEST(Overdamped, AParticleDepinsAsItShould) {
  for (const double over : {1.02, 1.5, 4.0}) {
    const double force = over * kDepinning;
    const double exact = mean_velocity(force);
    const double period = kPeriod / exact;
    const std::string window = "[measure]\nin = \"time\"\nfrom = " + digits(0.3 * period) +
                               "\nto = " + digits(3.3 * period) + "\n";
    const double fixed = run_text(tilted(force, 4.0 * period, fixed_step(period / 5000.0), window))
                             .body(0)["mean_velocity"][0];
    EXPECT_NEAR(fixed / exact, 1.0, 1e-9) << over;
    const double controlled =
        run_text(tilted(force, 4.0 * period, adaptive(1e-12), window)).body(0)["mean_velocity"][0];
    EXPECT_NEAR(controlled / exact, 1.0, 1e-9) << over;
  }
}

TEST(Overdamped, BelowDepinningItStaysPinned) {
  const double force = 0.98 * kDepinning;
  const RunResult result = run_text(tilted(force, 200.0, fixed_step(0.01)));
  // 2 pi V0/a sin(2 pi x/a) + F = 0 with a restoring slope: between the half and the whole period.
  const double phase = 0.5 + std::asin(force / kDepinning) / kTau;
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], phase * kPeriod, 1e-9);
  EXPECT_NEAR(result.body(0)["velocity"][0], 0.0, 1e-12);
}

/// The largest error at a few ends: at a single one leading terms may cancel.
TEST(Overdamped, ConvergesWithFourthOrder) {
  const double force = 1.3 * kDepinning;
  const auto end = [&](double duration, const std::string& integrator) {
    return run_text(tilted(force, duration, integrator)).body(0)["centre_of_mass"][0];
  };
  std::vector<double> steps;
  std::vector<double> errors;
  for (double h = 0.04; h > 0.004; h *= 0.5) {
    double error = 0.0;
    for (const double duration : {2.4, 2.8, 3.2}) {
      error = std::max(error, std::abs(end(duration, fixed_step(h)) -
                                       end(duration, fixed_step(duration / 40960))));
    }
    steps.push_back(h);
    errors.push_back(error);
  }
  const double rk4 = fitted_order(steps, errors, 1e-13);
  EXPECT_TRUE((Window{3.7, 4.3}.holds(rk4))) << rk4;
}

double velocity_at(double force, double x) {
  return (force + kDepinning * std::sin(kTau * x / kPeriod)) / kFriction;
}

/// How far sampled velocities are off force over friction at the sampled positions.
double worst_velocity(double force, const std::string& integrator) {
  KeptSamples kept;
  run(scene_of(tilted(force, 3.0, integrator, "[output]\nevery = 0.0931\n")), watched_by(kept));
  EXPECT_GT(kept.rows.size(), 30u);
  double worst = 0.0;
  for (const auto& row : kept.rows) {
    const double expected = velocity_at(force, row[kept.column("tip.centre_of_mass.x")]);
    worst = std::max(worst, std::abs(row[kept.column("tip.velocity.x")] - expected));
  }
  return worst;
}

TEST(Overdamped, TheVelocityIsForceOverFriction) {
  const double force = 1.3 * kDepinning;
  for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-9)}) {
    const ResultGroup tip = run_text(tilted(force, 3.0, integrator)).body(0);
    EXPECT_NEAR(tip["velocity"][0], velocity_at(force, tip["centre_of_mass"][0]), 1e-14);
    // The tip has passed where the substrate pushes most.
    EXPECT_NEAR(*tip["max_speed"], (force + kDepinning) / kFriction, 2e-3);
  }
  // Between step ends it is the slope of the dense output, of third order.
  const double longer = worst_velocity(force, fixed_step(0.005));
  const double shorter = worst_velocity(force, fixed_step(0.0025));
  EXPECT_NEAR(std::log2(longer / shorter), 3.0, 0.5);
  EXPECT_LT(worst_velocity(force, adaptive(1e-9)), 1e-5);
}

// ---- harmonic relaxation

std::string spring(double k, double c, double x0, double pull, double duration,
                   const std::string& integrator, const std::string& more = "") {
  return "[[body]]\ntype = \"point\"\nposition = [" + digits(x0) +
         "]\nparticle_mass = 7.0\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
         "start = [0.0]\nstiffness = " +
         digits(k) + "\nvelocity = [" + digits(pull) +
         "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(c) +
         "\n[run]\ndynamics = \"overdamped\"\nduration = " + digits(duration) +
         "\nintegrator = " + integrator + "\n" + more;
}

TEST(Overdamped, RelaxesExponentially) {
  const double k = 2.3, c = 0.9, x0 = 0.6, duration = 2.0;
  const double exact = x0 * std::exp(-k * duration / c);
  EXPECT_NEAR(
      run_text(spring(k, c, x0, 0.0, duration, fixed_step(1e-3))).body(0)["centre_of_mass"][0],
      exact, 1e-13);
  EXPECT_NEAR(
      run_text(spring(k, c, x0, 0.0, duration, adaptive(1e-12))).body(0)["centre_of_mass"][0],
      exact, 1e-11);
}

/// x = V t - c V / k (1 - exp(-k t / c)): the force settles at c V.
TEST(Overdamped, FollowsADriver) {
  const double k = 2.3, c = 0.9, pull = 0.4, duration = 2.0;
  const double lag = c * pull / k * -std::expm1(-k * duration / c);
  const RunResult result = run_text(spring(k, c, 0.0, pull, duration, fixed_step(1e-3)));
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], pull * duration - lag, 1e-13);
  EXPECT_NEAR(result.driver(0)["final_force"][0], k * lag, 1e-12);
  // From c x' = F, integrated over the run.
  EXPECT_NEAR(result.driver(0)["mean_force"][0], c * (pull * duration - lag) / duration, 1e-12);
}

/// The fastest relaxation is k/c; rk4 takes it up to h k/c = 2.785293563.
TEST(Overdamped, TheStableStepIsTheRelaxations) {
  const double k = 2.3, c = 0.9;
  const double limit = 2.785293563 * c / k;
  Engine engine(scene_of(spring(k, c, 0.6, 0.0, 2.0, fixed_step(0.01))), {});
  EXPECT_NEAR(stable_step_of(engine) / limit, 1.0, 1e-6);
  EXPECT_EQ(run_text(spring(k, c, 0.6, 0.0, 40.0, fixed_step(0.99 * limit))).status,
            RunStatus::finished);
  EXPECT_EQ(run_text(spring(k, c, 0.6, 0.0, 40.0, fixed_step(1.01 * limit))).status,
            RunStatus::failed);
}

// ---- rigid bodies: the limit of small masses

struct Lopsided {
  double mass = 1.0;  ///< of each particle
  std::string masses = "[1.0, 1.0, 1.0, 1.0, 1.0]";
  std::string hold = "[]";
  std::string dynamics = "overdamped";
  double duration = 2.0;

  std::string text(const std::string& integrator) const {
    return "[parameters]\nm = " + digits(mass) +
           "\n[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 5\nradius = 0.8\n"
           "centre = [0.1, 0.8]\ncoordinates = \"rigid\"\nparticle_mass = " +
           masses + "\nhold = " + hold +
           "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
           "attach = { particle = 1 }\nvelocity = [0.6, 0.1]\n"
           "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.35\n"
           "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.05\nperiod = 1.0\n"
           "decay = 0.4\n[run]\nduration = " +
           digits(duration) + "\ndynamics = \"" + dynamics + "\"\nintegrator = " + integrator +
           "\n";
  }
};

std::vector<double> end_position(const RunResult& result) {
  const ResultGroup& body = result.body(0);
  std::vector<double> all(body["centre_of_mass"].begin(), body["centre_of_mass"].end());
  all.push_back(body["rotation"].value_or(0.0));
  return all;
}

double distance_between(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squares);
}

/// With inertia the motion differs by O(m): friction centred on the mass and beside it, all
/// coordinates free and some held.
TEST(OverdampedRigid, IsTheLimitOfSmallMasses) {
  for (const std::string& masses :
       {std::string("\"m\""), std::string("[\"m\", \"7 * m\", \"3 * m\", \"2 * m\", \"4 * m\"]")}) {
    for (const std::string hold : {"[]", "[\"rotation\"]", "[\"x\"]", "[\"y\", \"rotation\"]"}) {
      SCOPED_TRACE(masses + ", hold " + hold);
      Lopsided ring{.masses = masses, .hold = hold};
      const auto limit = end_position(run_text(ring.text(adaptive(1e-11))));
      ring.dynamics = "inertial";
      std::vector<double> sizes, differences;
      for (const double mass : {4e-4, 2e-4, 1e-4}) {
        ring.mass = mass;
        sizes.push_back(mass);
        const RunResult heavy = run_text(ring.text(adaptive(1e-10)));
        ASSERT_EQ(heavy.status, RunStatus::finished);
        differences.push_back(distance_between(end_position(heavy), limit));
      }
      EXPECT_NEAR(fitted_order(sizes, differences), 1.0, 0.05);
      EXPECT_LT(differences.back(), 3e-3);
      // In the limit masses matter for nothing but the position of the centre.
      ring.dynamics = "overdamped";
      ring.mass = 5.0;
      EXPECT_LT(distance_between(end_position(run_text(ring.text(adaptive(1e-11)))), limit), 1e-8);
    }
  }
}

/// The centre about which a rigid body is described does not matter: particles move alike.
TEST(OverdampedRigid, MovesAlikeWhateverTheMassesAre) {
  Lopsided even;
  Lopsided uneven{.masses = "[1.0, 7.0, 3.0, 2.0, 4.0]"};
  const RunResult a = run_text(even.text(adaptive(1e-12)));
  const RunResult b = run_text(uneven.text(adaptive(1e-12)));
  EXPECT_NEAR(*a.body(0)["rotation"], *b.body(0)["rotation"], 1e-9);
  EXPECT_NEAR(a.driver(0)["final_force"][0], b.driver(0)["final_force"][0], 1e-9);
  EXPECT_NEAR(a.driver(0)["final_force"][1], b.driver(0)["final_force"][1], 1e-9);
  EXPECT_GT(std::abs(a.body(0)["centre_of_mass"][0] - b.body(0)["centre_of_mass"][0]), 1e-3);
}

TEST(OverdampedRigid, ConvergesWithTheOrderOfTheScheme) {
  const Lopsided ring{.masses = "[1.0, 7.0, 3.0, 2.0, 4.0]"};
  const auto exact = end_position(run_text(ring.text(adaptive(1e-13))));
  const auto order_of = [&](auto integrator) {
    std::vector<double> steps, errors;
    for (double h = 0.2; h > 0.02; h *= 0.5) {
      steps.push_back(h);
      errors.push_back(distance_between(end_position(run_text(ring.text(integrator(h)))), exact));
    }
    return fitted_order(steps, errors, 1e-12);
  };
  const double rk4 = order_of(fixed_step);
  EXPECT_TRUE((Window{3.6, 4.4}.holds(rk4))) << rk4;
  const double dopri5 = order_of(adaptive_held_to);
  EXPECT_TRUE((Window{4.5, 6.0}.holds(dopri5))) << dopri5;
}

/// Heavy at one end, equal friction at both: pulled at the heavy end across its length, that end
/// yields as if alone, twice as fast as the sum of frictions would have it.
TEST(OverdampedRigid, TheStableStepKnowsOfFrictionBesideTheCentre) {
  const double k = 100.0, c = 1.0;
  const auto dumbbell = [&](double dt) {
    return "[[body]]\ntype = \"particles\"\npositions = [[0.0, 0.0], [1.0, 0.0]]\n"
           "particle_mass = [1e9, 1.0]\ncoordinates = \"rigid\"\n"
           "[[force]]\ntype = \"driving_spring\"\nvelocity = [0.0, 0.0]\nstart = [0.0, 0.01]\n"
           "attach = { particle = 0 }\nstiffness = " +
           digits(k) + "\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(c) +
           "\n[run]\ndynamics = \"overdamped\"\nduration = 5.0\nintegrator = " + fixed_step(dt) +
           "\n";
  };
  const double limit = 2.785293563 * c / k;
  Engine engine(scene_of(dumbbell(0.01)), {});
  EXPECT_NEAR(stable_step_of(engine) / limit, 1.0, 1e-6);
  EXPECT_EQ(run_text(dumbbell(0.98 * limit)).status, RunStatus::finished);
  EXPECT_EQ(run_text(dumbbell(1.02 * limit)).steps, 0u) << "refused before it is taken";
}

// ---- held coordinates, and friction that is missing

TEST(Overdamped, WhatIsHeldNeedsNoFrictionAndStays) {
  const RunResult result =
      run_text(Lopsided{.hold = "[\"y\", \"rotation\"]"}.text(fixed_step(0.01)));
  EXPECT_EQ(result.body(0)["centre_of_mass"][1], 0.8);
  EXPECT_EQ(*result.body(0)["rotation"], 0.0);
  EXPECT_GT(result.body(0)["centre_of_mass"][0], 0.11);
}

std::string without_friction(const std::string& coordinates, const std::string& coefficient) {
  return "[[body]]\nname = \"raft\"\ntype = \"ring\"\nradius = 1.0\ncount = 3\n"
         "particle_mass = 1.0\ncentre = [0.0, 1.0]\ncoordinates = \"" +
         coordinates +
         "\"\n[[force]]\ntype = \"constant_force\"\nforce = [0.1, 0.0]\n"
         "[[force]]\ntype = \"viscous_damping\"\ncoefficient = " +
         coefficient +
         "\n[run]\nduration = 1.0\ndynamics = \"overdamped\"\nintegrator = " + fixed_step(0.1) +
         "\n";
}

TEST(Overdamped, MissingFrictionIsNamed) {
  const auto faults = [](const std::string& coordinates) {
    return briefs_of([&] { run_text(without_friction(coordinates, "0.0")); });
  };
  const std::string singular = "17:12 run.dynamics = \"overdamped\" [matrix.singular]";
  EXPECT_EQ(faults("particles"), std::vector<std::string>(5, singular));  // the first of six
  EXPECT_EQ(faults("rigid"), std::vector<std::string>(3, singular));
  const std::string of_particles = refusal(without_friction("particles", "0.0"));
  EXPECT_NE(of_particles.find("x of particle 0 of body \"raft\""), std::string::npos)
      << of_particles;
  const std::string of_body = refusal(without_friction("rigid", "0.0"));
  for (const char* coordinate : {"x of body \"raft\"", "y of body", "the rotation of body"}) {
    EXPECT_NE(of_body.find(coordinate), std::string::npos) << of_body;
  }
  EXPECT_EQ(refusal(without_friction("rigid", "0.1")), "");
}

}  // namespace
}  // namespace tomlin::test
