#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/run/bond_watch.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/run/prescribed_inertia.hpp"
#include "framework/run/watched_integrals.hpp"
#include "framework/run/window_warnings.hpp"

/// What is known at the end of a run.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

/// What is known at the end: the window may close there, and the final forces are read off. Where a
/// plugin throws once more, nothing is.
void Engine::finish() {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::fill(final_rates_.begin(), final_rates_.end(), kNothing);
  std::fill(observed_.begin(), observed_.end(), kNothing);
  kinetic_energy_ = potential_energy_ = kNothing;
  if (!attempt([this] { read_end(); })) {
    std::fill(final_rates_.begin(), final_rates_.end(), kNothing);
  }
}

void Engine::read_end() {
  const SystemView<double>& view = model_.system().view;
  if (!failure_ && !interrupted_ && *from_.reached != 0 && *to_.reached == 0) {
    keep_moment(to_, to_.time, view.position, view.velocity, view.integrals);
  }
  model_.evaluate_at(now(), view.position, view.velocity, view.integrals, final_rates_.data());
  if (path_ != nullptr && !failure_) describe_equilibrium();
  if (!watchers_.empty()) observe(time(), view.position, view.velocity, observed_.data());
  if (!failure_ && !interrupted_) {
    finish_events();
    warn_of_unsteadiness();
    warn_of_ties();
    warn_of_window();
    double work = 0.0;
    for (const Model::Driver& driver : drivers_) {
      const std::size_t power = driver.first_rate + model_.dimension();
      work += to_.integrals[power] - from_.integrals[power];
    }
    const double rounding = integrator_->rounding_of_works();
    const double tolerance =
        scheme_.tolerance ? scheme_.tolerance(scene_->run.integrator.description.get()) : 0.0;
    if (const auto doubt = doubt_of_rounding(rounding, work, tolerance)) {
      warnings_.push_back(*doubt);
    }
  }
  if (ledger_) {
    kinetic_energy_ = kinetic_energy_now();
    potential_energy_ =
        model_.potential_energy(now(), view.position, view.velocity, view.integrals);
  }
  if (!failure_ && !interrupted_) warn_of_energy();
}

/// At the end: what springs pull has followed them, and slips enough have been seen.
void Engine::warn_of_window() {
  if (plan_.period > 0.0 || *from_.reached == 0 || *to_.reached == 0) return;
  const auto axes = static_cast<std::size_t>(model_.dimension());
  for (const DriverWatch& watch : driver_watches_) {
    const std::size_t k = watch.driver();
    const DriverWindow window = driver_window(model_, k, from_.time, to_.time);
    const auto body = body_pulled_by(k);
    if (!(window.period > 0.0) || !window.steady || !body) continue;
    const auto axis = static_cast<std::size_t>(window.axis);
    const auto way =
        static_cast<double>(to_.place(*body * axes + axis) - from_.place(*body * axes + axis));
    const double moved = direction_[k * axes + axis] < 0.0 ? -way : way;
    std::optional<std::uint64_t> slips;
    if (watch.watches_slips() && driver_watches_.size() == 1) {
      slips = static_cast<std::uint64_t>(*slips_within_);
    }
    const auto all =
        static_cast<std::uint64_t>(event_counts_[static_cast<std::size_t>(EventKind::slip)]);
    for (std::string& doubt : doubts_after(window, moved, slips, all, to_.time >= plan_.duration)) {
      warnings_.push_back(std::move(doubt));
    }
  }
}

/// Over the window, each term from its own integral; what does not balance is the integrator's.
EnergyResult Engine::energy(bool window) const {
  EnergyResult energy;
  energy.kinetic = kinetic_energy_;
  energy.potential = potential_energy_;
  if (!window) return energy;
  const EnergyTerms terms = terms_between(from_.integrals, to_.integrals, from_.time, to_.time);
  energy.work_in = terms.work;
  energy.heat_out = terms.heat;
  energy.stored_change = *to_.stored - *from_.stored;
  energy.numerical_work = *energy.stored_change + terms.heat - terms.work;
  return energy;
}

/// Work and heat between two times, from running integrals with a ledger.
EnergyTerms Engine::terms_between(const double* from_integrals, const double* to_integrals,
                                  double from, double to) const {
  const auto between = [&](std::ptrdiff_t rate) {
    return to_integrals[rate] - from_integrals[rate];
  };
  EnergyTerms terms;
  for (const Model::Driver& driver : drivers_) {
    terms.work += between(driver.first_rate + model_.dimension());
    if (is_accelerated(model_, driver)) {
      terms.work += inertia_lacking(model_, driver, from_integrals, to_integrals, from, to).back();
    }
  }
  for (const Model::Force& force : model_.forces()) {
    if (force.heat_rate == kNoRate) continue;
    // An energy that changes with time does work on the scene: its heat is that, with the other
    // sign.
    (force.traits.conservative ? terms.work : terms.heat) +=
        (force.traits.conservative ? -1.0 : 1.0) * between(force.heat_rate);
  }
  if (model_.friction_rate() != kNoRate) terms.heat += between(model_.friction_rate());
  return terms;
}

double Engine::kinetic_energy_now() const {
  return model_.kinetic_energy(model_.system().view.velocity) +
         prescribed_kinetic_energy(model_, time());
}

/// But for a constant.
double Engine::stored_energy() {
  const SystemView<double>& view = model_.system().view;
  return kinetic_energy_now() +
         model_.potential_energy(now(), view.position, view.velocity, view.integrals);
}

/// Over the window: with a ledger all of it, else as sampled.
void Engine::warn_of_energy() {
  if (!options_.watches_energy || path_ != nullptr) return;
  std::optional<SampledWork> found;
  if (ledger_) {
    if (*from_.reached == 0 || *to_.reached == 0) return;
    const EnergyResult whole = energy(true);
    const double at_end = whole.kinetic + whole.potential;
    found =
        SampledWork{.work = *whole.work_in,
                    .heat = *whole.heat_out,
                    .kinetic = whole.kinetic,
                    .stored = std::max(std::abs(at_end), std::abs(at_end - *whole.stored_change)),
                    .numerical = *whole.numerical_work};
  } else if (balance_) {
    found = balance_->found();
  }
  if (!found) return;
  if (auto doubt = doubt_of_balance(*found, !ledger_)) warnings_.push_back(*std::move(doubt));
}

RunResult Engine::result() {
  RunResult result;
  attempt([&] { result.refused_steps = integrator_->refused_steps(); });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started_;
  result.status = failure_       ? RunStatus::failed
                  : interrupted_ ? RunStatus::interrupted
                                 : RunStatus::finished;
  result.failure = failure_;
  result.end_time = time();
  result.steps = static_cast<std::uint64_t>(counts_[kSteps]);
  result.force_evaluations = model_.system().evaluations;
  result.jacobian_columns = model_.system().columns;
  if (plan_.period > 0.0) result.steady = steady();
  result.window_from = from_.time;
  result.window_to = to_.time;
  result.warnings = warnings_;
  if (long_bonds_ != nullptr) {
    for (std::string& warning : warnings_of_long_bonds(model_, long_bonds_)) {
      result.warnings.push_back(std::move(warning));
    }
  }
  for (const Model::LeftOut& left : model_.left_out()) {
    result.left_out.emplace_back(left.force, left.why);
  }
  result.wall_seconds = elapsed.count();
  if (elapsed.count() > 0.0) {
    result.steps_per_second = static_cast<double>(result.steps - steps_before_) / elapsed.count();
  }
  result.instruction_set = options_.instruction_set;

  const bool window = *from_.reached != 0 && *to_.reached != 0;
  for (std::size_t k = 0; k < drivers_.size(); ++k) {
    result.groups.push_back(driver_results(k, window));
  }
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    result.groups.push_back(body_results(b, window));
  }
  if (!watchers_.empty()) observer_results(result.groups);
  result.groups.push_back(event_results());
  if (equilibrium_) result.groups.push_back(equilibrium_results());
  if (ledger_) result.groups.push_back(energy_results(window));
  return result;
}

}  // namespace tomlin
