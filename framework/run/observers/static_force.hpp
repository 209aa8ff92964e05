#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/run/events/events.hpp"
#include "framework/run/events/extremes.hpp"
#include "framework/run/observers/run_observer.hpp"

namespace tomlin::observers {

/// The static force of each driver: the largest force along its pull before the first slip, or of
/// the whole run. Of signals their power is looked at, the force along the pull times the speed.
class StaticForce {
 public:
  StaticForce(const ObserverParts& parts, const std::vector<DriverWatch>& watches);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  void start();
  /// Forces jump here: none lies between two that have been added.
  void break_off() { *seen_ = 0; }

  /// A driver has not slipped yet.
  bool any_open() const { return *open_ > 0; }
  /// Before slips of a step are looked for. The force of a driver while the point that it pulls
  /// slips is no static force; of a step in which a slip begins the maximum before it counts.
  void note_slipping();
  /// The start of a step of the grid. A maximum between three of them is that of the parabola
  /// through their powers.
  void add(double time, const double* signals);
  void add(const SignalSpan& span);
  /// The end of the run.
  void add_end(const double* signals);
  /// A driver has slipped: its speed has shown it after its peak, or it has slipped in no time from
  /// a force that was held.
  void slipped(const DriverWatch& watch, bool peak_is_known);
  void slipped(std::size_t driver, double held);

  std::optional<double> of(std::size_t driver) const;

 private:
  void include(std::size_t driver, double power) {
    if (settled_[driver] == 0 && power > height_[driver]) height_[driver] = power;
  }
  void include_maximum(const SignalSpan& span, std::size_t driver, double theta, double value);
  void settle(std::size_t driver);

  ObserverParts parts_;
  const std::vector<DriverWatch>& watches_;
  std::size_t drivers_;
  std::vector<bool> counts_;  ///< by driver: it does not slip
  // In the run's state, by driver: the largest power so far, those one and two steps ago, and
  // whether it has slipped.
  double* height_ = nullptr;
  double* last_ = nullptr;
  double* previous_ = nullptr;
  std::int64_t* settled_ = nullptr;
  double* times_ = nullptr;       ///< of the last and the previous powers
  std::int64_t* seen_ = nullptr;  ///< steps since forces have jumped, 2 at most
  std::int64_t* open_ = nullptr;  ///< drivers that have not slipped
};

}  // namespace tomlin::observers
