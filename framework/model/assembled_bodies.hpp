#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/model/assembly_plan.hpp"
#include "framework/model/principal_axes.hpp"
#include "framework/model/rigid_kernels.hpp"

namespace tomlin {

/// A body of a bound scene.
template <class Real>
struct AssembledBody {
  BoundBody<Real> bound;
  double rolling_radius = 0.0;
  double rolling_rise = 0.0;
  /// In which it turns: rotations from the first axis to the second are positive, and it rolls
  /// along the first.
  std::array<int, 2> plane = {0, 1};
  bool turns_in_space = false;  ///< about the axis that is across the plane, see Model::rotation()
  double total_mass = 0.0;
  double inertia = 0.0;  ///< about the centre, planar bodies
  /// Rigid, and rotates in space: see RigidArguments.
  bool rotor = false;
  int free_rotations = 0;           ///< of a rotor: 3, or 1 about an axis of space
  std::array<double, 3> moments{};  ///< of inertia, of a rotor; 0 along a rod
  Quaternion orientation{};         ///< of its principal axes at the start
  int dimension = 0;                ///< of the scene
  /// [count][axis] of the particles at the start, about the centre; 0 along axes that are not there
  std::vector<std::array<double, 3>> arms;
  std::array<bool, 3> held{};  ///< axes along which nothing moves
  bool rotation_held = false;
  std::array<bool, 3> rotation_free = {true, true, true};  ///< about each axis of space
  // Responses of a rigid body: its inverse mass and inertia, or without inertia its inverse
  // friction; zero where held.
  std::array<double, 3> response{};
  double response_of_rotation = 0.0;
  /// From the centre to the point about which these responses are independent of each other: the
  /// centre of friction without inertia.
  std::array<double, 2> pivot{};
  const RigidArguments<Real>* rigid = nullptr;  ///< of one that moves as one
  const Motion* motion = nullptr;               ///< of a prescribed body
  std::size_t steering = 0;                     ///< which of the prescribed bodies it is
  std::ptrdiff_t kinetic_rate = kNoRate;  ///< where its kinetic energy stands, see KineticIntegral

  bool rotates() const { return arms.size() > 1 && (dimension == 2 || turns_in_space); }
  /// Its rotation is a coordinate, or three.
  bool has_free_rotation() const { return rotor || (rotates() && !rotation_held); }
  bool moves_as_one() const { return bound.slot.rigid; }
  bool prescribed() const { return motion != nullptr; }
  /// A particle about the centre at the start, along the principal axes of a rotor.
  std::array<double, 3> reference_arm(std::size_t particle) const;
};

/// The bodies of a scene: which part of the arrays is whose, masses, shapes, and the arguments with
/// which kernels place the particles of those that move as one. Kernels hold pointers into it.
template <class Real>
class AssembledBodies {
 public:
  /// Throws InputError for what cannot be placed, weighed or turned.
  explicit AssembledBodies(const AssemblyPlan& plan);

  std::vector<AssembledBody<Real>> all;
  std::size_t dofs = 0;         ///< length of the arrays of coordinates
  std::size_t mapped_size = 0;  ///< length of the arrays of positions that follow from coordinates

  std::deque<RigidArguments<Real>> rigid;  ///< of rigid and prescribed bodies
  std::vector<std::size_t> rigid_body;     ///< whose each of them is
  std::deque<AlignedVector<Real>> reference;

  std::size_t rotor_count() const { return axes_.size(); }
  /// The principal axes of a rotor, the first of which is 0, at p = 0.
  void orient(std::size_t rotor, const Quaternion& orientation);

 private:
  void give_slot(AssembledBody<Real>& body, const SceneBody& from, int dimension);
  void place(AssembledBody<Real>& body, const AssemblyPlan& plan);
  void keep_shape(AssembledBody<Real>& body, int dimension);

  std::deque<AlignedVector<Real>> share_;  ///< mass fractions, one array a body
  std::deque<AlignedVector<Real>> arms_;
  std::deque<std::array<Real, 18>> axes_;  ///< of rotors: at p = 0, and at p
};

}  // namespace tomlin
