#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

// The Nose-Hoover chain in runs. That its operator is the exact flow of its equations, with the
// heat that is gone, is among the verified properties of its record.

namespace tomlin::test {
namespace {

constexpr double kBath = 0.3;

std::string chain_of(int links, double temperature = kBath, double period = 6.0) {
  return "[[force]]\nname = \"bath\"\ntype = \"nose_hoover_chain\"\ntemperature = " +
         digits(temperature) + "\nperiod = " + digits(period) +
         "\nlinks = " + std::to_string(links) + "\n";
}

std::string chain_run(const std::string& scheme, double dt, double duration,
                      const std::string& more = "") {
  return "[run]\nduration = " + digits(duration) + "\nintegrator = { type = \"" + scheme +
         "\", dt = " + digits(dt) + " }\n" + more;
}

std::string oscillator(double position, double velocity) {
  return "[[body]]\nname = \"body\"\ntype = \"point\"\nposition = [" + digits(position) +
         "]\nvelocity = [" + digits(velocity) +
         "]\nparticle_mass = 2.0\n[[force]]\nname = \"spring\"\ntype = \"driving_spring\"\n"
         "stiffness = 2.0\nvelocity = [0.0]\nstart = [0.0]\n";
}

/// Bonds that are no harmonic springs, with a corrugation below: chaotic.
std::string corrugated_chain(const std::string& body = "origin = [0.0]\n", int count = 12) {
  return "[[body]]\nname = \"body\"\ntype = \"chain\"\ncount = " + std::to_string(count) + "\n" +
         body +
         "spacing = 1.0\nparticle_mass = 1.3\nstart_temperature = 0.3\n"
         "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 5.0\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.4\nperiod = 1.3\n";
}

/// Returns the energy of the links, from their variables.
double energy_of_links(Engine& engine, std::size_t links, double freedom, double temperature,
                       double period) {
  const std::vector<double> own = field_of(engine, "integrals");
  const double omega = 2.0 * M_PI / period;
  double energy = 0.0;
  for (std::size_t k = 0; k < links; ++k) {
    const double thermal = (k == 0 ? freedom : 1.0) * temperature;
    const double velocity = own[links + k] / omega;
    energy += thermal * (own[k] + 0.5 * velocity * velocity);
  }
  return energy;
}

// ---- canonical or not

struct ChainMoments {
  std::array<double, 4> of{};  ///< x^2, x^4/3, v^2, v^4/3, in units of those that are canonical
};

ChainMoments moments_of(const std::string& text, double position_variance,
                        double velocity_variance) {
  KeptSamples samples;
  const RunResult result = run_text(text, {}, watched_by(samples));
  EXPECT_EQ(result.status, RunStatus::finished);
  const std::size_t x = samples.column("body.centre_of_mass.x");
  const std::size_t v = samples.column("body.velocity.x");
  ChainMoments found;
  for (const auto& row : samples.rows) {
    const double position = row[x] * row[x] / position_variance;
    const double velocity = row[v] * row[v] / velocity_variance;
    found.of[0] += position;
    found.of[1] += position * position / 3.0;
    found.of[2] += velocity;
    found.of[3] += velocity * velocity / 3.0;
  }
  for (double& moment : found.of) moment /= static_cast<double>(samples.rows.size());
  return found;
}

/// In 20 000 units of time, some 3000 periods, second moments scatter by 0.02 from start to start,
/// fourth ones by 0.04 (measured); windows are five times as wide.
bool is_canonical(const ChainMoments& found) {
  constexpr Window kSecond{0.9, 1.1};
  constexpr Window kFourth{0.8, 1.2};
  return kSecond.holds(found.of[0]) && kFourth.holds(found.of[1]) && kSecond.holds(found.of[2]) &&
         kFourth.holds(found.of[3]);
}

constexpr std::array<double, 6> kStarts = {0.3, 0.5, 0.8, 1.0, 1.7, 2.5};

ChainMoments of_oscillator(double start, int links) {
  const double thermal = std::sqrt(kBath / 2.0);  // of mass 2, and stiffness 2
  return moments_of(oscillator(0.1 * thermal, start * thermal) +
                        chain_of(links, kBath, 2.0 * M_PI) +
                        chain_run("velocity_verlet", 0.1, 2e4) + "[output]\nevery = 0.5\n",
                    kBath / 2.0, kBath / 2.0);
}

TEST(NoseHooverChain, ThreeLinksMakeAnOscillatorCanonical) {
  ChainMoments mean;
  for (const double start : kStarts) {
    const ChainMoments found = of_oscillator(start, 3);
    EXPECT_TRUE(is_canonical(found)) << start << ": " << found.of[0] << " " << found.of[1] << " "
                                     << found.of[2] << " " << found.of[3];
    for (std::size_t k = 0; k < 4; ++k) mean.of[k] += found.of[k] / kStarts.size();
  }
  // Means of six starts, within four of their standard errors.
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(mean.of[k], 1.0, k % 2 == 0 ? 0.03 : 0.07) << k;
}

/// The negative control: the trajectory of a single thermostat stays on a torus.
TEST(NoseHooverChain, OneLinkDoesNot) {
  for (const double start : kStarts) {
    const ChainMoments found = of_oscillator(start, 1);
    EXPECT_FALSE(is_canonical(found)) << start;
    EXPECT_NEAR(found.of[2], 1.0, 0.01) << "of which the mean kinetic energy says nothing";
  }
}

// ---- temperature

struct ChainTemperature {
  double value;
  double error;
};

ChainTemperature chain_temperature(const std::string& scene) {
  const RunResult result =
      run_text(scene + chain_of(3) +
               chain_run("baoab", 0.05, 5000.0, "[measure]\nin = \"time\"\nfrom = 200.0\n"));
  EXPECT_EQ(result.status, RunStatus::finished);
  for (const ErrorEstimate& estimate : result.errors) {
    if (estimate.path != "bodies.body.temperature" || !estimate.error) continue;
    return {body_of(result, "body")["temperature"][0], *estimate.error};
  }
  ADD_FAILURE() << "no error of the temperature";
  return {0.0, 0.0};
}

TEST(NoseHooverChain, KeepsTheTemperatureOfWhatIsFree) {
  for (const std::string body :
       {"origin = [0.0]\n", "origin = [0.0, 0.0]\n", "origin = [0.0, 0.0]\nhold = [\"y\"]\n"}) {
    constexpr int kCount = 6;
    const ChainTemperature found = chain_temperature(corrugated_chain(body, kCount));
    EXPECT_NEAR(found.value, kBath, 4.0 * found.error) << body;
    EXPECT_LT(found.error, 0.02 * kBath) << body << " shows nothing";
    // One coordinate more or less among twelve would be seen.
    EXPECT_GT(kBath / 12.0, 4.0 * found.error) << body;
  }
}

/// A temperature in K, and periods in ps.
TEST(NoseHooverChain, KeepsTheTemperatureInMetalUnits) {
  const RunResult result = run_text(
      "[scene]\nunits = \"metal\"\n[[body]]\nname = \"body\"\ntype = \"chain\"\ncount = 20\n"
      "spacing = 1.5\nparticle_mass = 12.0\nstart_temperature = 600.0\n[[force]]\n"
      "type = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 5.0\n[[force]]\n"
      "type = \"sinusoidal_substrate\"\namplitude = 0.05\nperiod = 2.0\n[[force]]\n"
      "type = \"nose_hoover_chain\"\ntemperature = 300.0\nperiod = 0.1\n[run]\nduration = 200.0\n"
      "integrator = { type = \"baoab\", dt = 2e-3 }\n[measure]\nin = \"time\"\nfrom = 10.0\n");
  ASSERT_EQ(result.status, RunStatus::finished);
  // The mean is over 20 free coordinates in 190 ps, thousands of exchanges with the chain.
  EXPECT_NEAR(body_of(result, "body")["temperature"][0], 300.0, 6.0);
}

/// Centre and rotation have three coordinates together.
TEST(NoseHooverChain, KeepsTheTemperatureOfARigidBody) {
  const std::string ring =
      "[[body]]\nname = \"body\"\ntype = \"ring\"\ncount = 5\nradius = 0.8\n"
      "centre = [0.1, 1.0]\nparticle_mass = [0.1, 0.7, 0.3, 0.2, 0.4]\n"
      "coordinates = \"rigid\"\nstart_temperature = 0.3\n"
      "[[force]]\nname = \"spring\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
      "velocity = [0.0, 0.0]\n"
      "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.3\n"
      "decay = 0.3\n";
  const ChainTemperature found = chain_temperature(ring);
  EXPECT_NEAR(found.value, kBath, 4.0 * found.error);
  EXPECT_LT(found.error, 0.03 * kBath) << "shows nothing";
}

// ---- energies

RunResult ended(const std::string& text, std::unique_ptr<Engine>& engine) {
  engine = std::make_unique<Engine>(scene_of(text), RunOptions{});
  return engine->run();
}

/// Nothing but the thermostat acts: what the ledger counts is what is gone, at any step, however
/// far from the temperature.
TEST(NoseHooverChain, LedgerClosesWithTheHeat) {
  for (const double dt : {0.01, 0.7}) {
    for (const double temperature : {3e-5, 0.3, 300.0}) {
      std::unique_ptr<Engine> engine;
      const RunResult result = ended(
          "[[body]]\nname = \"body\"\ntype = \"chain\"\ncount = 100\norigin = [0.0]\n"
          "spacing = 1.0\nparticle_mass = 0.5\nstart_temperature = 0.3\n" +
              chain_of(3, temperature) +
              chain_run("velocity_verlet", dt, 70.0, "ledger = true\nallow_unstable = true\n"),
          engine);
      ASSERT_EQ(result.status, RunStatus::finished);
      const ResultGroup& energy = result.group("energy");
      const double size = std::abs(*energy["heat_out"]) + 100.0 * temperature;
      EXPECT_NEAR(*energy["numerical_work"], 0.0, 1e-12 * size) << dt << " " << temperature;
      EXPECT_NEAR(*energy["heat_out"], energy_of_links(*engine, 3, 100.0, temperature, 6.0),
                  1e-11 * size)
          << dt << " " << temperature;
    }
  }
}

/// With forces: the heat is what the links have, and the energy with it is conserved to the order
/// of the scheme.
TEST(NoseHooverChain, ExtendedEnergyDriftsInSecondOrder) {
  struct Case {
    std::string scene;
    double freedom;
    double coarsest;
  };
  for (const auto& [scene, freedom, coarsest] :
       {Case{oscillator(0.4, 0.2), 1.0, 0.2}, Case{corrugated_chain(), 12.0, 0.08}}) {
    for (const std::string scheme : {"velocity_verlet", "baoab"}) {
      for (const int links : {1, 3, 5}) {
        SCOPED_TRACE(scheme + " " + std::to_string(links));
        std::vector<double> steps, drifts;
        for (double dt = coarsest; dt > 0.05 * coarsest; dt *= 0.5) {
          // At several times: a drift swings, and passes zero.
          double squares = 0.0;
          for (const double duration : {4.0, 4.8, 5.6, 6.4, 7.2, 8.0}) {
            std::unique_ptr<Engine> engine;
            const RunResult result =
                ended(scene + chain_of(links) + chain_run(scheme, dt, duration, "ledger = true\n"),
                      engine);
            const ResultGroup& energy = result.group("energy");
            EXPECT_NEAR(
                *energy["heat_out"],
                energy_of_links(*engine, static_cast<std::size_t>(links), freedom, kBath, 6.0),
                1e-12 * freedom);
            squares += *energy["numerical_work"] * *energy["numerical_work"];
          }
          steps.push_back(dt);
          drifts.push_back(std::sqrt(squares));
        }
        constexpr Window kSecondOrder{1.8, 2.2};
        EXPECT_TRUE(kSecondOrder.holds(fitted_order(steps, drifts)))
            << fitted_order(steps, drifts) << ", " << drifts.back();
      }
    }
  }
}

/// Velocities turned round, those of the links too, the run goes back.
TEST(NoseHooverChain, IsReversible) {
  const std::string text =
      corrugated_chain() + chain_of(3) + chain_run("velocity_verlet", 0.05, 20.0);
  Engine engine(scene_of(text), {});
  const std::vector<double> start = field_of(engine, "position");
  constexpr std::uint64_t kSteps = 150;
  engine.advance(kSteps);
  const std::vector<double> there = field_of(engine, "position");
  double* const velocity = engine.state().reals("velocity");
  double* const own = engine.state().reals("integrals");
  for (std::size_t i = 0; i < field_of(engine, "velocity").size(); ++i) velocity[i] = -velocity[i];
  for (std::size_t k = 3; k < 6; ++k) own[k] = -own[k];
  engine.advance(kSteps);
  const std::vector<double> back = field_of(engine, "position");
  double moved = 0.0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    moved = std::max(moved, std::abs(there[i] - start[i]));
    EXPECT_NEAR(back[i], start[i], 1e-11) << i;  // rounding, and what chaos makes of it
  }
  EXPECT_GT(moved, 0.1);
}

// ---- bits and precisions

TEST(NoseHooverChain, SameBitsOnEverySetAndAfterResumption) {
  for (const std::string scheme : {"velocity_verlet", "baoab", "gjf"}) {
    for (const std::string type : {"double", "quadruple"}) {
      const std::string text =
          corrugated_chain() + chain_of(3) +
          chain_run(scheme, 0.05, 3.0, "ledger = true\nnumber_type = \"" + type + "\"\n");
      const Motion expected = motion_at_end(text);
      for (const InstructionSet set :
           {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
        if (!is_supported(set)) continue;
        RunOptions options;
        options.instruction_set = set;
        EXPECT_TRUE(motion_at_end(text, {}, options) == expected) << scheme << " " << type;
      }
      for (const std::uint64_t steps : {1, 17, 40}) {
        Engine first(scene_of(text), {});
        first.advance(steps);
        Engine second(scene_of(text), {});
        second.resume(first.state().to_bytes());
        second.run();
        EXPECT_TRUE(Motion(second) == expected) << scheme << " " << type << " " << steps;
      }
    }
  }
}

TEST(NoseHooverChain, PrecisionsAgreeWithinTheirRounding) {
  const auto end = [](const std::string& type) {
    return motion_at_end(oscillator(0.4, 0.2) + chain_of(3) +
                         chain_run("velocity_verlet", 0.05, 20.0,
                                   "number_type = \"" + type + "\"\nledger = true\n"));
  };
  const Motion exact = end("quadruple");
  const auto worst = [&](const Motion& found) {
    double most = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {  // of the links
      most = std::max(most, std::abs(found.integrals[k] - exact.integrals[k]));
    }
    return std::max({most, std::abs(found.position[0] - exact.position[0]),
                     std::abs(found.velocity[0] - exact.velocity[0])});
  };
  // A chaotic motion has made the rounding of 400 steps some thousand times larger by then.
  EXPECT_LT(worst(end("double")), 1e-12);
}

// ---- far from the temperature

/// At any start temperature a run finishes or fails with a cause, and no result is NaN.
TEST(NoseHooverChain, BodiesMuchTooHot) {
  for (const double ratio : {1e2, 1e4, 1e6, 1e20, 1e200}) {
    const RunResult result = run_text(
        "[[body]]\nname = \"body\"\ntype = \"chain\"\ncount = 100\norigin = [0.0]\nspacing = 1.0\n"
        "particle_mass = 1.0\nvelocity = [1.0]\n" +
        chain_of(3, 1.0 / ratio) +
        chain_run("velocity_verlet", 0.05, 0.5, "ledger = true\nallow_unstable = true\n"));
    if (ratio < 1e5) {
      EXPECT_EQ(result.status, RunStatus::finished) << ratio;
    }
    if (result.status == RunStatus::failed) {
      ASSERT_TRUE(result.failure) << ratio;
      EXPECT_NE(result.failure->what, "") << ratio;
      continue;
    }
    EXPECT_TRUE(std::isfinite(*result.group("energy")["heat_out"])) << ratio;
  }
}

// ---- refusals

struct RefusedChain {
  std::string body = "position = [0.0]";  // line 3
  std::string links = "3";                // line 10
  std::string run = "integrator = { type = \"velocity_verlet\", dt = 0.01 }";
  std::string more = "";
  std::string faults = "";

  std::string text() const {
    return "[[body]]\ntype = \"point\"\n" + body +
           "\nparticle_mass = 1.0\n[[force]]\nname = \"bath\"\ntype = \"nose_hoover_chain\"\n"
           "temperature = 0.2\nperiod = 2.0\nlinks = " +
           links + "\n[run]\nduration = 1.0\n" + run + "\n" + more;
  }
};

std::string integrator_of(const std::string& scheme) { return "integrator = { " + scheme + " }"; }

std::vector<RefusedChain> refused_chains() {
  std::vector<RefusedChain> all;
  for (const std::string scheme :
       {"rk4", "midpoint", "dopri5", "dop853", "radau9", "exponential_verlet", "blanes_moan"}) {
    const std::string step = standard().integrator(scheme)->adaptive ? "" : ", dt = 0.01";
    all.push_back(
        {.run = integrator_of("type = \"" + scheme + "\"" + step),
         .faults = "13:14 run.integrator.type = \"" + scheme + "\" [integrator.unsuitable]"});
  }
  all.push_back({.links = "0", .faults = "10:9 force.bath.links = 0 [scene.out_of_range]"});
  all.push_back({.links = "101", .faults = "10:9 force.bath.links = 101 [scene.out_of_range]"});
  all.push_back({.body = "position = [0.0]\ncoordinates = \"fixed\"",
                 .faults = "9:15 force.bath.temperature [component.unsuitable]"});
  all.push_back(
      {.body = "position = [0.0]\ncoordinates = \"prescribed\"\nmotion = { velocity = [1.0] }",
       .faults = "10:15 force.bath.temperature [component.unsuitable]"});
  all.push_back({.body = "position = [0.0]\nhold = [\"x\"]",
                 .faults = "9:15 force.bath.temperature [component.unsuitable]"});
  all.push_back({.run = "accuracy = 1e-4", .faults = "13:12 run.accuracy [component.unsuitable]"});
  all.push_back({.run = "dynamics = \"quasistatic\"",
                 .faults = "13:12 run.dynamics = \"quasistatic\" [component.unsuitable]"});
  all.push_back({.more = "[output]\nevery = 0.025\n",
                 .faults = "15:9 output.every = 0.025 [component.unsuitable]"});
  const std::string other =
      "[[force]]\nname = \"second\"\ntype = \"langevin\"\ncoefficient = 1.0\ntemperature = 0.1\n";
  all.push_back({.more = other, .faults = "18:15 force.second.temperature [component.unsuitable]"});
  all.push_back({.more = "[[force]]\nname = \"second\"\ntype = \"nose_hoover_chain\"\n"
                         "temperature = 0.1\nperiod = 1.0\n",
                 .faults = "17:15 force.second.temperature [component.unsuitable]"});
  return all;
}

TEST(NoseHooverChain, RefusalsHavePlaceAndCode) {
  for (const RefusedChain& refused : refused_chains()) {
    EXPECT_EQ(brief_refusal(refused.text()), refused.faults) << refused.text();
  }
}

TEST(NoseHooverChain, WhatIsNotRefused) {
  const std::vector<RefusedChain> taken = {
      {},
      {.links = "100"},
      {.body = "position = [0.0]\ncoordinates = \"rigid\""},
      {.run = integrator_of("type = \"baoab\", dt = 0.01")},
      {.run = integrator_of("type = \"gjf\", dt = 0.01")},
      {.more = "[output]\nevery = 0.03\n"},
      {.more = "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"},
      {.more = "[[force]]\ntype = \"langevin\"\ncoefficient = 1.0\ntemperature = 0.0\n"},
  };
  for (const RefusedChain& scene : taken) EXPECT_EQ(refusal(scene.text()), "") << scene.text();
}

TEST(NoseHooverChain, OverdampedDynamicsHaveNoVelocities) {
  const std::string faults = brief_refusal(RefusedChain{
      .run = "dynamics = \"overdamped\"\n" + integrator_of("type = \"euler_maruyama\", dt = 0.01"),
      .more = "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n"}
                                               .text());
  EXPECT_NE(faults.find("13:12 run.dynamics = \"overdamped\" [component.unsuitable]"),
            std::string::npos)
      << faults;
}

}  // namespace
}  // namespace tomlin::test
