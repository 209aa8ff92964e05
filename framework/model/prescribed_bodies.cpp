#include "framework/model/prescribed_bodies.hpp"

#include <cmath>
#include <utility>

#include "framework/core/numbers/math.hpp"
#include "framework/scene/motion_slope.hpp"

namespace tomlin {

template <class Real>
PrescribedBodies<Real>::PrescribedBodies(const AssemblyPlan& plan, AssembledBodies<Real>& bodies)
    : first_origin_(plan.origin) {
  for (AssembledBody<Real>& body : bodies.all) {
    if (!body.prescribed()) continue;
    body.steering = steering_.size();
    Steering& steering = steering_.emplace_back();
    steering.motion = body.motion;
    steering.axes = plan.dimension();
    steering.planar = plan.dimension() == 2;
    Steered& steered = steered_.emplace_back();
    steered.body = body.bound.index;
    for (int d = 0; d < steering.axes; ++d) steering.start[d] = Real(body.bound.start_centre[d]);
    for (int k = 0; k < 4; ++k) {
      if (!steering.has(k)) continue;
      const TimeFunction& function = steering.function(k);
      if (function.is_constant()) {
        steering.speed[k] = Real(function.constant) / (k < 3 ? Real(1.0) : tau<Real>());
      } else {
        steered.own[k] = steering.own[k] = static_cast<std::ptrdiff_t>(own_count_++);
      }
    }
  }
}

template <class Real>
void PrescribedBodies<Real>::assign_rates(const AssemblyPlan& plan, AssembledBodies<Real>& bodies,
                                          std::size_t& rates,
                                          std::vector<AssembledDriver>& drivers) {
  for (std::size_t k = 0; k < bodies.rigid.size(); ++k) {
    const AssembledBody<Real>& body = bodies.all[bodies.rigid_body[k]];
    if (!body.prescribed()) continue;
    RigidArguments<Real>& arguments = bodies.rigid[k];
    Steering& steering = steering_[body.steering];
    arguments.coordinates = steering.coordinates;
    arguments.speeds = steering.speeds;
    arguments.velocities = true;
    arguments.rate = static_cast<std::ptrdiff_t>(rates);
    rates += plan.dimension() + 1;
    if (plan.inertial && !plan.quasistatic && accelerates(*body.motion)) {
      rates += plan.dimension() + 1;
      inertia_.push_back({body.bound.index, body.motion, &steering.anchor, body.total_mass,
                          body.inertia, arguments.rate});
    }
    Drive& drive = drives_.emplace_back();
    drive.start = body.bound.start_centre;
    drive.travel.assign(plan.dimension(), 0.0);
    for (const TimeFunction& function : body.motion->velocity) {
      drive.steady = drive.steady && function.is_constant();
      drive.velocity.push_back(function.constant);
    }
    drivers.push_back({body.bound.name, arguments.rate, &drive});
  }
}

template <class Real>
void PrescribedBodies<Real>::add_steering(std::vector<Operation<Real>>& operations) const {
  for (const Steering& steering : steering_) operations.push_back({&steer, &steering});
}

template <class Real>
void PrescribedBodies<Real>::add_inertia(std::size_t body,
                                         std::vector<Operation<Real>>& operations) const {
  for (const Inertia& inertia : inertia_) {
    if (inertia.body == body) operations.push_back({&accelerate, &inertia});
  }
}

template <class Real>
void PrescribedBodies<Real>::steer(const void* arguments, const Stage<Real>& stage) {
  // The scratch in it belongs to this evaluation.
  auto& a = *const_cast<Steering*>(static_cast<const Steering*>(arguments));
  const double now = static_cast<double>(a.anchor) + static_cast<double>(stage.elapsed);
  const auto follow = [&](int k, Real& way, Real& speed) {
    if (a.own[k] < 0) {
      speed = a.speed[k];
      way = fma(speed, stage.elapsed, a.travel[k]);
      return;
    }
    speed = Real(a.function(k)(now)) / (k < 3 ? Real(1.0) : tau<Real>());
    stage.rates[a.own[k]] = speed;
    way = stage.own[a.own[k]];
  };
  for (int d = 0; d < a.axes; ++d) {
    Real way;
    follow(d, way, a.speeds[d]);
    a.coordinates[d] = a.start[d] + way;
  }
  if (a.planar) follow(3, a.coordinates[kRotation], a.speeds[kRotation]);
}

template <class Real>
void PrescribedBodies<Real>::accelerate(const void* arguments, const Stage<Real>& stage) {
  const auto& a = *static_cast<const Inertia*>(arguments);
  const double now = static_cast<double>(*a.anchor) + static_cast<double>(stage.elapsed);
  // The force counts as zero where a velocity jumps or its slope has no bound.
  const auto slope = [now](const TimeFunction& function) {
    const double value = slope_of(function, now);
    return std::isfinite(value) ? value : 0.0;
  };
  const auto axes = static_cast<std::ptrdiff_t>(a.motion->velocity.size());
  Real* total = stage.rates + a.rate;
  Real* apart = total + axes + 1;
  const TimeFunction& spin = a.motion->angular_velocity;
  double power = 0.0;
  if (!spin.is_constant()) power = a.inertia * slope(spin) * spin(now);
  for (std::ptrdiff_t d = 0; d < axes; ++d) {
    const TimeFunction& velocity = a.motion->velocity[d];
    const double force = velocity.is_constant() ? 0.0 : a.mass * slope(velocity);
    if (force != 0.0) power = std::fma(force, velocity(now), power);
    apart[d] = Real(force);
    total[d] = total[d] + apart[d];
  }
  apart[axes] = Real(power);
  total[axes] = total[axes] + apart[axes];
}

template <class Real>
void PrescribedBodies<Real>::begin_step(const DoubleDouble& time, const Origin& origin) {
  for (std::size_t k = 0; k < steering_.size(); ++k) {
    Steering& steering = steering_[k];
    steering.anchor = time;
    for (int d = 0; d < 4; ++d) {
      if (!steering.has(d) || steering.own[d] >= 0) continue;
      if (d == 3) {
        steering.travel[d] = from_double_double<Real>(steering.travelled(d, time)) / tau<Real>();
        continue;
      }
      const double moved = static_cast<double>(origin.cells[d] - first_origin_.cells[d]);
      const DoubleDouble travel =
          steering.travelled(d, time) - DoubleDouble(moved) * origin.unit[d];
      steering.travel[d] = from_double_double<Real>(travel);
      drives_[k].travel[d] = static_cast<double>(travel);
    }
  }
}

template <class Real>
std::vector<Quad> PrescribedBodies<Real>::position_of(const AssembledBody<Real>& body,
                                                      const DoubleDouble& time,
                                                      const Origin& origin,
                                                      const std::vector<Quad>& own) const {
  const Steering& steering = steering_[body.steering];
  std::vector<Quad> position;
  for (int d = 0; d < steering.axes; ++d) {
    const Quad start = body.bound.start_centre[d];
    position.push_back(steering.own[d] < 0
                           ? absolute_position(first_origin_, d, start) +
                                 to_quad(steering.travelled(d, time))
                           : absolute_position(origin, d, start + own[steering.own[d]]));
  }
  if (steering.planar) position.push_back(to_quad(steering.travelled(3, time)));
  return position;
}

template <class Real>
void PrescribedBodies<Real>::begin_at(const AssembledBody<Real>& body,
                                      const std::vector<Quad>& position, const Origin& origin,
                                      Real* own) {
  Steering& steering = steering_[body.steering];
  for (int d = 0; d < steering.axes; ++d) {
    const Quad start = body.bound.start_centre[d];
    if (steering.own[d] < 0) {
      steering.began[d] =
          to_double_double(position[d] - absolute_position(first_origin_, d, start));
    } else {
      own[steering.own[d]] = static_cast<Real>(position[d] - absolute_position(origin, d, start));
    }
  }
  if (steering.planar) steering.began[3] = to_double_double(position.back());
}

template <class Real>
double PrescribedBodies<Real>::travel_of(const AssembledBody<Real>& body, int axis,
                                         const Real* integrals) const {
  const Steering& steering = steering_[body.steering];
  return static_cast<double>(steering.own[axis] >= 0 ? integrals[steering.own[axis]]
                                                     : steering.travel[axis]);
}

template <class Real>
double PrescribedBodies<Real>::turns_of(const AssembledBody<Real>& body) const {
  const Steering& steering = steering_[body.steering];
  return steering.planar ? static_cast<double>(steering.coordinates[kRotation]) : 0.0;
}

template <class Real>
double PrescribedBodies<Real>::speed_of(const AssembledBody<Real>& body, int axis) const {
  return static_cast<double>(steering_[body.steering].speeds[axis]);
}

template class PrescribedBodies<double>;
template class PrescribedBodies<Quad>;

}  // namespace tomlin
