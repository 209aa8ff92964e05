#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// `[run] accuracy`: the program picks the integrator, and says how large the errors are.
///
/// A pilot, three stick-slip cycles where there is a driver, is run with every integrator that the
/// scene admits, from coarse to fine, and held against a far finer run. Cost is counted in
/// evaluations of all forces and columns of Jacobians, never in seconds, so that the same scene
/// gets the same integrator everywhere. The cheapest setting whose error after the pilot's first
/// cycle is a tenth of what is asked for becomes the first companion; the run itself takes the next
/// finer setting of the same integrator, and the second companion the next coarser one. A third
/// companion is of another family, an integrator that solves equations beside one that does not:
/// what one family gets wrong at every setting shows in no difference between its own runs.
namespace tomlin {

/// The cost that all companions together may have, as a part of the run: where stability sets the
/// steps, a wider tolerance spares nothing. That of another family may always take what the pilot
/// has taken.
inline constexpr double kMostForCompanions = 2.5;

/// Companions of the run's own integrator, from the nearer one on.
inline constexpr std::size_t kCompanions = 2;
using CompanionShares = std::array<double, kCompanions>;

/// Shares of the differences to companions that are taken for the error, the larger of the two. To
/// tolerances ten and a hundred times as wide differences are 9 and 99 times the error where it
/// goes with the tolerance. Shares that come to 18 and 50 of it leave one result in a hundred
/// outside, over random scenes, and state 50 times the error in the median
/// (tests/properties/stated_errors.py); one companion alone left four, whatever its share.
inline constexpr CompanionShares kSharesOfTolerances = {2.0, 0.5};

/// Shares for steps twice and four times as long, of a scheme of this order.
CompanionShares shares_of_steps(int order);

/// The factor of the share where there is one companion alone, whose difference may be small by
/// chance.
inline constexpr double kSingleCompanion = 2.0;

/// The share of the difference to a companion of another family: the run's own error, and a quarter
/// of it for that of the companion.
inline constexpr double kShareOfOtherFamily = 1.25;

/// Evaluations times coordinates that one run of the pilot may take, which are some seconds.
inline constexpr double kMostPilotWork = 4e8;

/// A coarser run of the same scene, or one by another family.
struct Companion {
  std::shared_ptr<const Scene> scene;
  std::string text;    ///< the integrator as a line of a scene
  double share = 1.0;  ///< of the difference to it that is the error
  bool other_family = false;
};

/// Key that warnings of the choice and of the errors name.
inline constexpr const char* kAccuracyKey = "run.accuracy";

struct ChosenIntegrator {
  std::shared_ptr<const Scene> scene;  ///< with it; otherwise as it was asked for
  std::string text;                    ///< the integrator as a line of a scene
  std::vector<Companion> companions;   ///< none: nothing cheaper will do
  double length = 1.0;                 ///< of the scene: its shortest period where it has one
  std::uint64_t pilot_cost = 0;        ///< evaluations and columns
  bool interrupted = false;            ///< `stop` was set meanwhile; nothing else counts then
  std::vector<Warning> warnings;
};

/// Chooses the integrator of a scene with an accuracy, or reads the choice from the store. Throws
/// InputError for what every integrator refuses. Where no run gets through the pilot, the scene is
/// left with the integrator that it was bound with.
ChosenIntegrator choose_integrator(const std::shared_ptr<const Scene>& scene,
                                   const Registry& registry,
                                   const std::atomic<bool>* stop = nullptr,
                                   double most_work = kMostPilotWork, RunStore* store = nullptr);

/// The largest relative difference of the mean forces of drivers; where nothing drives, of the mean
/// velocities of bodies, held against their largest speeds. `length` is one of the scene's.
double relative_difference(const RunResult& result, const RunResult& reference, double length);

}  // namespace tomlin
