#include "framework/bodies/chain.hpp"

#include <string>

#include <gtest/gtest.h>

#include "forcefields/register.hpp"
#include "framework/bodies/register.hpp"
#include "framework/scene/scene.hpp"
#include "integrators/register.hpp"

namespace tomlin::test {
namespace {

std::string faults_of(const std::string& text) {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry);
  try {
    (void)parse_scene(text, "s", registry);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
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
  EXPECT_EQ(faults_of(chain("x", "[1, 1, 1]")), "");
  EXPECT_NE(faults_of(chain("x", "[1, 1]")).find("2 lengths for 3 pairs"), std::string::npos);
  EXPECT_EQ(faults_of(chain("y", "[1, 1]")), "");
  EXPECT_NE(faults_of(chain("y", "[1, 1, 1]")).find("3 lengths for 2 pairs"), std::string::npos);
}

TEST(HarmonicBonds, BetweenTwoBodiesCountEachParticleOfOneWithEachOfTheOther) {
  const auto bonds = [](const std::string& keys) {
    return faults_of(
        "[[body]]\nname = \"a\"\ntype = \"particles\"\npositions = [0, 1, 2]\nparticle_mass = 1\n"
        "[[body]]\nname = \"b\"\ntype = \"point\"\nposition = [5]\nparticle_mass = 1\n"
        "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"a\", \"b\"]\nstiffness = 1\n" +
        keys + "\n[run]\nduration = 1\nintegrator = { type = \"rk4\", dt = 0.01 }\n");
  };
  EXPECT_EQ(bonds("pairs = \"all\"\nrest_lengths = [1, 2, 3]"), "");
  EXPECT_NE(bonds("pairs = \"all\"\nrest_lengths = [1, 2]").find("2 lengths for 3 pairs"),
            std::string::npos);
  EXPECT_EQ(bonds("pairs = [[2, 0], [0, 0]]\nrest_lengths = [1, 2]"), "");
  EXPECT_NE(bonds("pairs = [[0, 2]]").find("indices of \"b\" are 0 to 0"), std::string::npos);
  EXPECT_NE(bonds("pairs = \"neighbours\"").find("no neighbours"), std::string::npos);
}

TEST(Forces, OfOneBodyTakeNoTwo) {
  const std::string found = faults_of(
      "[[body]]\nname = \"a\"\ntype = \"point\"\nposition = [0]\nparticle_mass = 1\n"
      "[[body]]\nname = \"b\"\ntype = \"point\"\nposition = [5]\nparticle_mass = 1\n"
      "[[force]]\ntype = \"viscous_damping\"\nbodies = [\"a\", \"b\"]\ncoefficient = 1\n"
      "[run]\nduration = 1\nintegrator = { type = \"rk4\", dt = 0.01 }\n");
  EXPECT_EQ(found,
            "s:13:10: error: force.viscous_damping.bodies = [\"a\", \"b\"]: found 2 bodies, but "
            "viscous_damping acts on 1");
}

}  // namespace
}  // namespace tomlin::test
