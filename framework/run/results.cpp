#include "framework/run/results.hpp"

#include <cmath>
#include <utility>

#include "framework/run/engine.hpp"
#include "framework/run/engine_parts.hpp"
#include "framework/run/prescribed_inertia.hpp"

/// What a run reports. A quantity is a row here and a line where its family is filled.
namespace tomlin {

using namespace engine_parts;  // NOLINT: its own parts

namespace {

using enum Scope;
using enum Shape;

enum DriverRow {
  kMeanForce,
  kFinalForce,
  kMaxForce,
  kMinForce,
  kStaticForce,
  kWork,
  kWorkPerDistance,
  kDistance,
};
const ResultQuantity kDriverRows[] = {
    {"mean_force", dimension::force, vector, window,
     "integral of the force over the window, by its length"},
    {"final_force", dimension::force, vector, end, "force at the end"},
    {"max_force", dimension::force, vector, window, "largest component along the axis"},
    {"min_force", dimension::force, vector, window, "smallest component along the axis"},
    {"static_force", dimension::force, number, run,
     "largest force along the pull before the first slip; of the whole run where nothing slips"},
    {"work", dimension::energy, number, window, "work of the driver on the scene"},
    {"work_per_distance", dimension::force, number, window, "work by distance"},
    {"distance", dimension::length, number, window,
     "displacement of the pulled end, at steady velocity"},
};

enum BodyRow { kCentre, kVelocity, kRotationRow, kTurns, kRolling, kMeanVelocity, kMaxSpeed };
const ResultQuantity kBodyRows[] = {
    {"centre_of_mass", dimension::length, vector, end, "position of the centre of mass"},
    {"velocity", dimension::velocity, vector, end, "velocity of the centre of mass"},
    {"rotation", dimension::none, number, end,
     "angle from the start, unwrapped, counter-clockwise positive", "rad"},
    {"turns", dimension::none, number, window, "revolutions, counter-clockwise positive"},
    {"rolling", dimension::none, number, window,
     "-R dphi/dx of a round body: 1 where it rolls without sliding"},
    {"mean_velocity", dimension::velocity, vector, window, "displacement of the centre by time"},
    {"max_speed", dimension::velocity, number, window,
     "largest speed of the centre; null where it slips in no time"},
};

enum EventRow { kSlipRow, kHopRow, kTurnRow, kReversalRow, kDriverReversalRow, kTieRow };
const ResultQuantity kEventRows[] = {
    {"slips", dimension::none, count, run, "slips of what drivers of steady velocity pull"},
    {"hops", dimension::none, count, run, "hops of round bodies in the plane"},
    {"turns", dimension::none, count, run, "whole revolutions of bodies in the plane"},
    {"reversals", dimension::none, count, run, "motions of pulled points against their drivers"},
    {"driver_reversals", dimension::none, count, run, "times that a driver has turned back"},
    {"ties", dimension::none, count, run, "unstable symmetric equilibria of quasistatic dynamics"},
};

enum EquilibriumRow { kEnergyRow, kNeutralRow, kCurvatureRow, kDeterminantRow };
const ResultQuantity kEquilibriumRows[] = {
    {"energy", dimension::energy, number, end, "potential energy, but for a constant"},
    {"neutral_directions", dimension::none, count, end, "zero modes: unconstrained directions"},
    {"smallest_curvature", dimension::stiffness, number, end,
     "smallest second derivative of the energy along a direction that is held"},
    {"log_determinant", dimension::none, number, end,
     "ln |det| of the energy's second derivatives"},
};

enum EnergyRow { kKinetic, kPotential, kWorkIn, kHeatOut, kStoredChange, kNumericalWork };
const ResultQuantity kEnergyRows[] = {
    {"kinetic", dimension::energy, number, end, "kinetic energy"},
    {"potential", dimension::energy, number, end, "potential energy, but for a constant"},
    {"work_in", dimension::energy, number, window,
     "work of all drivers and of energies that change with time"},
    {"heat_out", dimension::energy, number, window, "energy dissipated by all dampers"},
    {"stored_change", dimension::energy, number, window, "change of kinetic and potential energy"},
    {"numerical_work", dimension::energy, number, window,
     "stored_change + heat_out - work_in: what the integrator added"},
};

enum TimeRow { kEnd, kSteps, kForceEvaluations, kJacobianColumns, kRefusedSteps };
const ResultQuantity kTimeRows[] = {
    {"end", dimension::time, number, end, "time that the run has reached"},
    {"steps", dimension::none, count, run, "steps"},
    {"force_evaluations", dimension::none, count, run, "evaluations of all forces"},
    {"jacobian_columns", dimension::none, count, run,
     "columns of derivatives, each worth an evaluation"},
    {"refused_steps", dimension::none, count, run, "attempts that the error control refused"},
};

const ResultQuantity kWindowRows[] = {
    {"from", dimension::time, number, window, "beginning of the window"},
    {"to", dimension::time, number, window, "end of the window"},
};

const ResultQuantity kPerformanceRows[] = {
    {"wall_seconds", dimension::none, number, run, "duration of the run on this machine", "s"},
    {"steps_per_second", dimension::none, number, run, "steps by wall_seconds", "1/s"},
};

const ResultFamily kFamilies[] = {
    {"time", "", "", kTimeRows},
    {"window", "", "", kWindowRows},
    {"drivers", "each driver", "", kDriverRows},
    {"bodies", "each body", "", kBodyRows},
    {"events", "", "", kEventRows},
    {"equilibrium", "", "with dynamics = \"quasistatic\"", kEquilibriumRows},
    {"energy", "", "with ledger = true", kEnergyRows},
    {"performance", "", "", kPerformanceRows},
};

std::optional<double> number_of(std::optional<std::uint64_t> count) {
  if (!count) return {};
  return static_cast<double>(*count);
}

}  // namespace

std::span<const ResultFamily> result_families() { return kFamilies; }

const ResultQuantity* quantity_at(std::string_view path) {
  const auto last = [](std::string_view text) { return text.substr(text.rfind('.') + 1); };
  std::string_view key = last(path);
  if (key == "x" || key == "y" || key == "z") {
    key = last(path.substr(0, path.size() - 2));
  }
  for (const bool named : {true, false}) {
    for (const ResultFamily& family : kFamilies) {
      if (named && !path.starts_with(family.family)) continue;
      for (const ResultQuantity& quantity : family.quantities) {
        if (quantity.key == key) return &quantity;
      }
    }
  }
  return nullptr;
}

std::vector<ResultGroup> groups_of_run(const RunResult& result) {
  ResultGroup time = {"time", "", {}};
  time.add(kTimeRows[kEnd], result.end_time);
  time.add(kTimeRows[kSteps], number_of(result.steps));
  time.add(kTimeRows[kForceEvaluations], number_of(result.force_evaluations));
  time.add(kTimeRows[kJacobianColumns], number_of(result.jacobian_columns));
  time.add(kTimeRows[kRefusedSteps], number_of(result.refused_steps));
  ResultGroup window = {"window", "", {}};
  window.add(kWindowRows[0], result.window_from);
  window.add(kWindowRows[1], result.window_to);
  ResultGroup performance = {"performance", "", {}};
  performance.add(kPerformanceRows[0], result.wall_seconds);
  performance.add(kPerformanceRows[1], result.steps_per_second);
  return {std::move(time), std::move(window), std::move(performance)};
}

ResultGroup Engine::driver_results(std::size_t k, bool has_window) const {
  const auto axes = static_cast<std::size_t>(model_.dimension());
  const Model::Driver& driver = drivers_[k];
  const double length = to_.time - from_.time;
  std::vector<double> mean;
  std::vector<double> final_force;
  std::vector<double> max;
  std::vector<double> min;
  std::vector<double> lacking;
  for (std::vector<double>* values : {&mean, &final_force, &max, &min}) values->reserve(axes);
  if (has_window) {
    lacking = inertia_lacking(model_, driver, from_.integrals, to_.integrals, from_.time, to_.time);
  }
  for (std::size_t d = 0; d < axes; ++d) {
    const std::size_t rate = static_cast<std::size_t>(driver.first_rate) + d;
    final_force.push_back(final_rates_[rate]);
    if (!has_window) continue;
    mean.push_back((to_.integrals[rate] - from_.integrals[rate] + lacking[d]) / length);
    max.push_back(extremes_.high(k * axes + d));
    min.push_back(extremes_.low(k * axes + d));
  }
  const double speed = norm(driver.drive->velocity);
  std::optional<double> static_force;
  if (drags(*driver.drive) && static_forces_.any(k)) static_force = static_forces_.value(k) / speed;
  std::optional<double> work;
  std::optional<double> distance;
  std::optional<double> work_per_distance;
  if (has_window) {
    const std::size_t power = static_cast<std::size_t>(driver.first_rate) + axes;
    work = to_.integrals[power] - from_.integrals[power] + lacking[axes];
    if (driver.drive->steady) distance = speed * length;
    if (driver.drive->steady && speed > 0.0) work_per_distance = *work / *distance;
  }
  ResultGroup group = {"drivers", driver.name, {}};
  group.add(kDriverRows[kMeanForce], axes, mean);
  group.add(kDriverRows[kFinalForce], axes, final_force);
  group.add(kDriverRows[kMaxForce], axes, max);
  group.add(kDriverRows[kMinForce], axes, min);
  group.add(kDriverRows[kStaticForce], static_force);
  group.add(kDriverRows[kWork], work);
  group.add(kDriverRows[kWorkPerDistance], work_per_distance);
  group.add(kDriverRows[kDistance], distance);
  return group;
}

ResultGroup Engine::body_results(std::size_t b, bool has_window) const {
  const auto axes = static_cast<std::size_t>(model_.dimension());
  const Model::Body& body = model_.bodies()[b];
  const SystemView<double>& view = model_.system().view;
  double numbers[3];
  std::vector<double> centre;
  std::vector<double> velocity;
  std::vector<double> mean_velocity;
  centre.reserve(axes);
  mean_velocity.reserve(axes);
  model_.centre(b, view.position, numbers);
  for (int d = 0; d < model_.dimension(); ++d) {
    centre.push_back(static_cast<double>(model_.placed(d, numbers[d])));
  }
  model_.centre_velocity(b, view.velocity, numbers);
  velocity.assign(numbers, numbers + axes);
  std::optional<double> rotation;
  std::optional<double> turns;
  std::optional<double> rolling;
  std::optional<double> max_speed;
  if (body.rotates()) rotation = kTau * turns_of(b, view.position);
  if (has_window) {
    for (std::size_t d = 0; d < axes; ++d) {
      const DoubleDouble moved = to_.place(b * axes + d) - from_.place(b * axes + d);
      mean_velocity.push_back(static_cast<double>(moved) / (to_.time - from_.time));
    }
    max_speed = extremes_.high(drivers_.size() * axes + b);
  }
  if (has_window && body.rotates()) {
    turns = to_.turns[b] - from_.turns[b];
    const double moved = static_cast<double>(to_.place(b * axes) - from_.place(b * axes));
    if (body.rolling_radius > 0.0 && moved != 0.0) {
      rolling = body.rolling_radius * kTau * (0.0 - *turns) / moved;
    }
  }
  ResultGroup group = {"bodies", body.bound.name, {}};
  group.add(kBodyRows[kCentre], axes, centre);
  group.add(kBodyRows[kVelocity], axes, velocity);
  if (axes == 2) {
    group.add(kBodyRows[kRotationRow], rotation);
    group.add(kBodyRows[kTurns], turns);
    group.add(kBodyRows[kRolling], rolling);
  }
  group.add(kBodyRows[kMeanVelocity], axes, mean_velocity);
  group.add(kBodyRows[kMaxSpeed], max_speed);
  return group;
}

ResultGroup Engine::event_results() const {
  const auto found = [this](EventKind kind, bool possible) -> std::optional<double> {
    if (!possible) return {};
    return static_cast<double>(event_counts_[static_cast<std::size_t>(kind)]);
  };
  bool slips = path_ != nullptr;
  for (const DriverWatch& watch : driver_watches_) slips = slips || watch.watches_slips();
  bool hops = false;
  for (const BodyWatch& watch : body_watches_) hops = hops || watch.watches_hops();
  ResultGroup group = {"events", "", {}};
  group.add(kEventRows[kSlipRow], found(EventKind::slip, slips));
  group.add(kEventRows[kHopRow], found(EventKind::hop, hops));
  group.add(kEventRows[kTurnRow], found(EventKind::turn, !body_watches_.empty()));
  group.add(kEventRows[kReversalRow], found(EventKind::reversal, !driver_watches_.empty()));
  group.add(kEventRows[kDriverReversalRow], found(EventKind::driver_reversal, !triggers_.empty()));
  group.add(kEventRows[kTieRow], found(EventKind::tie, path_ != nullptr));
  return group;
}

ResultGroup Engine::equilibrium_results() const {
  ResultGroup group = {"equilibrium", "", {}};
  group.add(kEquilibriumRows[kEnergyRow], equilibrium_->energy);
  group.add(kEquilibriumRows[kNeutralRow], number_of(equilibrium_->neutral_directions));
  group.add(kEquilibriumRows[kCurvatureRow], equilibrium_->smallest_curvature);
  group.add(kEquilibriumRows[kDeterminantRow], equilibrium_->log_determinant);
  return group;
}

ResultGroup Engine::energy_results(bool has_window) const {
  const EnergyResult found = energy(has_window);
  ResultGroup group = {"energy", "", {}};
  group.add(kEnergyRows[kKinetic], found.kinetic);
  group.add(kEnergyRows[kPotential], found.potential);
  group.add(kEnergyRows[kWorkIn], found.work_in);
  group.add(kEnergyRows[kHeatOut], found.heat_out);
  group.add(kEnergyRows[kStoredChange], found.stored_change);
  group.add(kEnergyRows[kNumericalWork], found.numerical_work);
  return group;
}

}  // namespace tomlin
