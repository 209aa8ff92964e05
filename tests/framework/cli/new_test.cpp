#include <chrono>
#include <string>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

constexpr const char* kModels[] = {"pt", "fk", "ring"};
// A starting point answers at once; sanitizers and a busy machine get the rest.
constexpr std::chrono::seconds kAtOnce{20};

class New : public Cli {};

TEST_F(New, EachSceneRunsAsItIs) {
  for (const std::string model : kModels) {
    const Ended made = expect_status(0, tomlin({"new", model}));
    EXPECT_TRUE(contains(made.out, "tomlin run " + model + ".toml")) << made.out;
    const auto begun = std::chrono::steady_clock::now();
    const Ended ended = tomlin({"run", model + ".toml"});
    EXPECT_LT(std::chrono::steady_clock::now() - begun, kAtOnce);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const Json results = summary(model + ".out");
    EXPECT_EQ(results["status"], "finished");
    EXPECT_GT(results["drivers"]["driver"]["mean_force"][0], 0.0);
    EXPECT_TRUE(exists(model + ".out/observables.csv"));
    EXPECT_EQ(tomlin({"explain", model + ".toml"}).status, 0);
  }
}

TEST_F(New, EachSceneIsExplainedInItself) {
  for (const std::string model : kModels) {
    ASSERT_EQ(tomlin({"new", model}).status, 0);
    const std::string scene = file(model + ".toml");
    expect_parts(scene, {"\n[scene]\n", "source = \"", "units ", "[parameters]", "[[body]]",
                         "coordinates = ", "[[force]]", "[run]", "dynamics = ", "duration = ",
                         "integrator = ", "[measure]", "[output]", "[mass/time]", "[length]"});
    EXPECT_EQ(scene.substr(0, 2), "# ");
  }
}

TEST_F(New, TheRingMayBecomeFlexible) {
  ASSERT_EQ(tomlin({"new", "ring"}).status, 0);
  EXPECT_EQ(tomlin({"run", "ring.toml", "--set", "body.ring.coordinates=particles"}).status, 0);
}

TEST_F(New, TheFileHasTheNameThatIsGiven) {
  ASSERT_EQ(tomlin({"new", "pt", "mine"}).status, 0);
  ASSERT_EQ(tomlin({"new", "pt", "other.toml"}).status, 0);
  fs::create_directory(folder_ / "scenes");
  ASSERT_EQ(tomlin({"new", "pt", "-o", "scenes/third"}).status, 0);
  EXPECT_EQ(file("mine.toml"), file("other.toml"));
  EXPECT_EQ(file("mine.toml"), file("scenes/third"));
  EXPECT_EQ(tomlin({"new", "pt", "name", "-o", "file"}).status, 2);
}

TEST_F(New, NothingIsReplacedUnlessForced) {
  expect_refused({"new", "pt", "tip"}, "-o: tip.toml [file.exists]\n");
  EXPECT_EQ(file("tip.toml"), kTip);
  EXPECT_EQ(tomlin({"new", "pt", "tip", "--force"}).status, 0);
  EXPECT_NE(file("tip.toml"), kTip);
  fs::create_directory(folder_ / "folder.toml");
  expect_refused({"new", "pt", "folder", "--force"}, "-o: folder.toml [file.invalid]\n");
}

TEST_F(New, AModelIsDue) {
  expect_refused({"new", "rign"}, "tomlin: [command.invalid_value] did you mean ring\n",
                 {"\"rign\"", "pt, fk, ring, plugin"});
  expect_refused({"new"}, "tomlin: [command.missing_argument]\n", {"MODEL"});
  EXPECT_EQ(tomlin({"new", "pt", ""}).status, 2);
  EXPECT_EQ(tomlin({"new", "pt", "-o", ""}).status, 2);
}

TEST_F(New, AFileThatCannotBeWrittenIsReported) {
  // Found before the work.
  expect_refused({"new", "pt", "-o", "nowhere/pt.toml"},
                 "-o: nowhere/pt.toml [file.cannot_write]\n");
}

}  // namespace
}  // namespace tomlin::test
