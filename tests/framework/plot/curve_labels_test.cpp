#include "framework/plot/curve_labels.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/plot/stored_run.hpp"
#include "tests/framework/output/temporary_folder.hpp"

namespace tomlin {
namespace {

using Labels = std::vector<std::string>;

StoredRun run_of(const std::string& name,
                 const std::vector<std::pair<std::string, double>>& parameters) {
  StoredRun run;
  run.folder = "runs/" + name;
  run.name = name;
  run.parameters = parameters;
  return run;
}

TEST(CurveLabels, AreTheParametersThatDiffer) {
  EXPECT_EQ(curve_labels({run_of("a", {{"k", 2.0}, {"lambda", 0.1}}),
                          run_of("b", {{"k", 2.0}, {"lambda", 1e-3}})}),
            (Labels{"lambda = 0.1", "lambda = 0.001"}));
  EXPECT_EQ(
      curve_labels({run_of("a", {{"k", 2.0}, {"v", 1.0}}), run_of("b", {{"k", 3.0}, {"v", 1.0}}),
                    run_of("c", {{"k", 3.0}, {"v", 2.0}})}),
      (Labels{"k = 2, v = 1", "k = 3, v = 1", "k = 3, v = 2"}));
}

TEST(CurveLabels, OneRunNeedsNone) {
  EXPECT_EQ(curve_labels({run_of("a", {{"k", 2.0}})}), Labels{""});
}

TEST(CurveLabels, FoldersTellApartWhatParametersDoNot) {
  EXPECT_EQ(curve_labels({run_of("free", {{"k", 2.0}}), run_of("held", {{"k", 2.0}})}),
            (Labels{"free", "held"}));
  EXPECT_EQ(curve_labels({run_of("free", {{"k", 2.0}}), run_of("held", {{"k", 2.0}}),
                          run_of("stiff", {{"k", 8.0}})}),
            (Labels{"free", "held", "k = 8"}));
  // Beyond the digits that are shown.
  EXPECT_EQ(curve_labels({run_of("a", {{"k", 2.0}}), run_of("b", {{"k", 2.0 + 1e-9}})}),
            (Labels{"a", "b"}));
}

TEST(CurveLabels, AnotherModelGoesByItsFolder) {
  EXPECT_EQ(curve_labels({run_of("tip", {{"k", 2.0}}), run_of("a", {{"k", 2.0}, {"lambda", 0.0}}),
                          run_of("b", {{"k", 2.0}, {"lambda", 1.0}})}),
            (Labels{"tip", "lambda = 0", "lambda = 1"}));
}

TEST(CurveLabels, PathsTellFoldersOfOneNameApart) {
  StoredRun other = run_of("a", {});
  other.folder = "older/a";
  EXPECT_EQ(curve_labels({run_of("a", {}), other}), (Labels{"runs/a", "older/a"}));
}

TEST(CurveLabels, WhatFollowsFromOtherParametersIsLeftOut) {
  StoredRun slow = run_of("slow", {{"v", 1.0}, {"twice", 2.0}});
  StoredRun fast = run_of("fast", {{"v", 3.0}, {"twice", 6.0}});
  EXPECT_EQ(curve_labels({slow, fast}), (Labels{"v = 1, twice = 2", "v = 3, twice = 6"}));
  slow.written = {{"v", "1"}, {"twice", "2 * v"}};
  fast.written = {{"v", "3"}, {"twice", "2 * v"}};
  EXPECT_EQ(curve_labels({slow, fast}), (Labels{"v = 1", "v = 3"}));
}

class StoredRunTest : public testing::Test {
 protected:
  std::string folder() const { return folder_.path().string(); }
  test::TemporaryFolder folder_;
};

TEST_F(StoredRunTest, ReadsWhatFiguresNeed) {
  EXPECT_FALSE(holds_run(folder()));
  test::write(folder_ / "summary.json",
              R"({"status": "finished", "parameters": {"v": 0.5, "w": null, "k": 2}})");
  test::write(folder_ / "scene.toml", "[parameters]\nv = 0.5\nk = \"4 * v\"\n");
  EXPECT_TRUE(holds_run(folder()));
  const StoredRun run = read_stored_run(folder() + "/");
  EXPECT_EQ(run.name, folder_.path().filename().string());
  EXPECT_EQ(run.status, "finished");
  EXPECT_EQ(run.parameters, (std::vector<std::pair<std::string, double>>{{"v", 0.5}, {"k", 2.0}}));
  EXPECT_EQ(run.written.at("k"), "4 * v");
}

TEST_F(StoredRunTest, CanDoWithoutTheScene) {
  test::write(folder_ / "summary.json", R"({"status": "failed"})");
  EXPECT_TRUE(read_stored_run(folder()).written.empty());
  test::write(folder_ / "scene.toml", "no = = toml");
  EXPECT_TRUE(read_stored_run(folder()).written.empty());
}

TEST_F(StoredRunTest, RefusesWhatIsNoSummary) {
  for (const char* text : {"", "{", "[1, 2]", "{}", R"({"status": 3})"}) {
    test::write(folder_ / "summary.json", text);
    EXPECT_THROW(read_stored_run(folder()), InputError) << text;
  }
}

}  // namespace
}  // namespace tomlin
