#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "framework/model/model.hpp"

/// The plan of a run, in times: resolved from the scene before the first step.
namespace tomlin {

/// Steps in a block, after which the origin, rotations and signals are looked at. A particle moves
/// less than a period in a step, so that the origin is never left far behind.
inline constexpr std::int64_t kBlock = 16;
/// A remainder of the run below this part of a step is no step.
inline constexpr double kNoStep = 1e-9;

struct RunPlan {
  double dt = 0.0;        ///< step of the grid; 0: the scheme chooses its own
  double duration = 0.0;  ///< whole periods where the run is until it is steady
  double window_from = 0.0;
  double window_to = 0.0;        ///< where the run is until it is steady, of the first period
  double period = 0.0;           ///< of the driver, as a time, where it is; else 0
  std::int64_t whole_steps = 0;  ///< of the grid, that the run has room for
};

/// Throws InputError for a window outside of the run or without a driver to count periods of, and
/// for a run of more steps or samples than could ever be taken.
RunPlan plan_run(const Model& model);

/// Returns the speed of a support.
double speed_of(const Drive& drive);
/// Returns its speed along the axes on which a spring acts, which is the pull: motion along others
/// pulls nothing. Without a spring on any axis that it moves along, it is that of the support.
double pull_speed_of(const Drive& drive);
/// Whether it is a driver of steady velocity that is not zero.
bool drags(const Drive& drive);
/// Whether it also is a spring, whose force tells where what it pulls is.
bool pulls(const Drive& drive);
/// Whether it turns back where an observable passes a value.
bool reverses(const Model& model, const Model::Driver& driver);
/// In which a driver moves by `[measure] period`, or by the one period that forces declare along
/// its way; nothing where there is no such period, or its velocity is not steady.
std::optional<double> time_of_period(const Model& model, const Drive& drive);
/// The times that means are taken over, for their statistical errors: a period of the first driver
/// that has one, where a window of this length has enough of them, else a block of steps.
double part_of_window(const Model& model, double dt, double length);
/// Returns the body that a spring pulls; nothing for a prescribed body.
std::optional<std::size_t> body_pulled_by(const Model& model, const Model::Driver& driver);

}  // namespace tomlin
