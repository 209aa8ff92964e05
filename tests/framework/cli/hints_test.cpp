#include <string>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"

/// Messages about frequent mistakes name the cure, not only the symptom.
namespace tomlin::test {
namespace {

const std::string kNoisy = R"([parameters]
T = 0.01
v = 0.01
[[body]]
name = "tip"
type = "point"
position = [0.1]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 1.0
velocity = ["v"]
[[force]]
type = "langevin"
coefficient = 0.5
temperature = "T"
[run]
duration = 20.0
integrator = { type = "baoab", dt = 0.05 }
)";

class Hints : public Cli {
 protected:
  std::string said_of(const std::string& scene, const std::vector<std::string>& settings) {
    write(folder_ / "scene.toml", scene);
    std::vector<std::string> arguments = {"run", "scene.toml"};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    return refused(arguments);
  }
  std::string refused(const std::vector<std::string>& arguments) {
    return expect_status(2, tomlin(arguments)).err;
  }
};

TEST_F(Hints, UnitsBehindNumbers) {
  expect_parts(said_of(kTip, {"v='1%'"}), {"1 / 100", "absolute"});
  expect_parts(said_of(kTip, {"v='30 deg'"}), {"30 * pi / 180", "radians"});
  EXPECT_FALSE(contains(said_of(kTip, {"v='30 deg'"}), "write 30,"));
}

TEST_F(Hints, RunsUntilSteadyUnderNoise) {
  const std::string text =
      said_of(kNoisy, {R"(run.until={ steady = "driver.mean_force.x", tolerance = 0.1 })"});
  expect_parts(text, {"error = ..", "of = .."});
  EXPECT_FALSE(contains(text, "run.stream"));
}

TEST_F(Hints, SamplesBetweenSteps) {
  expect_parts(said_of(kNoisy, {"output.every=0.32"}), {"0.3 or 0.35"});
}

TEST_F(Hints, RepeatsWithoutNoise) {
  const std::string text = refused({"sweep", "tip.toml", "--over", "v=0.1,0.2", "--observable",
                                    "driver.mean_force.x", "--repeats", "3"});
  expect_parts(text, {"3", "the scene has no noise"});
  EXPECT_FALSE(contains(text, "run.stream"));
  expect_parts(said_of(kTip, {"run.repeats=3"}), {"run.repeats = 3: the scene has no noise"});
}

TEST_F(Hints, ASceneIsNoFolderOfASweep) {
  const std::string text = refused({"merge", "tip.toml", "-o", "all"});
  expect_parts(text, {"tip.toml", "is not the folder of a sweep"});
  EXPECT_FALSE(contains(text, "scene.toml"));
}

TEST_F(Hints, TwoAxesInOneOption) {
  const std::string text = refused(
      {"sweep", "tip.toml", "--over", "v=1,2;run.duration=1,2", "--observable", "events.slips"});
  expect_parts(text, {"another --over"});
  EXPECT_FALSE(contains(text, "unexpected character"));
}

TEST_F(Hints, LevelsFollowAnEqualsSign) {
  expect_parts(
      refused({"sweep", "tip.toml", "--over", "v=0.1,0.2", "--refine", "events.slips>0.5"}),
      {"OBSERVABLE=LEVEL"});
}

TEST_F(Hints, OtherNames) {
  expect_parts(said_of(replaced(kNoisy, "coefficient = ", "gamma = "), {}),
               {"mass times the rate gamma", "did you mean \"coefficient\""});
  expect_parts(said_of(kTip, {"force.driver.stiffness='2*j'"}), {"the index is 'i'"});
  const std::string surface = R"([[body]]
type = "point"
position = [0.1, 0.0]
particle_mass = 1.0
[[force]]
type = "lattice_substrate"
lattice = "graphite"
period = 1.0
amplitude = 0.1
[run]
duration = 20.0
integrator = { type = "rk4", dt = 0.05 }
)";
  expect_parts(said_of(surface, {}), {"did you mean \"honeycomb\""});
}

TEST_F(Hints, AtomsInMetalUnits) {
  const std::string atoms = R"([scene]
units = "metal"
[[body]]
name = "atoms"
type = "particles"
positions = [[0.0, 0.0, 0.0], [1.6, 0.0, 0.0], [0.8, 1.38, 0.0]]
species = "SPECIES"
particle_mass = 12.011
[[force]]
type = "tersoff"
parameters = "lindsay_broido_2010"
[run]
duration = 10.0
integrator = { type = "velocity_verlet", dt = 1.0 }
)";
  expect_parts(said_of(replaced(atoms, "SPECIES", "c"), {}),
               {"body.atoms.species = \"c\"", "expected: C"});
  write(folder_ / "scene.toml", replaced(atoms, "SPECIES", "C"));
  expect_parts(tomlin({"run", "scene.toml"}).err, {"times are in ps, and 1 fs is 1e-3"});
}

}  // namespace
}  // namespace tomlin::test
