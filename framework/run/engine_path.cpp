#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/run/disturbance.hpp"
#include "framework/run/engine.hpp"

/// What the run loop does for schemes that follow equilibria: how a run starts, what a step shows,
/// and slips, which such schemes tell of.
namespace tomlin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

/// The start of a run is an equilibrium.
void Engine::settle() {
  forget_pulls();
  const StepFault fault = path_->settle(plan_.duration);
  if (fault != StepFault::none) fail(fault, 0.0);
}

void Engine::forget_pulls() {
  if (path_ != nullptr) std::fill(peaks_, peaks_ + drivers_.size(), -kInfinity);
}

/// The largest force along a driver's way since the last slip.
void Engine::see_pull(std::size_t driver, double pull) {
  if (drags(*drivers_[driver].drive))
    peaks_[driver] = std::max(peaks_[driver], pull * along_[driver]);
}

/// Steps are long, and forces fall steeply where an equilibrium is about to end: looks are at
/// equal distances along the path, and cubics go through four of them.
void Engine::look_along_path(double from, double to) {
  note_slipping();
  const auto at = [&](double part) { return from + (to - from) * part; };
  for (std::size_t first = 0; first + 3 < EquilibriumPath::kMoments; first += 3) {
    double part[4];
    for (std::size_t k = 0; k < 4; ++k) {
      part[k] = path_->moment(first + k, dense_position_.data(), dense_velocity_.data(),
                              dense_rates_.data());
      signals_from_rates(dense_rates_.data());
      signals_from_velocity(dense_velocity_.data(), at(part[k]));
      between_[k] = signals_;
      for (std::size_t driver = 0; driver < drivers_.size(); ++driver) {
        see_pull(driver, pull_of(driver, signals_.data()));
      }
      if (k == 3) break;
      read_bodies(dense_position_.data(), nullptr, between_readings_);
      watch(at(part[k]), signals_.data(), between_readings_);
    }
    include_cubics(at(part[0]), at(part[3]));
  }
}

/// To the next equilibrium. What the scene loses is the difference of two energies.
bool Engine::slip() {
  const SystemView<double>& view = model_.system().view;
  const double before =
      model_.potential_energy(now(), view.position, view.velocity, view.integrals);
  const StepFault fault =
      path_->slip(0.0, static_cast<double>(DoubleDouble(plan_.duration) - now()));
  counts_[kEvaluations] = static_cast<std::int64_t>(model_.system().evaluations);
  counts_[kColumns] = static_cast<std::int64_t>(model_.system().columns);
  if (fault != StepFault::none) {
    fail(fault, 0.0);
    return false;
  }
  const double lost =
      before - model_.potential_energy(now(), view.position, view.velocity, view.integrals);
  if (model_.friction_rate() != kNoRate) view.integrals[model_.friction_rate()] += lost;
  note_tie();
  if (!path_->jumped()) return true;
  model_.evaluate_at(now(), view.position, view.velocity, view.integrals, dense_rates_.data());
  signals_from_rates(dense_rates_.data());
  tell_of_slip(lost);
  return true;
}

/// Friction makes one state of starts that differ: what they would part at later needs noise there.
void Engine::disturb() {
  tomlin::disturb(*options_.perturbation, static_cast<std::uint64_t>(counts_[kSteps]), model_);
  *disturbed_ = time();
  integrator_->forces_changed();
}

void Engine::note_tie() {
  if (path_ == nullptr) return;
  const std::optional<std::size_t> coordinate = path_->tied();
  if (!coordinate) return;
  if (event_counts_[static_cast<std::size_t>(EventKind::tie)] == 0) {
    tie_[0] = time();
    tie_[1] = static_cast<double>(*coordinate);
  }
  Event event;
  event.kind = EventKind::tie;
  event.time = time();
  event.duration = 0.0;
  event.size = event.energy_lost = event.peak_force = kNone;
  const std::string body = model_.name_of(*coordinate).body;
  for (const Model::Body& one : model_.bodies()) {
    if (one.bound.name == body) event_name_ = one.bound.name;
  }
  record(event);
}

void Engine::warn_of_ties() {
  if (path_ == nullptr) return;
  const std::int64_t ties = event_counts_[static_cast<std::size_t>(EventKind::tie)];
  if (ties == 0) return;
  const Model::CoordinateName name = model_.name_of(static_cast<std::size_t>(tie_[1]));
  const std::string particle = name.particle < 0 ? "" : fmt::format(", particle {}", name.particle);
  const std::string times = ties == 1 ? "" : fmt::format(", the first of {} ties", ties);
  warnings_.push_back(fmt::format(
      "not determined after time {:.6g}{}: there the scene is symmetric and its equilibrium "
      "unstable, so that nothing but rounding decides which way {}{}, {} goes; break the symmetry "
      "by a small force, or see how far results differ with run.perturb",
      tie_[0], times, name.body, particle, name.axis));
}

/// It is the slip of the driver whose spring's end gets furthest ahead.
void Engine::tell_of_slip(double lost) {
  const std::vector<double>& held = between_[3];  // at the end of the step
  Event event;
  event.kind = EventKind::slip;
  event.time = time();
  event.duration = 0.0;
  event.size = event.peak_force = kNone;
  event.energy_lost = lost;
  event_name_ = drivers_.empty() ? model_.bodies().front().bound.name : drivers_.front().name;
  for (DriverWatch& watch : driver_watches_) {
    const std::size_t k = watch.driver();
    const double pull = pull_of(k, held.data()) * along_[k];
    const double ahead = (pull - pull_of(k, signals_.data()) * along_[k]) / watch.stiffness();
    if (std::isnan(event.size) || std::abs(ahead) > std::abs(event.size)) {
      event.size = ahead;
      event.peak_force = peaks_[k];
      event_name_ = drivers_[k].name;
    }
    if (ahead > 0.0) {
      static_forces_.include(k, pull_of(k, held.data()));
      static_forces_.settle(k);
    }
    watch.turned();
  }
  if (event.time >= from_.time && event.time <= to_.time) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      extremes_.include(drivers_.size() * model_.dimension() + b, kInfinity);
    }
  }
  forget_pulls();
  record(event);
}

/// What the run ends in. Looking at it is no part of the run's cost.
void Engine::describe_equilibrium() {
  System<double>& system = model_.system();
  const std::uint64_t evaluations = system.evaluations;
  const std::uint64_t columns = system.columns;
  model_.anchor(now());
  const EquilibriumState state = path_->state(0.0);
  system.evaluations = evaluations;
  system.columns = columns;
  EquilibriumResult& result = equilibrium_.emplace();
  const SystemView<double>& view = system.view;
  result.energy = model_.potential_energy(now(), view.position, view.velocity, view.integrals);
  result.neutral_directions = state.neutral;
  if (state.neutral < view.coordinates) result.smallest_curvature = state.softest;
  if (state.neutral == 0) result.log_determinant = state.log_determinant;
  for (const std::size_t coordinate : state.neutral_at) {
    const Model::CoordinateName name = model_.name_of(coordinate);
    const std::string particle =
        name.particle < 0 ? "" : fmt::format(", particle {}", name.particle);
    warnings_.push_back(
        fmt::format("nothing holds the scene in one direction, in which {}{}, {} moves most: it "
                    "stays where it is",
                    name.body, particle, name.axis));
  }
}

}  // namespace tomlin
