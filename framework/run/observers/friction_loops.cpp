#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/run/observers/kinds.hpp"
#include "framework/run/steps/run_plan.hpp"
#include "framework/run/window/blocked_series.hpp"

/// Friction loops of drivers that reverse. A stroke lasts from one reversal to the next; a step
/// ends where a driver reverses, so that differences of its running integrals have the scheme's
/// order. Strokes that lie in the window as a whole count, and two in a row are a loop. With a
/// thermostat the scatter of strokes, and of loops, gives the standard errors of their means.
namespace tomlin::observers {
namespace {

const ResultQuantity kTrace{"trace", dimension::force, Shape::number, Scope::window,
                            "of a driver that reverses: mean force along its first direction over "
                            "complete strokes that way"};
const ResultQuantity kRetrace{"retrace", dimension::force, Shape::number, Scope::window,
                              "the same component over complete strokes back"};
const ResultQuantity kHalfDifference{"half_difference",
                                     dimension::force,
                                     Shape::number,
                                     Scope::window,
                                     "(trace - retrace) / 2: the mean friction force",
                                     "",
                                     {"trace", "retrace"}};
const ResultQuantity kLoopArea{"loop_area", dimension::energy, Shape::number, Scope::window,
                               "mean work of the driver over a stroke either way"};
const ResultQuantity kLoops{"loops", dimension::none, Shape::count, Scope::window,
                            "complete strokes either way, in pairs"};

/// Means over strokes and loops that have a standard error.
const ResultQuantity* const kMeans[] = {&kTrace, &kRetrace, &kHalfDifference, &kLoopArea};
constexpr std::size_t kMeansOfLoop = std::size(kMeans);

class FrictionLoops : public RunObserver, public ErrorEstimator {
 public:
  explicit FrictionLoops(const ObserverParts& parts) : parts_(parts) {
    const std::vector<Model::Driver>& drivers = parts.signals.drivers();
    for (std::size_t k = 0; k < drivers.size(); ++k) {
      if (!drags(*drivers[k].drive) || !reverses(parts.run.model, drivers[k])) continue;
      loops_.push_back({.driver = k});
      if (!has_thermostat(*parts.run.scene)) continue;
      for (const ResultQuantity* mean : kMeans) {
        paths_.push_back("drivers." + drivers[k].name + "." + mean->key);
      }
    }
    series_.resize(paths_.size());
    scratch_.assign(BlockedSeries::kBlocks, 0.0);
  }
  bool any() const { return !loops_.empty(); }
  ObserverFacets facets() override { return {.errors = this}; }

  void declare(StateLayout& layout) const override {
    layout.add_reals("friction_loops", loops_.size() * kReals);
    layout.add_integers("friction_loops", loops_.size() * kIntegers);
    if (series_.empty()) return;
    declare_all(layout, "friction_loops.series", series_);
  }
  void attach(RunState& state) override {
    double* reals = state.reals("friction_loops");
    std::int64_t* integers = state.integers("friction_loops");
    for (Reversing& loop : loops_) {
      loop.numbers = std::exchange(reals, reals + kReals);
      loop.counts = std::exchange(integers, integers + kIntegers);
    }
    if (series_.empty()) return;
    attach_all(state, "friction_loops.series", series_);
  }
  void next_window() override {
    for (const Reversing& loop : loops_) {
      std::fill_n(loop.numbers, kReals, 0.0);
      std::fill_n(loop.counts, kIntegers, 0);
    }
    for (BlockedSeries& one : series_) one.start();
  }

  void force_changed(std::string_view force) override {
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      if (parts_.signals.drivers()[loops_[k].driver].name == force) reversed(k);
    }
  }

  std::vector<std::string> estimated() const override { return paths_; }
  std::optional<double> error_so_far(std::string_view path) const override {
    const auto found = std::find(paths_.begin(), paths_.end(), path);
    if (found == paths_.end()) return std::nullopt;
    return error_of(static_cast<std::size_t>(found - paths_.begin()));
  }

  void results(ResultTable& table, const double*) const override {
    for (const Reversing& loop : loops_) {
      std::optional<double> trace;
      std::optional<double> retrace;
      std::optional<double> half_difference;
      std::optional<double> area;
      std::optional<double> pairs;
      if (parts_.window.is_over()) {
        const std::int64_t count = loop.counts[kPairs];
        trace = mean_force(loop.numbers + kForth);
        retrace = mean_force(loop.numbers + kBack);
        if (trace && retrace) half_difference = 0.5 * (*trace - *retrace);
        if (count > 0) area = loop.numbers[kPairWork] / static_cast<double>(count);
        pairs = static_cast<double>(count);
      }
      ResultGroup& group = table.driver(parts_.signals.drivers()[loop.driver]);
      group.add(kTrace, trace);
      group.add(kRetrace, retrace);
      group.add(kHalfDifference, half_difference);
      group.add(kLoopArea, area);
      group.add(kLoops, pairs);
    }
    if (!parts_.window.is_over()) return;
    for (std::size_t k = 0; k < series_.size(); ++k) {
      if (series_[k].count() == 0 || !parts_.selection.wants(kMeans[k % kMeansOfLoop]->key))
        continue;
      table.add_error(paths_[k], error_of(k));
    }
  }

 private:
  /// Sums over strokes one way: integral of the force and time, high and low parts of each.
  enum { kImpulse, kTime = 2, kStroke = 4 };
  enum {
    kSince,                  ///< the last reversal: its time, high and low part
    kImpulseThen = 2,        ///< integral of the force along the first direction up to it
    kWorkThen,               ///< and of the power
    kHalfWork,               ///< of the first stroke of a pair
    kHalfForce,              ///< and its mean force
    kPairWork,               ///< of complete pairs, high and low part
    kForth = kPairWork + 2,  ///< sums over strokes along the first direction
    kBack = kForth + kStroke,
    kReals = kBack + kStroke
  };
  /// kInside: a stroke has begun in the window; kHalf: there is the first stroke of a pair.
  enum { kInside, kHalf, kPairs, kIntegers };
  /// A driver that reverses; the numbers stand in the run's state.
  struct Reversing {
    std::size_t driver = 0;
    double* numbers = nullptr;
    std::int64_t* counts = nullptr;
  };

  static std::optional<double> mean_force(const double* strokes) {
    if (!(strokes[kTime] > 0.0)) return {};
    return strokes[kImpulse] / strokes[kTime];
  }

  /// A stroke that has ended: integral of the force along the first direction, duration and work.
  struct Stroke {
    bool is_forth;
    double impulse;
    double time;
    double work;
  };

  /// The driver has another direction already.
  void reversed(std::size_t k) {
    const Reversing& loop = loops_[k];
    const RunContext& run = parts_.run;
    const Model::Driver& driver = parts_.signals.drivers()[loop.driver];
    const double* integrals = run.model.system().view.integrals + driver.first_rate;
    const DoubleDouble now = run.clock.now();
    double impulse = 0.0;
    for (std::size_t d = 0; d < parts_.axes(); ++d) {
      impulse += parts_.signals.start_velocity(loop.driver, d) * integrals[d];
    }
    impulse /= speed_of(*driver.drive);
    const double work = integrals[parts_.axes()];
    const bool inside = parts_.window.contains(run.clock.time());
    double* numbers = loop.numbers;
    if (inside && loop.counts[kInside] != 0) {
      const DoubleDouble since(numbers[kSince], numbers[kSince + 1]);
      add_stroke(k, {.is_forth = parts_.signals.along(loop.driver) < 0.0,
                     .impulse = impulse - numbers[kImpulseThen],
                     .time = static_cast<double>(now - since),
                     .work = work - numbers[kWorkThen]});
    }
    loop.counts[kInside] = inside ? 1 : 0;
    numbers[kSince] = now.hi;
    numbers[kSince + 1] = now.lo;
    numbers[kImpulseThen] = impulse;
    numbers[kWorkThen] = work;
  }

  void add_stroke(std::size_t k, const Stroke& stroke) {
    const Reversing& loop = loops_[k];
    double* strokes = loop.numbers + (stroke.is_forth ? kForth : kBack);
    add_to(strokes + kImpulse, stroke.impulse);
    add_to(strokes + kTime, stroke.time);
    const double force = stroke.impulse / stroke.time;
    add_number(k, stroke.is_forth ? kTrace : kRetrace, force);
    if (loop.counts[kHalf] == 0) {
      loop.numbers[kHalfWork] = stroke.work;
      loop.numbers[kHalfForce] = force;
      loop.counts[kHalf] = 1;
      return;
    }
    const double area = loop.numbers[kHalfWork] + stroke.work;
    const double difference = 0.5 * (force - loop.numbers[kHalfForce]);
    add_to(loop.numbers + kPairWork, area);
    add_number(k, kHalfDifference, stroke.is_forth ? difference : -difference);
    add_number(k, kLoopArea, area);
    loop.counts[kHalf] = 0;
    ++loop.counts[kPairs];
  }

  /// One more number of a mean, for its standard error.
  void add_number(std::size_t k, const ResultQuantity& mean, double x) {
    if (series_.empty()) return;
    const auto which = std::find(std::begin(kMeans), std::end(kMeans), &mean) - std::begin(kMeans);
    series_[k * kMeansOfLoop + static_cast<std::size_t>(which)].add(x);
  }

  /// Strokes begin with a spring that is turned round, and forget those before: the few that most
  /// runs have are taken as independent.
  std::optional<double> error_of(std::size_t k) const { return series_[k].error(scratch_); }

  ObserverParts parts_;
  std::vector<Reversing> loops_;
  std::vector<std::string> paths_;     ///< of means that have an error; none without a thermostat
  std::vector<BlockedSeries> series_;  ///< [loop][mean]: of strokes, or of pairs
  mutable std::vector<double> scratch_;
};

std::unique_ptr<RunObserver> make_friction_loops(const ObserverParts& parts) {
  auto loops = std::make_unique<FrictionLoops>(parts);
  if (!loops->any()) return nullptr;
  return loops;
}

}  // namespace

ObserverKind friction_loops() {
  return {.rows = {{"drivers", {&kTrace, &kRetrace, &kHalfDifference, &kLoopArea, &kLoops}}},
          .make = make_friction_loops};
}

}  // namespace tomlin::observers
