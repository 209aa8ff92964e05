#include "framework/bodies/chain.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/register_forces.hpp"
#include "framework/bodies/register_bodies.hpp"
#include "framework/scene/scene.hpp"
#include "integrators/register_integrators.hpp"
#include "tests/support/faults.hpp"

namespace tomlin::test {
namespace {

using Lines = std::vector<std::string>;

Lines faults_of(const std::string& text) {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry);
  return briefs_of([&] { (void)parse_scene(text, "s", registry); });
}

/// Three particles along `axis` in a planar box that is periodic along x, with bonds of the
/// lengths given.
std::string chain(const std::string& axis, const std::string& lengths) {
  return "[[body]]\ntype = \"chain\"\ncount = 3\nspacing = 1\norigin = [0, 0]\nparticle_mass = 1\n"
         "axis = \"" +
         axis +
         "\"\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1\n"
         "rest_lengths = " +
         lengths +
         "\n[box]\nlengths = [3, 3]\nperiodic = [true, false]\n"
         "[run]\nduration = 1\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
}

TEST(Chain, IsClosedByABoxThatIsPeriodicAlongIt) {
  const auto wrong_count = [](const std::string& lengths) {
    return Lines{"12:16 force.harmonic_bonds.rest_lengths = " + lengths + " [scene.wrong_count]"};
  };
  EXPECT_EQ(faults_of(chain("x", "[1, 1, 1]")), Lines());
  EXPECT_EQ(faults_of(chain("x", "[1, 1]")), wrong_count("[1, 1]"));
  EXPECT_EQ(faults_of(chain("y", "[1, 1]")), Lines());
  EXPECT_EQ(faults_of(chain("y", "[1, 1, 1]")), wrong_count("[1, 1, 1]"));
}

TEST(HarmonicBonds, BetweenTwoBodiesCountEachParticleOfOneWithEachOfTheOther) {
  const auto bonds = [](const std::string& keys) {
    return faults_of(
        "[[body]]\nname = \"a\"\ntype = \"particles\"\npositions = [0, 1, 2]\nparticle_mass = 1\n"
        "[[body]]\nname = \"b\"\ntype = \"point\"\nposition = [5]\nparticle_mass = 1\n"
        "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"a\", \"b\"]\nstiffness = 1\n" +
        keys + "\n[run]\nduration = 1\nintegrator = { type = \"rk4\", dt = 0.01 }\n");
  };
  EXPECT_EQ(bonds("pairs = \"all\"\nrest_lengths = [1, 2, 3]"), Lines());
  EXPECT_EQ(bonds("pairs = \"all\"\nrest_lengths = [1, 2]"),
            Lines{"16:16 force.harmonic_bonds.rest_lengths = [1, 2] [scene.wrong_count]"});
  EXPECT_EQ(bonds("pairs = [[2, 0], [0, 0]]\nrest_lengths = [1, 2]"), Lines());
  EXPECT_EQ(bonds("pairs = [[0, 2]]"),
            Lines{"15:9 force.harmonic_bonds.pairs = [[0, 2]] [scene.out_of_range]"});
  EXPECT_EQ(bonds("pairs = \"neighbours\""),
            Lines{"15:9 force.harmonic_bonds.pairs = \"neighbours\" [component.unsuitable]"});
}

TEST(Forces, OfOneBodyTakeNoTwo) {
  const Lines found = faults_of(
      "[[body]]\nname = \"a\"\ntype = \"point\"\nposition = [0]\nparticle_mass = 1\n"
      "[[body]]\nname = \"b\"\ntype = \"point\"\nposition = [5]\nparticle_mass = 1\n"
      "[[force]]\ntype = \"viscous_damping\"\nbodies = [\"a\", \"b\"]\ncoefficient = 1\n"
      "[run]\nduration = 1\nintegrator = { type = \"rk4\", dt = 0.01 }\n");
  EXPECT_EQ(found,
            Lines{"13:10 force.viscous_damping.bodies = [\"a\", \"b\"] [scene.wrong_count]"});
}

}  // namespace
}  // namespace tomlin::test
