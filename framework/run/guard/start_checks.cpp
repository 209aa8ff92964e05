#include "framework/run/guard/start_checks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/model/stability.hpp"
#include "framework/run/guard/diagnose.hpp"
#include "framework/run/guard/window_warnings.hpp"
#include "framework/run/window/time_scale.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {

namespace {

/// Keys of warnings.
constexpr const char* kIntegratorKey = "run.integrator";
constexpr const char* kStepKey = "run.integrator.dt";

/// The scene under check, and the findings.
struct Check {
  Model& model;
  const RunPlan& plan;
  const Scene& scene = model.scene();
  const IntegratorRecord& scheme = *scene.run.integrator.record;
  StartFindings found = {};

  void warn(FaultCode code, std::string text, std::string key) {
    found.warnings.push_back({code, std::move(text), std::move(key)});
  }
  /// The run fails before its first step; the first reason is the one that is reported.
  void fail(FaultCode code, const std::string& body, std::string what, std::string cause) {
    if (found.failure) return;
    RunFailure& failure = found.failure.emplace();
    failure.code = code;
    failure.body = body;
    failure.what = std::move(what);
    failure.cause = std::move(cause);
  }
};

/// Returns the shortest period that the forces have along an axis; infinite where they have none.
double shortest_period(const Model& model) {
  double period = std::numeric_limits<double>::infinity();
  for (int d = 0; d < model.dimension(); ++d) {
    if (model.origin().unit[d] > 0.0) period = std::min(period, model.origin().unit[d]);
  }
  return period;
}

/// Largest distance of a body's particles from its centre.
double reach_of(const Model::Body& body) {
  double reach = 0.0;
  for (const std::array<double, 3>& arm : body.arms) {
    double squares = 0.0;
    for (const double x : arm) squares = std::fma(x, x, squares);
    reach = std::max(reach, std::sqrt(squares));
  }
  return reach;
}

/// The fastest that any particle of a prescribed body is along its way, looked at now and then.
double fastest_of(const Model::Body& body, double duration) {
  constexpr int kLooks = 1000;
  const double reach = reach_of(body);
  double fastest = 0.0;
  for (int k = 0; k <= kLooks; ++k) {
    const double time = duration * k / kLooks;
    double speed = reach * std::abs(body.motion->angular_velocity(time));
    for (const TimeFunction& function : body.motion->velocity) speed += std::abs(function(time));
    if (std::isfinite(speed)) fastest = std::max(fastest, speed);
  }
  return fastest;
}

/// Parts of a length that has to be seen: what is coarser is warned of, or refused.
constexpr double kCoarsePositions = 1e-9;
constexpr double kFewestPositions = 100.0;  // of a short number type
// Parts of the scene's length (natural_units.hpp), where no period or bond is along an axis.
constexpr double kCoarseUnits = 1e-6;
constexpr double kFewestUnits = 1000.0;
constexpr double kRefusedPositions = 1e-3;
/// Tolerance of an adaptive scheme, as a part of a period or of half the shortest bond. Half a
/// period is the way from a well to the next barrier: a step may end in any well.
constexpr double kCoarseTolerance = 1e-2;
constexpr double kRefusedTolerance = 0.5;
/// Error of a driver's force by that of positions, over the largest force of substrate and drag.
constexpr double kCoarseForce = 1e-2;
/// Relative error of the drag, and so of a mean force, by the scheme alone.
constexpr double kCoarseDrag = 1e-2;
constexpr double kRefusedDrag = 1e-1;
/// Relative error of a mean by the rounding of the integral that it is a difference of.
constexpr double kCoarseMean = 1e-6;
/// Part of a change with time that steps may miss without a warning.
constexpr double kMissedChange = 1e-2;
/// Steps that a scheme takes in seconds.
constexpr double kStepsOfSeconds = 1e6;

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

/// Without inertia velocities follow from forces, whatever the scene says of them at the start.
void warn_of_idle_velocities(Check& check) {
  if (check.model.system().view.inertial && !check.scheme.follows_equilibria) return;
  for (const SceneBody& body : check.scene.bodies) {
    const PerParticleVector& given = body.record->common(body.description.get()).velocity;
    const bool any = std::any_of(given.values.begin(), given.values.end(), [](const auto& vector) {
      return std::any_of(vector.components.begin(), vector.components.end(),
                         [](double v) { return v != 0.0; });
    });
    const bool warm = body.record->common(body.description.get()).start_temperature > 0.0;
    if (!any && !warm) continue;
    const std::string key =
        fmt::format("body.{}.{}", body.name, any ? "velocity" : "start_temperature");
    check.warn(FaultCode::scene_velocity_unused,
               fmt::format("{} means nothing without inertia: velocities follow from {}", key,
                           check.scheme.follows_equilibria ? "the drivers'" : "forces"),
               key);
  }
}

/// Quasistatic dynamics have a scheme of their own.
void warn_of_unused_integrator(Check& check) {
  const SceneIntegrator& integrator = check.scene.run.integrator;
  if (integrator.not_used.empty()) return;
  check.warn(FaultCode::integrator_unused,
             fmt::format("{} = {} is not used: quasistatic dynamics follow equilibria by {}",
                         kIntegratorKey, integrator.not_used, integrator.name),
             kIntegratorKey);
}

/// An adaptive scheme has no error to control where nothing is free, yet forces on prescribed
/// bodies change as these move: steps are parts of a period, or of the run where there is none.
/// Schemes that follow equilibria do not look at the errors of prescribed motions either.
void bound_unwatched_steps(Check& check) {
  const SystemView<double>& view = check.model.system().view;
  const bool watched =
      view.coordinates > 0 && (!check.scheme.follows_equilibria || view.own_count == 0);
  if (check.plan.dt > 0.0 || watched) return;
  constexpr double kPartOfPeriod = 0.02;
  constexpr double kPartOfRun = 1e-3;
  check.found.longest_step = kPartOfRun * check.plan.duration;
  const double period = shortest_period(check.model);
  for (const Model::Body& body : check.model.bodies()) {
    if (!body.prescribed()) continue;
    const double speed = fastest_of(body, check.plan.duration);
    if (!(speed > 0.0)) continue;
    const double scale =
        std::isfinite(period) ? period : std::max(reach_of(body), speed * check.plan.duration);
    check.found.longest_step = std::min(check.found.longest_step, kPartOfPeriod * scale / speed);
  }
}

/// A step beyond the stability limit is refused before it is taken.
void check_step(Check& check) {
  if (check.plan.dt == 0.0) return;
  check.found.stable_step =
      stable_step_of(check.model, check.scheme, check.plan.dt / (1.0 - 2.0 * kNoStep));
  const double longest = std::min(check.plan.dt, check.plan.duration);
  if (is_stable(longest, check.found.stable_step)) return;
  const bool beyond = longest > check.found.stable_step * (1.0 + kNoStep);
  const bool in_ps = check.scene.units == UnitSystem::metal;
  const std::string what =
      fmt::format("dt = {:g} is {} the stability limit of {}, about {:.4g}{}", check.plan.dt,
                  beyond ? "beyond" : "no shorter than", check.scheme.name, check.found.stable_step,
                  in_ps ? "; times are in ps, and 1 fs is 1e-3" : "");
  if (check.scene.run.allow_unstable) {
    check.warn(FaultCode::integrator_beyond_stability, what, kStepKey);
    return;
  }
  RunFailure failure = diagnose(check.model, check.scheme, StepFault::not_finite_or_too_far, 0,
                                DoubleDouble(0.0), check.plan.dt, check.found.stable_step);
  failure.code = FaultCode::run_step_unstable;
  failure.what = what;
  if (longest * fastest_spin_of(check.model) > kLargestRotation) {
    failure.force.clear();
    failure.cause = "a rigid body rotates by more than half a radian in a step; use a smaller dt";
  } else {
    failure.force = stiffest_force_of(check.model);
    failure.cause =
        "the stiffest force limits the step; use a smaller dt, or force the run with "
        "run.allow_unstable = true";
  }
  if (!check.found.failure) check.found.failure = std::move(failure);
}

/// A moment of inertia that underflows or overflows would freeze the rotation without a word.
void check_inertia(Check& check) {
  for (const Model::Body& body : check.model.bodies()) {
    if (!body.bound.slot.rigid || !(body.has_free_rotation())) continue;
    if (reach_of(body) == 0.0 || std::isnormal(body.inertia)) continue;
    check.fail(FaultCode::matrix_singular, body.bound.name,
               "its moment of inertia is beyond the range of numbers",
               "lengths or masses too small or too large; take other units");
  }
}

/// Positions are whole periods and an offset, or plain numbers along an axis without a period.
/// There they get coarser with the distance from zero, however short the ways that matter are.
void check_positions(Check& check) {
  const double epsilon = epsilon_of(check.scene.run.number_type);
  const SystemView<double>& view = check.model.system().view;
  for (const Model::Body& body : check.model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    const double reach = reach_of(body);
    double worst = 0.0;
    double farthest_without_length = 0.0;
    int axis = 0;
    int axis_without_length = 0;
    for (int d = 0; d < check.model.dimension(); ++d) {
      const std::size_t first = slot.rigid ? slot.centre + d : slot.offset + d * slot.stride;
      const std::size_t count = slot.rigid ? 1 : slot.count;
      for (std::size_t i = first; i < first + count; ++i) {
        const double farthest = std::abs(view.position[i]) + (slot.rigid ? reach : 0.0);
        double shortest = view.largest_move[i];
        if (slot.rigid && reach > 0.0) shortest = std::min(shortest, reach);
        if (!(shortest < kNoBound)) {
          if (farthest <= farthest_without_length || !(farthest < kNoBound)) continue;
          farthest_without_length = farthest;
          axis_without_length = d;
          continue;
        }
        const double coarse = epsilon * farthest / shortest;
        if (coarse <= worst) continue;
        worst = coarse;
        axis = d;
      }
    }
    const double coarse = epsilon * farthest_without_length / tolerance_scales(view).length;
    if (coarse > std::max(kCoarseUnits, kFewestUnits * epsilon)) {
      check.warn(
          FaultCode::number_type_coarse_positions,
          fmt::format("{}: positions along {} are far from zero, and no force declares a period "
                      "there: {} resolves {:.2g}, and smaller displacements are lost",
                      body.bound.name, kAxisNames[axis_without_length],
                      to_string(check.scene.run.number_type), epsilon * farthest_without_length),
          "body." + body.bound.name);
    }
    if (worst <= std::max(kCoarsePositions, kFewestPositions * epsilon)) continue;
    const std::string what = fmt::format(
        "positions along {} are too far from zero: {} resolves {:.2g} of the "
        "shortest length there (a period, half a bond, a radius)",
        kAxisNames[axis], to_string(check.scene.run.number_type), worst);
    if (worst <= kRefusedPositions) {
      check.warn(FaultCode::number_type_coarse_positions, body.bound.name + ": " + what,
                 "body." + body.bound.name);
    } else {
      check.fail(FaultCode::number_type_unsuitable, body.bound.name, what,
                 "start nearer to zero, or in a finer number_type");
    }
  }
}

/// Changes with time by itself have a time scale: a fixed step that does not resolve it is
/// warned of, and that of an adaptive scheme, whose error estimate may step over a pulse, bounded
/// by it. A prescribed body may no more jump over a period in a step than a free one.
void check_time_scales(Check& check) {
  for (const TimeDependence& change : time_dependences(check.model)) {
    const double longest = resolving_step(change, kMissedChange, check.plan.duration);
    if (check.plan.dt == 0.0) {
      check.found.longest_step = std::min(check.found.longest_step, longest);
    } else if (longest < check.plan.dt ||
               missed_by_steps(change, check.plan.dt, check.plan.duration) > kMissedChange) {
      check.warn(FaultCode::integrator_unresolved_time,
                 fmt::format("{} changes faster than steps of {:g} can follow", change.what,
                             check.plan.dt),
                 change.key);
    }
  }
  check.model.anchor(DoubleDouble(0.0));
  if (check.plan.dt == 0.0) return;
  const double period = shortest_period(check.model);
  for (const Model::Body& body : check.model.bodies()) {
    if (!body.prescribed()) continue;
    const double way = fastest_of(body, check.plan.duration) * check.plan.dt;
    if (!(way > period)) continue;
    check.fail(FaultCode::run_step_unstable, body.bound.name,
               fmt::format("its prescribed motion covers {:.3g} periods in a step", way / period),
               fmt::format("dt = {:g} is too long for it", check.plan.dt));
  }
}

/// Schemes that take friction apart from forces are stable where friction rules, and wrong.
void check_drag(Check& check) {
  if (check.plan.dt == 0.0 || check.scheme.drag_error == nullptr ||
      !check.model.system().view.inertial)
    return;
  const double rate = damping_rate_of(check.model);
  const double error = check.scheme.drag_error(std::min(check.plan.dt, check.plan.duration) * rate);
  if (!(error > kCoarseDrag)) return;
  const std::string what = fmt::format(
      "dt = {:g} is {:.3g} times the time 1/{:g} in which friction stops a motion: "
      "{} underestimates the friction force by {:.2g} of it",
      check.plan.dt, check.plan.dt * rate, rate, check.scheme.name, error);
  if (error <= kRefusedDrag || check.scene.run.allow_unstable) {
    check.warn(FaultCode::integrator_weak_drag, what, kStepKey);
    return;
  }
  check.fail(FaultCode::run_step_unstable, "", what,
             "take a smaller dt, dynamics = \"overdamped\", or insist with run.allow_unstable = "
             "true");
}

/// The highest temperature of the baths of a body, an energy.
class HottestBath : public FrictionSink {
 public:
  explicit HottestBath(std::size_t body) : body_(body) {}
  void site(std::size_t, std::size_t, double) override {}
  void bath(std::size_t body, std::size_t, double, double temperature) override {
    if (body == body_) highest = std::max(highest, temperature);
  }
  double highest = 0.0;

 private:
  std::size_t body_;
};

/// A number of kelvins in reduced units, where a temperature is an energy, is far above all
/// barriers. The barrier of a sine is twice its amplitude, and a rigid body has that of all its
/// particles.
void warn_of_hot_baths(Check& check) {
  constexpr double kMostBarriers = 100.0;  // thermal energies of studies are below one barrier
  if (check.scene.units != UnitSystem::reduced) return;
  for (std::size_t b = 0; b < check.model.bodies().size(); ++b) {
    const BoundBody<double>& body = check.model.bodies()[b].bound;
    HottestBath bath(b);
    double barrier = 0.0;
    for (const Model::Force& force : check.model.forces()) {
      force.friction->friction(bath);
      const double period = period_of(force, b, check.scene);
      if (!(period > 0.0)) continue;
      const double curvature = force.curvature->curvature_bound();  // negative: not known
      const double amplitude = curvature * std::pow(period / kTau, 2);
      barrier = std::max(barrier, curvature < 0.0 ? kNoBound : 2.0 * amplitude);
    }
    if (body.slot.rigid) barrier *= static_cast<double>(body.slot.count);
    if (!(barrier > 0.0 && bath.highest > kMostBarriers * barrier)) continue;
    check.warn(
        FaultCode::run_far_above_barriers,
        fmt::format("the temperature of the bath of \"{}\", {:g}, is {:.2g} times the highest "
                    "barrier of its substrate, about {:.2g}: in reduced units a temperature is an "
                    "energy, k_B T",
                    body.name, bath.highest, bath.highest / barrier, barrier),
        "body." + body.name);
  }
}

/// Positions that scatter too widely in a well, of the largest relaxation rate in the scene.
void warn_of_wide_distribution(Check& check) {
  constexpr double kLargestVarianceError = 0.1;  // of the variance
  if (check.model.system().view.noise_count == 0 || check.scheme.variance_error == nullptr) return;
  const double rate = stiffness_of(check.model).relaxation_rate;
  const double relaxed = check.plan.dt * rate;
  if (!is_stable(check.plan.dt, check.found.stable_step)) return;
  const double error = check.scheme.variance_error(relaxed);
  if (!(error >= kLargestVarianceError)) return;
  check.warn(
      FaultCode::integrator_wide_distribution,
      fmt::format("dt = {:g} is {:.2g} times the time 1/{:g} in which a coordinate relaxes: {} "
                  "makes the variance of a position in a well too large, by up to {:.2g} of it",
                  check.plan.dt, relaxed, rate, check.scheme.name, error),
      kStepKey);
}

/// Without inertia noise moves a coordinate by sqrt(2 T h/c) z in a step. A run is long, and z may
/// be as large as kLargestNormalNumber.
void check_noise(Check& check) {
  constexpr double kLargestNormalNumber = 6.0;
  const SystemView<double>& view = check.model.system().view;
  if (view.noise_count == 0 || check.scene.run.allow_unstable) return;
  double worst = 0.0;
  for (std::size_t i = 0; i < view.dofs; ++i) {
    worst = std::max(worst, view.noise_scale[i] / view.largest_move[i]);
  }
  const double step = 1.0 / (kLargestNormalNumber * worst);
  if (!(std::sqrt(check.plan.dt) > step)) return;
  check.fail(
      FaultCode::run_step_unstable, "",
      fmt::format("noise moves a coordinate by {:.2g} of the shortest length there (a period, or "
                  "half a bond) in a step, in the root mean square",
                  std::sqrt(check.plan.dt) * worst),
      fmt::format("take a dt of at most {:.2g}, or insist with run.allow_unstable = true",
                  step * step));
}

/// Friction and bonds do not let an explicit scheme take longer steps, however smooth the motion.
void check_pace(Check& check) {
  if (check.scheme.most_steps == nullptr) return;
  const auto most =
      static_cast<double>(check.scheme.most_steps(check.scene.run.integrator.description.get()));
  const double longest =
      std::min(longest_lasting_step_of(check.model, check.scheme), check.found.longest_step);
  // A few steps are soon used up; and forces without bound fail for what they are.
  if (!(longest > 0.0) || check.plan.duration / longest <= std::max(most, kStepsOfSeconds)) return;
  check.fail(FaultCode::run_step_limit, "",
             fmt::format("the run would take at least {:.2g} steps: {} keeps no step beyond "
                         "about {:.2g} here",
                         check.plan.duration / longest, check.scheme.name, longest),
             fmt::format("most_steps allows {:g}; take a shorter run, a scheme for stiff "
                         "scenes, or dynamics without inertia",
                         most));
}

/// A tolerance that does not see the lattice. Where nothing else keeps steps short, the result
/// means nothing.
void warn_of_coarse_tolerance(Check& check) {
  const SystemView<double>& view = check.model.system().view;
  const ToleranceScales<double> scales = tolerance_scales(view);
  const auto asked = tolerance_of(check.scene.run.integrator, scales.length);
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
  if (*asked <= kRefusedTolerance * shortest || holds_steps(check.scene.run) ||
      check.scene.run.allow_unstable) {
    check.warn(FaultCode::integrator_coarse_tolerance, what + ": results follow the steps",
               kIntegratorKey);
    return;
  }
  check.fail(FaultCode::scene_out_of_range, "", what + ": the result would mean nothing",
             fmt::format("take finer tolerances, absolute ones well below {:.2g}; without "
                         "absolute_tolerance it is 1e-9 of the scene's length, {:g}",
                         kCoarseTolerance * shortest * scales.length, scales.length));
}

/// A position is known to the tolerance or to its last digit, and a driver's force to its stiffness
/// times that, which may be more than all that substrate and drag have.
void warn_of_stiff_drivers(Check& check) {
  const double epsilon = epsilon_of(check.scene.run.number_type);
  for (const Model::Force& driver : check.model.forces()) {
    const Drive* drive = driver.drive();
    const double stiffness = drive ? drive->stiffness_along() : 0.0;
    if (!(stiffness > 0.0)) continue;
    double largest = 0.0;
    double shortest = std::numeric_limits<double>::infinity();
    for (const Model::Force& force : check.model.forces()) {
      const double period = period_of(force, driver.bodies.front(), check.scene);
      const double curvature = force.curvature->curvature_bound();
      if (period <= 0.0 || curvature <= 0.0) continue;
      const auto particles = check.model.bodies()[driver.bodies.front()].bound.slot.count;
      largest += curvature * period / kTau * static_cast<double>(particles);
      shortest = std::min(shortest, period);
    }
    if (largest <= 0.0) continue;
    TotalFriction friction(driver.bodies.front());
    for (const Model::Force& force : check.model.forces()) force.friction->friction(friction);
    double square = 0.0;
    for (const double part : drive->velocity) square += part * part;
    largest = std::max(largest, friction.total * std::sqrt(square));
    const double length = tolerance_scales(check.model.system().view).length;
    const double asked = tolerance_of(check.scene.run.integrator, length).value_or(0.0) * length;
    const double known = std::max(asked, epsilon * shortest);
    if (!(stiffness * known > kCoarseForce * largest)) continue;
    check.warn(
        FaultCode::run_stiff_driver,
        fmt::format("{}: positions are accurate to {:.2g}, and its force therefore to {:.2g} "
                    "only, while substrate and drag exert {:.2g} at most: use a finer tolerance "
                    "or a softer spring",
                    driver.name, known, stiffness * known, largest),
        "drivers." + driver.name);
  }
}

/// Means are differences of integrals, which have rounded since the start of the run; and those of
/// a window that is no number of periods depend on where it begins.
void warn_of_short_window(Check& check) {
  if (check.plan.period > 0.0) return;
  const double window = check.plan.window_to - check.plan.window_from;
  const double rounding = epsilon_of(NumberType::double_precision) * check.plan.window_to / window;
  if (rounding > kCoarseMean) {
    check.warn(
        FaultCode::run_window_rounding,
        fmt::format("the window is {:.2g} of the time before its end: rounding leaves its means "
                    "right to some {:.1g} of themselves",
                    window / check.plan.window_to, rounding),
        "measure");
  }
  // The end of the window is not known yet.
  if (check.scene.run.until) return;
  // One of several drivers of different speeds decides.
  std::vector<DriverWindow> windows;
  bool whole = false;
  for (std::size_t k = 0; k < check.model.drivers().size(); ++k) {
    windows.push_back(driver_window(check.model, k, check.plan.window_from, check.plan.window_to));
    whole = whole || is_whole(windows.back());
  }
  for (DriverWindow& seen : windows) {
    seen.steady = seen.steady && seen.one_period && !whole;
    if (auto doubt = doubt_before(seen)) check.found.warnings.push_back(*std::move(doubt));
  }
}

}  // namespace

double epsilon_of(NumberType number_type) {
  switch (number_type) {
    case NumberType::double_precision:
      return 0x1p-52;
    case NumberType::quadruple_precision:
      return 0x1p-112;
  }
  return 0.0;
}

bool is_stable(double step, double stable_step) { return step < stable_step * (1.0 - kNoStep); }

StartFindings check_start(Model& model, const RunPlan& plan, bool checks_step) {
  Check check = {model, plan};
  for (const SceneForce& force : check.scene.forces) {
    check.found.warnings.insert(check.found.warnings.end(), force.warnings.begin(),
                                force.warnings.end());
  }
  warn_of_idle_velocities(check);
  warn_of_unused_integrator(check);
  bound_unwatched_steps(check);
  // A run until it is steady checks once a period whether it is.
  if (plan.period > 0.0) {
    check.found.longest_step = std::min(check.found.longest_step, plan.period);
  }
  if (checks_step) check_step(check);
  check_inertia(check);
  check_positions(check);
  check_time_scales(check);
  check_drag(check);
  check_noise(check);
  warn_of_hot_baths(check);
  warn_of_wide_distribution(check);
  check_pace(check);
  warn_of_coarse_tolerance(check);
  warn_of_stiff_drivers(check);
  warn_of_short_window(check);
  return std::move(check.found);
}

}  // namespace tomlin
