#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/tolerance.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/run/time_scale.hpp"
#include "framework/scene/natural_units.hpp"

/// Scenes that run to their end and still give no number to trust: refused, or warned of, before
/// the first step.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

/// Parts of a length that has to be seen: what is coarser is warned of, or refused.
constexpr double kCoarsePlaces = 1e-9;
constexpr double kFewPlaces = 100.0;  // of a short number type
// The same in the scene's length (natural_units.hpp), where no period or bond is along an axis.
constexpr double kCoarseUnits = 1e-6;
constexpr double kFewUnits = 1000.0;
constexpr double kNoLength = 1e300;
constexpr double kUselessPlaces = 1e-3;
/// Tolerance of an adaptive scheme, as a part of a period or of half the shortest bond. Half a
/// period is the way from a well to the next barrier: a step may end in any well.
constexpr double kCoarseTolerance = 1e-2;
constexpr double kUselessTolerance = 0.5;
/// Of a driver's force by that of places, as a part of what substrate and drag have at most.
constexpr double kCoarseForce = 1e-2;
/// Relative error of the drag, and so of a mean force, by the scheme alone.
constexpr double kCoarseDrag = 1e-2;
constexpr double kUselessDrag = 1e-1;
/// Relative error of a mean by the rounding of the integral that it is a difference of.
constexpr double kCoarseMean = 1e-6;
/// Of what changes with time by itself, by steps that do not see it.
constexpr double kMissedChange = 1e-2;
/// Steps that a scheme takes in seconds.
constexpr double kSoonTaken = 1e6;

/// The friction coefficient of a body's particles together.
class TotalFriction : public FrictionSink {
 public:
  explicit TotalFriction(std::size_t body) : body_(body) {}
  void site(std::size_t body, std::size_t, double coefficient) override {
    if (body == body_) total += coefficient;
  }
  double total = 0.0;

 private:
  std::size_t body_;
};

/// The longest period of a force on a body; 0 where it has none there.
double period_of(const Model::Force& force, std::size_t body, const Scene& scene) {
  if (std::find(force.bodies.begin(), force.bodies.end(), body) == force.bodies.end()) return 0.0;
  double longest = 0.0;
  for (const SceneForce& from : scene.forces) {
    if (from.name != force.name) continue;
    for (int d = 0; d < scene.dimension; ++d) {
      longest = std::max(longest, from.record->period(from.description.get(), d));
    }
  }
  return longest;
}

/// Whether a longest step stands beside the tolerances.
bool holds_steps(const RunSettings& run) {
  for (const Parameter& row : run.integrator.record->parameters) {
    if (row.key != "largest_step") continue;
    const ParameterValue value = row.read(run.integrator.description.get());
    const auto* step = std::get_if<double>(&value);
    return step != nullptr && *step < run.duration;
  }
  return false;
}

double last_place_of(const std::string& number_type) {
  if (number_type == "float") return 0x1p-23;
  return number_type == "quadruple" ? 0x1p-112 : 0x1p-52;
}

}  // namespace

void Engine::look_for_doubts() {
  check_inertia();
  check_places();
  check_ways();
  check_drag();
  check_pace();
  warn_of_coarse_tolerance();
  warn_of_stiff_drivers();
  warn_of_short_window();
}

/// A run that fails before its first step; the first reason is the one that is told.
void Engine::fail_at_start(const std::string& body, std::string what, std::string cause) {
  if (failure_) return;
  failure_ = RunFailure{};
  failure_->body = body;
  failure_->what = std::move(what);
  failure_->cause = std::move(cause);
}

/// A moment of inertia that underflows or overflows would freeze the rotation without a word.
void Engine::check_inertia() {
  for (const Model::Body& body : model_.bodies()) {
    if (!body.bound.slot.rigid || !body.rotates() || body.rotation_held) continue;
    if (reach_of(body) == 0.0 || std::isnormal(body.inertia)) continue;
    fail_at_start(body.bound.name, "its moment of inertia is beyond the range of numbers",
                  "lengths or masses too small or too large; take other units");
  }
}

/// Places are whole periods and an offset, or plain numbers along an axis without a period. There
/// they get coarser with the distance from zero, however short the ways that matter are.
void Engine::check_places() {
  const double last_place = last_place_of(scene_->run.number_type);
  const SystemView<double>& view = model_.system().view;
  for (const Model::Body& body : model_.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    const double reach = reach_of(body);
    double worst = 0.0;
    double farthest_without_length = 0.0;
    int axis = 0;
    int axis_without_length = 0;
    for (int d = 0; d < model_.dimension(); ++d) {
      const std::size_t first = slot.rigid ? slot.centre + d : slot.offset + d * slot.stride;
      const std::size_t count = slot.rigid ? 1 : slot.count;
      for (std::size_t i = first; i < first + count; ++i) {
        const double farthest = std::abs(view.position[i]) + (slot.rigid ? reach : 0.0);
        double shortest = view.largest_move[i];
        if (slot.rigid && reach > 0.0) shortest = std::min(shortest, reach);
        if (!(shortest < kNoLength)) {
          if (farthest <= farthest_without_length || !(farthest < kNoLength)) continue;
          farthest_without_length = farthest;
          axis_without_length = d;
          continue;
        }
        const double coarse = last_place * farthest / shortest;
        if (coarse <= worst) continue;
        worst = coarse;
        axis = d;
      }
    }
    const double coarse = last_place * farthest_without_length / tolerance_scales(view).length;
    if (coarse > std::max(kCoarseUnits, kFewUnits * last_place)) {
      warnings_.push_back(fmt::format(
          "{}: places along {} are far from zero, and no force declares a period there: {} tells "
          "them apart to {:.2g}, and shorter ways are lost",
          body.bound.name, "xyz"[axis_without_length], scene_ -> run.number_type,
          last_place* farthest_without_length));
    }
    if (worst <= std::max(kCoarsePlaces, kFewPlaces * last_place)) continue;
    const std::string what = fmt::format(
        "places along {} are too far from zero: {} tells them apart to {:.2g} of the "
        "shortest length there (a period, half a bond, a radius)",
        "xyz"[axis], scene_ -> run.number_type, worst);
    if (worst <= kUselessPlaces) {
      warnings_.push_back(body.bound.name + ": " + what);
    } else {
      fail_at_start(body.bound.name, what, "start nearer to zero, or in a finer number_type");
    }
  }
}

/// What changes with time by itself has a time scale: a fixed step that does not resolve it is
/// warned of, and that of an adaptive scheme, whose error estimate may step over a pulse, bounded
/// by it. What moves as prescribed may no more jump over a period in a step than what is free.
void Engine::check_ways() {
  for (const TimeDependence& change : time_dependences(model_)) {
    const double longest = resolving_step(change, kMissedChange, duration_);
    if (dt_ == 0.0) {
      longest_unwatched_ = std::min(longest_unwatched_, longest);
    } else if (longest < dt_ || missed_by_steps(change, dt_, duration_) > kMissedChange) {
      warnings_.push_back(
          fmt::format("{} changes faster than steps of {:g} can follow", change.what, dt_));
    }
  }
  model_.anchor(DoubleDouble(0.0));
  if (dt_ == 0.0) return;
  double period = std::numeric_limits<double>::infinity();
  for (int d = 0; d < model_.dimension(); ++d) {
    if (model_.origin().unit[d] > 0.0) period = std::min(period, model_.origin().unit[d]);
  }
  for (const Model::Body& body : model_.bodies()) {
    if (!body.prescribed()) continue;
    const double way = fastest_of(body, duration_) * dt_;
    if (!(way > period)) continue;
    fail_at_start(
        body.bound.name,
        fmt::format("its prescribed motion is {:.3g} periods long in a step", way / period),
        fmt::format("dt = {:g} is too long for it", dt_));
  }
}

/// Schemes that take friction apart from forces are stable where friction rules, and wrong.
void Engine::check_drag() {
  if (dt_ == 0.0 || scheme_.drag_error == nullptr || !model_.system().view.inertial) return;
  const double rate = model_.stiffness().damping_rate;
  const double error = scheme_.drag_error(std::min(dt_, duration_) * rate);
  if (!(error > kCoarseDrag)) return;
  const std::string what = fmt::format(
      "dt = {:g} is {:.3g} times the time 1/{:g} in which friction stops a motion: "
      "{} drags too easily by {:.2g} of the force",
      dt_, dt_ * rate, rate, scheme_.name, error);
  if (error <= kUselessDrag || scene_->run.allow_unstable) {
    warnings_.push_back(what);
    return;
  }
  fail_at_start("", what,
                "take a smaller dt, dynamics = \"overdamped\", or insist with run.allow_unstable = "
                "true");
}

/// Friction and bonds do not let an explicit scheme take longer steps, however smooth the motion.
void Engine::check_pace() {
  if (scheme_.most_steps == nullptr) return;
  const auto most =
      static_cast<double>(scheme_.most_steps(scene_->run.integrator.description.get()));
  const double longest = std::min(model_.longest_lasting_step(scheme_), longest_unwatched_);
  // A few steps are soon used up; and forces without bound fail for what they are.
  if (!(longest > 0.0) || duration_ / longest <= std::max(most, kSoonTaken)) return;
  fail_at_start("",
                fmt::format("the run would take at least {:.2g} steps: {} keeps no step beyond "
                            "about {:.2g} here",
                            duration_ / longest, scheme_.name, longest),
                fmt::format("most_steps allows {:g}; take a shorter run, a scheme for stiff "
                            "scenes, or dynamics without inertia",
                            most));
}

/// A tolerance that does not see the lattice. Where nothing else keeps steps short, the result
/// means nothing.
void Engine::warn_of_coarse_tolerance() {
  const SystemView<double>& view = model_.system().view;
  const ToleranceScales<double> scales = tolerance_scales(view);
  const auto asked = tolerance_of(scene_->run.integrator, scales.length);
  if (!asked) return;
  double shortest = std::numeric_limits<double>::infinity();  // in the scene's length, or rad
  for (std::size_t i = 0; i < view.dofs; ++i) {
    if (view.inverse_mass[i] <= 0.0) continue;
    shortest = std::min(shortest, view.largest_move[i] * scales.position[i]);
  }
  if (!(*asked > kCoarseTolerance * shortest)) return;
  const std::string what = fmt::format(
      "a tolerance of {:g} does not resolve the scene's shortest length, {:g} (a period, or half a "
      "bond)",
      *asked * scales.length, shortest * scales.length);
  if (*asked <= kUselessTolerance * shortest || holds_steps(scene_->run) ||
      scene_->run.allow_unstable) {
    warnings_.push_back(what + ": results follow the steps");
    return;
  }
  fail_at_start("", what + ": the result would mean nothing",
                fmt::format("take finer tolerances, absolute ones well below {:.2g}; without "
                            "absolute_tolerance it is 1e-9 of the scene's length, {:g}",
                            kCoarseTolerance * shortest * scales.length, scales.length));
}

/// A place is known to the tolerance or to its last digit, and a driver's force to its stiffness
/// times that, which may be more than all that substrate and drag have.
void Engine::warn_of_stiff_drivers() {
  const double last_place = last_place_of(scene_->run.number_type);
  for (const Model::Force& driver : model_.forces()) {
    const Drive* drive = driver.bound->drive();
    if (drive == nullptr || drive->stiffness <= 0.0) continue;
    double largest = 0.0;
    double shortest = std::numeric_limits<double>::infinity();
    for (const Model::Force& force : model_.forces()) {
      const double period = period_of(force, driver.bodies.front(), *scene_);
      const double curvature = force.bound->curvature_bound();
      if (period <= 0.0 || curvature <= 0.0) continue;
      const auto particles = model_.bodies()[driver.bodies.front()].bound.slot.count;
      largest += curvature * period / kTau * static_cast<double>(particles);
      shortest = std::min(shortest, period);
    }
    if (largest <= 0.0) continue;
    TotalFriction friction(driver.bodies.front());
    for (const Model::Force& force : model_.forces()) force.bound->friction(friction);
    double square = 0.0;
    for (const double part : drive->velocity) square += part * part;
    largest = std::max(largest, friction.total * std::sqrt(square));
    const double length = tolerance_scales(model_.system().view).length;
    const double asked = tolerance_of(scene_->run.integrator, length).value_or(0.0) * length;
    const double known = std::max(asked, last_place * shortest);
    if (!(drive->stiffness * known > kCoarseForce * largest)) continue;
    warnings_.push_back(fmt::format(
        "{}: places are known to {:.2g}, and so its force to {:.2g} only, where substrate and "
        "drag have {:.2g} at most: take a finer tolerance, or a softer spring",
        driver.name, known, drive->stiffness * known, largest));
  }
}

/// Means are differences of integrals, which have rounded since the start of the run; and those of
/// a window that is no number of periods depend on where it begins.
void Engine::warn_of_short_window() {
  if (period_ > 0.0) return;
  const double window = to_.time - from_.time;
  const double rounding = last_place_of("double") * to_.time / window;
  if (rounding > kCoarseMean) {
    warnings_.push_back(
        fmt::format("the window is {:.2g} of the time before its end: rounding leaves its means "
                    "right to some {:.1g} of themselves",
                    window / to_.time, rounding));
  }
  // Of several drivers of different speeds one decides.
  bool whole = false;
  for (std::size_t k = 0; k < drivers_.size(); ++k) whole = whole || is_whole(window_of(k).first);
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    auto [seen, unique] = window_of(k);
    seen.steady = seen.steady && unique && !whole;
    for (std::string& doubt : doubts_before(seen)) warnings_.push_back(std::move(doubt));
  }
}

/// The window as a driver of steady speed sees it, and whether no two forces have different periods
/// along its way.
std::pair<DriverWindow, bool> Engine::window_of(std::size_t driver) const {
  DriverWindow window;
  window.driver = drivers_[driver].name;
  window.from = from_.time;
  window.to = to_.time;
  bool unique = true;
  const Drive& drive = *drivers_[driver].drive;
  window.steady = drags_[driver] && !turns_round(driver);
  for (int d = 0; d < model_.dimension(); ++d) {
    if (drive.velocity[d] == 0.0) continue;
    for (const SceneForce& force : scene_->forces) {
      const double period = force.record->period(force.description.get(), d);
      if (!(period > 0.0)) continue;
      unique = unique && (window.period == 0.0 || window.period == period);
      if (period < window.period) continue;
      window.period = period;
      window.speed = std::abs(drive.velocity[d]);
    }
  }
  return {window, unique};
}

bool Engine::turns_round(std::size_t driver) const {
  return std::any_of(triggers_.begin(), triggers_.end(), [&](const Trigger& trigger) {
    return model_.forces()[trigger.force].name == drivers_[driver].name;
  });
}

/// At the end: what springs pull has followed them, and slips enough have been seen.
void Engine::warn_of_window() {
  if (period_ > 0.0 || *from_.reached == 0 || *to_.reached == 0) return;
  const auto axes = static_cast<std::size_t>(model_.dimension());
  for (const DriverWatch& watch : driver_watches_) {
    const std::size_t k = watch.driver();
    const DriverWindow window = window_of(k).first;
    const auto body = body_pulled_by(k);
    if (!(window.period > 0.0) || !window.steady || !body) continue;
    double moved = 0.0;
    for (std::size_t d = 0; d < axes; ++d) {
      const DoubleDouble way = to_.place(*body * axes + d) - from_.place(*body * axes + d);
      moved += static_cast<double>(way) * direction_[k * axes + d] / speed_[k];
    }
    std::optional<std::uint64_t> slips;
    if (watch.watches_slips() && driver_watches_.size() == 1) {
      slips = static_cast<std::uint64_t>(*slips_within_);
    }
    const auto all =
        static_cast<std::uint64_t>(event_counts_[static_cast<std::size_t>(EventKind::slip)]);
    for (std::string& doubt : doubts_after(window, moved, slips, all)) {
      warnings_.push_back(std::move(doubt));
    }
  }
}

}  // namespace tomlin
