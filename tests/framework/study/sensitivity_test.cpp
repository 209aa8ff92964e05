#include "framework/study/tradeoff/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "framework/study/tradeoff/methods.hpp"
#include "tests/support/ring_scenes.hpp"

// A spread is judged by the tolerance, by the errors of integration and by digits.

namespace tomlin::test {
namespace {

using Verdict = Sensitivity::Verdict;
constexpr const char* kForce = "driver.mean_force.x";
constexpr double kFine = 1e-9;
/// Far more evaluations than a run takes.
constexpr double kBudget = 60.0;
constexpr double kPace = 1e6;

/// The spread of a tip that slides, judged by a reference that moved so much at last.
Sensitivity judged(double move, double tolerance, bool settled = true) {
  const TipScene tip{
      .velocity = 0.05, .stiffness = 8.0, .duration = 20.0, .integrator = adaptive(kFine)};
  const auto scene = scene_of(tip.text());
  const Variants variants(scene, standard());
  Reference reference;
  reference.method = "dopri5";
  reference.resolution_value = kFine;
  reference.value = observable(run(scene), kForce).value();
  reference.move = move;
  reference.settled = settled;
  reference.finest = !settled;
  Measurer measurer(variants, kForce, kBudget, nullptr, kPace);
  return find_sensitivity(variants, methods_for(variants), reference, measurer, tolerance);
}

TEST(Sensitivity, ComesFromStartsThatDiffer) {
  const Sensitivity found = judged(0.0, 1e-3);
  ASSERT_EQ(found.values.size(), 4U);
  EXPECT_EQ(found.verdict, Verdict::determined);
  const auto [least, most] = std::minmax_element(found.values.begin(), found.values.end());
  EXPECT_GT(*most, *least);
  EXPECT_LE(found.min, *least);
  EXPECT_GE(found.max, *most);
  EXPECT_EQ(found.spread, found.max - found.min);
  // A start off by 1e-9 of a period is forgotten, but in the mean.
  EXPECT_LT(found.spread, 1e-9);
  EXPECT_NEAR(found.digits, std::log10(found.max / found.spread), 1e-12);
}

/// A spread beyond the tolerance is the scene's own only where steps cannot have made it.
TEST(Sensitivity, IsNotWhatTheStepsHaveMade) {
  constexpr double kNoTolerance = 0.0;
  const Sensitivity found = judged(0.0, kNoTolerance);
  EXPECT_EQ(found.verdict, Verdict::not_determined);
  // Ten errors are the limit.
  EXPECT_EQ(judged(found.spread / 9.0, kNoTolerance).verdict, Verdict::unknown);
  EXPECT_EQ(judged(found.spread / 11.0, kNoTolerance).verdict, Verdict::not_determined);
  EXPECT_FALSE(judged(found.spread, kNoTolerance).why.empty());
  // No finer steps make the value settle: then it moves for another reason.
  EXPECT_EQ(judged(found.spread, kNoTolerance, false).verdict, Verdict::not_determined);
}

}  // namespace
}  // namespace tomlin::test
