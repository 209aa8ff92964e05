#include "framework/run/window/time_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/run/guard/watched_integrals.hpp"

namespace tomlin {
namespace {

/// Particles that are evaluated before a run begins: some hundredths of a second.
constexpr std::size_t kMostEffort = 1 << 20;
constexpr int kParts = 16;  ///< of a step that is looked at
constexpr std::size_t kFewestSteps = 100;
constexpr std::size_t kMostSteps = 400;
constexpr std::size_t kFewestTimes = 1 << 8;
constexpr std::size_t kMostTimes = 1 << 14;
/// From the start of a scene to where forces are looked at once more, in largest moves (a period,
/// half a bond): formulas are often zero where a scene starts.
constexpr double kShiftInLargestMoves = 0.23;
/// Changes below this part of a value are rounding.
constexpr double kRoundingOfValue = 1e-12;
/// A value that comes back through its middle as often swings; else it goes from one to another,
/// and has arrived within this part of its range.
constexpr std::size_t kFewestCrossings = 3;
constexpr double kArrivedPart = 0.05;

/// One force at two states near the start: on all particles, in their own coordinates.
class TimedForce {
 public:
  TimedForce(Model& model, const Model::Force& force)
      : model_(model), force_(force), passes_(force.bound->passes()) {
    const SystemView<double>& view = model.system().view;
    const int axes = model.dimension();
    for (const Model::Body& body : model.bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.mapped) mapped_ = std::max(mapped_, slot.offset + slot.stride * axes);
    }
    force_on_.assign(view.dofs + 2 * kGroup, 0.0);
    mapped_force_.assign(mapped_ + 2 * kGroup, 0.0);
    rates_.assign(view.rates + 2 * kGroup, 0.0);
    for (State& state : states_) {
      state.position.assign(view.position, view.position + view.dofs);
      state.position.resize(view.dofs + 2 * kGroup, 0.0);
    }
    const ToleranceScales<double> scales = tolerance_scales(view);
    const std::vector<double> along = along_with_drivers(model);
    velocity_.assign(view.velocity, view.velocity + view.dofs);
    velocity_.resize(view.dofs + 2 * kGroup, 0.0);
    for (std::size_t i = 0; i < view.dofs; ++i) {
      if (view.inverse_mass[i] <= 0.0) continue;
      double& x = states_[1].position[i];
      const double length = view.largest_move[i];
      x += kShiftInLargestMoves *
           (length < kNoBound ? length : std::abs(x) + 1.0 / scales.position[i]);
      // Forces in proportion to a velocity need one.
      velocity_[i] += along[i] != 0.0 ? along[i] : kShiftInLargestMoves / scales.velocity[i];
    }
    for (State& state : states_) {
      // Bodies that move as one place their particles in an evaluation.
      model.evaluate_at(DoubleDouble(0.0), state.position.data(), velocity_.data(), view.integrals,
                        rates_.data());
      state.mapped.assign(view.mapped_position, view.mapped_position + mapped_);
      state.mapped.resize(mapped_ + 2 * kGroup, 0.0);
    }
  }

  std::size_t numbers() const { return 2 * (model_.system().view.dofs + mapped_); }

  void at(double time, double* value) {
    const SystemView<double>& view = model_.system().view;
    force_.bound->begin_step(DoubleDouble(time));
    for (State& state : states_) {
      std::fill(force_on_.begin(), force_on_.end(), 0.0);
      std::fill(mapped_force_.begin(), mapped_force_.end(), 0.0);
      Stage<double> stage = stage_of(view, state.position.data(), velocity_.data(), view.integrals,
                                     rates_.data(), 0.0);
      stage.force = force_on_.data();
      stage.mapped_position = state.mapped.data();
      stage.mapped_force = mapped_force_.data();
      for (const Pass<double>& pass : passes_) pass.add(pass.arguments, stage);
      value = std::copy(force_on_.begin(), force_on_.begin() + view.dofs, value);
      value = std::copy(mapped_force_.begin(), mapped_force_.begin() + mapped_, value);
    }
  }

 private:
  struct State {
    AlignedVector<double> position;
    AlignedVector<double> mapped;
  };

  Model& model_;
  const Model::Force& force_;
  std::vector<Pass<double>> passes_;
  std::size_t mapped_ = 0;
  State states_[2];
  AlignedVector<double> velocity_, force_on_, mapped_force_, rates_;
};

/// Difference of Simpson's rule on a step's two ends and middle from that on all its parts.
struct Missed {
  double most = 0.0;    ///< that a step has
  double missed = 0.0;  ///< of one

  /// Values at parts + 1 times, each of so many numbers and `apart` from the next.
  void add(const double* value, std::size_t numbers, std::size_t parts, std::size_t apart) {
    double whole = 0.0;
    double lost = 0.0;
    for (std::size_t k = 0; k < numbers; ++k) {
      double in_parts = 0.0;
      for (std::size_t part = 0; part <= parts; ++part) {
        const double weight = part == 0 || part == parts ? 1.0 : part % 2 == 0 ? 2.0 : 4.0;
        in_parts += weight / (3.0 * static_cast<double>(parts)) * value[part * apart + k];
      }
      const double at_once =
          (value[k] + 4.0 * value[parts / 2 * apart + k] + value[parts * apart + k]) / 6.0;
      if (!std::isfinite(in_parts)) continue;
      whole += std::abs(in_parts) + std::abs(at_once);
      lost += 2.0 * std::abs(in_parts - at_once);
    }
    most = std::max(most, whole);
    missed = std::max(missed, lost);
  }
  double part() const { return most > 0.0 ? missed / most : 0.0; }
};

}  // namespace

std::vector<TimeDependence> time_dependences(Model& model) {
  std::vector<TimeDependence> all;
  for (const Model::Body& body : model.bodies()) {
    if (!body.prescribed()) continue;
    const auto add = [&](const TimeFunction& function, const char* which, const char* key) {
      if (function.is_constant()) return;
      all.push_back({fmt::format("{}: its prescribed {} {}", body.bound.name, which, function.text),
                     fmt::format("body.{}.motion.{}", body.bound.name, key), 1, 8,
                     [&function](double t, double* value) { *value = function(t); }});
    };
    for (const TimeFunction& function : body.motion->velocity) {
      add(function, "velocity", "velocity");
    }
    add(body.motion->angular_velocity, "angular velocity", "angular_velocity");
  }
  for (const Model::Force& force : model.forces()) {
    const Drive* drive = force.drive();
    if (!force.bound->depends_on_time() || (drive != nullptr && drive->steady)) continue;
    if (force.variables->own_count() > 0 || force.is_operator) continue;
    const auto timed = std::make_shared<TimedForce>(model, force);
    all.push_back({fmt::format("{}: its force", force.name), "force." + force.name,
                   timed->numbers(), timed->numbers(),
                   [timed](double t, double* value) { timed->at(t, value); }});
  }
  return all;
}

double slowest_cycle(const TimeDependence& of, double duration) {
  std::size_t times = kMostTimes;
  while (times > kFewestTimes && times * of.effort > kMostEffort) times /= 2;
  const double apart = duration / static_cast<double>(times);
  std::vector<double> values(of.numbers * (times + 1));
  for (std::size_t k = 0; k <= times; ++k) {
    of.at(apart * static_cast<double>(k), values.data() + of.numbers * k);
  }
  double slowest = 0.0;
  for (std::size_t n = 0; n < of.numbers; ++n) {
    const auto value = [&](std::size_t k) { return values[of.numbers * k + n]; };
    double low = value(0);
    double high = low;
    for (std::size_t k = 1; k <= times; ++k) {
      low = std::min(low, value(k));
      high = std::max(high, value(k));
    }
    if (!(high - low > kRoundingOfValue * std::max(std::abs(low), std::abs(high)))) continue;
    const double middle = 0.5 * (low + high);
    std::size_t crossings = 0;
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t differs = 0;  // from its last value
    for (std::size_t k = 1; k <= times; ++k) {
      if (std::abs(value(k) - value(times)) > kArrivedPart * (high - low)) differs = k;
      if ((value(k) > middle) == (value(k - 1) > middle)) continue;
      if (++crossings == 1) first = k;
      last = k;
    }
    const double steps = crossings < kFewestCrossings ? static_cast<double>(differs)
                                                      : 2.0 * static_cast<double>(last - first) /
                                                            static_cast<double>(crossings - 1);
    slowest = std::max(slowest, steps * apart);
  }
  return slowest;
}

double missed_by_steps(const TimeDependence& of, double h, double duration) {
  const std::size_t steps =
      std::clamp(kMostEffort / (of.effort * (kParts + 1)), kFewestSteps, kMostSteps);
  std::vector<double> values(of.numbers * (kParts + 1));
  Missed missed;
  for (std::size_t k = 0; k < steps; ++k) {
    const double from =
        std::max(0.0, duration - h) * static_cast<double>(k) / static_cast<double>(steps);
    for (int part = 0; part <= kParts; ++part) {
      of.at(from + h * part / kParts, values.data() + of.numbers * part);
    }
    missed.add(values.data(), of.numbers, kParts, of.numbers);
  }
  return missed.part();
}

double resolving_step(const TimeDependence& of, double part, double duration) {
  std::size_t times = kMostTimes;
  while (times > kFewestTimes && times * of.effort > kMostEffort) times /= 2;
  std::vector<double> values(of.numbers * (times + 1));
  for (std::size_t k = 0; k <= times; ++k) {
    of.at(duration * static_cast<double>(k) / static_cast<double>(times),
          values.data() + of.numbers * k);
  }
  for (std::size_t parts = 4; parts <= times; parts *= 2) {
    Missed missed;
    for (std::size_t k = 0; k + parts <= times; k += parts) {
      missed.add(values.data() + of.numbers * k, of.numbers, parts, of.numbers);
    }
    if (missed.part() > part) {
      const auto half = parts / 2;
      return duration * static_cast<double>(half) / static_cast<double>(times);
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace tomlin
