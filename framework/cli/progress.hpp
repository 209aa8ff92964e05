#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "framework/run/run.hpp"

namespace spdlog {
class logger;
}

namespace tomlin {

/// "37 %, time 370 of 1000, 0:12 elapsed, 0:20 remaining, 3.1e+06 steps/s"
std::string progress_text(const RunProgress& progress);

/// Shows on standard error how far a run is: on a terminal one line, written again and again;
/// elsewhere a line now and then.
class ProgressLine {
 public:
  enum class Style { silent, terminal, plain };

  explicit ProgressLine(Style style);

  void show(const RunProgress& progress);
  /// Clears the terminal's line.
  void finish();

 private:
  Style style_;
  std::shared_ptr<spdlog::logger> log_;  ///< for plain lines
  std::size_t width_ = 0;                ///< of what stands on the terminal's line
  double last_shown_ = 0.0;              ///< elapsed seconds at the last plain line
};

/// The style for standard error as it is.
ProgressLine::Style progress_style();

}  // namespace tomlin
