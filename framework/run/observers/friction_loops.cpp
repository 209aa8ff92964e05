#include <algorithm>
#include <utility>

#include "framework/run/observers/kinds.hpp"
#include "framework/run/plan.hpp"

/// Friction loops of drivers that reverse. A stroke lasts from one reversal to the next; a step
/// ends where a driver reverses, so that differences of its running integrals have the scheme's
/// order. Strokes that lie in the window as a whole count, and two in a row are a loop.
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

class FrictionLoops : public RunObserver {
 public:
  explicit FrictionLoops(const ObserverParts& parts) : parts_(parts) {
    const std::vector<Model::Driver>& drivers = parts.signals.drivers();
    for (std::size_t k = 0; k < drivers.size(); ++k) {
      if (drags(*drivers[k].drive) && reverses(drivers[k])) loops_.push_back({.driver = k});
    }
  }
  bool any() const { return !loops_.empty(); }

  void declare(StateLayout& layout) const override {
    layout.add_reals("friction_loops", loops_.size() * kReals);
    layout.add_integers("friction_loops", loops_.size() * kIntegers);
  }
  void attach(RunState& state) override {
    double* reals = state.reals("friction_loops");
    std::int64_t* integers = state.integers("friction_loops");
    for (Reversing& loop : loops_) {
      loop.numbers = std::exchange(reals, reals + kReals);
      loop.counts = std::exchange(integers, integers + kIntegers);
    }
  }
  void next_window() override {
    for (const Reversing& loop : loops_) {
      std::fill_n(loop.numbers, kReals, 0.0);
      std::fill_n(loop.counts, kIntegers, 0);
    }
  }

  void force_changed(std::string_view force) override {
    for (const Reversing& loop : loops_) {
      if (parts_.signals.drivers()[loop.driver].name == force) reversed(loop);
    }
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
  }

 private:
  /// Sums over strokes one way: integral of the force and time, high and low parts of each.
  enum { kImpulse, kTime = 2, kStroke = 4 };
  enum {
    kSince,                  ///< the last reversal: its time, high and low part
    kImpulseThen = 2,        ///< integral of the force along the first direction up to it
    kWorkThen,               ///< and of the power
    kHalfWork,               ///< of the first stroke of a pair
    kPairWork,               ///< of complete pairs, high and low part
    kForth = kPairWork + 2,  ///< sums over strokes along the first direction
    kBack = kForth + kStroke,
    kReals = kBack + kStroke
  };
  /// kInside: a stroke has begun in the window; kHalf: there is the first stroke of a pair.
  enum { kInside, kHalf, kPairs, kIntegers };
  /// Of one driver; the numbers stand in the run's state.
  struct Reversing {
    std::size_t driver = 0;
    double* numbers = nullptr;
    std::int64_t* counts = nullptr;
  };

  bool reverses(const Model::Driver& driver) const {
    const std::vector<Model::Force>& forces = parts_.run.model.forces();
    return std::any_of(forces.begin(), forces.end(), [&](const Model::Force& force) {
      return force.name == driver.name && force.bound->waits_for() != nullptr;
    });
  }

  static std::optional<double> mean_force(const double* strokes) {
    if (!(strokes[kTime] > 0.0)) return {};
    return strokes[kImpulse] / strokes[kTime];
  }

  /// The driver has another direction already.
  void reversed(const Reversing& loop) const {
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
      const bool was_forth = parts_.signals.along(loop.driver) < 0.0;
      double* strokes = numbers + (was_forth ? kForth : kBack);
      add_to(strokes + kImpulse, impulse - numbers[kImpulseThen]);
      add_to(strokes + kTime, static_cast<double>(now - since));
      add_stroke(loop, work - numbers[kWorkThen]);
    }
    loop.counts[kInside] = inside ? 1 : 0;
    numbers[kSince] = now.hi;
    numbers[kSince + 1] = now.lo;
    numbers[kImpulseThen] = impulse;
    numbers[kWorkThen] = work;
  }

  static void add_stroke(const Reversing& loop, double work) {
    if (loop.counts[kHalf] == 0) {
      loop.numbers[kHalfWork] = work;
      loop.counts[kHalf] = 1;
      return;
    }
    add_to(loop.numbers + kPairWork, loop.numbers[kHalfWork] + work);
    loop.counts[kHalf] = 0;
    ++loop.counts[kPairs];
  }

  ObserverParts parts_;
  std::vector<Reversing> loops_;
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
