#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/lanes.hpp"
#include "framework/core/system/system.hpp"
#include "framework/model/assembled_forces.hpp"
#include "framework/model/friction_matrix.hpp"
#include "framework/model/prescribed_bodies.hpp"

namespace tomlin {

/// A kernel call of an evaluation, as replicas in lanes make it.
struct LaneCall {
  LaneForm form;                 ///< without a kernel: there is none over replicas
  const void* single = nullptr;  ///< the arguments of the call
  bool set = false;
  std::ptrdiff_t arms = -1;  ///< of calls with the same scratch: those of this rigid body
};

/// How a heat is computed over replicas, see BoundForce::heat().
template <class Real>
LaneCall lane_call_of(const Operation<Real>& heat) {
  return {heat.lanes != nullptr ? *heat.lanes : LaneForm(), heat.arguments};
}

/// The kernel calls of one evaluation of all forces, in order: bodies that move as one place their
/// particles; forces on rigid centres; forces on particles, cheap ones first; rigid bodies gather;
/// the ledger. The first force on each region sets, the rest add.
template <class Real>
class Evaluation {
 public:
  Evaluation(const AssemblyPlan& plan, AssembledBodies<Real>& bodies,
             const PrescribedBodies<Real>& prescribed,
             const std::vector<AssembledForce<Real>>& forces, FrictionMatrix<Real>& friction,
             SystemView<Real>& view);
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  /// Writes no numbers where the next evaluation has to write forces, so that a kernel that adds to
  /// what it should set shows.
  void spoil(const Stage<Real>& stage) const { spoil(&written_, stage); }

  /// The calls that make one evaluation over replicas; of double. None where one is missing.
  const std::vector<LaneCall>& lane_calls() const { return lane_calls_; }
  std::vector<LaneCall>& lane_calls() { return lane_calls_; }

 private:
  /// Numbers in one of the arrays of forces.
  struct Range {
    bool mapped = false;
    std::size_t offset = 0;
    std::size_t length = 0;
  };
  /// Heats of forces in a scene without inertia.
  struct Drifted {
    std::vector<Operation<Real>> placements;  ///< of bodies that move as one
    std::vector<Operation<Real>> heats;
    mutable AlignedVector<Real> velocity;
    const Real* mobility = nullptr;
    std::size_t dofs = 0;
  };
  /// Arrays of forces that have been written so far, by body.
  struct Regions {
    std::vector<bool> particles;
    std::vector<bool> centre;

    std::vector<bool>::reference of(const Region& region) {
      return region.centre ? centre[region.body] : particles[region.body];
    }
  };

  void add_zeros(const BodySlot<Real>& slot, int dimension, bool centre);
  void add_pass(const Pass<Real>& pass, const AssembledBodies<Real>& bodies, int dimension,
                Regions& set);
  void gather(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies,
              const PrescribedBodies<Real>& prescribed, Regions& set);
  void add_heats(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies,
                 const std::vector<AssembledForce<Real>>& forces, FrictionMatrix<Real>& friction,
                 const SystemView<Real>& view);
  void add_point_forces(const std::vector<Pass<Real>>& passes, SystemView<Real>& view);
  void add_call(const Operation<Real>& operation, LaneCall lanes = {});
  void add_rigid(Kernel<Real> kernel, const AssembledBodies<Real>& bodies, std::size_t k,
                 Kernel<double> over_lanes, bool set);
  static void write_zeros(const void* range, const Stage<Real>& stage);
  static void write_zeros_in_lanes(const void* arguments, const Stage<double>& stage);
  static void spoil(const void* ranges, const Stage<Real>& stage);
  static void heat_of_drift(const void* drifted, const Stage<Real>& stage);

  std::vector<Operation<Real>> operations_;
  std::vector<LaneCall> lane_calls_;  ///< one for each of them, but for checks of debug builds
  std::deque<Range> zeros_;           ///< where no force acts
  std::vector<Range> written_;        ///< all that kernels which set have to set
  Drifted drifted_;
  std::vector<PointForce<Real>> point_forces_;
};

}  // namespace tomlin
