#include "framework/model/assembled_forces.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/core/records/facets.hpp"
#include "framework/model/plugin_code.hpp"

namespace tomlin {

Fault fault_of(const SceneForce& force, const Complaint& complaint) {
  Fault fault(complaint.code);
  fault.location = force.location_of(complaint.key);
  if (complaint.column && fault.location.line > 0 && force.locations.contains(complaint.key)) {
    fault.location.column += static_cast<int>(*complaint.column) + 1;  // behind the quotation mark
  }
  fault.key = "force." + force.name + "." + complaint.key;
  fault.why = complaint.why;
  fault.admissible = complaint.admissible;
  fault.nearest = complaint.nearest;
  return fault;
}

namespace {

Fault not_in_this_number_type(const RunSettings& run, const SceneForce& force) {
  return Fault(FaultCode::number_type_unsuitable, run.location_of("number_type"), "run.number_type",
               fmt::format("\"{}\"", to_string(run.number_type)),
               "not available with the force \"" + force.name + "\", of type " + force.record->name,
               "\"double\"");
}

/// Why nothing of the scene would change without a force; empty where something would.
template <class Real>
std::string why_left_out(const SceneForce& from, const Traits& traits,
                         const std::vector<AssembledBody<Real>>& bodies) {
  const auto all_of = [&](auto&& holds) {
    return std::all_of(from.bodies.begin(), from.bodies.end(),
                       [&](std::size_t b) { return holds(bodies[b]); });
  };
  if (traits.internal && from.bodies.size() == 1 &&
      all_of([](const auto& body) { return body.bound.slot.rigid || body.prescribed(); })) {
    return "internal to a rigid body, where it does nothing";
  }
  const bool nothing_moves =
      all_of([](const auto& body) { return body.bound.coordinates == Coordinates::fixed; });
  const bool drives = traits.does_work || from.driver;
  return nothing_moves && !drives ? "acts only on what is fixed" : "";
}

/// Why a force cannot be declared a driver; empty where it can.
template <class Real>
std::string why_no_driver(const AssembledForce<Real>& force, bool quasistatic) {
  if (force.traits.internal) return "it is internal to what it acts on, and drives nothing";
  if (force.traits.dissipative || force.friction->is_friction()) return "it is friction";
  if (force.variables->own_count() > 0) return "it has internal variables";
  const bool by_velocity = !(force.traits.conservative && force.traits.depends_on_time);
  if (quasistatic && by_velocity) {
    return "its work follows from velocities, and quasistatic dynamics have none";
  }
  return "";
}

/// Why a force cannot be active at some times only, or at these; empty where it can, or is so
/// always.
template <class Real>
std::string why_always_active(const AssembledForce<Real>& force, const AssemblyPlan& plan) {
  if (force.switched == nullptr) return "";
  if (plan.quasistatic) return "quasistatic dynamics follow one energy from the start to the end";
  if (force.given->driver && !force.traits.does_work) {
    return "it is declared to be a driver, which acts at all times";
  }
  if (!plan.inertial && force.is_operator) {
    return "without inertia velocities follow from friction, which acts at all times";
  }
  const RunSettings& run = plan.scene->run;
  if (run.until) {
    return "run.until ends the run when a state of forces that act at all times is steady, or "
           "known";
  }
  if (!(force.given->active->from < run.duration)) {
    return "it would become active at the end of the run, or later";
  }
  if (force.control->waits_for() != nullptr) {
    return "its driver reverses, and does so at all times";
  }
  const PulledEnd* const end = force.pulled_end;
  const bool follows = end != nullptr && force.given->active->from > 0.0;
  if (follows && end->is_of_each_particle() && end->starts_at_point()) {
    return "where each particle's support starts is known at the start of the run only: give start";
  }
  const IntegratorRecord& scheme = *run.integrator.record;
  if (scheme.splits_bonds) {
    return "the integrator \"" + scheme.name + "\" takes bonds and friction as one, at all times";
  }
  return "";
}

/// On bodies that move by forces; what is prescribed or fixed is dragged along as ever.
template <class Real>
bool taken_as_operator(const AssembledForce<Real>& force, const AssemblyPlan& plan,
                       const std::vector<AssembledBody<Real>>& bodies) {
  if (plan.quasistatic) return force.friction->is_friction();
  if (plan.inertial && !plan.splits_friction) return false;
  Flow<Real> unused;
  const bool flows = plan.inertial && force.exact_flow->flow(unused);
  if (!flows && !force.friction->is_friction()) return false;
  return std::none_of(force.bodies.begin(), force.bodies.end(), [&](std::size_t b) {
    return bodies[b].bound.slot.mapped && !bodies[b].bound.slot.rigid;
  });
}

/// Why a force cannot keep its bodies at a temperature, by noise or without; nothing where it can.
template <class Real>
std::optional<Complaint> why_no_thermostat(const SceneForce& from,
                                           const std::vector<AssembledBody<Real>>& bodies,
                                           std::vector<const SceneForce*>& thermostats) {
  for (const std::size_t b : from.bodies) {
    const AssembledBody<Real>& body = bodies[b];
    if (body.bound.coordinates == Coordinates::fixed || body.prescribed()) {
      return Complaint{"temperature",
                       "the body \"" + body.bound.name +
                           "\" does not move by forces: a thermostat does "
                           "nothing to it",
                       "a body with coordinates \"particles\" or \"rigid\""};
    }
    if (body.bound.freedom == 0) {
      return Complaint{"temperature",
                       "all coordinates of the body \"" + body.bound.name +
                           "\" are held: a thermostat does nothing to it",
                       "a body with a coordinate that is free"};
    }
    if (thermostats[b] != nullptr) {
      return Complaint{"temperature",
                       "the force \"" + thermostats[b]->name + "\" is a thermostat of the body \"" +
                           body.bound.name + "\" already",
                       "one force with a temperature for each body"};
    }
    thermostats[b] = &from;
  }
  return std::nullopt;
}

/// How many numbers of the run's state events change of a force, its switch included.
template <class Real>
std::size_t control_count_of(const AssembledForce<Real>& force) {
  const std::size_t own = force.switched ? ForceSwitch<Real>::kCount : 0;
  return own + force.control->control_count();
}

}  // namespace

template <class Real>
void AssembledForce<Real>::bind(std::unique_ptr<BoundForce<Real>> force) {
  bound = std::move(force);
  curvature = facet_of<Curvature<Real>>(*bound);
  friction = facet_of<FrictionCoefficients>(*bound);
  exact_flow = facet_of<ExactFlow<Real>>(*bound);
  variables = facet_of<InternalVariables<Real>>(*bound);
  driving = facet_of<Driving>(*bound);
  control = facet_of<Control>(*bound);
  diagnosis = facet_of<Diagnosis<Real>>(*bound);
  pulled_end = dynamic_cast<PulledEnd*>(bound.get());
}

template <class Real>
bool AssembledForce<Real>::heat(std::ptrdiff_t rate, Operation<Real>& operation) const {
  if (!bound->heat(rate, operation)) return false;
  if (switched) operation = switched->gated(operation, static_cast<std::size_t>(rate));
  return true;
}

template <class Real>
bool AssembledForce<Real>::flow(Flow<Real>& flow) const {
  if (!exact_flow->flow(flow)) return false;
  if (switched) flow = switched->gated(flow);
  return true;
}

template <class Real>
AssembledForces<Real>::AssembledForces(const AssemblyPlan& plan,
                                       const AssembledBodies<Real>& assembled) {
  const std::vector<AssembledBody<Real>>& bodies = assembled.all;
  std::vector<Fault> faults;
  std::vector<const SceneForce*> thermostats(bodies.size());
  for (const SceneForce& from : plan.scene->forces) {
    const Traits traits = bound_by(from, "force", [&] { return from.traits(); });
    if (traits.stochastic || from.record->thermostat) {
      if (auto complaint = why_no_thermostat(from, bodies, thermostats)) {
        complaint->code = FaultCode::component_unsuitable;
        faults.push_back(fault_of(from, *complaint));
        continue;
      }
    }
    if (std::string why = why_left_out(from, traits, bodies); !why.empty()) {
      left_out.push_back({from.name, std::move(why)});
      continue;
    }
    Binding<Real> binding;
    binding.dimension = plan.dimension();
    binding.set = plan.set;
    binding.origin = plan.origin;
    binding.box = plan.box;
    for (const std::size_t b : from.bodies) binding.bodies.push_back(&bodies[b].bound);
    binding.variations = from.variations;
    const auto factory = from.record->bind.template in<Real>();
    if (factory == nullptr) {
      faults.push_back(not_in_this_number_type(plan.scene->run, from));
      continue;
    }
    AssembledForce<Real> force;
    force.name = from.name;
    force.record = from.record;
    force.given = &from;
    force.traits = traits;
    force.bodies = from.bodies;
    try {
      force.bind(bound_by(from, "force",
                          [&] { return something(factory(from.description.get(), binding)); }));
    } catch (const BindError& error) {
      faults.push_back(fault_of(from, error.complaint));
      continue;
    }
    const std::string& library = from.record->library;
    // An exception of a plugin is caught in the thread of the run only.
    if (plan.team != nullptr && library.empty()) {
      facet_of<SharesWork>(*force.bound)->share_with(*plan.team);
    }
    if (from.active) {
      force.switched =
          std::make_unique<ForceSwitch<Real>>(*force.bound, from.active->from, from.active->until);
    }
    force.is_operator = taken_as_operator(force, plan, bodies);
    if (std::string why = why_always_active(force, plan); !why.empty()) {
      Complaint complaint{"active", std::move(why), "no active"};
      complaint.code = FaultCode::component_unsuitable;
      faults.push_back(fault_of(from, complaint));
      continue;
    }
    if (force.switched && force.is_operator) force.switched->is_taken_as_operator();
    if (from.driver && !traits.does_work) {
      if (std::string why = why_no_driver(force, plan.quasistatic); !why.empty()) {
        Complaint complaint{"driver", std::move(why), "false"};
        complaint.code = FaultCode::component_unsuitable;
        faults.push_back(fault_of(from, complaint));
        continue;
      }
      const Element element = element_of(*from.record, from.description.get());
      force.driver = std::make_unique<DeclaredDriver<Real>>(*force.bound, traits, element,
                                                            force.bodies, plan, assembled);
    }
    if (force.bound->depends_on_time()) timed_.push_back(force.bound.get());
    all.push_back(std::move(force));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

template <class Real>
void AssembledForces<Real>::begin_step(const DoubleDouble& time, const Origin& origin) {
  for (BoundForce<Real>* force : timed_) force->begin_step(time);
  for (const AssembledForce<Real>& force : all) {
    if (force.driver) force.driver->begin_step(time, origin);
  }
}

template <class Real>
void AssembledForces<Real>::rebase(const Origin& origin) {
  for (AssembledForce<Real>& force : all) force.bound->rebase(origin);
}

template <class Real>
void AssembledForces<Real>::declare_controls(StateLayout& layout) const {
  for (const AssembledForce<Real>& force : all) {
    const std::size_t count = control_count_of(force);
    if (count > 0) layout.add_reals("control." + force.name, count);
  }
}

template <class Real>
void AssembledForces<Real>::attach_controls(RunState& state) {
  for (const AssembledForce<Real>& force : all) {
    if (control_count_of(force) == 0) continue;
    double* control = state.reals("control." + force.name);
    if (force.switched) {
      force.switched->attach_control(control);
      control += ForceSwitch<Real>::kCount;
    }
    if (force.control->control_count() > 0) force.control->attach_control(control);
  }
}

template <class Real>
void AssembledForces<Real>::start_controls() {
  for (const AssembledForce<Real>& force : all) {
    force.control->start_control();
    if (force.switched) force.switched->start_control();
  }
}

template struct AssembledForce<double>;
template struct AssembledForce<Quad>;
template class AssembledForces<double>;
template class AssembledForces<Quad>;

}  // namespace tomlin
