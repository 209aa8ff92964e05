#include "framework/run/observers/static_force.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "framework/run/steps/run_plan.hpp"

namespace tomlin::observers {

StaticForce::StaticForce(const ObserverParts& parts, const std::vector<DriverWatch>& watches)
    : parts_(parts),
      watches_(watches),
      drivers_(parts.signals.drivers().size()),
      counts_(drivers_) {}

void StaticForce::declare(StateLayout& layout) const {
  layout.add_reals("static_force.height", drivers_);
  layout.add_reals("static_force.last", drivers_);
  layout.add_reals("static_force.previous", drivers_);
  layout.add_reals("static_force.times", 2);
  layout.add_integers("static_force.settled", drivers_);
  layout.add_integers("static_force.counts", 2);
}

void StaticForce::attach(RunState& state) {
  height_ = state.reals("static_force.height");
  last_ = state.reals("static_force.last");
  previous_ = state.reals("static_force.previous");
  times_ = state.reals("static_force.times");
  settled_ = state.integers("static_force.settled");
  seen_ = state.integers("static_force.counts");
  open_ = seen_ + 1;
}

void StaticForce::start() {
  *open_ = static_cast<std::int64_t>(drivers_);
  std::fill_n(height_, drivers_, -std::numeric_limits<double>::max());
}

void StaticForce::settle(std::size_t driver) {
  if (std::exchange(settled_[driver], 1) == 0) --*open_;
}

void StaticForce::note_slipping() {
  counts_.assign(drivers_, true);
  for (const DriverWatch& watch : watches_) counts_[watch.driver()] = !watch.slipping();
}

void StaticForce::add(double time, const double* signals) {
  for (std::size_t k = 0; k < drivers_; ++k) {
    const double y = parts_.signals.power(k, signals);
    if (counts_[k]) include(k, y);
    if (counts_[k] && *seen_ >= 2 && last_[k] > previous_[k] && last_[k] >= y) {
      include(k, parabola_vertex(times_[1], previous_[k], times_[0], last_[k], time, y));
    }
    previous_[k] = last_[k];
    last_[k] = y;
  }
  times_[1] = times_[0];
  times_[0] = time;
  if (*seen_ < 2) ++*seen_;
}

void StaticForce::add(const SignalSpan& span) {
  if (!any_open()) return;
  for (std::size_t k = 0; k < drivers_; ++k) {
    double powers[4];
    for (std::size_t n = 0; n < 4; ++n) powers[n] = parts_.signals.power(k, span.at[n].data());
    if (counts_[k]) {
      for (const std::size_t end : {0, 3}) include(k, powers[end]);
    }
    const CubicExtremes found = cubic_extremes(powers[0], powers[1], powers[2], powers[3]);
    for (int e = 0; e < found.count; ++e) {
      if (found.is_maximum[e]) include_maximum(span, k, found.theta[e], found.value[e]);
    }
  }
}

/// A maximum of the power that the cubic has, refined as extremes are.
void StaticForce::include_maximum(const SignalSpan& span, std::size_t driver, double theta,
                                  double value) {
  if (settled_[driver] != 0 || !counts_[driver]) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const std::vector<double>& signals : span.at) {
    const double power = parts_.signals.power(driver, signals.data());
    low = std::min(low, power);
    high = std::max(high, power);
  }
  if (span.is_dense && value + kNearLargest * (high - low) >= height_[driver]) {
    value = span.extreme_near(
        theta, [&](const double* signals) { return parts_.signals.power(driver, signals); });
  }
  include(driver, value);
}

void StaticForce::add_end(const double* signals) {
  for (std::size_t k = 0; k < drivers_; ++k) {
    if (counts_[k]) include(k, parts_.signals.power(k, signals));
  }
}

/// Once a driver has turned back its force is along another direction.
void StaticForce::slipped(const DriverWatch& watch, bool peak_is_known) {
  const std::size_t k = watch.driver();
  const double along = parts_.signals.along(k);
  // Larger forces until the slip was known do not count.
  if (peak_is_known && along > 0.0 && settled_[k] == 0) {
    height_[k] = watch.highest_peak() / along;
  }
  settle(k);
}

void StaticForce::slipped(std::size_t driver, double held) {
  include(driver, held);
  settle(driver);
}

std::optional<double> StaticForce::of(std::size_t driver) const {
  const Drive& drive = *parts_.signals.drivers()[driver].drive;
  const bool any = height_[driver] > -std::numeric_limits<double>::max();
  if (!drags(drive) || !any) return {};
  return height_[driver] / pull_speed_of(drive);
}

}  // namespace tomlin::observers
