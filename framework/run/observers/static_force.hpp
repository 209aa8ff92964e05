#pragma once

#include <memory>
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
  void declare(StateLayout& layout) const {
    StaticForces::declare(layout, parts_.signals.drivers().size());
  }
  void attach(RunState& state) { forces_.attach(state, parts_.signals.drivers().size()); }
  void start() { forces_.start(); }
  /// Forces jump here: none lies between two that have been added.
  void break_off() { forces_.break_off(); }

  bool any_open() const { return forces_.any_open(); }
  /// Before slips of a step are looked for. What a driver holds while what it pulls slips is no
  /// static force; of a step in which a slip begins the maximum before it counts.
  void note_slipping();
  /// The start of a step of the grid.
  void add(double time, const double* signals);
  void add(const SignalSpan& span);
  /// The end of the run.
  void add_end(const double* signals);
  /// A slip that a speed has told of, after its peak; or one in no time from a force that was held.
  void slipped(const DriverWatch& watch, bool peak_is_known);
  void slipped(std::size_t driver, double held);

  std::optional<double> of(std::size_t driver) const;

 private:
  void include_maximum(const SignalSpan& span, std::size_t driver, double theta, double value);

  ObserverParts parts_;
  const std::vector<DriverWatch>& watches_;
  StaticForces forces_;
  std::unique_ptr<bool[]> counts_;  ///< by driver: it does not slip
  std::vector<double> powers_;
};

}  // namespace tomlin::observers
