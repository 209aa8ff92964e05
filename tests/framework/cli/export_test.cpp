#include <string>

#include "tests/framework/cli/cli_fixture.hpp"

// Tests what `tomlin export` writes and refuses without LAMMPS; numbers: tests/framework/lammps.

namespace tomlin::test {
namespace {

class Export : public Cli {};

constexpr const char* kPairOfAtoms = R"([scene]
name = "two \"\"\" atoms &"

[[body]]
name = "pair"
type = "particles"
positions = [[0.0, 0.0, 0.0], [1.1, 0.1, 0.0]]
particle_mass = [1.0, 2.0]

[[force]]
type = "lennard_jones"
epsilon = 0.1
sigma = 1.0
cutoff = 2.5

[run]
duration = 0.1
integrator = { type = "velocity_verlet", dt = 1e-3 }
)";

TEST_F(Export, WritesItsFiles) {
  write(folder_ / "pair.toml", kPairOfAtoms);
  const Ended ended = expect_status(0, tomlin({"export", "pair.toml", "--to", "lammps"}));
  EXPECT_TRUE(contains(ended.out, "lmp -in in.lmp")) << ended.out;
  const std::string data = file("pair.lammps/data.lmp");
  expect_parts(data,
               {"\n2 atoms\n2 atom types\n", "\n2 2 1.1000000000000001 0.10000000000000001 0\n"});
  const std::string input = file("pair.lammps/in.lmp");
  expect_parts(input, {"\nunits lj\n", "\npair_coeff 1*2 1*2 lj/smooth/linear 0.1 1 2.5\n",
                       "\ntimestep 0.001\n", "\nvariable steps index 100\nrun ${steps}\n"});
  // Even in comments LAMMPS looks for these.
  EXPECT_FALSE(contains(input, "\"\"\"")) << input;
  EXPECT_FALSE(contains(input, "&\n")) << input;
}

TEST_F(Export, AFolderThatIsNotEmptyNeedsForce) {
  write(folder_ / "pair.toml", kPairOfAtoms);
  ASSERT_EQ(tomlin({"export", "pair.toml", "--to", "lammps", "-o", "out"}).status, 0);
  write(folder_ / "out" / "mine.txt", "kept");
  expect_refused({"export", "pair.toml", "--to", "lammps", "-o", "out"}, "-o: out [file.exists]\n");
  expect_status(0, tomlin({"export", "pair.toml", "--to", "lammps", "-o", "out", "--set",
                           "run.integrator.dt=2e-3", "--force"}));
  EXPECT_TRUE(contains(file("out/in.lmp"), "\ntimestep 0.002\n"));
  EXPECT_EQ(file("out/mine.txt"), "kept");
}

TEST_F(Export, OtherProgramsAreNotKnown) {
  expect_refused({"export", "tip.toml", "--to", "gromacs"}, "tomlin: [command.invalid_value]\n",
                 {"gromacs", "--to lammps"});
  expect_refused({"export", "tip.toml"}, "tomlin: [command.missing_argument]\n", {"--to"});
}

/// All that has no counterpart is named at once, each with its position, and nothing is made.
TEST_F(Export, WhatHasNoCounterpartIsRefused) {
  write(folder_ / "odd.toml", R"([[body]]
name = "ring"
type = "ring"
count = 5
radius = 1.0
centre = [0.0, 1.0]
particle_mass = 1.0
coordinates = "rigid"

[[body]]
name = "tip"
type = "point"
position = [0.0, 3.0]
particle_mass = 1.0

[[force]]
type = "coulomb_friction"
body = "tip"
force = 0.1
width = 0.01

[[force]]
type = "viscous_damping"
body = "ring"
coefficient = [0.1, 0.2, 0.3, 0.4, 0.5]

[run]
duration = 1.0
integrator = { type = "dopri5", absolute_tolerance = 1e-8, relative_tolerance = 1e-8 }
)");
  const Ended ended = expect_status(2, tomlin({"export", "odd.toml", "--to", "lammps"}));
  expect_parts(
      ended.err,
      {"odd.toml:8:", "body.ring.coordinates", "odd.toml:17:", "force.coulomb_friction.type",
       "odd.toml:25:", "force.viscous_damping.coefficient", "odd.toml:29:", "run.integrator.type"});
  EXPECT_FALSE(exists("odd.lammps"));
}

}  // namespace
}  // namespace tomlin::test
