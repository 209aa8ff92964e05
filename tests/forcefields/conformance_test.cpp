#include "tests/support/conformance.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

// Every force of the registry against its claims. What depends on a single force's formula has a
// test of its own elsewhere.

namespace tomlin::test {
namespace {

constexpr std::uint64_t kSeeds[] = {20240611, 7, 424242};

/// What has no force law of its own: expression_test tests formulas of every kind.
bool needs_a_formula(const ForceRecord& record) { return record.name == "expression"; }

TEST(Conformance, EveryForceKeepsItsClaims) {
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    if (needs_a_formula(*record)) continue;
    ClaimCheck check(*record);
    for (const std::uint64_t seed : kSeeds) check.examine_everywhere(seed);
    // Points, chains and rings in three dimensions, free and rigid: none may slip by unseen.
    EXPECT_GT(check.examined(), 100);
    EXPECT_EQ(check.broken(), std::vector<std::string>{});
  }
}

/// Every remainder of a group of eight, twice over.
TEST(Conformance, TailsOfEveryLengthHaveTheSameBits) {
  constexpr std::size_t kMost = 19;
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    if (needs_a_formula(*record)) continue;
    ClaimCheck check(*record);
    check.examine_everywhere(99, kMost);
    EXPECT_EQ(check.broken(), std::vector<std::string>{});
  }
}

}  // namespace
}  // namespace tomlin::test
