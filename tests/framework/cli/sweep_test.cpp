#include <chrono>
#include <cmath>
#include <csignal>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/framework/cli/cli_fixture.hpp"

/// `tomlin sweep` as a user sees it.
namespace tomlin::test {
namespace {

const std::vector<std::string> kSweptForce = {"--observable", "driver.mean_force.x"};

class SweepCommand : public Cli {
 protected:
  /// `tomlin sweep tip.toml` with these options and the mean force.
  Ended sweep(std::vector<std::string> options, const Conditions& conditions = {}) {
    options.insert(options.begin(), {"sweep", "tip.toml"});
    options.insert(options.end(), kSweptForce.begin(), kSweptForce.end());
    return tomlin(options, conditions);
  }
};

TEST_F(SweepCommand, LeavesATableAnArrayAndASummary) {
  const Ended ended = expect_status(
      0, sweep({"--over", "v=1e-2,2e-2", "--over", "run.integrator.dt=1e-2,2e-2,-1"}));
  EXPECT_TRUE(contains(ended.out, "4 points finished, 2 refused\n")) << ended.out;
  EXPECT_LE(lines(ended.out), 10);
  for (const char* name : {"sweep.csv", "sweep.h5", "sweep.json", "scene.toml", "sweep.journal"}) {
    EXPECT_TRUE(exists(std::string("tip.sweep.out/") + name)) << name;
  }
  EXPECT_FALSE(exists("tip.sweep.out/run.journal"));
  const std::string table = file("tip.sweep.out/sweep.csv");
  EXPECT_EQ(lines(table), 7);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "v,run.integrator.dt,driver.mean_force.x [force],status,reason");
  const Json json = sweep_summary("tip.sweep.out");
  EXPECT_EQ(json["status"], "finished");
  EXPECT_EQ(json["points"], 6);
  EXPECT_EQ(json["counts"]["finished"], 4);
  EXPECT_EQ(json["counts"]["refused"], 2);
  EXPECT_EQ(json["axes"][0]["name"], "v");
  EXPECT_EQ(json["axes"][0]["values"], (std::vector<double>{1e-2, 2e-2}));
  EXPECT_EQ(json["observables"][0]["path"], "drivers.driver.mean_force.x");
}

constexpr const char* kWarmTip = R"([parameters]
v = 0.1
[[body]]
type = "point"
name = "tip"
position = [0.0]
particle_mass = 1.0
[[force]]
type = "driving_spring"
name = "driver"
stiffness = 2.0
velocity = ["v"]
[[force]]
type = "langevin"
name = "bath"
coefficient = 1.0
temperature = 0.1
[run]
duration = 20
integrator = { type = "gjf", dt = 0.05 }
)";

/// Each repeat of a sweep is a run with a stream of its own; of a run with repeats the sweep's
/// streams share no run.
TEST_F(SweepCommand, Repeats) {
  write(folder_ / "warm.toml", kWarmTip);
  const auto warm = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"sweep", "warm.toml", "--observable", "driver.mean_force.x"});
    return tomlin(more);
  };
  ASSERT_EQ(warm({"--over", "v=0.1,0.2", "--repeats", "3", "-o", "a"}).status, 0);
  const std::string table = file("a/sweep.csv");
  EXPECT_EQ(lines(table), 7);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "run.stream,v,driver.mean_force.x [force],error.driver.mean_force.x "
            "[force],status,reason");
  EXPECT_EQ(sweep_summary("a")["axes"][0]["name"], "run.stream");
  ASSERT_EQ(tomlin({"sweep", "a/scene.toml", "-o", "again"}).status, 0);
  EXPECT_EQ(results("again"), results("a"));

  double sum = 0.0;
  for (const std::string stream : {"0", "1", "2"}) {
    expect_status(0, tomlin({"run", "warm.toml", "--set", "run.stream=" + stream, "-o",
                             "run" + stream, "--quiet"}));
    const double force = summary("run" + stream)["drivers"]["driver"]["mean_force"][0];
    EXPECT_TRUE(contains(table, "\n" + stream + ",")) << table;
    const std::string start = "\n" + stream + ",0.1";
    const std::size_t row = table.find(start);
    ASSERT_NE(row, std::string::npos);
    EXPECT_EQ(std::stod(table.substr(table.find(',', row + start.size()) + 1)), force);
    sum += force;
  }
  expect_status(0, tomlin({"run", "warm.toml", "--set", "run.repeats=3", "-o", "mean", "--quiet"}));
  const double mean = summary("mean")["drivers"]["driver"]["mean_force"][0];
  const double error = summary("mean")["error"]["drivers.driver.mean_force.x"];
  constexpr double kSigmas = 6.0;  // of two means over three runs; seeds are fixed
  constexpr double kOtherRuns = 1e-6;
  EXPECT_NEAR(mean, sum / 3.0, kSigmas * error);
  EXPECT_GT(std::abs(mean - sum / 3.0), kOtherRuns * error);
}

TEST_F(SweepCommand, RepeatsOfWhatIsNotRandomAreRefused) {
  write(folder_ / "warm.toml", kWarmTip);
  const Ended cold = expect_status(2, sweep({"--over", "v=0.1,0.2", "--repeats", "3"}));
  expect_error(cold, "[command.conflict]");
  EXPECT_FALSE(exists("tip.sweep.out"));
  for (const std::string wrong : {"1", "-3", "two", "1.5"}) {
    const Ended ended = tomlin({"sweep", "warm.toml", "--over", "v=0.1,0.2", "--observable",
                                "driver.mean_force.x", "--repeats", wrong});
    EXPECT_EQ(ended.status, 2) << wrong;
    expect_error(ended, "--repeats: [command.invalid_value]");
  }
  // Such a sweep would have the same noise at every point of a line.
  const Ended same =
      expect_status(2, tomlin({"sweep", "warm.toml", "--over", "v=0.1,0.2", "--observable",
                               "driver.mean_force.x", "--continue-from-neighbour"}));
  expect_error(same, "--continue-from-neighbour: [command.conflict]");
}

TEST_F(SweepCommand, TheSceneMayHaveTheTable) {
  write(folder_ / "tip.toml", std::string(kTip) +
                                  "\n[sweep]\nover = { v = [1e-2, 2e-2], two_v = [1.0, 2.0] }\n"
                                  "zip = [\"v\", \"two_v\"]\n"
                                  "observables = [\"driver.mean_force.x\"]\n");
  EXPECT_EQ(tomlin({"sweep", "tip.toml"}).status, 0);
  EXPECT_EQ(lines(file("tip.sweep.out/sweep.csv")), 3);
  // Options replace it.
  const Ended other =
      expect_status(0, tomlin({"sweep", "tip.toml", "--over", "v=1:3:4", "-o", "other"}));
  EXPECT_EQ(lines(file("other/sweep.csv")), 5);
  // Nothing of it is in a run.
  EXPECT_EQ(tomlin({"run", "tip.toml", "-o", "run"}).status, 0);
  EXPECT_FALSE(contains(file("run/scene.toml"), "sweep"));
  // The written scene has the same sweep.
  EXPECT_EQ(tomlin({"sweep", "tip.sweep.out/scene.toml", "-o", "again"}).status, 0);
  EXPECT_EQ(results("again"), results("tip.sweep.out"));
}

TEST_F(SweepCommand, AllFaultsTogetherAndNothingIsMade) {
  expect_refused({"sweep", "tip.toml"},
                 "tomlin: [command.missing_argument]\ntomlin: [command.missing_argument]\n",
                 {"--over", "--observable"});
  expect_refused({"sweep", "tip.toml", "--over", "two_w=1,2", "--over", "v=1:2:1", "--over", "v",
                  "--over", "two_v=1,2,3", "--over", "force.drivr.stiffness=1,2", "--zip",
                  "two_v,two_w", "--observable", "driver.maen_force.x"},
                 "--over: [command.invalid_value]\n"
                 "--over: v [command.missing_argument]\n"
                 "--zip: zip = two_v,two_w [scene.wrong_count]\n"
                 "--over: two_w = 1 [scene.unknown_key] did you mean two_v\n"
                 "--over: force.drivr.stiffness = 1 [scene.unknown_name] did you mean driver\n"
                 "--observable: driver.maen_force.x [observable.unknown] did you mean "
                 "driver.mean_force.x\n",
                 {"v = 1:2:1"});
  // Faults are found in the table, in options that replace a part of it and in the scene only.
  write(folder_ / "tip.toml",
        std::string(kTip) +
            "\n[sweep]\nover = { v = \"1:2\", two_v = [1.0, 2.0], \"run.until\" = "
            "[] }\nzip = [\"v\", \"two_v\"]\nobservables = [1]\nzp = 1\n");
  expect_refused({"sweep", "tip.toml", "--set", "force.driver.stiffness=a", "--observable",
                  "driver.maen_force.x"},
                 "tip.toml:42:14: sweep.over.v = \"1:2\" [scene.wrong_type]\n"
                 "tip.toml:42:55: sweep.over.run.until = [] [scene.wrong_count]\n"
                 "tip.toml:44:15: sweep.observables = [1] [scene.wrong_type]\n"
                 "tip.toml:45:1: sweep.zp [scene.unknown_key] did you mean zip\n"
                 "--set force.driver.stiffness=a: force.driver.stiffness = a "
                 "[expression.unknown_name]\n");
  const std::vector<std::string> no_options = {"sweep", "tip.toml"};
  EXPECT_FALSE(contains(tomlin(no_options).err, "no observable"));
  write(folder_ / "tip.toml", kTip);
  EXPECT_EQ(sweep({"--over", "v=1,2", "--threads", "0"}).status, 2);
  EXPECT_EQ(sweep({"--over", "v=1,2", "--set", "w=1"}).status, 2);
}

TEST_F(SweepCommand, DryRunMakesNothing) {
  const auto before = all_files();
  const Ended ended = expect_status(
      0, sweep({"--over", "v=1e-3:1e-1:5:log", "--over", "two_v=1:2:3", "--dry-run"}));
  expect_parts(ended.out, {"5 x 3 = 15", "v = 0.001, two_v = 1\n", "v = 0.1, two_v = 2\n", "cost"});
  EXPECT_EQ(all_files(), before);
}

TEST_F(SweepCommand, AFolderOfAnotherSweepNeedsForce) {
  ASSERT_EQ(sweep({"--over", "v=1e-2,2e-2", "-o", "a"}).status, 0);
  const std::string first = results("a");
  const Ended same = expect_status(0, sweep({"--over", "v=1e-2,2e-2", "-o", "a"}));
  EXPECT_TRUE(contains(same.out, "finished already")) << same.out;
  EXPECT_EQ(results("a"), first);
  const Ended other = expect_status(2, sweep({"--over", "v=1e-2,3e-2", "-o", "a"}));
  expect_error(other, "[resume.other_scene]", {"--force"});
  EXPECT_EQ(results("a"), first);
  EXPECT_EQ(sweep({"--over", "v=1e-2,3e-2", "-o", "a", "--force"}).status, 0);
  EXPECT_NE(results("a"), first);
  // A run's folder, and a run in a sweep's.
  ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "run", "--quiet"}).status, 0);
  EXPECT_EQ(sweep({"--over", "v=1e-2,2e-2", "-o", "run"}).status, 2);
  EXPECT_EQ(tomlin({"run", "tip.toml", "-o", "a"}).status, 2);
  // No file of a run stays that would be taken for one of the sweep.
  expect_status(
      0, tomlin({"run", "tip.toml", "-o", "b", "--quiet", "--set", "output.trajectory=true"}));
  write(folder_ / "b/run.journal", "of a run that was stopped");
  write(folder_ / "b/run.checkpoint", "x");
  write(folder_ / "b/notes", "mine");
  EXPECT_EQ(sweep({"--over", "v=1e-2,2e-2", "-o", "b", "--force"}).status, 0);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_ / "b")) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"notes", "scene.toml", "sweep.csv", "sweep.h5",
                                             "sweep.journal", "sweep.json"}));
  EXPECT_EQ(results("b"), first);
  // A damaged journal.
  std::string journal = file("a/sweep.journal");
  journal[20] = static_cast<char>(journal[20] ^ 1);
  write(folder_ / "a/sweep.journal", journal);
  EXPECT_EQ(sweep({"--over", "v=1e-2,3e-2", "-o", "a"}).status, 2);
  EXPECT_EQ(sweep({"--over", "v=1e-2,3e-2", "-o", "a", "--force"}).status, 0);
}

/// Missing results are made again from the rows.
TEST_F(SweepCommand, ResultsThatWereRemovedComeBack) {
  ASSERT_EQ(sweep({"--over", "v=1e-2,2e-2", "-o", "a"}).status, 0);
  const std::string first = results("a");
  fs::remove(folder_ / "a/sweep.csv");
  // A kill between a row and the end of its point leaves a checkpoint.
  fs::create_directory(folder_ / "a/sweep.points");
  write(folder_ / "a/sweep.points/1.store", "left by a kill");
  const Ended ended = expect_status(0, sweep({"--over", "v=1e-2,2e-2", "-o", "a"}));
  EXPECT_TRUE(contains(ended.out, "for 0 points")) << ended.out;
  EXPECT_FALSE(exists("a/sweep.points"));
  EXPECT_EQ(results("a"), first);
}

/// Full results of chosen points are those of a run, in any number of threads and after a kill.
TEST_F(SweepCommand, TracesAreRuns) {
  const std::vector<std::string> options = {"--over", "v=1e-2,2e-2,3e-2",       "--trace",   "0,2",
                                            "--set",  "output.trajectory=true", "--threads", "2"};
  expect_status(0, sweep(options));
  EXPECT_FALSE(exists("tip.sweep.out/sweep.points/1"));
  const std::string trace = "tip.sweep.out/sweep.points/2/";
  expect_status(0, tomlin({"run", "tip.toml", "--set", "v=3e-2", "--set", "output.trajectory=true",
                           "-o", "run"}));
  for (const char* name : {"observables.csv", "events.csv", "trajectory.h5", "scene.toml"}) {
    EXPECT_EQ(file(trace + name), file(std::string("run/") + name)) << name;
  }
  EXPECT_EQ(comparable_summary(trace), comparable_summary("run"));
  // Later ones are added, and rows are not run again.
  const std::string table = file("tip.sweep.out/sweep.csv");
  std::vector<std::string> more = options;
  more[3] = "all";
  const Ended added = expect_status(0, sweep(more));
  EXPECT_TRUE(contains(added.out, "for 0 points")) << added.out;
  EXPECT_TRUE(exists("tip.sweep.out/sweep.points/1/summary.json"));
  EXPECT_EQ(file("tip.sweep.out/sweep.csv"), table);
  more[3] = "1,3,x,2-1";
  const Ended wrong = expect_status(2, sweep(more));
  EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 3) << wrong.err;
}

/// Only what tomlin has made is taken away, and a trace that cannot be written is not passed over.
TEST_F(SweepCommand, WhatOthersHavePutAmongThePointsStays) {
  const std::vector<std::string> options = {"--over", "v=1e-2,2e-2", "-o", "a"};
  ASSERT_EQ(sweep(options).status, 0);
  fs::create_directories(folder_ / "a/sweep.points/mine");
  for (const char* name : {"notes.store", "mine/summary.json", "3.store", "3.store.part"}) {
    write(folder_ / "a/sweep.points" / name, "x");
  }
  EXPECT_EQ(sweep(plus(options, {"--force"})).status, 0);
  EXPECT_TRUE(exists("a/sweep.points/notes.store"));
  EXPECT_TRUE(exists("a/sweep.points/mine/summary.json"));
  EXPECT_FALSE(exists("a/sweep.points/3.store"));
  EXPECT_FALSE(exists("a/sweep.points/3.store.part"));
  fs::remove_all(folder_ / "a/sweep.points");
  write(folder_ / "a/sweep.points", "a file");
  fs::remove(folder_ / "a/sweep.csv");
  EXPECT_EQ(sweep(options).status, 0);
  EXPECT_EQ(file("a/sweep.points"), "a file");
  EXPECT_NE(sweep(plus(options, {"--trace", "0"})).status, 0);
}

TEST_F(SweepCommand, AJournalThatIsALinkIsNotFollowed) {
  fs::create_directories(folder_ / "a");
  write(folder_ / "other", "");
  fs::create_symlink(folder_ / "other", folder_ / "a/sweep.journal");
  EXPECT_NE(sweep({"--over", "v=1e-2,2e-2", "-o", "a"}).status, 0);
  EXPECT_EQ(file("other"), "");
}

/// Traces of a finished sweep that are stopped are no end, and its results stay.
TEST_F(SweepCommand, StoppedTracesAreToldAndGoOn) {
  const std::vector<std::string> options = {
      "--over", "v=1e-2,2e-2", "-o", "a", "--threads", "1", "--set", "run.duration=2e4"};
  ASSERT_EQ(sweep(options).status, 0);
  const std::string first = results("a");
  std::vector<std::string> traced = plus(options, {"--trace", "all"});
  const Ended stopped = sweep(traced, {.then = [&](pid_t child) {
                                appears(folder_ / "a/sweep.points/0/run.journal");
                                ::kill(child, SIGTERM);
                              }});
  EXPECT_EQ(stopped.status, 128 + SIGTERM) << stopped.out;
  EXPECT_TRUE(contains(stopped.out, "traces left")) << stopped.out;
  EXPECT_EQ(results("a"), first);
  EXPECT_EQ(sweep(traced).status, 0);
  EXPECT_TRUE(exists("a/sweep.points/1/summary.json"));
  EXPECT_EQ(results("a"), first);
}

/// Stopped by signals, killed at random moments, and repeated: as if it had been left alone.
TEST_F(SweepCommand, StoppedKilledAndRepeatedItIsTheSame) {
  // Above a second in all, in lanes, and the first rows after some hundredths of it.
  constexpr int kPoints = 9000;
  std::vector<std::string> options = {"--over",    "v=1e-3:1e-1:3000",
                                      "--over",    "force.driver.stiffness=2,3,-1",
                                      "--threads", "2",
                                      "-o",        "a"};
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto stop = [&](pid_t child) {
      appears(folder_ / "a/scene.toml");
      signal_after(std::chrono::milliseconds(150), signal)(child);
    };
    expect_status(128 + signal, sweep(options, {.then = stop}));
    EXPECT_EQ(sweep_summary("a")["status"], "interrupted");
    EXPECT_FALSE(exists("a/sweep.csv"));
    EXPECT_FALSE(exists("a/sweep.h5"));
  }
  const int before = sweep_summary("a")["performance"]["rows"];
  EXPECT_GT(before, 0);
  std::mt19937 random(7);
  int kills = 0;
  for (int k = 0; k < 12; ++k) {
    const std::chrono::milliseconds wait(20 + random() % 150);
    const Ended ended = sweep(options, {.then = signal_after(wait, SIGKILL)});
    if (ended.status == 0) break;
    ASSERT_EQ(ended.status, 128 + SIGKILL) << ended.err;
    ++kills;
  }
  EXPECT_GT(kills, 2);
  expect_status(0, sweep(options));
  EXPECT_LE(sweep_summary("a")["performance"]["rows_of_this_process"], kPoints - before);
  options.back() = "b";
  expect_status(0, sweep(options));
  EXPECT_EQ(results("a"), results("b"));
}

/// A point starts where the one before it has ended: in any number of threads and parts, and when
/// it is killed.
TEST_F(SweepCommand, ContinuesFromTheNeighbour) {
  const std::vector<std::string> axes = {"--over", "force.driver.stiffness=1,2,3,4", "--over",
                                         "v=1e-2:5e-2:12"};
  const auto with = [&](std::vector<std::string> more) {
    return plus(plus(axes, {"--continue-from-neighbour", "-o"}), more);
  };
  ASSERT_EQ(sweep(with({"a", "--threads", "1"})).status, 0);
  const std::string whole = results("a");
  EXPECT_TRUE(contains(file("a/scene.toml"), "continue_from_neighbour = true\n"));
  EXPECT_EQ(sweep_summary("a")["continue_from_neighbour"], true);
  for (const std::string threads : {"2", "3"}) {
    ASSERT_EQ(sweep(with({"t", "--force", "--threads", threads})).status, 0);
    EXPECT_EQ(results("t"), whole) << threads;
  }
  // The table gives the same sweep; without the option it is another one.
  ASSERT_EQ(tomlin({"sweep", "a/scene.toml", "-o", "table"}).status, 0);
  EXPECT_EQ(results("table"), whole);
  std::vector<std::string> alone = plus(axes, {"-o", "a"});
  expect_error(sweep(alone), "[resume.other_scene]");
  alone.back() = "alone";
  ASSERT_EQ(sweep(alone).status, 0);
  EXPECT_NE(file("alone/sweep.csv"), file("a/sweep.csv"));
  EXPECT_EQ(sweep_summary("alone")["continue_from_neighbour"], false);
  // Lines stay together in parts.
  for (const std::string shard : {"1", "2", "3"}) {
    ASSERT_EQ(sweep(with({"part" + shard, "--shard", shard + "/3"})).status, 0);
  }
  ASSERT_EQ(tomlin({"merge", "part1", "part2", "part3", "-o", "merged"}).status, 0);
  EXPECT_EQ(results("merged"), whole);
  // Killed, with checkpoints and without.
  for (const std::string every : {"1e-3", "60"}) {
    const auto options = with({"k", "--threads", "2", "--set", "run.checkpoint_every=" + every,
                               "--set", "run.duration=2e3"});
    const auto again = [&](const std::string& folder) {
      std::vector<std::string> other = options;
      *std::find(other.begin(), other.end(), "k") = folder;
      return other;
    };
    fs::remove_all(folder_ / "k");
    std::mt19937 random(11);
    int kills = 0;
    for (int k = 0; k < 12; ++k) {
      const std::chrono::milliseconds wait(20 + random() % 60);
      const int signal = k % 2 == 0 ? SIGKILL : SIGTERM;
      if (sweep(options, {.then = signal_after(wait, signal)}).status == 0) break;
      ++kills;
    }
    EXPECT_GT(kills, 1) << every;
    ASSERT_EQ(sweep(options).status, 0);
    EXPECT_FALSE(exists("k/sweep.points")) << every;
    ASSERT_EQ(sweep(again("left_alone" + every)).status, 0);
    EXPECT_EQ(results("k"), results("left_alone" + every)) << every;
  }
  const Ended traced = expect_status(2, sweep(with({"b", "--trace", "0"})));
  expect_error(traced, "--trace: [command.conflict]");
}

/// The mean force falls to 1 and below as the driver becomes slower: bisection finds where.
const std::vector<std::string> kRefinedForce = {"--over",   "force.driver.stiffness=1,2,-1",
                                                "--over",   "v=1e-2:1:5:log",
                                                "--refine", "driver.mean_force.x=1"};

/// In any number of threads, by its table, and whenever it is stopped or killed.
TEST_F(SweepCommand, IsRefined) {
  const auto with = [](std::vector<std::string> more) {
    more.insert(more.begin(), kRefinedForce.begin(), kRefinedForce.end());
    return more;
  };
  const Ended ended = expect_status(0, sweep(with({"-o", "a", "--threads", "1"})));
  EXPECT_TRUE(contains(ended.out, "2 found, 1 none")) << ended.out;
  const std::string whole = results("a");
  const Json json = sweep_summary("a");
  const Json& refine = json["refine"];
  EXPECT_EQ(refine["observable"], "drivers.driver.mean_force.x");
  EXPECT_EQ(refine["along"], "v");
  ASSERT_EQ(refine["intervals"].size(), 3);
  EXPECT_EQ(refine["intervals"][2]["status"], "none");
  EXPECT_EQ(refine["intervals"][2]["axes"]["force.driver.stiffness"], -1.0);
  for (const int k : {0, 1}) {
    const Json& interval = refine["intervals"][k];
    EXPECT_EQ(interval["axes"]["force.driver.stiffness"], k + 1.0);
    EXPECT_LT(interval["values"][0], 1.0);
    EXPECT_GE(interval["values"][1], 1.0);
    const double low = interval["interval"][0];
    const double high = interval["interval"][1];
    EXPECT_LE(std::log(high / low), 1e-4 * std::log(100.0));
    // A point is a run with these digits.
    expect_status(
        0, tomlin({"run", "tip.toml", "--set", fmt::format("v={}", low), "--set",
                   fmt::format("force.driver.stiffness={}", k + 1), "-o", "run", "--force"}));
    EXPECT_EQ(summary("run")["drivers"]["driver"]["mean_force"][0], interval["values"][0]);
  }
  EXPECT_EQ(json["points"], lines(file("a/sweep.csv")) - 1);
  EXPECT_EQ(json["points"], 15 + 2 * 12);  // a quarter of the axis, halved to 1e-4 of it

  for (const std::string threads : {"2", "3"}) {
    ASSERT_EQ(sweep(with({"-o", "t", "--force", "--threads", threads})).status, 0);
    EXPECT_EQ(results("t"), whole) << threads;
  }
  ASSERT_EQ(tomlin({"sweep", "a/scene.toml", "-o", "table"}).status, 0);
  EXPECT_EQ(results("table"), whole);
  // Nothing is run again, be it complete or without its results.
  EXPECT_TRUE(contains(sweep(with({"-o", "a"})).out, "finished already"));
  fs::remove(folder_ / "a/sweep.h5");
  EXPECT_TRUE(contains(sweep(with({"-o", "a"})).out, "for 0 points"));
  EXPECT_EQ(results("a"), whole);
  Json again = sweep_summary("a");
  EXPECT_EQ(again["refine"], refine);
  EXPECT_EQ(again["points"], json["points"]);
  // A damaged record of an added point is no record, though all results are there.
  const double of_it = refine["intervals"][0]["values"][0];
  std::string journal = file("a/sweep.journal");
  const std::string bytes(reinterpret_cast<const char*>(&of_it), sizeof of_it);
  const std::size_t at = journal.find(bytes);
  ASSERT_NE(at, std::string::npos);
  journal[at] = static_cast<char>(~journal[at]);
  write(folder_ / "a/sweep.journal", journal);
  EXPECT_TRUE(contains(sweep(with({"-o", "a"})).out, "for 1 points"));
  EXPECT_EQ(results("a"), whole);
  // Another level is another sweep.
  std::vector<std::string> other = with({"-o", "a"});
  other[5] = "driver.mean_force.x=1.1";
  expect_error(sweep(other), "[resume.other_scene]");

  const Ended dry = sweep(with({"-o", "dry", "--dry-run"}));
  EXPECT_TRUE(contains(dry.out, "adds up to 144 points")) << dry.out;
  EXPECT_FALSE(exists("dry"));
}

TEST_F(SweepCommand, RefinedAndKilledItIsTheSame) {
  // Some tenths of a second, most of them in rounds of one or two points.
  std::vector<std::string> options =
      plus(kRefinedForce, {"--set", "run.duration=3000", "--threads", "2", "-o", "a"});
  std::mt19937 random(11);
  int kills = 0;
  for (int k = 0; k < 20; ++k) {
    Conditions conditions;
    const int signal = k % 3 == 2 ? SIGTERM : SIGKILL;
    conditions.then = [&](pid_t child) {
      appears(folder_ / "a/scene.toml");
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
      ::kill(child, signal);
    };
    const Ended ended = sweep(options, conditions);
    if (ended.status == 0) break;
    ASSERT_EQ(ended.status, 128 + signal) << ended.err;
    ++kills;
  }
  EXPECT_GT(kills, 2);
  EXPECT_EQ(sweep(options).status, 0);
  EXPECT_FALSE(exists("a/sweep.points"));
  options.back() = "b";
  EXPECT_EQ(sweep(options).status, 0);
  EXPECT_EQ(results("a"), results("b"));
}

TEST_F(SweepCommand, RefinementThatIsWrongIsRefused) {
  expect_refused({"sweep", "tip.toml", "--over", "v=1,2", "--over", "force.drivr.stiffness=1,2",
                  "--refine", "driver.maen_force.x=y", "--refine-along", "vv", "--refine-to", "0",
                  "--observable", "tip.x"},
                 "--refine: driver.maen_force.x=y [command.invalid_value]\n"
                 "--refine-to: 0 [command.invalid_value]\n"
                 "--refine-along: vv [scene.unknown_name]\n"
                 "--over: force.drivr.stiffness = 1 [scene.unknown_name] did you mean driver\n"
                 "--observable: tip.x [observable.unknown]\n"
                 "--refine: driver.maen_force.x [observable.unknown] did you mean "
                 "driver.mean_force.x\n");
  const auto refused = [&](std::vector<std::string> more, const std::string& errors) {
    more.insert(more.begin(), {"sweep", "tip.toml", "--over", "v=1,2"});
    expect_refused(more, errors);
  };
  const std::string what = "driver.mean_force.x";
  refused({"--observable", what, "--refine-to", "1"},
          "--refine-to: 1 [command.missing_argument]\n");
  refused({"--refine", what, "--shard", "1/2", "--trace", "all"},
          "--trace: [command.conflict]\n--shard: [command.conflict]\n");
  refused({"--refine", what, "--continue-from-neighbour"},
          "--refine: driver.mean_force.x [command.conflict]\n");
  refused({"--refine", what, "--over", "two_v=1,2", "--zip", "v,two_v"},
          "--refine: driver.mean_force.x [scene.conflict]\n");
  write(folder_ / "tip.toml", std::string(kTip) +
                                  "\n[sweep]\nover = { v = [1.0, 2.0] }\nrefine = \"" + what +
                                  "=1\"\nrefine_along = \"two_v\"\nrefine_to = -1\n");
  expect_refused({"sweep", "tip.toml"},
                 "tip.toml:45:13: sweep.refine_to = -1 [command.invalid_value]\n"
                 "tip.toml:44:16: sweep.refine_along = two_v [scene.unknown_name]\n");
}

TEST_F(SweepCommand, AFullDiskStopsWithAMessageAndGoesOnLater) {
  const std::vector<std::string> options = {"--over", "v=1e-2:1e-1:60", "-o", "a"};
  const Ended full = expect_status(1, sweep(options, {.largest_file = 4000}));
  expect_error(full, "[file.cannot_write]", {"sweep.journal"});
  EXPECT_FALSE(exists("a/sweep.csv"));
  EXPECT_EQ(sweep(options).status, 0);
  EXPECT_LT(sweep_summary("a")["performance"]["rows_of_this_process"], 60);
}

}  // namespace
}  // namespace tomlin::test
