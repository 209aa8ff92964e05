#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tests/framework/cli/cli_fixture.hpp"
#include "tests/framework/plugin/kim/own_models.hpp"

// kim_model as users have it: a plugin of the program.

namespace tomlin::test {
namespace {

std::string scene_of_model(const std::string& model, const std::string& plugin,
                           const std::string& duration) {
  std::string positions;
  for (int i = 0; i < 64; ++i) {
    positions += "[" + std::to_string(3.7 * (i % 4) + 0.1 * (i % 3)) + ", " +
                 std::to_string(3.7 * (i / 4 % 4)) + ", " + std::to_string(3.7 * (i / 16)) + "], ";
  }
  return "plugins = [\"" + plugin + "\"]\n[scene]\nunits = \"metal\"\n" +
         "[box]\nlengths = [14.8, 14.8, 14.8]\nperiodic = [true, true, true]\n" +
         "[[body]]\nname = \"a\"\ntype = \"particles\"\nspecies = \"Ar\"\n" +
         "particle_mass = 39.948\nstart_temperature = 40.0\npositions = [" + positions + "]\n" +
         "[[force]]\nname = \"pot\"\ntype = \"kim_model\"\nmodel = \"" + model + "\"\n" +
         "[run]\nduration = " + duration +
         "\nintegrator = { type = \"velocity_verlet\", dt = 0.002 }\ncheckpoint_every = 0.1\n" +
         "[output]\nevery = 0.02\n";
}

class KimPlugin : public Cli {
 protected:
  void SetUp() override {
    use_own_models();
    Cli::SetUp();
    write(folder_ / "argon.toml", scene_of_model("tomlin_test_pair", TOMLIN_KIM_PLUGIN, "0.1"));
    write(folder_ / "long.toml", scene_of_model("tomlin_test_pair", TOMLIN_KIM_PLUGIN, "4.0"));
  }
};

TEST_F(KimPlugin, RunsAndIsExplained) {
  expect_status(0, tomlin({"run", "argon.toml"}));
  EXPECT_EQ(summary("argon.out")["status"], "finished");
  const Ended again = expect_status(0, tomlin({"run", "argon.out/scene.toml", "-o", "again"}));
  EXPECT_EQ(file("again/observables.csv"), file("argon.out/observables.csv"));
  EXPECT_FALSE(exists("kim.log"));

  const Ended explained = expect_status(0, tomlin({"explain", "argon.toml"}));
  expect_parts(explained.out, {"tomlin_test_pair", "for Ar, Kr; influence 6 A", "neighbours"});
  const Ended described =
      expect_status(0, tomlin({"describe", "--plugin", TOMLIN_KIM_PLUGIN, "kim_model"}));
  EXPECT_TRUE(contains(described.out, "doi:10.1007/s11837-011-0102-6")) << described.out;
}

TEST_F(KimPlugin, IsChecked) {
  const Ended ended = tomlin({"check", "argon.toml"});
  EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
}

TEST_F(KimPlugin, FaultsHaveTheirPlace) {
  write(folder_ / "argon.toml", scene_of_model("tomlin_test_pear", TOMLIN_KIM_PLUGIN, "0.1"));
  const Ended ended = expect_status(2, tomlin({"run", "argon.toml"}));
  expect_error(
      ended,
      "argon.toml:17:9: force.pot.model = \"tomlin_test_pear\" [scene.unknown_name] did you "
      "mean tomlin_test_pair\n");
  EXPECT_FALSE(exists("argon.out"));
}

TEST_F(KimPlugin, IsKilledAndResumedWithTheSameBits) {
  ASSERT_EQ(tomlin({"run", "long.toml", "-o", "whole"}).status, 0);
  for (const int milliseconds : {300, 500, 900}) {
    SCOPED_TRACE(milliseconds);
    const std::string out = "killed_" + std::to_string(milliseconds);
    tomlin({"run", "long.toml", "-o", out},
           {.then = signal_after(std::chrono::milliseconds(milliseconds), SIGKILL)});
    expect_status(0, tomlin({"run", "long.toml", "-o", out, "--resume"}));
    EXPECT_EQ(file(out + "/observables.csv"), file("whole/observables.csv"));
  }
}

}  // namespace
}  // namespace tomlin::test
