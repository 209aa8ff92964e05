#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/study/tradeoff/methods.hpp"
#include "framework/study/tradeoff/reference.hpp"
#include "framework/study/tradeoff/sensitivity.hpp"

/// Cost of accuracy on a scene, and the cheapest way to reach the accuracy that is asked for.
namespace tomlin {

struct TradeoffRequest {
  std::string observable;
  double tolerance =
      1e-3;  ///< of the observable, relative to it; where it is zero, to the scene's units
  double budget = 60.0;  ///< seconds of the machine's time
  const std::atomic<bool>* stop = nullptr;
  /// Called before each part of the work with what it is: "reference", "rk4".
  std::function<void(const std::string&)> on_progress = {};
  /// Evaluations that count as a second in place of the machine's: no result depends on its speed.
  double pace = 0.0;
};

/// One run of the work-precision diagram.
struct TradeoffPoint {
  std::size_t method = 0;   ///< index into Tradeoff::methods
  double resolution = 0.0;  ///< its step or its tolerance
  double value = 0.0;
  double error = 0.0;  ///< distance from the reference
  std::uint64_t evaluations = 0;
  std::uint64_t columns = 0;
  double seconds = 0.0;
  /// Accuracies at which no other point has fewer seconds, or costs less: n for 10^-n.
  std::vector<int> fastest_at;
  std::vector<int> cheapest_at;

  std::uint64_t cost() const { return evaluations + columns; }
};

/// A method, or settings of one, that are not in the diagram.
struct TradeoffGap {
  enum class Kind {
    refused,
    unstable,
    failed,
    over_budget,
    costly,
    undefined
  } kind = Kind::refused;
  std::string method;
  std::string why;
};

constexpr auto word_table(TradeoffGap::Kind) {
  using enum TradeoffGap::Kind;
  return std::to_array<Word<TradeoffGap::Kind>>({{refused, "refused"},
                                                 {unstable, "unstable"},
                                                 {failed, "failed"},
                                                 {over_budget, "over budget"},
                                                 {costly, "too costly"},
                                                 {undefined, "undefined"}});
}

struct Recommendation {
  std::size_t point = 0;          ///< index into Tradeoff::points
  double tolerance = 0.0;         ///< that it meets: the one asked for, or what has a meaning
  std::vector<Setting> settings;  ///< of the scene
};

struct Tradeoff {
  std::string observable;  ///< its path in full
  UnitSystem units = UnitSystem::reduced;
  double tolerance = 0.0;
  double budget = 0.0;
  double seconds = 0.0;  ///< used
  bool interrupted = false;
  std::vector<Method> methods;  ///< all of them
  std::optional<Reference> reference;
  ErrorScale scale;
  Sensitivity sensitivity;
  std::vector<TradeoffPoint> points;  ///< method after method, from coarse to fine
  std::vector<TradeoffGap> gaps;
  std::optional<Recommendation> recommendation;
  std::string why_none;  ///< when there is no recommendation

  double error_of(const TradeoffPoint& point) const { return point.error / scale.size; }
};

/// Measures the trade. The reference is found first, then whether starts that hardly differ change
/// the result, then every method from coarse to fine until it is a hundred times better than the
/// tolerance, as good as the reference, or the budget is over; at last the steps near the tolerance
/// are refined. The recommendation is the cheapest setting, in force evaluations with Jacobian
/// columns, that keeps four fifths of the tolerance and whose finer settings all do.
///
/// Throws InputError for an observable that there is not, or that is undefined in this scene, and
/// for a scene that cannot be bound. A budget that is too small is not an error.
Tradeoff measure_tradeoff(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const TradeoffRequest& request);

/// The settings as lines of a scene, ready to paste: "[run]", "integrator = ...".
std::vector<std::string> scene_lines(const std::vector<Setting>& settings);

}  // namespace tomlin
