#pragma once

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "framework/run/run.hpp"

namespace spdlog {
class logger;
}

namespace tomlin {

/// "0:12", "1:02:03"
std::string duration_text(double seconds);

/// "37 %, time 370 of 1000, 0:12 elapsed, 0:20 remaining, 3.1e+06 steps/s"
std::string progress_text(const RunProgress& progress);

/// Shows on standard error how far a run is: on a terminal one line, written again and again;
/// elsewhere a line now and then.
class ProgressLine {
 public:
  enum class Style { silent, terminal, plain };

  /// `before` names work before the first step that has no known end, such as a pilot; the name is
  /// shown with the time that the work has taken. "" stands for no such work.
  explicit ProgressLine(Style style, std::string before = "");
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const RunProgress& progress);
  /// Shows the progress of anything else that takes long.
  void show(const std::string& text, double elapsed_seconds);
  /// Clears the terminal's line.
  void finish();

 private:
  /// Until the run begins; a thread of its own.
  void show_what_is_before();
  void end_what_is_before();
  void write(const std::string& text, double elapsed_seconds);

  Style style_;
  std::shared_ptr<spdlog::logger> log_;  ///< for plain lines
  std::size_t width_ = 0;                ///< of what stands on the terminal's line
  double next_plain_ = 0.0;              ///< elapsed seconds at the next plain line
  std::string before_;
  bool begun_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;  ///< last: it uses the others
};

/// The style for standard error as it is.
ProgressLine::Style progress_style();

}  // namespace tomlin
