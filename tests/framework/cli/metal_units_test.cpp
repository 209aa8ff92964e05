#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/cli/cli_fixture.hpp"

// Scenes in metal units through the program: what stands in tables, summaries, figures and on the
// screen is in eV, Angstrom, ps, u and K, as what the scene gives.

namespace tomlin::test {
namespace {

constexpr const char* kDimer = R"([scene]
name = "a dimer in a bath"
units = "metal"

[parameters]
T = 300

[[body]]
name = "dimer"
type = "chain"
count = 2
spacing = 1.42
particle_mass = [12.011, 28.0855]
start_temperature = "T"

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 0.5
velocity = [0.2]

[[force]]
name = "bond"
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 3.0

[[force]]
name = "bath"
type = "langevin"
coefficient = 0.01
temperature = "T"

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.2
period = 2.46

[run]
duration = 400.0
integrator = { type = "baoab", dt = 0.01 }
ledger = true

[measure]
in = "time"
from = 10.0
to = 400.0

[output]
every = 0.5
trajectory = true
)";

class MetalUnits : public Cli {
 protected:
  void SetUp() override { write(folder_ / "dimer.toml", kDimer); }

  void run_dimer(const std::string& folder, const std::vector<std::string>& more = {}) {
    expect_status(0, tomlin(plus({"run", "dimer.toml", "-o", folder, "--quiet"}, more)));
  }
};

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

TEST_F(MetalUnits, StandInHeaders) {
  run_dimer("out");
  EXPECT_EQ(first_line(file("out/observables.csv")),
            "time [ps],driver.force.x [eV/A],driver.position.x [A],dimer.centre_of_mass.x [A],"
            "dimer.velocity.x [A/ps]");
  EXPECT_EQ(first_line(file("out/events.csv")),
            "time [ps],event,name,duration [ps],size,energy_lost [eV],peak_force [eV/A]");
}

TEST_F(MetalUnits, StandInTheSummary) {
  run_dimer("out", {"--set", "force.driver.velocity=[0.0]"});
  const Json summary = this->summary("out");
  EXPECT_EQ(summary["scene"]["units"], "metal");
  EXPECT_EQ(summary["parameters"]["T"], 300);
  // A window of a thousand correlation times; a third more than 300 K would be seen.
  const double temperature = summary["bodies"]["dimer"]["temperature"];
  EXPECT_GT(temperature, 225.0);
  EXPECT_LT(temperature, 400.0);
  const double error = summary["error"]["bodies.dimer.temperature"];
  EXPECT_GT(error, 1.0);
  EXPECT_LT(error, 60.0);
}

TEST_F(MetalUnits, ReducedOnesAreNotNamed) {
  write(folder_ / "tip.toml", kTip);
  ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "tip", "--quiet"}).status, 0);
  EXPECT_FALSE(summary("tip")["scene"].contains("units"));
  EXPECT_TRUE(
      contains(first_line(file("tip/observables.csv")), "time [time],driver.force.x [force]"));
}

TEST_F(MetalUnits, StandOnTheScreen) {
  const Ended ended = tomlin({"run", "dimer.toml", "-o", "out"});
  expect_parts(ended.out,
               {"at time 400 ps after", "time 10 to 400 ps", " eV/A", " A/ps", " K", " eV"});
  const Ended explained = tomlin({"explain", "dimer.toml"});
  expect_parts(explained.out, {"metal units (eV, A, ps, u, K)", "mass 40.1 u"});
  const Json json = Json::parse(tomlin({"explain", "dimer.toml", "--json"}).out);
  EXPECT_EQ(json["scene"]["units"], "metal");
  EXPECT_NEAR(json["bodies"][0]["mass"].get<double>(), 12.011 + 28.0855, 1e-13);
}

/// The scene that a run has left runs again, to the bit, and has the numbers that were given.
TEST_F(MetalUnits, SceneIsRunAgain) {
  run_dimer("out", {"--set", "T=250"});
  const std::string scene = file("out/scene.toml");
  expect_parts(scene, {"units = \"metal\"", "T = 250", "particle_mass = [12.011, 28.0855]"});
  ASSERT_EQ(tomlin({"run", "out/scene.toml", "-o", "again", "--quiet"}).status, 0);
  EXPECT_EQ(file("again/scene.toml"), scene);
  EXPECT_EQ(file("again/observables.csv"), file("out/observables.csv"));
  EXPECT_EQ(file("again/events.csv"), file("out/events.csv"));
  EXPECT_EQ(comparable_summary("out"), comparable_summary("again"));
}

/// Particles from a file: the effective scene states what stands in it.
TEST_F(MetalUnits, ParticlesOfAFile) {
  write(folder_ / "dimer.toml", replaced(kDimer, "type = \"chain\"\ncount = 2\nspacing = 1.42\n",
                                         "type = \"particles\"\nfile = \"dimer.dat\"\n"));
  write(folder_ / "dimer.dat", "0.0\n1.42\n");
  run_dimer("out");
  expect_parts(file("out/scene.toml"),
               {"particle_mass = [12.011, 28.0855]", "start_temperature = \"T\""});
  ASSERT_EQ(tomlin({"run", "out/scene.toml", "-o", "again", "--quiet"}).status, 0);
  EXPECT_EQ(file("again/observables.csv"), file("out/observables.csv"));
}

TEST_F(MetalUnits, SweptTemperaturesAreInKelvin) {
  expect_status(0, tomlin({"sweep", "dimer.toml", "--over", "T=100,300,900", "--observable",
                           "dimer.temperature", "--observable", "driver.mean_force.x", "-o",
                           "sweep", "--quiet"}));
  const std::string table = file("sweep/sweep.csv");
  EXPECT_TRUE(contains(first_line(table), "T,dimer.temperature [K],driver.mean_force.x [eV/A]"))
      << table;
  EXPECT_TRUE(contains(first_line(table), "error.dimer.temperature [K]")) << table;
  std::size_t at = table.find('\n') + 1;
  for (const double expected : {100.0, 300.0, 900.0}) {
    char* end = nullptr;
    EXPECT_EQ(std::strtod(table.c_str() + at, &end), expected);
    const double found = std::strtod(end + 1, nullptr);
    // A window's mean scatters by a tenth; drift and slips count as heat.
    EXPECT_GT(found, 0.7 * expected);
    EXPECT_LT(found, 1.5 * expected + 30.0);
    at = table.find('\n', at) + 1;
  }
}

TEST_F(MetalUnits, AreNamedWhereTheyAreUnknown) {
  expect_refused({"run", "dimer.toml", "--set", "scene.units=SI", "-o", "out"},
                 "--set scene.units=SI: scene.units = SI [scene.unknown_choice]\n",
                 {"\"reduced\"", "\"metal\": eV, Angstrom, ps, u, K"});
  expect_refused({"run", "dimer.toml", "--set", "scene.units=real", "-o", "out"},
                 "--set scene.units=real: scene.units = real [scene.unknown_choice]\n",
                 {"\"metal\": eV, Angstrom, ps, u, K"});
}

}  // namespace
}  // namespace tomlin::test
