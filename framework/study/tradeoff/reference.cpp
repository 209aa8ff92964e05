#include "framework/study/tradeoff/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/text.hpp"
#include "framework/study/tradeoff/methods.hpp"

namespace tomlin {
namespace {

/// The moves of the reference are to be at most this part of the tolerance.
constexpr double kPartOfTolerance = 1e-3;
/// Tolerance of adaptive schemes at a first look.
constexpr double kPilotTolerance = 1e-6;
/// Shares of the budget for the scheme, its pilot, the second scheme and the runs in quadruple.
constexpr double kShareOfMain = 0.3;
constexpr double kShareOfPilot = 0.05;
constexpr double kShareOfSecond = 0.15;
constexpr double kShareOfQuadruple = 0.05;
constexpr double kMostSecondsOfQuadruple = 2.0;
/// A run in quadruple takes about so many times longer.
constexpr double kSlownessOfQuadruple = 500.0;
/// A value within so many of its own errors of zero is not resolved; it is zero where its error is
/// at most this part of the unit that the scene's own scales give it.
constexpr double kErrorsFromZero = 10.0;
constexpr double kRoundingOfUnits = 1e-12;
/// Moves below this part of the value are rounding.
constexpr double kReferenceRounding = 1e-14;

/// The dimension of what stands at a path of the summary; counts and angles have none.
Dimension dimension_of(std::string_view path) {
  const ResultQuantity* quantity = quantity_at(path);
  return quantity == nullptr ? dimension::none : quantity->dimension;
}

bool may_be_reference(const Method& method) {
  return method.is_own_model() && method.number_type == NumberType::double_precision &&
         method.refused.empty();
}

/// Cost at the finest tolerance, from that of a coarser one and the order.
double predicted_cost(const Method& method, const Measurement& pilot, double at) {
  const double order = std::max(1, method.integrator->order);
  return static_cast<double>(pilot.cost()) * std::pow(at / kFinestTolerance, 1.0 / order);
}

/// A scheme with its step or tolerance.
struct ReferenceSetup {
  const Method* method = nullptr;
  double resolution = 0.0;
};

class ReferenceSearch {
 public:
  ReferenceSearch(const Variants& variants, const std::vector<Method>& methods, Measurer& measurer,
                  double tolerance)
      : variants_(variants), measurer_(measurer), tolerance_(tolerance) {
    for (const Method& method : methods) {
      if (may_be_reference(method)) candidates_.push_back(&method);
    }
    const Scene& scene = variants.scene();
    const Dimension dimension = dimension_of(measurer.observable());
    found_.natural = natural_units(scene).of(dimension) / scene_unit(scene.units, dimension);
  }

  std::optional<Reference> find(std::string& why) {
    const ReferenceSetup start = choose();
    if (start.method == nullptr) {
      why = why_none_;
      return std::nullopt;
    }
    tighten(start);
    check_by_second(*start.method);
    check_in_quadruple(*start.method);
    return found_;
  }

 private:
  double share(double part) const { return part * measurer_.budget(); }

  /// The search begins with the scheme that promises the finest tolerance at least cost: each
  /// adaptive one is tried, coarser where none gets through; then those with fixed steps.
  ReferenceSetup choose() {
    for (const double tolerance : {kPilotTolerance, 1e-4, 1e-2}) {
      const ReferenceSetup best = cheapest(tolerance);
      if (best.method != nullptr) return best;
    }
    ReferenceSetup best;
    for (const Method* method : candidates_) {
      if (method->resolution != Resolution::step) continue;
      const double dt = first_step(*method);
      if (!look(*method, dt).defined()) continue;
      if (best.method == nullptr || method->integrator->order > best.method->integrator->order) {
        best = {method, dt};
      }
    }
    return best;
  }

  ReferenceSetup cheapest(double tolerance) {
    ReferenceSetup best;
    double least = std::numeric_limits<double>::infinity();
    for (const Method* method : candidates_) {
      if (method->resolution != Resolution::tolerance) continue;
      const Measurement& pilot = look(*method, tolerance);
      if (!pilot.defined()) continue;
      const double cost = predicted_cost(*method, pilot, tolerance);
      if (cost >= least) continue;
      least = cost;
      best = {method, tolerance};
    }
    return best;
  }

  const Measurement& look(const Method& method, double resolution) {
    const Measurement& pilot = measurer_.at(method, resolution, share(kShareOfPilot));
    if (pilot.end == TrialRun::End::finished && !pilot.defined()) {
      refuse_input(FaultCode::observable_undefined, "--observable", measurer_.observable(),
                   "undefined in this scene", "an observable that has a value in it");
    }
    if (!pilot.defined()) {
      why_none_ += fmt::format("{}{} at {} = {:g}: {}", why_none_.empty() ? "" : "; ", method.name,
                               to_string(method.resolution), resolution, pilot.why);
    }
    return pilot;
  }

  double first_step(const Method& method) const {
    constexpr double kFirstPart = 1e-3;  // of the run, where nothing limits the step
    return std::min(0.5 * method.stable_step, kFirstPart * variants_.scene().run.duration);
  }

  static double finer(const Method& method, double resolution) {
    return method.resolution == Resolution::step ? 0.5 * resolution : 0.1 * resolution;
  }

  static bool can_be_finer(const Method& method, double resolution) {
    constexpr double kRoundingFactor = 1.01;
    return method.resolution == Resolution::step ||
           finer(method, resolution) * kRoundingFactor >= kFinestTolerance;
  }

  /// A move that is small enough for this value.
  double goal() const {
    const double size = std::abs(found_.value);
    // A value that is tiny against its first moves is zero, or not resolved.
    return kPartOfTolerance * tolerance_ *
           (size > kErrorsFromZero * found_.error ? size : kRoundingOfUnits * found_.natural);
  }

  void keep(const Method& method, double resolution, const Measurement& at) {
    found_.method = method.name;
    found_.resolution = method.resolution;
    found_.resolution_value = resolution;
    found_.value = *at.value;
    found_.cost = at.cost();
    found_.seconds = at.seconds;
  }

  void tighten(const ReferenceSetup& start) {
    const Method& method = *start.method;
    const double until = measurer_.used() + share(kShareOfMain);
    double resolution = start.resolution;
    keep(method, resolution, measurer_.at(method, resolution, share(kShareOfPilot)));
    found_.move = found_.error = std::abs(found_.value);
    int small_moves = 0;
    while (small_moves < 2) {
      if (!can_be_finer(method, resolution)) {
        found_.finest = true;
        break;
      }
      resolution = finer(method, resolution);
      const Measurement& next = measurer_.at(method, resolution, until - measurer_.used());
      if (!next.defined()) {
        found_.finest = next.end == TrialRun::End::failed;
        break;
      }
      const double move = std::abs(*next.value - found_.value);
      keep(method, resolution, next);
      found_.move = found_.error = std::max(move, kReferenceRounding * std::abs(found_.value));
      small_moves = found_.error <= goal() ? small_moves + 1 : 0;
    }
    found_.settled = small_moves > 0;
  }

  /// Another family first: one that solves equations against one that does not.
  const Method* second_to(const Method& main) const {
    const auto rank = [&main](const Method& method) {
      const bool other_family = method.integrator->needs_tangent != main.integrator->needs_tangent;
      const bool adaptive = method.resolution == Resolution::tolerance;
      return 100 * static_cast<int>(other_family) + 50 * static_cast<int>(adaptive) +
             method.integrator->order;
    };
    const Method* best = nullptr;
    for (const Method* method : candidates_) {
      if (method->integrator == main.integrator) continue;
      if (best == nullptr || rank(*method) > rank(*best)) best = method;
    }
    return best;
  }

  void check_by_second(const Method& main) {
    const Method* second = second_to(main);
    if (second == nullptr || measurer_.is_over()) return;
    const double until = measurer_.used() + share(kShareOfSecond);
    double resolution =
        second->resolution == Resolution::step ? first_step(*second) : kPilotTolerance;
    std::optional<double> last;
    for (;;) {
      const Measurement& now = measurer_.at(*second, resolution, until - measurer_.used());
      if (!now.defined()) break;
      second_ = {second, resolution};
      found_.second = second->name;
      found_.second_differs = std::abs(*now.value - found_.value);
      found_.second_settled = last && std::abs(*now.value - *last) < 0.5 * *found_.second_differs;
      last = now.value;
      found_.second_agrees = *found_.second_differs <= std::max(goal(), found_.error);
      if (found_.second_agrees) return;
      if (!can_be_finer(*second, resolution)) break;
      resolution = finer(*second, resolution);
    }
    // Two schemes that have stopped moving at different positions: neither is known any better.
    if (found_.second_settled) {
      found_.error = std::max(found_.error, *found_.second_differs);
      found_.settled = found_.settled && found_.error <= goal();
    }
  }

  /// Returns the settings of a scheme for a part of the run, window included.
  std::vector<Setting> shortened(const ReferenceSetup& scheme, double part) const {
    const Scene& scene = variants_.scene();
    std::vector<Setting> settings = scheme.method->at(scheme.resolution);
    settings.push_back({"run.duration", fmt::format("{}", part * scene.run.duration)});
    if (scene.measure.unit != MeasureSettings::Unit::whole_run) {
      settings.push_back({"measure.from", fmt::format("{}", part * scene.measure.from)});
      if (scene.measure.to) {
        settings.push_back({"measure.to", fmt::format("{}", part * *scene.measure.to)});
      }
    }
    return settings;
  }

  /// The scheme itself where it is available in quadruple, or else the second one, which shows what
  /// rounding does to this scene.
  ReferenceSetup in_quadruple(const Method& main) const {
    if (main.integrator->bind.in_quadruple != nullptr) return {&main, found_.resolution_value};
    const bool other = second_.method != nullptr && second_.method->integrator->bind.in_quadruple;
    return other ? second_ : ReferenceSetup{};
  }

  void check_in_quadruple(const Method& main) {
    const ReferenceSetup scheme = in_quadruple(main);
    if (scheme.method == nullptr) {
      found_.unchecked = main.name + " is not available in it";
    } else if (variants_.scene().run.until) {
      found_.unchecked = "a run until it is steady has no length to shorten";
    } else if (measurer_.is_over()) {
      found_.unchecked = "over budget";
    }
    if (!found_.unchecked.empty()) return;
    const double seconds = std::min(share(kShareOfQuadruple), kMostSecondsOfQuadruple);
    const double known = measurer_.at(*scheme.method, scheme.resolution, seconds).seconds;
    const double part = std::min(1.0, seconds / (std::max(known, 1e-6) * kSlownessOfQuadruple));
    const std::vector<Setting> in_double = shortened(scheme, part);
    std::vector<Setting> in_quadruple = in_double;
    in_quadruple.push_back(
        {"run.number_type", quoted_text(to_string(NumberType::quadruple_precision))});
    constexpr double kMostTimesSlower = 2.0;  // the slowness is no more than a guess
    const Measurement one = measurer_.with(in_double, kMostTimesSlower * seconds);
    const Measurement other = measurer_.with(in_quadruple, kMostTimesSlower * seconds);
    if (!one.defined() || !other.defined()) {
      found_.unchecked = one.defined() ? other.why : one.why;
      return;
    }
    found_.quadruple = scheme.method->name;
    found_.quadruple_part = part;
    found_.quadruple_differs = std::abs(*one.value - *other.value);
    if (scheme.method == &main) found_.error = std::max(found_.error, *found_.quadruple_differs);
  }

  const Variants& variants_;
  Measurer& measurer_;
  double tolerance_;
  std::vector<const Method*> candidates_;
  std::string why_none_;
  ReferenceSetup second_;  ///< with the finest resolution that it got to
  Reference found_;
};

}  // namespace

ErrorScale error_scale(const Reference& reference) {
  const double size = std::abs(reference.value);
  if (size > kErrorsFromZero * reference.error) return {true, true, size};
  return {false, reference.error <= kRoundingOfUnits * reference.natural, reference.natural};
}

std::optional<Reference> find_reference(const Variants& variants,
                                        const std::vector<Method>& methods, Measurer& measurer,
                                        double tolerance, std::string& why) {
  return ReferenceSearch(variants, methods, measurer, tolerance).find(why);
}

}  // namespace tomlin
