#include "framework/plot/curve_labels.hpp"

#include <cmath>
#include <map>
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

TEST(CurveOrder, IsThatOfTheValuesThatDiffer) {
  const auto names = [](const std::vector<StoredRun>& runs) {
    Labels result;
    for (const StoredRun& run : in_order_of_parameters(runs)) result.push_back(run.name);
    return result;
  };
  const auto point = [](const std::string& name, double k, double v) {
    return run_of(name, {{"k", k}, {"v", v}});
  };
  // As numbers: 10 is behind 9.
  EXPECT_EQ(names({point("a", 10.0, 1.0), point("b", 9.0, 1.0), point("c", 2e-3, 1.0)}),
            (Labels{"c", "b", "a"}));
  EXPECT_EQ(names({point("a", 2.0, 3.0), point("b", 1.0, 5.0), point("c", 2.0, 1.0)}),
            (Labels{"b", "c", "a"}));
  EXPECT_EQ(names({point("b", 2.0, 3.0), point("a", 2.0, 3.0)}), (Labels{"b", "a"}));
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

TEST_F(StoredRunTest, ReadsResultsAndUnits) {
  test::write(folder_ / "summary.json",
              R"({"status": "finished", "scene": {"axes": {"length": "a"}}, "parameters": {"v": 2},
                  "drivers": {"d": {"mean_force": [0.5, -1], "work": null}}, "events": {"slips": 3},
                  "bodies": {"d": {"mass": 1}, "e": {"mass": 2}}, "warnings": [7]})");
  const StoredRun run = read_stored_run(folder());
  EXPECT_EQ(run.units, (std::map<std::string, std::string>{{"length", "a"}}));
  EXPECT_EQ(run.results.at("drivers.d.mean_force.y"), -1.0);
  EXPECT_TRUE(std::isnan(run.results.at("drivers.d.work")));
  EXPECT_EQ(result_name(run, "d.mean_force.x"), "drivers.d.mean_force.x");
  EXPECT_EQ(result_name(run, "events.slips"), "events.slips");
  EXPECT_EQ(result_name(run, "e.mass"), "bodies.e.mass");
  EXPECT_EQ(result_name(run, "d.mean_force"), "");
  EXPECT_FALSE(run.results.contains("parameters.v"));
  EXPECT_FALSE(run.results.contains("warnings.x"));
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
