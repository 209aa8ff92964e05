#include "framework/study/sweep/bisection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace tomlin {
namespace {

/// A jump keeps this fraction of its difference however narrow its interval is.
constexpr double kJumpKeeps = 0.5;

double difference_of(const Bisection::End& one, const Bisection::End& other) {
  return std::abs(one.number - other.number);
}

bool crosses(const SweepRefinement& refinement, const Bisection::End& one,
             const Bisection::End& other) {
  return (one.number < *refinement.level) != (other.number < *refinement.level);
}

}  // namespace

double SweepBisection::observed_at(std::size_t point) const {
  SweepRow row;
  journal_.read(point, {&row, 1});
  return row.numbers[plan_.refined_column()];
}

bool SweepBisection::add_points() {
  if (!has_begun_) begin();
  has_begun_ = true;
  bool is_complete = true;
  for (Bisection& bisection : bisections_) {
    if (!bisection.status) go_on(bisection);
    is_complete = is_complete && bisection.status;
  }
  return !is_complete;
}

void SweepBisection::begin() {
  for (std::size_t point = 0; point < plan_.points(); ++point) {
    if (plan_.index(plan_.refinement()->axis, point) == 0) begin_in_line(point);
  }
}

void SweepBisection::begin_in_line(std::size_t first) {
  const SweepRefinement& refinement = *plan_.refinement();
  const std::size_t count = plan_.axes()[refinement.axis].values.size();
  const std::size_t before = bisections_.size();
  Bisection widest;
  std::vector<Bisection> at_failed_ends;
  std::optional<Bisection::End> last;
  bool are_neighbours = true;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t point = first + k * plan_.stride(refinement.axis);
    const Bisection::End end = {point, plan_.number(refinement.axis, point), observed_at(point)};
    const bool is_end = k == 0 || k + 1 == count;
    if (std::isnan(end.number) && !is_end) {
      are_neighbours = false;
      continue;
    }
    if (last) {
      Bisection bisection;
      bisection.first = first;
      bisection.ends = {*last, end};
      bisection.left = last->point;
      bisection.difference = difference_of(*last, end);
      bisection.rounds = refinement.rounds_between(last->at, end.at);
      if (!are_neighbours) bisection.status = BisectionStatus::failed;
      const bool is_known = !std::isnan(bisection.difference);
      if (!refinement.level && are_neighbours && bisection.difference > widest.difference) {
        widest = bisection;
      }
      if (refinement.level && is_known && crosses(refinement, *last, end)) {
        bisections_.push_back(bisection);
      }
      const bool is_one_known = !std::isnan(last->number) || !std::isnan(end.number);
      if (refinement.level && !is_known && is_one_known && are_neighbours)
        at_failed_ends.push_back(bisection);
    }
    last = end;
    are_neighbours = true;
  }
  if (widest.difference > 0.0) bisections_.push_back(widest);
  if (bisections_.size() > before) return;
  bisections_.insert(bisections_.end(), at_failed_ends.begin(), at_failed_ends.end());
  if (bisections_.size() > before) return;
  Bisection nothing;
  nothing.status = BisectionStatus::none;
  nothing.first = first;
  bisections_.push_back(nothing);
}

/// Continues a bisection as far as there are rows.
void SweepBisection::go_on(Bisection& bisection) {
  const SweepRefinement& refinement = *plan_.refinement();
  auto& [low, high] = bisection.ends;
  for (; bisection.round < bisection.rounds; ++bisection.round) {
    Bisection::End middle;
    middle.at = refinement.middle(low.at, high.at);
    if (middle.at == low.at || middle.at == high.at) break;  // neighbouring doubles
    middle.point = plan_.number_between(bisection.left, bisection.round);
    plan_.add(middle.point, middle.at);
    if (!journal_.has(middle.point)) return;
    middle.number = observed_at(middle.point);
    if (std::isnan(middle.number)) {
      bisection.status = BisectionStatus::failed;
      return;
    }
    const bool is_in_first_half = !refinement.level
                                      ? difference_of(low, middle) >= difference_of(middle, high)
                                  : std::isnan(low.number) ? !crosses(refinement, middle, high)
                                                           : crosses(refinement, low, middle);
    (is_in_first_half ? high : low) = middle;
    if (!refinement.level && difference_of(low, high) < kJumpKeeps * bisection.difference) {
      bisection.status = BisectionStatus::smooth;
      return;
    }
  }
  const bool is_known = !std::isnan(difference_of(low, high));
  bisection.status = is_known ? BisectionStatus::found : BisectionStatus::failed;
}

}  // namespace tomlin
