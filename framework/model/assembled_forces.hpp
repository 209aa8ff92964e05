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
#include "framework/model/switched_force.hpp"

namespace tomlin {

/// A force of a bound scene.
template <class Real>
struct AssembledForce {
  std::string name;
  const ForceRecord* record = nullptr;
  const SceneForce* given = nullptr;  ///< in the scene
  Traits traits;                      ///< its properties, as the scene describes it
  std::unique_ptr<BoundForce<Real>> bound;
  std::vector<std::size_t> bodies;
  std::ptrdiff_t first_rate = kNoRate;  ///< where its force and power stand among the rates
  std::ptrdiff_t heat_rate = kNoRate;   ///< where its heat stands, with the ledger
  bool is_operator = false;             ///< taken by its flow, not evaluated as a force
  std::unique_ptr<DeclaredDriver<Real>> driver;  ///< where the scene declares it to be one
  SwitchedForce<Real>* switched = nullptr;       ///< `bound`, where it is not active at all times

  const Drive* drive() const { return driver ? &driver->drive() : bound->drive(); }
  std::vector<Pass<Real>> passes() const {
    return driver ? std::vector<Pass<Real>>{driver->pass()} : bound->passes();
  }
  Real energy(const Stage<Real>& stage) const {
    return driver && !driver->stores_energy() ? Real(0.0) : bound->energy(stage);
  }
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
