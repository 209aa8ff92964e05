#include "framework/run/guard/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/model/scheme_checks.hpp"

namespace tomlin {
namespace {

/// The coordinate that would move furthest for its limit in a step of h, or the first that would
/// not be a finite number.
std::size_t worst_coordinate(Model& model, double h) {
  const SystemView<double>& s = model.system().view;
  std::size_t worst = 0;
  double furthest = -1.0;
  for (std::size_t i = 0; i < s.dofs; ++i) {
    if (s.inverse_mass[i] == 0.0) continue;
    const double response = s.force[i] * s.inverse_mass[i];  // acceleration, or velocity
    const double move = s.inertial ? h * std::abs(s.velocity[i]) + 0.5 * h * h * std::abs(response)
                                   : h * std::abs(response);
    if (!std::isfinite(move)) return i;
    const double limit =
        s.largest_move[i] < kNoBound ? s.largest_move[i] : 1.0 / s.tolerance_scale[i];
    if (move / limit > furthest) {
      furthest = move / limit;
      worst = i;
    }
  }
  return worst;
}

/// The force whose part at the coordinate is largest, or no number.
std::string strongest_force(Model& model, std::size_t coordinate) {
  SystemView<double>& s = model.system().view;
  const Model::CoordinateName name = model.name_of(coordinate);
  std::string strongest;
  double most = -1.0;
  AlignedVector<double> rates(s.rates + 2 * kGroup, 0.0);
  Stage<double> stage = stage_of(s, s.position, s.velocity, s.integrals, rates.data(), 0.0);
  for (const Model::Force& force : model.forces()) {
    double part = 0.0;
    for (const Pass<double>& pass : force.own_passes()) {
      for (const Region& region : pass.writes) {
        const BodySlot<double>& slot = model.bodies()[region.body].bound.slot;
        if (model.bodies()[region.body].bound.name != name.body) continue;
        double* f = slot.mapped && !region.centre ? stage.mapped_force : stage.force;
        const std::size_t first = region.centre ? slot.centre : slot.offset;
        const std::size_t length = region.centre ? kGroup : slot.stride * model.dimension();
        for (std::size_t i = 0; i < length; ++i) f[first + i] = 0.0;
        pass.add(pass.arguments, stage);
        if (slot.mapped) {
          for (std::size_t i = 0; i < length; ++i) {
            const double size = std::abs(f[first + i]);
            if (!(size <= part)) part = size;
          }
        } else {
          const double size = std::abs(f[coordinate]);
          if (!(size <= part)) part = size;
        }
      }
    }
    if (std::isnan(part)) return force.name;
    if (part > most) {
      most = part;
      strongest = force.name;
    }
  }
  return strongest;
}

/// A force and what it says about having no finite value.
struct NotFinite {
  std::string force;
  std::string why;
};

/// The force that has no finite value here, or on the straight way of a step from here; empty where
/// none says so.
NotFinite not_finite(Model& model, const DoubleDouble& time, double h) {
  SystemView<double>& s = model.system().view;
  AlignedVector<double> rates(s.rates + 2 * kGroup, 0.0);
  AlignedVector<double> position(s.position, s.position + s.dofs);
  position.resize(s.dofs + 2 * kGroup, 0.0);
  NotFinite found;
  for (const double part : {0.0, 0.5, 1.0}) {
    const DoubleDouble then = time + DoubleDouble(part * h);
    model.anchor(then);  // where formulas count their time from; nothing goes on after a failure
    for (std::size_t i = 0; i < s.dofs; ++i) position[i] = s.position[i] + part * h * s.velocity[i];
    model.evaluate_at(then, position.data(), s.velocity, s.integrals, rates.data());
    const Stage<double> stage =
        stage_of(s, position.data(), s.velocity, s.integrals, rates.data(), 0.0);
    for (const Model::Force& force : model.forces()) {
      if (!found.why.empty() || !force.is_active()) continue;
      found = {force.name, force.diagnosis->why_not_finite(stage)};
    }
    if (!found.why.empty()) break;
  }
  model.evaluate_at(time, s.position, s.velocity, s.integrals, rates.data());
  return found;
}

/// Whether two particles of a body coincide, or meet within a step of h on their way.
bool particles_meet(const Model& model, const SystemView<double>& s, const std::string& name,
                    double h) {
  constexpr std::size_t kMostParticles = 500;  // a message is not worth more than this squared
  constexpr double kClosestPart = 1e-6;        // of the distance
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (body.bound.name != name || slot.mapped || slot.count > kMostParticles) continue;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t j = i + 1; j < slot.count; ++j) {
        double apart[3] = {};
        double closing[3] = {};
        double square = 0.0;
        double along = 0.0;
        double speed = 0.0;
        for (int d = 0; d < model.dimension(); ++d) {
          const double* x = s.position + slot.offset + d * slot.stride;
          const double* v = s.velocity + slot.offset + d * slot.stride;
          apart[d] = x[j] - x[i];
          closing[d] = v[j] - v[i];
          square += apart[d] * apart[d];
          along -= apart[d] * closing[d];
          speed += closing[d] * closing[d];
        }
        if (square == 0.0) return true;
        // On a line particles pass through each other: a bond has a direction on either side.
        if (model.dimension() == 1 || !(along > 0.0)) continue;
        const double meeting = std::min(along / speed, h);
        double closest = 0.0;
        for (int d = 0; d < model.dimension(); ++d) {
          const double left = apart[d] + meeting * closing[d];
          closest += left * left;
        }
        if (closest <= kClosestPart * kClosestPart * square) return true;
      }
    }
  }
  return false;
}

/// " of a particle of species C"; empty where there is no such particle, or it has none.
std::string of_species(const Model& model, const Model::CoordinateName& name) {
  for (const Model::Body& body : model.bodies()) {
    const BoundBody<double>& bound = body.bound;
    if (bound.name != name.body || name.particle < 0 || bound.species.empty()) continue;
    const auto index = static_cast<std::size_t>(bound.species[name.particle]);
    return " of a particle of species " + bound.species_names[index];
  }
  return "";
}

/// A thermostat whose flow over half a step has no finite value: the body is much too hot for it.
const Model::Force* failing_thermostat(const Model& model, double h) {
  const SystemView<double>& s = model.system().view;
  for (const Model::Force& force : model.forces()) {
    Flow<double> flow;
    if (!force.record->thermostat || force.traits.stochastic || !force.flow(flow)) continue;
    AlignedVector<double> velocity(s.velocity, s.velocity + s.dofs);
    AlignedVector<double> own(s.integrals, s.integrals + s.own);
    FlowStage<double> stage;
    stage.position = s.position;
    stage.inverse_mass = s.inverse_mass;
    stage.velocity = velocity.data();
    stage.own = own.data();
    flow.run(flow.arguments, stage, 0.5 * h);
    if (!std::all_of(velocity.begin(), velocity.end(), [](double v) { return std::isfinite(v); }))
      return &force;
  }
  return nullptr;
}

FaultCode code_of(StepFault fault) {
  switch (fault) {
    case StepFault::too_many_steps:
      return FaultCode::run_step_limit;
    case StepFault::no_equilibrium:
      return FaultCode::run_no_equilibrium;
    case StepFault::step_too_small:
      return FaultCode::run_step_too_small;
    case StepFault::none:
    case StepFault::not_finite_or_too_far:
      break;
  }
  return FaultCode::run_step_unstable;
}

/// Name of a prescribed body whose motion has no finite value at one of these times, or halfway.
std::optional<std::string> body_without_velocity(const Model& model, double from, double to) {
  for (const Model::Body& body : model.bodies()) {
    if (!body.prescribed()) continue;
    for (const double at : {from, from + 0.5 * (to - from), to}) {
      bool finite = std::isfinite(body.motion->angular_velocity(at));
      for (const TimeFunction& function : body.motion->velocity) {
        finite = finite && std::isfinite(function(at));
      }
      if (!finite) return body.bound.name;
    }
  }
  return std::nullopt;
}

}  // namespace

RunFailure diagnose(Model& model, const IntegratorRecord& scheme, StepFault fault,
                    std::uint64_t step, const DoubleDouble& time, double h, double stable_step) {
  SystemView<double>& s = model.system().view;
  RunFailure failure;
  failure.step = step;
  failure.time = static_cast<double>(time);
  failure.code = code_of(fault);
  const auto because = [&failure](std::string what, std::string cause) {
    failure.what = std::move(what);
    failure.cause = std::move(cause);
    return failure;
  };
  AlignedVector<double> rates(s.rates + 2 * kGroup, 0.0);
  if (const auto body = body_without_velocity(model, failure.time, failure.time + h)) {
    failure.code = FaultCode::expression_not_finite;
    failure.body = *body;
    return because(
        "its prescribed motion has no finite value",
        "an expression in motion has no value there: it is evaluated outside of the range in which "
        "it is defined");
  }
  model.evaluate_at(time, s.position, s.velocity, s.integrals, rates.data());
  if (s.coordinates == 0) {
    return because(
        "a variable that is not a coordinate left the finite numbers, or cannot be kept "
        "to the tolerance",
        "a force law was evaluated outside of the range in which it is defined, or a motion jumps");
  }
  if (fault == StepFault::not_finite_or_too_far) {
    if (const Model::Force* thermostat = failing_thermostat(model, h)) {
      failure.body = model.bodies()[thermostat->bodies.front()].bound.name;
      failure.force = thermostat->name;
      return because(
          "the velocities of the body would not be finite numbers",
          "the kinetic energy is too far from the temperature for this thermostat: the speed "
          "diverges, or the body starts much too hot");
    }
  }
  const std::size_t worst = worst_coordinate(model, h);
  const Model::CoordinateName name = model.name_of(worst);
  const double acceleration = s.force[worst] * s.inverse_mass[worst];
  failure.body = name.body;
  failure.particle = name.particle;
  failure.axis = name.axis;
  failure.force = strongest_force(model, worst);
  const bool finite = std::isfinite(acceleration);

  switch (fault) {
    case StepFault::none:
      break;
    case StepFault::too_many_steps:
      return because("the integrator has taken most_steps steps",
                     "the scene is stiffer, or the run longer, than most_steps allows for");
    case StepFault::no_equilibrium:
      if (scheme.splits_bonds) {
        failure.code = FaultCode::integrator_unsuitable;
        return because(
            "the body has left the shape that " + scheme.name + " takes its bonds at",
            fmt::format("its bonds are soft, loose or too far from rest for a step of {:g}: take a "
                        "much smaller dt, or another scheme: {}",
                        h, integrators_with_bonds_as_forces(model.scene())));
      }
      return because(
          "no stable equilibrium was found from here on",
          "the scene is unconstrained against its forces: it slides away or slips indefinitely");
    case StepFault::step_too_small:
      return because("the step needed is below smallest_step",
                     "tolerances below what rounding allows, or a force that is not smooth");
    case StepFault::not_finite_or_too_far:
      failure.what =
          finite ? fmt::format(
                       "a coordinate{} would move further in one step than is "
                       "allowed (a period, half the shortest bond or size, or half a radian "
                       "of a body in space), "
                       "or become non-finite",
                       of_species(model, name))
                 : fmt::format("an acceleration{} is not a finite number", of_species(model, name));
      break;
  }
  NotFinite found = not_finite(model, time, h);
  if (!found.why.empty()) failure.force = found.force;
  if (!scheme.adaptive && h > stable_step) {
    failure.cause =
        fmt::format("the step of {:g} is beyond the stability limit of {}, about {:.3g} here", h,
                    scheme.name, stable_step);
  } else if (particles_meet(model, s, name.body, h)) {
    failure.cause = "two particles of the body coincide, and a bond has no direction there";
  } else if (!found.why.empty()) {
    failure.cause = std::move(found.why);
  } else if (!finite) {
    failure.cause =
        "a force law was evaluated outside of the range in which it is defined, or its numbers "
        "overflow";
  } else if (scheme.adaptive) {
    failure.cause =
        "every step down to smallest_step failed: the scene's forces are too strong, its lengths "
        "too short, or the tolerances too fine";
  } else {
    failure.cause = fmt::format(
        "the speed diverges: a step of {:g} is too long for it, or the "
        "scene's forces are too strong",
        h);
  }
  return failure;
}

}  // namespace tomlin
