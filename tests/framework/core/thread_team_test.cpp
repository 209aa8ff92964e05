#include "framework/core/system/thread_team.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TOMLIN_TEST_RESERVES_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TOMLIN_TEST_RESERVES_MEMORY 1
#endif
#endif

/// A team of threads does each part of a piece of work once, and all before it returns.
namespace tomlin::test {
namespace {

struct CountedParts {
  std::vector<std::atomic<int>>* counts = nullptr;
  std::atomic<std::size_t>* highest_member = nullptr;
};

void count_part(const void* work, std::size_t part, std::size_t member) {
  const auto& counted = *static_cast<const CountedParts*>(work);
  (*counted.counts)[part].fetch_add(1, std::memory_order_relaxed);
  std::size_t highest = counted.highest_member->load();
  while (member > highest && !counted.highest_member->compare_exchange_weak(highest, member)) {
  }
}

/// So many parts, and what has been done when the team is back.
void expect_each_once(const Team& team, std::size_t parts) {
  std::vector<std::atomic<int>> counts(parts);
  std::atomic<std::size_t> highest_member{0};
  const CountedParts counted{&counts, &highest_member};
  team.share(team.threads, parts, &count_part, &counted);
  for (std::size_t k = 0; k < parts; ++k) {
    ASSERT_EQ(counts[k].load(std::memory_order_relaxed), 1) << "part " << k << " of " << parts;
  }
  EXPECT_LT(highest_member.load(), team.members);
}

TEST(ThreadTeam, EachPartIsDoneOnce) {
  for (const std::size_t members : {1, 2, 3, 8}) {
    const ThreadTeam team(members);
    ASSERT_EQ(team.members(), members);
    for (int piece = 0; piece < 2000; ++piece) {
      expect_each_once(team.team(), static_cast<std::size_t>(piece % 37));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ThreadTeam, WakesUpAfterAPause) {
  const ThreadTeam team(3);
  for (int piece = 0; piece < 20; ++piece) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    expect_each_once(team.team(), 11);
  }
}

TEST(ThreadTeam, WaitsForALongPart) {
  const ThreadTeam team(4);
  std::atomic<int> done{0};
  for (int piece = 1; piece <= 5; ++piece) {
    team.team().share(
        team.team().threads, 4,
        [](const void* work, std::size_t part, std::size_t) {
          std::this_thread::sleep_for(std::chrono::milliseconds(part == 2 ? 10 : 0));
          static_cast<std::atomic<int>*>(const_cast<void*>(work))->fetch_add(1);
        },
        &done);
    EXPECT_EQ(done.load(), 4 * piece);
  }
}

TEST(ThreadTeam, EndsWithoutWork) {
  for (int k = 0; k < 20; ++k) const ThreadTeam team(5);
  EXPECT_EQ(ThreadTeam(0).members(), 1u);
  EXPECT_EQ(team_of(1), nullptr);
}

// Sanitizers reserve more address space than the test leaves.
#ifndef TOMLIN_TEST_RESERVES_MEMORY
TEST(ThreadTeam, DoesWithTheThreadsThatCanBeStarted) {
  // Address space for a few stacks of threads more than there is.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit narrow = before;
  narrow.rlim_cur = rlim_t{1} << 28;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &narrow), 0);
  const ThreadTeam team(1000);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_LT(team.members(), 1000u);
  expect_each_once(team.team(), 500);
}
#endif

/// The ranges of particles that a loop is divided into, as a member sees them.
TEST(ThreadTeam, RangesAreWholeGroupsAndCoverAll) {
  const ThreadTeam team(3);
  for (const std::size_t count : {0, 1, 8, 255, 256, 257, 1001, 100'000}) {
    for (const Team* shared : {static_cast<const Team*>(nullptr), &team.team()}) {
      const std::size_t length = (count + kGroup - 1) / kGroup * kGroup;
      std::vector<std::atomic<int>> counts(length + 1);
      auto* const seen = &counts;
      in_parts(shared, count, [seen](std::size_t begin, std::size_t end, std::size_t) {
        EXPECT_EQ(begin % kGroup, 0u);
        EXPECT_EQ(end % kGroup, 0u);
        for (std::size_t i = begin; i < end; ++i) (*seen)[i].fetch_add(1);
      });
      for (std::size_t i = 0; i < length; ++i) ASSERT_EQ(counts[i].load(), 1) << i << "/" << count;
      EXPECT_EQ(counts[length].load(), 0);
    }
  }
}

}  // namespace
}  // namespace tomlin::test
