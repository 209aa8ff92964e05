#include "framework/study/sweep/runner.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <numeric>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/recorded_run.hpp"
#include "framework/study/sweep/worker.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {
namespace {

/// Runs a point and leaves in a folder what `tomlin run` does; resumes one that was stopped there,
/// and does nothing where it has ended or the scene refuses the point. False when it was stopped.
/// Throws OutputError, and InputError where the folder cannot be used.
bool trace_point(const SweepPlan& plan, std::size_t point, const std::filesystem::path& path,
                 const std::atomic<bool>* stop) {
  std::shared_ptr<const Scene> scene;
  try {
    scene = plan.scene_at(point);
    result_at_start(scene);
  } catch (const InputError&) {
    return true;  // as the row of the point says
  }
  RunFolder folder(path, Occupied::go_on);
  Resumption found = find_resumption(folder, *scene, plan.program_version());
  using Kind = Resumption::Kind;
  if (found.kind == Kind::finished || found.kind == Kind::failed) return true;
  folder.own(found.journal);
  RecordedRunOptions options;
  options.program_version = plan.program_version();
  options.before = StoreFile::Before::read;
  options.stop = stop;
  const RecordedRun run = record_run(folder, scene, *scene->registry, std::move(found), options);
  if (run.trouble) throw OutputError(*run.trouble);
  return !run.stopped_before && run.result.status != RunStatus::interrupted;
}

/// The threads of a sweep and what they have done.
class SweepWork : private PointSource {
 public:
  SweepWork(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options,
            const SweepProgress& so_far)
      : plan_(plan),
        rows_(rows),
        options_(options),
        queue_(plan, rows, options.part),
        seconds_before_(so_far.seconds),
        progress_(progress_before(plan, rows, options, so_far)) {}

  SweepProgress run() {
    const std::size_t left = progress_.points - progress_.with_row() + options_.traced.size();
    const auto count = std::clamp<std::size_t>(options_.threads, 1, std::max<std::size_t>(1, left));
    running_ = count;
    most_at_once_ = (left + count - 1) / count;
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

  double elapsed() const {
    return seconds_before_ + std::chrono::duration<double>(Clock::now() - started_).count();
  }

  void work() {
    try {
      SweepWorker(plan_, *this, {&halt_, options_.folder, most_at_once_}).work();
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

  std::vector<std::size_t> take() override { return queue_.take(1); }

  void keep(std::size_t point, const SweepRow& row) override {
    rows_.keep(point, row);
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

  /// Reports progress and passes on `stop` until all threads have ended.
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
  double seconds_before_;
  std::atomic<bool> halt_ = false;
  std::atomic<std::size_t> traces_begun_ = 0;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t running_ = 0;  ///< threads
  std::size_t most_at_once_ = 1;
  SweepProgress progress_;
  std::exception_ptr error_;  ///< the first
};

}  // namespace

std::vector<std::size_t> SweepQueue::take(std::size_t most) {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> taken;
  while (next_ < plan_.point_numbers() && taken.size() < most) {
    for (const std::size_t end = next_ + plan_.line(); next_ < end; ++next_) {
      const bool is_mine = plan_.exists(next_) && part_.has(next_);
      if (is_mine && !rows_.has(next_)) taken.push_back(next_);
    }
  }
  return taken;
}

SweepProgress progress_before(const SweepPlan& plan, const SweepRows& rows,
                              const SweepOptions& options, const SweepProgress& so_far) {
  SweepProgress progress = so_far;
  progress.points = 0;
  progress.traces_left = options.traced.size();
  std::size_t with_row = 0;
  for (std::size_t k = 0; k < plan.point_numbers(); ++k) {
    if (!plan.exists(k) || !options.part.has(k)) continue;
    ++progress.points;
    with_row += rows.has(k) ? 1 : 0;
  }
  progress.before = with_row - progress.done_here();
  return progress;
}

std::size_t SweepProgress::done_here() const {
  return std::accumulate(done.begin(), done.end(), std::size_t{0});
}

SweepProgress run_sweep(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options) {
  SweepProgress progress;
  for (;;) {
    progress = options.run_points ? options.run_points(plan, rows, options, progress)
                                  : SweepWork(plan, rows, options, progress).run();
    if (!options.add_points || !progress.complete()) return progress;
    if (!options.add_points()) return progress_before(plan, rows, options, progress);
  }
}

}  // namespace tomlin
