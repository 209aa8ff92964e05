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
    rows_of("waiting_time", dimension::time, "time from one slip in the window to the next"),
};

const ResultQuantity kEffectiveStiffness{
    "effective_stiffness", dimension::stiffness, Shape::number, Scope::window,
    "mean over slips of the steepest slope of the force over the displacement of the support "
    "since the slip before: of spring and contact in series"};

}  // namespace

SlipStatistics::SlipStatistics(const ObserverParts& parts) : parts_(parts) {
  if (!has_noise(*parts.run.scene)) return;
  for (const Model::Driver& driver : parts.signals.drivers()) {
    for (int q = 0; q < kQuantities; ++q) {
      paths_.push_back("drivers." + driver.name + "." + mean_row(q).key);
    }
  }
  series_.resize(paths_.size());
  scratch_.assign(BlockedSeries::kBlocks, 0.0);
}

const ResultQuantity& SlipStatistics::mean_row(int quantity) {
  return quantity == kStiffness ? kEffectiveStiffness : kRows[quantity].mean;
}

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
  layout.add_reals("slips.last", drivers());
  layout.add_integers("slips.counts", drivers() * (1 + kQuantities));
  if (series_.empty()) return;
  declare_all(layout, "slips.series", series_);
}

void SlipStatistics::attach(RunState& state) {
  numbers_ = state.reals("slips.numbers");
  last_ = state.reals("slips.last");
  counts_ = state.integers("slips.counts");
  if (series_.empty()) return;
  attach_all(state, "slips.series", series_);
}

void SlipStatistics::start() {
  std::fill_n(numbers_, drivers() * kQuantities * kNumbers, 0.0);
  std::fill_n(counts_, drivers() * (1 + kQuantities), 0);
  for (BlockedSeries& one : series_) one.start();
}

void SlipStatistics::add(std::size_t driver, const Event& slip, double stiffness) {
  if (!parts_.window.contains(slip.time)) return;
  std::int64_t* count = counts_ + driver * (1 + kQuantities);
  double* number = numbers_ + driver * kQuantities * kNumbers;
  const double waited = *count > 0 ? slip.time - last_[driver] : std::nan("");
  last_[driver] = slip.time;
  ++*count++;
  // A run until an error has ended at that of the slips before.
  const bool counts = !series_.empty() && !(parts_.run.scene->run.until && parts_.window.is_over());
  std::size_t k = driver * kQuantities;
  for (const double x : {slip.size, slip.peak_force, slip.energy_lost, waited, stiffness}) {
    if (std::isfinite(x)) {
      if (counts) series_[k].add(x);
      ++*count;
      const double from_mean = x - number[kMean];
      number[kMean] += from_mean / static_cast<double>(*count);
      number[kSquares] += from_mean * (x - number[kMean]);
      number[kSmallest] = *count == 1 ? x : std::min(number[kSmallest], x);
      number[kLargest] = *count == 1 ? x : std::max(number[kLargest], x);
    }
    ++k;
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
  for (int q = kLength; q <= kWaiting; ++q, number += kNumbers) {
    const SlipRows& rows = kRows[q];
    const double others = static_cast<double>(count[1 + q]) - 1.0;
    group.add(rows.mean, value(q, number[kMean], 1));
    group.add(rows.deviation, value(q, std::sqrt(number[kSquares] / others), 2));
    group.add(rows.smallest, value(q, number[kSmallest], 1));
    group.add(rows.largest, value(q, number[kLargest], 1));
  }
  group.add(kEffectiveStiffness, value(kStiffness, number[kMean], 1));
}

void SlipStatistics::add_errors(ResultTable& table) const {
  if (!parts_.window.is_over()) return;
  for (std::size_t k = 0; k < series_.size(); ++k) {
    const std::size_t driver = k / kQuantities;
    const std::size_t quantity = k % kQuantities;
    const bool any = counts_[driver * (1 + kQuantities) + 1 + quantity] > 0;
    if (!any || !parts_.selection.wants(mean_row(static_cast<int>(quantity)).key)) continue;
    table.add_error(paths_[k], error_of(k));
  }
}

std::optional<double> SlipStatistics::error_so_far(std::string_view path) const {
  const auto found = std::find(paths_.begin(), paths_.end(), path);
  if (found == paths_.end()) return std::nullopt;
  return error_of(static_cast<std::size_t>(found - paths_.begin()));
}

std::optional<double> SlipStatistics::error_of(std::size_t series) const {
  return series_[series].mean(scratch_).error;
}

}  // namespace tomlin::observers
