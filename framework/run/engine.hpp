#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/model/observe_kernels.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/run/energy_balance.hpp"
#include "framework/run/events.hpp"
#include "framework/run/extremes.hpp"
#include "framework/run/instant.hpp"
#include "framework/run/plan.hpp"
#include "framework/run/run.hpp"
#include "framework/run/steadiness.hpp"

namespace tomlin {

/// The energy ledger. Kinetic and potential energy are those at the end of the run; the rest is
/// over the window, each term integrated on its own with the scheme's order.
struct EnergyResult {
  double kinetic = 0.0;
  double potential = 0.0;
  /// By all drivers, at their pulled ends, and by energies that change with time.
  std::optional<double> work_in;
  std::optional<double> heat_out;       ///< to all dampers
  std::optional<double> stored_change;  ///< of kinetic and potential energy
  /// stored_change + heat_out - work_in: what the integrator itself added.
  std::optional<double> numerical_work;
};

/// The equilibrium that a quasistatic run ends in.
struct EquilibriumResult {
  double energy = 0.0;                       ///< potential; but for what the choice of zero holds
  std::uint64_t neutral_directions = 0;      ///< zero modes
  std::optional<double> smallest_curvature;  ///< of the energy, along what is not neutral
  std::optional<double> log_determinant;     ///< ln |det| of the energy's second derivatives
};

/// One run: the loop over steps and what is observed along the way. Kept apart from run() so that
/// tests and benchmarks can take single steps.
class Engine {
 public:
  Engine(const std::shared_ptr<const Scene>& scene, const RunOptions& options);

  RunResult run();

  Model& model() { return model_; }
  RunState& state() { return state_; }
  Integrator<double>& integrator() { return *integrator_; }
  double stable_step() const { return stable_step_; }
  /// What is known of the energy balance without a ledger, after run(); see energy_balance.hpp.
  std::optional<SampledWork> sampled_work() const {
    return balance_ ? balance_->found() : std::nullopt;
  }
  /// What a sink that wants samples gets.
  RunLayout layout() const;
  /// What the code of a plugin has thrown, if it has.
  const std::optional<PluginError>& thrown() const { return thrown_; }

  /// Go on from the numbers of another engine of the same scene: state().to_bytes(). Throws
  /// std::invalid_argument when they are not.
  void resume(const std::vector<std::byte>& numbers);

  /// Take up to this many steps (fewer at the end of the run, or when one fails) with everything
  /// that a run does along the way. For benchmarks and tests.
  void advance(std::uint64_t steps);
  bool done() const { return ended_ || failed(); }
  bool failed() const { return failure_.has_value(); }
  double time() const { return clock_[0] + clock_[1]; }
  std::uint64_t steps() const { return static_cast<std::uint64_t>(counts_[kSteps]); }

 private:
  friend class EnergyBalance;

  /// Everything that the window needs to know of one moment; the numbers stand in the run state.
  struct Moment {
    double time = 0.0;
    std::int64_t* reached = nullptr;
    double* integrals = nullptr;
    double* centre = nullptr;  ///< [body * dimension + axis][high, low], cells included
    double* turns = nullptr;   ///< [body]
    double* stored = nullptr;  ///< kinetic and potential energy, with the ledger

    DoubleDouble place(std::size_t k) const { return {centre[2 * k], centre[2 * k + 1]}; }
  };

  /// A force that waits for an observable to pass a value.
  struct Trigger {
    std::size_t force = 0;
    Instant instant;
    std::int64_t* beyond = nullptr;  ///< above the upper value, below the lower one
  };
  struct Passed {
    std::size_t trigger = 0;
    double theta = 1.0;  ///< part of the step
  };
  /// Where a body that is watched is, and how fast: height, and rotation in turns.
  struct Reading {
    double height = 0.0;
    double rise = 0.0;
    double turns = 0.0;
    double spin = 0.0;
  };

  void declare(StateLayout& layout);
  void attach();
  void list_signals();
  void warn_of_window();
  bool foresees_too_many_steps();
  bool take_to(const Passed& passed, const DoubleDouble& begin, double length, double since,
               const DoubleDouble& arrived, bool to_grid);
  bool own_variables_are_finite() const;
  bool take(double since, double h, const DoubleDouble& end, bool to_grid, bool watched = true);
  double since_anchor();
  void anchor_here();
  DoubleDouble into_step() const;
  void list_watches();
  void find_wells();
  std::optional<std::size_t> body_pulled_by(std::size_t driver) const;
  void list_triggers();
  void start_triggers();
  bool waiting() const;
  void read_triggers(const DoubleDouble& time, const double* position, const double* velocity,
                     const double* integrals);
  double beyond(const Trigger& trigger, int side) const;
  std::optional<Passed> first_passed(const DoubleDouble& begin, double h, double since);
  void fire(const Trigger& trigger);
  double height_of(double y) const;
  void read_bodies(const double* position, const double* velocity, std::vector<Reading>& readings);
  void interpolate_readings(double theta, double h);
  void watch(double at, const double* signals, const std::vector<Reading>& readings);
  void record(Event event);
  double heat_so_far();
  void set_directions();
  void start_until();
  void end_period();
  void warn_of_unsteadiness();
  void watch_bonds();
  std::int64_t plain_steps() const;
  void plain_block(std::int64_t most);
  void look(double at);
  bool look_between(double from, double to);
  void look_along_path(double from, double to);
  void include_cubics(double from, double to);
  void signals_within(double theta);
  double refined(std::size_t signal, double theta, double value, bool maximum);
  void note_slipping();
  void include_pull(std::size_t driver, double theta, double value);
  void see_pull(std::size_t driver, double pull);
  void settle();
  void forget_pulls();
  void tell_of_slip(double lost);
  bool slip();
  void note_tie();
  void warn_of_ties();
  void disturb();
  void describe_equilibrium();
  /// Force of a driver along its way at the start, times its speed.
  double pull_of(std::size_t driver, const double* signals) const {
    const auto axes = static_cast<std::size_t>(model_.dimension());
    double pull = 0.0;
    for (std::size_t s = driver * axes; s < (driver + 1) * axes; ++s) {
      pull += direction_[s] * signals[s];
    }
    return pull;
  }
  void step_fixed(std::uint64_t most);
  void step_adaptive();
  void begin_sink();
  void observe_start();
  void keep_checkpoint();
  void keep_end();
  bool too_dear() const;
  bool stopped() const;
  void signals_from_rates(const double* rates);
  void signals_from_velocity(const double* velocity, double at);
  void serve_dense(double due, const DoubleDouble& from, const DoubleDouble& to, double next_since);
  void serve_point(double at, const double* x, const double* v, const double* z);
  double next_dense() const;
  void sample(double at, const double* position, const double* velocity, const double* integrals);
  void keep_moment(Moment& moment, double at, const double* position, const double* velocity,
                   const double* integrals);
  bool housekeeping_due() const;
  void housekeeping();
  void track_rotation();
  double turns_of(std::size_t body, const double* position) const;
  void finish();
  void read_end();
  void finish_events();
  void fail(StepFault fault, double h);
  void fail(const PluginError& error);
  void fail_by_record(const std::string& said);
  void begin();
  StepReport step_from(double since, double h, bool dense);
  /// False when a plugin has thrown something, which ends the run as failed.
  template <class Action>
  bool attempt(Action action) {
    try {
      action();
      return true;
    } catch (const PluginError& error) {
      fail(error);
    } catch (const InputError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      if (scene_->libraries.empty()) throw;
      fail_by_record(error.what());
    } catch (...) {
      if (scene_->libraries.empty()) throw;
      fail_by_record("an exception that is no std::exception");
    }
    return false;
  }
  void bind_observers();
  std::size_t observed_numbers() const;
  std::size_t observe(double at, const double* position, const double* velocity, double* numbers);
  void list_observed(std::vector<SampleColumn>& columns) const;
  bool are_finite(const double* numbers);
  void keep_means(double at, const double* numbers);
  void observer_results(std::vector<ResultGroup>& groups) const;
  RunResult result();
  EnergyResult energy(bool window) const;
  EnergyTerms terms_between(const double* from_integrals, const double* to_integrals, double from,
                            double to) const;
  double kinetic_energy_now() const;
  double stored_energy();
  void take_up(RunState& other);
  void warn_of_energy();
  ResultGroup driver_results(std::size_t driver, bool has_window) const;
  ResultGroup body_results(std::size_t body, bool has_window) const;
  ResultGroup event_results() const;
  ResultGroup equilibrium_results() const;
  ResultGroup energy_results(bool has_window) const;
  SteadyResult steady() const;
  DoubleDouble now() const { return {clock_[0], clock_[1]}; }

  std::shared_ptr<const Scene> scene_;
  RunOptions options_;
  Model model_;
  const IntegratorRecord& scheme_;
  std::unique_ptr<Integrator<double>> integrator_;
  EquilibriumPath* path_ = nullptr;  ///< of a quasistatic run
  RunState state_;
  const ObserveTable& observe_;

  RunPlan plan_;
  double stable_step_ = 0.0;
  double longest_unwatched_ = std::numeric_limits<double>::infinity();  ///< of an adaptive scheme
  double time_before_ = 0.0;        ///< where a resumed run went on from
  std::uint64_t steps_before_ = 0;  ///< taken before that
  std::int64_t plain_left_ = 0;     ///< steps known to have nothing to serve

  // In the run state.
  double* clock_ = nullptr;             ///< high and low part of the time
  std::int64_t* counts_ = nullptr;      ///< steps taken, steps on the grid, next sample
  std::int64_t* long_bonds_ = nullptr;  ///< by force, see bond_watch.hpp; null without a box
  double* tie_ = nullptr;               ///< quasistatic: time and coordinate of the first one
  double* disturbed_ = nullptr;         ///< of a run that is disturbed: when last
  double disturb_every_ = 0.0;          ///< at the earliest; 0: never again after the start
  double* peaks_ = nullptr;             ///< quasistatic: of drivers' pulls since the last slip
  double* last_turns_ = nullptr;        ///< flexible bodies: rotation when last looked at
  std::int64_t* turn_wraps_ = nullptr;
  enum { kSteps, kGridSteps, kNextSample, kRotationEvery, kEvaluations, kColumns, kCounts };

  // Drivers and bodies among the signals that extremes are taken of.
  std::vector<Model::Driver> drivers_;
  std::size_t signal_count_ = 0;
  std::vector<double> signals_;
  std::vector<double> pulls_;
  std::unique_ptr<bool[]> before_slip_;  ///< by driver: its pull counts for its static force
  std::vector<double> between_[4];       ///< signals at thirds of a step, or of a part of it
  double between_from_ = 0.0;            ///< the time that they begin at
  double between_length_ = 0.0;          ///< 0: of a path, which has no dense output
  std::vector<double> direction_;        ///< [driver * dimension + axis], velocities at the start
  std::vector<double> speed_;            ///< of each driver
  std::vector<double> along_;  ///< pull times this is the force along the present velocity
  Extremes extremes_;
  StaticForces static_forces_;

  // Events. Those that are only told of follow from signals; those that change a force split steps.
  std::vector<DriverWatch> driver_watches_;
  std::vector<BodyWatch> body_watches_;
  DriverWatch::Emit emit_;
  DriverWatch::Heat heat_;
  std::string_view event_name_;
  std::int64_t* event_counts_ = nullptr;  ///< by kind, in the run state
  std::int64_t* slips_within_ = nullptr;  ///< that have begun within the window
  std::vector<Reading> readings_;         ///< by body watch, at the start of the step
  std::vector<Reading> end_readings_;
  std::vector<Reading> between_readings_;
  std::vector<Trigger> triggers_;
  AlignedVector<double> trigger_rates_;
  std::vector<double> trigger_turns_;
  Instant::State instant_;
  DoubleDouble seen_;  ///< the time of the state while its last step is looked at
  RunState before_;    ///< the state at the start of a step that may be split

  /// An observer of the scene, and what it is shown.
  struct Watcher {
    const SceneObserver* scene = nullptr;
    std::vector<ObservedNumber> columns;
    std::vector<std::size_t> bodies;
    /// Of each number, at the end and as a mean.
    std::vector<std::shared_ptr<const ResultQuantity>> quantities;
  };
  std::vector<Watcher> watchers_;
  std::vector<std::vector<double>> seen_places_;      ///< of each body's particles
  std::vector<std::vector<double>> seen_velocities_;  ///< likewise
  std::vector<ObservedBody> shown_;
  std::vector<double> observed_;            ///< all watchers' numbers
  double* observed_sums_ = nullptr;         ///< over samples in the window: high and low parts
  std::int64_t* observed_count_ = nullptr;  ///< of them

  // Until it is steady.
  double slowest_time_ = 0.0;  ///< of the scene, as far as it is known
  Steadiness steadiness_;
  bool period_over_ = false;

  Moment from_;
  Moment to_;
  AlignedVector<double> dense_position_;  // aligned: kernels read them
  AlignedVector<double> dense_velocity_;
  AlignedVector<double> dense_integrals_;
  AlignedVector<double> dense_rates_;
  std::vector<double> sample_values_;
  AlignedVector<double> final_rates_;
  AlignedVector<double> block_rates_;
  AlignedVector<double> block_velocities_;

  std::unique_ptr<EnergyBalance> balance_;  ///< null where nothing is sampled

  bool sampling_ = false;
  bool sink_has_begun_ = false;
  bool ledger_ = false;
  double kinetic_energy_ = 0.0;    ///< at the end
  double potential_energy_ = 0.0;  ///< at the end
  std::optional<EquilibriumResult> equilibrium_;
  bool ended_ = false;
  bool interrupted_ = false;
  bool within_step_ = false;  ///< stopped before all samples of the last step were served
  std::optional<RunFailure> failure_;
  std::optional<PluginError> thrown_;
  std::vector<std::string> warnings_;
  std::chrono::steady_clock::time_point started_;
  std::chrono::steady_clock::time_point last_report_;
  std::chrono::steady_clock::time_point last_checkpoint_;
};

}  // namespace tomlin
