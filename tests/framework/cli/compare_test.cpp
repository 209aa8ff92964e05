#include <algorithm>
#include <string>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

constexpr const char* kForce = "driver.mean_force.x";

class CompareCommand : public Cli {};

TEST_F(CompareCommand, NamesTheSimplestModelAndLeavesItsFiles) {
  write(folder_ / "other.toml", kTip);
  const Ended ended =
      expect_status(0, tomlin({"compare", "tip.toml", "other.toml", "--observable", kForce}));
  expect_parts(ended.out, {"coordinates", "reference", "agrees", "results: compare.out/"});
  const Json found = Json::parse(file("compare.out/compare.json"));
  ASSERT_EQ(found["models"].size(), 2U);
  EXPECT_EQ(found["status"], "finished");
  EXPECT_EQ(found["models"].at(0).at("value"), found["models"].at(1).at("value"));
  EXPECT_EQ(found["models"][0]["difference"], 0.0);
  EXPECT_TRUE(file("compare.out/compare.csv").starts_with("model,file,verdict,particles,"));
  EXPECT_EQ(lines(file("compare.out/compare.csv")), 3);
  const std::string curves = file("compare.out/curves.csv");
  EXPECT_TRUE(curves.starts_with("model,name,displacement [length],force [force]\n0,\"a tip\","));
  EXPECT_TRUE(contains(curves, "\n1,\"a tip\","));

  EXPECT_EQ(tomlin({"compare", "tip.toml", "other.toml", "--observable", kForce}).status, 2);
  expect_status(0,
                tomlin({"compare", "tip.toml", "other.toml", "--observable", kForce, "--force"}));
}

/// A window from 1.0 to 2.5 periods of the driver.
TEST_F(CompareCommand, WarningsHaveTheirCodes) {
  write(folder_ / "other.toml", replaced(kTip, "to = 2.0", "to = 2.5"));
  const Ended ended =
      expect_status(0, tomlin({"compare", "tip.toml", "other.toml", "--observable", kForce}));
  EXPECT_TRUE(contains(ended.out, " [run.window_not_whole]\n")) << ended.out;
  const Json models = Json::parse(file("compare.out/compare.json"))["models"];
  for (const Json& model : models) {
    EXPECT_EQ(model["warnings"].size(), model["warning_codes"].size());
  }
  const Json& codes = models[1]["warning_codes"];
  EXPECT_NE(std::find(codes.begin(), codes.end(), "run.window_not_whole"), codes.end()) << codes;
}

TEST_F(CompareCommand, RefusesWrongInput) {
  expect_refused({"compare", "tip.toml", "--observable", kForce},
                 "tomlin: [command.missing_argument]\n", {"two or more"});
  expect_refused({"compare", "tip.toml", "tip.toml"}, "tomlin: [command.missing_argument]\n",
                 {"--observable is required"});
  expect_refused({"compare", "tip.toml", "none.toml", "--observable", kForce},
                 "none.toml:1:1: [file.cannot_read]\n");
  expect_refused({"compare", "tip.toml", "tip.toml", "--observable", kForce, "--tolerance", "0"},
                 "tomlin: [command.invalid_value]\n", {"--tolerance is 0"});
  expect_refused(
      {"compare", "tip.toml", "tip.toml", "--observable", "driver.mean_farce.x"},
      "tip.toml: driver.mean_farce.x [observable.unknown] did you mean driver.mean_force.x\n");
}

}  // namespace
}  // namespace tomlin::test
