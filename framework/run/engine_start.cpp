#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/tolerance.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/scene/natural_units.hpp"

/// What a run is refused for or warned of before its first step, and the window that it is asked
/// for.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

/// How far past the end of the run a window may reach through rounding alone.
constexpr double kWindowSlack = 1e-9;

/// Tolerances that floats can keep: ten units in the last place.
constexpr double kFinestOfFloat = 1e-6;

/// Weeks of the simplest scene.
constexpr double kMostSteps = 1e14;
/// Of them the fastest scene takes so many a second.
constexpr double kFastestSteps = 1e8;
constexpr double kSecondsOfADay = 86400.0;
/// A table of a hundred terabytes.
constexpr double kMostSamples = 1e12;

}  // namespace

/// A run must end, its counts stay exact, and a signal must get through between samples.
void Engine::refuse_endless() const {
  const auto place = [](const std::map<std::string, Place>& places, const char* key,
                        const Place& table) {
    const auto found = places.find(key);
    return found == places.end() ? table : found->second;
  };
  if (dt_ > 0.0 && !(duration_ / dt_ <= kMostSteps)) {
    throw InputError(
        {{place(scene_->run.integrator.places, "dt", scene_->run.place), "run.integrator.dt",
          fmt::format("{}", dt_),
          fmt::format("the run would take {:.3g} steps, {:.2g} days at the very least",
                      duration_ / dt_, duration_ / dt_ / kFastestSteps / kSecondsOfADay),
          fmt::format("at most {:g} steps", kMostSteps), ""}});
  }
  if (scene_->output.every && !(duration_ / *scene_->output.every <= kMostSamples)) {
    throw InputError(
        {{place(scene_->output.places, "every", scene_->output.place), "output.every",
          fmt::format("{}", *scene_->output.every),
          fmt::format("the run would leave {:.3g} samples", duration_ / *scene_->output.every),
          fmt::format("at most {:g} samples", kMostSamples), ""}});
  }
}

void Engine::resolve_window() {
  const MeasureSettings& m = scene_->measure;
  double unit = 1.0;
  if (m.unit == MeasureSettings::Unit::driver_periods || scene_->run.until) {
    const auto fault = [&](const std::string& key, const std::string& why,
                           const std::string& admissible) {
      const auto found = m.places.find(key);
      throw InputError({{found == m.places.end() ? m.place : found->second, "measure." + key, "",
                         why, admissible, ""}});
    };
    std::vector<std::size_t> candidates;
    for (std::size_t k = 0; k < drivers_.size(); ++k) {
      if (drags_[k] && (m.driver.empty() || drivers_[k].name == m.driver)) {
        candidates.push_back(k);
      }
    }
    if (candidates.empty()) {
      fault(m.driver.empty() ? "in" : "driver", "there is no moving driver to count periods of",
            "\"time\", or the name of a driver with a velocity");
    }
    if (candidates.size() > 1) {
      fault("in", "several drivers move: say whose periods are meant", "driver = NAME");
    }
    const std::vector<double>& velocity = drivers_[candidates.front()].drive->velocity;
    if (m.period) {
      unit = *m.period / norm(velocity);
    } else {
      double period = 0.0;
      int along = -1;
      for (int d = 0; d < model_.dimension(); ++d) {
        if (velocity[d] == 0.0) continue;
        for (const SceneForce& force : scene_->forces) {
          const double declared = force.record->period(force.description.get(), d);
          if (declared <= 0.0) continue;
          if (period > 0.0 && declared != period) {
            fault("in", "the forces declare several periods: say which is meant",
                  "period = a length");
          }
          period = declared;
          along = d;
        }
      }
      if (along < 0) {
        fault("in", "no force declares a period along the driver's way", "period = a length");
      }
      unit = period / std::abs(velocity[along]);
    }
  }
  if (scene_->run.until) {
    period_ = unit;
    const double whole = std::floor(duration_ / period_ * (1.0 + kWindowSlack));
    if (whole < 1.0) {
      throw InputError({{scene_->run.until->place, "run.until", "",
                         fmt::format("the run ends at time {:g}, before the first period of the "
                                     "driver is over at {:g}",
                                     duration_, period_),
                         "a later max, or a longer duration", ""}});
    }
    duration_ = whole * period_;
    to_.time = period_;
    return;
  }
  from_.time = m.from * unit;
  to_.time = m.to ? *m.to * unit : duration_;
  if (to_.time > duration_ * (1.0 + kWindowSlack) || from_.time >= duration_) {
    const auto found = m.places.find(to_.time > duration_ ? "to" : "from");
    throw InputError(
        {{found == m.places.end() ? m.place : found->second,
          to_.time > duration_ ? "measure.to" : "measure.from", "",
          fmt::format("the window reaches to time {:g}, past the end of the run at {:g}",
                      std::max(to_.time, from_.time), duration_),
          "a window within the run, or a longer run.duration", ""}});
  }
  to_.time = std::min(to_.time, duration_);
}

/// Where nothing is free there is no error for an adaptive scheme to control, yet forces on what is
/// prescribed change along its way: parts of a period, or of the run where there is none. Schemes
/// that follow equilibria do not look at the errors of prescribed ways either.
void Engine::bound_unwatched_steps() {
  const SystemView<double>& view = model_.system().view;
  const bool watched = view.coordinates > 0 && (path_ == nullptr || view.own_count == 0);
  if (dt_ > 0.0 || watched) return;
  constexpr double kPartOfPeriod = 0.02;
  constexpr double kPartOfRun = 1e-3;
  longest_unwatched_ = kPartOfRun * duration_;
  double period = std::numeric_limits<double>::infinity();
  for (int d = 0; d < model_.dimension(); ++d) {
    if (model_.origin().unit[d] > 0.0) period = std::min(period, model_.origin().unit[d]);
  }
  for (const Model::Body& body : model_.bodies()) {
    if (!body.prescribed()) continue;
    const double speed = fastest_of(body, duration_);
    if (!(speed > 0.0)) continue;
    const double scale =
        std::isfinite(period) ? period : std::max(reach_of(body), speed * duration_);
    longest_unwatched_ = std::min(longest_unwatched_, kPartOfPeriod * scale / speed);
  }
}

/// An adaptive scheme that is asked for more digits than its numbers have.
void Engine::warn_of_fine_tolerance() {
  if (scheme_.tolerance == nullptr || scene_->run.number_type != "float") return;
  const double asked =
      *tolerance_of(scene_->run.integrator, tolerance_scales(model_.system().view).length);
  if (asked >= kFinestOfFloat) return;
  warnings_.push_back(fmt::format(
      "floats carry no tolerance of {:g} of a length: below about {:g} steps follow their rounding "
      "and get very short",
      asked, kFinestOfFloat));
}

/// Without inertia velocities follow from forces, whatever the scene says of them at the start.
void Engine::warn_of_idle_velocities() {
  if (model_.system().view.inertial && path_ == nullptr) return;
  for (const SceneBody& body : scene_->bodies) {
    const PerParticleVector& given = body.record->common(body.description.get()).velocity;
    const bool any = std::any_of(given.values.begin(), given.values.end(), [](const auto& vector) {
      return std::any_of(vector.components.begin(), vector.components.end(),
                         [](double v) { return v != 0.0; });
    });
    if (!any) continue;
    warnings_.push_back(
        fmt::format("body.{}.velocity means nothing without inertia: velocities follow from {}",
                    body.name, path_ == nullptr ? "forces" : "the drivers'"));
  }
}

/// Quasistatic dynamics have a scheme of their own.
void Engine::warn_of_unused_integrator() {
  const SceneIntegrator& integrator = scene_->run.integrator;
  if (integrator.not_used.empty()) return;
  warnings_.push_back(
      fmt::format("run.integrator = {} is not used: quasistatic dynamics follow equilibria by {}",
                  integrator.not_used, integrator.name));
}

/// A step beyond the stability limit is refused before it is taken.
void Engine::check_step() {
  if (dt_ == 0.0) return;
  stable_step_ = model_.stable_step(scheme_);
  const double longest = std::min(dt_, duration_);
  if (longest <= stable_step_ * (1.0 + kNoStep)) return;
  if (scene_->run.allow_unstable) {
    warnings_.push_back(fmt::format("dt = {:g} is beyond the stability limit of {}, about {:.4g}",
                                    dt_, scheme_.name, stable_step_));
    return;
  }
  fail(StepFault::not_finite_or_too_far, dt_);
  failure_->what = fmt::format("dt = {:g} is beyond the stability limit of {}, about {:.4g}", dt_,
                               scheme_.name, stable_step_);
  failure_->force = model_.stiffest_force();
  failure_->cause =
      "the stiffest force allows no longer step; take a smaller dt, or insist with "
      "run.allow_unstable = true";
}

}  // namespace tomlin
