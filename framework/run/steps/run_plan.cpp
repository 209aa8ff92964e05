#include "framework/run/steps/run_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/model/plugin_code.hpp"
#include "framework/run/window/blocking.hpp"

namespace tomlin {

namespace {

/// In fewer periods of a driver than these no statistical error is known.
constexpr double kFewestPeriods = 2.0 * kFewestCorrelationTimes;

/// How far past the end of the run a window may reach through rounding alone.
constexpr double kWindowSlack = 1e-9;

/// Weeks of the simplest scene.
constexpr double kMostSteps = 1e14;
/// The fastest scene takes so many steps a second.
constexpr double kFastestSteps = 1e8;
constexpr double kSecondsOfADay = 86400.0;
/// A table of a hundred terabytes.
constexpr double kMostSamples = 1e12;

/// A run must end, its counts stay exact, and a signal must get through between samples.
void refuse_endless(const Scene& scene, const RunPlan& plan) {
  if (plan.dt > 0.0 && !(plan.duration / plan.dt <= kMostSteps)) {
    const auto& locations = scene.run.integrator.locations;
    const auto found = locations.find("dt");
    throw InputError({Fault(
        FaultCode::run_endless, found == locations.end() ? scene.run.location : found->second,
        "run.integrator.dt", fmt::format("{}", plan.dt),
        fmt::format("the run would take {:.3g} steps, {:.2g} days at the very least",
                    plan.duration / plan.dt,
                    plan.duration / plan.dt / kFastestSteps / kSecondsOfADay),
        fmt::format("at most {:g} steps", kMostSteps))});
  }
  if (scene.output.every && !(plan.duration / *scene.output.every <= kMostSamples)) {
    throw InputError({Fault(
        FaultCode::output_too_large, scene.output.location_of("every"), "output.every",
        fmt::format("{}", *scene.output.every),
        fmt::format("the run would leave {:.3g} samples", plan.duration / *scene.output.every),
        fmt::format("at most {:g} samples", kMostSamples))});
  }
}

/// Returns the number of steps of the grid that end within the run, but for rounding.
std::int64_t whole_steps(double dt, double duration) {
  auto steps = static_cast<std::int64_t>(duration / dt);
  const auto remains = [&](std::int64_t count) {
    return static_cast<double>(DoubleDouble(duration) - two_prod(static_cast<double>(count), dt));
  };
  while (remains(steps) < -kNoStep * dt) --steps;
  while (remains(steps + 1) >= -kNoStep * dt) ++steps;
  return steps;
}

[[noreturn]] void refuse_window(FaultCode code, const MeasureSettings& measure,
                                const std::string& key, const std::string& why,
                                const std::string& admissible) {
  throw InputError({Fault(code, measure.location_of(key), "measure." + key, "", why, admissible)});
}

bool waits_for_steady(const Scene& scene) {
  return scene.run.until && scene.run.until->is_steady();
}

/// Periods are counted for the window, or for a run until it is steady.
FaultCode code_without_period(const Scene& scene) {
  return waits_for_steady(scene) ? FaultCode::run_until_never : FaultCode::run_invalid_window;
}

/// The driver whose periods the window is counted in.
const Drive& counted_driver(const Model& model) {
  const MeasureSettings& measure = model.scene().measure;
  const FaultCode code = code_without_period(model.scene());
  std::vector<const Drive*> candidates;
  for (const Model::Driver& driver : model.drivers()) {
    if (!drags(*driver.drive)) continue;
    if (measure.driver.empty() || driver.name == measure.driver) candidates.push_back(driver.drive);
  }
  if (candidates.empty()) {
    refuse_window(code, measure, measure.driver.empty() ? "in" : "driver",
                  "there is no moving driver to count periods of",
                  "\"time\", or the name of a driver with a velocity");
  }
  if (candidates.size() > 1) {
    refuse_window(code, measure, "in", "several drivers move, and the window does not name one",
                  "driver = NAME");
  }
  return *candidates.front();
}

/// Periods that the forces of a scene declare along the displacement of a driver.
struct PassedPeriod {
  double length = 0.0;  ///< 0: none
  double speed = 0.0;   ///< of the driver along that axis
  bool several = false;

  double time() const { return length / speed; }
};

/// Whether one time is a multiple of another.
bool is_multiple(double longer, double shorter) {
  constexpr double kEqual = 1e-9;
  const double ratio = longer / shorter;
  return ratio >= 1.0 - kEqual && std::abs(ratio - std::nearbyint(ratio)) <= kEqual * ratio;
}

PassedPeriod passed_period(const Model& model, const Drive& driver) {
  const Scene& scene = model.scene();
  if (scene.measure.period) return {*scene.measure.period, speed_of(driver)};
  PassedPeriod passed;
  for (int d = 0; d < model.dimension(); ++d) {
    if (driver.velocity[d] == 0.0) continue;
    for (const SceneForce& force : scene.forces) {
      const double declared = force.record->period(force.description.get(), d);
      if (declared <= 0.0) continue;
      const PassedPeriod here{declared, std::abs(driver.velocity[d])};
      // Along several axes all come back after the longest time, where the others fit into it.
      const bool known = passed.length > 0.0 && is_multiple(passed.time(), here.time());
      if (known) continue;
      passed.several =
          passed.several || (passed.length > 0.0 && !is_multiple(here.time(), passed.time()));
      passed.length = here.length;
      passed.speed = here.speed;
    }
  }
  return passed;
}

/// The time in which the driver that the window is counted in passes a period.
double period_of_driver(const Model& model) {
  const Scene& scene = model.scene();
  const PassedPeriod passed = passed_period(model, counted_driver(model));
  if (passed.several) {
    refuse_window(code_without_period(scene), scene.measure, "in",
                  "the forces declare several periods", "period = a length");
  }
  if (!(passed.length > 0.0)) {
    refuse_window(code_without_period(scene), scene.measure, "in",
                  "no force declares a period along the direction of the driver",
                  "period = a length");
  }
  return passed.time();
}

/// The first period, and as many whole ones as the run has room for.
void plan_periods(const UntilSettings& until, RunPlan& plan) {
  const double whole = std::floor(plan.duration / plan.period * (1.0 + kWindowSlack));
  if (whole < 1.0) {
    throw InputError({Fault(FaultCode::run_until_never, until.location, "run.until", "",
                            fmt::format("the run ends at time {:g}, before the first period of the "
                                        "driver is over at {:g}",
                                        plan.duration, plan.period),
                            "a later max, or a longer duration")});
  }
  plan.duration = whole * plan.period;
  plan.window_to = plan.period;
}

void plan_window(const MeasureSettings& measure, double unit, RunPlan& plan) {
  plan.window_from = measure.from * unit;
  plan.window_to = measure.to ? *measure.to * unit : plan.duration;
  const bool late = plan.window_to > plan.duration * (1.0 + kWindowSlack);
  if (late || plan.window_from >= plan.duration) {
    refuse_window(FaultCode::run_invalid_window, measure,
                  plan.window_to > plan.duration ? "to" : "from",
                  fmt::format("the window reaches to time {:g}, past the end of the run at {:g}",
                              std::max(plan.window_to, plan.window_from), plan.duration),
                  "a window within the run, or a longer run.duration");
  }
  plan.window_to = std::min(plan.window_to, plan.duration);
}

}  // namespace

double speed_of(const Drive& drive) {
  double squares = 0.0;
  for (const double v : drive.velocity) squares = std::fma(v, v, squares);
  return std::sqrt(squares);
}

double pull_speed_of(const Drive& drive) {
  double squares = 0.0;
  for (std::size_t d = 0; d < drive.velocity.size(); ++d) {
    if (!(drive.stiffness_on(static_cast<int>(d)) > 0.0)) continue;
    squares = std::fma(drive.velocity[d], drive.velocity[d], squares);
  }
  return squares > 0.0 ? std::sqrt(squares) : speed_of(drive);
}

bool drags(const Drive& drive) { return drive.steady && speed_of(drive) > 0.0; }

bool pulls(const Drive& drive) { return drags(drive) && drive.stiffness_along() > 0.0; }

bool reverses(const Model& model, const Model::Driver& driver) {
  return std::any_of(model.forces().begin(), model.forces().end(), [&](const Model::Force& force) {
    return force.name == driver.name && force.control->waits_for() != nullptr;
  });
}

std::optional<double> time_of_period(const Model& model, const Drive& drive) {
  if (!drags(drive)) return {};
  const PassedPeriod passed = passed_period(model, drive);
  if (passed.several || !(passed.length > 0.0)) return {};
  return passed.time();
}

double part_of_window(const Model& model, double dt, double length) {
  const double block = static_cast<double>(kBlock) * dt;
  for (const Model::Driver& driver : model.drivers()) {
    if (!drags(*driver.drive)) continue;
    const auto period = time_of_period(model, *driver.drive);
    const bool enough = period && length >= kFewestPeriods * *period;
    if (enough) return std::max(block, *period);
  }
  return block;
}

std::optional<std::size_t> body_pulled_by(const Model& model, const Model::Driver& driver) {
  for (const Model::Force& force : model.forces()) {
    if (force.name == driver.name) return force.bodies.front();
  }
  return {};
}

RunPlan plan_run(const Model& model) {
  const Scene& scene = model.scene();
  const SceneIntegrator& from = scene.run.integrator;
  RunPlan plan;
  plan.dt = bound_by(from, "integrator", [&] { return from.record->step(from.description.get()); });
  plan.duration = scene.run.duration;
  if (waits_for_steady(scene)) {
    plan.period = period_of_driver(model);
    plan_periods(*scene.run.until, plan);
  } else {
    const bool in_periods = scene.measure.unit == MeasureSettings::Unit::driver_periods;
    plan_window(scene.measure, in_periods ? period_of_driver(model) : 1.0, plan);
  }
  refuse_endless(scene, plan);
  if (plan.dt > 0.0) plan.whole_steps = whole_steps(plan.dt, plan.duration);
  return plan;
}

}  // namespace tomlin
