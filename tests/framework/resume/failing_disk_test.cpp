#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/resume/resume_fixture.hpp"

/// Every call by which a run changes its folder goes wrong once: it fails, is done by half, or is
/// the last that the run gets to. Nothing may look complete that is not, and the run goes on to the
/// same bits when the disk is well again.
namespace tomlin::test {
namespace {

class FailingDisk : public Cli {
 protected:
  void SetUp() override {
    write(folder_ / "short.toml", kShortRun);
    ASSERT_EQ(tomlin({"run", "short.toml", "-o", "good"}).status, 0);
  }

  /// A run with the call of this number going wrong.
  Ended disturbed(const std::vector<std::string>& arguments, const std::string& way, long at,
                  int error = ENOSPC) {
    std::vector<std::string> environment =
        plus(impatient(), {"FAILING_CALLS_HOW=" + way, "FAILING_CALLS_AT=" + std::to_string(at),
                           "FAILING_CALLS_ERROR=" + std::to_string(error),
                           "FAILING_CALLS_COUNT=" + (folder_ / "count").string()});
    return tomlin(arguments, {.environment = environment});
  }

  /// Runs the program with no call that fails.
  Ended undisturbed(const std::vector<std::string>& arguments) {
    return disturbed(arguments, "error", 0);
  }

  /// How many calls there are when none goes wrong, in a folder that looks like `before`.
  long calls(const std::vector<std::string>& arguments, const std::string& before = "") {
    restore(before);
    EXPECT_EQ(undisturbed(arguments).status, 0);
    restore(before);
    return std::atol(file("count").c_str());
  }

  /// The folder of the runs becomes a copy of another; without one it goes.
  void restore(const std::string& before) {
    fs::remove_all(folder_ / "bad");
    if (!before.empty()) fs::copy(folder_ / before, folder_ / "bad");
  }

  /// "begun": a folder of a run that was killed half way.
  void begin_a_run() {
    const long all = calls(kRun);
    EXPECT_EQ(disturbed(kRun, "kill", all / 2).status, 128 + SIGKILL);
    EXPECT_TRUE(exists("bad/run.checkpoint"));
    fs::rename(folder_ / "bad", folder_ / "begun");
  }

  /// Whatever has its final name is what it would have been.
  void expect_nothing_half() {
    const auto good = files_of(folder_ / "good");
    for (const auto& [name, text] : files_of(folder_ / "bad")) {
      if (name == "run.journal" || name == "run.checkpoint" || name.ends_with(".part")) continue;
      if (name == "summary.json" && Json::parse(text)["status"] == "failed") continue;
      ASSERT_TRUE(good.contains(name)) << name;
      EXPECT_EQ(text, good.at(name)) << name;
    }
  }

  void expect_resumed() {
    expect_status(0, undisturbed(kResume));
    EXPECT_EQ(differing(folder_ / "good", folder_ / "bad"), "");
  }

  const std::vector<std::string> kRun = {"run", "short.toml", "-o", "bad"};
  const std::vector<std::string> kResume = {"run", "short.toml", "-o", "bad", "--resume"};
};

/// A run that is shorter than this many calls would test little.
constexpr long kEnough = 50;
/// Tests that repeat what another does from another start take only every third call, unless
/// TOMLIN_EVERY_CALL is set.
long stride() { return std::getenv("TOMLIN_EVERY_CALL") != nullptr ? 1 : 3; }

TEST_F(FailingDisk, KilledBeforeEveryCall) {
  const long all = calls(kRun);
  ASSERT_GT(all, kEnough);
  for (long at = 1; at <= all && !HasFailure(); ++at) {
    SCOPED_TRACE(at);
    restore("");
    EXPECT_EQ(disturbed(kRun, "kill", at).status, 128 + SIGKILL);
    expect_nothing_half();
    expect_resumed();
  }
}

TEST_F(FailingDisk, KilledBeforeEveryCallOfAResumedRun) {
  begin_a_run();
  const long all = calls(kResume, "begun");
  ASSERT_GT(all, kEnough / 2);
  for (long at = 1; at <= all && !HasFailure(); at += stride()) {
    SCOPED_TRACE(at);
    restore("begun");
    EXPECT_EQ(disturbed(kResume, "kill", at).status, 128 + SIGKILL);
    expect_nothing_half();
    expect_resumed();
  }
}

TEST_F(FailingDisk, FailingAtEveryCall) {
  const long all = calls(kRun);
  ASSERT_GT(all, kEnough / 2);
  for (const std::string way : {"error", "half"}) {
    for (long at = 1; at <= all && !HasFailure(); ++at) {
      SCOPED_TRACE(way + " " + std::to_string(at));
      restore("");
      const Ended ended = disturbed(kRun, way, at, at % 2 == 0 ? EIO : ENOSPC);
      expect_nothing_half();
      if (ended.status == 0) {
        // A folder that cannot be synchronised, or litter that is taken away later.
        expect_resumed();
        continue;
      }
      // If not even the folder can be made, the choice of the folder is at fault.
      EXPECT_TRUE(ended.status == 1 || (ended.status == 2 && !exists("bad"))) << ended.status;
      EXPECT_NE(ended.err, "");
      if (exists("bad/summary.json")) {
        const Json results = summary("bad");
        if (results["status"] == "failed") {
          EXPECT_TRUE(contains(results["failure"]["what"], "bad/"));
        }
      }
      expect_resumed();
    }
  }
}

TEST_F(FailingDisk, FailingAtEveryCallOfAResumedRun) {
  begin_a_run();
  const long all = calls(kResume, "begun");
  ASSERT_GT(all, kEnough / 2);
  for (const std::string way : {"error", "half"}) {
    for (long at = 1; at <= all && !HasFailure(); at += stride()) {
      SCOPED_TRACE(way + " " + std::to_string(at));
      restore("begun");
      disturbed(kResume, way, at);
      expect_nothing_half();
      expect_resumed();
    }
  }
}

/// Starting again over another run's results: those are there whole, or not at all.
TEST_F(FailingDisk, KilledBeforeEveryCallOfARunThatReplacesAnother) {
  ASSERT_EQ(tomlin({"run", "short.toml", "-o", "other", "--set", "run.duration=2"}).status, 0);
  const std::vector<std::string> force = {"run", "short.toml", "-o", "bad", "--force"};
  const long all = calls(force, "other");
  ASSERT_GT(all, kEnough / 2);
  for (long at = 1; at <= all && !HasFailure(); at += stride()) {
    SCOPED_TRACE(at);
    restore("other");
    EXPECT_EQ(disturbed(force, "kill", at).status, 128 + SIGKILL);
    if (exists("bad/summary.json")) {
      const std::string with_other = differing(folder_ / "other", folder_ / "bad");
      EXPECT_TRUE(with_other == "" || with_other == "run.journal " ||
                  summary("bad") != summary("other"))
          << with_other;
    }
    // Refused only where nothing of the other is gone; otherwise the replacement goes on.
    const bool begun = !exists("bad/summary.json");
    const int resumed = undisturbed(kResume).status;
    if (resumed != 0) {
      EXPECT_EQ(resumed, 2);
      EXPECT_FALSE(begun);
      EXPECT_EQ(undisturbed(force).status, 0);
    }
    EXPECT_EQ(differing(folder_ / "good", folder_ / "bad"), "");
  }
}

}  // namespace
}  // namespace tomlin::test
