#include "framework/run/observers/slip_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace tomlin::observers {
namespace {

const ResultQuantity kSlips{"slips", dimension::none, Shape::count, Scope::window,
                            "slips that begin in the window, of a spring of steady velocity"};

/// Mean, standard deviation and range of one quantity of slips.
struct SlipRows {
  ResultQuantity mean;
  ResultQuantity deviation;
  ResultQuantity smallest;
  ResultQuantity largest;
};

SlipRows rows_of(const std::string& key, const Dimension& dimension, const std::string& what) {
  const auto row = [&](const std::string& name, const std::string& meaning) {
    return ResultQuantity{name, dimension, Shape::number, Scope::window, meaning};
  };
  return {row("mean_" + key, "mean " + what),
          row(key + "_deviation", "standard deviation of it, of two slips or more"),
          row("min_" + key, "smallest"), row("max_" + key, "largest")};
}

const SlipRows kRows[] = {
    rows_of("slip_length", dimension::length, "displacement of the pulled point in a slip"),
    rows_of("slip_force", dimension::force, "force along the pull at which a slip begins"),
    rows_of("slip_energy", dimension::energy, "energy dissipated in a slip"),
};

const ResultQuantity kEffectiveStiffness{
    "effective_stiffness", dimension::stiffness, Shape::number, Scope::window,
    "mean over slips of the steepest slope of the force over the displacement of the pulled end "
    "since the slip before: of spring and contact in series"};

}  // namespace

std::vector<const ResultQuantity*> SlipStatistics::rows() {
  std::vector<const ResultQuantity*> all = {&kSlips};
  for (const SlipRows& one : kRows) {
    all.insert(all.end(), {&one.mean, &one.deviation, &one.smallest, &one.largest});
  }
  all.push_back(&kEffectiveStiffness);
  return all;
}

void SlipStatistics::declare(StateLayout& layout) const {
  layout.add_reals("slips.numbers", drivers() * kQuantities * kNumbers);
  layout.add_integers("slips.counts", drivers() * (1 + kQuantities));
}

void SlipStatistics::attach(RunState& state) {
  numbers_ = state.reals("slips.numbers");
  counts_ = state.integers("slips.counts");
}

void SlipStatistics::start() {
  std::fill_n(numbers_, drivers() * kQuantities * kNumbers, 0.0);
  std::fill_n(counts_, drivers() * (1 + kQuantities), 0);
}

void SlipStatistics::add(std::size_t driver, const Event& slip, double stiffness) {
  if (!parts_.window.contains(slip.time)) return;
  std::int64_t* count = counts_ + driver * (1 + kQuantities);
  double* number = numbers_ + driver * kQuantities * kNumbers;
  ++*count++;
  for (const double x : {slip.size, slip.peak_force, slip.energy_lost, stiffness}) {
    if (std::isfinite(x)) {
      ++*count;
      const double from_mean = x - number[kMean];
      number[kMean] += from_mean / static_cast<double>(*count);
      number[kSquares] += from_mean * (x - number[kMean]);
      number[kSmallest] = *count == 1 ? x : std::min(number[kSmallest], x);
      number[kLargest] = *count == 1 ? x : std::max(number[kLargest], x);
    }
    ++count;
    number += kNumbers;
  }
}

void SlipStatistics::add_rows(ResultGroup& group, std::size_t driver, bool looked_for) const {
  const std::int64_t* count = counts_ + driver * (1 + kQuantities);
  const double* number = numbers_ + driver * kQuantities * kNumbers;
  const bool over = looked_for && parts_.window.is_over();
  const auto value = [&](int quantity, double x, std::int64_t least) {
    return over && count[1 + quantity] >= least ? std::optional(x) : std::nullopt;
  };
  group.add(kSlips, over ? std::optional(static_cast<double>(*count)) : std::nullopt);
  for (int q = kLength; q <= kEnergy; ++q, number += kNumbers) {
    const SlipRows& rows = kRows[q];
    const double others = static_cast<double>(count[1 + q]) - 1.0;
    group.add(rows.mean, value(q, number[kMean], 1));
    group.add(rows.deviation, value(q, std::sqrt(number[kSquares] / others), 2));
    group.add(rows.smallest, value(q, number[kSmallest], 1));
    group.add(rows.largest, value(q, number[kLargest], 1));
  }
  group.add(kEffectiveStiffness, value(kStiffness, number[kMean], 1));
}

}  // namespace tomlin::observers
