#include "framework/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/numbers/rotation_vector.hpp"
#include "framework/core/records/facets.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/model/scheme_checks.hpp"

TOMLIN_DECLARE_DOUBLE_TABLES(ObserveKernels, ObserveTable)

namespace tomlin {

namespace {

/// Builds a body's particles at the start: as many as it says, each in all dimensions.
BodyGeometry build(const SceneBody& body, int dimension) {
  const void* description = body.description.get();
  BodyGeometry geometry = body.record->build(description, dimension);
  const std::int64_t count = body.record->count(description);
  const auto axes = static_cast<std::size_t>(dimension);
  const bool fits = geometry.anchor.size() == axes &&
                    geometry.relative.size() == static_cast<std::size_t>(count) &&
                    std::all_of(geometry.relative.begin(), geometry.relative.end(),
                                [axes](const auto& point) { return point.size() == axes; });
  if (!fits) {
    throw UnfitPart(
        fmt::format("its geometry is not that of {} particles in {} dimensions", count, dimension));
  }
  const auto& displacement = body.record->common(description).displacement.values;
  for (std::size_t i = 0; !displacement.empty() && i < geometry.relative.size(); ++i) {
    const SpaceVector& by = displacement[displacement.size() == 1 ? 0 : i];
    for (std::size_t d = 0; d < axes; ++d) geometry.relative[i][d] += by.components[d];
  }
  return geometry;
}

/// The cells of an origin that is where a run has left its own, or less than a cell before it.
std::int64_t cells_near(const FinalState& from, const Origin& origin, int axis) {
  const double unit = origin.unit[axis];
  if (unit == from.origin.unit[axis] || !(unit > 0.0)) return from.origin.cells[axis];
  return static_cast<std::int64_t>(
      static_cast<double>(absolute_position(from.origin, axis, 0.0) / Quad(unit)));
}

}  // namespace

/// The unit of each axis is the longest period or cell that a force declares on it; the body with
/// the lowest start decides how many of them the scene is away, so that the order of bodies does
/// not.
AssemblyPlan Model::plan_for(const Scene& scene, InstructionSet set, const Team* team) {
  AssemblyPlan plan;
  plan.scene = &scene;
  plan.set = set;
  plan.team = team;
  plan.quasistatic = scene.run.dynamics == Dynamics::quasistatic;
  plan.inertial = scene.run.dynamics == Dynamics::inertial || plan.quasistatic;
  plan.splits_friction = scene.run.integrator.record->splits_friction || plan.quasistatic;
  plan.ledger = scene.run.ledger;
  plan.half_step_velocities = scene.run.integrator.record->half_step_velocities;
  std::vector<BodyGeometry> geometry;
  for (const SceneBody& body : scene.bodies) {
    geometry.push_back(bound_by(body, "body", [&] { return build(body, scene.dimension); }));
  }
  for (int axis = 0; axis < scene.dimension; ++axis) {
    if (!scene.box.lengths.empty() && scene.box.periodic[axis]) {
      plan.box[axis] = scene.box.lengths[axis];
    }
    double unit = 0.0;
    for (const SceneForce& force : scene.forces) {
      unit = std::max(unit, bound_by(force, "force", [&] {
                        const void* description = force.description.get();
                        const double period = force.record->period(description, axis);
                        return period > 0.0 ? period : force.record->origin_cell(description, axis);
                      }));
    }
    plan.origin.unit[axis] = unit;
    if (!(unit > 0.0)) continue;
    double lowest = geometry.front().anchor[axis];
    for (const BodyGeometry& one : geometry) lowest = std::min(lowest, one.anchor[axis]);
    remainder_of(DoubleDouble(lowest), unit, plan.origin.cells[axis]);
  }
  plan.geometry = std::make_shared<const std::vector<BodyGeometry>>(std::move(geometry));
  return plan;
}

Model::Model(std::shared_ptr<const Scene> scene, InstructionSet set, const Team* team)
    : scene_(std::move(scene)),
      plan_(plan_for(*scene_, set, team)),
      assembly_(plan_),
      observe_(kernels::ObserveKernels.on(set)),
      origin_(plan_.origin) {
  check_scheme(assembly_);
  keep_shapes();
  place_origin();
  rates_.assign(system().view.rates + 2 * kGroup, 0.0);
  system().begin_step = &Model::begin_step;
  system().model = this;
  build_tangent();
  build_elastic();
}

void Model::build_elastic() {
  const SceneIntegrator& scheme = scene_->run.integrator;
  if (!scheme.record->splits_bonds) return;
  std::string fault;
  elastic_ = elastic_bodies(assembly_, fault);
  if (!fault.empty()) {
    throw InputError(
        {Fault(FaultCode::integrator_unsuitable, scheme.location, "run.integrator.type",
               "\"" + scheme.record->name + "\"", "splits bonds and friction off, but " + fault,
               integrators_with_bonds_as_forces(*scene_))});
  }
  system().elastic = &elastic_;
}

Model::~Model() = default;

/// Derivatives of the forces, for schemes that solve equations with them.
void Model::build_tangent() {
  const SceneIntegrator& scheme = scene_->run.integrator;
  if (!scheme.record->needs_tangent && !scheme.record->follows_equilibria) return;
  tangent_ = std::make_unique<ForceTangent>(assembly_);
  if (!tangent_->unknown().empty()) {
    throw InputError(
        {Fault(FaultCode::integrator_unsuitable, scheme.location, "run.integrator.type",
               "\"" + scheme.record->name + "\"",
               "solves equations with the forces' derivatives, but " + tangent_->unknown(),
               integrators_for_any_scene(*scene_))});
  }
  system().tangent = tangent_.get();
}

void Model::keep_shapes() {
  shapes_.resize(bodies().size());
  for (std::size_t b = 0; b < bodies().size(); ++b) {
    const Body& body = bodies()[b];
    if (body.bound.slot.mapped || !body.rotates()) continue;
    const std::size_t length = padded(body.bound.slot.count);
    shapes_[b].assign(3 * length, 0.0);
    for (std::size_t i = 0; i < body.bound.slot.count; ++i) {
      for (std::size_t d = 0; d < 2; ++d) {
        shapes_[b][d * length + i] = body.arms[i][static_cast<std::size_t>(body.plane[d])];
      }
      shapes_[b][2 * length + i] = body.bound.mass[i];
    }
  }
}

void Model::place_origin() {
  for (int d = 0; d < dimension(); ++d) {
    origin_position_[d] = DoubleDouble(static_cast<double>(origin_.cells[d])) * origin_.unit[d];
  }
}

void Model::begin_step(void* model, double time_high, double time_low) {
  auto* const self = static_cast<Model*>(model);
  self->anchor_ = DoubleDouble(time_high, time_low);
  self->assembly_.begin_step(self->anchor_);
  if (self->follower_) self->follower_->begin_step(self->anchor_);
}

void Model::declare(StateLayout& layout) const {
  layout.add_reals("position", system().view.dofs);
  layout.add_reals("velocity", system().view.dofs);
  layout.add_reals("integrals", system().view.rates);
  layout.add_integers("origin_cells", 3);
  layout.add_integers("whole_turns", bodies().size());
  if (has_rotors()) layout.add_reals("orientations", 4 * assembly_.rotor_count());
  assembly_.declare_controls(layout);
}

void Model::attach(RunState& state) {
  SystemView<double>& view = system().view;
  view.position = state.reals("position");
  view.velocity = state.reals("velocity");
  view.integrals = state.reals("integrals");
  cells_ = state.integers("origin_cells");
  whole_turns_ = state.integers("whole_turns");
  if (has_rotors()) orientations_ = state.reals("orientations");
  for (int d = 0; d < 3; ++d) origin_.cells[d] = cells_[d];
  place_origin();
  orient();
  assembly_.attach_controls(state);
  assembly_.rebase(origin_);
  if (follower_) follower_->rebase(origin_);
}

void Model::start(const Perturbation* noise, const FinalState* from) {
  const SystemView<double>& view = system().view;
  if (from != nullptr) require_same_parts(*from);
  for (int d = 0; d < dimension(); ++d) {
    cells_[d] = from == nullptr ? plan_.origin.cells[d] : cells_near(*from, origin_, d);
    origin_.cells[d] = cells_[d];
  }
  place_origin();
  double* orientation = orientations_;
  std::size_t rotor = 0;
  for (const Body& body : bodies()) {
    if (!body.rotor) continue;
    const Quaternion axes = from == nullptr
                                ? body.orientation
                                : product(from->rotors[rotor++].rotation, body.orientation);
    orientation = std::copy(axes.begin(), axes.end(), orientation);
  }
  orient();
  assembly_.rebase(origin_);
  assembly_.start(view.position, view.velocity, view.integrals, noise, from);
  assembly_.start_controls();
  if (follower_) {
    follower_->rebase(origin_);
    follower_->start(noise, from);
  }
  if (view.inertial) return;
  evaluate_at(DoubleDouble(0.0), view.position, view.velocity, view.integrals, rates_.data());
  drift_velocity(view.velocity);
}

/// Describes coordinates and internal variables, in their order.
std::vector<std::string> Model::structure() const {
  std::vector<std::string> parts = {fmt::format("{} dimensions", dimension())};
  for (const Body& body : bodies()) {
    parts.push_back(fmt::format("body {}: {} particles, {}{}", body.bound.name,
                                body.bound.slot.count, to_string(body.bound.coordinates),
                                body.rotor ? ", rotating in space" : ""));
  }
  parts.push_back(
      fmt::format("{} numbers of prescribed motions", assembly_.prescribed().own_count()));
  for (const Force& force : forces()) {
    const std::size_t count = force.variables->own_count();
    if (count == 0) continue;
    parts.push_back(fmt::format("force {}: {} internal variables", force.name, count));
  }
  return parts;
}

void Model::require_same_parts(const FinalState& from) const {
  const auto refuse = [this](const std::string& key, std::string why) {
    throw InputError({Fault(FaultCode::component_unsuitable, {scene_->file}, key, "",
                            "cannot start where another run has ended: " + std::move(why))});
  };
  const std::vector<std::string> own = structure();
  for (std::size_t k = 0; k < std::max(own.size(), from.structure.size()); ++k) {
    const std::string mine = k < own.size() ? own[k] : "nothing more";
    const std::string other = k < from.structure.size() ? from.structure[k] : "nothing more";
    if (mine != other) refuse("", fmt::format("that had {}, and this has {}", other, mine));
  }
  for (const Force& force : forces()) {
    if (force.switched != nullptr) {
      refuse("force." + force.name + ".active", "its times count from the start of the run");
    }
    if (force.drive() == nullptr || !force.bound->depends_on_time()) continue;
    if (force.pulled_end != nullptr) continue;
    refuse("force." + force.name, "this driver follows from the time, which counts from 0 again");
  }
}

double Model::next_switch() const {
  double next = std::numeric_limits<double>::infinity();
  for (const Force& force : forces()) {
    if (force.switched != nullptr) next = std::min(next, force.switched->next_switch());
  }
  return next;
}

std::vector<std::string> Model::switch_forces(const DoubleDouble& time, double latest) {
  std::vector<std::string> names;
  for (const Force& force : forces()) {
    if (force.switched == nullptr || !(force.switched->next_switch() <= latest)) continue;
    const double before = energy_of(force, time);
    force.switched->switch_over();
    if (force.switched->is_active()) set_out(force, time);
    force.switched->shift_energy(before - energy_of(force, time));
    names.push_back(force.name);
  }
  return names;
}

double Model::energy_of(const Force& force, const DoubleDouble& time) {
  const SystemView<double>& view = system().view;
  evaluate_at(time, view.position, view.velocity, view.integrals, rates_.data());
  const DoubleDouble anchored = anchor_;
  anchor(time);
  const double energy =
      force.energy(stage(view.position, view.velocity, view.integrals, rates_.data()));
  anchor(anchored);
  return energy;
}

/// The support of a driver that has become active moves from here on: from where the spring has
/// no force, unless its position is given.
void Model::set_out(const Force& force, const DoubleDouble& time) {
  PulledEnd* const end = force.pulled_end;
  if (end == nullptr || force.first_rate == kNoRate) return;
  const auto axes = static_cast<std::size_t>(dimension());
  std::vector<DoubleDouble> travel(axes);
  end->set_out(time, travel);
  if (!end->starts_at_point()) return;
  const SystemView<double>& view = system().view;
  // The second time takes away what rounding has left.
  for (int k = 0; k < 2; ++k) {
    evaluate_at(time, view.position, view.velocity, view.integrals, rates_.data());
    for (std::size_t d = 0; d < axes; ++d) {
      const double stiffness = force.drive()->stiffness_on(static_cast<int>(d));
      if (!(stiffness > 0.0)) continue;
      const double pull = rates_[static_cast<std::size_t>(force.first_rate) + d];
      travel[d] = travel[d] - DoubleDouble(pull / stiffness);
    }
    end->set_out(time, travel);
  }
}

FinalState Model::final_state(const DoubleDouble& time) const {
  FinalState state;
  state.structure = structure();
  state.origin = origin_;
  const double* orientation = orientations_;
  for (const Body& body : bodies()) {
    if (!body.rotor) continue;
    const std::size_t at = body.bound.slot.centre + 3;
    const double* p = system().view.position + at;
    const double* u = system().view.velocity + at;
    Quaternion anchor;
    std::copy_n(orientation, anchor.size(), anchor.begin());
    orientation += anchor.size();
    const Quaternion axes = rotated_by(anchor, {p[0], p[1], p[2]});
    const Vec<double, 3> w = angular_velocity<double>({{p[0], p[1], p[2]}}, {{u[0], u[1], u[2]}});
    FinalState::Rotor& rotor = state.rotors.emplace_back();
    rotor.rotation = product(axes, inverse(body.orientation));
    const Matrix3 m = matrix_of(axes);
    for (std::size_t d = 0; d < 3; ++d) {
      rotor.spin[d] = m[3 * d] * w[0] + m[3 * d + 1] * w[1] + m[3 * d + 2] * w[2];
    }
  }
  assembly_.write_numbers(state);
  if (follower_) follower_->write_numbers(state);
  assembly_.write_supports(time, state);
  return state;
}

void Model::drift_velocity(double* velocity) const {
  const SystemView<double>& view = system().view;
  for (std::size_t i = 0; i < view.dofs; ++i) velocity[i] = view.force[i] * view.inverse_mass[i];
}

void Model::orient() {
  for (std::size_t k = 0; k < assembly_.rotor_count(); ++k) {
    Quaternion orientation;
    std::copy_n(orientations_ + 4 * k, orientation.size(), orientation.begin());
    assembly_.orient(k, orientation);
  }
}

bool Model::reorient_if_needed() {
  /// In rad; p has no value for half a turn, and a step turns a body by a radian at most.
  constexpr double kLargestTurn = 0.25;
  bool changed = false;
  double* orientation = orientations_;
  for (const Body& body : bodies()) {
    if (!body.rotor) continue;
    double* const p = system().view.position + body.bound.slot.centre + 3;
    double* const rate = system().view.velocity + body.bound.slot.centre + 3;
    if (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] > kLargestTurn * kLargestTurn) {
      const Vec<double, 3> spin =
          angular_velocity<double>({{p[0], p[1], p[2]}}, {{rate[0], rate[1], rate[2]}});
      Quaternion from;
      std::copy_n(orientation, from.size(), from.begin());
      const Quaternion to = rotated_by(from, {p[0], p[1], p[2]});
      std::copy(to.begin(), to.end(), orientation);
      for (int k = 0; k < 3; ++k) {
        p[k] = 0.0;
        rate[k] = spin[k];
      }
      changed = true;
    }
    orientation += 4;
  }
  if (changed) orient();
  return changed;
}

bool Model::rebase_if_needed() {
  bool rebased = false;
  SystemView<double>& view = system().view;
  std::array<std::int64_t, 3> moved_cells{};
  for (const Body& body : bodies()) {
    // Rotation has cells of its own: whole turns.
    const BodySlot<double>& slot = body.bound.slot;
    if (!slot.rigid || dimension() != 2) continue;
    double& turns = view.position[slot.centre + kRotation];
    if (turns >= 1.0 || turns <= -1.0) {
      const double whole = std::trunc(turns);
      turns -= whole;
      whole_turns_[body.bound.index] += static_cast<std::int64_t>(whole);
      rebased = true;
    }
  }
  for (int d = 0; d < dimension(); ++d) {
    const double unit = origin_.unit[d];
    if (unit == 0.0) continue;
    // Whole cells by which everything has moved forward.
    double least = std::numeric_limits<double>::max();
    double most = -least;
    const auto moved = [&](double by) {
      least = std::min(least, by);
      most = std::max(most, by);
      return least >= unit || most <= -unit;
    };
    bool all = true;
    for (const Driver& driver : drivers()) {
      if (driver.drive == nullptr || driver.drive->travel.empty() || !driver.drive->steady)
        continue;
      all = all && moved(driver.drive->travel[d]);
    }
    for (const Body& body : bodies()) {
      if (!all) break;
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.rigid) {
        all = moved(view.position[slot.centre + d] - body.bound.start_centre[d]);
      } else if (body.prescribed()) {
        all = moved(assembly_.prescribed().travel_of(body, d, view.integrals));
      } else {
        const double* x =
            (slot.mapped ? view.mapped_position : view.position) + slot.offset + d * slot.stride;
        for (std::size_t i = 0; all && i < slot.count; ++i)
          all = moved(x[i] - body.bound.start[i][d]);
      }
    }
    if (!all || !(least >= unit || most <= -unit)) continue;
    const double cells = std::trunc((least >= unit ? least : most) / unit);
    const double shift = cells * unit;
    for (const Body& body : bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.rigid) {
        view.position[slot.centre + d] -= shift;
      } else if (!slot.mapped) {
        double* x = view.position + slot.offset + d * slot.stride;
        for (std::size_t i = 0; i < slot.count; ++i) x[i] -= shift;
      }
    }
    for (const auto& steered : assembly_.prescribed().steered()) {
      if (steered.own[d] >= 0) view.integrals[steered.own[d]] -= shift;
    }
    cells_[d] += static_cast<std::int64_t>(cells);
    origin_.cells[d] = cells_[d];
    moved_cells[d] = static_cast<std::int64_t>(cells);
    rebased = true;
  }
  if (!rebased) return false;
  ++rebases_;
  place_origin();
  assembly_.rebase(origin_);
  if (follower_) {
    follower_->rebase(origin_);
    follower_->shift_by(moved_cells);
  }
  begin_step(this, anchor_.hi, anchor_.lo);
  return true;
}

}  // namespace tomlin
