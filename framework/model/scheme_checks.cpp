#include "framework/model/scheme_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace tomlin {
namespace {

using Force = Assembly<double>::Force;

bool is_linear_friction(const Force& force) { return force.friction->is_friction(); }

/// An operator of its own.
bool has_flow(const Force& force) {
  Flow<double> flow;
  return force.exact_flow->flow(flow);
}

bool depends_on_velocity_otherwise(const Force& force) {
  return force.traits.depends_on_velocity && !is_linear_friction(force);
}

/// One check per flag of the record; each adds a fault for every force that the scheme cannot take.
class SchemeChecks {
 public:
  explicit SchemeChecks(const Assembly<double>& assembly)
      : assembly_(assembly),
        scene_(assembly.scene()),
        scheme_(*scene_.run.integrator.record),
        any_scene_(integrators_for_any_scene(scene_)) {}

  std::vector<Fault> faults() {
    if (scene_.run.dynamics == Dynamics::overdamped && !scheme_.without_inertia) {
      refuse(FaultCode::integrator_unsuitable, "takes no dynamics without inertia",
             integrators_that(scene_, [](const IntegratorRecord& other) {
               return other.without_inertia && !other.follows_equilibria;
             }));
    }
    if (scene_.run.dynamics != Dynamics::overdamped && !scheme_.with_inertia) {
      refuse(FaultCode::integrator_unsuitable, "takes no dynamics with inertia",
             integrators_that(scene_, [](const IntegratorRecord& other) {
               return other.with_inertia && !other.follows_equilibria;
             }));
    }
    check_rotors();
    check_noise();
    check_thermostats();
    if (scheme_.splits_friction) check_split_friction();
    if (scheme_.splits_friction || scheme_.conservative_only) check_declared_drivers();
    check_operators();
    if ((scheme_.splits_friction || scheme_.conservative_only) && scene_.run.ledger) check_ledger();
    if (scheme_.conservative_only) check_loss();
    if (scene_.run.dynamics != Dynamics::inertial) check_dynamics();
    return std::move(faults_);
  }

 private:
  void refuse(FaultCode code, const std::string& why, const std::string& admissible) {
    faults_.emplace_back(code, scene_.run.integrator.location, "run.integrator.type",
                         "\"" + scheme_.name + "\"", why, admissible);
  }

  void refuse_internal_variables(const Force& force) {
    if (force.variables->own_count() == 0) return;
    refuse(FaultCode::integrator_unsuitable,
           "does not advance the variables of the force \"" + force.name + "\"", any_scene_);
  }

  /// Their coordinates of rotation have forces that depend on velocities (Euler's equations).
  void check_rotors() {
    for (const auto& body : assembly_.bodies()) {
      if (!body.rotor) continue;
      const std::string why = "the rigid body \"" + body.bound.name + "\" rotates in space, ";
      const std::string held = "hold = [\"rotation\"], or coordinates = \"particles\"";
      if (scene_.run.dynamics != Dynamics::inertial) {
        faults_.emplace_back(FaultCode::component_unsuitable, location_of("dynamics"),
                             "run.dynamics", fmt::format("\"{}\"", to_string(scene_.run.dynamics)),
                             why + "which takes inertia", "\"inertial\", or " + held);
      } else if (scheme_.splits_friction || scheme_.needs_tangent || scheme_.conservative_only) {
        refuse(FaultCode::integrator_unsuitable,
               why + "by forces that depend on its angular velocity",
               integrators_that(scene_,
                                [](const IntegratorRecord& other) {
                                  return other.with_inertia && !other.splits_friction &&
                                         !other.needs_tangent && !other.conservative_only &&
                                         !other.follows_equilibria;
                                }) +
                   "; or " + held);
      }
      if (scene_.run.number_type != NumberType::double_precision) {
        faults_.emplace_back(FaultCode::component_unsuitable, location_of("number_type"),
                             "run.number_type",
                             fmt::format("\"{}\"", to_string(scene_.run.number_type)),
                             why + "in double precision alone", "\"double\", or " + held);
      }
      return;
    }
  }

  /// Random numbers belong to the steps of a grid, and each to one operator in a step.
  void check_noise() {
    if (scene_.run.repeats > 1 && !draws_by_stream(scene_)) {
      faults_.emplace_back(FaultCode::component_unsuitable, location_of("repeats"), "run.repeats",
                           fmt::format("{}", scene_.run.repeats),
                           "the scene has no noise: all repeats would be equal",
                           "1, or a force with noise, such as langevin, or a start_temperature");
    }
    check_until_error();
    for (const Force& force : assembly_.forces()) {
      if (!force.traits.stochastic) continue;
      if (scene_.run.dynamics == Dynamics::quasistatic) {
        faults_.emplace_back(
            FaultCode::component_unsuitable, location_of("dynamics"), "run.dynamics",
            "\"quasistatic\"",
            "follows equilibria without noise, and the force \"" + force.name + "\" is stochastic",
            "\"inertial\" or \"overdamped\", or temperature = 0");
      } else if (!scheme_.takes_noise && !scene_.run.locations.contains("accuracy")) {
        const bool inertial = scene_.run.dynamics == Dynamics::inertial;
        refuse(FaultCode::integrator_unsuitable,
               "draws no random numbers, and the force \"" + force.name + "\" is stochastic",
               integrators_that(scene_, [inertial](const IntegratorRecord& other) {
                 return other.takes_noise &&
                        (inertial ? other.with_inertia : other.without_inertia);
               }));
      }
      if (scheme_.takes_noise && scheme_.splits_friction && !force.is_operator) {
        refuse(FaultCode::integrator_unsuitable,
               "has no noise of the force \"" + force.name + "\" on rigid bodies",
               "coordinates = \"particles\", or the force langevin");
      }
      for (const char* key : {"accuracy", "perturb", "until"}) {
        if (!scene_.run.locations.contains(key) ||
            (std::string_view(key) == kUntil && waits_for_error()))
          continue;
        if (std::string_view(key) == kUntil) {
          faults_.emplace_back(FaultCode::component_unsuitable, location_of(key), "run.until", "",
                               "under the noise of the force \"" + force.name +
                                   "\" means of periods never become alike",
                               "{ error = .., of = .. }, which ends when a mean is known so well");
          continue;
        }
        faults_.emplace_back(FaultCode::component_unsuitable, location_of(key),
                             std::string("run.") + key, "",
                             "compares runs that differ by little, and the force \"" + force.name +
                                 "\" is stochastic",
                             "other values of run.stream, which repeat the run with other noise");
      }
      if (scheme_.takes_noise) check_samples(force);
      return;
    }
  }

  bool waits_for_error() const { return scene_.run.until && !scene_.run.until->is_steady(); }

  void check_until_error() {
    if (!waits_for_error()) return;
    if (!has_noise(scene_)) {
      faults_.emplace_back(FaultCode::run_until_never, location_of(kUntil), "run.until", "",
                           "no force of the scene is stochastic: its means have no statistical "
                           "error",
                           "a duration, or a force with noise, such as langevin");
    }
    if (scene_.run.repeats > 1) {
      faults_.emplace_back(FaultCode::component_unsuitable, location_of("repeats"), "run.repeats",
                           fmt::format("{}", scene_.run.repeats),
                           "with run.until each repeat would end at a time of its own",
                           "1, or no run.until");
    }
  }

  /// Without noise they are operators, and nothing else.
  void check_thermostats() {
    const bool takes_no_steps = scheme_.bind.in_double == nullptr;
    for (const Force& force : assembly_.forces()) {
      if (!force.record->thermostat || takes_no_steps) continue;
      if (scene_.run.locations.contains("accuracy")) {
        faults_.emplace_back(FaultCode::component_unsuitable, location_of("accuracy"),
                             "run.accuracy", "",
                             "chooses among schemes that take no thermostat, and the force \"" +
                                 force.name + "\" is one",
                             "an integrator of fixed steps that takes operators");
      } else if (scene_.run.dynamics == Dynamics::inertial && !scheme_.splits_friction) {
        refuse(FaultCode::integrator_unsuitable,
               "does not take the operator of the force \"" + force.name + "\", a thermostat",
               integrators_that(scene_, [](const IntegratorRecord& other) {
                 return other.splits_friction && !other.splits_bonds;
               }));
      } else if (scene_.run.dynamics == Dynamics::inertial) {
        check_samples(force);
      }
      return;
    }
  }

  /// Between steps noise has no path, and what a thermostat does none that the ledger knows.
  void check_samples(const Force& force) {
    const OutputSettings& output = scene_.output;
    if (!output.every || scheme_.step == nullptr) return;
    const double dt = scheme_.step(scene_.run.integrator.description.get());
    const double steps = *output.every / dt;
    constexpr double kStepTolerance = 1e-9;
    if (std::round(steps) >= 1.0 && std::abs(steps - std::round(steps)) <= kStepTolerance * steps)
      return;
    faults_.emplace_back(
        FaultCode::component_unsuitable, output.location_of("every"), "output.every",
        fmt::format("{}", *output.every),
        fmt::format("no multiple of the step {}: the force \"{}\" is {}, and samples fall on steps",
                    dt, force.name, force.traits.stochastic ? "stochastic" : "a thermostat"),
        // The shortest decimals, not those of a product that is rounded: 0.3, not
        // 0.30000000000000004.
        fmt::format("{:.15g} or {:.15g}", std::max(1.0, std::floor(steps)) * dt,
                    (std::max(1.0, std::floor(steps)) + 1.0) * dt));
  }

  const SourceLocation& location_of(const char* key) const { return scene_.run.location_of(key); }

  void check_split_friction() {
    for (const Force& force : assembly_.forces()) {
      if (force.is_operator && has_flow(force)) continue;
      if (depends_on_velocity_otherwise(force)) {
        refuse(FaultCode::integrator_order_reduction,
               "falls to first order with the force \"" + force.name +
                   "\", which depends on velocity and is not linear friction",
               any_scene_);
      }
      refuse_internal_variables(force);
    }
  }

  /// The flow of bonds knows no others; and where a force is nothing but an operator, a scheme that
  /// takes none would leave it out.
  void check_operators() {
    const bool takes_no_steps = scheme_.bind.in_double == nullptr;
    for (const Force& force : assembly_.forces()) {
      const bool left_out = !force.is_operator && !takes_no_steps && force.bound->passes().empty();
      if (!(scheme_.splits_bonds || left_out) || !has_flow(force)) continue;
      refuse(FaultCode::integrator_unsuitable,
             "does not take the operator of the force \"" + force.name + "\"",
             integrators_that(scene_, [](const IntegratorRecord& other) {
               return other.splits_friction && !other.splits_bonds;
             }));
    }
  }

  /// A kick's forces come with velocities of half a step before, and so does F.v.
  void check_declared_drivers() {
    for (const Force& force : assembly_.forces()) {
      if (!force.driver || force.driver->stores_energy()) continue;
      refuse(FaultCode::integrator_order_reduction,
             "falls to first order in the work of the driver \"" + force.name +
                 "\", which follows from velocities",
             any_scene_);
    }
  }

  /// A kick's forces are the rates of the ledger, at a velocity of half a step before.
  void check_ledger() {
    for (const Force& force : assembly_.forces()) {
      const Traits& traits = force.traits;
      const bool has_power = traits.conservative || traits.does_work ||
                             traits.depends_on_velocity || is_linear_friction(force);
      if (has_power || force.is_operator || force.variables->own_count() > 0) continue;
      refuse(FaultCode::integrator_order_reduction,
             "falls to first order in the power of the force \"" + force.name +
                 "\", which is no gradient, and the ledger would not close",
             any_scene_ + ", or ledger = false");
    }
  }

  void check_loss() {
    for (const Force& force : assembly_.forces()) {
      if (force.record->thermostat) continue;  // see check_thermostats()
      const Traits& traits = force.traits;
      if (traits.depends_on_velocity || traits.stochastic || is_linear_friction(force)) {
        refuse(FaultCode::integrator_unsuitable,
               "is for scenes without loss; the force \"" + force.name + "\" depends on velocity",
               integrators_that(scene_, [&](const IntegratorRecord& other) {
                 return !other.conservative_only && !other.follows_equilibria &&
                        (!other.splits_friction || is_linear_friction(force));
               }));
      }
      refuse_internal_variables(force);
    }
    for (const auto& steered : assembly_.prescribed().steered()) {
      if (std::all_of(steered.own, steered.own + 4, [](auto at) { return at < 0; })) continue;
      const std::string& body = assembly_.bodies()[steered.body].bound.name;
      refuse(FaultCode::integrator_unsuitable,
             "does not advance the prescribed motion of the body \"" + body +
                 "\", whose velocity changes with time",
             any_scene_);
    }
  }

  void check_dynamics() {
    const SourceLocation& location = location_of("dynamics");
    for (const Force& force : assembly_.forces()) {
      if (!depends_on_velocity_otherwise(force)) continue;
      faults_.emplace_back(
          FaultCode::component_unsuitable, location, "run.dynamics",
          fmt::format("\"{}\"", to_string(scene_.run.dynamics)),
          "the force \"" + force.name + "\" depends on velocity and is not linear friction",
          "\"inertial\"");
    }
  }

  static constexpr const char* kUntil = "until";

  const Assembly<double>& assembly_;
  const Scene& scene_;
  const IntegratorRecord& scheme_;
  const std::string any_scene_;
  std::vector<Fault> faults_;
};

}  // namespace

std::string integrators_for_any_scene(const Scene& scene) {
  return integrators_that(scene,
                          [](const IntegratorRecord& record) { return record.takes_any_scene(); });
}

std::string integrators_with_bonds_as_forces(const Scene& scene) {
  return integrators_that(scene, [](const IntegratorRecord& record) {
    return !record.splits_bonds && !record.conservative_only && !record.follows_equilibria;
  });
}

void check_scheme(const Assembly<double>& assembly) {
  std::vector<Fault> faults = SchemeChecks(assembly).faults();
  if (!faults.empty()) throw InputError(std::move(faults));
}

}  // namespace tomlin
