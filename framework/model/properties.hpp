#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/scene/scene.hpp"

/// Declarations of a scene's forces by their traits and contracts, held against what they do to
/// this scene's bodies with this scene's numbers. The properties themselves stand in properties/.
namespace tomlin {

/// The state in which a property was closest to breaking, or broke.
struct PropertyPoint {
  std::string state;             ///< "near the start", "far away", "almost touching", ...
  std::string body;              ///< empty: everything together
  std::ptrdiff_t particle = -1;  ///< -1: the body as a whole
  std::string coordinate;        ///< "x", "rotation"; empty: all of them
  std::vector<double> position;  ///< of the particle or the centre, relative to the scene's origin
  double time = 0.0;
  double found = 0.0;
  double expected = 0.0;

  std::string text() const;
};

/// Name under which the properties of all forces together are filed.
inline constexpr const char* kAllForces = "all forces";

/// One property of one force, or of all.
struct PropertyResult {
  std::string force;  ///< its name in the scene, or kAllForces
  std::string type;
  std::string property;  ///< "conservative", "internal", "dissipative", "periodic", ...
  std::string meaning;   ///< what was compared: "force = -gradient of the energy"
  bool holds = false;
  /// Relative, at the state where it is the largest part of what is allowed.
  double error = 0.0;
  double allowed = 0.0;  ///< what rounding and finite differences explain there
  int states = 0;        ///< at which something was compared; 0: the property holds for want of any
  PropertyPoint worst;
};

struct PropertyOptions {
  int displaced_states = 8;                 ///< besides the start
  std::uint64_t seed = 1;                   ///< of the displacements
  const std::atomic<bool>* stop = nullptr;  ///< true: no further property is looked at
};

/// Checks every force that the scene builds, in the scene's order, each on its own, by the table of
/// properties in properties.cpp; then, as "all forces", that together they do the sum of what each
/// does alone, in either order of evaluation. The states are the start; those near it, at random
/// displacements of every coordinate by up to a tenth of a length: the shortest that the scene
/// declares, or the force's own where nothing declares one or it is much shorter; far away, by a
/// thousand and a million of them; high above the start; and where two free particles almost touch,
/// a thousandth and a millionth of a length apart.
///
/// Throws InputError when the scene cannot be bound.
std::vector<PropertyResult> check_properties(const Scene& scene,
                                             const PropertyOptions& options = {});

}  // namespace tomlin
