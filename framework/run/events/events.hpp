#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "framework/core/system/state_layout.hpp"
#include "framework/model/model.hpp"
#include "framework/run/run.hpp"

/// Events in a run, seen from signals that are known at the ends of steps (and within long ones).
/// Between them goes the polynomial through the last five, so that a moment is found to the
/// fourth order in their distance and no step is altered.
namespace tomlin {

/// The last points of a signal, and the polynomial through five of them.
class LastPoints {
 public:
  static constexpr std::size_t kMost = 5;
  static constexpr std::size_t kReals = 16;    ///< in the run state
  static constexpr std::size_t kIntegers = 1;  ///< in the run state

  LastPoints() = default;
  LastPoints(double* reals, std::int64_t* integers)
      : times_(reals), values_(reals + kRing), added_(integers) {}

  void clear() { *added_ = 0; }
  void add(double time, double value) {
    const std::size_t at = static_cast<std::size_t>((*added_)++) % kRing;
    times_[at] = time;
    values_[at] = value;
  }
  void add(const double* times, const double* values, std::size_t count) {
    const std::size_t last = count > kRing ? count - kRing : 0;
    *added_ += static_cast<std::int64_t>(last);
    for (std::size_t n = last; n < count; ++n) add(times[n], values[n]);
  }
  std::size_t count() const {
    return *added_ < static_cast<std::int64_t>(kMost) ? static_cast<std::size_t>(*added_) : kMost;
  }
  /// Time and value of the point `back` points ago, 0 being the last.
  double time(std::size_t back) const { return times_[index(back)]; }
  double value(std::size_t back) const { return values_[index(back)]; }

  double at(double time) const;
  double slope_at(double time) const;
  /// Returns when the value, or the slope, passes `level` between two times; the nearer end when it
  /// does not.
  double when_value_is(double level, double from, double to) const;
  double when_slope_is(double level, double from, double to) const;

 private:
  static constexpr std::size_t kRing = 8;
  std::size_t index(std::size_t back) const {
    return static_cast<std::size_t>(*added_ - 1 - static_cast<std::int64_t>(back)) % kRing;
  }
  template <class Function>
  double root(Function function, double from, double to) const;

  double* times_ = nullptr;
  double* values_ = nullptr;
  std::int64_t* added_ = nullptr;
};

/// Slips and reversals of the point that a spring of steady speed pulls. Both follow from the
/// spring's force along the pull: the point's velocity is v - (dF/dt)/k, where k is the same on all
/// axes of the pull; else from k times the stretch along it, with 1/k = sum over axes n_d^2/k_d.
///   slip      from the maximum of F before the point runs faster than ten times v to the last
///             moment at which it does, when it has been slower for a fiftieth of a period. Where
///             wells are known it ends in one, another than it began in; and from well to well at
///             any speed, when the point has come to less than half of v. What begins before the
///             driver has moved a tenth of a period relaxes from the start and is no slip. Of a
///             body that is held more strongly than its spring pulls it, but whose wells are not
///             known, also at any speed what moves the point by about half a period or more, until
///             it has come to less than half of v
///   reversal  from where its velocity along the pull turns negative to where it turns back
/// A point that noise acts on never comes to rest, and its velocity says nothing:
///   slip      where wells are known, from the largest force since the last slip to the moment at
///             which the point enters the well that it stays in. It passes through wells that it
///             leaves for the next one sooner than it would at ten times v. Its length is that to
///             the mean position while it stays; its heat is not known
/// and reversals are not looked for.
class DriverWatch {
 public:
  /// With `precision`, the unit roundoff of forces. Slips that the scheme reports are not
  /// detected.
  enum class Slips { detected, reported };
  DriverWatch(std::size_t driver, const Drive& drive, double period, double precision, Slips slips);

  static constexpr std::size_t kReals = 3 * LastPoints::kReals + 21;
  static constexpr std::size_t kIntegers = 3 * LastPoints::kIntegers + 10;
  /// The point has wells, a period apart, this far from where it is at the start, along the pull;
  /// they hold it against the spring.
  void set_wells(double offset) {
    busy_[kWells] = kKnownWells;
    numbers_[kWellOffset] = offset;
  }
  /// The point has wells that hold it against the spring, but where they are is not known.
  void set_unknown_wells() { busy_[kWells] = kUnknownWells; }
  /// Noise acts on the point.
  void set_noise() { noisy_ = true; }
  std::size_t driver() const { return driver_; }
  bool watches_slips() const { return period_ > 0.0; }
  /// Under noise only of a point that has wells.
  bool finds_slips() const { return watches_slips() && (!noisy_ || busy_[kWells] == kKnownWells); }
  /// Stiffness of the pull: its force over the displacement of the pulled point along it.
  double stiffness() const { return stiffness_; }
  /// By axis, where the springs of an oblique pull differ: stiffness() over theirs. Forces with
  /// these factors have the component along the pull that is stiffness() times the stretch along
  /// it. Empty where that is the force.
  const std::vector<double>& factors() const { return factors_; }
  double period() const { return period_; }
  bool slipping() const { return busy_[kSlipping] != 0; }
  /// When a slip is reported: the largest force of the peaks up to its own.
  double highest_peak() const { return numbers_[kHighest]; }
  void attach(double* reals, std::int64_t* integers);
  /// Forgets what was going on; wells are not counted any more.
  void start();
  /// Its driver has turned round: what was going on is over, and wells are counted along the new
  /// direction.
  void turned();
  using Emit = std::function<void(const Event&)>;
  /// Reports a slip under noise that the point has not yet stayed after, before its driver turns
  /// round or its forces become others.
  void close_slip(const Emit& emit) {
    if (noisy_ && slipping()) end_slip_of_noise(emit);
  }
  /// The point has come to rest after a slip: how steeply the force rises from here on.
  void look_for_stiffness(double time, double force);
  /// The largest slope of the force over the displacement of the support since the last slip
  /// that was reported, of chords over a twentieth of a period in which the point sticks
  /// throughout: it moves with the driver and more slowly. Minus infinity where there is none.
  double steepest() const { return numbers_[kSteepest]; }

  /// Heat of the scene so far, but for a constant, and when it was that.
  struct HeatAt {
    double time;
    double heat;
  };
  /// At the moment that is added, or the first one after it whose state is known.
  using Heat = std::function<HeatAt(double)>;
  /// Heat is known only at the ends of steps that are so long that it is looked at after each in
  /// which something happens.
  void set_long_steps() { long_steps_ = watches_slips(); }
  /// The force along the pull at one more moment. Mostly nothing happens: the point sticks, and the
  /// force rises no faster than the driver pulls.
  void add(double time, double force, const Emit& emit, const Heat& heat) {
    add(time, force, force, emit, heat);
  }
  /// Takes the force with the factors, where there are any, then the force itself.
  void add(double time, double force, double along, const Emit& emit, const Heat& heat) {
    const bool known = force_.count() >= 2;
    const double rise = known ? force - force_.value(0) : 0.0;
    const double pulled = known ? stiffness_ * speed_ * (time - force_.time(0)) : 0.0;
    if (force_.count() == 0) {
      if (busy_[kTurned] != 0) turn_wells(time, force);
      numbers_[kFirstTime] = time;
      numbers_[kFirstForce] = force;
      numbers_[kHighest] = along;
      busy_[kMoved] = busy_[kWells] != kNoWells ? 1 : 0;
    }
    force_.add(time, force);
    if (!factors_.empty()) along_.add(time, along);
    if (noisy_) {
      if (busy_[kWells] == kKnownWells) look_for_slip_of_noise(along, emit);
      return;
    }
    const bool sticks = rise > 0.0 && rise < pulled;
    if (!sticks) {
      restart_chord(time, along);
    } else if (time >= numbers_[kChordEnd]) {
      end_chord(time, along);
    }
    if (long_steps_ && !(sticks && rise > kStickingRisePart * pulled)) note_heat(heat);
    if (sticks && is_idle()) return;
    if (known) look(emit, heat);
  }
  /// Adds the points of a block one by one.
  void add_block(const double* times, const double* forces, std::size_t count, const Emit& emit,
                 const Heat& heat) {
    for (std::size_t n = sticking(times, forces, count); n < count; ++n) {
      add(times[n], forces[n], emit, heat);
    }
  }
  /// The run is over: what is going on is reported as far as it got.
  void finish(double time, const Emit& emit);

 private:
  /// Far from its maximum the force rises by more than this part of what the driver pulls.
  static constexpr double kStickingRisePart = 0.5;
  /// Values of busy_[kWells].
  static constexpr std::int64_t kNoWells = 0;
  static constexpr std::int64_t kKnownWells = 1;
  static constexpr std::int64_t kUnknownWells = 2;
  bool is_idle() const {
    return (busy_[kSlipping] | busy_[kBack] | busy_[kMoved] | busy_[kPeakOpen] | busy_[kEndOpen]) ==
           0;
  }
  /// Points of the force along the pull.
  const LastPoints& along() const { return factors_.empty() ? force_ : along_; }
  std::size_t sticking(const double* times, const double* forces, std::size_t count);
  void turn_wells(double time, double force);
  void begin_chord(double time, double force);
  void restart_chord(double time, double force);
  void end_chord(double time, double force);
  enum {
    kPeakTime,
    kPeakForce,
    kPeakAlong,  ///< the force along the pull
    kPeakHeat,
    kLastFast,
    kEndForce,
    kEndHeat,
    kBackTime,
    kBackForce,
    kFirstTime,  ///< of the first point since the start, from which wells are counted
    kFirstForce,
    kWellOffset,  ///< of a well from the first point
    kWell,        ///< the one that the point was in last; of unknown wells its position there
    kHighest,     ///< force along the pull of the peaks so far, the first point included
    kChordTime,
    kChordForce,
    kChordEnd,  ///< no sooner than this time; infinite where there is no chord
    kSteepest,  ///< slope of chords since the last slip
    kNoted,     ///< when heat was noted last
    kReached,   ///< under noise: the furthest well that the point has entered in a slip
    kStayed     ///< and the integral of its position over time since
  };
  /// kMoved: the force has fallen since the point was seen at rest in a well.
  /// kTurned: the driver has turned round since the last point.
  /// kPeakOpen, kEndOpen: their heat follows from points that are still to come.
  enum {
    kSlipping,
    kBack,
    kFast,
    kHasPeak,
    kMoved,
    kHasWell,
    kWells,
    kTurned,
    kPeakOpen,
    kEndOpen
  };
  double way(double from, double force_from, double to, double force_to) const;
  void look(const Emit& emit, const Heat& heat);
  void look_for_slip(const Emit& emit);
  void look_for_reversal(const Emit& emit);
  bool is_relaxation() const;
  double position_at(double time, double force) const;
  double position() const { return position_at(force_.time(0), force_.value(0)); }
  bool in_well(double& well) const;
  bool is_passage() const;
  void look_for_slip_of_noise(double along, const Emit& emit);
  void enter_well();
  void end_slip_of_noise(const Emit& emit);
  void look_for_passage(const Emit& emit, const Heat& heat);
  void emit_slip(const Emit& emit);
  void begin_heat(int which);
  void note_heat(const Heat& heat);
  void settle_heat();
  double heat_at(double time) const;

  std::size_t driver_;
  double speed_;
  double stiffness_;
  double period_;
  double precision_;
  Slips slips_;
  bool long_steps_ = false;
  bool noisy_ = false;
  std::vector<double> factors_;
  LastPoints force_;
  LastPoints along_;  ///< the force along the pull, where there are factors
  LastPoints heat_;   ///< near the peak and the end of a slip
  double* numbers_ = nullptr;
  std::int64_t* busy_ = nullptr;
};

/// Hops of a body that rolls: its centre rises by more than a fifth of its rolling radius above
/// where it was lowest since the last one, until it has come down as much. Where its outline is not
/// round, this is beyond the `rise` with which the centre follows the outline. And whole turns of
/// any body, counted from its start.
class BodyWatch {
 public:
  BodyWatch(std::size_t body, double radius, double rise = 0.0)
      : body_(body), radius_(radius), rise_(rise) {}

  static constexpr std::size_t kReals = 2 * LastPoints::kReals + 4;
  static constexpr std::size_t kIntegers = 2 * LastPoints::kIntegers + 2;
  std::size_t body() const { return body_; }
  bool watches_hops() const { return radius_ > 0.0; }
  void attach(double* reals, std::int64_t* integers);
  void start();

  using Emit = DriverWatch::Emit;
  void add_height(double time, double height, const Emit& emit) {
    height_.add(time, height);
    if (busy_[kRisen] == 0 && height >= numbers_[kLow] && height <= numbers_[kHigh]) return;
    look_for_hop(time, height, emit);
  }
  void add_turns(double time, double turns, const Emit& emit) {
    turns_.add(time, turns);
    const double since = turns - numbers_[kWhole];
    if (since > -kWholeTurn && since < kWholeTurn) return;
    look_for_turn(time, turns, emit);
  }
  void finish(double time, const Emit& emit);

 private:
  /// Rounding about a whole turn is no turn.
  static constexpr double kWholeTurn = 1.0 - 1e-9;
  enum { kLow, kHigh, kSince, kWhole };
  enum { kRisen, kStarted };
  void look_for_hop(double time, double height, const Emit& emit);
  void look_for_turn(double time, double turns, const Emit& emit);

  std::size_t body_;
  double radius_;
  double rise_;
  LastPoints height_;
  LastPoints turns_;
  /// Lowest position since the last hop, and from which on it is one; during a hop its highest.
  double* numbers_ = nullptr;
  std::int64_t* busy_ = nullptr;
};

}  // namespace tomlin
