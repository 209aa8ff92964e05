#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "framework/core/system/state_layout.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/assembled_bodies.hpp"
#include "framework/model/assembled_forces.hpp"
#include "framework/model/assembly_plan.hpp"
#include "framework/model/coordinate_arrays.hpp"
#include "framework/model/evaluation.hpp"
#include "framework/model/final_state.hpp"
#include "framework/model/friction_matrix.hpp"
#include "framework/model/prescribed_bodies.hpp"

/// A scene bound in one number type: particles, coordinates, forces, and the list of kernel calls
/// that evaluates them. What can be read off it is the model's business (model.hpp).
namespace tomlin {

template <class Real>
class Assembly {
 public:
  using Body = AssembledBody<Real>;
  using Force = AssembledForce<Real>;
  using Driver = AssembledDriver;
  using LeftOut = ForceLeftOut;

  /// Throws InputError for faults that only show now.
  explicit Assembly(const AssemblyPlan& plan);
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  const Scene& scene() const { return *plan_.scene; }
  int dimension() const { return plan_.dimension(); }
  const std::vector<Body>& bodies() const { return bodies_.all; }
  const std::vector<Force>& forces() const { return forces_.all; }
  const std::vector<Driver>& drivers() const { return drivers_; }
  const std::vector<LeftOut>& left_out() const { return forces_.left_out; }
  const PrescribedBodies<Real>& prescribed() const { return prescribed_; }
  /// See Evaluation::lane_calls().
  const std::vector<LaneCall>& lane_calls() const { return evaluation_->lane_calls(); }
  std::vector<LaneCall>& lane_calls() { return evaluation_->lane_calls(); }
  /// Length of the arrays of positions that follow from coordinates, with padding; see LaneSystem.
  std::size_t mapped_size() const { return bodies_.mapped_size; }
  System<Real>& system() { return system_; }
  const System<Real>& system() const { return system_; }
  /// Index of all operators' heat among the integrals, with the ledger.
  std::ptrdiff_t friction_rate() const { return friction_.rate; }

  /// Fill these with the scene's start, or where another run has ended; cells of the origin stay as
  /// they are.
  void start(Real* position, Real* velocity, Real* integrals, const Perturbation* noise,
             const FinalState* from = nullptr);
  /// The numbers of the present state.
  void write_numbers(FinalState& state) const;
  /// Writes the positions of drivers, for the numbers that have been written.
  void write_supports(const DoubleDouble& time, FinalState& state) const;
  void declare_controls(StateLayout& layout) const { forces_.declare_controls(layout); }
  void attach_controls(RunState& state) { forces_.attach_controls(state); }
  void start_controls() { forces_.start_controls(); }
  /// Stages count their time from here on.
  void begin_step(const DoubleDouble& time);
  std::size_t rotor_count() const { return bodies_.rotor_count(); }
  void orient(std::size_t rotor, const Quaternion& orientation) {
    bodies_.orient(rotor, orientation);
  }
  /// The origin has moved; positions in the state are the caller's to shift.
  void rebase(const Origin& origin);
  /// See Evaluation::spoil().
  void spoil_forces();

 private:
  void assign_rates();
  void assign_kinetic(std::size_t& rates);
  void start_supports(const FinalState& from, Real* own);

  // Each is laid over those before it; kernels hold pointers into them.
  AssemblyPlan plan_;
  Origin origin_;
  System<Real> system_;
  AssembledBodies<Real> bodies_;
  CoordinateArrays<Real> coordinates_;
  AssembledForces<Real> forces_;
  PrescribedBodies<Real> prescribed_;
  std::vector<Driver> drivers_;
  std::vector<KineticIntegral> kinetic_;
  FrictionMatrix<Real> friction_;
  std::optional<Evaluation<Real>> evaluation_;
};

extern template class Assembly<double>;
extern template class Assembly<Quad>;

}  // namespace tomlin
