#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/flow.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/assembled_forces.hpp"
#include "framework/model/friction_kernels.hpp"

namespace tomlin {

/// Friction as a matrix: what dynamics without inertia divides forces by, and what splitting
/// schemes take as operators, behind those that forces hand out. Kernels hold pointers into it.
template <class Real>
class FrictionMatrix {
 public:
  FrictionMatrix() = default;
  FrictionMatrix(const FrictionMatrix&) = delete;
  FrictionMatrix& operator=(const FrictionMatrix&) = delete;

  /// Without inertia the inverse masses become inverse friction, and the bodies respond by it.
  /// Throws InputError where the matrix is then not positive definite.
  void lay(const AssemblyPlan& plan, std::vector<AssembledBody<Real>>& bodies,
           const std::vector<AssembledForce<Real>>& forces, AlignedVector<Real>& inverse_mass,
           SystemView<Real>& view);
  /// Without inertia: the kernels that divide the forces on rigid bodies, and with the ledger the
  /// one that writes the heat.
  void add_mobility(const AssemblyPlan& plan, std::vector<Operation<Real>>& operations);

  std::ptrdiff_t rate = kNoRate;  ///< where all operators' heat stands among the integrals

 private:
  /// Collects from forces that are operators and act at all times the flows that they hand out,
  /// else their coefficients.
  void collect(const AssemblyPlan& plan, const std::vector<AssembledForce<Real>>& forces);
  /// Collects the friction of one force, beside that of others.
  void collect(const AssembledForce<Real>& force);
  void begin(const std::vector<AssembledBody<Real>>& bodies);
  /// The friction that has been collected, body by body.
  void lay_bodies(const AssemblyPlan& plan, std::vector<AssembledBody<Real>>& bodies,
                  AlignedVector<Real>& inverse_mass);
  /// Noise of the bath that a body's friction stands for.
  void assign_noise(const AssemblyPlan& plan, const AssembledBody<Real>& body,
                    FrictionArguments<Real>& arguments);
  void lay_noise(const AssemblyPlan& plan, SystemView<Real>& view);
  void refuse_noise(const AssembledForce<Real>& thermostat, const std::string& why,
                    const std::string& admissible);
  void assign_rigid(const AssemblyPlan& plan, AssembledBody<Real>& body, Real* inverse_mass,
                    FrictionArguments<Real>& arguments);
  void assign_particles(const AssemblyPlan& plan, const AssembledBody<Real>& body,
                        Real* inverse_mass, FrictionArguments<Real>& arguments);
  AlignedVector<Real>& new_array(std::size_t length, Real value);
  /// A coordinate that moves without friction.
  void miss(const AssemblyPlan& plan, const AssembledBody<Real>& body,
            const std::string& coordinate);

  /// Coefficients of each body's particles.
  std::vector<std::vector<double>> coefficients_;
  std::vector<std::vector<double>> warmth_;  ///< coefficient times temperature; empty: no noise
  std::vector<const AssembledForce<Real>*> thermostats_;  ///< of each body; null: none
  std::vector<Fault> faults_;
  std::deque<FrictionArguments<Real>> friction_;
  std::deque<AlignedVector<Real>> arrays_;
  std::deque<std::vector<std::uint64_t>> drawn_for_;
  std::vector<Flow<Real>> flows_;
  std::vector<Noise<Real>> noises_;
  DriftHeatArguments<Real> drift_heat_;
  AlignedVector<Real> heat_of_bodies_;
  AlignedVector<Real> mobility_;
};

}  // namespace tomlin
