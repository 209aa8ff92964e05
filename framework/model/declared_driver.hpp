#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/model/assembled_bodies.hpp"
#include "framework/model/assembly_plan.hpp"

namespace tomlin {

/// A force of any kind that a scene declares to be a driver (`driver = true`): it stands among the
/// drivers with its force on each axis and its work.
///
/// Where its energy changes with time, V(x, t), it does the work dV/dt on the scene, as the pulled
/// end of a spring does, and V stays a stored energy. Any other does the work F.v on what it acts
/// on, and stores nothing.
///
/// A force that is linear in the position of its body as a whole, F = k (X(t) - x), is a spring
/// with its support at X(t): k and X follow from its values, and X moves at a steady velocity or
/// not.
template <class Real>
class DeclaredDriver {
 public:
  /// The force is not yet evaluated by anybody. All must outlive the driver.
  DeclaredDriver(BoundForce<Real>& force, const Traits& traits, Element element,
                 const std::vector<std::size_t>& on, const AssemblyPlan& plan,
                 const AssembledBodies<Real>& bodies);
  DeclaredDriver(const DeclaredDriver&) = delete;
  DeclaredDriver& operator=(const DeclaredDriver&) = delete;

  /// Evaluates the force, and writes its total on each axis to the rates.
  Pass<Real> pass() const;
  /// After it: writes the power.
  Operation<Real> power() const { return {&write_power, this}; }
  void place_rates(std::ptrdiff_t first);
  void begin_step(const DoubleDouble& time, const Origin& origin);

  const Drive& drive() const { return drive_; }
  bool stores_energy() const { return stores_energy_; }

 private:
  /// Numbers of one axis that the force writes.
  struct Part {
    bool mapped = false;
    int axis = 0;
    std::size_t offset = 0;
    std::size_t count = 0;
  };
  using Total = std::array<double, 3>;

  void list_parts(const AssembledBodies<Real>& bodies, const Region& region);
  void act(const Stage<Real>& stage) const;
  void find_support(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies, std::size_t body,
                    double duration);
  static void drive(const void* driver, const Stage<Real>& stage);
  static void write_power(const void* driver, const Stage<Real>& stage);

  BoundForce<Real>& force_;
  std::vector<Pass<Real>> passes_;
  std::vector<Region> regions_;
  std::vector<Part> parts_;
  mutable AlignedVector<Real> own_;  ///< the force alone
  mutable AlignedVector<Real> own_mapped_;
  int dimension_;
  bool stores_energy_;
  bool of_centre_ = false;  ///< it takes hold of the centre of mass
  std::ptrdiff_t rate_ = kNoRate;
  Operation<Real> heat_;
  Drive drive_;
  Origin first_origin_;
};

}  // namespace tomlin
