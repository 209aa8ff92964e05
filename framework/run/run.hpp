#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/core/text/fault_code.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/core/text/words.hpp"
#include "framework/model/assembly.hpp"
#include "framework/run/results/result_group.hpp"
#include "framework/scene/scene.hpp"

/// Runs a scene from start to end and reports what happened.
namespace tomlin {

enum class RunStatus { finished, interrupted, failed };

constexpr auto word_table(RunStatus) {
  using enum RunStatus;
  return std::to_array<Word<RunStatus>>(
      {{finished, "finished"}, {interrupted, "interrupted"}, {failed, "failed"}});
}

/// Why a run failed, with its position.
struct RunFailure {
  std::uint64_t step = 0;  ///< index of the step that failed, from 0
  double time = 0.0;       ///< at its start
  std::string body;
  std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
  std::string axis;
  std::string force;  ///< the force that acts most strongly there
  std::string what;   ///< what was noticed
  std::string cause;  ///< the likely cause
  FaultCode code = FaultCode::run_step_unstable;
};

/// One sentence with everything in it.
std::string to_string(const RunFailure& failure);

/// How a run until it is steady came out.
struct SteadyResult {
  std::string path;
  bool reached = false;
  std::uint64_t periods = 0;  ///< of the driver, whole ones
  /// Estimated distance of the last period's value from the steady one, relative to it.
  std::optional<double> change;
};

/// How a run until the error of a mean is small enough came out.
struct UntilErrorResult {
  std::string path;
  bool reached = false;
  double asked = 0.0;
  std::optional<double> error;  ///< of the mean over the window; nothing where it is unknown
};

/// How far an observable is determined: its values in runs from slightly other starts.
struct DeterminedResult {
  std::string path;
  std::optional<double> value;  ///< of the run as it is
  double spread = 0.0;          ///< largest less smallest value, the run as it is included
  double digits = 0.0;          ///< decimal digits that all runs share, 0 to 17
  double min = 0.0;
  double max = 0.0;
};

/// `[run] accuracy`: what was taken.
struct AccuracyResult {
  double asked = 0.0;
  std::string integrator;  ///< as a line of a scene
  std::string companion;   ///< the same of the run that errors are estimated with; empty: none
  std::string second_companion;                        ///< by another family, or coarser still
  std::uint64_t pilot_cost = 0;                        ///< evaluations and columns
  std::uint64_t companion_cost = 0;                    ///< of all
  const IntegratorRecord* scheme = nullptr;            ///< the integrator's
  const IntegratorRecord* companion_scheme = nullptr;  ///< of another family where there is one
};

/// Estimated error of an observable of this run, in its own unit.
struct ErrorEstimate {
  std::string path;
  std::optional<double> error;  ///< nothing where the observable is undefined
  double longer = 0.0;  ///< without an error: times the window that one takes at least; 0: unknown
};

struct RunResult {
  RunStatus status = RunStatus::finished;
  std::optional<RunFailure> failure;
  double end_time = 0.0;
  std::uint64_t steps = 0;
  std::uint64_t refused_steps = 0;
  std::uint64_t force_evaluations = 0;
  std::uint64_t jacobian_columns = 0;  ///< each worth an evaluation of all forces
  double window_from = 0.0;
  double window_to = 0.0;
  /// Measured results: of each driver, each body, each observer, of events and, where the scene
  /// asks for them, of the energy and the equilibrium that a quasistatic run ends in.
  std::vector<ResultGroup> groups;
  std::optional<SteadyResult> steady;           ///< with `[run] until` and `steady`
  std::optional<UntilErrorResult> until_error;  ///< with `[run] until` and `error`
  std::vector<DeterminedResult> determined;     ///< with `[run] perturb`
  std::optional<AccuracyResult> accuracy;       ///< with `[run] accuracy`
  std::vector<ErrorEstimate> errors;            ///< likewise
  std::vector<Warning> warnings;
  std::vector<std::pair<std::string, std::string>> left_out;  ///< force and why it was not built
  double wall_seconds = 0.0;
  double steps_per_second = 0.0;
  InstructionSet instruction_set = InstructionSet::baseline;
  std::size_t threads = 1;  ///< that shared the evaluations of forces

  /// All groups of a family: "drivers", "bodies", "observers".
  std::span<const ResultGroup> family(std::string_view name) const;
  /// In the order of the scene. Throw std::out_of_range.
  const ResultGroup& driver(std::size_t k) const { return member("drivers", k); }
  const ResultGroup& body(std::size_t k) const { return member("bodies", k); }
  /// Null where there is none of that name; families of the run as a whole have an empty name.
  const ResultGroup* find(std::string_view family, std::string_view name = "") const;
  /// Throws std::out_of_range where there is none.
  const ResultGroup& group(std::string_view family, std::string_view name = "") const;

 private:
  const ResultGroup& member(std::string_view family, std::size_t k) const;
};

/// A column of observables.csv: "driver.force.x" and "force", or "eV/A". All numbers of samples are
/// in the units of the scene.
struct SampleColumn {
  std::string name;
  std::string unit;
};

/// The particles of one body in a trajectory, one body after another.
struct TrajectoryBody {
  std::string name;
  std::vector<double> mass;                ///< [particle], in the units of the scene
  std::vector<std::int32_t> species = {};  ///< [particle], indices of names; empty: it has none
};

/// Layout of the data that a run will send to its sink.
struct RunLayout {
  std::vector<SampleColumn> columns;      ///< of the table; empty: no samples come
  std::vector<TrajectoryBody> bodies;     ///< with `[output] trajectory`; empty: no positions come
  std::vector<std::string> species = {};  ///< names of those that bodies have
  int dimension = 0;
  std::vector<double> box;     ///< lengths by axis; empty: there is none
  std::vector<bool> periodic;  ///< by axis, with a box
  bool events = false;         ///< whether any can happen
  std::string state = {};      ///< names and sizes of what stands in a checkpoint's numbers
  // How much that is: nothing that a resumed run has to agree with.
  double most_samples = 0.0;    ///< of the whole run; fewer when it ends early
  std::size_t state_bytes = 0;  ///< of a checkpoint's numbers

  std::size_t particles() const;
  /// Numbers of one sample: the columns, then positions [particle][axis].
  std::size_t row() const;
};

enum class EventKind {
  slip,             ///< the pulled point runs ahead, far faster than its driver
  hop,              ///< a round body leaves the substrate for a moment
  turn,             ///< a body has completed a turn
  reversal,         ///< a body moves against its driver
  driver_reversal,  ///< a driver turns round
  tie,              ///< nothing but rounding decides where a quasistatic scene goes
  observed,         ///< what an observer of the scene tells of
};

constexpr auto word_table(EventKind) {
  using enum EventKind;
  return std::to_array<Word<EventKind>>({{slip, "slip"},
                                         {hop, "hop"},
                                         {turn, "turn"},
                                         {reversal, "reversal"},
                                         {driver_reversal, "driver_reversal"},
                                         {tie, "tie"},
                                         {observed, "observed"}});
}

inline constexpr std::size_t kEventKinds = kWordTable<EventKind>.size();

/// Something that happened. What a kind has no number for is not a number.
struct Event {
  EventKind kind = EventKind::slip;
  std::string_view name;  ///< of the driver, body or observer; good as long as the run lasts
  double time = 0.0;      ///< when it began
  double duration = 0.0;
  double size = 0.0;         ///< length of a slip, height of a hop, turns, way back of a reversal
  double energy_lost = 0.0;  ///< of a slip: heat of the whole scene meanwhile
  double peak_force = 0.0;   ///< of a slip: of the driver, along its way, when it began
  std::string_view label = {};  ///< of an observed one: its observer's name for the kind
};

/// Receives what a run leaves while it runs: samples and events, each in the order of time, and
/// now and then all that is needed to go on from here.
class RunSink {
 public:
  virtual ~RunSink() = default;
  /// Before anything else, also when a run is resumed.
  virtual void begin(const RunLayout& layout) = 0;
  /// One row: see RunLayout::row(). The first sample of a run is its start; of a resumed run, the
  /// first after the moment from which it resumes.
  virtual void sample(const std::vector<double>& row) = 0;
  virtual void event(const Event& event) { (void)event; }
  /// At the start, every `[run] checkpoint_every` seconds, when a run is stopped and at its end
  /// where more runs follow: whatever was sent so far belongs to the time before these numbers,
  /// whatever comes is after them. See RunOptions::resume_from.
  virtual void checkpoint(const RunState& state) { (void)state; }
  /// Without them none are taken for this sink.
  virtual bool wants_samples() const { return true; }

 protected:
  RunSink() = default;
};

/// Keeps what is done before and after a run proper, the choice of its integrator and runs that its
/// result is compared with, for a run that is stopped meanwhile and resumes later: by name.
class RunStore {
 public:
  virtual ~RunStore() = default;
  /// Returns the bytes kept last under this name; empty when there are none.
  virtual std::vector<std::byte> kept(const std::string& name) const = 0;
  /// Keeps bytes under this name. The run computes again whatever cannot be kept.
  virtual void keep(const std::string& name, std::vector<std::byte> bytes) = 0;

 protected:
  RunStore() = default;
};

struct RunProgress {
  double time = 0.0;
  double duration = 0.0;
  std::uint64_t steps = 0;
  double elapsed_seconds = 0.0;
  double time_before = 0.0;        ///< where a resumed run went on from
  std::uint64_t steps_before = 0;  ///< taken before that
};

struct RunOptions {
  RunSink* sink = nullptr;
  std::function<void(const RunProgress&)> on_progress;  ///< called a few times a second
  const std::atomic<bool>* stop = nullptr;              ///< set by a signal: end as interrupted
  /// End as interrupted, a few steps later, when evaluations and columns come to more than this.
  std::uint64_t most_cost = std::numeric_limits<std::uint64_t>::max();
  InstructionSet instruction_set = chosen_instruction_set();
  /// Threads that share the evaluations of forces with the calling one; the bits of results do not
  /// depend on it. It outlives the run, and is that of one run at a time.
  const Team* team = nullptr;
  /// Paths of the only observables that are wanted; empty: those of the scene's [measure].
  std::vector<std::string> observables = {};
  bool all_observables = false;              ///< whatever was asked for
  std::optional<Perturbation> perturbation;  ///< noise on the start; see also `[run] perturb`
  /// The final state of another run, to start from in place of the scene's start. Time and
  /// integrals count from 0. Throws InputError where that run's scene has not the same parts. A
  /// run that resumes is given the same.
  const FinalState* start_from = nullptr;
  FinalState* final_state = nullptr;  ///< filled where the run finishes
  /// The bytes of a checkpoint of the same scene: go on from there. Throws std::invalid_argument
  /// when they are not.
  const std::vector<std::byte>* resume_from = nullptr;
  RunStore* store = nullptr;   ///< for what is done besides the run proper
  bool watches_energy = true;  ///< warn where the energy balance does not close
  bool checks_step = true;     ///< refuse a fixed step beyond the stability limit
};

/// For an engine that is bound and not run: no second one beside it.
inline RunOptions options_to_bind() {
  RunOptions options;
  options.watches_energy = false;
  return options;
}

/// One run with the integrator that the scene is bound with, whatever accuracy it asks for; run()
/// in framework/study/accuracy/accuracy.hpp does all that a scene says. Throws InputError for what
/// only shows when the scene is bound; everything later is in the result. Allocates nothing between
/// the first step and the last.
RunResult run_as_bound(const std::shared_ptr<const Scene>& scene, const RunOptions& options = {});

}  // namespace tomlin
