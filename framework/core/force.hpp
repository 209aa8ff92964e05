#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/core/body.hpp"
#include "framework/core/registry.hpp"
#include "framework/core/traits.hpp"

/// Forces as the registry knows them. What a force becomes when a scene is bound stands in
/// framework/core/bound_force.hpp.
namespace tomlin {

template <class Real>
class BoundForce;
template <class Real>
struct Binding;

/// What a force may ask about the scene when its description is checked.
struct SceneOutline {
  int dimension = 0;
  std::array<double, 3> box{};  ///< length of each periodic axis, else 0
  struct Body {
    std::string name;
    std::int64_t count = 0;
    bool closed = false;  ///< "neighbours" joins its ends, by its shape or through the box
  };
  std::vector<Body> bodies;  ///< those the force acts on, in the order named
};

/// For forces whose keys need no checking against each other.
inline std::vector<Complaint> no_complaints(const void*, const SceneOutline&) { return {}; }

/// For forces that declare no period.
inline double no_period(const void*, int) { return 0.0; }

struct ForceRecord : ComponentRecord {
  Element element = Element::site;
  Traits traits;
  int fewest_bodies = 1;
  int most_bodies = 1;

  /// Faults across keys and against the bodies; empty when sound.
  std::vector<Complaint> (*complaints)(const void* description,
                                       const SceneOutline& scene) = &no_complaints;
  /// Period of the force along an axis; 0 when it declares none. The longest period declared on
  /// an axis becomes the unit in which the scene's origin moves.
  double (*period)(const void* description, int axis) = &no_period;

  /// Factories by number type. A missing one removes that number type for scenes with this force.
  std::unique_ptr<BoundForce<double>> (*bind)(const void* description,
                                              const Binding<double>& binding) = nullptr;
};

}  // namespace tomlin
