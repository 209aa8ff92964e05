#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/instruction_set.hpp"
#include "framework/model/assembly.hpp"
#include "framework/scene/scene.hpp"

/// Runs a scene from start to end and reports what happened.
namespace tomlin {

enum class RunStatus { finished, interrupted, failed };

/// "finished", "interrupted", "failed".
const char* to_string(RunStatus status);

/// Why a run failed, with its place.
struct RunFailure {
  std::uint64_t step = 0;  ///< index of the step that failed, from 0
  double time = 0.0;       ///< at its start
  std::string body;
  std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
  std::string axis;
  std::string force;  ///< the force that acts most strongly there
  std::string what;   ///< what was noticed
  std::string cause;  ///< the likely cause
};

/// One sentence with everything in it.
std::string to_string(const RunFailure& failure);

/// Means, work and extremes are over the window, final_force is at the end of the run.
struct DriverResult {
  std::string name;
  std::vector<double> mean_force;  ///< [dimension]; empty when the window was not reached
  std::vector<double> final_force;
  std::vector<double> max_force;
  std::vector<double> min_force;
  std::optional<double> static_force;  ///< first maximum along the pull in the whole run
  std::optional<double> work;
  std::optional<double> work_per_distance;
  std::optional<double> distance;
};

struct BodyResult {
  std::string name;
  std::vector<double> centre_of_mass;  ///< at the end
  std::vector<double> velocity;        ///< at the end
  std::optional<double> rotation;      ///< rad, unwrapped, counter-clockwise positive, at the end
  std::optional<double> turns;         ///< over the window
  std::optional<double> rolling;       ///< -R dphi/dx over the window
  std::vector<double> mean_velocity;   ///< over the window
  std::optional<double> max_speed;     ///< of the centre, over the window
};

/// The energy ledger. Kinetic and potential energy are those at the end of the run; the rest is
/// over the window, each term integrated on its own with the scheme's order.
struct EnergyResult {
  double kinetic = 0.0;
  double potential = 0.0;
  std::optional<double> work_in;        ///< by all drivers, at their pulled ends
  std::optional<double> heat_out;       ///< to all dampers
  std::optional<double> stored_change;  ///< of kinetic and potential energy
  /// stored_change + heat_out - work_in: what the integrator itself added.
  std::optional<double> numerical_work;
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

struct RunResult {
  RunStatus status = RunStatus::finished;
  std::optional<RunFailure> failure;
  double end_time = 0.0;
  std::uint64_t steps = 0;
  std::uint64_t refused_steps = 0;
  std::uint64_t force_evaluations = 0;
  double window_from = 0.0;
  double window_to = 0.0;
  std::vector<DriverResult> drivers;
  std::vector<BodyResult> bodies;
  std::optional<EnergyResult> energy;        ///< with `[run] ledger`
  std::vector<DeterminedResult> determined;  ///< with `[run] perturb`
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::string>> left_out;  ///< force and why it was not built
  double wall_seconds = 0.0;
  double steps_per_second = 0.0;
  InstructionSet instruction_set = InstructionSet::baseline;
};

/// A column of observables.csv: "driver.force.x" and "force".
struct SampleColumn {
  std::string name;
  std::string unit;
};

/// Receives samples in the order of time.
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  virtual void begin(const std::vector<SampleColumn>& columns) = 0;
  virtual void sample(const std::vector<double>& values) = 0;

 protected:
  SampleSink() = default;
};

struct RunProgress {
  double time = 0.0;
  double duration = 0.0;
  std::uint64_t steps = 0;
  double elapsed_seconds = 0.0;
};

struct RunOptions {
  SampleSink* sink = nullptr;                           ///< used when the scene has output.every
  std::function<void(const RunProgress&)> on_progress;  ///< called a few times a second
  const std::atomic<bool>* stop = nullptr;              ///< set by a signal: end as interrupted
  InstructionSet instruction_set = chosen_instruction_set();
  std::optional<Perturbation> perturbation;  ///< noise on the start; see also `[run] perturb`
};

/// Throws InputError for what only shows when the scene is bound; everything later is in the
/// result. Allocates nothing between the first step and the last.
RunResult run(const std::shared_ptr<const Scene>& scene, const RunOptions& options = {});

}  // namespace tomlin
