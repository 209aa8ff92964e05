#include <chrono>
#include <csignal>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/framework/resume/resume_fixture.hpp"

/// --resume continues some runs and refuses others, with a reason; more may befall a folder.
namespace tomlin::test {
namespace {

class Resume : public Cli {
 protected:
  void SetUp() override {
    write(folder_ / "scene.toml", kShortRun);
    write(folder_ / "long.toml", long_run());
  }

  /// A run that was stopped by this signal, in "out".
  void stop_a_run(int signal) {
    expect_status(128 + signal,
                  tomlin({"run", "long.toml", "-o", "out"},
                         {.then =
                              [&](pid_t child) {
                                EXPECT_TRUE(appears(folder_ / "out/run.checkpoint"));
                                std::this_thread::sleep_for(std::chrono::milliseconds(50));
                                ::kill(child, signal);
                              },
                          .environment = impatient()}));
  }

  Ended resume(const std::vector<std::string>& more = {}) {
    return tomlin(plus({"run", "long.toml", "-o", "out", "--resume"}, more));
  }

  /// Refused at this path with this code, with these names and numbers in the message, and nothing
  /// in the folder has changed.
  void expect_refused_for(const std::string& path_and_code,
                          const std::vector<std::string>& named = {},
                          const std::vector<std::string>& more = {}) {
    const auto before = files_of(folder_ / "out");
    const Ended ended = expect_status(2, resume(more));
    EXPECT_EQ(abridged(ended.err), "--resume: " + path_and_code + "\n") << ended.err;
    expect_parts(ended.err, named);
    EXPECT_EQ(files_of(folder_ / "out"), before);
  }

  void change_byte(const std::string& path, std::size_t at) {
    std::string bytes = file(path);
    bytes.at(at) = static_cast<char>(bytes.at(at) ^ 1);
    write(folder_ / path, bytes);
  }
};

TEST_F(Resume, BeginsWhereThereIsNothingYet) {
  EXPECT_EQ(tomlin({"run", "scene.toml", "-o", "new", "--resume"}).status, 0);
  fs::create_directory(folder_ / "empty");
  EXPECT_EQ(tomlin({"run", "scene.toml", "-o", "empty", "--resume"}).status, 0);
  EXPECT_EQ(differing(folder_ / "new", folder_ / "empty"), "");
}

TEST_F(Resume, ARunThatHasFinishedStaysAsItIs) {
  ASSERT_EQ(tomlin({"run", "scene.toml", "-o", "out"}).status, 0);
  const auto before = files_of(folder_ / "out");
  const Ended ended = expect_status(0, tomlin({"run", "scene.toml", "-o", "out", "--resume"}));
  EXPECT_TRUE(contains(ended.out, "finished already")) << ended.out;
  EXPECT_EQ(files_of(folder_ / "out"), before);
  expect_refused_for("out/scene.toml [resume.other_scene]",
                     {"duration = 1.5", "duration = 1000000.0"});
}

TEST_F(Resume, ARunThatFailedWouldFailAgain) {
  const std::vector<std::string> failing = {"--set", "run.integrator.dt=100", "--set",
                                            "run.duration=1e3"};
  std::vector<std::string> words = plus({"run", "scene.toml", "-o", "out", "--resume"}, failing);
  ASSERT_EQ(tomlin(words).status, 1);
  EXPECT_FALSE(exists("out/run.journal"));
  const Ended ended = expect_status(1, tomlin(words));
  EXPECT_EQ(abridged(ended.err), "scene.toml: [resume.impossible]\n") << ended.err;
  EXPECT_TRUE(contains(ended.err, "dt = 100")) << ended.err;
}

TEST_F(Resume, ARunThatWasStoppedSaysHowToGoOn) {
  stop_a_run(SIGTERM);
  EXPECT_EQ(summary("out")["status"], "interrupted");
  EXPECT_TRUE(exists("out/observables.csv"));
  const Ended ended = expect_status(2, tomlin({"run", "long.toml", "-o", "out"}));
  EXPECT_EQ(abridged(ended.err), "-o: out [file.exists]\n") << ended.err;
  EXPECT_TRUE(contains(ended.err, "--resume")) << ended.err;
  EXPECT_TRUE(exists("out/run.checkpoint"));
  // Not both at once.
  EXPECT_EQ(resume({"--force"}).status, 2);
  expect_status(0, tomlin({"run", "scene.toml", "-o", "out", "--force"}));
  EXPECT_FALSE(exists("out/run.checkpoint"));
}

TEST_F(Resume, AnotherSceneIsRefusedWithItsFirstDifference) {
  stop_a_run(SIGTERM);
  expect_refused_for("out/run.journal [resume.other_scene]", {"amplitude = 0.1", "amplitude = 0.2"},
                     {"--set", "force.sinusoidal_substrate.amplitude=0.2"});
}

/// A file that a scene reads is part of it.
TEST_F(Resume, ChangedPositionsAreAnotherScene) {
  write(folder_ / "long.toml", from_a_file(long_run(), "positions.dat"));
  write(folder_ / "positions.dat", "0.0\n");
  stop_a_run(SIGTERM);
  write(folder_ / "positions.dat", "0.25\n");
  expect_refused_for("out/run.journal [resume.other_scene]", {"0.25"});
}

TEST_F(Resume, AnEditedSceneFileIsNotLost) {
  stop_a_run(SIGKILL);
  write(folder_ / "out/scene.toml", "# mine\n" + file("out/scene.toml"));
  expect_refused_for("out/scene.toml [resume.other_scene]", {"# mine"});
}

TEST_F(Resume, MissingFilesAreRefused) {
  stop_a_run(SIGTERM);
  const std::string journal = file("out/run.journal");
  fs::remove(folder_ / "out/run.journal");
  expect_refused_for("out/run.journal [resume.impossible]");
  fs::rename(folder_ / "out/run.checkpoint", folder_ / "kept");
  expect_refused_for("out [resume.impossible]");
  write(folder_ / "out/run.journal", journal);
  expect_refused_for("out/run.checkpoint [resume.impossible]");
  fs::remove(folder_ / "out/summary.json");
  expect_refused_for("out/run.checkpoint [resume.impossible]");
  fs::rename(folder_ / "kept", folder_ / "out/run.checkpoint");
}

TEST_F(Resume, DamagedFilesAreRefused) {
  stop_a_run(SIGKILL);
  for (const std::string name : {"out/run.checkpoint", "out/run.journal"}) {
    const std::string good = file(name);
    for (const std::size_t at : {std::size_t{0}, std::size_t{20}, good.size() / 2}) {
      change_byte(name, at);
      expect_refused_for(name + " [file.damaged]");
      write(folder_ / name, good);
    }
    for (const std::size_t length : {good.size() / 2, std::size_t{0}}) {
      write(folder_ / name, good.substr(0, length));
      expect_refused_for(name + " [file.damaged]");
    }
    write(folder_ / name, good);
  }
}

/// Results that were not yet in the checkpoint are computed again.
TEST_F(Resume, WhateverFollowsTheCheckpointIsDropped) {
  const std::vector<std::string> run = {"run", "scene.toml", "-o", "out", "--resume"};
  ASSERT_EQ(tomlin({"run", "scene.toml", "-o", "whole"}).status, 0);
  std::vector<std::string> environment =
      plus(impatient(), {"FAILING_CALLS_HOW=kill", "FAILING_CALLS_AT=30"});
  for (const std::string garbage :
       {"x", "TOMR", "a whole lot of it, longer than a record's head"}) {
    fs::remove_all(folder_ / "out");
    ASSERT_EQ(tomlin(run, {.environment = environment}).status, 128 + SIGKILL);
    ASSERT_TRUE(exists("out/run.checkpoint"));
    write(folder_ / "out/run.journal", file("out/run.journal") + garbage);
    EXPECT_EQ(tomlin(run).status, 0);
    EXPECT_EQ(differing(folder_ / "whole", folder_ / "out"), "");
  }
}

TEST_F(Resume, TwoRunsNeverShareAFolder) {
  expect_status(128 + SIGTERM,
                tomlin({"run", "long.toml", "-o", "out"},
                       {.then =
                            [&](pid_t child) {
                              EXPECT_TRUE(appears(folder_ / "out/run.checkpoint"));
                              for (const std::string how : {"--resume", "--force"}) {
                                const Ended second = expect_status(
                                    2, tomlin({"run", "long.toml", "-o", "out", how}));
                                EXPECT_EQ(abridged(second.err), "-o: out [folder.in_use]\n")
                                    << second.err;
                              }
                              ::kill(child, SIGTERM);
                            },
                        .environment = impatient()}));
  EXPECT_EQ(summary("out")["status"], "interrupted");
}

/// Removed, or removed and made anew, while the run is going on.
TEST_F(Resume, AFolderThatGoesAwayEndsTheRun) {
  for (const bool made_anew : {false, true}) {
    fs::remove_all(folder_ / "out");
    const Ended ended =
        expect_status(1, tomlin({"run", "long.toml", "-o", "out"},
                                {.then =
                                     [&](pid_t) {
                                       EXPECT_TRUE(appears(folder_ / "out/run.checkpoint"));
                                       fs::rename(folder_ / "out", folder_ / "away");
                                       fs::remove_all(folder_ / "away");
                                       if (made_anew) fs::create_directory(folder_ / "out");
                                     },
                                 .environment = impatient()}));
    EXPECT_TRUE(contains(ended.err, " [file.cannot_write]\n")) << ended.err;
    EXPECT_FALSE(exists("out/observables.csv"));
    EXPECT_FALSE(exists("out/run.checkpoint"));
  }
}

TEST_F(Resume, AFullDiskKeepsTheLastCheckpoint) {
  ASSERT_EQ(tomlin({"run", "scene.toml", "-o", "whole", "--set", "run.duration=60"}).status, 0);
  const std::vector<std::string> run = {"run",   "scene.toml",      "-o",      "out",
                                        "--set", "run.duration=60", "--resume"};
  const Ended full = expect_status(1, tomlin(run, {.largest_file = 9000}));
  EXPECT_EQ(abridged(full.err), "tomlin: [file.cannot_write]\n");
  expect_parts(full.err, {"File too large", "out/run.journal"});
  EXPECT_EQ(summary("out")["status"], "failed");
  EXPECT_LT(summary("out")["time"]["end"], 60.0);
  EXPECT_TRUE(exists("out/run.checkpoint"));
  EXPECT_TRUE(contains(summary("out")["failure"]["what"], "cannot write out/"));
  EXPECT_FALSE(exists("out/observables.csv"));
  expect_status(0, tomlin(run));
  EXPECT_EQ(differing(folder_ / "whole", folder_ / "out"), "");
}

/// A small file system in memory, while this lives; none where mounting is not allowed.
class SmallDisk {
 public:
  SmallDisk(const fs::path& at, const std::string& size) : at_(at) {
    fs::create_directory(at_);
    mounted_ = ::mount("tmpfs", at_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount(at_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }
  bool grow() const { return ::mount("tmpfs", at_.c_str(), "tmpfs", MS_REMOUNT, "size=64m") == 0; }

 private:
  fs::path at_;
  bool mounted_ = false;
};

TEST_F(Resume, AFullFileSystemKeepsTheLastCheckpointToo) {
  // Room for the run when it begins, which another program fills.
  const SmallDisk disk(folder_ / "disk", "8m");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a file system is not allowed here";
  const std::vector<std::string> settings = {"--set", "run.duration=600", "--set",
                                             "output.every=0.05"};
  const auto run = [&](const std::string& out, const std::vector<std::string>& more,
                       const Conditions& conditions = {}) {
    return tomlin(plus(plus({"run", "scene.toml", "-o", out}, settings), more), conditions);
  };
  ASSERT_EQ(run("whole", {}).status, 0);
  const Ended full =
      expect_status(1, run("disk/out", {}, {.then = [&](pid_t child) {
                             EXPECT_TRUE(appears(folder_ / "disk/out/run.checkpoint"));
                             // The run waits meanwhile, however slowly the disk is filled.
                             ::kill(child, SIGSTOP);
                             std::ofstream(folder_ / "disk/other") << std::string(8 << 20, 'x');
                             ::kill(child, SIGCONT);
                           }}));
  EXPECT_TRUE(contains(full.err, "No space left on device")) << full.err;
  EXPECT_FALSE(exists("disk/out/observables.csv"));
  ASSERT_TRUE(disk.grow());
  expect_status(0, run("disk/out", {"--resume"}));
  EXPECT_EQ(differing(folder_ / "whole", folder_ / "disk/out"), "");
}

/// Known before it begins, and with what would fit; the rest of a run is all that one that goes on
/// needs room for.
TEST_F(Resume, ARunThatDoesNotFitIsRefusedBeforeItBegins) {
  const SmallDisk disk(folder_ / "disk", "1m");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a file system is not allowed here";
  const auto run = [&](const std::string& every, const std::vector<std::string>& more = {},
                       const Conditions& conditions = {}) {
    return tomlin(plus({"run", "scene.toml", "-o", "disk/out", "--set", "run.duration=600", "--set",
                        "output.every=" + every},
                       more),
                  conditions);
  };
  const Ended refused = expect_status(2, run("0.05"));
  EXPECT_EQ(abridged(refused.err),
            "--set output.every=0.05: output.every = 0.05 [output.too_large]\n")
      << refused.err;
  expect_parts(refused.err, {"12001", " 1.05 MB"});
  EXPECT_FALSE(exists("disk/out"));

  const std::string admissible = "expected: >= ";
  const auto at = refused.err.find(admissible);
  ASSERT_NE(at, std::string::npos) << refused.err;
  const std::string rest = refused.err.substr(at + admissible.size());
  const std::string every = rest.substr(0, rest.find(','));
  expect_status(128 + SIGINT,
                run(every, {}, {.then = signal_at(folder_ / "disk/out/run.checkpoint", SIGINT)}));
  // The space of the files that the run has written is no longer free, but belongs to it.
  expect_status(0, run(every, {"--resume"}));
  EXPECT_TRUE(exists("disk/out/observables.csv"));
}

/// No file of the run takes the number of a stream that is closed.
TEST_F(Resume, ClosedStandardStreamsHarmNothing) {
  ASSERT_EQ(tomlin({"run", "scene.toml", "-o", "whole"}).status, 0);
  const Ended no_output =
      expect_status(1, tomlin({"run", "scene.toml", "-o", "out"}, {.closed = {1}}));
  EXPECT_EQ(abridged(no_output.err), "tomlin: [file.cannot_write]\n") << no_output.err;
  EXPECT_EQ(differing(folder_ / "whole", folder_ / "out"), "");
  fs::remove_all(folder_ / "out");
  EXPECT_EQ(tomlin({"run", "scene.toml", "-o", "out", "--quiet"}, {.closed = {0, 1, 2}}).status, 0);
  EXPECT_EQ(differing(folder_ / "whole", folder_ / "out"), "");
}

}  // namespace
}  // namespace tomlin::test
