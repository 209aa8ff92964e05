#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/cli/resume_fixture.hpp"

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
    return tomlin(arguments,
                  {.environment = {"LD_PRELOAD=" FAILING_CALLS, "FAILING_CALLS_HOW=" + way,
                                   "FAILING_CALLS_AT=" + std::to_string(at),
                                   "FAILING_CALLS_ERROR=" + std::to_string(error),
                                   "FAILING_CALLS_COUNT=" + (folder_ / "count").string(),
                                   // The library comes before that of the sanitizer.
                                   "ASAN_OPTIONS=verify_asan_link_order=0"}});
  }

  /// How many calls there are when none goes wrong.
  long calls(const std::vector<std::string>& arguments) {
    EXPECT_EQ(disturbed(arguments, "error", 0).status, 0);
    return std::atol(file("count").c_str());
  }

  /// Whatever has its final name is what it would have been.
  void expect_nothing_half(const std::string& folder) {
    const auto good = files_of(folder_ / "good");
    for (const auto& [name, text] : files_of(folder_ / folder)) {
      if (name == "run.journal" || name == "run.checkpoint" || name.ends_with(".part")) continue;
      if (name == "summary.json" && Json::parse(text)["status"] == "failed") continue;
      ASSERT_TRUE(good.contains(name)) << name;
      EXPECT_EQ(text, good.at(name)) << name;
    }
  }

  void expect_resumed(const std::string& folder) {
    const Ended ended = tomlin({"run", "short.toml", "-o", folder, "--resume"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(differing(folder_ / "good", folder_ / folder), "");
  }

  void clear(const std::string& folder) { fs::remove_all(folder_ / folder); }

  const std::vector<std::string> kRun = {"run", "short.toml", "-o", "bad"};
  const std::vector<std::string> kResume = {"run", "short.toml", "-o", "bad", "--resume"};
};

/// A run that is shorter than this many calls would test little.
constexpr long kEnough = 50;

TEST_F(FailingDisk, KilledBeforeEveryCall) {
  const long all = calls(kRun);
  ASSERT_GT(all, kEnough);
  for (long at = 1; at <= all && !HasFailure(); ++at) {
    SCOPED_TRACE(at);
    clear("bad");
    EXPECT_EQ(disturbed(kRun, "kill", at).status, 128 + SIGKILL);
    expect_nothing_half("bad");
    expect_resumed("bad");
  }
}

TEST_F(FailingDisk, KilledBeforeEveryCallOfAResumedRun) {
  disturbed(kRun, "kill", calls(kRun) / 2);
  fs::rename(folder_ / "bad", folder_ / "begun");
  fs::copy(folder_ / "begun", folder_ / "bad");
  const long all = calls(kResume);
  ASSERT_GT(all, kEnough / 2);
  for (long at = 1; at <= all && !HasFailure(); ++at) {
    SCOPED_TRACE(at);
    clear("bad");
    fs::copy(folder_ / "begun", folder_ / "bad");
    EXPECT_EQ(disturbed(kResume, "kill", at).status, 128 + SIGKILL);
    expect_nothing_half("bad");
    expect_resumed("bad");
  }
}

TEST_F(FailingDisk, FailingAtEveryCall) {
  const long all = calls(kRun);
  for (const std::string way : {"error", "from_then_on", "half"}) {
    for (long at = 1; at <= all && !HasFailure(); ++at) {
      SCOPED_TRACE(way + " " + std::to_string(at));
      clear("bad");
      const Ended ended = disturbed(kRun, way, at, at % 2 == 0 ? EIO : ENOSPC);
      expect_nothing_half("bad");
      if (ended.status == 0) {
        // A folder that cannot be synchronised, or litter that is taken away later.
        expect_resumed("bad");
        continue;
      }
      // Where not even the folder can be made it is the choice of it that is at fault.
      EXPECT_EQ(ended.status, exists("bad") ? 1 : 2);
      EXPECT_NE(ended.err, "");
      if (exists("bad/summary.json")) {
        const Json results = summary("bad");
        if (results["status"] == "failed") {
          EXPECT_TRUE(contains(results["failure"]["what"], "bad/"));
        }
      }
      expect_resumed("bad");
    }
  }
}

TEST_F(FailingDisk, FailingAtEveryCallOfAResumedRun) {
  disturbed(kRun, "kill", calls(kRun) / 2);
  fs::rename(folder_ / "bad", folder_ / "begun");
  fs::copy(folder_ / "begun", folder_ / "bad");
  const long all = calls(kResume);
  for (const std::string way : {"error", "from_then_on", "half"}) {
    for (long at = 1; at <= all && !HasFailure(); ++at) {
      SCOPED_TRACE(way + " " + std::to_string(at));
      clear("bad");
      fs::copy(folder_ / "begun", folder_ / "bad");
      disturbed(kResume, way, at);
      expect_nothing_half("bad");
      expect_resumed("bad");
    }
  }
}

/// Starting again over another run's results: those are there whole, or not at all.
TEST_F(FailingDisk, KilledBeforeEveryCallOfARunThatReplacesAnother) {
  ASSERT_EQ(tomlin({"run", "short.toml", "-o", "other", "--set", "run.duration=2"}).status, 0);
  fs::copy(folder_ / "other", folder_ / "bad");
  const std::vector<std::string> force = {"run", "short.toml", "-o", "bad", "--force"};
  const long all = calls(force);
  for (long at = 1; at <= all && !HasFailure(); ++at) {
    SCOPED_TRACE(at);
    clear("bad");
    fs::copy(folder_ / "other", folder_ / "bad");
    EXPECT_EQ(disturbed(force, "kill", at).status, 128 + SIGKILL);
    if (exists("bad/summary.json")) {
      const std::string with_other = differing(folder_ / "other", folder_ / "bad");
      EXPECT_TRUE(with_other == "" || with_other == "run.journal " ||
                  summary("bad") != summary("other"))
          << with_other;
    }
    const int resumed = tomlin({"run", "short.toml", "-o", "bad", "--resume"}).status;
    if (resumed != 0) {
      EXPECT_EQ(resumed, 2);
      EXPECT_EQ(tomlin(force).status, 0);
    }
    EXPECT_EQ(differing(folder_ / "good", folder_ / "bad"), "");
  }
}

}  // namespace
}  // namespace tomlin::test
