#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "framework/core/state_layout.hpp"
#include "framework/model/model.hpp"
#include "framework/run/run.hpp"

/// What happens in a run, seen from signals that are known at the ends of steps (and within long
/// ones). Between them goes the polynomial through the last five, so that a moment is found to the
/// fourth order in their distance and no step is altered.
namespace tomlin {

/// The polynomial through the last points of a signal.
class LastPoints {
 public:
  static constexpr std::size_t kMost = 5;
  static constexpr std::size_t kNumbers = 2 * kMost + 1;  ///< in the run state

  LastPoints() = default;
  explicit LastPoints(double* numbers) : numbers_(numbers) {}

  void clear() { numbers_[0] = 0.0; }
  void add(double time, double value);
  std::size_t count() const { return static_cast<std::size_t>(numbers_[0]); }
  /// Of the point `back` points ago, 0 being the last.
  double time(std::size_t back) const { return numbers_[1 + 2 * back]; }
  double value(std::size_t back) const { return numbers_[2 + 2 * back]; }

  double at(double time) const;
  double slope_at(double time) const;
  /// Where the value, or the slope, passes `level` between two times; the nearer end when it does
  /// not.
  double when_value_is(double level, double from, double to) const;
  double when_slope_is(double level, double from, double to) const;

 private:
  template <class Function>
  double root(Function function, double from, double to) const;

  double* numbers_ = nullptr;  ///< count, then time and value of each, the last one first
};

/// Slips and reversals of the point that a spring of steady speed pulls. Both follow from the
/// spring's force along the pull: the point's velocity is v - (dF/dt)/k.
///   slip      from the maximum of F before the point runs faster than ten times v to the last
///             moment at which it does, when it has been slower for a fiftieth of a period
///   reversal  from where its velocity along the pull turns negative to where it turns back
class DriverWatch {
 public:
  /// With `precision`, the unit roundoff of forces.
  DriverWatch(std::size_t driver, const Drive& drive, double period, double precision);

  static constexpr std::size_t kNumbers = LastPoints::kNumbers + 12;
  std::size_t driver() const { return driver_; }
  bool watches_slips() const { return period_ > 0.0; }
  void attach(double* numbers);
  void start();
  /// Its driver has turned round: what was going on is over.
  void turned() { start(); }

  using Emit = std::function<void(const Event&)>;
  /// Heat of the scene so far, but for a constant.
  using Heat = std::function<double()>;
  void add(double time, double force, const Emit& emit, const Heat& heat);
  /// The run is over: what is going on is reported as far as it got.
  void finish(double time, const Emit& emit);

 private:
  enum {
    kPeakTime,
    kPeakForce,
    kPeakHeat,
    kHasPeak,
    kSlips,
    kLastFast,
    kFast,
    kEndForce,
    kEndHeat,
    kBack,
    kBackTime,
    kBackForce
  };
  double way(double from, double force_from, double to, double force_to) const;
  void watch_slip(const Emit& emit, const Heat& heat);
  void watch_reversal(const Emit& emit);
  void emit_slip(const Emit& emit) const;

  std::size_t driver_;
  double speed_;
  double stiffness_;
  double period_;
  double precision_;
  LastPoints force_;
  double* numbers_ = nullptr;
};

/// Hops of a round body: its centre rises by more than a fifth of its radius above where it was
/// lowest since the last one, until it has come down as much. And whole turns of any body, counted
/// from its start.
class BodyWatch {
 public:
  BodyWatch(std::size_t body, double radius) : body_(body), radius_(radius) {}

  static constexpr std::size_t kNumbers = 2 * LastPoints::kNumbers + 6;
  std::size_t body() const { return body_; }
  bool watches_hops() const { return radius_ > 0.0; }
  void attach(double* numbers);
  void start();

  using Emit = DriverWatch::Emit;
  void add_height(double time, double height, const Emit& emit);
  void add_turns(double time, double turns, const Emit& emit);
  void finish(double time, const Emit& emit);

 private:
  enum { kRisen, kLow, kHigh, kSince, kStarted, kWhole };
  std::size_t body_;
  double radius_;
  LastPoints height_;
  LastPoints turns_;
  double* numbers_ = nullptr;
};

}  // namespace tomlin
