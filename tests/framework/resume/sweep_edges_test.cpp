#include <cerrno>
#include <csignal>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/resume/resume_fixture.hpp"

/// Sweeps and merges lose no result where files change, folders move, and the system fails.
namespace tomlin::test {
namespace {

constexpr const char* kTipOfAFile = R"(
[[body]]
name = "tip"
type = "particles"
file = "p0"
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.1]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
name = "substrate"
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 3.0
integrator = { type = "rk4", dt = 1e-2 }
)";

constexpr const char* kAtomsOfAFile = R"(
[scene]
units = "metal"
[[body]]
name = "atoms"
type = "particles"
positions = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0]]
species = "C"
particle_mass = 12.0
[[force]]
name = "bonds"
type = "tersoff"
file = "p0"
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 1.0
velocity = [1.0, 0.0, 0.0]
attach = { particle = 0 }
[run]
duration = 0.01
integrator = { type = "velocity_verlet", dt = 1e-4 }
)";

constexpr const char* kMapOfAFile = R"(
[[body]]
name = "tip"
type = "point"
position = [0.1, 0.2]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.1, 0.0]
[[force]]
name = "map"
type = "lattice_substrate"
energy_map = "p0"
lattice = "square"
period = 1.0
[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";

std::string tersoff_set(const std::string& a) {
  return "C C C 3 1 0 38049 4.3484 -0.57058 0.72751 1.5724e-7 2.2119 346.74 1.95 0.15 3.4879 " + a +
         "\n";
}

std::string map_of(const std::string& highest) {
  return "# \xC5 in Latin-1\n0 0 0 0\n0 " + highest + " 0 0\n0 0 0.1 0\n0 0 0 0\n";
}

/// A scene whose file p0 an axis replaces by p1 and p2.
struct FileAxis {
  const char* scene;
  std::string axis;
  std::string observable;
  std::vector<std::string> texts;  ///< of p0, p1, p2, and another one
};

const std::vector<FileAxis>& file_axes() {
  static const std::vector<FileAxis> axes = {
      {kTipOfAFile,
       "body.tip.file=p1,p2",
       "driver.final_force.x",
       {"0.5\n", "0.2\n", "0.3\n", "0.35\n"}},
      {kAtomsOfAFile,
       "force.bonds.file=p1,p2",
       "driver.final_force.x",
       {tersoff_set("1393.6"), tersoff_set("1400"), tersoff_set("1410"), tersoff_set("1420")}},
      {kMapOfAFile,
       "force.map.energy_map=p1,p2",
       "driver.final_force.x",
       {map_of("0.1"), map_of("0.2"), map_of("0.3"), map_of("0.4")}}};
  return axes;
}

class SweepEdges : public Cli {
 protected:
  static std::vector<std::string> failing(const std::vector<std::string>& conditions) {
    return plus(impatient(), conditions);
  }
  /// A sweep of twelve short points.
  Ended sweep(std::vector<std::string> options, const Conditions& conditions = {}) {
    options.insert(options.begin(),
                   {"sweep", "tip.toml", "--over", "v=1e-2,2e-2,3e-2", "--over",
                    "force.driver.stiffness=1,2,3,4", "--observable", "driver.mean_force.x",
                    "--set", "run.duration=220", "--quiet"});
    return tomlin(options, conditions);
  }
  Ended merge(std::vector<std::string> options, const Conditions& conditions = {}) {
    options.insert(options.begin(), {"merge"});
    options.push_back("--quiet");
    return tomlin(options, conditions);
  }
  int calls() { return std::stoi(file("calls")); }
};

/// Whatever a component reads: what an axis names is known by its content, and stands in the scene
/// of the sweep.
TEST_F(SweepEdges, FilesOfAxesAreKnownByTheirContent) {
  for (const FileAxis& one : file_axes()) {
    for (const char* folder : {"a", "b", "again", "fresh", "s1", "s2", "m", "elsewhere"}) {
      fs::remove_all(folder_ / folder);
    }
    write(folder_ / "scene.toml", one.scene);
    for (int k = 0; k < 3; ++k) {
      write(folder_ / ("p" + std::to_string(k)), one.texts[static_cast<std::size_t>(k)]);
    }
    const std::vector<std::string> arguments = {"sweep",        "scene.toml",   "--over",  one.axis,
                                                "--observable", one.observable, "--quiet", "-o"};
    const auto into = [&](const std::string& folder, const std::string& shard = "") {
      std::vector<std::string> all = plus(arguments, {folder});
      if (!shard.empty()) all.insert(all.end(), {"--shard", shard});
      return all;
    };
    ASSERT_EQ(tomlin(into("a")).status, 0) << one.axis;
    EXPECT_EQ(tomlin(into("a")).status, 0);
    const std::string table = file("a/sweep.csv");
    expect_parts(table, {"\"p1\",", ",finished,\n"});

    // The scene in the folder is the same sweep, wherever it lies, and a scene to run.
    fs::create_directory(folder_ / "elsewhere");
    fs::copy_file(folder_ / "a/scene.toml", folder_ / "elsewhere/scene.toml");
    const Ended again =
        expect_status(0, tomlin({"sweep", "elsewhere/scene.toml", "-o", "again", "--quiet"}));
    EXPECT_EQ(results("again"), results("a"));
    EXPECT_EQ(tomlin({"run", "elsewhere/scene.toml", "-o", "b", "--quiet"}).status, 0);

    // Another content is another sweep, whose file is named.
    ASSERT_EQ(tomlin(into("s1", "1/2")).status, 0);
    ASSERT_EQ(tomlin(into("s2", "2/2")).status, 0);
    EXPECT_EQ(merge({"s1", "s2", "-o", "m"}).status, 0);
    EXPECT_EQ(results("m"), results("a"));
    write(folder_ / "p2", one.texts[3]);
    const Ended changed = expect_status(2, tomlin(into("a")));
    expect_error(changed, "-o: a [resume.other_scene]", {"files have changed", "p2"});
    EXPECT_FALSE(contains(changed.err, "p1,"));
    EXPECT_EQ(file("a/sweep.csv"), table);
    ASSERT_EQ(tomlin(into("fresh")).status, 0);
    EXPECT_NE(file("fresh/sweep.csv"), table);
    fs::remove_all(folder_ / "s2");
    ASSERT_EQ(tomlin(into("s2", "2/2")).status, 0);
    const Ended merged = expect_status(2, merge({"s1", "s2", "-o", "other"}));
    expect_error(merged, "[resume.other_scene]", {"s2"});
    EXPECT_FALSE(exists("other"));
  }
}

/// A file that a scene refuses stays what it was: neither messages nor results have its words.
TEST_F(SweepEdges, WordsOfFilesAreNeverPrinted) {
  std::string secret = "SECRET:token";
  for (int k = 0; k < 40; ++k) secret += " TOKEN" + std::to_string(k);
  for (const std::string& text : std::vector<std::string>{
           secret, "C C C 3 1 SECRET:token 1 2 3 4 5 6 7 8 9 10 11", "1 2\nSECRET:token 3\n"}) {
    for (const FileAxis& one : file_axes()) {
      write(folder_ / "scene.toml", one.scene);
      write(folder_ / "p0", text);
      for (const char* command : {"check", "run", "explain"}) {
        const Ended ended = tomlin({command, "scene.toml"});
        EXPECT_EQ(ended.status, 2) << one.axis;
        EXPECT_FALSE(contains(ended.err + ended.out, "SECRET")) << ended.err;
        EXPECT_FALSE(contains(ended.err + ended.out, "TOKEN")) << ended.err;
      }
      write(folder_ / "p0", one.texts[0]);
      write(folder_ / "p1", one.texts[1]);
      write(folder_ / "p2", text);
      const Ended ended =
          expect_status(0, tomlin({"sweep", "scene.toml", "--over", one.axis, "--observable",
                                   one.observable, "-o", "x", "--force"}));
      for (const std::string& part : {ended.err, ended.out, file("x/sweep.csv"),
                                      file("x/scene.toml"), file("x/sweep.json")}) {
        EXPECT_FALSE(contains(part, "SECRET")) << part;
      }
    }
  }
}

/// The sweep whose folder was moved away writes nothing into the one that has the name now.
TEST_F(SweepEdges, AMovedFolderIsLeftAlone) {
  std::map<std::string, std::string> before;
  const auto move = [&](pid_t) {
    EXPECT_TRUE(appears(folder_ / "out/scene.toml"));
    fs::rename(folder_ / "out", folder_ / "old");
    EXPECT_EQ(sweep({"-o", "out"}).status, 0);
    before = files_of(folder_ / "out");
  };
  // A second for two points, with checkpoints all the time.
  const Ended moved = tomlin(
      {"sweep", "tip.toml", "--over", "v=1e-2,2e-2", "--observable", "driver.mean_force.x", "--set",
       "run.duration=2e4", "--set", "run.checkpoint_every=1e-3", "--threads", "1", "-o", "out"},
      {.then = move, .environment = impatient()});
  EXPECT_EQ(moved.status, 1) << moved.out;
  expect_error(moved, "[file.cannot_write]", {"it has gone"});
  EXPECT_EQ(before.size(), 5);
  EXPECT_EQ(files_of(folder_ / "out"), before);
  EXPECT_FALSE(exists("out/sweep.points"));
  // Its rows are where it is.
  expect_status(0, tomlin({"sweep", "tip.toml", "--over", "v=1e-2,2e-2", "--observable",
                           "driver.mean_force.x", "--set", "run.duration=2e4", "--set",
                           "run.checkpoint_every=1e-3", "-o", "old"}));
  EXPECT_EQ(sweep_summary("old")["performance"]["rows_of_this_process"], 0);
}

/// Whichever open of the journals fails once: no row is lost.
TEST_F(SweepEdges, WhatCannotBeReadIsNotLost) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  for (const char* k : {"1", "2", "3"}) {
    ASSERT_EQ(sweep({"-o", std::string("s") + k, "--shard", std::string(k) + "/3"}).status, 0);
  }
  ASSERT_EQ(merge({"s1", "s2", "-o", "merged"}).status, 1);
  fs::remove_all(folder_ / "s1");
  fs::remove_all(folder_ / "s2");
  const std::string count = "FAILING_CALLS_COUNT=" + (folder_ / "calls").string();
  const std::string name = "FAILING_CALLS_OPEN=sweep.journal";
  fs::copy(folder_ / "merged", folder_ / "m");
  ASSERT_EQ(merge({"s3", "-o", "m"}, {.environment = failing({name, count})}).status, 0);
  const int opens = calls();
  EXPECT_GE(opens, 4);
  for (int k = 1; k <= opens; ++k) {
    for (const int error : {EIO, ESTALE, EMFILE}) {
      fs::remove_all(folder_ / "m");
      fs::copy(folder_ / "merged", folder_ / "m");
      const Ended failed = merge(
          {"s3", "-o", "m"},
          {.environment =
               failing({name, "FAILING_CALLS_HOW=error", "FAILING_CALLS_AT=" + std::to_string(k),
                        "FAILING_CALLS_ERROR=" + std::to_string(error)})});
      EXPECT_NE(failed.status, 0) << k << failed.err;
      EXPECT_EQ(merge({"s3", "-o", "m"}).status, 0) << k;
      EXPECT_EQ(results("m"), results("whole")) << k;
    }
  }
  // A sweep that resumes keeps its rows as well.
  for (int k = 1; k <= 3; ++k) {
    fs::remove_all(folder_ / "m");
    fs::copy(folder_ / "merged", folder_ / "m");
    sweep({"-o", "m"}, {.environment = failing({name, "FAILING_CALLS_HOW=error",
                                                "FAILING_CALLS_AT=" + std::to_string(k),
                                                "FAILING_CALLS_ERROR=" + std::to_string(EIO)})});
    EXPECT_EQ(sweep({"-o", "m"}).status, 0) << k;
    const Json performance = sweep_summary("m")["performance"];
    EXPECT_LE(performance["rows_of_this_process"], 4) << k;
    EXPECT_EQ(results("m"), results("whole")) << k;
  }
}

/// Killed, stopped or without room at any call that changes files, it is continued by the same
/// command.
TEST_F(SweepEdges, AMergeIsContinuedFromAnyCall) {
  ASSERT_EQ(sweep({"-o", "whole"}).status, 0);
  for (const char* k : {"1", "2"}) {
    ASSERT_EQ(sweep({"-o", std::string("s") + k, "--shard", std::string(k) + "/2"}).status, 0);
  }
  const std::string count = "FAILING_CALLS_COUNT=" + (folder_ / "calls").string();
  ASSERT_EQ(merge({"s1", "s2", "-o", "m"}, {.environment = failing({count})}).status, 0);
  const int all = calls();
  EXPECT_GT(all, 20);
  // Every call until the first row, and then every third, each way at another third of these: rows
  // and parts of a file that is not in place yet are all of a kind.
  constexpr int kUntilFirstRow = 9;
  const std::vector<std::string> ways = {"kill", "half", "stop"};
  int stopped = 0;
  for (std::size_t way = 0; way < ways.size(); ++way) {
    const std::string& how = ways[way];
    for (int k = 1; k <= all; ++k) {
      if (k > kUntilFirstRow && k % 9 != 3 * static_cast<int>(way)) continue;
      fs::remove_all(folder_ / "m");
      const Ended ended = merge(
          {"s1", "s2", "-o", "m"},
          {.environment =
               failing({"FAILING_CALLS_HOW=" + how, "FAILING_CALLS_AT=" + std::to_string(k)})});
      stopped += ended.status == 128 + SIGTERM ? 1 : 0;
      const Ended again = merge({"s1", "s2", "-o", "m"});
      ASSERT_EQ(again.status, 0) << how << k << again.err;
      ASSERT_EQ(results("m"), results("whole")) << how << k;
      EXPECT_FALSE(exists("m/run.journal"));
    }
  }
  EXPECT_GE(stopped, kUntilFirstRow - 1);  // each before a row that was to come
}

/// A file stands for a lock where the file system has none.
TEST_F(SweepEdges, WithoutLocksAFolderStillHasOneProgram) {
  for (const int error : {ENOSYS, ENOLCK}) {
    const std::vector<std::string> no_locks =
        failing({"FAILING_CALLS_FLOCK=" + std::to_string(error)});
    const std::vector<std::string> run = {
        "run", "tip.toml", "--set", "run.duration=2e4", "--set", "run.checkpoint_every=1e-3",
        "-o",  "out"};
    std::vector<std::string> resume = plus(run, {"--resume"});
    const Ended first = expect_status(
        128 + SIGKILL,
        tomlin(run, {.then =
                         [&](pid_t child) {
                           EXPECT_TRUE(appears(folder_ / "out/run.checkpoint"));
                           const Ended second =
                               expect_status(2, tomlin(resume, {.environment = no_locks}));
                           expect_error(second, "-o: out [folder.in_use]", {"run.lock"});
                           ::kill(child, SIGKILL);
                         },
                     .environment = no_locks}));
    EXPECT_TRUE(contains(first.err, "has no locks")) << first.err;
    EXPECT_TRUE(exists("out/run.lock"));
    // The file of a process which has ended keeps nobody away; the file of another machine does.
    const std::string left = file("out/run.lock");
    write(folder_ / "out/run.lock", "process 1 on another-machine");
    EXPECT_EQ(tomlin(resume, {.environment = no_locks}).status, 2);
    EXPECT_EQ(file("out/run.lock"), "process 1 on another-machine");
    write(folder_ / "out/run.lock", left);
    const Ended rest = expect_status(0, tomlin(resume, {.environment = no_locks}));
    EXPECT_EQ(lines(rest.err), 1) << rest.err;
    EXPECT_FALSE(exists("out/run.lock"));
    ASSERT_EQ(sweep({"-o", "s"}, {.environment = no_locks}).status, 0);
    EXPECT_FALSE(exists("s/run.lock"));
    for (const char* folder : {"out", "s"}) fs::remove_all(folder_ / folder);
  }
}

TEST_F(SweepEdges, AnotherBuildIsAnotherVersion) {
  ASSERT_EQ(sweep({"-o", "a"}).status, 0);
  std::string journal = file("a/sweep.journal");
  const std::size_t build = journal.find('+');
  ASSERT_LT(build, 60);
  EXPECT_FALSE(contains(file("a/sweep.h5"), journal.substr(build, 17)));
  EXPECT_TRUE(contains(file("a/sweep.h5"), "tomlin "));
}

/// A sweep all of whose points are refused has failed, also when it is started again.
TEST_F(SweepEdges, ASweepOfRefusedPointsFails) {
  const std::vector<std::string> refused = {"sweep",        "tip.toml",
                                            "--over",       "run.integrator.dt=-1,-2",
                                            "--observable", "driver.mean_force.x",
                                            "-o",           "a"};
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(tomlin(refused).status, 1) << k;
    EXPECT_EQ(sweep_summary("a")["counts"]["refused"], 2);
  }
  std::vector<std::string> one = refused;
  one[3] = "run.integrator.dt=-1,1e-2";
  one.back() = "b";
  EXPECT_EQ(tomlin(one).status, 0);
  EXPECT_EQ(tomlin(one).status, 0);
}

}  // namespace
}  // namespace tomlin::test
