#include <algorithm>
#include <cmath>

#include "framework/run/steps/stepping.hpp"

namespace tomlin {

FixedGrid::FixedGrid(StepParts parts) : Stepping(std::move(parts)) {
  if (!run_.point_blocks()) return;
  point_rates_.assign(kBlock * run_.model.system().view.rates, 0.0);
  point_positions_.assign(kBlock, 0.0);
  point_velocities_.assign(kBlock, 0.0);
  starts_ = {point_rates_.data(), point_positions_.data(), point_velocities_.data()};
}

/// Times on the grid are products, not sums: step n ends at (n + 1) dt however many there were.
void FixedGrid::advance(std::uint64_t most) {
  const RunPlan& plan = run_.plan;
  const DoubleDouble into = into_step();
  if (run_.clock.grid_steps() == plan.whole_steps) {
    // The rest of the run is shorter than a step, or nothing.
    const double rest = static_cast<double>(DoubleDouble(plan.duration) - run_.clock.now());
    if (rest <= kNoStep * plan.dt && (run_.clock.steps() > 0 || rest <= 0.0)) {
      run_.outcome.ended = true;
    } else {
      take_one(up_to_switch(
          {run_.since_anchor() + static_cast<double>(into), rest, DoubleDouble(plan.duration)}));
    }
    return;
  }
  if (static_cast<double>(into) != 0.0) {
    // An event has split this step of the grid: the rest of it.
    const DoubleDouble end = end_of_step();
    const double rest = static_cast<double>(end - run_.clock.now());
    take_one(up_to_switch({run_.since_anchor() + static_cast<double>(into), rest, end, true}));
    return;
  }
  // A ledger that is kept for some steps may end blocks in registers.
  if (samples_each_step_ && !run_.point_blocks()) plain_left_ = 0;
  if (parts_.triggers.waiting() || parts_.observation.looks_within_steps()) {
    plain_left_ = 0;
  } else if (plain_left_ == 0) {
    plain_left_ = std::max<std::int64_t>(0, plain_steps());
  }
  if (plain_left_ == 0 || is_looked_into() ||
      parts_.observation.rotations().is_needed_at_every_step()) {
    take_one(up_to_switch({run_.since_anchor(), plan.dt, end_of_step(), true}));
    if (plain_left_ > 0) --plain_left_;
    return;
  }
  const std::int64_t to_anchor = kBlock - run_.clock.grid_steps() % kBlock;
  take_block(std::min({to_anchor, plain_left_, static_cast<std::int64_t>(most)}));
}

std::int64_t FixedGrid::steps_for_lanes() {
  if (run_.clock.grid_steps() % kBlock != 0 || static_cast<double>(into_step()) != 0.0) return 0;
  if (!may_be_in_lanes()) return 0;
  if (plain_left_ == 0 && run_.clock.grid_steps() < run_.plan.whole_steps) {
    plain_left_ = std::max<std::int64_t>(0, plain_steps());
  }
  if (samples_each_step_ || plain_left_ < kBlock) return 0;
  run_.since_anchor();
  // Turns are counted after every block.
  if (parts_.observation.rotations().counts_turns()) return kBlock;
  return std::min(plain_left_ / kBlock, blocks_before(parts_.observation.idle_until())) * kBlock;
}

/// Returns the number of blocks that end before that time, but one at least.
std::int64_t FixedGrid::blocks_before(double time) const {
  const double dt = run_.plan.dt;
  const std::int64_t taken = run_.clock.grid_steps();
  if (!(time < run_.plan.duration)) return run_.plan.whole_steps / kBlock;
  auto blocks = (static_cast<std::int64_t>(std::max(time, 0.0) / dt) - taken) / kBlock;
  const auto end = [&] { return static_cast<double>(taken + blocks * kBlock) * dt; };
  while (blocks > 1 && !(end() < time)) --blocks;
  return std::max<std::int64_t>(blocks, 1);
}

void FixedGrid::count_steps(std::int64_t steps, const DoubleDouble&) {
  run_.clock.add(steps, steps);
  run_.clock.keep_cost(run_.model.system());
  run_.clock.set(two_prod(static_cast<double>(run_.clock.grid_steps()), run_.plan.dt));
  run_.seen = run_.clock.now();
  plain_left_ -= steps;
  // In the middle of a block the run goes on from the block's start.
  run_.anchor_here();
  if (run_.clock.grid_steps() % kBlock == 0) parts_.housekeeping.after_block();
}

/// How far the run is into a step of the grid; after blocks that is nothing.
DoubleDouble FixedGrid::into_step() {
  if (on_grid_) return DoubleDouble(0.0);
  const DoubleDouble into = run_.into_step();
  on_grid_ = static_cast<double>(into) == 0.0;
  return into;
}

void FixedGrid::take_one(const Step& step) {
  on_grid_ = false;
  take(step);
}

/// End of the step of the grid that the run is in or before; the last one ends with the run.
DoubleDouble FixedGrid::end_of_step() const {
  const RunPlan& plan = run_.plan;
  const DoubleDouble end = two_prod(static_cast<double>(run_.clock.grid_steps() + 1), plan.dt);
  const bool at_end = std::abs(static_cast<double>(end - plan.duration)) <= kNoStep * plan.dt;
  return at_end ? DoubleDouble(plan.duration) : end;
}

/// The number of steps that end before the next edge of the window and the next sample. For a
/// single particle that is sampled at every step, samples do not end a block.
std::int64_t FixedGrid::plain_steps() {
  const RunPlan& plan = run_.plan;
  const std::int64_t taken = run_.clock.grid_steps();
  samples_each_step_ =
      run_.point_blocks() != nullptr &&
      parts_.observation.samples_each_step(plan.dt, static_cast<double>(taken + 1) * plan.dt);
  const double next_time =
      std::min(next_switch_time(), samples_each_step_ ? parts_.observation.next_edge()
                                                      : parts_.observation.next_time());
  const std::int64_t left = plan.whole_steps - taken;
  if (!(next_time < plan.duration)) return left - 1;  // the last may end on a sample
  auto before = static_cast<std::int64_t>(next_time / plan.dt) - taken;
  // Rounding of the quotient: the step that ends at or past the time is the one that is not plain.
  while (before > 0 && next_time <= static_cast<double>(taken + before) * plan.dt) --before;
  return std::min(left - 1, before);
}

/// Steps with nothing to serve between them, up to the next time that forces are anchored at.
void FixedGrid::take_block(std::int64_t most) {
  StepFault fault = StepFault::none;
  const std::int64_t taken =
      run_.point_blocks() ? point_block(most, fault) : plain_block(most, fault);
  run_.check_arithmetic();
  run_.clock.add(taken, taken);
  run_.clock.keep_cost(run_.model.system());
  run_.clock.set(two_prod(static_cast<double>(run_.clock.grid_steps()), run_.plan.dt));
  plain_left_ -= taken;
  if (samples_each_step_ && taken > 0) sample_end_of_block();
  if (fault != StepFault::none) {
    run_.fail(fault, run_.plan.dt);
    return;
  }
  if (run_.clock.grid_steps() % kBlock != 0) return;
  // How far drivers have come counts for the origin: they are looked at where `take` leaves them.
  run_.since_anchor();
  parts_.housekeeping.after_block();
}

/// Takes the steps of a single point, which stays in registers.
std::int64_t FixedGrid::point_block(std::int64_t most, StepFault& fault) {
  run_.since_anchor();
  const std::int64_t grid = run_.clock.grid_steps();
  const auto first = static_cast<std::size_t>(grid % kBlock);
  const auto wanted = static_cast<std::size_t>(most);
  const auto taken = static_cast<std::int64_t>(
      run_.point_blocks()->point_block(first, run_.plan.dt, wanted, starts_));
  if (taken < most) fault = StepFault::not_finite_or_too_far;
  run_.seen = two_prod(static_cast<double>(grid + taken), run_.plan.dt);
  parts_.observation.point_block(grid, static_cast<std::size_t>(taken), starts_);
  if (samples_each_step_) sample_within_block(grid, taken);
  return taken;
}

/// The end of a step is the start of the next one, at which the forces are known.
void FixedGrid::sample_within_block(std::int64_t grid, std::int64_t taken) {
  const std::size_t width = run_.model.system().view.rates;
  for (std::int64_t step = 1; step < taken; ++step) {
    const PointStarts<double> start = starts_.from(static_cast<std::size_t>(step), width);
    parts_.observation.sample_point(static_cast<double>(grid + step) * run_.plan.dt,
                                    *start.positions, *start.velocities, start.rates);
  }
}

/// With the forces that the next step will begin with, so that rows do not depend on where blocks
/// end.
void FixedGrid::sample_end_of_block() {
  const SystemView<double>& view = run_.model.system().view;
  const double since = run_.since_anchor();
  run_.model.evaluate_point(view.position[0], view.velocity[0], since, point_rates_.data());
  parts_.observation.sample_point(run_.clock.time(), view.position[0], view.velocity[0],
                                  point_rates_.data());
}

std::int64_t FixedGrid::plain_block(std::int64_t most, StepFault& fault) {
  const double dt = run_.plan.dt;
  const std::int64_t grid = run_.clock.grid_steps();
  const std::int64_t first = grid % kBlock;
  double since = run_.since_anchor();
  std::int64_t taken = 0;
  while (taken < most) {
    parts_.observation.begin_step(static_cast<double>(grid + taken) * dt);
    fault = step_scheme(since, dt, false).fault;
    if (fault != StepFault::none) break;
    ++taken;
    run_.seen = two_prod(static_cast<double>(grid + taken), dt);
    parts_.observation.end_step();
    since = static_cast<double>(first + taken) * dt;
  }
  parts_.observation.end_block();
  return taken;
}

}  // namespace tomlin
