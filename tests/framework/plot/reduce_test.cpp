#include "framework/plot/reduce.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMany = 100000;
constexpr std::size_t kColumns = 540;

Window window_of(const Polyline& curve) {
  const auto by_x = [](const Point& a, const Point& b) { return a.x < b.x; };
  const auto by_y = [](const Point& a, const Point& b) { return a.y < b.y; };
  const auto [left, right] = std::minmax_element(curve.begin(), curve.end(), by_x);
  const auto [low, high] = std::minmax_element(curve.begin(), curve.end(), by_y);
  return {left->x, right->x, low->y, high->y, kColumns, 330.0};
}

Polyline joined(const std::vector<Polyline>& pieces) {
  Polyline all;
  for (const Polyline& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

bool has(const Polyline& curve, const Point& point) {
  return std::find(curve.begin(), curve.end(), point) != curve.end();
}

/// Every point of the one is a point of the other, in the same order.
bool is_subsequence(const Polyline& part, const Polyline& whole) {
  auto at = whole.begin();
  for (const Point& point : part) {
    at = std::find(at, whole.end(), point);
    if (at == whole.end()) return false;
    ++at;
  }
  return true;
}

/// A trace with one sample that stands out on either side.
Polyline trace_with_spikes() {
  Polyline curve;
  for (std::size_t i = 0; i < kMany; ++i) {
    const double x = static_cast<double>(i) / kMany;
    curve.push_back({x, std::sin(40.0 * kTau * x)});
  }
  curve[kMany / 3].y = 5.0;
  curve[kMany / 2 + 1].y = -7.0;
  return curve;
}

/// Many rounds on nearly the same loop.
Polyline loop() {
  Polyline curve;
  for (std::size_t i = 0; i < kMany; ++i) {
    const double turns = 100.0 * static_cast<double>(i) / kMany;
    curve.push_back({std::cos(kTau * turns) + 1e-4 * turns, std::sin(kTau * turns)});
  }
  return curve;
}

Polyline noise() {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Polyline curve;
  for (std::size_t i = 0; i < kMany; ++i) curve.push_back({uniform(generator), uniform(generator)});
  return curve;
}

/// Lowest and highest y in each column of the screen.
std::vector<std::pair<double, double>> outline(const Polyline& curve, const Window& window) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, double>> columns(kColumns, {kNone, -kNone});
  for (const Point& point : curve) {
    const double share = (point.x - window.x_from) / (window.x_to - window.x_from);
    auto& [low, high] =
        columns[std::min<std::size_t>(static_cast<std::size_t>(share * kColumns), kColumns - 1)];
    low = std::min(low, point.y);
    high = std::max(high, point.y);
  }
  return columns;
}

TEST(Reduce, FewPointsStayAsTheyAre) {
  Polyline curve = trace_with_spikes();
  curve.resize(kFewPoints);
  const std::vector<Polyline> pieces = {curve};
  EXPECT_EQ(reduced(pieces, window_of(curve)), pieces);
  EXPECT_TRUE(reduced({}, Window{}).empty());
}

TEST(Reduce, WhatIsDrawnInAColumnStaysTheSame) {
  const Polyline curve = trace_with_spikes();
  const Window window = window_of(curve);
  const Polyline kept = joined(reduced({curve}, window));
  EXPECT_LE(kept.size(), kMostPoints);
  EXPECT_TRUE(is_subsequence(kept, curve));
  EXPECT_EQ(outline(kept, window), outline(curve, window));
  EXPECT_TRUE(has(kept, curve[kMany / 3]));
  EXPECT_TRUE(has(kept, curve[kMany / 2 + 1]));
  EXPECT_EQ(kept.front(), curve.front());
  EXPECT_EQ(kept.back(), curve.back());
}

TEST(Reduce, TheTestSeesPointsThatAreMissing) {
  const Polyline curve = trace_with_spikes();
  const Window window = window_of(curve);
  Polyline every_hundredth;
  for (std::size_t i = 0; i < curve.size(); i += 100) every_hundredth.push_back(curve[i]);
  EXPECT_NE(outline(every_hundredth, window), outline(curve, window));
  EXPECT_FALSE(has(every_hundredth, curve[kMany / 2 + 1]));
}

TEST(Reduce, LaterRoundsOfALoopAreLeftOut) {
  const Polyline curve = loop();
  const Window window = window_of(curve);
  const std::vector<Polyline> pieces = reduced({curve}, window);
  const Polyline kept = joined(pieces);
  EXPECT_LE(kept.size(), kMostPoints);
  EXPECT_TRUE(is_subsequence(kept, curve));
  for (const Polyline& piece : pieces) EXPECT_GE(piece.size(), 2U);
  // All of the first round is there: no larger step than a cell along the circle would explain.
  const double column = (window.x_to - window.x_from) / kColumns;
  for (std::size_t i = 0; i < kMany / 100; i += 10) {
    double nearest = 10.0;
    for (const Point& point : kept) {
      nearest = std::min(nearest, std::hypot(point.x - curve[i].x, point.y - curve[i].y));
    }
    EXPECT_LT(nearest, 0.1) << i;  // at the sides a column holds an arc of sqrt(8 column)
  }
  EXPECT_LT(std::sqrt(8.0 * column), 0.2);
}

TEST(Reduce, ExtremesSurviveWhateverTheCurve) {
  for (const Polyline& curve : {trace_with_spikes(), loop(), noise()}) {
    const Window window = window_of(curve);
    const Polyline kept = joined(reduced({curve}, window));
    EXPECT_LE(kept.size(), kMostPoints);
    const Window shown = window_of(kept);
    EXPECT_EQ(shown.x_from, window.x_from);
    EXPECT_EQ(shown.x_to, window.x_to);
    EXPECT_EQ(shown.y_from, window.y_from);
    EXPECT_EQ(shown.y_to, window.y_to);
  }
}

TEST(Reduce, PiecesAreNotJoined) {
  const Polyline curve = trace_with_spikes();
  const Polyline first(curve.begin(), curve.begin() + kMany / 4);
  const Polyline second(curve.begin() + kMany / 2, curve.end());
  const std::vector<Polyline> pieces = reduced({first, second}, window_of(curve));
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].back(), first.back());
  EXPECT_EQ(pieces[1].front(), second.front());
}

TEST(Reduce, ALevelOrUprightCurveHasNoExtent) {
  const Polyline level(kMany, Point{1.0, 2.0});
  EXPECT_LE(joined(reduced({level}, window_of(level))).size(), kMostPoints);
  Polyline upright;
  for (std::size_t i = 0; i < kMany; ++i) upright.push_back({0.0, static_cast<double>(i)});
  const Polyline kept = joined(reduced({upright}, window_of(upright)));
  EXPECT_EQ(kept.front(), upright.front());
  EXPECT_EQ(kept.back(), upright.back());
}

}  // namespace
}  // namespace tomlin
