#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"

/// Scenes that run to their end and still give no number to trust: refused, or warned of, before
/// the first step.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

/// Parts of a length that has to be seen: what is coarser is warned of, or refused.
constexpr double kCoarsePlaces = 1e-9;
constexpr double kFewPlaces = 100.0;  // of a short number type
// The same in units of length, where the scene has no length of its own.
constexpr double kCoarseUnits = 1e-6;
constexpr double kFewUnits = 1000.0;
constexpr double kNoLength = 1e300;
constexpr double kUselessPlaces = 1e-3;
/// Tolerance of an adaptive scheme, as a part of a period or of half the shortest bond.
constexpr double kCoarseTolerance = 1e-2;
/// Of a driver's force by that of places, as a part of what substrate and drag have at most.
constexpr double kCoarseForce = 1e-2;
/// Relative error of the drag, and so of a mean force, by the scheme alone.
constexpr double kCoarseDrag = 1e-2;
constexpr double kUselessDrag = 1e-1;
/// Relative error of a mean by the rounding of the integral that it is a difference of.
constexpr double kCoarseMean = 1e-6;
/// Of a driver's period within the window: less is not sliding.
constexpr double kShortestSlide = 1e-2;
/// Of a prescribed way, by steps that do not see it.
constexpr double kMissedWay = 1e-2;
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

double last_place_of(const std::string& number_type) {
  if (number_type == "float") return 0x1p-23;
  return number_type == "quadruple" ? 0x1p-112 : 0x1p-52;
}

/// How much of a prescribed way steps of h miss: Simpson's rule, which a Runge-Kutta step amounts
/// to, against the same on eighths, at steps all over the run.
double missed_by_steps(const TimeFunction& function, double h, double duration) {
  constexpr int kSteps = 100;
  constexpr int kParts = 16;
  double way = 0.0;
  double missed = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double from = std::max(0.0, duration - h) * k / kSteps;
    double in_parts = 0.0;
    double at_once = 0.0;
    for (int part = 0; part <= kParts; ++part) {
      const double velocity = function(from + h * part / kParts);
      const bool edge = part == 0 || part == kParts;
      in_parts += (edge ? 1.0 : part % 2 == 0 ? 2.0 : 4.0) / (3.0 * kParts) * velocity;
      if (edge) at_once += velocity / 6.0;
      if (2 * part == kParts) at_once += velocity * 4.0 / 6.0;
    }
    way += std::abs(in_parts) + std::abs(at_once);
    missed += 2.0 * std::abs(in_parts - at_once);
  }
  return way > 0.0 ? missed / way : 0.0;
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
    // Nothing tells a length of the scene there: in its units, one is as good as another.
    const double coarse = last_place * farthest_without_length;
    if (coarse > std::max(kCoarseUnits, kFewUnits * last_place)) {
      warnings_.push_back(fmt::format(
          "{}: places along {} are far from zero, and no force declares a period there: {} tells "
          "them apart to {:.2g}, and shorter ways are lost",
          body.bound.name, "xyz"[axis_without_length], scene_ -> run.number_type, coarse));
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

/// What moves as prescribed may no more jump over a period in a step than what is free.
void Engine::check_ways() {
  if (dt_ == 0.0) return;
  double period = std::numeric_limits<double>::infinity();
  for (int d = 0; d < model_.dimension(); ++d) {
    if (model_.origin().unit[d] > 0.0) period = std::min(period, model_.origin().unit[d]);
  }
  for (const Model::Body& body : model_.bodies()) {
    if (!body.prescribed()) continue;
    const double way = fastest_of(body, duration_) * dt_;
    for (const TimeFunction& function : body.motion->velocity) {
      if (function.is_constant() || !(missed_by_steps(function, dt_, duration_) > kMissedWay))
        continue;
      warnings_.push_back(
          fmt::format("{}: its prescribed velocity {} changes faster than steps of "
                      "{:g} can follow",
                      body.bound.name, function.text, dt_));
    }
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
  const auto drives = [](const Model::Force& force) { return !force.bound->is_friction(); };
  if (std::none_of(model_.forces().begin(), model_.forces().end(), drives)) return;
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

/// A tolerance that does not see the lattice, as the default one in units of atoms' metres.
void Engine::warn_of_coarse_tolerance() {
  if (scheme_.tolerance == nullptr) return;
  const double asked = scheme_.tolerance(scene_->run.integrator.description.get());
  const SystemView<double>& view = model_.system().view;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < view.dofs; ++i) {
    if (view.inverse_mass[i] > 0.0) shortest = std::min(shortest, view.largest_move[i]);
  }
  if (!(asked > kCoarseTolerance * shortest)) return;
  warnings_.push_back(
      fmt::format("a tolerance of {:g} does not resolve the scene's shortest length, {:g} (a "
                  "period, or half a bond): results follow the steps",
                  asked, shortest));
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
    const double asked = scheme_.tolerance == nullptr
                             ? 0.0
                             : scheme_.tolerance(scene_->run.integrator.description.get());
    const double known = std::max(asked, last_place * shortest);
    if (!(drive->stiffness * known > kCoarseForce * largest)) continue;
    warnings_.push_back(fmt::format(
        "{}: places are known to {:.2g}, and so its force to {:.2g} only, where substrate and "
        "drag have {:.2g} at most: take a finer tolerance, or a softer spring",
        driver.name, known, drive->stiffness * known, largest));
  }
}

/// Means are differences of integrals, which have rounded since the start of the run; and those of
/// a driver that hardly moves tell of its start.
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
  for (const Model::Driver& driver : drivers_) {
    if (driver.drive == nullptr) continue;
    for (int d = 0; d < model_.dimension(); ++d) {
      const double period = model_.origin().unit[d];
      const double way = std::abs(driver.drive->velocity[d]) * window;
      if (!(period > 0.0 && way > 0.0) || way >= kShortestSlide * period) continue;
      warnings_.push_back(
          fmt::format("{} moves by {:.2g} of a period within the window: its means "
                      "tell of the start, not of sliding",
                      driver.name, way / period));
    }
  }
}

}  // namespace tomlin
