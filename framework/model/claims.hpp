#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/scene/scene.hpp"

/// What the forces of a scene claim by their traits, held against what they do to this scene's
/// bodies with this scene's numbers.
namespace tomlin {

/// One claim of one force.
struct ClaimResult {
  std::string force;  ///< its name in the scene
  std::string type;
  std::string claim;    ///< "conservative", "internal", "dissipative", "periodic"
  std::string meaning;  ///< what was compared: "force = -gradient of the energy"
  bool holds = false;
  /// Relative, at the state where it is the largest part of what is allowed.
  double error = 0.0;
  double allowed = 0.0;  ///< what rounding and finite differences explain there
  int states = 0;        ///< that were looked at
  std::string worst;     ///< there: "ring, particle 3, x"; may be empty
};

struct ClaimOptions {
  int displaced_states = 8;  ///< besides the start
  std::uint64_t seed = 1;    ///< of the displacements
};

/// Checks every force that the scene builds, in the scene's order, each on its own: at the start,
/// and at random displacements of every coordinate by up to a tenth of the shortest length.
///
///   conservative  virtual work of the force equals minus the change of its energy. The slope of
///                 the energy is the limit of central differences, whose error falls as h^2.
///   internal      forces and torques on all bodies it acts on sum to zero
///   dissipative   its power is never positive, for random velocities
///   periodic      a shift of everything by the declared period changes nothing
///
/// Throws InputError when the scene cannot be bound.
std::vector<ClaimResult> check_claims(const Scene& scene, const ClaimOptions& options = {});

}  // namespace tomlin
