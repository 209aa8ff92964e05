#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "framework/cli/build_version.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "tests/framework/cli/cli_fixture.hpp"

/// `tomlin sweep --shard` and `tomlin merge` as a user sees them.
namespace tomlin::test {
namespace {

/// Four of the twelve points finish, four are refused and four fail.
const std::vector<std::string> kSharded = {
    "--over",       "v=1e-2,2e-2,3e-2,4e-2", "--over",       "run.integrator.dt=1e-2,-1,50",
    "--observable", "driver.mean_force.x",   "--observable", "events.slips"};

class MergeCommand : public Cli {
 protected:
  Ended sweep(const std::vector<std::string>& options, const Conditions& conditions = {},
              const std::vector<std::string>& axes = kSharded) {
    return tomlin(plus(plus({"sweep", "tip.toml"}, axes), options), conditions);
  }
  /// In the folders s1, s2, ...
  void sweep_shards(int count, const std::vector<std::string>& axes = kSharded) {
    for (int k = 1; k <= count; ++k) {
      const std::string shard = std::to_string(k) + "/" + std::to_string(count);
      const Ended ended = sweep({"--shard", shard, "-o", "s" + std::to_string(k)}, {}, axes);
      EXPECT_EQ(ended.status, 0) << shard << " " << ended.err;
    }
  }
  /// `tomlin merge` of these folders.
  Ended merge(std::vector<std::string> folders, const std::string& into,
              const std::vector<std::string>& options = {}, const Conditions& conditions = {}) {
    folders.insert(folders.begin(), "merge");
    folders.insert(folders.end(), {"-o", into});
    folders.insert(folders.end(), options.begin(), options.end());
    return tomlin(folders, conditions);
  }
  /// All that does not depend on how the sweep came to its end.
  std::string results(const std::string& folder) {
    Json json = sweep_summary(folder);
    json.erase("performance");
    return Cli::results(folder) + json.dump();
  }
  int rows_of(const std::string& folder) { return sweep_summary(folder)["performance"]["rows"]; }
};

TEST_F(MergeCommand, ShardsInAnyOrderAreTheWholeSweep) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  sweep_shards(3);
  std::vector<std::string> shards = {"s1", "s2", "s3"};
  do {
    const Ended ended = expect_status(0, merge(shards, "merged", {"--force"}));
    EXPECT_TRUE(contains(ended.out, "4 points finished, 4 failed, 4 refused\n")) << ended.out;
    EXPECT_EQ(results("merged"), results("whole"));
  } while (std::next_permutation(shards.begin(), shards.end()));
  EXPECT_FALSE(exists("merged/run.journal"));
  const Ended same = sweep({"-o", "merged"});
  EXPECT_TRUE(contains(same.out, "finished already")) << same.out;
  // Some shards are empty if there are more of them than points.
  sweep_shards(13);
  expect_status(
      0, merge({"s13", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "s12"},
               "many"));
  EXPECT_EQ(results("many"), results("whole"));
}

TEST_F(MergeCommand, AShardSaysWhatItIs) {
  const Ended ended = expect_status(0, sweep({"--shard", "2/5"}));
  EXPECT_TRUE(contains(ended.out, "2 of 5: 2 of these points")) << ended.out;
  const std::string folder = "tip.sweep.2-of-5.out";
  for (const char* name : {"sweep.journal", "sweep.json", "scene.toml"}) {
    EXPECT_TRUE(exists(folder + "/" + name)) << name;
  }
  EXPECT_FALSE(exists(folder + "/sweep.csv"));
  EXPECT_FALSE(exists(folder + "/sweep.h5"));
  const Json json = sweep_summary(folder);
  EXPECT_EQ(json["status"], "finished");
  EXPECT_EQ(json["points"], 12);
  EXPECT_EQ(json["shard"], (Json{{"number", 2}, {"of", 5}, {"points", 2}}));
  int counted = 0;
  for (const auto& [status, count] : json["counts"].items()) counted += count.get<int>();
  EXPECT_EQ(counted, 2);
  EXPECT_EQ(json["performance"]["rows"], 2);
  // Repeated, it runs nothing; its traces are its own points'.
  const Ended again = expect_status(0, sweep({"--shard", "2/5", "--trace", "all"}));
  EXPECT_TRUE(contains(again.out, "for 0 points")) << again.out;
  EXPECT_FALSE(exists(folder + "/sweep.points/0"));
  const Ended dry = expect_status(0, sweep({"--shard", "5/5", "--dry-run"}));
  EXPECT_TRUE(contains(dry.out, "5 of 5: 2 of these points")) << dry.out;
  for (const std::string wrong : {"0/3", "4/3", "3", "/3", "3/", "", "1/0", "a/b", "1/3/3", "-1/3",
                                  "1/1000000000000000000000"}) {
    const Ended refused = sweep({"--shard", wrong, "-o", "x"});
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_TRUE(contains(refused.err, "--shard: error: ")) << refused.err;
  }
  EXPECT_FALSE(exists("x"));
}

TEST_F(MergeCommand, WhatIsMissingIsRunInTheMergedFolder) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  sweep_shards(3);
  const Ended ended = expect_status(1, merge({"s3", "s1"}, "merged"));
  expect_parts(ended.out,
               {"4 of 12 points are missing\n", "first point 1, v = 0.01, run.integrator.dt = -1"});
  EXPECT_FALSE(exists("merged/sweep.csv"));
  EXPECT_FALSE(exists("merged/sweep.h5"));
  EXPECT_EQ(sweep_summary("merged")["status"], "interrupted");
  EXPECT_EQ(rows_of("merged"), 8);
  fs::copy(folder_ / "merged", folder_ / "other");
  // Its own scene is the sweep.
  EXPECT_EQ(tomlin({"sweep", "merged/scene.toml", "-o", "merged"}).status, 0);
  EXPECT_EQ(sweep_summary("merged")["performance"]["rows_of_this_process"], 4);
  EXPECT_EQ(results("merged"), results("whole"));
  // Or a later merge brings it.
  EXPECT_EQ(merge({"s2"}, "other").status, 0);
  EXPECT_EQ(results("other"), results("whole"));
  // A folder may be its own source.
  EXPECT_EQ(merge({"s1", "s2", "s3"}, "s1").status, 0);
  EXPECT_EQ(results("s1"), results("whole"));
}

/// The scene in a folder has the settings of the command line in it.
TEST_F(MergeCommand, TheSceneInTheFolderIsThatOfTheOptions) {
  const std::vector<std::string> axes = {"--over",       "v=1e-2:4e-2:4:log",
                                         "--over",       "run.dynamics=inertial,overdamped",
                                         "--over",       "two_v=1,\"3 * v\",5,6",
                                         "--zip",        "v,two_v",
                                         "--set",        "force.driver.stiffness=\"300 * two_v\"",
                                         "--set",        "run.duration=50",
                                         "--observable", "driver.work"};
  ASSERT_EQ(sweep({"-o", "whole"}, {}, axes).status, 0);
  sweep_shards(2, axes);
  expect_status(0, merge({"s1", "s2"}, "merged"));
  EXPECT_EQ(results("merged"), results("whole"));
}

TEST_F(MergeCommand, OtherSweepsAreRefusedTogether) {
  sweep_shards(2);
  expect_status(0, sweep({"--shard", "2/2", "--set", "force.driver.stiffness=3", "-o", "other"}));
  ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "run", "--quiet"}).status, 0);
  expect_refused({"merge", "s1", "other", "run", "none", "s2", "-o", "x"},
                 "other: [resume.other_scene]\nrun: [file.invalid]\nnone: [file.invalid]\n",
                 {"s1"});
  EXPECT_EQ(merge({"run", "s1"}, "x").status, 2);
  EXPECT_EQ(merge({"none", "s1"}, "x").status, 2);
  // Nor does a folder of another sweep take them.
  expect_error(merge({"s1", "s2"}, "other"), "-o: other [resume.other_scene]", {"--force"});
  expect_error(merge({"s1", "s2"}, "run"), "-o: run [file.exists]");
  EXPECT_EQ(merge({"s1", "s2"}, "other", {"--force"}).status, 0);
  expect_error(merge({"s1", "s2"}, "s2", {"--force"}), "[command.conflict]");
  // A scene that is not that of the rows.
  write(folder_ / "s1/scene.toml",
        replaced(file("s1/scene.toml"), "amplitude = 0.1", "amplitude = 0.2"));
  expect_error(merge({"s1", "s2"}, "x"), "s1: [resume.other_scene]\ns2: [resume.other_scene]",
               {"scene.toml"});
  EXPECT_FALSE(exists("x"));
}

/// One program gives one set of rows: of two that differ one is wrong, and nobody knows which.
TEST_F(MergeCommand, DifferentRowsOfAPointAreRefused) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  const auto plant = [this](const std::string& folder, std::size_t point, auto change) {
    const fs::path path = folder_ / folder;
    fs::remove_all(path);
    fs::copy(folder_ / "whole", path);
    SceneDocument document((path / "scene.toml").string());
    std::vector<Fault> faults;
    const auto settings = document.sweep(faults);
    const Registry registry = standard_registry();
    const SweepPlan plan(document, registry, {}, settings.value(), build_version());
    SweepJournal journal(path / kSweepJournalFile, plan);
    ASSERT_TRUE(journal.has(point));
    SweepRow row;
    journal.read(point, {&row, 1});
    change(row);
    journal.keep(point, row);
  };
  plant("a", 3, [](SweepRow&) {});
  EXPECT_EQ(merge({"whole", "a"}, "x").status, 0) << "the same rows";
  plant("a", 3, [](SweepRow& row) { row.numbers[1] = std::nextafter(row.numbers[1], 1e9); });
  expect_refused({"merge", "whole", "a", "-o", "y"}, "a: [file.damaged]\n",
                 {"point 3", "whole", "events.slips = "});
  plant("a", 4, [](SweepRow& row) { row.reason += "."; });
  expect_refused({"merge", "a", "whole", "-o", "y"}, "whole: [file.damaged]\n",
                 {"point 4", "reason"});
  plant("a", 5, [](SweepRow& row) { row.status = SweepStatus::refused; });
  expect_refused({"merge", "a", "whole", "-o", "y"}, "whole: [file.damaged]\n",
                 {"point 5", "status = refused and failed"});
  plant("a", 0, [](SweepRow& row) { row.warnings.set(0); });
  expect_refused({"merge", "a", "whole", "-o", "y"}, "whole: [file.damaged]\n",
                 {"point 0", "warnings"});
  // With the rows that are there already.
  const std::string before = results("x");
  expect_refused({"merge", "a", "-o", "x"}, "x: [file.damaged]\n", {"point 0"});
  EXPECT_EQ(results("x"), before);
}

TEST_F(MergeCommand, DamagedJournals) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  sweep_shards(2);
  const std::string journal = file("s2/sweep.journal");
  // In the header: refused.
  std::string changed = journal;
  changed[20] = static_cast<char>(changed[20] ^ 1);
  write(folder_ / "s2/sweep.journal", changed);
  expect_error(merge({"s1", "s2"}, "x"), "[file.damaged]", {"s2/sweep.journal"});
  expect_error(merge({"s1"}, "s2"), "-o: s2 [file.damaged]");
  EXPECT_FALSE(exists("x"));
  // In a record: its point is missing, and what is left is kept.
  changed = journal;
  const std::size_t record = changed.rfind("step 0, time 0");  // the reason of a point that failed
  ASSERT_NE(record, std::string::npos);
  changed[record] = 'S';
  write(folder_ / "s2/sweep.journal", changed);
  const Ended ended = expect_status(1, merge({"s1", "s2"}, "x"));
  EXPECT_TRUE(contains(ended.out, "1 of 12 points are missing\n")) << ended.out;
  // The shard runs it again.
  EXPECT_EQ(sweep({"--shard", "2/2", "-o", "s2"}).status, 0);
  EXPECT_EQ(merge({"s1", "s2"}, "x").status, 0);
  EXPECT_EQ(results("x"), results("whole"));
}

TEST_F(MergeCommand, ShardsThatWereKilledGoOn) {
  const std::vector<std::string> axes = {
      "--over", "v=1e-3:1e-1:3000", "--observable", "driver.mean_force.x", "--threads", "1"};
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(sweep({"-o", "whole"}, {}, axes).status, 0);
  const auto time_of_all = std::chrono::steady_clock::now() - begin;
  int kills = 0;
  for (const std::string shard : {"1", "2"}) {
    const Ended ended = sweep({"--shard", shard + "/2", "-o", "s" + shard},
                              {.then =
                                   [&](pid_t child) {
                                     appears(folder_ / ("s" + shard) / "scene.toml");
                                     // A shard takes half of the time of all on this machine.
                                     std::this_thread::sleep_for(time_of_all / 10);
                                     ::kill(child, shard == "1" ? SIGKILL : SIGTERM);
                                   }},
                              axes);
    kills += ended.status == 0 ? 0 : 1;
  }
  EXPECT_GT(kills, 0);
  // The points that the killed shards have are merged, too.
  expect_status(1, merge({"s1", "s2"}, "x"));
  sweep_shards(2, axes);
  EXPECT_EQ(merge({"s1", "s2"}, "x").status, 0);
  EXPECT_EQ(results("x"), results("whole"));
}

TEST_F(MergeCommand, AFullDiskOrAKillAndAgain) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  sweep_shards(2);
  const auto sizes = {300L, 1500L, 2500L, 8000L};
  for (const long size : sizes) {
    const Ended full = merge({"s1", "s2"}, "x", {}, {.largest_file = size});
    EXPECT_EQ(full.status, 1) << size;
    expect_error(full, "[file.cannot_write]");
    EXPECT_FALSE(exists("x/sweep.json")) << size;
  }
  EXPECT_EQ(merge({"s1", "s2"}, "x").status, 0);
  EXPECT_EQ(results("x"), results("whole"));
}

}  // namespace
}  // namespace tomlin::test
