#include "framework/run/housekeeping.hpp"

#include <algorithm>

#include "framework/run/guard/disturbance.hpp"

namespace tomlin {
namespace {

constexpr std::chrono::milliseconds kReportEvery{200};

}  // namespace

Housekeeping::Housekeeping(RunContext& run, Observation& observation)
    : run_(run),
      observation_(observation),
      started_(Clock::now()),
      last_report_(started_),
      last_checkpoint_(started_) {}

void Housekeeping::declare(StateLayout& layout) const {
  if (run_.options.perturbation) layout.add_reals("disturbed", 1);
}

void Housekeeping::attach(RunState& state) {
  if (run_.options.perturbation) disturbed_ = state.reals("disturbed");
}

void Housekeeping::start() {
  started_ = last_report_ = last_checkpoint_ = Clock::now();
  const bool again = run_.options.perturbation && run_.path == nullptr;
  disturb_every_ = again ? memory_of_disturbances(run_.model) : 0.0;
}

void Housekeeping::resumed() {
  time_before_ = run_.clock.time();
  steps_before_ = run_.clock.steps();
}

double Housekeeping::seconds() const {
  return std::chrono::duration<double>(Clock::now() - started_).count();
}

std::uint64_t Housekeeping::steps() const {
  return static_cast<std::uint64_t>(run_.clock.steps() - steps_before_);
}

void Housekeeping::after_block() {
  follow();
  if (after_blocks_) after_blocks_();
  const RunOutcome& outcome = run_.outcome;
  if (outcome.ended && !outcome.interrupted && has_more_than_numbers()) return;
  if (run_.stopped()) {
    run_.outcome.interrupt();
    keep_checkpoint();
    return;
  }
  if (!run_.options.on_progress && run_.options.sink == nullptr) return;
  if (--blocks_to_look_ == 0) look_at_clock();
}

void Housekeeping::follow_rotations() {
  observation_.look_at_rotations();
  if (run_.model.reorient_if_needed()) run_.integrator->forces_changed();
}

/// The origin follows the particles.
void Housekeeping::follow() {
  follow_rotations();
  observation_.look_at_block_end();
  if (run_.model.rebase_if_needed()) run_.integrator->rebased();
  if (disturb_every_ > 0.0 && run_.clock.time() >= *disturbed_ + disturb_every_) disturb();
}

/// Every block where blocks take long, else more rarely, so that looks do not count.
void Housekeeping::look_at_clock() {
  const std::chrono::duration<double> short_time{std::min(1e-4, run_.scene->run.checkpoint_every)};
  constexpr int kMostApart = 64;
  const Clock::time_point now = Clock::now();
  looks_apart_ = now - last_look_ < short_time ? std::min(2 * looks_apart_, kMostApart) : 1;
  blocks_to_look_ = looks_apart_;
  last_look_ = now;
  const RunOptions& options = run_.options;
  if (options.on_progress && now - last_report_ >= kReportEvery) {
    last_report_ = now;
    const std::chrono::duration<double> elapsed = now - started_;
    options.on_progress({run_.clock.time(), run_.plan.duration,
                         static_cast<std::uint64_t>(run_.clock.steps()), elapsed.count(),
                         time_before_, static_cast<std::uint64_t>(steps_before_)});
  }
  const std::chrono::duration<double> since = now - last_checkpoint_;
  if (since.count() < run_.scene->run.checkpoint_every) return;
  keep_checkpoint();
  last_checkpoint_ = Clock::now();
}

void Housekeeping::stop_within_step() {
  if (run_.block_ends()) {
    follow();
  } else if (observation_.rotations().is_needed_at_every_step()) {
    follow_rotations();
  }
  run_.outcome.interrupt();
}

/// Friction makes one state of starts that differ: what they would part at later needs noise there.
void Housekeeping::disturb() {
  tomlin::disturb(*run_.options.perturbation, static_cast<std::uint64_t>(run_.clock.steps()),
                  run_.model);
  *disturbed_ = run_.clock.time();
  run_.integrator->forces_changed();
}

/// A run that resumes from these numbers computes again what was computed ahead.
void Housekeeping::keep_checkpoint() {
  if (run_.options.sink == nullptr) return;
  run_.clock.keep_cost(run_.model.system(), run_.integrator->evaluations_ahead());
  run_.options.sink->checkpoint(run_.state);
}

/// The numbers do not hold all that a run that ends on a condition, and a path of equilibria, know
/// at their end: such runs resume from the checkpoint before.
bool Housekeeping::has_more_than_numbers() const {
  return run_.path != nullptr || run_.scene->run.until.has_value();
}

void Housekeeping::keep_end() {
  const RunSettings& settings = run_.scene->run;
  const bool more_follow = settings.perturb || settings.accuracy || settings.repeats > 1;
  if (run_.options.sink == nullptr || !more_follow || !run_.outcome.complete()) return;
  if (has_more_than_numbers()) return;
  run_.clock.keep_cost(run_.model.system());
  run_.options.sink->checkpoint(run_.state);
}

}  // namespace tomlin
