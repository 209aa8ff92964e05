#include "framework/study/tradeoff/work_precision.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "framework/study/tradeoff/methods.hpp"

namespace tomlin {
namespace {

/// Part of the tolerance that a measured error may take.
constexpr double kMargin = 0.8;
/// Part of the stable step to begin with.
constexpr double kPartOfStableStep = 0.98;
/// Part of the run to begin with where nothing is known to limit the step.
constexpr double kLongestPartOfRun = 0.1;
constexpr double kCoarsestTolerance = 1.0;
constexpr int kMostPoints = 40;
/// A method ends after so many points in a row that are no better than those before, because of
/// rounding or chaos.
constexpr int kMostIdlePoints = 7;
/// A point is better where its error is at most this part of the least one so far.
constexpr double kImprovement = 0.7;
/// A method ends after so many points in a row whose value has moved by at most this part of their
/// error, which is then that of the model or of rounding.
constexpr int kPointsAtRest = 3;
constexpr double kMoveAtRest = 0.03;
/// A method ends after so many points that are fine enough: the first may be so by chance.
constexpr int kMostFineEnough = 2;
constexpr int kRefinements = 4;
/// A method ends at a point that costs so many times as much as one that keeps the tolerance.
constexpr std::uint64_t kMostTimesCheapest = 30;
constexpr std::size_t kNoPointOfMethod = std::numeric_limits<std::size_t>::max();

double rounded_down(double x) {
  const double near = rounded_to_digits(x, 2);
  if (near <= x) return near;
  // One less in the second digit.
  const std::string text = fmt::format("{:.0e}", x);
  double digit = 0.0;
  const std::string unit = "1" + text.substr(text.find('e'));
  std::from_chars(unit.data(), unit.data() + unit.size(), digit);
  return rounded_to_digits(near - 0.1 * digit, 2);
}

TradeoffGap::Kind kind_of(const Measurement& found) {
  switch (found.end) {
    case TrialRun::End::finished:
      return TradeoffGap::Kind::undefined;
    case TrialRun::End::over_budget:
    case TrialRun::End::interrupted:
      return TradeoffGap::Kind::over_budget;
    case TrialRun::End::refused:
      return TradeoffGap::Kind::refused;
    case TrialRun::End::failed:
      break;
  }
  return TradeoffGap::Kind::failed;
}

TradeoffPoint point_of(std::size_t method, double resolution, const Measurement& found,
                       const Aim& aim) {
  TradeoffPoint point;
  point.method = method;
  point.resolution = resolution;
  point.value = *found.value;
  point.error = std::abs(point.value - aim.reference);
  point.evaluations = found.evaluations;
  point.columns = found.columns;
  point.seconds = found.seconds;
  return point;
}

bool is_last(const Method& method, double resolution) {
  return method.resolution == Resolution::tolerance && resolution <= kFinestTolerance;
}

/// The least cost of all points that keep the tolerance.
std::uint64_t least_cost(const Aim& aim, const std::vector<TradeoffPoint>& points) {
  const std::size_t best = cheapest_point(aim, points);
  return best < points.size() ? std::max<std::uint64_t>(points[best].cost(), 1)
                              : std::numeric_limits<std::uint64_t>::max();
}

/// One method's way from coarse to fine.
class Walk {
 public:
  Walk(std::size_t index, const Method& method, const Aim& aim, Tradeoff& tradeoff)
      : index_(index),
        method_(method),
        aim_(aim),
        tradeoff_(tradeoff),
        least_(least_cost(aim, tradeoff.points)) {}

  void go(double first, double seconds, Measurer& measurer) {
    const double until = measurer.used() + seconds;
    double resolution = first;
    double last_seconds = 0.0;
    for (int k = 0; k < kMostPoints && !done_;
         ++k, resolution = next_resolution(method_, resolution)) {
      // Halving a step doubles the work; that a tolerance costs more is only seen by trying.
      const double left = std::min(until - measurer.used(), measurer.left());
      const double expected =
          method_.resolution == Resolution::step ? 2.0 * last_seconds : last_seconds;
      if (left <= 0.0 || expected > left) return leave_rest(resolution);
      const Measurement& found = measurer.at(method_, resolution, left);
      last_seconds = found.seconds;
      take(resolution, found);
      if (is_last(method_, resolution)) break;
    }
    end();
  }

 private:
  void gap(TradeoffGap::Kind kind, std::string why) {
    tradeoff_.gaps.push_back({kind, method_.name, std::move(why)});
  }

  std::string at(double resolution) const {
    return fmt::format("{} = {:g}", to_string(method_.resolution), resolution);
  }

  void leave_rest(double resolution) {
    gap(TradeoffGap::Kind::over_budget, at(resolution) + " and finer");
    end();
  }

  void take(double resolution, const Measurement& found) {
    if (!found.defined()) return take_failure(resolution, found);
    tradeoff_.points.push_back(point_of(index_, resolution, found, aim_));
    ++taken_;
    const double error = tradeoff_.points.back().error;
    fine_ = error <= aim_.fine_enough ? fine_ + 1 : 0;
    idle_ = error <= kImprovement * best_ ? 0 : idle_ + 1;
    best_ = std::min(best_, error);
    at_rest_ =
        taken_ > 1 && std::abs(*found.value - last_) <= kMoveAtRest * error ? at_rest_ + 1 : 0;
    last_ = *found.value;
    done_ = fine_ >= kMostFineEnough || idle_ >= kMostIdlePoints || at_rest_ >= kPointsAtRest;
    if (!done_ && found.cost() / kMostTimesCheapest >= least_) {
      done_ = true;
      gap(TradeoffGap::Kind::costly,
          fmt::format("finer than {}: over {} times what keeps the tolerance", at(resolution),
                      kMostTimesCheapest));
    }
  }

  /// Steps or tolerances that are too coarse make runs fail, and finer ones help.
  void take_failure(double resolution, const Measurement& found) {
    const TradeoffGap::Kind kind = kind_of(found);
    const std::string why = at(resolution) + ": " + found.why;
    if (taken_ == 0 && kind == TradeoffGap::Kind::failed) {
      if (first_failure_.empty()) first_failure_ = why;
      return;
    }
    gap(kind, why);
    done_ = true;
  }

  void end() {
    if (!first_failure_.empty()) gap(TradeoffGap::Kind::failed, first_failure_);
    if (method_.resolution == Resolution::step && std::isfinite(method_.stable_step)) {
      gap(TradeoffGap::Kind::unstable, fmt::format("beyond dt = {:.4g}", method_.stable_step));
    }
  }

  std::size_t index_;
  const Method& method_;
  const Aim& aim_;
  Tradeoff& tradeoff_;
  std::uint64_t least_;  ///< cost of the cheapest point of other methods that keeps the tolerance
  int taken_ = 0;
  int fine_ = 0;
  int idle_ = 0;
  int at_rest_ = 0;
  double last_ = 0.0;  ///< the value before
  double best_ = std::numeric_limits<double>::infinity();
  bool done_ = false;
  std::string first_failure_;  ///< of those before the first point
};

bool is_coarser(const TradeoffPoint& a, const TradeoffPoint& b) {
  return a.resolution > b.resolution;
}

/// The points of one method, from coarse to fine.
std::vector<std::size_t> points_of(std::size_t method, const std::vector<TradeoffPoint>& points) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].method == method) found.push_back(p);
  }
  std::sort(found.begin(), found.end(),
            [&points](std::size_t a, std::size_t b) { return is_coarser(points[a], points[b]); });
  return found;
}

/// The coarsest point of a method from which on all keep the tolerance, and the one before it.
struct Bracket {
  std::size_t coarse = kNoPointOfMethod;
  std::size_t fine = kNoPointOfMethod;
};

Bracket bracket_of(const Aim& aim, std::size_t method, const std::vector<TradeoffPoint>& points) {
  Bracket bracket;
  const std::vector<std::size_t> order = points_of(method, points);
  for (auto p = order.rbegin(); p != order.rend(); ++p) {
    if (!aim.is_met(points[*p].error)) {
      bracket.coarse = *p;
      break;
    }
    bracket.fine = *p;
  }
  return bracket;
}

/// Halfway between two values of a resolution, by their ratio; nothing when two digits do not tell
/// them apart.
std::optional<double> between(const Method& method, double coarse, double fine) {
  const double middle =
      rounded_to_digits(std::sqrt(coarse / method.unit * (fine / method.unit)), 2) * method.unit;
  if (middle >= coarse || middle <= fine) return std::nullopt;
  return middle;
}

}  // namespace

bool Aim::is_met(double error) const { return error + doubt <= kMargin * tolerance; }

double first_resolution(const Method& method, double duration) {
  if (method.resolution == Resolution::tolerance) return kCoarsestTolerance;
  const double longest =
      std::min(kPartOfStableStep * method.stable_step, kLongestPartOfRun * duration);
  return rounded_down(longest / method.unit) * method.unit;
}

double next_resolution(const Method& method, double resolution) {
  if (method.resolution == Resolution::step) return method.rounded(0.5 * resolution, 2);
  const double decade = rounded_to_digits(resolution, 1);
  constexpr double kHalfDecade = 0.3;  // 1, 0.3, 0.1, ...: easy to read
  const bool power_of_ten = fmt::format("{:.0e}", decade).front() == '1';
  return rounded_to_digits(decade * (power_of_ten ? kHalfDecade : 1.0 / 3.0), 1);
}

void walk(std::size_t index, const std::vector<Method>& methods, double duration, const Aim& aim,
          double seconds, Measurer& measurer, Tradeoff& tradeoff) {
  const Method& method = methods[index];
  if (!method.refused.empty()) {
    tradeoff.gaps.push_back({TradeoffGap::Kind::refused, method.name, method.refused});
    return;
  }
  Walk(index, method, aim, tradeoff).go(first_resolution(method, duration), seconds, measurer);
}

void refine(const Aim& aim, Measurer& measurer, Tradeoff& tradeoff) {
  for (int pass = 0; pass < kRefinements; ++pass) {
    const std::size_t best = cheapest_point(aim, tradeoff.points);
    if (best == tradeoff.points.size()) return;
    const std::uint64_t least = tradeoff.points[best].cost();
    for (std::size_t r = 0; r < tradeoff.methods.size(); ++r) {
      const Bracket bracket = bracket_of(aim, r, tradeoff.points);
      if (bracket.coarse == kNoPointOfMethod || bracket.fine == kNoPointOfMethod) continue;
      // A point between the two costs more than the coarser one.
      if (tradeoff.points[bracket.coarse].cost() >= least) continue;
      const auto middle = between(tradeoff.methods[r], tradeoff.points[bracket.coarse].resolution,
                                  tradeoff.points[bracket.fine].resolution);
      if (!middle || measurer.is_over()) continue;
      const Measurement& found = measurer.at(tradeoff.methods[r], *middle, measurer.left());
      if (found.defined()) tradeoff.points.push_back(point_of(r, *middle, found, aim));
    }
  }
}

std::size_t cheapest_point(const Aim& aim, const std::vector<TradeoffPoint>& points) {
  std::size_t best = points.size();
  std::size_t methods = 0;
  for (const TradeoffPoint& point : points) methods = std::max(methods, point.method + 1);
  for (std::size_t r = 0; r < methods; ++r) {
    const std::size_t last = bracket_of(aim, r, points).fine;
    if (last == kNoPointOfMethod) continue;
    for (const std::size_t p : points_of(r, points)) {
      if (is_coarser(points[p], points[last])) continue;
      if (best == points.size() || points[p].cost() < points[best].cost()) best = p;
    }
  }
  return best;
}

void mark_best(Tradeoff& tradeoff) {
  std::vector<TradeoffPoint>& points = tradeoff.points;
  constexpr int kMostDigits = 15;
  for (int n = 1; n <= kMostDigits; ++n) {
    const double accuracy = std::pow(10.0, -n);
    TradeoffPoint* fastest = nullptr;
    TradeoffPoint* cheapest = nullptr;
    for (TradeoffPoint& point : points) {
      if (!(tradeoff.error_of(point) <= accuracy)) continue;
      if (fastest == nullptr || point.seconds < fastest->seconds) fastest = &point;
      if (cheapest == nullptr || point.cost() < cheapest->cost()) cheapest = &point;
    }
    if (fastest == nullptr) return;
    fastest->fastest_at.push_back(n);
    cheapest->cheapest_at.push_back(n);
  }
}

}  // namespace tomlin
