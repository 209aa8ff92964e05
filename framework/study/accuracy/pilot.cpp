#include "framework/study/accuracy/pilot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/model/model.hpp"
#include "framework/model/scales.hpp"
#include "framework/output/store_file.hpp"
#include "framework/run/engine.hpp"
#include "framework/study/accuracy/kept_choice.hpp"
#include "framework/study/tradeoff/methods.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Errors in the pilot, as parts of the allowed one. A whole run differs from the pilot: the first
// companion has a margin of ten. One of another family, whose error is stated as it is, may be ten
// times as far off over a whole run.
constexpr double kErrorOfReference = 1e-4;
constexpr double kErrorOfCompanion = 0.1;
constexpr double kErrorOfOtherFamily = 0.02;
constexpr double kErrorStated = 0.5;

// The search for a reference: each pass shortens the pilot to a quarter.
constexpr int kOrderOfReference = 8;
constexpr int kMostShortenings = 6;
constexpr double kFirstCost = 2e3;  ///< that a reference may have, in evaluations
/// The cost of a setting at most, as a multiple of that of the reference.
constexpr double kMostTimesReference = 4.0;
/// Costs that are projected from a part of a run are at most so many times too high.
constexpr double kMostOverestimated = 2.0;
/// The share of the remaining cost that a companion of another family may take in the pilot: a
/// whole run costs a little more or less than its part.
constexpr double kShareOfRemainingCost = 0.8;
/// Two successive settings have come to rest where their errors differ by at most this part.
constexpr double kChangeAtRest = 0.1;
constexpr double kLeastPart = 1e-12;  ///< of a run, which its cost is divided by

constexpr std::array kTolerances = {1e-2, 1e-3, 1e-4,  1e-5,  1e-6,  1e-7,
                                    1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13};
constexpr int kMostResolutions = static_cast<int>(kTolerances.size());
/// The longest fixed step is this part of the stable one, and at most the pilot's duration over
/// kFewestSteps.
constexpr double kShareOfStableStep = 0.9;
constexpr double kFewestSteps = 50.0;
/// A mean below this part of the largest value is zero by cancellation, and is compared with that
/// part.
constexpr double kCancellation = 1e-3;
/// A body that moves by a smaller part of the scene's length does not move.
constexpr double kLeastDistance = 1e-9;

/// Quantities that headlines are made of.
constexpr const char* kHeadlines[] = {"drivers.mean_force", "drivers.max_force",
                                      "drivers.min_force", "bodies.mean_velocity",
                                      "bodies.max_speed"};

/// A vector of the pilot's results, and a size that its error is never held below.
struct Headline {
  std::vector<double> components;
  double scale = 0.0;
  double nothing = 0.0;  ///< a difference that is none
};

/// The mean forces of drivers; where nothing drives, the mean velocities of bodies, held against
/// their largest speeds.
std::vector<Headline> headlines(const RunResult& result, double length) {
  std::vector<Headline> all;
  const auto components = [](const ResultValue& value) {
    return std::vector<double>(value.begin(), value.end());
  };
  for (const ResultGroup& driver : result.family("drivers")) {
    double largest = 0.0;
    for (const char* extreme : {"max_force", "min_force"}) {
      for (const double force : driver[extreme]) largest = std::max(largest, std::abs(force));
    }
    all.push_back({components(driver["mean_force"]), largest});
  }
  if (!all.empty()) return all;
  for (const ResultGroup& body : result.family("bodies")) {
    all.push_back({components(body["mean_velocity"]),
                   body["max_speed"].value_or(0.0) / kCancellation,
                   kLeastDistance * length / (result.window_to - result.window_from)});
  }
  return all;
}

/// Length of a pilot, and where its window begins.
struct Piece {
  double duration = 0.0;
  double from = 0.0;
};

/// The first slip comes when the spring has been stretched by stick_slip() / (2 pi) periods, and
/// slips are as far apart where they are long. The pilot has as many of them after the last force
/// has become active, which it does in the same part of the pilot as of the run.
Piece pilot_of(const std::shared_ptr<const Scene>& scene) {
  constexpr double kTau = 6.283185307179586;
  double cycle = 0.0;
  for (const Sliding& sliding : scales_of(scene).sliding) {
    if (sliding.washboard_frequency <= 0.0) continue;
    const double periods = sliding.stiffness > 0.0 ? std::ceil(sliding.stick_slip() / kTau) : 1.0;
    cycle = std::max(cycle, std::max(1.0, periods) * kTau / sliding.washboard_frequency);
  }
  const double duration = scene->run.duration;
  double begun = 0.0;  // the part of the run in which forces are still to become active
  for (const SceneForce& force : scene->forces) {
    if (force.active) begun = std::max(begun, force.active->from / duration);
  }
  if (begun < 1.0) cycle /= 1.0 - begun;
  // A part of the run has to do where there is no period.
  if (cycle == 0.0) return {duration / 8.0, duration / 24.0};
  if (3.0 * cycle >= duration) return {duration, duration / 3.0};
  return {3.0 * cycle, cycle};
}

/// Forces become active and inactive in the same part of the pilot as of the run.
std::shared_ptr<const Scene> shortened(const Scene& scene, const Piece& piece) {
  auto result = std::make_shared<Scene>(scene);
  const double part = piece.duration / scene.run.duration;
  for (SceneForce& force : result->forces) {
    if (!force.active) continue;
    force.active->from *= part;
    if (force.active->until) *force.active->until *= part;
  }
  result->run.duration = piece.duration;
  result->run.until.reset();
  result->run.perturb.reset();
  result->measure = {};
  result->measure.unit = MeasureSettings::Unit::time;
  result->measure.from = piece.from;
  result->output.every.reset();
  return result;
}

constexpr int kReferenceLevel = -1;

/// A setting that was tried.
struct Tried {
  std::size_t method = 0;
  int level = kReferenceLevel;  ///< of the method's settings, from coarse to fine
  double resolution = 0.0;
  double cost = 0.0;
  double error = kInfinity;
  bool finished = true;
};

/// A setting that took more than it was allowed to.
struct TooExpensive {
  std::size_t method = 0;
  int level = 0;
  double at_least = 0.0;  ///< what all of it takes
};

/// A method that may become the reference, and what it would cost.
struct Hopeful {
  std::size_t method = 0;
  double projected = 0.0;
};

class Pilot {
 public:
  Pilot(std::shared_ptr<const Scene> scene, const Registry& registry, const std::atomic<bool>* stop,
        double most_work)
      : scene_(std::move(scene)),
        variants_(scene_, registry),
        accuracy_(*scene_->run.accuracy),
        stop_(stop),
        piece_(pilot_of(scene_)) {
    const auto coordinates = static_cast<double>(Model(scene_).coordinate_count());
    most_cost_ = std::max(1.0, most_work / std::max(1.0, coordinates));
    for (Method& method : methods_of_own_model(variants_)) {
      if (method.refused.empty()) {
        methods_.push_back(std::move(method));
      } else {
        refusals_ += (refusals_.empty() ? "" : "; ") + method.name + ": " + method.refused;
      }
    }
    if (!methods_.empty()) length_ = methods_.front().absolute_share;
    if (methods_.empty()) {
      // Mostly the scene's own fault, which is reported once, where it occurs.
      (void)Engine(scene_, options_to_bind());
      throw InputError(
          {Fault(FaultCode::integrator_unsuitable, scene_->run.location, "run.accuracy", "",
                 "no integrator can treat this scene: " + refusals_, "an integrator")});
    }
  }

  ChosenIntegrator choose() {
    find_reference();
    const double wanted = kErrorOfCompanion * accuracy_;
    climb_all(wanted);
    const std::optional<Tried> first = confirmed(wanted);
    const std::optional<Tried> main = first ? main_beside(*first) : most_accurate();
    ChosenIntegrator chosen;
    chosen.pilot_cost = cost_;
    chosen.length = length_;
    chosen.interrupted = interrupted();
    if (chosen.interrupted) return chosen;
    if (!main) return as_it_is(std::move(chosen));
    if (main->error > accuracy_) {
      chosen.warnings.push_back(warning_of(*main));
    }
    chosen.text = line(*main);
    chosen.scene = variants_.with_integrator(chosen.text);
    const CompanionShares shares = shares_of(methods_[main->method]);
    for (const Tried& one : coarser_than(*main)) {
      chosen.companions.push_back(companion_at(one, shares[chosen.companions.size()]));
    }
    // One of another family agrees with the run by its own means, and says nothing of the share.
    const bool alone = chosen.companions.size() <= 1;
    add_other_family(*main, chosen);
    if (alone && !chosen.companions.empty()) chosen.companions.front().share *= kSingleCompanion;
    return chosen;
  }

 private:
  bool interrupted() const { return stop_ != nullptr && stop_->load(); }

  /// The methods for a reference: adaptive and, where there are such, of high order. A scheme of
  /// lower order keeps its tolerance less well, and errs in the same way as what is held against
  /// it. Explicit ones first.
  std::vector<std::size_t> references() const {
    const auto order = [this](std::size_t k) { return methods_[k].integrator->order; };
    std::vector<std::size_t> found;
    int highest = 0;
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      if (methods_[k].resolution != Resolution::tolerance) continue;
      found.push_back(k);
      highest = std::max(highest, order(k));
    }
    const int least = std::min(highest, kOrderOfReference);
    std::erase_if(found, [&](std::size_t k) { return order(k) < least; });
    std::stable_sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
      const bool implicit = methods_[a].integrator->needs_tangent;
      if (implicit != methods_[b].integrator->needs_tangent) return !implicit;
      return order(a) > order(b);
    });
    return found;
  }

  /// The integrator that a scene without one is bound with, with its defaults.
  ChosenIntegrator as_it_is(ChosenIntegrator chosen) const {
    chosen.scene = scene_;
    chosen.text = fmt::format("{{ type = \"{}\" }}", scene_->run.integrator.record->name);
    chosen.warnings.push_back(
        {FaultCode::run_accuracy_no_pilot,
         fmt::format("accuracy {:g}: no integrator got through the pilot; {} is taken as it is",
                     accuracy_, chosen.text),
         kAccuracyKey});
    return chosen;
  }

  /// Warns that the error of the most accurate setting is larger than asked for or not known.
  Warning warning_of(const Tried& best) const {
    if (!std::isfinite(best.error)) {
      return {FaultCode::run_accuracy_no_reference,
              fmt::format("accuracy {:g}: the pilot found no reference to compare {} with",
                          accuracy_, line(best)),
              kAccuracyKey};
    }
    return {FaultCode::run_accuracy_not_reached,
            fmt::format("accuracy {:g}: the most accurate setting that the pilot found, {}, has an "
                        "error of {:.1e}",
                        accuracy_, line(best), best.error),
            kAccuracyKey};
  }

  /// Finds the reference: the cheapest, whichever it is.
  void find_reference() {
    for (int pass = 0; pass < kMostShortenings && !interrupted(); ++pass) {
      if (look_for_reference()) return;
      piece_.duration /= 4.0;
      piece_.from /= 4.0;
    }
    // No adaptive scheme gets through: the finest setting that is tried has to serve.
  }

  /// Each gets so much, then four times as much where it may get through with that.
  bool look_for_reference() {
    hopefuls_.clear();
    for (const std::size_t k : references()) hopefuls_.push_back({k});
    for (double allowed = kFirstCost; !hopefuls_.empty(); allowed *= 4.0) {
      for (Hopeful& one : hopefuls_) {
        if (interrupted()) return false;
        if (one.projected > kMostOverestimated * allowed) continue;
        if (is_reference(one, allowed)) return true;
      }
      if (allowed >= most_cost_) return false;
      std::erase_if(hopefuls_, [](const Hopeful& one) { return one.projected == kInfinity; });
    }
    return false;
  }

  bool is_reference(Hopeful& one, double allowed) {
    const double tolerance = std::max(kFinestTolerance, kErrorOfReference * accuracy_);
    TrialRun trial = attempt(one.method, tolerance, allowed);
    if (!trial.finished()) {
      one.projected = projected_cost(one.method, trial);
      return false;
    }
    const auto cost = static_cast<double>(trial.cost());
    // Settings that cost far more than the reference are of no use.
    most_expensive_ = kMostTimesReference * cost;
    tried_.push_back({one.method, kReferenceLevel, tolerance, cost, kErrorOfReference * accuracy_});
    reference_ = std::move(trial.result);
    return true;
  }

  /// Projects the cost of a whole run that went over budget: at least its cost so far. Explicit
  /// schemes, whose steps are as long as stability allows, continue as they began; implicit ones
  /// may begin with steps that are shorter by far. The cost is infinite where a run fails.
  double projected_cost(std::size_t method, const TrialRun& trial) const {
    if (trial.end != TrialRun::End::over_budget) return kInfinity;
    const auto cost = static_cast<double>(trial.cost());
    return methods_[method].integrator->needs_tangent ? cost
                                                      : cost / std::max(trial.part(), kLeastPart);
  }

  TrialRun attempt(std::size_t method, double resolution, double most_cost) {
    const auto scene = variants_.with(methods_[method].at(resolution));
    TrialLimits limits;
    limits.store = &begun_;
    limits.name = fmt::format("{} {} {}", methods_[method].name, resolution, piece_.duration);
    limits.stop = stop_;
    limits.cost = static_cast<std::uint64_t>(std::min(most_cost, most_cost_));
    limits.observables = {std::begin(kHeadlines), std::end(kHeadlines)};
    TrialRun trial = try_run(shortened(*scene, piece_), limits);
    cost_ += trial.cost() - std::exchange(cost_of_[limits.name], trial.cost());
    return trial;
  }

  /// The settings of a method from coarse to fine: steps from a little below the stable one by
  /// halves.
  double resolution(const Method& method, int level) const {
    if (method.resolution == Resolution::tolerance)
      return kTolerances[static_cast<std::size_t>(level)];
    const double longest =
        std::min(piece_.duration / kFewestSteps, kShareOfStableStep * method.stable_step);
    return method.rounded(longest, 2) * std::ldexp(1.0, -level);
  }

  /// The next setting of a method, and what it may cost.
  struct Next {
    std::size_t method = 0;
    int level = 0;
    double cost = 0.0;
  };

  /// Two coarser settings than the run's there are for tolerances, which cost little more.
  int first_level(std::size_t k) const {
    return methods_[k].resolution == Resolution::tolerance ? 1 : 0;
  }

  /// All methods from coarse to fine, cheap settings first: what they take limits the others.
  void climb_all(double wanted) {
    std::vector<Next> left;
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      const double of_reference = reference_ ? tried_.front().cost : kInfinity;
      left.push_back({k, first_level(k), cost_of_steps(k, first_level(k)).value_or(of_reference)});
    }
    for (const Hopeful& one : hopefuls_) {
      if (one.projected > 0.0)
        left[one.method].cost = std::min(left[one.method].cost, one.projected);
    }
    climb(std::move(left), wanted);
  }

  void climb(std::vector<Next> left, double wanted) {
    climb(std::move(left), wanted, most_expensive_, any);
  }

  /// The cheapest first, each until a setting has at most the wanted error, or is more expensive
  /// than one among these that has.
  template <class Among>
  void climb(std::vector<Next> left, double wanted, double most_expensive, Among among) {
    while (!left.empty() && !interrupted()) {
      const auto next = std::min_element(
          left.begin(), left.end(), [](const Next& a, const Next& b) { return a.cost < b.cost; });
      const auto best = cheapest_of(wanted, among);
      const Tried tried = try_out(next->method, next->level, best ? best->cost : most_expensive);
      if (tried.error <= wanted || tried.cost == kInfinity || ++next->level == kMostResolutions) {
        left.erase(next);
      } else {
        next->cost = cost_of_steps(next->method, next->level).value_or(tried.cost);
      }
    }
  }

  /// Fixed steps can be counted beforehand.
  std::optional<double> cost_of_steps(std::size_t method, int level) const {
    const Method& one = methods_[method];
    if (one.resolution != Resolution::step) return std::nullopt;
    return piece_.duration / resolution(one, level) * one.integrator->evaluations_per_step;
  }

  /// An error may be small by chance, where it changes sign: the next finer setting has to be as
  /// good, or the error is taken to be that one's.
  std::optional<Tried> confirmed(double wanted) {
    for (auto found = cheapest_of(wanted, any); found && !interrupted();
         found = cheapest_of(wanted, any)) {
      if (found->level == kReferenceLevel || found->level + 1 >= kMostResolutions) return found;
      const Tried finer = try_out(found->method, found->level + 1, most_expensive_);
      if (finer.error <= found->error) return found;
      known(found->method, found->level)->error = finer.error;
      if (finer.error <= wanted) return cheapest_of(wanted, any);
      climb({{found->method, first_level(found->method)}}, wanted);
    }
    return std::nullopt;
  }

  Tried* known(std::size_t method, int level) {
    for (Tried& one : tried_) {
      if (one.method == method && one.level == level) return &one;
    }
    return nullptr;
  }

  /// Whether a setting costs too much, as counted or since it or a coarser one has taken more.
  bool is_too_expensive(std::size_t method, int level, double allowed) const {
    if (cost_of_steps(method, level).value_or(0.0) > allowed + 1.0) return true;
    return std::any_of(
        too_expensive_.begin(), too_expensive_.end(), [=](const TooExpensive& before) {
          return before.method == method && before.level <= level && before.at_least >= allowed;
        });
  }

  /// More expensive than the limit counts as infinitely expensive.
  Tried try_out(std::size_t k, int level, double most_cost) {
    if (const Tried* before = known(k, level); before != nullptr && before->cost <= most_cost) {
      return *before;
    }
    const double setting = resolution(methods_[k], level);
    const double allowed = std::min(most_cost, most_cost_);
    if (is_too_expensive(k, level, allowed))
      return {k, level, setting, kInfinity, kInfinity, false};
    const TrialRun trial = attempt(k, setting, most_cost);
    Tried tried{k, level, setting, static_cast<double>(trial.cost()), kInfinity, trial.finished()};
    if (trial.finished() && reference_) {
      tried.error = relative_difference(trial.result, *reference_, length_);
    }
    if (trial.end == TrialRun::End::over_budget) {
      tried.cost = kInfinity;
      too_expensive_.push_back(
          {k, level, std::max(allowed, projected_cost(k, trial) / kMostOverestimated)});
      return tried;
    }
    tried_.push_back(tried);
    return tried;
  }

  static bool any(const Tried& tried) {
    (void)tried;
    return true;
  }

  /// The cheapest setting among these with at most the wanted error.
  template <class Among>
  std::optional<Tried> cheapest_of(double wanted, Among among) const {
    std::optional<Tried> found;
    for (const Tried& one : tried_) {
      if (!(one.error <= wanted) || !(one.cost < kInfinity) || !among(one)) continue;
      if (!found || one.cost < found->cost) found = one;
    }
    return found;
  }

  /// The companion that tells whether the integrator of the run has an error that its own settings
  /// share: of another family, at what the other companions leave for it.
  void add_other_family(const Tried& main, ChosenIntegrator& chosen) {
    const double wanted = kErrorOfOtherFamily * accuracy_;
    double left = kMostForCompanions * main.cost;
    for (const Tried& one : coarser_than(main)) left -= one.cost;
    // Short runs are spared nothing that the pilot has not cost already.
    const double of_pilot = static_cast<double>(cost_) * piece_.duration / scene_->run.duration;
    const double allowed = std::min(std::max(kShareOfRemainingCost * left, of_pilot), most_cost_);
    const auto solves = [this](std::size_t k) { return methods_[k].integrator->needs_tangent; };
    const auto is_other = [&](const Tried& one) {
      return solves(one.method) != solves(main.method) && one.finished && one.cost <= allowed;
    };
    std::vector<Next> others;
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      if (solves(k) == solves(main.method)) continue;
      const int level = first_level(k);
      others.push_back({k, level, cost_of_steps(k, level).value_or(0.0)});
    }
    climb(std::move(others), wanted, allowed, is_other);
    std::optional<Tried> other;
    for (auto found = cheapest_of(wanted, is_other); found && found->level + 1 < kMostResolutions;
         found = cheapest_of(wanted, is_other)) {
      // An error may be small by chance: the next finer setting has to be as good, and is taken.
      const Tried finer = try_out(found->method, level_of(*found) + 1, allowed);
      if (!finer.finished || finer.cost > allowed || interrupted()) break;
      if (finer.error <= wanted) {
        other = finer;
        break;
      }
      known(found->method, found->level)->error = finer.error;
      climb({{found->method, level_of(*found) + 1}}, wanted, allowed, is_other);
    }
    if (!other) other = elsewhere(is_other);
    if (!other) return;
    chosen.companions.push_back(companion_at(*other, kShareOfOtherFamily, true));
  }

  /// A setting that has come to rest away from the reference: finer ones would not come nearer.
  template <class Among>
  std::optional<Tried> elsewhere(Among among) const {
    for (const Tried& finer : tried_) {
      if (!among(finer) || !std::isfinite(finer.error) || finer.error <= accuracy_) continue;
      const bool rests = std::any_of(tried_.begin(), tried_.end(), [&](const Tried& coarser) {
        return coarser.method == finer.method && coarser.level + 1 == finer.level &&
               std::abs(coarser.error - finer.error) <= kChangeAtRest * finer.error;
      });
      if (rests) return finer;
    }
    return std::nullopt;
  }

  /// The most expensive is the finest where no error is known for want of a reference.
  std::optional<Tried> most_accurate() const {
    std::optional<Tried> best;
    for (const Tried& one : tried_) {
      if (!one.finished) continue;
      if (!best || std::pair(one.error, -one.cost) < std::pair(best->error, -best->cost))
        best = one;
    }
    return best;
  }

  static CompanionShares shares_of(const Method& method) {
    return method.resolution == Resolution::step ? shares_of_steps(method.integrator->order)
                                                 : kSharesOfTolerances;
  }

  /// The level of a setting, where its method has one: the reference may stand between two.
  int level_of(const Tried& tried) const {
    if (tried.level != kReferenceLevel) return tried.level;
    int level = 0;
    while (level + 1 < kMostResolutions &&
           kTolerances[static_cast<std::size_t>(level)] > tried.resolution) {
      ++level;
    }
    return level;
  }

  /// The next finer setting than a companion that is good enough by itself; finer yet where the
  /// errors that would be stated are not. The companion itself where there is nothing finer.
  Tried main_beside(const Tried& companion) {
    Tried main = companion;
    for (int level = level_of(companion) + 1; level < kMostResolutions && !interrupted(); ++level) {
      const Tried finer = try_out(companion.method, level, kInfinity);
      if (!finer.finished || !std::isfinite(finer.cost)) break;
      main = finer;
      if (stated_error(main) <= kErrorStated * accuracy_) break;
    }
    return main;
  }

  /// Estimates the error to be stated: differences to companions are hardly more than their errors.
  double stated_error(const Tried& main) {
    const CompanionShares shares = shares_of(methods_[main.method]);
    double stated = 0.0;
    std::size_t k = 0;
    for (const Tried& one : coarser_than(main)) stated = std::max(stated, shares[k++] * one.error);
    return stated;
  }

  /// The companions of a setting, from the nearer one on.
  std::vector<Tried> coarser_than(const Tried& main) {
    std::vector<Tried> found;
    const int level = level_of(main);
    for (int k = 1; k <= static_cast<int>(kCompanions) && level >= k; ++k) {
      const Tried one = try_out(main.method, level - k, kInfinity);
      if (!one.finished || !std::isfinite(one.cost)) break;
      found.push_back(one);
    }
    return found;
  }

  std::string line(const Tried& tried) const {
    return methods_[tried.method].integrator_at(tried.resolution);
  }

  Companion companion_at(const Tried& tried, double share, bool other_family = false) const {
    const std::string text = line(tried);
    return {variants_.with_integrator(text), text, share, other_family};
  }

  std::shared_ptr<const Scene> scene_;
  Variants variants_;
  double accuracy_;
  const std::atomic<bool>* stop_;
  Piece piece_;
  std::vector<Method> methods_;
  std::string refusals_;
  double most_cost_ = 0.0;  ///< of one trial
  std::optional<RunResult> reference_;
  double most_expensive_ = kInfinity;
  double length_ = 1.0;
  std::vector<Tried> tried_;  ///< the reference is the first
  std::vector<TooExpensive> too_expensive_;
  std::vector<Hopeful> hopefuls_;  ///< that might have become the reference
  StoreFile begun_{{}, "", 0.0};   ///< runs over budget, which resume with a larger one; in memory
  std::map<std::string, std::uint64_t> cost_of_;  ///< of trials, by name
  std::uint64_t cost_ = 0;
};

}  // namespace

double relative_difference(const RunResult& result, const RunResult& reference, double length) {
  const std::vector<Headline> ours = headlines(result, length);
  const std::vector<Headline> true_ones = headlines(reference, length);
  double largest = 0.0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const std::vector<double>& x = ours[k].components;
    const std::vector<double>& y = true_ones[k].components;
    if (x.size() != y.size() || x.empty()) return kInfinity;
    double square = 0.0;
    double size = 0.0;
    for (std::size_t d = 0; d < x.size(); ++d) {
      square += (x[d] - y[d]) * (x[d] - y[d]);
      size += y[d] * y[d];
    }
    const double held_to = std::max(std::sqrt(size), kCancellation * true_ones[k].scale);
    if (std::sqrt(square) <= true_ones[k].nothing) continue;
    const double part = held_to > 0.0 ? std::sqrt(square) / held_to : kInfinity;
    largest = std::isfinite(part) ? std::max(largest, part) : kInfinity;
  }
  return largest;
}

CompanionShares shares_of_steps(int order) {
  // Differences to steps twice and four times as long are 2^p - 1 and 4^p - 1 times the error.
  constexpr CompanionShares kTimesTheError = {18.0, 50.0};
  const double ratio = std::ldexp(1.0, order);
  return {kTimesTheError[0] / (ratio - 1.0), kTimesTheError[1] / (ratio * ratio - 1.0)};
}

ChosenIntegrator choose_integrator(const std::shared_ptr<const Scene>& scene,
                                   const Registry& registry, const std::atomic<bool>* stop,
                                   double most_work, RunStore* store) {
  if (store != nullptr) {
    if (auto kept = kept_choice(*store, scene, registry)) return std::move(*kept);
  }
  ChosenIntegrator chosen = Pilot(scene, registry, stop, most_work).choose();
  if (store != nullptr && !chosen.interrupted) keep_choice(*store, chosen);
  return chosen;
}

}  // namespace tomlin
