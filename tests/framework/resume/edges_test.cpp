#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/resume/resume_fixture.hpp"

/// Tests of runs before they begin, after they have ended and beside them: whose folder it is, what
/// the scene reads, the choice of an integrator, estimates of errors, perturbed starts.
namespace tomlin::test {
namespace {

/// A tip to an accuracy: the pilot takes a tenth of a second, the run and its companion some more.
const std::string kToAnAccuracy = R"(
[[body]]
name = "tip"
type = "point"
position = [0.13]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 0.7
velocity = [0.11]
[[force]]
type = "viscous_damping"
coefficient = 0.37
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.21
period = 1.0
[run]
duration = 1.5e4
accuracy = 1e-5
checkpoint_every = 0.01
)";

std::string perturbed() {
  return replaced(kToAnAccuracy, "accuracy = 1e-5",
                  "integrator = { type = \"rk4\", dt = 1e-2 }\n"
                  "perturb = { size = 1e-9, repeats = 3 }");
}

class Edges : public Cli {
 protected:
  void SetUp() override {
    write(folder_ / "scene.toml", kShortRun);
    write(folder_ / "long.toml", long_run());
    write(folder_ / "accurate.toml", kToAnAccuracy);
    write(folder_ / "perturbed.toml", perturbed());
  }

  Ended run(const std::string& scene, const std::string& out,
            const std::vector<std::string>& more = {}, const Conditions& conditions = {}) {
    return tomlin(plus({"run", scene, "-o", out}, more), conditions);
  }

  /// Stopped as soon as the file holds the words.
  Ended stopped_at(const std::string& scene, const std::string& out, const std::string& file_name,
                   const std::string& words, int signal = SIGTERM) {
    const auto stop = [&](pid_t child) {
      const fs::path file = folder_ / (out + "/" + file_name);
      for (int k = 0; k < 20000; ++k) {
        if (fs::exists(file) && contains(content(file), words)) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      ::kill(child, signal);
    };
    return run(scene, out, {"--quiet"}, {.then = stop, .environment = impatient()});
  }
};

// ---- whose folder it is

/// Long before there is anything to write.
TEST_F(Edges, ARunOwnsItsFolderWhileItsPilotIsOn) {
  write(folder_ / "slow.toml", kToAnAccuracy + "number_type = \"quadruple\"\n");
  expect_status(128 + SIGTERM,
                run("slow.toml", "out", {}, {.then = [&](pid_t child) {
                      EXPECT_TRUE(appears(folder_ / "out/run.journal"));
                      EXPECT_FALSE(exists("out/scene.toml"));
                      for (const std::vector<std::string>& how :
                           std::vector<std::vector<std::string>>{{}, {"--force"}, {"--resume"}}) {
                        const Ended second = expect_status(2, run("scene.toml", "out", how));
                        EXPECT_EQ(abridged(second.err), "-o: out [folder.in_use]\n") << second.err;
                      }
                      const Ended study = expect_status(
                          2,
                          tomlin({"tradeoff", "scene.toml", "--observable", "driver.mean_force.x",
                                  "--budget", "1", "-o", "out", "--force"}));
                      EXPECT_EQ(abridged(study.err), "-o: out [folder.in_use]\n") << study.err;
                      ::kill(child, SIGTERM);
                    }}));
  EXPECT_FALSE(exists("out"));  // nothing came of it
}

TEST_F(Edges, AFolderThatWasMovedAwayLeavesItsNameToOthers) {
  std::map<std::string, std::string> others;
  const Ended ended =
      expect_status(1, run("long.toml", "out", {},
                           {.then =
                                [&](pid_t) {
                                  EXPECT_TRUE(appears(folder_ / "out/run.checkpoint"));
                                  fs::rename(folder_ / "out", folder_ / "away");
                                  EXPECT_EQ(run("scene.toml", "out").status, 0);
                                  others = files_of(folder_ / "out");
                                },
                            .environment = impatient()}));
  EXPECT_TRUE(contains(ended.err, " [file.cannot_write]\n")) << ended.err;
  EXPECT_EQ(files_of(folder_ / "out"), others);
  // The folder that was moved keeps its checkpoint.
  EXPECT_TRUE(exists("away/run.checkpoint"));
}

// ---- what is there already

/// Whatever it is called.
TEST_F(Edges, ForceNeverTakesAwayWhatTheSceneReads) {
  const std::string scene = from_a_file(kShortRun, "FILE");
  for (const std::string name : {"trajectory.xyz", "observables.csv", "summary.json.part"}) {
    fs::remove_all(folder_ / "here");
    fs::create_directory(folder_ / "here");
    write(folder_ / ("here/" + name), "0.0\n");
    write(folder_ / "here/s.toml", replaced(scene, "FILE", name));
    const Ended ended = expect_status(2, run("here/s.toml", "here", {"--force"}));
    EXPECT_EQ(abridged(ended.err), "-o: here [file.exists]\n") << ended.err;
    EXPECT_TRUE(contains(ended.err, " tip: here/" + name)) << ended.err;
    EXPECT_EQ(file("here/" + name), "0.0\n");
    EXPECT_FALSE(exists("here/scene.toml"));
    EXPECT_EQ(run("here/s.toml", "elsewhere", {"--force"}).status, 0);
  }
  write(folder_ / "here/tradeoff.csv", "0.0\n");
  write(folder_ / "here/s.toml", replaced(scene, "FILE", "tradeoff.csv"));
  expect_status(2, tomlin({"tradeoff", "here/s.toml", "--observable", "driver.mean_force.x",
                           "--budget", "1", "-o", "here", "--force"}));
  EXPECT_EQ(file("here/tradeoff.csv"), "0.0\n");
}

/// At once: nothing of the new run could be written.
TEST_F(Edges, AReplacementThatTheDiskHadNoRoomForGoesOn) {
  ASSERT_EQ(run("scene.toml", "out", {"--set", "run.duration=0.9"}).status, 0);
  const Ended full = expect_status(1, run("scene.toml", "out", {"--force"}, {.largest_file = 500}));
  EXPECT_TRUE(contains(full.err, "File too large")) << full.err;
  expect_status(0, run("scene.toml", "whole", {"--quiet"}));
  expect_status(0, run("scene.toml", "out", {"--resume", "--quiet"}));
  EXPECT_EQ(differing(folder_ / "whole", folder_ / "out"), "");
}

/// Files of commands that were killed.
TEST_F(Edges, WhatIsUnfinishedBlocksNothing) {
  write(folder_ / "schema.json.part", "");
  EXPECT_EQ(tomlin({"schema", "-o", "schema.json"}).status, 0);
  fs::create_directory(folder_ / "study");
  write(folder_ / "study/tradeoff.csv.part", "");
  expect_status(0, tomlin({"tradeoff", "scene.toml", "--observable", "driver.mean_force.x",
                           "--budget", "1", "-o", "study", "--force"}));
  EXPECT_TRUE(exists("study/tradeoff.csv"));
  EXPECT_FALSE(exists("study/tradeoff.csv.part"));
  EXPECT_FALSE(exists("study/run.journal"));
}

/// Before the work, not after it.
TEST_F(Edges, WhereResultsCannotBeWrittenIsFoundAtOnce) {
  fs::create_directories(folder_ / "study/tradeoff.json");
  const Ended study =
      expect_status(2, tomlin({"tradeoff", "scene.toml", "--observable", "driver.mean_force.x",
                               "--budget", "1e9", "-o", "study", "--force"}));
  EXPECT_EQ(abridged(study.err), "-o: study/tradeoff.json [file.cannot_write]\n") << study.err;
  const Ended write =
      expect_status(2, tomlin({"tradeoff", "scene.toml", "--observable", "driver.mean_force.x",
                               "--budget", "1e9", "-o", "other", "--write", "none/scene.toml"}));
  EXPECT_EQ(abridged(write.err), "--write: none/scene.toml [file.cannot_write]\n") << write.err;
  EXPECT_FALSE(exists("other"));
}

// ---- before and after the run proper

/// A signal or a kill in what follows a run, which takes up what its store has. The store is a
/// cache: what is damaged in it is computed again.
TEST_F(Edges, WhatFollowsARunIsContinued) {
  struct Stopped {
    std::string scene;
    std::string words;  // in the store when the run is stopped
    int signal;
    bool damages = false;
  };
  for (const Stopped& one :
       {Stopped{"accurate", "companion", SIGTERM}, Stopped{"accurate", "companion", SIGKILL},
        Stopped{"perturbed", "perturbed start 2", SIGTERM},
        Stopped{"perturbed", "perturbed start 2", SIGTERM, true}}) {
    SCOPED_TRACE(one.scene + std::string(one.damages ? ", damaged" : ""));
    SCOPED_TRACE(one.signal);
    const std::string scene = one.scene + ".toml";
    const bool estimates = one.scene == "accurate";
    if (!exists(one.scene)) expect_status(0, run(scene, one.scene, {"--quiet"}));
    fs::remove_all(folder_ / "out");
    expect_status(128 + one.signal, stopped_at(scene, "out", "run.store", one.words, one.signal));
    if (one.signal == SIGKILL) {
      EXPECT_FALSE(exists("out/summary.json"));
    } else {
      EXPECT_EQ(summary("out")["status"], "interrupted");
    }
    if (one.signal == SIGTERM && estimates) {
      EXPECT_FALSE(summary("out").contains("error"));
      EXPECT_TRUE(exists("out/run.checkpoint"));
    }
    if (one.damages) {
      std::string store = file("out/run.store");
      store[store.size() / 2] = static_cast<char>(store[store.size() / 2] ^ 1);
      write(folder_ / "out/run.store", store);
    }
    expect_status(0, run(scene, "out", {"--resume", "--quiet"}));
    EXPECT_EQ(differing(folder_ / one.scene, folder_ / "out"), "");
    if (!estimates) continue;
    EXPECT_TRUE(summary("out").contains("error"));
    EXPECT_FALSE(exists("out/run.store"));
  }
}

// ---- signals

TEST_F(Edges, WhateverAsksForAnEndStopsTheRun) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU}) {
    const std::string out = "signal-" + std::to_string(signal);
    expect_status(128 + signal, run("long.toml", out, {},
                                    {.then = signal_at(folder_ / (out + "/run.checkpoint"), signal),
                                     .environment = impatient()}));
    EXPECT_EQ(summary(out)["status"], "interrupted");
    EXPECT_LT(summary(out)["time"]["end"], 1e6);
    for (const char* name : {"/run.checkpoint", "/observables.csv", "/scene.toml"}) {
      EXPECT_TRUE(exists(out + name)) << name;
    }
  }
}

/// A signal is ignored under nohup, and in the background of a script.
TEST_F(Edges, ASignalThatIsIgnoredStaysIgnored) {
  for (const int signal : {SIGINT, SIGHUP}) {
    expect_status(
        0, run("scene.toml", "out" + std::to_string(signal), {"--set", "run.duration=3e3"},
               {.then =
                    [&](pid_t child) {
                      EXPECT_TRUE(
                          appears(folder_ / ("out" + std::to_string(signal)) / "run.checkpoint"));
                      ::kill(child, signal);
                    },
                .environment = impatient(),
                .ignored = {signal}}));
  }
}

}  // namespace
}  // namespace tomlin::test
