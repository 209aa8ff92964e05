#include "framework/run/lane_batch.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "framework/run/context.hpp"

namespace tomlin {
namespace {

std::size_t whole_vectors(std::size_t lanes) { return padded(std::max<std::size_t>(lanes, 1)); }

}  // namespace

std::size_t LaneBatch::good_width(const Engine& like) {
  // Latencies of a small scene are hidden by other vectors; numbers of a large one fill the cache.
  constexpr std::size_t kMostVectors = 8;
  constexpr std::size_t kNumbers = 16;
  const Model& model = const_cast<Engine&>(like).model();
  const std::size_t numbers = model.coordinate_count() + model.assembly().mapped_size() / kGroup;
  return kGroup *
         std::clamp<std::size_t>(kNumbers / std::max<std::size_t>(numbers, 1), 1, kMostVectors);
}

LaneBatch::LaneBatch(Engine& like, std::size_t most)
    : like_(like),
      system_(like.model(), whole_vectors(most)),
      dt_(like.context().plan.dt),
      lanes_(most) {
  const RunContext& run = like.context();
  const void* const description = run.scene->run.integrator.description.get();
  integrator_ = run.scheme.bind.in<double>()(description, system_.system());
}

bool LaneBatch::fits(Engine& run) const {
  const RunContext& one = like_.context();
  const RunContext& other = run.context();
  return other.plan.dt == dt_ && &other.scheme == &one.scheme && system_.fits(run.model());
}

void LaneBatch::add(Engine& run) {
  const auto free = std::find_if(lanes_.begin(), lanes_.end(),
                                 [](const Lane& lane) { return lane.run == nullptr; });
  *free = {};
  free->run = &run;
  ++runs_;
}

std::vector<Engine*> LaneBatch::advance() {
  std::vector<Engine*> ended;
  while (runs_ > 0) {
    std::int64_t steps = std::numeric_limits<std::int64_t>::max();
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& lane = lanes_[k];
      if (lane.run == nullptr) continue;
      if (lane.left == 0 && !serve(k)) {
        ended.push_back(std::exchange(lane.run, nullptr));
        --runs_;
        all_filled_ = false;
        continue;
      }
      steps = std::min(steps, lane.left);
    }
    if (!ended.empty() || runs_ == 0) break;
    if (!all_filled_) fill_empty_lanes();
    take_blocks(steps);
  }
  return ended;
}

/// Lets a run do what it has to do. False: it has ended.
bool LaneBatch::serve(std::size_t k) {
  Lane& lane = lanes_[k];
  bool same = lane.taken > 0;  // numbers in the lane are those of the run
  if (lane.taken > 0) {
    system_.get(k, lane.run->model());
    const std::uint64_t evaluations = system_.system().evaluations;
    same = !lane.run->took(std::exchange(lane.taken, 0), evaluations - lane.evaluations);
  }
  while (!lane.run->done()) {
    if (!lane.alone && (lane.left = lane.run->steps_for_lanes()) > 0) break;
    lane.alone = false;
    lane.run->step_alone();
    same = false;
  }
  if (lane.run->done()) return false;
  lane.evaluations = system_.system().evaluations;
  lane.anchored = true;
  if (same) {
    system_.put_timed(k, lane.run->model());
  } else {
    system_.put(k, lane.run->model());
  }
  return true;
}

/// Lanes without a run repeat a run's numbers, so that nothing happens there that does not happen
/// elsewhere.
void LaneBatch::fill_empty_lanes() {
  const auto some = std::find_if(lanes_.begin(), lanes_.end(),
                                 [](const Lane& lane) { return lane.run != nullptr; });
  for (std::size_t k = 0; k < system_.width(); ++k) {
    if (k < lanes_.size() && lanes_[k].run != nullptr) continue;
    system_.put(k, some->run->model());
  }
  all_filled_ = true;
}

void LaneBatch::follow_time() {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    Lane& lane = lanes_[k];
    if (lane.run == nullptr || std::exchange(lane.anchored, false)) continue;
    lane.run->anchor_ahead(lane.taken);
    system_.put_timed(k, lane.run->model());
  }
}

/// Whole blocks, until a run has something to do. All have where a step has failed.
void LaneBatch::take_blocks(std::int64_t steps) {
  for (std::int64_t block = 0; block < steps / kBlock; ++block) {
    follow_time();
    std::int64_t taken = 0;
    std::uint64_t& evaluations = system_.system().evaluations;
    for (; taken < kBlock; ++taken) {
      const double since = static_cast<double>(taken) * dt_;
      const std::uint64_t before = evaluations;
      if (integrator_->step_from(since, dt_, false).fault == StepFault::none) continue;
      evaluations = before;
      all_filled_ = false;
      break;
    }
    bool serves = false;
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& lane = lanes_[k];
      if (lane.run == nullptr) continue;
      lane.taken += taken;
      lane.left -= taken;
      lane.alone = taken < kBlock;
      if (lane.alone || system_.may_rebase(k)) lane.left = 0;
      serves = serves || lane.left == 0;
    }
    if (serves) return;
  }
}

}  // namespace tomlin
