#include "framework/study/sweep/worker.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/study/sweep/line_run.hpp"

namespace tomlin {
namespace {

/// Runs of other structures that wait: enough to make batches where structures alternate.
constexpr std::size_t kMostWaiting = 128;

}  // namespace

void SweepWorker::work() {
  if (plan_.line() > 1) {
    for (auto points = source_.take(); !points.empty(); points = source_.take()) {
      if (!run_line(plan_, points, source_, options_)) return;
    }
    return;
  }
  while (!stopped()) {
    if (waiting_.empty() && !fetch()) return;
    if (!waiting_.empty()) run_first();
  }
}

/// One point more: it waits for a batch, unless it is run by itself. False: there are no more.
bool SweepWorker::fetch() {
  const std::vector<std::size_t> points = source_.take();
  if (points.empty()) return false;
  const std::size_t point = points.front();
  try {
    auto run = std::make_unique<PointRun>(plan_, point, options_.stop, options_.checkpoints);
    Engine* const engine = options_.most_at_once > 1 ? run->engine() : nullptr;
    if (engine != nullptr && engine->in_lanes().why_not().empty()) {
      waiting_.push_back(std::move(run));
    } else {
      keep(*run, run->run());
    }
  } catch (const InputError& error) {
    source_.keep(point, row_of_refused(plan_, error));
  }
  return true;
}

/// Returns up to `most` waiting runs that fit the batch; fetches points until there are as many.
SweepWorker::Runs SweepWorker::gather(const LaneBatch& batch, std::size_t most) {
  Runs found;
  const std::size_t most_waiting = std::min(kMostWaiting, options_.most_at_once);
  for (std::size_t k = 0; found.size() < most;) {
    if (k == waiting_.size()) {
      if (stopped() || waiting_.size() >= most_waiting || !fetch()) break;
      continue;  // it may have been run
    }
    if (batch.fits(*waiting_[k]->engine())) {
      found.push_back(std::move(waiting_[k]));
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
  return found;
}

/// The run that has waited longest, with those that fit.
void SweepWorker::run_first() {
  std::unique_ptr<PointRun> first = std::move(waiting_.front());
  waiting_.pop_front();
  Engine& like = *first->engine();
  const std::size_t most = std::min(LaneBatch::good_width(like), options_.most_at_once);
  Runs runs = gather(LaneBatch(like, 1), most - 1);
  if (runs.size() + 1 < LaneBatch::kFewestRuns) {
    keep(*first, first->run());
    for (const auto& run : runs) keep(*run, run->run());
    return;
  }
  run_batch(std::move(first), std::move(runs));
}

/// Runs them until all have ended, or so few are left that fewer lanes, or none, take less time.
void SweepWorker::run_batch(std::unique_ptr<PointRun> first, Runs runs) {
  Engine& like = *first->engine();
  LaneBatch batch(like, runs.size() + 1);
  batch.add(like);
  for (const auto& run : runs) batch.add(*run->engine());
  bool first_runs = true;
  while (!batch.is_empty()) {
    for (Engine* const ended : batch.advance()) {
      if (ended == &like) {
        keep(*first, first->end());
        first_runs = false;
        continue;
      }
      const auto run = std::find_if(runs.begin(), runs.end(),
                                    [&](const auto& one) { return one->engine() == ended; });
      keep(**run, (*run)->end());
      runs.erase(run);
    }
    for (auto& run : gather(batch, batch.room())) {
      batch.add(*run->engine());
      runs.push_back(std::move(run));
    }
    if (batch.is_empty() || !batch.is_sparse()) continue;
    batch.release();
    if (first_runs) runs.push_back(std::move(first));
    for (auto& run : runs) waiting_.push_front(std::move(run));
    return;
  }
}

void SweepWorker::keep(const PointRun& run, const std::optional<SweepRow>& row) {
  if (!row) return;
  source_.keep(run.point(), *row);
  run.remove_checkpoint();
}

}  // namespace tomlin
