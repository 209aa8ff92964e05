#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/numbers/angle.hpp"
#include "framework/core/numbers/rotation_vector.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/model/model.hpp"

/// Numbers that can be read off a bound model at a given state.
namespace tomlin {
Stage<double> Model::stage(const double* position, const double* velocity, const double* integrals,
                           double* rates) const {
  return stage_of(system().view, position, velocity, integrals, rates, 0.0);
}

void Model::evaluate_at(const DoubleDouble& time, const double* position, const double* velocity,
                        const double* integrals, double* rates) {
  const DoubleDouble anchored = anchor_;
  anchor(time);
  const SystemView<double>& view = system().view;
  if (view.point_force_count > 0) {
    evaluate_point(*position, *velocity, 0.0, rates);
  } else {
    const Stage<double> here = stage(position, velocity, integrals, rates);
    for (std::size_t k = 0; k < view.operation_count; ++k) {
      view.operations[k].run(view.operations[k].arguments, here);
    }
  }
  anchor(anchored);
}

void Model::evaluate_point(double position, double velocity, double elapsed, double* rates) const {
  const SystemView<double>& view = system().view;
  double total = 0.0;
  for (std::size_t k = 0; k < view.point_force_count; ++k) {
    const PointForce<double>& force = view.point_forces[k];
    const PointResult<double> part =
        force.run(force.parameters, position, velocity, force.start, elapsed);
    total = k == 0 ? part.force : total + part.force;
    if (force.rate == kNoRate) continue;
    rates[force.rate] = part.force;
    rates[force.rate + 1] = part.power;
  }
  view.force[0] = total;
}

void Model::centre(std::size_t b, const double* position, double* result) const {
  const BodySlot<double>& slot = bodies()[b].bound.slot;
  if (slot.rigid) {
    std::copy(position + slot.centre, position + slot.centre + dimension(), result);
    return;
  }
  observe_.mean(slot, slot.mapped ? system().view.mapped_position : position, dimension(), result);
}

void Model::centre_velocity(std::size_t b, const double* velocity, double* result) const {
  const Body& body = bodies()[b];
  const BodySlot<double>& slot = body.bound.slot;
  if (slot.rigid) {
    std::copy(velocity + slot.centre, velocity + slot.centre + dimension(), result);
  } else if (body.prescribed()) {
    for (int d = 0; d < dimension(); ++d) result[d] = assembly_.prescribed().speed_of(body, d);
  } else if (slot.mapped) {
    std::fill(result, result + dimension(), 0.0);
  } else {
    observe_.mean(slot, velocity, dimension(), result);
  }
}

double* Model::place_particles(std::size_t b, const double* position, double* result) const {
  const BodySlot<double>& slot = bodies()[b].bound.slot;
  const double* from = (slot.mapped ? system().view.mapped_position : position) + slot.offset;
  const int axes = dimension();
  for (int d = 0; d < axes; ++d) {
    const DoubleDouble origin = placed(d, 0.0);
    const double* offset = from + d * slot.stride;
    for (std::size_t i = 0; i < slot.count; ++i) {
      result[i * axes + d] = static_cast<double>(origin + offset[i]);
    }
  }
  return result + slot.count * axes;
}

double Model::rotation(std::size_t b, const double* position) const {
  const Body& body = bodies()[b];
  const BodySlot<double>& slot = body.bound.slot;
  if (body.prescribed()) return assembly_.prescribed().turns_of(body);
  if (slot.rigid && dimension() == 2) {
    return static_cast<double>(whole_turns_[b]) + position[slot.centre + kRotation];
  }
  if (body.rotor && body.turns_in_space) return rotation_of_rotor(body, position);
  if (slot.mapped || !body.rotates()) return 0.0;
  const AlignedVector<double>& shape = shapes_[b];
  const std::size_t length = shape.size() / 3;
  return observe_.rotation(slot,
                           {shape.data(), shape.data() + length, shape.data() + 2 * length,
                            body.plane[0], body.plane[1]},
                           position);
}

/// The best fit of a rotation in the plane to the particles, weighted by their masses: with their
/// second moments D along the principal axes, sum m r x^T = A D R^T for start A and present R.
double Model::rotation_of_rotor(const Body& body, const double* position) const {
  const double* orientation = orientations_;
  for (const Body& other : bodies()) {
    if (&other == &body) break;
    if (other.rotor) orientation += 4;
  }
  const double* p = position + body.bound.slot.centre + 3;
  const Matrix3 start = matrix_of(body.orientation);
  const Matrix3 anchor =
      matrix_of({orientation[0], orientation[1], orientation[2], orientation[3]});
  Matrix3 now;
  rotate_axes<double>(anchor.data(), {{p[0], p[1], p[2]}}, now.data());
  const auto [x, y, z] = body.moments;
  const std::array<double, 3> second = {0.5 * (y + z - x), 0.5 * (z + x - y), 0.5 * (x + y - z)};
  const auto moment = [&](int a, int b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      sum += start[3 * static_cast<std::size_t>(a) + k] * second[k] *
             now[3 * static_cast<std::size_t>(b) + k];
    }
    return sum;
  };
  const auto [a, b] = body.plane;
  return angle_turns(moment(a, b) - moment(b, a), moment(a, a) + moment(b, b));
}

double Model::kinetic_energy(const double* position, const double* velocity) const {
  InterleavedSum<double> total;
  if (!system().view.inertial || plan_.quasistatic) return 0.0;
  for (std::size_t i = 0; i < system().view.dofs; ++i) {
    const double inverse_mass = system().view.inverse_mass[i];
    if (inverse_mass > 0.0) total.add(i, 0.5 * velocity[i] * velocity[i] / inverse_mass);
  }
  double energy = total.total();
  for (const Body& body : bodies()) {
    if (!body.rotor) continue;
    const std::size_t at = body.bound.slot.centre + 3;
    const double* p = position + at;
    const double* u = velocity + at;
    const Vec<double, 3> spin =
        angular_velocity<double>({{p[0], p[1], p[2]}}, {{u[0], u[1], u[2]}});
    for (int k = 0; k < 3; ++k) {
      const double inverse_mass = system().view.inverse_mass[at + static_cast<std::size_t>(k)];
      if (!(inverse_mass > 0.0)) continue;
      const double moment = body.moments[static_cast<std::size_t>(k)];
      energy += 0.5 * (moment * spin[k] * spin[k] - u[k] * u[k] / inverse_mass);
    }
  }
  return energy;
}

double Model::potential_energy(const DoubleDouble& time, const double* position,
                               const double* velocity, const double* integrals) {
  // Rigid bodies place their particles in an evaluation.
  evaluate_at(time, position, velocity, integrals, rates_.data());
  const DoubleDouble anchored = anchor_;
  anchor(time);
  const Stage<double> here = stage(position, velocity, integrals, rates_.data());
  double total = 0.0;
  for (const Force& force : forces()) total += force.energy(here);
  anchor(anchored);
  return total;
}

DoubleDouble Model::pulled_end(std::size_t driver, const DoubleDouble& time, int axis) const {
  const Drive& drive = *drivers()[driver].drive;
  const auto since = static_cast<double>(time - anchor_);
  return placed(axis,
                drive.start[axis] + std::fma(drive.velocity[axis], since, drive.travel[axis]));
}

Model::CoordinateName Model::name_of(std::size_t coordinate) const {
  for (const Body& body : bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.rigid && coordinate >= slot.centre && coordinate < slot.centre + kGroup) {
      const std::size_t d = coordinate - slot.centre;
      if (d > 2)
        return {body.bound.name, -1, fmt::format("rotation about principal axis {}", d - 2)};
      return {body.bound.name, -1, d == 2 && dimension() == 2 ? "rotation" : kAxisNames[d]};
    }
    if (!slot.mapped && coordinate >= slot.offset &&
        coordinate < slot.offset + slot.stride * dimension()) {
      const std::size_t within = coordinate - slot.offset;
      return {body.bound.name, static_cast<std::ptrdiff_t>(within % slot.stride),
              kAxisNames[within / slot.stride]};
    }
  }
  return {};
}

}  // namespace tomlin
