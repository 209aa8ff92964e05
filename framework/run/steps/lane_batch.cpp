#include "framework/run/steps/lane_batch.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace tomlin {
namespace {

constexpr auto kBlockSteps = static_cast<std::size_t>(kBlock);

/// For steps of runs like this one.
LaneBlock lane_block_of(const Model& model, const IntegratorRecord& scheme) {
  if (scheme.lane_block == nullptr || model.system().view.point_force_count == 0) return nullptr;
  std::vector<Kernel<double>> forces;
  for (const LaneCall& call : model.assembly().lane_calls()) forces.push_back(call.form.kernel);
  return scheme.lane_block(model.system(), forces);
}

}  // namespace

std::string why_not_in_lanes(const Model& model) {
  const RunSettings& run = model.scene().run;
  const IntegratorRecord& scheme = *run.integrator.record;
  if (run.accuracy) return "accuracy makes several runs";
  if (run.perturb) return "perturb makes several runs";
  if (run.number_type != NumberType::double_precision) return "lanes are of double precision";
  if (model.plan().quasistatic) return "the dynamics are quasistatic";
  if (!scheme.library.empty()) return "the integrator " + scheme.name + " is a plugin's";
  if (!scheme.in_lanes && scheme.adaptive_lanes == nullptr) {
    return "the integrator " + scheme.name + " has no steps in lanes";
  }
  for (const Model::Force& force : model.forces()) {
    if (!force.record->library.empty()) return "the force \"" + force.name + "\" is a plugin's";
  }
  return LaneSystem::why_not(model);
}

std::size_t LaneBatch::good_width(Engine& like) {
  // Latencies of a small scene are hidden by other vectors; numbers of a large one fill the cache.
  constexpr std::size_t kMostVectors = 8;
  constexpr std::size_t kNumbersInFlight = 16;
  const Model& model = like.model();
  const std::size_t numbers = model.coordinate_count() + model.assembly().mapped_size() / kGroup;
  return kGroup * std::clamp<std::size_t>(kNumbersInFlight / std::max<std::size_t>(numbers, 1), 1,
                                          kMostVectors);
}

LaneBatch::LaneBatch(Engine& like, std::size_t most)
    : like_(like),
      system_(like.model(), padded(std::max<std::size_t>(most, 1))),
      dt_(like.context().plan.dt),
      lanes_(most),
      grid_(system_.width(), 0.0),
      most_(system_.width(), 0.0),
      attempts_(system_.width()) {
  const RunContext& run = like.context();
  if (run.scheme.adaptive_lanes != nullptr) {
    adaptive_ = run.scheme.adaptive_lanes(system_.layout(), system_.system());
    return;
  }
  const void* const description = run.scene->run.integrator.description.get();
  integrator_ = run.scheme.bind.in<double>()(description, system_.system());
  StateLayout layout;
  integrator_->declare(layout);
  state_ = RunState(layout);
  integrator_->attach(state_);
  lane_block_ = lane_block_of(like.model(), run.scheme);
  if (like.context().point_blocks() == nullptr) return;
  const SystemView<double>& view = system_.system().view;
  const std::size_t states = (kBlockSteps + 1) * view.dofs;
  row_memory_.assign(2 * states + (kBlockSteps + 1) * view.rates, 0.0);
  double* const first = row_memory_.data();
  rows_ = {first, first + states, first + 2 * states,
           first + 2 * states + kBlockSteps * view.rates};
  shown_.assign(kBlockSteps * (2 + like.model().system().view.rates), 0.0);
}

bool LaneBatch::fits(Engine& run) const {
  const RunContext& one = like_.context();
  const RunContext& other = run.context();
  return other.plan.dt == dt_ && &other.scheme == &one.scheme && system_.fits(run.model());
}

void LaneBatch::add(Engine& engine) {
  const auto free = std::find_if(lanes_.begin(), lanes_.end(),
                                 [](const Lane& lane) { return lane.run == nullptr; });
  *free = {};
  free->engine = &engine;
  free->run = &engine.in_lanes();
  watches_steps_ = watches_steps_ || free->run->watches_steps();
  ++runs_;
}

std::vector<Engine*> LaneBatch::advance() {
  std::vector<Engine*> ended;
  while (runs_ > 0) {
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& lane = lanes_[k];
      if (lane.run == nullptr || lane.left > 0 || serve(k)) continue;
      ended.push_back(lane.engine);
      lane.run = nullptr;
      --runs_;
      all_filled_ = false;
    }
    if (!ended.empty() || runs_ == 0) break;
    if (!all_filled_) fill_empty_lanes();
    if (adaptive_) {
      take_attempts();
    } else {
      take_blocks();
    }
  }
  return ended;
}

/// All numbers of a run.
void LaneBatch::put(std::size_t k, RunContext& run) {
  system_.put(k, run.model, static_cast<std::uint64_t>(run.clock.steps()));
  system_.set_time(k, run.model.anchor_time());
  grid_[k] = static_cast<double>(run.clock.grid_steps());
  if (adaptive_) {
    adaptive_->put(k, run.model.system(), run.scene->run.integrator.description.get(), run.state);
  } else if (FixedLanes* const lanes = integrator_->capabilities().lanes) {
    lanes->put_lane(system_.layout(), k, run.state);
  }
}

/// Gives a run the steps that were taken for it. True where the lane has the run's numbers after
/// that.
bool LaneBatch::bring_back(std::size_t k) {
  Lane& lane = lanes_[k];
  if (lane.taken == 0) return false;
  RunContext& run = lane.run->context();
  system_.get(k, run.model);
  if (adaptive_) {
    adaptive_->get(k, run.state);
  } else if (FixedLanes* const lanes = integrator_->capabilities().lanes) {
    lanes->get_lane(system_.layout(), k, run.state);
  }
  const std::int64_t taken = std::exchange(lane.taken, 0);
  steps_ += static_cast<std::uint64_t>(taken);
  return !lane.run->count_steps(taken, lane.now, std::exchange(lane.evaluations, 0));
}

void LaneBatch::release() {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if (lanes_[k].run == nullptr) continue;
    bring_back(k);
    lanes_[k] = {};
  }
  runs_ = 0;
}

/// Lets a run do what it has to do. False: it has ended.
bool LaneBatch::serve(std::size_t k) {
  Lane& lane = lanes_[k];
  RunContext& run = lane.run->context();
  bool same = bring_back(k);
  for (;;) {
    if (run.outcome.done()) return false;
    if (!lane.is_alone && (lane.left = lane.run->steps_for_lanes()) > 0) {
      lane.now = run.clock.now();
      lane.next_time = lane.run->next_time();
      if (same) {
        system_.put_timed(k, run.model);
      } else {
        put(k, run);
      }
      if (may_attempt(k)) return true;
    }
    lane.is_alone = false;
    lane.run->step_alone();
    same = false;
  }
}

/// Lanes without a run repeat a run's numbers, so that nothing happens there that does not happen
/// elsewhere.
void LaneBatch::fill_empty_lanes() {
  const auto some = std::find_if(lanes_.begin(), lanes_.end(),
                                 [](const Lane& lane) { return lane.run != nullptr; });
  for (std::size_t k = 0; k < system_.width(); ++k) {
    if (k < lanes_.size() && lanes_[k].run != nullptr) continue;
    put(k, some->run->context());
    most_[k] = std::numeric_limits<double>::max();
  }
  all_filled_ = true;
}

/// Parameters are those of the next step in every lane whose run has nothing to do before.
void LaneBatch::follow_time() {
  if (system_.follows_by_kernel()) {
    if (!adaptive_) system_.set_times(grid_.data(), dt_);
    system_.follow_time();
    return;
  }
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    Lane& lane = lanes_[k];
    if (lane.run == nullptr || lane.left == 0 || lane.within_step) continue;
    Model& model = lane.run->context().model;
    model.anchor(adaptive_ ? lane.now : two_prod(grid_[k], dt_));
    system_.put_timed(k, model);
  }
}

/// Takes the steps of one block; returns how many there were before one failed.
std::int64_t LaneBatch::take_steps() {
  std::uint64_t& evaluations = system_.system().evaluations;
  for (std::size_t taken = 0; taken < kBlockSteps; ++taken) {
    const std::uint64_t before = evaluations;
    if (watches_steps_) keep_start(taken);
    const StepReport report = integrator_->step_from(static_cast<double>(taken) * dt_, dt_, false);
    if (report.fault != StepFault::none) {
      evaluations = before;
      return static_cast<std::int64_t>(taken);
    }
    if (watches_steps_) keep_rates(taken);
  }
  return kBlock;
}

/// One block; nothing of it when a step fails.
bool LaneBatch::take_in_registers() {
  const SystemView<double>& view = system_.system().view;
  keep_start(0);
  std::copy_n(view.integrals, view.rates, rows_.integrals);
  if (!lane_block_(view, dt_, kBlockSteps, rows_)) return false;
  std::copy_n(rows_.positions + kBlockSteps * view.dofs, view.dofs, view.position);
  std::copy_n(rows_.velocities + kBlockSteps * view.dofs, view.dofs, view.velocity);
  std::copy_n(rows_.integrals, view.rates, view.integrals);
  const auto evaluations = static_cast<std::uint64_t>(like_.context().scheme.evaluations_per_step);
  system_.system().evaluations += kBlockSteps * evaluations;
  return true;
}

void LaneBatch::keep_start(std::size_t step) {
  const SystemView<double>& view = system_.system().view;
  std::copy_n(view.position, view.dofs, rows_.positions + step * view.dofs);
  std::copy_n(view.velocity, view.dofs, rows_.velocities + step * view.dofs);
}

void LaneBatch::keep_rates(std::size_t step) {
  const std::size_t rates = system_.system().view.rates;
  std::copy_n(integrator_->first_rates(), rates, rows_.rates + step * rates);
}

/// Shows the steps of the block to a run; `count` of them have been taken.
void LaneBatch::show_steps(std::size_t k, std::size_t count) {
  const std::size_t w = system_.width();
  RunInLanes& run = *lanes_[k].run;
  const std::size_t apart = run.context().model.system().view.rates;
  double* const positions = shown_.data();
  double* const velocities = positions + kBlockSteps;
  double* const rates = velocities + kBlockSteps;
  const LaneMap& map = system_.layout().rates;
  for (std::size_t step = 0; step < count; ++step) {
    positions[step] = rows_.positions[step * w + k];
    velocities[step] = rows_.velocities[step * w + k];
    map.get(rows_.rates + step * map.from.size() * w, k, w, rates + step * apart);
  }
  run.watch(static_cast<std::int64_t>(grid_[k]), count, {rates, positions, velocities});
}

/// Whole blocks, until a run has something to do. All have where a step has failed.
void LaneBatch::take_blocks() {
  std::uint64_t& evaluations = system_.system().evaluations;
  for (bool serves = false; !serves;) {
    const std::uint64_t before = evaluations;
    const std::int64_t taken = lane_block_ == nullptr ? take_steps()
                               : take_in_registers()  ? kBlock
                                                      : 0;
    if (taken < kBlock) all_filled_ = false;
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& lane = lanes_[k];
      if (lane.run == nullptr) continue;
      if (watches_steps_ && lane.run->watches_steps()) {
        show_steps(k, static_cast<std::size_t>(taken));
      }
      lane.taken += taken;
      lane.left -= taken;
      lane.evaluations += evaluations - before;
      lane.is_alone = taken < kBlock;
      if (lane.is_alone || system_.may_rebase(k)) lane.left = 0;
      serves = serves || lane.left == 0;
      grid_[k] += static_cast<double>(taken);
    }
    follow_time();
  }
}

/// Whether the next step of a run is a plain one. One that was begun is.
bool LaneBatch::may_attempt(std::size_t k) {
  if (!adaptive_) return true;
  const Lane& lane = lanes_[k];
  const RunContext& run = lane.run->context();
  const double rest = static_cast<double>(DoubleDouble(run.plan.duration) - lane.now);
  most_[k] = std::min(run.longest_step, rest);
  if (lane.within_step) return true;
  const double end = static_cast<double>(lane.now + adaptive_->next_attempt(k, most_[k]));
  return end < lane.next_time && end < run.plan.duration;
}

/// Attempts of all lanes, until a run has something to do.
void LaneBatch::take_attempts() {
  for (bool serves = false; !serves;) {
    adaptive_->attempt(most_, attempts_);
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& lane = lanes_[k];
      if (lane.run == nullptr) continue;
      const AdaptiveLanes::Attempt& attempt = attempts_[k];
      lane.attempted += attempt.evaluations;
      lane.within_step = attempt.taken == 0.0 && attempt.fault == StepFault::none;
      if (lane.within_step) continue;
      const unsigned evaluations = std::exchange(lane.attempted, 0);
      if (attempt.fault != StepFault::none) {
        lane.is_alone = true;
        lane.left = 0;
      } else {
        lane.now = lane.now + attempt.taken;
        ++lane.taken;
        --lane.left;
        lane.evaluations += evaluations;
        system_.set_time(k, lane.now);
        lane.is_alone = lane.left > 0 && !may_attempt(k);
        if (lane.is_alone) lane.left = 0;
      }
      serves = serves || lane.left == 0;
    }
    follow_time();
  }
}

}  // namespace tomlin
