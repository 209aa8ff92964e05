#include "framework/study/sweep/runner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/observables.hpp"
#include "framework/study/accuracy.hpp"
#include "framework/study/methods.hpp"
#include "framework/study/sweep/line_end.hpp"
#include "framework/study/sweep/point_checkpoint.hpp"
#include "framework/study/sweep/trace.hpp"

namespace tomlin {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

SweepRow row_without_numbers(const SweepPlan& plan, SweepStatus status, std::string reason) {
  SweepRow row;
  row.status = status;
  row.numbers.assign(plan.columns().size(), kNoNumber);
  row.reason = std::move(reason);
  return row;
}

std::optional<double> number_of(const RunResult& result, SweepColumn::Kind kind,
                                const std::string& path) {
  switch (kind) {
    case SweepColumn::Kind::value:
      return observable(result, path);
    case SweepColumn::Kind::error:
      for (const ErrorEstimate& estimate : result.errors) {
        if (estimate.path == path) return estimate.error;
      }
      return std::nullopt;
    case SweepColumn::Kind::spread:
      for (const DeterminedResult& one : result.determined) {
        if (full_path(result, one.path) == path) return one.spread;
      }
      return std::nullopt;
  }
  return std::nullopt;
}

SweepRow row_of(const SweepPlan& plan, const RunResult& result) {
  SweepRow row = row_without_numbers(plan, SweepStatus::finished, "");
  for (const Warning& warning : result.warnings) {
    row.warnings.set(static_cast<std::size_t>(warning.code));
  }
  if (result.failure) {
    row.status = SweepStatus::failed;
    row.reason = to_string(*result.failure);
    return row;
  }
  for (std::size_t k = 0; k < plan.columns().size(); ++k) {
    const SweepColumn& column = plan.columns()[k];
    const auto number = number_of(result, column.kind, plan.paths()[column.observable]);
    if (number && std::isfinite(*number)) row.numbers[k] = *number;
  }
  return row;
}

RunResult resumed(const std::shared_ptr<const Scene>& scene, RunOptions options,
                  PointCheckpoint& checkpoint) {
  options.sink = &checkpoint;
  options.store = &checkpoint;
  if (!checkpoint.state().empty()) {
    options.resume_from = &checkpoint.state();
    try {
      return run(scene, options);
    } catch (const std::invalid_argument&) {
      options.resume_from = nullptr;  // of a program with other numbers in its state
    }
  }
  return run(scene, options);
}

/// The threads of a sweep and what they have done.
class SweepWork {
 public:
  SweepWork(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options)
      : plan_(plan), rows_(rows), options_(options), queue_(plan, rows, options.part) {
    progress_.points = options.part.size(plan.points());
    progress_.traces_left = options.traced.size();
    for (std::size_t k = 0; k < plan.points(); ++k) {
      progress_.before += options.part.has(k) && rows.has(k) ? 1 : 0;
    }
  }

  SweepProgress run() {
    const std::size_t left = progress_.points - progress_.before + options_.traced.size();
    const auto count = std::clamp<std::size_t>(options_.threads, 1, std::max<std::size_t>(1, left));
    running_ = count;
    std::vector<std::thread> threads;
    try {
      while (threads.size() < count) threads.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      // The system gives no more of them: fewer take longer.
      if (threads.empty()) throw;
      const std::lock_guard lock(mutex_);
      running_ -= count - threads.size();
    }
    watch();
    for (std::thread& thread : threads) thread.join();
    if (error_) std::rethrow_exception(error_);
    progress_.seconds = elapsed();
    return progress_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kLookEvery{20};
  static constexpr std::chrono::milliseconds kShowEvery{500};

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

  void work() {
    try {
      while (!halt_) {
        const std::vector<std::size_t> points = queue_.take(1);
        if (points.empty()) break;
        if (plan_.line() > 1 ? !run_line(points) : !run_alone(points.front())) break;
      }
      trace();
    } catch (...) {
      halt_ = true;
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    ended_.notify_one();
  }

  /// False where it was stopped.
  bool run_alone(std::size_t point) {
    const auto row = run_point(plan_, point, &halt_, options_.folder);
    if (row) keep(point, *row);
    return row.has_value();
  }

  /// These points of a line, and again those before them whose end is not known any more. False
  /// where it was stopped.
  bool run_line(const std::vector<std::size_t>& points) {
    const std::size_t first = points.front() / plan_.line() * plan_.line();
    LineEnd end(plan_, first, points.front(), options_.folder);
    for (std::size_t point = end.next();; point = end.next()) {
      FinalState state;
      const auto row = run_from(end.before(), point, state);
      if (!row) {
        end.write();
        return false;
      }
      const bool is_last = point == points.back();
      if (is_last) end.remove();
      if (std::binary_search(points.begin(), points.end(), point)) keep(point, *row);
      if (is_last) return true;
      end.pass(std::move(state));
    }
  }

  std::optional<SweepRow> run_from(const FinalState* before, std::size_t point, FinalState& end) {
    if (before != nullptr && !before->known()) {
      return row_without_numbers(
          plan_, SweepStatus::refused,
          fmt::format("the point before it, row {}, has not finished and left no end to start from",
                      point - 1));
    }
    return run_point(plan_, point, &halt_, options_.folder, before, &end);
  }

  void keep(std::size_t point, const SweepRow& row) {
    rows_.keep(point, row);
    if (!options_.folder.empty()) {
      PointCheckpoint::remove(PointCheckpoint::file_of(options_.folder, point));
    }
    const std::lock_guard lock(mutex_);
    ++progress_.done[static_cast<std::size_t>(row.status)];
  }

  /// The traces that no other thread has begun.
  void trace() {
    while (!halt_) {
      const std::size_t k = traces_begun_++;
      if (k >= options_.traced.size()) return;
      const std::size_t point = options_.traced[k];
      if (!trace_point(plan_, point, options_.folder / fmt::format("{}", point), &halt_)) return;
      const std::lock_guard lock(mutex_);
      --progress_.traces_left;
    }
  }

  /// Until all threads have ended.
  void watch() {
    std::unique_lock lock(mutex_);
    auto next_shown = started_ + kShowEvery;
    while (!ended_.wait_for(lock, kLookEvery, [this] { return running_ == 0; })) {
      if (options_.stop != nullptr && options_.stop->load()) halt_ = true;
      if (!options_.on_progress || Clock::now() < next_shown) continue;
      next_shown = Clock::now() + kShowEvery;
      SweepProgress now = progress_;
      now.seconds = elapsed();
      lock.unlock();
      options_.on_progress(now);
      lock.lock();
    }
  }

  const SweepPlan& plan_;
  SweepRows& rows_;
  const SweepOptions& options_;
  SweepQueue queue_;
  Clock::time_point started_ = Clock::now();
  std::atomic<bool> halt_ = false;
  std::atomic<std::size_t> traces_begun_ = 0;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t running_ = 0;  ///< threads
  SweepProgress progress_;
  std::exception_ptr error_;  ///< the first
};

}  // namespace

std::vector<std::size_t> SweepQueue::take(std::size_t most) {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> taken;
  while (next_ < points_ && taken.size() < most) {
    for (const std::size_t end = next_ + line_; next_ < end; ++next_) {
      if (part_.has(next_) && !rows_.has(next_)) taken.push_back(next_);
    }
  }
  return taken;
}

std::size_t SweepProgress::with_row() const {
  return std::accumulate(done.begin(), done.end(), before);
}

std::optional<SweepRow> run_point(const SweepPlan& plan, std::size_t point,
                                  const std::atomic<bool>* stop,
                                  const std::filesystem::path& checkpoints,
                                  const FinalState* start_from, FinalState* final_state) {
  try {
    const auto scene = plan.scene_at(point);
    RunOptions options;
    options.stop = stop;
    options.observables = plan.paths();
    options.start_from = start_from;
    options.final_state = final_state;
    std::optional<PointCheckpoint> checkpoint;
    if (!checkpoints.empty()) {
      checkpoint.emplace(PointCheckpoint::file_of(checkpoints, point),
                         fmt::format("sweep {:x}, point {}", plan.identity(), point),
                         scene->run.checkpoint_every);
    }
    const RunResult result =
        checkpoint ? resumed(scene, options, *checkpoint) : run(scene, options);
    if (result.status == RunStatus::interrupted) {
      if (checkpoint) checkpoint->write();
      return std::nullopt;
    }
    return row_of(plan, result);
  } catch (const InputError& error) {
    return row_without_numbers(plan, SweepStatus::refused, condensed(error));
  }
}

SweepProgress run_sweep(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options) {
  return SweepWork(plan, rows, options).run();
}

}  // namespace tomlin
