#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

constexpr const char* kForce = "driver.mean_force.x";

class TradeoffCommand : public Cli {
 protected:
  // The budget is a hundred times what the trade takes, so that no outcome depends on the machine.
  static std::vector<std::string> words(const std::vector<std::string>& more = {}) {
    return plus(
        {"tradeoff", "tip.toml", "--observable", kForce, "--tolerance", "1e-4", "--budget", "600"},
        more);
  }
  Json result(const std::string& folder) { return Json::parse(file(folder + "/tradeoff.json")); }
};

TEST_F(TradeoffCommand, RecommendsLinesThatRunAsMeasured) {
  const Ended ended = expect_status(0, tomlin(words({"--write", "cheap.toml", "--set", "v=0.02"})));
  EXPECT_EQ(ended.err, "");
  expect_parts(ended.out, {"a tip\n", "observable ", "reference ", "other scheme", "quadruple",
                           "determined ", "yes: ", "evaluations", "left out\n", "recommended",
                           "[run]\n", "integrator = { type = "});
  const Json found = result("tip.tradeoff.out");
  EXPECT_EQ(found["status"], "finished");
  EXPECT_EQ(found["observable"], "drivers.driver.mean_force.x");
  EXPECT_EQ(found["determined"]["determined"], true);
  const Json& chosen = found["recommendation"];
  EXPECT_LT(chosen["relative_error"].get<double>(), 1e-4);

  // A parameter set, the lines replaced, nothing else touched.
  const std::string text = file("cheap.toml");
  expect_parts(text, {"v = 0.02\ntwo_v = \"2 * v\"\n", "[output]\nevery = 0.7\n"});
  ASSERT_EQ(tomlin({"run", "cheap.toml", "-o", "again"}).status, 0);
  const Json again = summary("again");
  EXPECT_EQ(again["drivers"]["driver"]["mean_force"][0], chosen["value"]);
  // Samples take evaluations, too: here one more for each.
  EXPECT_GE(again["time"]["force_evaluations"], chosen["force_evaluations"]);
}

TEST_F(TradeoffCommand, LeavesATable) {
  expect_status(0, tomlin(words({"-o", "out"})));
  const std::string csv = file("out/tradeoff.csv");
  EXPECT_TRUE(csv.starts_with("rung,dt [time],tolerance,value,error,relative error,"));
  EXPECT_EQ(lines(csv), static_cast<std::ptrdiff_t>(result("out")["points"].size()) + 1);
  for (const std::string& name : all_files()) EXPECT_FALSE(contains(name, ".part")) << name;
}

TEST_F(TradeoffCommand, DoesNotWriteOverAnything) {
  ASSERT_EQ(tomlin(words({"--budget", "0.001"})).status, 2) << "given twice";
  write(folder_ / "cheap.toml", "mine");
  expect_refused(words({"--write", "cheap.toml"}), "--write: cheap.toml [file.exists]\n");
  expect_refused(words({"--write", "./tip.toml", "--force"}),
                 "--write: ./tip.toml [file.exists]\n");
  fs::create_directory(folder_ / "tip.tradeoff.out");
  write(folder_ / "tip.tradeoff.out/notes.txt", "mine");
  EXPECT_EQ(tomlin(words()).status, 2);
  EXPECT_EQ(tomlin(words({"--force"})).status, 0);
  EXPECT_EQ(file("tip.tradeoff.out/notes.txt"), "mine");
}

TEST_F(TradeoffCommand, ABudgetThatIsTooSmallIsSaid) {
  const Ended ended =
      expect_status(0, tomlin({"tradeoff", "tip.toml", "--observable", kForce, "--budget", "0.01",
                               "--set", "run.duration=1e8", "-o", "out", "--write", "cheap.toml"}));
  expect_parts(ended.out, {"over budget", "no recommendation"});
  EXPECT_TRUE(contains(ended.err, "cheap.toml is not written"));
  EXPECT_FALSE(exists("cheap.toml"));
  EXPECT_TRUE(result("out").at("recommendation").is_null());
}

TEST_F(TradeoffCommand, RefusesWrongInput) {
  expect_refused(
      {"tradeoff", "tip.toml", "--observable", "driver.mean_farce.x"},
      "--observable: driver.mean_farce.x [observable.unknown] did you mean driver.mean_force.x\n");
  for (const char* wrong : {"0", "-1", "nan"}) {
    for (const char* option : {"--tolerance", "--budget"}) {
      EXPECT_EQ(tomlin({"tradeoff", "tip.toml", "--observable", kForce, option, wrong}).status, 2)
          << option << " " << wrong;
    }
  }
  EXPECT_EQ(tomlin({"tradeoff", "tip.toml"}).status, 2);
  EXPECT_FALSE(exists("tip.tradeoff.out"));
}

TEST_F(TradeoffCommand, AnInterruptLeavesWhatIsKnown) {
  expect_status(130, tomlin({"tradeoff", "tip.toml", "--observable", kForce, "--set",
                             "run.duration=1e7", "-o", "out"},
                            {.then = signal_after(std::chrono::milliseconds(500), SIGINT)}));
  EXPECT_EQ(result("out")["status"], "interrupted");
}

}  // namespace
}  // namespace tomlin::test
