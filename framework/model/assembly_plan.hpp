#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/team.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// Noise on the start, for seeing whether a result is determined.
struct Perturbation {
  std::vector<std::size_t> bodies;
  double size = 0.0;
  std::uint64_t seed = 0;
  std::uint64_t stream = 0;
};

/// Decisions of the model for a scene before it is bound.
struct AssemblyPlan {
  int dimension() const { return scene->dimension; }

  const Scene* scene = nullptr;
  std::shared_ptr<const std::vector<BodyGeometry>> geometry;  ///< of each body
  Origin origin;                                              ///< at time 0
  std::array<double, 3> box{};  ///< length of each periodic axis, else 0
  InstructionSet set = InstructionSet::baseline;
  bool inertial = true;
  bool splits_friction = false;
  bool quasistatic = false;  ///< no friction acts, on nothing
  bool ledger = false;
  bool half_step_velocities = false;
  const Team* team = nullptr;  ///< of threads that share evaluations; null: one thread
  bool backwards = false;  ///< kernels in the opposite order: another sums the same, to rounding
};

/// About each axis in one step, in rad, of a rigid body in space: far from half a turn, for which
/// its coordinates have no value.
inline constexpr double kLargestRotation = 0.5;

/// Index of the rotation among a planar body's coordinates.
inline constexpr std::size_t kRotation = 2;

}  // namespace tomlin
