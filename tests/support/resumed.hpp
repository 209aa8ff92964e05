#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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

}  // namespace tomlin::test
