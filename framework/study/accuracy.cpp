#include "framework/study/accuracy.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/model/scales.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/observables.hpp"
#include "framework/study/ladder.hpp"
#include "framework/study/trial_run.hpp"

namespace tomlin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of the error allowed, what the companion may have in the pilot: a whole run is not quite it.
constexpr double kShareOfCompanion = 0.1;
/// The same of costs.
constexpr double kSlack = 0.85;
/// The pilot's reference is so much finer than what is asked for.
constexpr double kReferenceShare = 1e-4;
constexpr double kFinestTolerance = 1e-13;
/// Nothing is tried that costs so many times more than the reference.
constexpr double kDearest = 4.0;
/// Evaluations times coordinates that one run of the pilot may take: seconds.
constexpr double kMostWork = 4e8;
constexpr int kMostShortenings = 6;
constexpr double kFirstCost = 5e3;  ///< of a reference
constexpr std::array kTolerances = {1e-2, 1e-3, 1e-4,  1e-5,  1e-6,  1e-7,
                                    1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13};
constexpr int kMostKnobs = static_cast<int>(kTolerances.size());
/// Fixed steps begin a little below the stable one.
constexpr double kFirstStep = 0.9;
constexpr double kFewestSteps = 50.0;
/// A mean below this part of the largest value is nought by cancellation, and held to that part.
constexpr double kFloor = 1e-3;
/// A body that moves by less of the scene's length does not move.
constexpr double kUnmoved = 1e-9;
/// The companion's error in the pilot is at least so many times the run's.
constexpr double kFactorOfCompanion = 10.0;
/// As long as it is three times as large in the run, half the difference is not below the error.
constexpr double kShareOfDifference = 0.5;
/// Nothing is known better than to the last digits of a double.
constexpr double kRounding = 1e-15;

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
  for (const DriverResult& driver : result.drivers) {
    double largest = 0.0;
    for (const auto* extremes : {&driver.max_force, &driver.min_force}) {
      for (const double force : *extremes) largest = std::max(largest, std::abs(force));
    }
    all.push_back({driver.mean_force, largest});
  }
  if (!all.empty()) return all;
  for (const BodyResult& body : result.bodies) {
    all.push_back({body.mean_velocity, body.max_speed.value_or(0.0) / kFloor,
                   kUnmoved * length / (result.window_to - result.window_from)});
  }
  return all;
}

/// The largest relative difference between two results; `length` is one of the scene's.
double difference(const RunResult& result, const RunResult& reference, double length) {
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
    const double held_to = std::max(std::sqrt(size), kFloor * true_ones[k].scale);
    if (std::sqrt(square) <= true_ones[k].nothing) continue;
    const double part = held_to > 0.0 ? std::sqrt(square) / held_to : kInfinity;
    largest = std::isfinite(part) ? std::max(largest, part) : kInfinity;
  }
  return largest;
}

/// For people: a step is a little below the stable one anyway.
double two_digits(double x) {
  const std::string text = fmt::format("{:.1e}", x);
  double rounded = x;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

/// Length of a pilot, and where its window begins.
struct Piece {
  double duration = 0.0;
  double from = 0.0;
};

/// The first slip comes when the spring has been stretched by stick_slip() / (2 pi) periods, and
/// slips are as far apart where they are long.
Piece pilot_of(const std::shared_ptr<const Scene>& scene) {
  constexpr double kTau = 6.283185307179586;
  double cycle = 0.0;
  for (const Sliding& sliding : scales_of(scene).sliding) {
    if (sliding.washboard_frequency <= 0.0) continue;
    const double periods = sliding.stiffness > 0.0 ? std::ceil(sliding.stick_slip() / kTau) : 1.0;
    cycle = std::max(cycle, std::max(1.0, periods) * kTau / sliding.washboard_frequency);
  }
  const double duration = scene->run.duration;
  // Without a period a part of the run has to stand for it.
  if (cycle == 0.0) return {duration / 8.0, duration / 24.0};
  if (3.0 * cycle >= duration) return {duration, duration / 3.0};
  return {3.0 * cycle, cycle};
}

std::shared_ptr<const Scene> shortened(const Scene& scene, const Piece& piece) {
  auto result = std::make_shared<Scene>(scene);
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
  std::size_t rung = 0;
  int level = kReferenceLevel;  ///< of the rung's settings, from coarse to fine
  double knob = 0.0;
  double cost = 0.0;
  double error = kInfinity;
};

class Pilot {
 public:
  Pilot(std::shared_ptr<const Scene> scene, const Registry& registry, const std::atomic<bool>* stop)
      : scene_(std::move(scene)),
        variants_(scene_, registry),
        accuracy_(*scene_->run.accuracy),
        stop_(stop),
        piece_(pilot_of(scene_)) {
    for (Rung& rung : ladder(variants_)) {
      if (!rung.refused.empty())
        refusals_ += (refusals_.empty() ? "" : "; ") + rung.name + ": " + rung.refused;
      if (rung.refused.empty() && rung.is_own_model() &&
          rung.number_type == scene_->run.number_type) {
        rungs_.push_back(std::move(rung));
      }
    }
    if (!rungs_.empty()) length_ = rungs_.front().absolute_share;
    if (rungs_.empty()) {
      throw InputError({{scene_->run.place, "run.accuracy", "",
                         "no integrator takes this scene: " + refusals_, "an integrator", ""}});
    }
  }

  ChosenIntegrator choose() {
    find_reference();
    // The companion first, good enough by itself; then a run that is better by far.
    const Wanted cheap{.error = kShareOfCompanion * accuracy_};
    for (std::size_t k = 0; k < rungs_.size() && !interrupted(); ++k) climb(k, cheap);
    const std::optional<Tried> companion = confirmed(cheap);
    std::optional<Tried> main;
    if (companion) {
      const double noise = 2.0 * kReferenceShare * accuracy_;
      const Wanted fine{.error = std::max(companion->error / kFactorOfCompanion, noise),
                        .cost = companion->cost / (kSlack * kMostForCompanion)};
      for (std::size_t k = 0; k < rungs_.size() && !interrupted(); ++k) climb(k, fine);
      main = confirmed(fine);
    }
    ChosenIntegrator chosen;
    chosen.pilot_cost = cost_;
    chosen.length = length_;
    chosen.interrupted = interrupted();
    if (chosen.interrupted) return chosen;
    if (!main) {
      main = companion ? companion : most_accurate();
      if (main->error > accuracy_) {
        chosen.warnings.push_back(
            fmt::format("accuracy {:g}: the best that the pilot found, {}, keeps {:.1e}", accuracy_,
                        line(*main), main->error));
      }
    }
    chosen.scene = scene_at(*main);
    chosen.text = line(*main);
    if (const auto other = companion_of(*main)) {
      chosen.companion = scene_at(*other);
      chosen.companion_text = line(*other);
      const bool far_worse = other->error >= kFactorOfCompanion * main->error;
      chosen.share = far_worse ? kShareOfDifference : 1.0;
    }
    return chosen;
  }

 private:
  bool interrupted() const { return stop_ != nullptr && stop_->load(); }

  /// Orders the rungs for a reference: adaptive, of high order, in double or better; explicit ones
  /// first.
  std::vector<std::size_t> references() const {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < rungs_.size(); ++k) {
      if (rungs_[k].knob == Knob::tolerance) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      const IntegratorRecord& x = *rungs_[a].integrator;
      const IntegratorRecord& y = *rungs_[b].integrator;
      if (x.needs_tangent != y.needs_tangent) return y.needs_tangent;
      return x.order > y.order;
    });
    return order;
  }

  /// The cheapest, whichever it is: so much for each, then four times as much.
  void find_reference() {
    for (int pass = 0; pass < kMostShortenings && !interrupted(); ++pass) {
      for (double cost = kFirstCost; cost < kMostWork; cost *= 4.0) {
        if (look_for_reference(cost) || interrupted()) return;
      }
      piece_.duration /= 4.0;
      piece_.from /= 4.0;
    }
    // Nothing adaptive gets through: the finest of what is tried has to serve.
  }

  bool look_for_reference(double most_cost) {
    const double tolerance = std::max(kFinestTolerance, kReferenceShare * accuracy_);
    for (const std::size_t k : references()) {
      TrialRun trial = attempt(k, tolerance, most_cost);
      if (!trial.finished()) continue;
      const auto cost = static_cast<double>(trial.cost());
      // What costs far more than the reference is of no use.
      dearest_ = kDearest * cost;
      tried_.push_back({k, kReferenceLevel, tolerance, cost, kReferenceShare * accuracy_});
      reference_ = std::move(trial.result);
      return true;
    }
    return false;
  }

  TrialRun attempt(std::size_t rung, double knob, double most_cost) {
    const auto scene = variants_.with(rungs_[rung].at(knob));
    TrialLimits limits;
    limits.stop = stop_;
    const double coordinates = std::max<double>(1.0, static_cast<double>(coordinates_));
    limits.cost = static_cast<std::uint64_t>(std::min(most_cost, kMostWork / coordinates));
    TrialRun trial = try_run(shortened(*scene, piece_), limits);
    cost_ += trial.cost();
    return trial;
  }

  /// A setting with at most this error that costs at least this much.
  struct Wanted {
    double error = 0.0;
    double cost = 0.0;

    bool met_by(const Tried& tried) const { return tried.error <= error && tried.cost >= cost; }
  };

  /// The settings of a rung from coarse to fine: steps from a little below the stable one by
  /// halves.
  double knob(const Rung& rung, int level) const {
    if (rung.knob == Knob::tolerance) return kTolerances[static_cast<std::size_t>(level)];
    const double longest = std::min(piece_.duration / kFewestSteps, kFirstStep * rung.stable_step);
    return two_digits(longest) * std::ldexp(1.0, -level);
  }

  /// From coarse to fine until a setting is as wanted, or dearer than one that is.
  void climb(std::size_t k, const Wanted& wanted) {
    for (int level = 0; level < kMostKnobs && !interrupted(); ++level) {
      const auto best = cheapest_of(wanted);
      const Tried tried = try_out(k, level, best ? best->cost : dearest_);
      if (wanted.met_by(tried) || tried.cost == kInfinity) return;
    }
  }

  /// An error may be small by chance, where it changes sign: the next finer setting has to be as
  /// good, or the error is taken to be that one's.
  std::optional<Tried> confirmed(const Wanted& wanted) {
    for (auto found = cheapest_of(wanted); found && !interrupted(); found = cheapest_of(wanted)) {
      if (found->level == kReferenceLevel || found->level + 1 >= kMostKnobs) return found;
      const Tried finer = try_out(found->rung, found->level + 1, dearest_);
      if (finer.error <= found->error) return found;
      known(found->rung, found->level)->error = finer.error;
      if (wanted.met_by(finer)) return cheapest_of(wanted);
      climb(found->rung, wanted);
    }
    return std::nullopt;
  }

  Tried* known(std::size_t rung, int level) {
    for (Tried& one : tried_) {
      if (one.rung == rung && one.level == level) return &one;
    }
    return nullptr;
  }

  /// Dearer than the limit counts as infinitely dear.
  Tried try_out(std::size_t k, int level, double most_cost) {
    if (const Tried* before = known(k, level); before != nullptr && before->cost <= most_cost) {
      return *before;
    }
    const double setting = knob(rungs_[k], level);
    const TrialRun trial = attempt(k, setting, most_cost);
    Tried tried{k, level, setting, static_cast<double>(trial.cost()), kInfinity};
    if (trial.finished() && reference_) {
      tried.error = difference(trial.result, *reference_, length_);
    }
    if (trial.end == TrialRun::End::over_budget) {
      tried.cost = kInfinity;
      return tried;
    }
    tried_.push_back(tried);
    return tried;
  }

  std::optional<Tried> cheapest_of(const Wanted& wanted) const {
    std::optional<Tried> found;
    for (const Tried& one : tried_) {
      if (wanted.met_by(one) && one.cost < kInfinity && (!found || one.cost < found->cost)) {
        found = one;
      }
    }
    return found;
  }

  Tried most_accurate() const {
    return *std::min_element(tried_.begin(), tried_.end(), [](const Tried& a, const Tried& b) {
      return std::pair(a.error, a.cost) < std::pair(b.error, b.cost);
    });
  }

  /// The most accurate of those that cost little enough.
  std::optional<Tried> companion_of(const Tried& main) const {
    std::optional<Tried> found;
    for (const Tried& one : tried_) {
      if (!(one.cost <= kSlack * kMostForCompanion * main.cost)) continue;
      if (std::isfinite(one.error) && (!found || one.error < found->error)) found = one;
    }
    return found;
  }

  std::string line(const Tried& tried) const {
    return rungs_[tried.rung].at(tried.knob).back().value;
  }

  /// The scene as it was asked for, with nothing but the integrator replaced.
  std::shared_ptr<const Scene> scene_at(const Tried& tried) const {
    auto result = std::make_shared<Scene>(*scene_);
    result->run.integrator = variants_.with(rungs_[tried.rung].at(tried.knob))->run.integrator;
    return result;
  }

  std::shared_ptr<const Scene> scene_;
  Variants variants_;
  double accuracy_;
  const std::atomic<bool>* stop_;
  Piece piece_;
  std::vector<Rung> rungs_;
  std::string refusals_;
  std::size_t coordinates_ = Model(scene_).coordinate_count();
  std::optional<RunResult> reference_;
  double dearest_ = kInfinity;
  double length_ = 1.0;
  std::vector<Tried> tried_;
  std::uint64_t cost_ = 0;
};

/// What has an error: what drivers, bodies and the ledger show. Counts and clocks have none.
bool has_error(const std::string& path) {
  return path.starts_with("drivers.") || path.starts_with("bodies.") || path.starts_with("energy.");
}

void add_errors(RunResult& result, const RunResult& companion, double share) {
  for (const Observable& one : observables(result)) {
    if (!has_error(one.path)) continue;
    const auto other = observable(companion, one.path);
    ErrorEstimate estimate{one.path, std::nullopt};
    if (one.value && other) {
      estimate.error =
          std::max(share * std::abs(*one.value - *other), kRounding * std::abs(*one.value));
    }
    result.errors.push_back(std::move(estimate));
  }
}

void warn_of_large_errors(const RunResult& main, const RunResult& companion,
                          const ChosenIntegrator& chosen, std::vector<std::string>& warnings) {
  const double accuracy = *chosen.scene->run.accuracy;
  const double found = chosen.share * difference(companion, main, chosen.length);
  if (found <= accuracy) return;
  warnings.push_back(
      fmt::format("accuracy {:g} was not reached: the estimated error is {:.1e} of the result",
                  accuracy, found));
}

/// The integrator of a scene, coarser or finer, and what part of the difference is its error.
struct Companion {
  std::shared_ptr<const Scene> scene;
  double share = 1.0;
};

Companion companion_of(const std::shared_ptr<const Scene>& scene) {
  constexpr double kWider = 30.0;
  constexpr double kNearlyStable = 0.95;
  const SceneIntegrator& integrator = scene->run.integrator;
  const double dt = integrator.record->step(integrator.description.get());
  double factor = kWider;
  Companion companion{nullptr, kShareOfDifference};
  if (dt > 0.0) {
    const bool stable = 2.0 * dt <= kNearlyStable * Engine(scene, {}).stable_step();
    factor = stable ? 2.0 : 0.5;
    // Of second order at least: the longer step has four times the error.
    companion.share = stable ? 1.0 / 3.0 : 4.0 / 3.0;
  }
  auto description = integrator.record->make_description();
  for (const Parameter& row : integrator.record->parameters) {
    ParameterValue value = row.read(integrator.description.get());
    const bool turned = dt > 0.0 ? row.key == "dt" : row.key.ends_with("tolerance");
    if (turned) value = std::get<double>(value) * factor;
    row.assign(description.get(), std::move(value));
  }
  auto other = std::make_shared<Scene>(*scene);
  other->run.integrator.description = std::move(description);
  companion.scene = std::move(other);
  return companion;
}

}  // namespace

ChosenIntegrator choose_integrator(const std::shared_ptr<const Scene>& scene,
                                   const Registry& registry, const std::atomic<bool>* stop) {
  return Pilot(scene, registry, stop).choose();
}

void estimate_errors(const ChosenIntegrator& chosen, const RunOptions& options, RunResult& result) {
  const double accuracy = *chosen.scene->run.accuracy;
  result.accuracy = AccuracyResult{accuracy, chosen.text, chosen.companion_text, chosen.pilot_cost};
  result.accuracy->scheme = chosen.scene->run.integrator.record;
  if (chosen.companion) result.accuracy->companion_scheme = chosen.companion->run.integrator.record;
  result.warnings.insert(result.warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
  if (result.status != RunStatus::finished) return;
  if (chosen.companion == nullptr) {
    result.warnings.emplace_back("no error was estimated: nothing cheaper than the run will do");
    return;
  }
  TrialLimits limits;
  limits.stop = options.stop;
  const std::uint64_t cost = result.force_evaluations + result.jacobian_columns;
  limits.cost = static_cast<std::uint64_t>(kMostForCompanion * static_cast<double>(cost));
  const TrialRun companion = try_run(chosen.companion, limits);
  result.accuracy->companion_cost = companion.cost();
  if (!companion.finished()) {
    result.warnings.push_back(
        companion.end == TrialRun::End::over_budget
            ? fmt::format("no error was estimated: a cheaper run took more than {} of this one",
                          kMostForCompanion)
            : "no error was estimated: the cheaper run did not end" +
                  (companion.why.empty() ? std::string() : ": " + companion.why));
    return;
  }
  add_errors(result, companion.result, chosen.share);
  warn_of_large_errors(result, companion.result, chosen, result.warnings);
}

RunResult run_to_accuracy(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options) {
  if (!scene->run.accuracy) return run(scene, options);
  const ChosenIntegrator chosen = choose_integrator(scene, registry, options.stop);
  if (chosen.interrupted) {
    RunResult result;
    result.status = RunStatus::interrupted;
    return result;
  }
  RunResult result = run(chosen.scene, options);
  estimate_errors(chosen, options, result);
  return result;
}

RunResult run_with_errors(const std::shared_ptr<const Scene>& scene, const Registry& registry,
                          const RunOptions& options) {
  if (scene->run.accuracy) return run_to_accuracy(scene, registry, options);
  RunResult result = run(scene, options);
  if (result.status != RunStatus::finished) return result;
  const Companion companion = companion_of(scene);
  TrialLimits limits;
  limits.stop = options.stop;
  const TrialRun other = try_run(companion.scene, limits);
  if (other.finished()) add_errors(result, other.result, companion.share);
  return result;
}

}  // namespace tomlin
