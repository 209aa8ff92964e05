#include "framework/study/tradeoff/trial_run.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "framework/core/text/fault.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/guard/side_run.hpp"
#include "framework/study/tradeoff/methods.hpp"

namespace tomlin {
namespace {

using Clock = std::chrono::steady_clock;

/// Raises a flag when time is up or somebody else's flag is raised. A thread of its own, so that a
/// run needs no look at the clock.
class Watchdog {
 public:
  Watchdog(double seconds, const std::atomic<bool>* other)
      : until_(seconds < kLongest
                   ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(std::max(seconds, 0.0)))
                   : Clock::time_point::max()),
        other_(other),
        thread_([this] { watch(); }) {}
  ~Watchdog() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  const std::atomic<bool>& stop() const { return stop_; }
  bool asked_from_outside() const { return other_ != nullptr && other_->load(); }

 private:
  static constexpr double kLongest = 1e8;  // seconds: three years
  static constexpr std::chrono::milliseconds kLookEvery{20};

  void watch() {
    std::unique_lock lock(mutex_);
    while (!over_) {
      if (Clock::now() >= until_ || asked_from_outside()) {
        stop_ = true;
        return;
      }
      changed_.wait_until(lock, std::min(until_, Clock::now() + kLookEvery));
    }
  }

  Clock::time_point until_;
  const std::atomic<bool>* other_;
  std::atomic<bool> stop_ = false;
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses the others
};

TrialRun::End end_of(const RunResult& result, const Watchdog& watchdog) {
  switch (result.status) {
    case RunStatus::finished:
      return TrialRun::End::finished;
    case RunStatus::failed:
      return TrialRun::End::failed;
    case RunStatus::interrupted:
      break;
  }
  return watchdog.asked_from_outside() ? TrialRun::End::interrupted : TrialRun::End::over_budget;
}

}  // namespace

TrialRun try_run(const std::shared_ptr<const Scene>& scene, const TrialLimits& limits) {
  TrialRun trial;
  trial.duration = scene->run.duration;
  try {
    const Watchdog watchdog(limits.seconds, limits.stop);
    RunOptions options;
    options.stop = &watchdog.stop();
    options.most_cost = limits.cost;
    options.perturbation = limits.perturbation;
    options.start_from = limits.start_from;
    options.observables = limits.observables;
    options.all_observables = limits.all_observables;
    options.store = limits.store;
    trial.result = side_run(scene, std::move(options), limits.name);
    trial.seconds = trial.result.wall_seconds;
    trial.end = end_of(trial.result, watchdog);
    if (trial.result.failure) trial.why = to_string(*trial.result.failure);
  } catch (const InputError& error) {
    trial.end = TrialRun::End::refused;
    trial.why = condensed(error);
  }
  return trial;
}

RunResult result_at_start(const std::shared_ptr<const Scene>& scene) {
  const std::atomic<bool> stop = true;
  RunOptions options = options_to_bind();
  options.stop = &stop;
  options.all_observables = true;
  return Engine(scene, options).run();
}

}  // namespace tomlin
