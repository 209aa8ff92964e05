#include "framework/run/observers/static_force.hpp"

#include <algorithm>
#include <limits>

#include "framework/run/steps/run_plan.hpp"

namespace tomlin::observers {

StaticForce::StaticForce(const ObserverParts& parts, const std::vector<DriverWatch>& watches)
    : parts_(parts),
      watches_(watches),
      counts_(std::make_unique<bool[]>(parts.signals.drivers().size())),
      powers_(parts.signals.drivers().size()) {}

void StaticForce::note_slipping() {
  std::fill_n(counts_.get(), powers_.size(), true);
  for (const DriverWatch& watch : watches_) counts_[watch.driver()] = !watch.slipping();
}

void StaticForce::add(double time, const double* signals) {
  for (std::size_t k = 0; k < powers_.size(); ++k) powers_[k] = parts_.signals.power(k, signals);
  forces_.add(time, powers_.data(), counts_.get());
}

void StaticForce::add(const SignalSpan& span) {
  if (!any_open()) return;
  for (std::size_t k = 0; k < powers_.size(); ++k) {
    double powers[4];
    for (std::size_t n = 0; n < 4; ++n) powers[n] = parts_.signals.power(k, span.at[n].data());
    if (counts_[k]) {
      for (const std::size_t end : {0, 3}) forces_.include(k, powers[end]);
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
  if (!forces_.open(driver) || !counts_[driver]) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const std::vector<double>& signals : span.at) {
    const double power = parts_.signals.power(driver, signals.data());
    low = std::min(low, power);
    high = std::max(high, power);
  }
  if (span.is_dense && value + kNearLargest * (high - low) >= forces_.value(driver)) {
    value = span.extreme_near(
        theta, [&](const double* signals) { return parts_.signals.power(driver, signals); });
  }
  forces_.include(driver, value);
}

void StaticForce::add_end(const double* signals) {
  for (std::size_t k = 0; k < powers_.size(); ++k) {
    if (counts_[k]) forces_.include(k, parts_.signals.power(k, signals));
  }
}

/// Once a driver has turned back its force is along another direction.
void StaticForce::slipped(const DriverWatch& watch, bool peak_is_known) {
  const std::size_t k = watch.driver();
  const double along = parts_.signals.along(k);
  if (peak_is_known && along > 0.0) {
    forces_.settle(k, watch.highest_peak() / along);
  } else {
    forces_.settle(k);
  }
}

void StaticForce::slipped(std::size_t driver, double held) {
  forces_.include(driver, held);
  forces_.settle(driver);
}

std::optional<double> StaticForce::of(std::size_t driver) const {
  const Drive& drive = *parts_.signals.drivers()[driver].drive;
  if (!drags(drive) || !forces_.any(driver)) return {};
  return forces_.value(driver) / pull_speed_of(drive);
}

}  // namespace tomlin::observers
