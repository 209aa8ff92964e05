#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/run/context.hpp"
#include "framework/run/observers/run_observer.hpp"
#include "framework/run/observers/samples.hpp"
#include "framework/run/steps/gauss_rule.hpp"

namespace tomlin {

/// All that looks on in one run: tells observers of steps, blocks of steps, edges of the window and
/// the end, and serves what falls within a step.
class Observation {
 public:
  /// Throws InputError for an observer of the scene that cannot be bound.
  explicit Observation(RunContext& run);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// Numbers of a run that begins.
  void start();
  /// The model is placed, and the sink has begun.
  void placed();
  /// Samples, the window's edge and the equilibrium at the start of a run.
  void look_at_start();
  /// See SignalSpan.
  void evaluate_forces_within_steps() { span_.evaluate_forces(); }

  /// Before a step that begins at a time; steps of the grid go without velocities.
  void begin_step(double time);
  /// A step of the grid has been taken. What is looked at in blocks is looked at in end_block(), at
  /// most kBlock steps later.
  void end_step();
  void end_block();
  /// Steps of the grid of a single point, from their starts.
  void point_block(std::int64_t first_step, std::size_t count, const PointStarts<double>& starts);
  /// A sample of a single point at the end of a step of the grid.
  void sample_point(double time, double position, double velocity, double* rates);
  /// A long step has been taken.
  void look_between(double from, double to);
  void look_along_path(double from, double to);
  void at_equilibrium();
  void path_slip(double energy_lost);
  void force_changed(const std::string& force);
  /// A force has become active, or has ceased to be.
  void force_switched(const std::string& force);
  void look_at_rotations();
  void look_at_batch_end();
  /// Every kBlock steps of the grid.
  void look_at_block_end();
  /// Ends of blocks before this time may be left out, see BlockObserver; infinite: all of them.
  double idle_until() const;

  /// The next sample or edge of the window.
  double next_time() const { return std::min(samples_.next_time(), window_.next_edge()); }
  double next_edge() const { return window_.next_edge(); }
  /// Every step of a grid ends on a sample, the next one at this time.
  bool samples_each_step(double dt, double end_of_next) const {
    return samples_.are_taken_every(dt) && samples_.next_time() == end_of_next;
  }
  /// Serves what is asked for within a step that has been taken; `next_since`: its end, after the
  /// anchor. False when a signal has come through between the samples of a very long step.
  bool serve(double first_time, const DoubleDouble& from, const DoubleDouble& to,
             double next_since);
  /// Signals of every step are looked at.
  bool watches() const { return !at_signals_.empty(); }
  /// Every step is looked into.
  bool looks_within_steps() const { return !at_nodes_.empty() || !at_ends_.empty(); }
  /// A part of a step, in fractions of it.
  struct Part {
    double begin = 0.0;
    double length = 1.0;
  };
  /// Calls use(moment, weight) at the nodes of a quadrature over a part of the step that has been
  /// taken; weights are times. `next_since`: the step's end, after the anchor.
  template <class Use>
  void at_nodes(const DoubleDouble& from, const DoubleDouble& to, double next_since,
                const Part& part, Use&& use);
  /// Integrates over the part of a step that lies in the window.
  void integrate(const DoubleDouble& from, const DoubleDouble& to, double next_since);
  /// At the start, and at the end of each step of the run.
  void look_at_end_of_step();
  /// The window has ended since this was asked last.
  bool window_has_ended() { return std::exchange(window_has_ended_, false); }
  void next_window();

  /// The end of a run, which may close the window, and with the rates there.
  void close_window();
  void stopped(double* rates);
  void finish(double* rates);
  /// Paths of all results whose statistical errors are estimated, and the error of one of them in
  /// the window so far; nothing where it is unknown.
  std::vector<std::string> estimated() const;
  std::optional<double> error_so_far(std::string_view path) const;
  /// Groups of results, errors and warnings that only they show.
  void write_results(const double* rates, RunResult& result) const;

  MeasureWindow& window() { return window_; }
  Rotations& rotations() { return rotations_; }
  Signals& signals() { return signals_; }
  EventLog& events() { return events_; }
  observers::Samples& samples() { return samples_; }
  const observers::Samples& samples() const { return samples_; }

 private:
  /// A state within a step, and what is read off it.
  struct Within {
    AlignedVector<double> position;  // aligned: kernels read them
    AlignedVector<double> velocity;
    AlignedVector<double> integrals;
    AlignedVector<double> rates;
    std::vector<double> signals;
  };
  /// Evaluates the model at a state.
  RunMoment moment_at(const DoubleDouble& time, const double* position, const double* velocity,
                      const double* integrals);
  void show_span();
  void complete_dense(double next_since);
  RunMoment end_of_run(double* rates);
  void take_point(double time, const double* position, const double* velocity,
                  const double* integrals);
  void reach_edge(double time, const double* position, const double* velocity,
                  const double* integrals);
  double* row() { return block_signals_.data() + block_.count * block_.width; }

  RunContext& run_;
  Selection selection_;
  Signals signals_;
  MeasureWindow window_;
  Rotations rotations_;
  EventLog events_;
  std::vector<std::unique_ptr<RunObserver>> observers_;
  observers::Samples samples_;
  // Facets of them.
  std::vector<SignalObserver*> at_steps_;
  std::vector<SignalObserver*> at_blocks_;
  std::vector<SignalObserver*> at_signals_;  ///< those at steps, then those at blocks
  std::vector<StateReader*> readers_;
  std::vector<NodeObserver*> at_nodes_;
  std::vector<StepObserver*> at_ends_;
  std::vector<BlockObserver*> at_block_ends_;
  std::vector<BatchObserver*> at_batch_ends_;
  std::vector<PathObserver*> on_path_;
  std::vector<ErrorEstimator*> estimators_;
  SignalBlock block_;
  std::vector<double> block_times_;
  std::vector<double> block_signals_;
  bool is_point_ = false;        ///< whose steps are taken in registers
  double point_position_ = 0.0;  ///< of a single point, at the start of the step
  double point_velocity_ = 0.0;
  SignalSpan span_;
  Within within_;
  bool dense_is_complete_ = false;  ///< of the last step
  bool window_has_ended_ = false;
};

template <class Use>
void Observation::at_nodes(const DoubleDouble& from, const DoubleDouble& to, double next_since,
                           const Part& part, Use&& use) {
  const double length = static_cast<double>(to - from);
  complete_dense(next_since);
  for (std::size_t k = 0; k < kGaussNodes; ++k) {
    const double theta = part.begin + part.length * kGaussNode[k];
    run_.integrator->interpolate(theta, within_.position.data(), within_.velocity.data(),
                                 within_.integrals.data());
    const RunMoment moment = moment_at(from + theta * length, within_.position.data(),
                                       within_.velocity.data(), within_.integrals.data());
    use(moment, part.length * kGaussWeight[k] * length);
  }
}

}  // namespace tomlin
