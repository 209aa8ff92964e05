#pragma once

#include <cstddef>

#include "framework/run/observer.hpp"

namespace tomlin::observers {

/// Of a quasistatic run: the largest force along each driver's pull since the last slip, in the
/// run's state.
class PathPeaks {
 public:
  explicit PathPeaks(const Signals& signals) : signals_(signals) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);

  /// After a slip, and where a force has changed.
  void clear();
  /// Includes the extremes of the cubics through the four places of a step.
  void add(const SignalSpan& span);
  double of(std::size_t driver) const { return peaks_[driver]; }

 private:
  const Signals& signals_;
  double* peaks_ = nullptr;
};

}  // namespace tomlin::observers
