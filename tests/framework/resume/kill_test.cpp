#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/resume/resume_fixture.hpp"
#include "tests/support/tube_scene.hpp"

/// Runs that are killed at random moments, some again and again, end with the same bits in every
/// file as runs that are left alone.
namespace tomlin::test {
namespace {

/// Moments at which each scene's run is killed; more with TOMLIN_KILL_POINTS.
int kill_points() {
  constexpr int kDefault = 6;
  const char* asked = std::getenv("TOMLIN_KILL_POINTS");
  return asked != nullptr ? std::atoi(asked) : kDefault;
}

const std::string kTipForces = R"(
[[body]]
name = "tip"
type = "point"
position = [0.1]
particle_mass = 1.0
[[force]]
type = "viscous_damping"
coefficient = 0.7
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.2
period = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.1]
)";

const std::string kChain = R"(
[[body]]
name = "chain"
type = "chain"
count = 21
spacing = 1.1
particle_mass = 1.0
[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 5.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[[force]]
type = "viscous_damping"
coefficient = 0.3
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 1.0
velocity = [0.2]
)";

std::string ring(const std::string& coordinates) {
  return R"(
[[body]]
name = "ring"
type = "ring"
radius = 1.0
count = 8
particle_mass = "1 / 8"
centre = [0.0, 1.0]
coordinates = ")" +
         coordinates + R"("
[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 1e3
[[force]]
type = "viscous_damping"
coefficient = "2 / 8"
[[force]]
type = "sinusoidal_substrate"
amplitude = "0.1 / 8"
period = 1.0
decay = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.25, 0.0]
)";
}

std::string settings(const std::string& duration, const std::string& integrator,
                     const std::string& run = "", const std::string& every = "0.5") {
  return "[run]\nduration = " + duration + "\nintegrator = " + integrator +
         "\ncheckpoint_every = 0.01\n" + run + "[output]\nevery = " + every +
         "\ntrajectory = true\n";
}

const std::string kReverse = "reverse = { when = \"bodies.tip.centre_of_mass.x\", above = 60.0 }\n";
/// Variables that a force owns.
const std::string kMemory = R"(
[[force]]
type = "memory_damping"
coefficient = 0.5
memory_time = 2.0
)";
const std::string kThermostat = R"(
[[force]]
type = "nose_hoover_chain"
temperature = 0.1
period = 2.0
)";
const std::string kAdaptive =
    "{ type = \"dopri5\", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }";

const std::string kImplicit =
    "{ type = \"radau9\", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }";

const std::string kEighthOrder =
    "{ type = \"dop853\", absolute_tolerance = 1e-10, relative_tolerance = 1e-10 }";

const std::string kBath = R"(
[[force]]
name = "bath"
type = "langevin"
coefficient = 0.7
temperature = 0.02
)";

struct Named {
  const char* name;
  std::string text;
};

/// Each takes a few tenths of a second.
std::vector<Named> scenes() {
  return {
      {"tip, fixed steps", kTipForces + settings("4e3", "{ type = \"rk4\", dt = 5e-3 }")},
      {"tip, adaptive", kTipForces + settings("5e3", kAdaptive)},
      {"tip that turns round, fixed steps",
       kTipForces + kReverse + settings("1.2e3", "{ type = \"rk4\", dt = 2e-3 }")},
      {"tip that turns round, adaptive", kTipForces + kReverse + settings("4e3", kAdaptive)},
      {"chain", kChain + settings("600", "{ type = \"rk4\", dt = 1e-2 }", "ledger = true\n")},
      {"chain, Verlet", kChain + settings("1500", "{ type = \"velocity_verlet\", dt = 1e-2 }")},
      {"chain, exponential",
       kChain + settings("1000", "{ type = \"exponential_verlet\", dt = 1e-2 }")},
      {"tip with a memory",
       kTipForces + kMemory + settings("3e3", "{ type = \"rk4\", dt = 5e-3 }", "ledger = true\n")},
      {"tip with a memory, adaptive", kTipForces + kMemory + settings("4e3", kAdaptive)},
      {"tip, eighth order", kTipForces + settings("5e3", kEighthOrder)},
      {"chain with a thermostat",
       kChain + kThermostat +
           settings("1000", "{ type = \"velocity_verlet\", dt = 1e-2 }", "ledger = true\n")},
      {"chain, overdamped",
       kChain + settings("800", "{ type = \"rk4\", dt = 1e-2 }", "dynamics = \"overdamped\"\n")},
      {"flexible ring",
       ring("particles") + settings("250", "{ type = \"rk4\", dt = 4e-3 }", "ledger = true\n")},
      {"rigid ring", ring("rigid") + settings("1500", kAdaptive)},
      {"rigid ring, implicit", ring("rigid") + settings("600", kImplicit)},
      {"chain, implicit", kChain + settings("150", kImplicit)},
      {"tip, to an accuracy",
       kTipForces + "[run]\nduration = 6e3\naccuracy = 1e-4\ncheckpoint_every = 0.01\n"},
      {"perturbed starts",
       ring("particles") + settings("100", "{ type = \"rk4\", dt = 4e-3 }",
                                    "ledger = true\nperturb = { size = 1e-9, repeats = 2 }\n")},
  };
}

/// With noise: none of its numbers is in a checkpoint.
std::vector<Named> noisy_scenes() {
  return {
      {"tip in a bath, until its mean force is known",
       kTipForces + kBath +
           settings("1e5", "{ type = \"baoab\", dt = 1e-2 }",
                    "ledger = true\nuntil = { error = 4e-3, of = \"driver.mean_force.x\" }\n")},
      {"chain in a bath, overdamped",
       kChain + kBath +
           settings("600", "{ type = \"leimkuhler_matthews\", dt = 1e-2 }",
                    "dynamics = \"overdamped\"\n")},
  };
}

class Killed : public Cli {
 protected:
  Ended run_in(const std::string& folder, const std::function<void(pid_t)>& then = {}) {
    return tomlin({"run", "scene.toml", "-o", folder, "--resume", "--quiet"},
                  {.then = then, .environment = impatient()});
  }

  void kill_and_resume(const std::vector<Named>& scenes_of_runs, int moments);

  /// The longest a run takes when nobody else wants the machine, in seconds.
  double time_alone(const std::string& folder) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(run_in(folder).status, 0);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
};

/// Each is killed at so many moments; most of them lie within the runs.
void Killed::kill_and_resume(const std::vector<Named>& scenes_of_runs, int moments) {
  std::mt19937 random(20240511);
  std::uniform_real_distribution<double> part(0.0, 1.1);
  constexpr int kSignals[] = {SIGKILL, SIGKILL, SIGTERM, SIGINT};
  constexpr int kMostTimes = 3;  // that one run is killed
  int stopped = 0;
  int points = 0;
  for (const auto& [name, text] : scenes_of_runs) {
    SCOPED_TRACE(name);
    write(folder_ / "scene.toml", text);
    fs::remove_all(folder_ / "alone");
    const double whole = time_alone("alone");
    for (int point = 0; point < moments && !HasFailure(); ++point) {
      SCOPED_TRACE(point);
      ++points;
      fs::remove_all(folder_ / "killed");
      const int times = 1 + static_cast<int>(random() % kMostTimes);
      for (int time = 0; time < times; ++time) {
        const std::chrono::duration<double> wait(whole * part(random) / times);
        const int signal = kSignals[random() % std::size(kSignals)];
        const Ended ended = run_in("killed", signal_after(wait, signal));
        EXPECT_TRUE(ended.status == 0 || ended.status == 128 + signal)
            << ended.status << " " << ended.err;
        if (ended.status == 0) continue;
        ++stopped;
      }
      expect_status(0, run_in("killed"));
      EXPECT_EQ(differing(folder_ / "alone", folder_ / "killed"), "");
    }
  }
  EXPECT_GT(stopped, points / 2);
}

TEST_F(Killed, RunsEndWithTheSameBits) { kill_and_resume(scenes(), kill_points()); }

/// A dozen moments; a hundred in the test `kills_with_noise`, of the label slow.
TEST_F(Killed, NoisyRunsEndWithTheSameBits) {
  const char* asked = std::getenv("TOMLIN_NOISY_KILL_POINTS");
  kill_and_resume(noisy_scenes(), asked != nullptr ? std::atoi(asked) : 6);
}

/// Neighbour lists are no part of a checkpoint. A hundred moments in the test
/// `kills_of_molecular_dynamics`, of the label slow.
TEST_F(Killed, MolecularDynamicsEndsWithTheSameBits) {
  const char* asked = std::getenv("TOMLIN_DYNAMICS_KILL_POINTS");
  const std::string scene =
      tube_scene_with("duration = 1.0", "duration = 10.0\ncheckpoint_every = 0.01",
                      tube_scene_with("every = 0.05", "every = 0.02"));
  kill_and_resume({{"tube on a sheet", scene}}, asked != nullptr ? std::atoi(asked) : 15);
}

/// The comparison above sees a single bit.
TEST_F(Killed, OneBitWouldBeSeen) {
  write(folder_ / "scene.toml", kShortRun);
  ASSERT_EQ(run_in("alone").status, 0);
  fs::copy(folder_ / "alone", folder_ / "other");
  EXPECT_EQ(differing(folder_ / "alone", folder_ / "other"), "");
  std::string table = file("other/observables.csv");
  table[table.size() - 2] = table[table.size() - 2] == '1' ? '2' : '1';
  write(folder_.path() / "other" / "observables.csv", table);
  EXPECT_EQ(differing(folder_ / "alone", folder_ / "other"), "observables.csv ");
}

}  // namespace
}  // namespace tomlin::test
