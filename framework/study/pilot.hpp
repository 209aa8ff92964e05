#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// `[run] accuracy`: the program picks the integrator, and says how large the errors are.
///
/// A pilot, three stick-slip cycles where there is a driver, is run with every integrator that the
/// scene admits, from coarse to fine, and held against a far finer run. Cost is counted in
/// evaluations of all forces and columns of Jacobians, never in seconds, so that the same scene
/// gets the same integrator everywhere. The cheapest setting whose error after the pilot's first
/// cycle is a tenth of what is asked for becomes the companion; the run itself takes the cheapest
/// one that costs at least 1/0.6 of that and has at most a tenth of its error.
namespace tomlin {

/// What the companion may cost, as a part of the run.
inline constexpr double kMostForCompanion = 0.6;

/// The part of the difference to a companion ten times as bad that is taken for the error. As long
/// as the companion is three times as bad in truth, it is not below the error.
inline constexpr double kShareOfDifference = 0.5;

/// Evaluations times coordinates that one run of the pilot may take: seconds.
inline constexpr double kMostPilotWork = 4e8;

struct ChosenIntegrator {
  std::shared_ptr<const Scene> scene;      ///< with it; otherwise as it was asked for
  std::shared_ptr<const Scene> companion;  ///< the same, cheaper; null: nothing cheaper will do
  std::string text;                        ///< the integrator as a line of a scene
  std::string companion_text;
  double share = 1.0;            ///< of the difference to the companion that is the error
  double length = 1.0;           ///< of the scene: its shortest period where it has one
  std::uint64_t pilot_cost = 0;  ///< evaluations and columns
  bool interrupted = false;      ///< `stop` was set meanwhile; nothing else counts then
  std::vector<std::string> warnings;
};

/// For a scene with an accuracy. Throws InputError for what every integrator refuses. Where nothing
/// gets through the pilot, the scene is left with the integrator that it was bound with.
ChosenIntegrator choose_integrator(const std::shared_ptr<const Scene>& scene,
                                   const Registry& registry,
                                   const std::atomic<bool>* stop = nullptr,
                                   double most_work = kMostPilotWork);

/// The largest relative difference of the mean forces of drivers; where nothing drives, of the mean
/// velocities of bodies, held against their largest speeds. `length` is one of the scene's.
double relative_difference(const RunResult& result, const RunResult& reference, double length);

}  // namespace tomlin
