#include "framework/run/observers/path_peaks.hpp"

#include <algorithm>
#include <limits>

#include "framework/run/extremes.hpp"
#include "framework/run/plan.hpp"

namespace tomlin::observers {

void PathPeaks::declare(StateLayout& layout) const {
  layout.add_reals("events.peaks", signals_.drivers().size());
}

void PathPeaks::attach(RunState& state) { peaks_ = state.reals("events.peaks"); }

void PathPeaks::clear() {
  std::fill_n(peaks_, signals_.drivers().size(), -std::numeric_limits<double>::infinity());
}

void PathPeaks::add(const SignalSpan& span) {
  const auto& drivers = signals_.drivers();
  for (std::size_t k = 0; k < drivers.size(); ++k) {
    if (!drags(*drivers[k].drive)) continue;
    double powers[4];
    for (std::size_t n = 0; n < 4; ++n) powers[n] = signals_.power(k, span.at[n].data());
    const CubicExtremes found = cubic_extremes(powers[0], powers[1], powers[2], powers[3]);
    const auto include = [&](double power) {
      peaks_[k] = std::max(peaks_[k], power * signals_.along(k));
    };
    for (const double power : powers) include(power);
    for (int e = 0; e < found.count; ++e) include(found.value[e]);
  }
}

}  // namespace tomlin::observers
