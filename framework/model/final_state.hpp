#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/numbers/quad.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/model/principal_axes.hpp"

namespace tomlin {

/// The end of a run, for another one to start from, whose scene has the same bodies and
/// internal variables: its parameters, dynamics and number type may be others. Quads hold the
/// numbers of every type.
struct FinalState {
  /// A support or a prescribed body, in the scene's own coordinates; the rotation of a
  /// planar body, in rad, comes after its axes.
  struct Support {
    std::string name;
    std::vector<Quad> position;
  };

  /// A rigid body in space; its coordinates of rotation are relative to axes of its own.
  struct Rotor {
    Quaternion rotation{};         ///< from the start
    std::array<double, 3> spin{};  ///< angular velocity, along the axes of space
  };

  std::vector<std::string> structure;  ///< what must be the same, a line each; empty: unknown
  Origin origin;
  std::vector<Quad> position;  ///< as coordinates, relative to the origin
  std::vector<Quad> velocity;
  std::vector<Quad> own;  ///< internal variables
  std::vector<Rotor> rotors;
  std::vector<Support> supports;

  bool known() const { return !structure.empty(); }
  const Support* support(const std::string& name) const;
};

/// With all the digits that each of them has.
inline Quad to_quad(const DoubleDouble& x) { return Quad(x.hi) + Quad(x.lo); }
inline DoubleDouble to_double_double(Quad x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - Quad(high))};
}

/// Returns the absolute position of one that is relative to the origin.
Quad absolute_position(const Origin& origin, int axis, Quad relative);

}  // namespace tomlin
