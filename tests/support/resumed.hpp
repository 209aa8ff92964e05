#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

namespace tomlin::test {

/// A run that is left at every third step and gone on with from the bytes of its state ends with
/// the bits of one that was not, and has the same samples and as many events. `check` gets the
/// result of the whole run and that of each.
template <class Check>
void expect_same_from_any_step(const std::shared_ptr<const Scene>& scene, Check check) {
  constexpr std::uint64_t kEvery = 3;
  constexpr std::uint64_t kFewest = 15;  // with fewer steps it would show little
  KeptSamples all;
  RunOptions options;
  options.sink = &all;
  Engine whole(scene, options);
  const RunResult expected = whole.run();
  ASSERT_GT(expected.steps, kFewest);
  ASSERT_GT(all.rows.size(), kFewest);
  for (std::uint64_t steps = 1; steps < expected.steps; steps += kEvery) {
    SCOPED_TRACE(steps);
    KeptSamples kept;
    RunOptions first = options;
    first.sink = &kept;
    Engine engine(scene, first);
    engine.advance(steps);
    const std::vector<std::byte> bytes = engine.state().to_bytes();
    RunOptions second = first;
    second.resume_from = &bytes;
    Engine resumed(scene, second);
    const RunResult result = resumed.run();
    ASSERT_TRUE(Motion(resumed) == Motion(whole));
    ASSERT_EQ(result.steps, expected.steps);
    ASSERT_EQ(kept.rows, all.rows);
    ASSERT_EQ(kept.events.size(), all.events.size());
    check(expected, result);
  }
}

/// A run that is left at step `first` and at every so many steps after it, and gone on with from
/// the bytes of its state, has the same numbers of its driver.
inline void expect_same_driver_from(const std::shared_ptr<const Scene>& scene,
                                    const RunResult& expected, std::uint64_t first,
                                    std::uint64_t every) {
  for (std::uint64_t steps = first; steps < expected.steps; steps += every) {
    Engine engine(scene, {});
    engine.advance(steps);
    const std::vector<std::byte> bytes = engine.state().to_bytes();
    RunOptions options;
    options.resume_from = &bytes;
    const RunResult resumed = run_as_bound(scene, options);
    for (const ResultValue& one : expected.driver(0).values) {
      const std::string& key = one.quantity().key;
      ASSERT_TRUE(same_bits(resumed.driver(0)[key], one)) << key << " from step " << steps;
    }
  }
}

/// All numbers of two results have the same bits.
inline void expect_same_numbers(const RunResult& a, const RunResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.refused_steps, b.refused_steps);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    SCOPED_TRACE(a.groups[g].family + " " + a.groups[g].name);
    ASSERT_EQ(a.groups[g].values.size(), b.groups[g].values.size());
    for (std::size_t k = 0; k < a.groups[g].values.size(); ++k) {
      EXPECT_TRUE(same_bits(a.groups[g].values[k], b.groups[g].values[k]))
          << a.groups[g].values[k].quantity().key;
    }
  }
  ASSERT_EQ(a.errors.size(), b.errors.size());
  for (std::size_t k = 0; k < a.errors.size(); ++k) {
    EXPECT_EQ(a.errors[k].path, b.errors[k].path);
    EXPECT_EQ(a.errors[k].error, b.errors[k].error) << a.errors[k].path;
  }
}

}  // namespace tomlin::test
