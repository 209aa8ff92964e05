#include "framework/cli/progress.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <unistd.h>

namespace tomlin {
namespace {

constexpr double kLogInterval = 10.0;       // seconds between lines
constexpr double kFirstLogBeforeRun = 2.0;  // seconds, of what comes before the run
constexpr std::chrono::milliseconds kRedrawInterval{500};

}  // namespace

std::string duration_text(double seconds) {
  constexpr double kLongest = 1e9;  // thirty years
  if (!(seconds < kLongest)) return "very long";
  const auto whole = static_cast<std::int64_t>(std::llround(std::max(seconds, 0.0)));
  const auto hours = whole / 3600;
  const auto minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

std::string progress_text(const RunProgress& progress) {
  const double fraction = std::clamp(progress.time / progress.duration, 0.0, 1.0);
  const double elapsed = progress.elapsed_seconds;
  const double remaining = elapsed * (progress.duration - progress.time) /
                           std::max(progress.time - progress.time_before, 0.0);
  const auto steps = static_cast<double>(progress.steps - progress.steps_before);
  const double rate = elapsed > 0.0 ? steps / elapsed : 0.0;
  return fmt::format("{} %, time {:.6g} of {:.6g}, {} elapsed, {} remaining, {:.2g} steps/s",
                     std::floor(100.0 * fraction), progress.time, progress.duration,
                     duration_text(elapsed), duration_text(remaining), rate);
}

ProgressLine::ProgressLine(Style style, std::string before)
    : style_(style),
      next_plain_(before.empty() ? kLogInterval : kFirstLogBeforeRun),
      before_(std::move(before)) {
  if (style == Style::plain) {
    log_ = std::make_shared<spdlog::logger>("tomlin",
                                            std::make_shared<spdlog::sinks::stderr_sink_mt>());
    log_->set_pattern("%n: %v");
    log_->flush_on(spdlog::level::info);
  }
  if (style != Style::silent && !before_.empty()) {
    thread_ = std::thread([this] { show_what_is_before(); });
  }
}

ProgressLine::~ProgressLine() { finish(); }

void ProgressLine::show_what_is_before() {
  using Clock = std::chrono::steady_clock;
  const auto started = Clock::now();
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kRedrawInterval, [this] { return begun_; })) {
    const std::chrono::duration<double> elapsed = Clock::now() - started;
    write(fmt::format("{}, {} elapsed", before_, duration_text(elapsed.count())), elapsed.count());
  }
}

void ProgressLine::end_what_is_before() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    begun_ = true;
  }
  changed_.notify_one();
  thread_.join();
  next_plain_ = kLogInterval;
}

void ProgressLine::show(const RunProgress& progress) {
  show(progress_text(progress), progress.elapsed_seconds);
}

void ProgressLine::show(const std::string& text, double elapsed_seconds) {
  if (style_ == Style::silent) return;
  end_what_is_before();
  write(text, elapsed_seconds);
}

void ProgressLine::write(const std::string& text, double elapsed_seconds) {
  if (style_ == Style::plain) {
    if (elapsed_seconds < next_plain_) return;
    next_plain_ = elapsed_seconds + kLogInterval;
    log_->info(text);
    return;
  }
  std::string line = "tomlin: " + text;
  const std::size_t width = line.size();
  if (width < width_) line.append(width_ - width, ' ');
  width_ = width;
  std::fputs(("\r" + line).c_str(), stderr);
  std::fflush(stderr);
}

void ProgressLine::finish() {
  end_what_is_before();
  if (style_ != Style::terminal || width_ == 0) return;
  std::fputs(("\r" + std::string(width_, ' ') + "\r").c_str(), stderr);
  std::fflush(stderr);
  width_ = 0;
}

ProgressLine::Style progress_style() {
  return ::isatty(STDERR_FILENO) != 0 ? ProgressLine::Style::terminal : ProgressLine::Style::plain;
}

}  // namespace tomlin
