#include "framework/run/events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tomlin {
namespace {

/// A slip is faster than so many times its driver. Smooth sliding near its threshold reaches a few.
constexpr double kFastFactor = 10.0;
/// Between two slips the driver moves at least this part of a period: the swings after a slip
/// belong to it.
constexpr double kCalmPart = 0.02;
/// Parts of the driver's speed, and units of rounding, that are no motion backwards.
constexpr double kNoMotion = 1e-3;
constexpr double kRoundings = 16.0;
constexpr double kHopPart = 0.2;
constexpr int kHalvings = 60;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double speed_of(const Drive& drive) {
  double square = 0.0;
  for (const double v : drive.velocity) square = std::fma(v, v, square);
  return std::sqrt(square);
}

}  // namespace

void LastPoints::add(double time, double value) {
  for (std::size_t k = kMost - 1; k > 0; --k) {
    numbers_[1 + 2 * k] = numbers_[2 * k - 1];
    numbers_[2 + 2 * k] = numbers_[2 * k];
  }
  numbers_[1] = time;
  numbers_[2] = value;
  if (numbers_[0] < static_cast<double>(kMost)) numbers_[0] += 1.0;
}

/// Neville's scheme.
double LastPoints::at(double t) const {
  double p[kMost];
  const std::size_t n = count();
  for (std::size_t k = 0; k < n; ++k) p[k] = value(k);
  for (std::size_t width = 1; width < n; ++width) {
    for (std::size_t k = 0; k + width < n; ++k) {
      const double a = time(k);
      const double b = time(k + width);
      p[k] = ((t - b) * p[k] - (t - a) * p[k + 1]) / (a - b);
    }
  }
  return p[0];
}

/// The same with derivatives.
double LastPoints::slope_at(double t) const {
  double p[kMost];
  double q[kMost] = {};
  const std::size_t n = count();
  for (std::size_t k = 0; k < n; ++k) p[k] = value(k);
  for (std::size_t width = 1; width < n; ++width) {
    for (std::size_t k = 0; k + width < n; ++k) {
      const double a = time(k);
      const double b = time(k + width);
      q[k] = (p[k] - p[k + 1] + (t - b) * q[k] - (t - a) * q[k + 1]) / (a - b);
      p[k] = ((t - b) * p[k] - (t - a) * p[k + 1]) / (a - b);
    }
  }
  return q[0];
}

template <class Function>
double LastPoints::root(Function function, double from, double to) const {
  double low = from;
  double high = to;
  double at_low = function(low);
  const double at_high = function(high);
  if ((at_low > 0.0) == (at_high > 0.0)) return std::abs(at_low) < std::abs(at_high) ? from : to;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    const double here = function(middle);
    if ((here > 0.0) == (at_low > 0.0)) {
      low = middle;
      at_low = here;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

double LastPoints::when_value_is(double level, double from, double to) const {
  return root([&](double t) { return at(t) - level; }, from, to);
}

double LastPoints::when_slope_is(double level, double from, double to) const {
  return root([&](double t) { return slope_at(t) - level; }, from, to);
}

DriverWatch::DriverWatch(std::size_t driver, const Drive& drive, double period, double precision)
    : driver_(driver),
      speed_(speed_of(drive)),
      stiffness_(drive.stiffness),
      period_(period),
      precision_(precision) {}

void DriverWatch::attach(double* numbers) {
  force_ = LastPoints(numbers);
  numbers_ = numbers + LastPoints::kNumbers;
}

void DriverWatch::start() {
  force_.clear();
  std::fill(numbers_, numbers_ + kNumbers - LastPoints::kNumbers, 0.0);
}

/// Of the pulled point, along the pull.
double DriverWatch::way(double from, double force_from, double to, double force_to) const {
  return speed_ * (to - from) - (force_to - force_from) / stiffness_;
}

void DriverWatch::add(double time, double force, const Emit& emit, const Heat& heat) {
  force_.add(time, force);
  if (force_.count() < 3) return;
  if (watches_slips()) watch_slip(emit, heat);
  watch_reversal(emit);
}

void DriverWatch::watch_slip(const Emit& emit, const Heat& heat) {
  const double now = force_.time(0);
  const double f0 = force_.value(0);
  const double f1 = force_.value(1);
  const bool slipping = numbers_[kSlips] != 0.0;
  if (!slipping && f1 >= f0 && f1 > force_.value(2)) {
    numbers_[kPeakTime] = force_.when_slope_is(0.0, force_.time(2), now);
    numbers_[kPeakForce] = force_.at(numbers_[kPeakTime]);
    numbers_[kPeakHeat] = heat();
    numbers_[kHasPeak] = 1.0;
  }
  const double interval = now - force_.time(1);
  const double scale = stiffness_ * speed_ * interval;
  const bool fast = std::abs(scale - (f0 - f1)) > kFastFactor * scale;
  if (fast) {
    if (!slipping) {
      // A run may start with one.
      if (numbers_[kHasPeak] == 0.0) {
        numbers_[kPeakTime] = force_.time(1);
        numbers_[kPeakForce] = f1;
        numbers_[kPeakHeat] = heat();
      }
      numbers_[kSlips] = 1.0;
    }
    numbers_[kFast] = 1.0;
    numbers_[kLastFast] = now;
    return;
  }
  if (!slipping) return;
  if (numbers_[kFast] != 0.0) {
    numbers_[kFast] = 0.0;
    const bool forwards = f0 < f1;
    const double level = stiffness_ * speed_ * (1.0 + (forwards ? -kFastFactor : kFastFactor));
    numbers_[kLastFast] = force_.when_slope_is(level, force_.time(2), now);
    numbers_[kEndForce] = force_.at(numbers_[kLastFast]);
    numbers_[kEndHeat] = heat();
  }
  if ((now - numbers_[kLastFast]) * speed_ < kCalmPart * period_) return;
  emit_slip(emit);
  numbers_[kSlips] = numbers_[kHasPeak] = 0.0;
}

void DriverWatch::emit_slip(const Emit& emit) const {
  Event slip;
  slip.kind = EventKind::slip;
  slip.time = numbers_[kPeakTime];
  slip.duration = numbers_[kLastFast] - slip.time;
  slip.size = way(slip.time, numbers_[kPeakForce], numbers_[kLastFast], numbers_[kEndForce]);
  slip.energy_lost = numbers_[kEndHeat] - numbers_[kPeakHeat];
  slip.peak_force = numbers_[kPeakForce];
  emit(slip);
}

void DriverWatch::watch_reversal(const Emit& emit) {
  const double interval = force_.time(0) - force_.time(1);
  const double f0 = force_.value(0);
  const double moved = speed_ * interval - (f0 - force_.value(1)) / stiffness_;
  const double noise =
      kNoMotion * speed_ * interval + kRoundings * precision_ * (std::abs(f0) / stiffness_);
  if (std::abs(moved) <= noise) return;
  const bool back = moved < 0.0;
  if (back == (numbers_[kBack] != 0.0)) return;
  numbers_[kBack] = back ? 1.0 : 0.0;
  const double at = force_.when_slope_is(stiffness_ * speed_, force_.time(2), force_.time(0));
  const double force = force_.at(at);
  if (back) {
    numbers_[kBackTime] = at;
    numbers_[kBackForce] = force;
    return;
  }
  Event reversal;
  reversal.kind = EventKind::reversal;
  reversal.time = numbers_[kBackTime];
  reversal.duration = at - reversal.time;
  reversal.size = -way(reversal.time, numbers_[kBackForce], at, force);
  reversal.energy_lost = reversal.peak_force = kNone;
  emit(reversal);
}

void DriverWatch::finish(double time, const Emit& emit) {
  if (force_.count() == 0) return;
  if (numbers_[kSlips] != 0.0) {
    if (numbers_[kFast] != 0.0) {
      numbers_[kLastFast] = force_.time(0);
      numbers_[kEndForce] = force_.value(0);
      numbers_[kEndHeat] = kNone;
    }
    emit_slip(emit);
  }
  if (numbers_[kBack] == 0.0) return;
  Event reversal;
  reversal.kind = EventKind::reversal;
  reversal.time = numbers_[kBackTime];
  reversal.duration = time - reversal.time;
  reversal.size = -way(reversal.time, numbers_[kBackForce], force_.time(0), force_.value(0));
  reversal.energy_lost = reversal.peak_force = kNone;
  emit(reversal);
}

void BodyWatch::attach(double* numbers) {
  height_ = LastPoints(numbers);
  turns_ = LastPoints(numbers + LastPoints::kNumbers);
  numbers_ = numbers + 2 * LastPoints::kNumbers;
}

void BodyWatch::start() {
  height_.clear();
  turns_.clear();
  std::fill(numbers_, numbers_ + kNumbers - 2 * LastPoints::kNumbers, 0.0);
}

void BodyWatch::add_height(double time, double y, const Emit& emit) {
  height_.add(time, y);
  if (numbers_[kStarted] == 0.0) {
    numbers_[kStarted] = 1.0;
    numbers_[kLow] = y;
    return;
  }
  const double enough = kHopPart * radius_;
  const double before = height_.time(1);
  if (numbers_[kRisen] == 0.0) {
    numbers_[kLow] = std::min(numbers_[kLow], y);
    if (y - numbers_[kLow] <= enough) return;
    numbers_[kRisen] = 1.0;
    numbers_[kHigh] = y;
    numbers_[kSince] = height_.when_value_is(numbers_[kLow] + enough, before, time);
    return;
  }
  numbers_[kHigh] = std::max(numbers_[kHigh], y);
  if (numbers_[kHigh] - y <= enough) return;
  Event hop;
  hop.kind = EventKind::hop;
  hop.time = numbers_[kSince];
  hop.duration = height_.when_value_is(numbers_[kHigh] - enough, before, time) - hop.time;
  hop.size = numbers_[kHigh] - numbers_[kLow];
  hop.energy_lost = hop.peak_force = kNone;
  numbers_[kRisen] = 0.0;
  numbers_[kLow] = y;
  emit(hop);
}

void BodyWatch::add_turns(double time, double turns, const Emit& emit) {
  turns_.add(time, turns);
  // Rounding about a whole turn is no turn.
  constexpr double kSlack = 1e-9;
  while (std::abs(turns - numbers_[kWhole]) >= 1.0 - kSlack) {
    const double sign = turns > numbers_[kWhole] ? 1.0 : -1.0;
    numbers_[kWhole] += sign;
    Event turn;
    turn.kind = EventKind::turn;
    const double before = turns_.count() > 1 ? turns_.time(1) : time;
    turn.time = turns_.when_value_is(numbers_[kWhole], before, time);
    turn.size = sign;
    turn.duration = turn.energy_lost = turn.peak_force = kNone;
    emit(turn);
  }
}

void BodyWatch::finish(double time, const Emit& emit) {
  if (numbers_[kRisen] == 0.0) return;
  Event hop;
  hop.kind = EventKind::hop;
  hop.time = numbers_[kSince];
  hop.duration = time - hop.time;
  hop.size = numbers_[kHigh] - numbers_[kLow];
  hop.energy_lost = hop.peak_force = kNone;
  emit(hop);
}

}  // namespace tomlin
