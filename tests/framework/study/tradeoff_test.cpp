#include "framework/study/tradeoff/tradeoff.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "framework/scene/document.hpp"
#include "tests/support/ring_scenes.hpp"

// The trade of a scene, held against runs that the study has no part in.

namespace tomlin::test {
namespace {

constexpr const char* kForce = "driver.mean_force.x";
constexpr double kTolerance = 1e-4;
/// Evaluations that count as a second of a budget: no verdict depends on the machine's speed.
constexpr double kPace = 1e6;

const char* const kWindow = "[measure]\nin = \"driver_periods\"\nfrom = 1\n";

/// Slides smoothly: the driving spring is stiffer than the corrugation.
TipScene smooth() {
  return {.velocity = 0.05, .stiffness = 8.0, .duration = 60.0, .more = kWindow};
}

/// Sticks and slips.
TipScene stick_slip() {
  return {.velocity = 0.05, .stiffness = 1.0, .damping = 2.0, .duration = 100.0, .more = kWindow};
}

Tradeoff tradeoff_of(const std::string& text, const std::string& observable = kForce,
                     double tolerance = kTolerance, double budget = 5.0) {
  return measure_tradeoff(
      scene_of(text), standard(),
      {.observable = observable, .tolerance = tolerance, .budget = budget, .pace = kPace});
}

double value_of(const std::string& text, const std::vector<Setting>& settings) {
  return observable(run_text(text, settings), kForce).value();
}

/// By a run of the test's own, far finer than any tolerance here.
double truth(const std::string& text) {
  return value_of(text, {{"run.integrator", adaptive(1e-13)}});
}

void expect_valid(const std::string& text) {
  const Tradeoff found = tradeoff_of(text);
  ASSERT_TRUE(found.reference);
  const double exact = truth(text);
  EXPECT_TRUE(found.reference->settled);
  // The estimate is that of the last but one; the test's own run has rounding.
  EXPECT_LE(std::abs(found.reference->value - exact),
            found.reference->error + 1e-12 * std::abs(exact));
  EXPECT_LT(found.reference->error, 1e-2 * kTolerance * std::abs(exact));
  EXPECT_EQ(found.sensitivity.verdict, Sensitivity::Verdict::determined);
  EXPECT_EQ(found.sensitivity.values.size(), 4U);

  ASSERT_TRUE(found.recommendation) << found.why_none;
  const TradeoffPoint& chosen = found.points[found.recommendation->point];
  const double again = value_of(text, found.recommendation->settings);
  EXPECT_EQ(again, chosen.value) << "the lines are the run";
  EXPECT_LT(std::abs(again - exact), kTolerance * std::abs(exact));
  for (const TradeoffPoint& point : found.points) {
    EXPECT_EQ(point.error, std::abs(point.value - found.reference->value));
    EXPECT_GT(point.cost(), 0U);
  }
}

/// Its hundreds of variants are read from one document.
TEST(Tradeoff, ParsesTheSceneOnce) {
  const auto scene = scene_of(smooth().text());
  const std::size_t before = parsed_documents();
  const Tradeoff tradeoff = measure_tradeoff(
      scene, standard(),
      {.observable = kForce, .tolerance = kTolerance, .budget = 5.0, .pace = kPace});
  EXPECT_TRUE(tradeoff.recommendation.has_value());
  EXPECT_EQ(parsed_documents(), before + 1);
}

TEST(Tradeoff, SmoothSliding) { expect_valid(smooth().text()); }

TEST(Tradeoff, StickSlip) { expect_valid(stick_slip().text()); }

TEST(Tradeoff, NothingThatWasMeasuredIsCheaper) {
  const Tradeoff found = tradeoff_of(stick_slip().text());
  ASSERT_TRUE(found.recommendation);
  const std::uint64_t cost = found.points[found.recommendation->point].cost();
  // By chance a setting may be good whose finer ones are not: those are no recommendation.
  constexpr double kLuck = 1.5;
  for (const TradeoffPoint& point : found.points) {
    if (found.error_of(point) > 0.5 * kTolerance) continue;
    EXPECT_LE(static_cast<double>(cost), kLuck * static_cast<double>(point.cost()))
        << found.methods[point.method].name << " " << point.resolution;
  }
}

TEST(Tradeoff, MarksTheBestAtEachPowerOfTen) {
  const Tradeoff found = tradeoff_of(smooth().text());
  std::set<int> cheapest;
  std::set<int> fastest;
  for (const TradeoffPoint& point : found.points) {
    for (const int n : point.cheapest_at) {
      EXPECT_TRUE(cheapest.insert(n).second) << "one each";
      EXPECT_LE(found.error_of(point), std::pow(10.0, -n));
      for (const TradeoffPoint& other : found.points) {
        if (found.error_of(other) > std::pow(10.0, -n)) continue;
        EXPECT_LE(point.cost(), other.cost());
      }
    }
    for (const int n : point.fastest_at) EXPECT_TRUE(fastest.insert(n).second);
  }
  EXPECT_EQ(cheapest, fastest);
  EXPECT_TRUE(cheapest.contains(1) && cheapest.contains(4));
}

TEST(Tradeoff, ATighterToleranceCostsMore) {
  const auto cost = [](double tolerance) {
    const Tradeoff found = tradeoff_of(stick_slip().text(), kForce, tolerance);
    return found.points.at(found.recommendation.value().point).cost();
  };
  EXPECT_LT(cost(1e-2), cost(1e-6));
}

TEST(Tradeoff, TellsWhatIsRefusedAndWhatIsUnstable) {
  TipScene tip = smooth();
  tip.more = "dynamics = \"overdamped\"\n" + tip.more;
  const Tradeoff found = tradeoff_of(tip.text());
  const auto gap = [&found](const std::string& method, TradeoffGap::Kind kind) {
    return std::any_of(found.gaps.begin(), found.gaps.end(), [&](const TradeoffGap& one) {
      return one.method == method && one.kind == kind && !one.why.empty();
    });
  };
  EXPECT_TRUE(gap("velocity_verlet", TradeoffGap::Kind::refused));
  EXPECT_TRUE(gap("rk4", TradeoffGap::Kind::unstable));
  EXPECT_FALSE(gap("dopri5", TradeoffGap::Kind::refused));
  for (const TradeoffPoint& point : found.points) {
    EXPECT_NE(found.methods[point.method].name, "velocity_verlet");
  }
}

TEST(Tradeoff, AModelsErrorIsPartOfIt) {
  // Lightly damped: without inertia it is another motion, however small the steps.
  TipScene tip = stick_slip();
  tip.damping = 0.1;
  tip.velocity = 0.3;
  const Tradeoff found = tradeoff_of(tip.text());
  bool seen = false;
  for (const TradeoffPoint& point : found.points) {
    if (found.methods[point.method].is_own_model()) continue;
    seen = true;
    EXPECT_GT(found.error_of(point), 1e-2)
        << found.methods[point.method].name << " " << point.resolution;
  }
  EXPECT_TRUE(seen);
  ASSERT_TRUE(found.recommendation);
  EXPECT_TRUE(found.methods[found.points[found.recommendation->point].method].is_own_model());
}

TEST(Tradeoff, WhereTheNumberIsZeroErrorsArePartsOfTheScenesForce) {
  TipScene rest = smooth();
  rest.velocity = 0.0;
  rest.position = 0.5;  // a well
  rest.more = "";
  const Tradeoff found = tradeoff_of(rest.text());
  ASSERT_TRUE(found.reference);
  EXPECT_FALSE(found.scale.relative);
  EXPECT_TRUE(found.scale.resolved);
  // The corrugation's.
  EXPECT_NEAR(found.scale.size, rest.amplitude * std::pow(2.0 * 3.141592653589793, 2.0), 1e-12);
  ASSERT_TRUE(found.recommendation);
}

/// A value of the size of its own error is neither known nor zero: nothing is held against it.
TEST(Tradeoff, WhatIsNotResolvedIsNotRecommended) {
  Reference reference;
  reference.natural = 8.0;
  reference.value = 1e-8;
  reference.error = 3e-9;
  EXPECT_FALSE(error_scale(reference).resolved);
  reference.error = 1e-10;
  EXPECT_TRUE(error_scale(reference).resolved);
  EXPECT_TRUE(error_scale(reference).relative);
  reference.value = 1e-13;
  reference.error = 1e-12;
  EXPECT_TRUE(error_scale(reference).resolved) << "rounding: it is zero";
  EXPECT_FALSE(error_scale(reference).relative);
  // Hardly driven at all: a mean force of 1e-8 beside forces of 8.
  TipScene tip = smooth();
  tip.velocity = 1e-9;
  tip.position = 0.5;
  tip.more = "";
  const Tradeoff found = tradeoff_of(tip.text(), "driver.mean_force.x", 1e-6, 2.0);
  ASSERT_TRUE(found.reference);
  EXPECT_TRUE(found.scale.relative || !found.recommendation)
      << "T has turned from relative to absolute";
}

/// The ring of the paper's Table I, whose orientation at decay 0 is unstable in every period.
RingScene table_1(double decay) {
  return {.coordinates = "rigid",
          .velocity = 1e-3,
          .decay = decay,
          .duration = 5e3,
          .integrator = adaptive(1e-10),
          .more = kWindow};
}

TEST(Tradeoff, DoesNotRecommendForWhatIsNotDetermined) {
  const Tradeoff found = tradeoff_of(table_1(0.0).text());
  EXPECT_EQ(found.sensitivity.verdict, Sensitivity::Verdict::not_determined);
  EXPECT_LT(found.sensitivity.digits, 1.0);
  EXPECT_GT(found.sensitivity.spread, 0.1 * found.reference->value);
  EXPECT_FALSE(found.recommendation);
  EXPECT_NE(found.why_none.find("not determined"), std::string::npos);
}

TEST(Tradeoff, DoesNotCryWolf) {
  const Tradeoff found = tradeoff_of(table_1(1.0).text());
  EXPECT_EQ(found.sensitivity.verdict, Sensitivity::Verdict::determined);
  EXPECT_GT(found.sensitivity.digits, 6.0);
  EXPECT_GT(found.sensitivity.spread, 0.0) << "the starts do differ";
  EXPECT_TRUE(found.recommendation) << found.why_none;
}

TEST(Tradeoff, ASmallBudgetIsNoErrorAndKeepsItself) {
  TipScene tip = smooth();
  tip.duration = 1e8;
  constexpr double kBudget = 0.01;
  constexpr double kMost = 0.02;  // each method that has no share left takes a step nevertheless
  const Tradeoff found = tradeoff_of(tip.text(), kForce, kTolerance, kBudget);
  EXPECT_FALSE(found.reference);
  EXPECT_FALSE(found.recommendation);
  EXPECT_NE(found.why_none.find("over budget"), std::string::npos) << found.why_none;
  EXPECT_LT(found.seconds, kMost);
  EXPECT_GE(found.gaps.size(), standard().integrators().size());
}

TEST(Tradeoff, IsStoppedByASignal) {
  const std::atomic<bool> stop = true;
  const Tradeoff found = measure_tradeoff(scene_of(smooth().text()), standard(),
                                          {.observable = kForce, .stop = &stop});
  EXPECT_TRUE(found.interrupted);
  EXPECT_TRUE(found.points.empty());
}

TEST(Tradeoff, RefusesWhatIsNoResult) {
  using Briefs = std::vector<std::string>;
  const auto faults = [](const std::string& text, const std::string& observable) {
    return briefs_of([&] { tradeoff_of(text, observable); });
  };
  const std::string text = smooth().text();
  EXPECT_EQ(faults(text, "driver.mean_farce.x"),
            Briefs{"driver.mean_farce.x [observable.unknown] did you mean driver.mean_force.x"});
  for (const std::string path : {"performance.wall_seconds", "time.force_evaluations"}) {
    EXPECT_EQ(faults(text, path), Briefs{path + " [command.invalid_value]"});
  }
  TipScene still = smooth();
  still.velocity = 0.0;
  still.more = "";
  EXPECT_EQ(faults(still.text(), "driver.static_force"),
            Briefs{"drivers.driver.static_force [observable.undefined]"});
}

TEST(SceneLines, AreReadyToPaste) {
  const std::vector<std::string> lines = scene_lines({{"run.integrator", "{ type = \"rk4\" }"},
                                                      {"body.ring.coordinates", "\"rigid\""},
                                                      {"run.dynamics", "\"overdamped\""}});
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "[run]");
  EXPECT_EQ(lines[1], "integrator = { type = \"rk4\" }");
  EXPECT_EQ(lines[2], "dynamics = \"overdamped\"");
  EXPECT_EQ(lines[3], "coordinates = \"rigid\"    # [[body]] ring");
}

}  // namespace
}  // namespace tomlin::test
