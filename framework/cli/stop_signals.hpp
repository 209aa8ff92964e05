#pragma once

#include <atomic>

namespace tomlin {

/// While this lives, the first SIGINT or SIGTERM asks the run to stop and leave its results, and so
/// does what batch systems and terminals send before they kill: SIGHUP, SIGUSR1, SIGXCPU. The
/// second one kills. A signal that is ignored, as under nohup, stays ignored. There is one at a
/// time. From then on failures to write are errors and no signals.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Set when the run is to stop.
  const std::atomic<bool>& stop() const;
  /// Stop for another reason.
  void request_stop();
  /// The signal that came; 0 when none did.
  int caught() const;
};

}  // namespace tomlin
