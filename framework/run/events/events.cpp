#include "framework/run/events/events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/run/events/event_log.hpp"
#include "framework/run/steps/run_plan.hpp"

namespace tomlin {
namespace {

/// A slip is faster than so many times its driver. Smooth sliding near its threshold reaches a few.
constexpr double kSlipSpeedInDriverSpeeds = 10.0;
/// Between two slips the driver moves at least this part of a period: the swings after a slip
/// belong to it.
constexpr double kCalmWayInPeriods = 0.02;
/// A driver that has moved by less than this part of a period cannot have pulled anything over a
/// barrier: a spring softer than the wells (s > 1) holds until s / 2 pi, from an equilibrium.
constexpr double kLoadingWayInPeriods = 0.1;
/// A point is in a well within this part of a period from its bottom. A sinusoid turns concave at a
/// quarter; a spring holds the point a little beyond.
constexpr double kWellHalfWidthInPeriods = 0.3;
/// The driver moves by this part of a period along a chord: what is left of the swings after a slip
/// is small over it, and the slope of a sinusoidal well is that at its bottom to less than a
/// hundredth.
constexpr double kChordInPeriods = 0.05;
/// A point that moves by more than this part of a period is in another well, where wells are not
/// known. From its largest force to its lowest a tip passes half of the period of a weak substrate,
/// and more of that of a strong one; less is the passage of some of a body's particles, or a swing.
constexpr double kPassageInPeriods = 0.45;
/// Parts of the driver's speed: the point rests in a well, whose curvature is more than the
/// spring's.
constexpr double kRestingSpeedInDriverSpeeds = 0.5;
/// Parts of the driver's speed, and units of rounding, that are no motion backwards.
constexpr double kUnresolvedSpeedPart = 1e-3;
constexpr double kUnresolvedRoundings = 16.0;
constexpr double kHopInRadii = 0.2;
/// Points of heat after a moment, whose polynomial goes back to it.
constexpr std::size_t kPointsOfHeat = LastPoints::kMost;
constexpr int kMostHalvings = 60;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Event between(EventKind kind, double from, double to, double size) {
  Event event = event_of_kind(kind);
  event.time = from;
  event.duration = to - from;
  event.size = size;
  return event;
}

/// Stiffness of a pull: force over displacement where only the components along it count. Equal
/// stiffnesses of the axes are returned as they are, without rounding.
double stiffness_of_pull(const Drive& drive) {
  double squares = 0.0;
  double compliance = 0.0;
  double first = 0.0;
  bool equal = true;
  for (std::size_t d = 0; d < drive.stiffness.size(); ++d) {
    const double k = drive.stiffness[d];
    const double v = drive.velocity[d];
    if (v == 0.0 || !(k > 0.0)) continue;
    if (first == 0.0) first = k;
    equal = equal && k == first;
    squares += v * v;
    compliance += v * v / k;
  }
  return equal ? first : squares / compliance;
}

}  // namespace

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

/// Neville's scheme with derivatives.
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
  for (int k = 0; k < kMostHalvings; ++k) {
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

DriverWatch::DriverWatch(std::size_t driver, const Drive& drive, double period, double precision,
                         Slips slips)
    : driver_(driver),
      speed_(pull_speed_of(drive)),
      stiffness_(stiffness_of_pull(drive)),
      period_(period),
      precision_(precision),
      slips_(slips) {
  bool equal = true;
  for (std::size_t d = 0; d < drive.stiffness.size(); ++d) {
    const double k = drive.stiffness[d];
    factors_.push_back(k > 0.0 ? stiffness_ / k : 0.0);
    equal = equal && (drive.velocity[d] == 0.0 || !(k > 0.0) || k == stiffness_);
  }
  if (equal) factors_.clear();
}

void DriverWatch::attach(double* reals, std::int64_t* integers) {
  for (LastPoints* points : {&force_, &along_, &heat_}) {
    *points = LastPoints(std::exchange(reals, reals + LastPoints::kReals),
                         std::exchange(integers, integers + LastPoints::kIntegers));
  }
  numbers_ = reals;
  busy_ = integers;
}

void DriverWatch::start() {
  for (LastPoints* points : {&force_, &along_, &heat_}) points->clear();
  std::fill(numbers_, numbers_ + kReals - 3 * LastPoints::kReals, 0.0);
  std::fill(busy_, busy_ + kIntegers - 3 * LastPoints::kIntegers, 0);
  numbers_[kNoted] = -std::numeric_limits<double>::infinity();
  numbers_[kChordEnd] = std::numeric_limits<double>::infinity();
  numbers_[kSteepest] = -std::numeric_limits<double>::infinity();
}

void DriverWatch::turned() {
  const std::int64_t wells = busy_[kWells];
  const std::int64_t moved = force_.count() > 0 ? 1 : 0;
  const double time = numbers_[kFirstTime];
  const double force = numbers_[kFirstForce];
  const double offset = numbers_[kWellOffset];
  start();
  numbers_[kFirstTime] = time;
  numbers_[kFirstForce] = force;
  numbers_[kWellOffset] = moved != 0 ? offset : -offset;
  busy_[kWells] = wells;
  busy_[kTurned] = wells * moved;
}

/// At the first point after a turn, whose force is along the new direction. What lay ahead of it
/// lies behind.
void DriverWatch::turn_wells(double time, double force) {
  const double moved = way(numbers_[kFirstTime], numbers_[kFirstForce], time, -force);
  numbers_[kWellOffset] = std::remainder(moved - numbers_[kWellOffset], period_);
  busy_[kTurned] = 0;
}

void DriverWatch::look_for_stiffness(double time, double force) {
  numbers_[kSteepest] = -std::numeric_limits<double>::infinity();
  if (watches_slips()) begin_chord(time, force);
}

void DriverWatch::begin_chord(double time, double force) {
  numbers_[kChordTime] = time;
  numbers_[kChordForce] = force;
  numbers_[kChordEnd] = time + kChordInPeriods * period_ / speed_;
}

/// Swings after a slip, or in a well, show no stiffness: the chord begins again.
void DriverWatch::restart_chord(double time, double force) {
  if (std::isfinite(numbers_[kChordEnd])) begin_chord(time, force);
}

void DriverWatch::end_chord(double time, double force) {
  const double moved = speed_ * (time - numbers_[kChordTime]);
  numbers_[kSteepest] = std::max(numbers_[kSteepest], (force - numbers_[kChordForce]) / moved);
  begin_chord(time, force);
}

/// Displacement of the pulled point, along the pull.
double DriverWatch::way(double from, double force_from, double to, double force_to) const {
  return speed_ * (to - from) - (force_to - force_from) / stiffness_;
}

/// Takes in the points from the first of a block on in which the point sticks; returns how many.
std::size_t DriverWatch::sticking(const double* times, const double* forces, std::size_t count) {
  if (noisy_ || force_.count() < 2 || !is_idle() || !factors_.empty()) return 0;
  const double slope = stiffness_ * speed_;
  double time = force_.time(0);
  double force = force_.value(0);
  std::size_t n = 0;
  for (; n < count; ++n) {
    const double rise = forces[n] - force;
    if (!(rise > 0.0 && rise < slope * (times[n] - time))) break;
    time = times[n];
    force = forces[n];
  }
  force_.add(times, forces, n);
  if (n > 0 && times[n - 1] >= numbers_[kChordEnd]) {
    for (std::size_t k = 0; k < n; ++k) {
      if (times[k] >= numbers_[kChordEnd]) end_chord(times[k], forces[k]);
    }
  }
  return n;
}

void DriverWatch::look(const Emit& emit, const Heat& heat) {
  if (watches_slips() && slips_ == Slips::detected) {
    if (busy_[kWells] != 0 && force_.value(0) < force_.value(1)) busy_[kMoved] = 1;
    if (busy_[kSlipping] != 0) note_heat(heat);
    look_for_slip(emit);
    if (busy_[kMoved] != 0) look_for_passage(emit, heat);
    if (busy_[kPeakOpen] + busy_[kEndOpen] != 0) {
      note_heat(heat);
      if (long_steps_ || heat_.count() >= kPointsOfHeat) settle_heat();
    }
  }
  look_for_reversal(emit);
}

void DriverWatch::look_for_slip(const Emit& emit) {
  const double now = force_.time(0);
  const double f0 = force_.value(0);
  const double f1 = force_.value(1);
  const bool slipping = busy_[kSlipping] != 0;
  if (!slipping && f1 >= f0 && f1 > force_.value(2)) {
    numbers_[kPeakTime] = force_.when_slope_is(0.0, force_.time(2), now);
    numbers_[kPeakForce] = force_.at(numbers_[kPeakTime]);
    numbers_[kPeakAlong] = along().at(numbers_[kPeakTime]);
    begin_heat(kPeakOpen);
    numbers_[kHighest] = std::max(numbers_[kHighest], numbers_[kPeakAlong]);
    busy_[kHasPeak] = 1;
  }
  const double pulled = stiffness_ * speed_ * (now - force_.time(1));
  const bool fast = std::abs(pulled - (f0 - f1)) > kSlipSpeedInDriverSpeeds * pulled;
  if (fast) {
    if (!slipping) {
      // A run may start with one.
      if (busy_[kHasPeak] == 0) {
        numbers_[kPeakTime] = force_.time(1);
        numbers_[kPeakForce] = f1;
        numbers_[kPeakAlong] = along().value(1);
        begin_heat(kPeakOpen);
      }
      busy_[kSlipping] = 1;
    }
    busy_[kFast] = 1;
    numbers_[kLastFast] = now;
    return;
  }
  if (!slipping) return;
  if (busy_[kFast] != 0) {
    busy_[kFast] = 0;
    const bool forwards = f0 < f1;
    const double level = stiffness_ * speed_ *
                         (1.0 + (forwards ? -kSlipSpeedInDriverSpeeds : kSlipSpeedInDriverSpeeds));
    numbers_[kLastFast] = force_.when_slope_is(level, force_.time(2), now);
    numbers_[kEndForce] = force_.at(numbers_[kLastFast]);
    settle_heat();
    numbers_[kEndHeat] = heat_at(numbers_[kLastFast]);
  }
  if ((now - numbers_[kLastFast]) * speed_ < kCalmWayInPeriods * period_) return;
  const bool known = busy_[kWells] == kKnownWells;
  double well = position();
  if (known && !in_well(well)) return;  // on a barrier
  // A point that only swings in its well has not slipped, nor has one that came to its first well.
  const bool stayed = busy_[kHasWell] == 0 || well == numbers_[kWell];
  if (!(known && stayed) && !is_relaxation()) {
    emit_slip(emit);
    look_for_stiffness(now, along().value(0));
  }
  numbers_[kWell] = well;
  busy_[kHasWell] = busy_[kWells] != kNoWells ? 1 : 0;
  busy_[kSlipping] = busy_[kHasPeak] = 0;
}

/// A motion that begins before the driver has loaded its spring leads from the start to an
/// equilibrium, with swings about it: no driver has pulled the point there.
bool DriverWatch::is_relaxation() const {
  return (numbers_[kPeakTime] - numbers_[kFirstTime]) * speed_ < kLoadingWayInPeriods * period_;
}

/// The position of the point, in periods from the first well.
double DriverWatch::position_at(double time, double force) const {
  const double moved = way(numbers_[kFirstTime], numbers_[kFirstForce], time, force);
  return (moved - numbers_[kWellOffset]) / period_;
}

/// The well that the point is in, by its number from the start.
bool DriverWatch::in_well(double& well) const {
  const double here = position();
  well = std::nearbyint(here);
  return std::abs(here - well) < kWellHalfWidthInPeriods;
}

/// Whether the point has passed from one well to another at once, where wells are not known.
bool DriverWatch::is_passage() const {
  const double size =
      way(numbers_[kPeakTime], numbers_[kPeakForce], numbers_[kLastFast], numbers_[kEndForce]);
  return size > kPassageInPeriods * period_;
}

/// A point that has been in a well before does not slip to it again.
void DriverWatch::look_for_slip_of_noise(double along, const Emit& emit) {
  const double now = force_.time(0);
  const double here = position();
  if (busy_[kHasWell] == 0) {
    numbers_[kWell] = std::nearbyint(here);
    busy_[kHasWell] = 1;
  }
  if (busy_[kSlipping] == 0) {
    if (busy_[kHasPeak] == 0 || along > numbers_[kPeakAlong]) {
      numbers_[kPeakTime] = now;
      numbers_[kPeakForce] = force_.value(0);
      numbers_[kPeakAlong] = along;
      busy_[kHasPeak] = 1;
    }
    if (!(here >= numbers_[kWell] + 1.0 - kWellHalfWidthInPeriods)) return;
    busy_[kSlipping] = 1;
    numbers_[kReached] = numbers_[kWell];
    enter_well();
    return;
  }
  if (here >= numbers_[kReached] + 1.0 - kWellHalfWidthInPeriods) {
    enter_well();
    return;
  }
  const double before = position_at(force_.time(1), force_.value(1));
  numbers_[kStayed] += 0.5 * (before + here) * (now - force_.time(1));
  if ((now - numbers_[kLastFast]) * speed_ * kSlipSpeedInDriverSpeeds >= period_)
    end_slip_of_noise(emit);
}

/// Within the last step, on the straight line between its ends: noise leaves no smoother one.
void DriverWatch::enter_well() {
  const double now = force_.time(0);
  const double here = position();
  numbers_[kReached] = std::floor(here + kWellHalfWidthInPeriods);
  const double edge = numbers_[kReached] - kWellHalfWidthInPeriods;
  numbers_[kLastFast] = now;
  if (force_.count() > 1) {
    const double before = position_at(force_.time(1), force_.value(1));
    if (before < edge) {
      numbers_[kLastFast] = now - (now - force_.time(1)) * (here - edge) / (here - before);
    }
  }
  numbers_[kStayed] = 0.5 * (edge + here) * (now - numbers_[kLastFast]);
}

/// The point has stayed where it is. If this is where it was before, it has not slipped. What
/// begins before the driver has loaded its spring is relaxation.
void DriverWatch::end_slip_of_noise(const Emit& emit) {
  const double time = force_.time(0) - numbers_[kLastFast];
  const double stays_at = time > 0.0 ? numbers_[kStayed] / time : position();
  busy_[kSlipping] = 0;
  const double well = std::nearbyint(stays_at);
  if (!(well > numbers_[kWell])) return;
  numbers_[kWell] = well;
  busy_[kHasPeak] = 0;
  if ((numbers_[kLastFast] - numbers_[kFirstTime]) * speed_ < kLoadingWayInPeriods * period_)
    return;
  numbers_[kHighest] = std::max(numbers_[kHighest], numbers_[kPeakAlong]);
  Event slip = event_of_kind(EventKind::slip);
  slip.time = numbers_[kPeakTime];
  slip.duration = numbers_[kLastFast] - slip.time;
  slip.size = (stays_at - position_at(slip.time, numbers_[kPeakForce])) * period_;
  slip.peak_force = numbers_[kPeakAlong];
  emit(slip);
}

/// At rest in another well: a slip that no speed has shown, which has ended where the force was
/// lowest.
void DriverWatch::look_for_passage(const Emit& emit, const Heat& heat) {
  if (busy_[kSlipping] != 0) return;
  const double now = force_.time(0);
  const bool lowest =
      force_.count() > 2 && force_.value(1) <= force_.value(0) && force_.value(1) < force_.value(2);
  const auto end_here = [&] {
    numbers_[kLastFast] = force_.when_slope_is(0.0, force_.time(2), now);
    numbers_[kEndForce] = force_.at(numbers_[kLastFast]);
    begin_heat(kEndOpen);
  };
  if (lowest) end_here();
  if (force_.slope_at(now) < (1.0 - kRestingSpeedInDriverSpeeds) * stiffness_ * speed_) return;
  const bool known = busy_[kWells] == kKnownWells;
  double well = position();
  if (known && !in_well(well)) return;
  const bool first = busy_[kHasWell] == 0;
  const bool further = !first && well > numbers_[kWell] + (known ? 0.0 : kPassageInPeriods);
  if (further && busy_[kHasPeak] != 0) {
    if (!(numbers_[kLastFast] > numbers_[kPeakTime])) end_here();
    if ((known || is_passage()) && !is_relaxation()) {
      if (busy_[kPeakOpen] + busy_[kEndOpen] != 0) note_heat(heat);
      emit_slip(emit);
      look_for_stiffness(now, along().value(0));
    }
  }
  if (known || first || further) numbers_[kWell] = well;
  busy_[kHasWell] = 1;
  busy_[kMoved] = 0;
}

/// Heat at a moment that has just passed is asked for. Where steps are short, none is at hand from
/// before: the polynomial goes through the points that follow.
void DriverWatch::begin_heat(int which) {
  settle_heat();
  if (!long_steps_) heat_.clear();
  busy_[which] = 1;
}

void DriverWatch::note_heat(const Heat& heat) {
  const double now = force_.time(0);
  if (numbers_[kNoted] == now && heat_.count() > 0) return;
  if (force_.count() > 1 && numbers_[kNoted] < force_.time(1)) heat_.clear();
  const HeatAt here = heat(now);
  if (heat_.count() == 0 || here.time > heat_.time(0)) heat_.add(here.time, here.heat);
  numbers_[kNoted] = now;
}

void DriverWatch::settle_heat() {
  if (busy_[kPeakOpen] != 0) numbers_[kPeakHeat] = heat_at(numbers_[kPeakTime]);
  if (busy_[kEndOpen] != 0) numbers_[kEndHeat] = heat_at(numbers_[kLastFast]);
  busy_[kPeakOpen] = busy_[kEndOpen] = 0;
}

/// Not back beyond long steps.
double DriverWatch::heat_at(double time) const {
  if (heat_.count() == 0) return kUnknown;
  return heat_.at(long_steps_ ? std::max(time, heat_.time(heat_.count() - 1)) : time);
}

void DriverWatch::emit_slip(const Emit& emit) {
  settle_heat();
  Event slip;
  slip.kind = EventKind::slip;
  slip.time = numbers_[kPeakTime];
  slip.duration = numbers_[kLastFast] - slip.time;
  slip.size = way(slip.time, numbers_[kPeakForce], numbers_[kLastFast], numbers_[kEndForce]);
  slip.energy_lost = numbers_[kEndHeat] - numbers_[kPeakHeat];
  slip.peak_force = numbers_[kPeakAlong];
  emit(slip);
}

void DriverWatch::look_for_reversal(const Emit& emit) {
  const double interval = force_.time(0) - force_.time(1);
  const double f0 = force_.value(0);
  const double moved = way(force_.time(1), force_.value(1), force_.time(0), f0);
  const double noise = kUnresolvedSpeedPart * speed_ * interval +
                       kUnresolvedRoundings * precision_ * (std::abs(f0) / stiffness_);
  if (std::abs(moved) <= noise) return;
  const bool back = moved < 0.0;
  if (back == (busy_[kBack] != 0)) return;
  busy_[kBack] = back ? 1 : 0;
  const double at = force_.when_slope_is(stiffness_ * speed_, force_.time(2), force_.time(0));
  const double force = force_.at(at);
  if (back) {
    numbers_[kBackTime] = at;
    numbers_[kBackForce] = force;
    return;
  }
  emit(between(EventKind::reversal, numbers_[kBackTime], at,
               -way(numbers_[kBackTime], numbers_[kBackForce], at, force)));
}

void DriverWatch::finish(double time, const Emit& emit) {
  close_slip(emit);
  if (busy_[kSlipping] != 0 && !is_relaxation()) {
    if (busy_[kFast] != 0) {
      numbers_[kLastFast] = force_.time(0);
      numbers_[kEndForce] = force_.value(0);
      busy_[kEndOpen] = 0;
      numbers_[kEndHeat] = kUnknown;
    }
    emit_slip(emit);
  }
  if (busy_[kBack] == 0) return;
  emit(between(EventKind::reversal, numbers_[kBackTime], time,
               -way(numbers_[kBackTime], numbers_[kBackForce], force_.time(0), force_.value(0))));
}

void BodyWatch::attach(double* reals, std::int64_t* integers) {
  height_ = LastPoints(reals, integers);
  turns_ = LastPoints(reals + LastPoints::kReals, integers + LastPoints::kIntegers);
  numbers_ = reals + 2 * LastPoints::kReals;
  busy_ = integers + 2 * LastPoints::kIntegers;
}

void BodyWatch::start() {
  height_.clear();
  turns_.clear();
  std::fill(numbers_, numbers_ + kReals - 2 * LastPoints::kReals, 0.0);
  std::fill(busy_, busy_ + kIntegers - 2 * LastPoints::kIntegers, 0);
}

void BodyWatch::look_for_hop(double time, double y, const Emit& emit) {
  const double enough = kHopInRadii * radius_ + rise_;
  if (busy_[kStarted] == 0) {
    busy_[kStarted] = 1;
    numbers_[kLow] = y;
    numbers_[kHigh] = y + enough;
    return;
  }
  const double before = height_.time(1);
  if (busy_[kRisen] == 0) {
    if (y < numbers_[kLow]) {
      numbers_[kLow] = y;
      numbers_[kHigh] = y + enough;
      return;
    }
    busy_[kRisen] = 1;
    numbers_[kSince] = height_.when_value_is(numbers_[kHigh], before, time);
    numbers_[kHigh] = y;
    return;
  }
  numbers_[kHigh] = std::max(numbers_[kHigh], y);
  if (numbers_[kHigh] - y <= enough) return;
  const double down = height_.when_value_is(numbers_[kHigh] - enough, before, time);
  emit(between(EventKind::hop, numbers_[kSince], down, numbers_[kHigh] - numbers_[kLow]));
  busy_[kRisen] = 0;
  numbers_[kLow] = y;
  numbers_[kHigh] = y + enough;
}

void BodyWatch::look_for_turn(double time, double turns, const Emit& emit) {
  while (std::abs(turns - numbers_[kWhole]) >= kWholeTurn) {
    const double sign = turns > numbers_[kWhole] ? 1.0 : -1.0;
    numbers_[kWhole] += sign;
    const double before = turns_.count() > 1 ? turns_.time(1) : time;
    Event turn = event_of_kind(EventKind::turn);
    turn.time = turns_.when_value_is(numbers_[kWhole], before, time);
    turn.size = sign;
    emit(turn);
  }
}

void BodyWatch::finish(double time, const Emit& emit) {
  if (busy_[kRisen] == 0) return;
  emit(between(EventKind::hop, numbers_[kSince], time, numbers_[kHigh] - numbers_[kLow]));
}

}  // namespace tomlin
