#pragma once

#include <cstdint>
#include <string>

#include "framework/run/context.hpp"
#include "framework/run/results/observation.hpp"

namespace tomlin {

/// [run] until = { error = ..., of = ... }: the run ends, and with it the window, as soon as the
/// statistical error of a mean is as small as asked.
///
/// It is looked at in the blocks of steps in which parts of the window end (part_of_window), so
/// that the window is a whole number of the driver's periods but for a block: after 50 parts and
/// from there on whenever the window has grown by a thirty-second to a sixty-fourth of its length.
/// Fewer looks make it rarer that a run ends at an error that is small by chance, and cost nothing.
class UntilError {
 public:
  UntilError(RunContext& run, Observation& observation);
  /// Before the first step, with the paths of results. Throws InputError where the mean has no
  /// statistical error.
  void start(const RunResult& before);
  /// At the end of a block of steps.
  void look();
  /// Warns where the run has ended before.
  void finish();
  UntilErrorResult result() const;

 private:
  const UntilSettings& settings() const { return *run_.scene->run.until; }
  std::int64_t parts_at(std::int64_t grid_step) const;

  RunContext& run_;
  Observation& observation_;
  std::string path_;   ///< of the mean, in full
  double part_ = 0.0;  ///< of the window, a time
  bool reached_ = false;
};

}  // namespace tomlin
