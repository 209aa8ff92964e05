#include "framework/study/sweep/worker.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/run/lane_batch.hpp"

namespace tomlin {
namespace {

/// Runs of other structures that wait: enough to make batches where structures alternate.
constexpr std::size_t kMostWaiting = 128;

}  // namespace

void SweepWorker::work() {
  while (!stopped()) {
    if (waiting_.empty() && !fetch()) return;
    if (!waiting_.empty()) run_batch();
  }
}

/// One point more: it waits for a batch, unless it is run by itself. False: there are no more.
bool SweepWorker::fetch() {
  const std::optional<std::size_t> point = source_.take();
  if (!point) return false;
  try {
    auto run = std::make_unique<PointRun>(plan_, *point, options_.stop, options_.checkpoints);
    const Engine* const engine = options_.most_at_once > 1 ? run->engine() : nullptr;
    if (engine != nullptr && engine->why_not_in_lanes().empty()) {
      waiting_.push_back(std::move(run));
    } else {
      keep(*run, run->run());
    }
  } catch (const InputError& error) {
    source_.keep(*point, row_of_refused(plan_, error));
  }
  return true;
}

void SweepWorker::run_batch() {
  std::vector<std::unique_ptr<PointRun>> running;
  running.push_back(std::move(waiting_.front()));
  waiting_.pop_front();
  Engine& like = *running.front()->engine();
  const std::size_t most = std::min(LaneBatch::good_width(like), options_.most_at_once);
  LaneBatch batch(like, most);
  std::unique_ptr<PointRun> prototype;  // outlives its part in the batch
  batch.add(like);
  while (!batch.is_empty()) {
    for (auto next = waiting_.begin(); !batch.is_full() && next != waiting_.end();) {
      if (!batch.fits(*(*next)->engine())) {
        ++next;
        continue;
      }
      batch.add(*(*next)->engine());
      running.push_back(std::move(*next));
      next = waiting_.erase(next);
    }
    if (!batch.is_full() && !stopped() && waiting_.size() < kMostWaiting && fetch()) continue;
    for (Engine* const ended : batch.advance()) {
      const auto run = std::find_if(running.begin(), running.end(),
                                    [&](const auto& one) { return one->engine() == ended; });
      keep(**run, (*run)->end());
      if (ended == &like) prototype = std::move(*run);
      running.erase(run);
    }
  }
}

void SweepWorker::keep(const PointRun& run, const std::optional<SweepRow>& row) {
  if (!row) return;
  source_.keep(run.point(), *row);
  run.remove_checkpoint();
}

}  // namespace tomlin
