#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/system/state_layout.hpp"
#include "framework/run/context.hpp"
#include "framework/run/events/event_log.hpp"
#include "framework/run/results/result_group.hpp"
#include "framework/run/results/rotations.hpp"
#include "framework/run/results/selection.hpp"
#include "framework/run/signals.hpp"
#include "framework/run/window/window.hpp"

/// Observers of a run, which fill the rows of its results.
namespace tomlin {

/// Parts of a run that observers share.
struct ObserverParts {
  RunContext& run;
  const Signals& signals;
  const MeasureWindow& window;
  const Rotations& rotations;
  EventLog& events;
  const Selection& selection;

  std::size_t axes() const { return static_cast<std::size_t>(run.model.dimension()); }
};

/// The end of a quasistatic equilibrium: a slip in no time, with the signals before and after.
struct PathSlip {
  double energy_lost = 0.0;
  const double* before = nullptr;
  const double* after = nullptr;
};

/// The groups of results while observers fill them.
class ResultTable {
 public:
  /// Made at its first use.
  ResultGroup& group(std::string_view family, std::string_view name = "");
  ResultGroup& driver(const Model::Driver& driver) { return group("drivers", driver.name); }
  ResultGroup& body(const Model::Body& body) { return group("bodies", body.bound.name); }
  /// Standard error of a result; nothing where it is unknown.
  void add_error(std::string path, std::optional<double> error, double longer = 0.0) {
    errors_.push_back({std::move(path), error, longer});
  }
  const std::vector<ErrorEstimate>& errors() const { return errors_; }
  /// Numbers of observers, which are in the engine's units, become those of a scene.
  void convert_to(UnitSystem units);
  /// Ordered by family: drivers, bodies, observers of the scene, then those of the whole run.
  std::vector<ResultGroup> take(const Selection& selection);

 private:
  std::vector<ResultGroup> groups_;
  std::vector<ErrorEstimate> errors_;
};

/// A moment of a run at which its model has just been evaluated.
struct RunMoment {
  double time = 0.0;
  double elapsed = 0.0;  ///< since the time that forces are anchored at
  const double* position = nullptr;
  const double* velocity = nullptr;
  const double* integrals = nullptr;
  double* rates = nullptr;
  const double* signals = nullptr;  ///< null at nodes
};

/// An observer of signals, which it sees at the starts of steps of the grid and along long steps.
class SignalObserver {
 public:
  /// The model is placed, and the sink has begun; also of a run that is resumed.
  virtual void placed() {}
  virtual void steps(const SignalBlock& block) = 0;
  /// One of the first three points of a long step: all observers see it before the next one, so
  /// that events come in the order of time.
  virtual void look_at_point(const SignalSpan& span, std::size_t k) { (void)span, (void)k; }
  /// Signals along a long step, after its points.
  virtual void span(const SignalSpan& span) { (void)span; }
  /// The run has come to its end: one more moment, before any RunObserver::finish().
  virtual void look_at_end(const RunMoment& end) { (void)end; }

 protected:
  ~SignalObserver() = default;
};

/// An observer of the states that signals are read off.
class StateReader {
 public:
  /// The state at one of the four points of the step that is looked at next, the first being its
  /// start. Velocities are null where steps are short.
  virtual void read(std::size_t point, const double* position, const double* velocity) = 0;
  /// A flexible body was looked at.
  virtual void turned(std::size_t body, double turns) = 0;

 protected:
  ~StateReader() = default;
};

/// An observer of states within every step.
class NodeObserver {
 public:
  /// A node of the quadrature over the part of a step that lies in the window; weights are times
  /// and add up to the window's length.
  virtual void node(const RunMoment& moment, double weight) = 0;

 protected:
  ~NodeObserver() = default;
};

/// An observer of the states between steps.
class StepObserver {
 public:
  /// The start of the run, and the end of each step.
  virtual void stepped(const RunMoment& moment) = 0;

 protected:
  ~StepObserver() = default;
};

/// An observer of every kBlock steps of the grid.
class BlockObserver {
 public:
  virtual void block_ended() = 0;
  /// Ends of blocks before this time may be left out, but for the last of them.
  virtual double idle_until() const = 0;

 protected:
  ~BlockObserver() = default;
};

/// An observer of every thousand steps; the same ones in a run that is resumed.
class BatchObserver {
 public:
  virtual void batch_ended() = 0;

 protected:
  ~BatchObserver() = default;
};

/// An observer of a quasistatic run.
class PathObserver {
 public:
  /// The run has come to an equilibrium: at its start, and after one has ended.
  virtual void at_equilibrium() {}
  virtual void path_slip(const PathSlip& slip) { (void)slip; }

 protected:
  ~PathObserver() = default;
};

/// An observer that estimates statistical errors of results.
class ErrorEstimator {
 public:
  /// Paths of these results.
  virtual std::vector<std::string> estimated() const = 0;
  /// The error of one in the window so far; nothing where it is unknown, or the result another
  /// one's. Without allocation, but for the first.
  virtual std::optional<double> error_so_far(std::string_view path) const = 0;

 protected:
  ~ErrorEstimator() = default;
};

/// The further interfaces that an observer has; null where it has not.
struct ObserverFacets {
  SignalObserver* at_steps = nullptr;   ///< it sees signals after every step of the grid,
  SignalObserver* at_blocks = nullptr;  ///< or after blocks of them
  StateReader* reader = nullptr;
  NodeObserver* at_nodes = nullptr;
  StepObserver* at_ends = nullptr;
  BlockObserver* at_block_ends = nullptr;
  BatchObserver* at_batch_ends = nullptr;
  PathObserver* on_path = nullptr;
  ErrorEstimator* errors = nullptr;
};

/// Hooks are called in the order below; none need be overridden. What has to survive a checkpoint
/// stands in the run's state.
class RunObserver {
 public:
  virtual ~RunObserver() = default;

  virtual ObserverFacets facets() { return {}; }
  virtual void declare(StateLayout& layout) const { (void)layout; }
  virtual void attach(RunState& state) { (void)state; }
  /// Numbers of a run that begins; the model is not yet placed.
  virtual void start() {}

  /// An edge of the window.
  virtual void edge(const RunMoment& moment) { (void)moment; }
  virtual void next_window() {}
  /// A force has changed at an event.
  virtual void force_changed(std::string_view force) { (void)force; }
  /// A force has become active, or has ceased to be.
  virtual void force_switched(std::string_view force) { (void)force; }

  /// The run stops; it may have failed or been interrupted.
  virtual void stopped(const RunMoment& end) { (void)end; }
  /// The run has come to its end: what is going on there counts as far as it got.
  virtual void finish(const RunMoment& end) { (void)end; }
  /// Now, with these rates.
  virtual void results(ResultTable& table, const double* rates) const { (void)table, (void)rates; }

 protected:
  RunObserver() = default;
};

/// Rows of one family.
struct ObserverRows {
  std::string_view family;
  std::vector<const ResultQuantity*> quantities;
};

/// A kind of observer.
struct ObserverKind {
  std::vector<ObserverRows> rows;
  /// It looks at steps, for these rows and others, of `events`: where none of them is wanted it is
  /// left out.
  bool watches = false;
  std::vector<std::string_view> events = {};
  /// Null where the scene has nothing for it.
  std::unique_ptr<RunObserver> (*make)(const ObserverParts& parts) = nullptr;
};

/// Returns a kind that every scene has something for.
template <class Observer>
ObserverKind kind_of(const std::vector<ObserverRows>& rows) {
  return {.rows = rows, .make = [](const ObserverParts& parts) -> std::unique_ptr<RunObserver> {
            return std::make_unique<Observer>(parts);
          }};
}

/// All kinds; rows of a family come in this order.
std::span<const ObserverKind> observer_kinds();

}  // namespace tomlin
