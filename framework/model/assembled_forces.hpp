#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/model/assembled_bodies.hpp"
#include "framework/model/declared_driver.hpp"
#include "framework/model/force_switch.hpp"

namespace tomlin {

/// A force of a bound scene.
template <class Real>
struct AssembledForce {
  std::string name;
  const ForceRecord* record = nullptr;
  const SceneForce* given = nullptr;  ///< in the scene
  Traits traits;                      ///< its properties, as the scene describes it
  std::unique_ptr<BoundForce<Real>> bound;
  // The facets of `bound`, or those of a force without them.
  const Curvature<Real>* curvature = nullptr;
  const FrictionCoefficients* friction = nullptr;
  ExactFlow<Real>* exact_flow = nullptr;
  InternalVariables<Real>* variables = nullptr;
  Driving* driving = nullptr;
  Control* control = nullptr;
  const Diagnosis<Real>* diagnosis = nullptr;
  PulledEnd* pulled_end = nullptr;  ///< null where it pulls nothing
  std::vector<std::size_t> bodies;
  std::ptrdiff_t first_rate = kNoRate;  ///< where its force and power stand among the rates
  std::ptrdiff_t heat_rate = kNoRate;   ///< where its heat stands, with the ledger
  bool is_operator = false;             ///< taken by its flow, not evaluated as a force
  std::unique_ptr<DeclaredDriver<Real>> driver;  ///< where the scene declares it to be one
  std::unique_ptr<ForceSwitch<Real>> switched;   ///< where it is not active at all times

  void bind(std::unique_ptr<BoundForce<Real>> force);

  const Drive* drive() const { return driver ? &driver->drive() : driving->drive(); }
  bool is_active() const { return !switched || switched->is_active(); }

  // These functions return what the force does while it is active, and nothing at other times.

  std::vector<Pass<Real>> own_passes() const {
    return switched ? switched->gated(bound->passes()) : bound->passes();
  }
  /// A driver that the scene declares calls the kernels of its force itself.
  std::vector<Pass<Real>> passes() const {
    return driver ? std::vector<Pass<Real>>{driver->pass()} : own_passes();
  }
  Real energy(const Stage<Real>& stage) const {
    if (driver && !driver->stores_energy()) return Real(0.0);
    return switched ? switched->energy(stage) : bound->energy(stage);
  }
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) const;
  bool flow(Flow<Real>& flow) const;
};

/// A force of the scene that was not built, and why.
struct ForceLeftOut {
  std::string force;
  std::string why;
};

/// A complaint about a force of the scene, at the key that it is about.
Fault fault_of(const SceneForce& force, const Complaint& complaint);

/// The forces of a scene, bound to its bodies.
template <class Real>
class AssembledForces {
 public:
  /// Throws InputError for forces that do not fit the bodies or the number type.
  AssembledForces(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies);

  void begin_step(const DoubleDouble& time, const Origin& origin);
  void rebase(const Origin& origin);

  // The run's state holds whatever events change of the forces.

  void declare_controls(StateLayout& layout) const;
  void attach_controls(RunState& state);
  void start_controls();

  std::vector<AssembledForce<Real>> all;
  std::vector<ForceLeftOut> left_out;

 private:
  std::vector<BoundForce<Real>*> timed_;
};

}  // namespace tomlin
