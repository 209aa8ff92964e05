#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "framework/run/engine.hpp"
#include "tests/support/ring_scenes.hpp"

// Samples of a tip at every step, which are served by the block.

namespace tomlin::test {
namespace {

constexpr double kStep = 0.01;

std::string scheme(const char* name) {
  return std::string("{ type = \"") + name + "\", dt = " + digits(kStep) + " }";
}

KeptSamples sampled(const TipScene& tip, std::uint64_t steps_at_once) {
  KeptSamples kept;
  Engine engine(scene_of(tip.text()), watched_by(kept));
  while (!engine.done()) engine.advance(steps_at_once);
  return kept;
}

TipScene tip_sampled_every(double time, const char* integrator) {
  TipScene tip{.damping = 0.5, .duration = 7.0, .integrator = scheme(integrator)};
  tip.more = "[measure]\nin = \"time\"\nfrom = 2.005\nto = 6.0\n[output]\nevery = " + digits(time) +
             "\ntrajectory = true\n";
  return tip;
}

TEST(SamplesOfEachStep, DoNotDependOnWhereBlocksEnd) {
  for (const char* integrator : {"rk4", "midpoint"}) {
    const TipScene tip = tip_sampled_every(kStep, integrator);
    const KeptSamples all = sampled(tip, 1'000'000);
    ASSERT_EQ(all.rows.size(), 701u);
    for (const std::uint64_t at_once : {1, 7, 16, 23}) {
      SCOPED_TRACE(integrator + std::string(" by ") + std::to_string(at_once));
      EXPECT_EQ(sampled(tip, at_once).rows, all.rows);
    }
  }
}

/// Rows of a run that is sampled half as often: those are served step by step.
TEST(SamplesOfEachStep, AreThoseOfStepsTakenOneByOne) {
  // Forces are known at one of two times that differ by a rounding of the time, 4e-16 of 7.
  constexpr double kRounding = 1e-14;
  for (const char* integrator : {"rk4", "midpoint"}) {
    const KeptSamples all = sampled(tip_sampled_every(kStep, integrator), 1000);
    const KeptSamples half = sampled(tip_sampled_every(2.0 * kStep, integrator), 1000);
    ASSERT_EQ(half.rows.size(), 351u);
    for (std::size_t row = 0; row < half.rows.size(); ++row) {
      for (std::size_t k = 0; k < half.rows[row].size(); ++k) {
        EXPECT_NEAR(all.rows[2 * row][k], half.rows[row][k], kRounding)
            << integrator << ", row " << row << ", number " << k;
      }
    }
  }
}

/// Events are those of a run without samples, to the last digit.
TEST(SamplesOfEachStep, LeaveEventsAsTheyAre) {
  for (const char* integrator : {"rk4", "midpoint"}) {
    TipScene tip = tip_sampled_every(kStep, integrator);
    tip.duration = 60.0;
    const KeptSamples with = sampled(tip, 1'000'000);
    tip.more = "[measure]\nin = \"time\"\nfrom = 2.005\nto = 6.0\n";
    const KeptSamples without = sampled(tip, 1'000'000);
    const auto slips = with.of(EventKind::slip);
    const auto expected = without.of(EventKind::slip);
    ASSERT_EQ(slips.size(), expected.size());
    EXPECT_GE(slips.size(), 5u);
    for (std::size_t k = 0; k < slips.size(); ++k) {
      EXPECT_EQ(slips[k].time, expected[k].time);
      EXPECT_EQ(slips[k].energy_lost, expected[k].energy_lost);
    }
  }
}

/// The force is that of the support and of the centre in the same row, at the time of the grid.
TEST(SamplesOfEachStep, AreOfOneMoment) {
  constexpr double kRounding = 4e-15;  // of forces of about 1 from positions of about 2
  const TipScene tip = tip_sampled_every(kStep, "rk4");
  const KeptSamples kept = sampled(tip, 1'000'000);
  const std::size_t force = kept.column("driver.force.x");
  const std::size_t support = kept.column("driver.position.x");
  const std::size_t centre = kept.column("tip.centre_of_mass.x");
  ASSERT_GT(kept.rows.size(), 100u);
  for (std::size_t n = 0; n < kept.rows.size(); ++n) {
    const auto& row = kept.rows[n];
    EXPECT_EQ(row[0], static_cast<double>(n) * kStep);
    EXPECT_NEAR(row[support], tip.position + tip.velocity * row[0], kRounding);
    EXPECT_NEAR(row[force], tip.stiffness * (row[support] - row[centre]), kRounding) << n;
    EXPECT_EQ(row[centre], row.back());
  }
}

}  // namespace
}  // namespace tomlin::test
