#pragma once

#include <functional>

#include "framework/run/context.hpp"
#include "framework/run/window/steadiness.hpp"
#include "framework/run/window/window.hpp"

namespace tomlin {

/// [run] until: the window is one period of the driver after another, and the run ends where an
/// observable changes no more from one to the next.
class UntilSteady {
 public:
  /// Returns the results in the window that has just ended.
  using Measured = std::function<RunResult()>;
  UntilSteady(RunContext& run, MeasureWindow& window) : run_(run), window_(window) {}

  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// Before the first step. Throws InputError where the observable is none of the scene's.
  void start(const Measured& measured);
  /// A run has been resumed.
  void set_window();
  /// At the end of a period. True: another one begins.
  bool end_period(const Measured& measured);
  /// Warns where the run has ended before it is steady.
  void finish();
  SteadyResult result() const;

 private:
  const UntilSettings& settings() const { return *run_.scene->run.until; }

  RunContext& run_;
  MeasureWindow& window_;
  Steadiness steadiness_;
  double slowest_time_ = 0.0;  ///< of the scene, as far as it is known
};

}  // namespace tomlin
