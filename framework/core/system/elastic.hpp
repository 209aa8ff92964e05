#pragma once

#include <cstddef>
#include <vector>

namespace tomlin {

/// A body of particles with its bonds linearised about its shape at the start, for schemes that
/// take bonds and friction as an operator. Arrays run over its n = axes * count coordinates,
/// [axis * count + particle].
///
/// In the body's own frame, which turns with it in the plane, with u the displacements from the
/// shape, the normal coordinates are q = Q^T M^(1/2) u, and bonds and friction alone give
///   q_j'' = -squares_j (q_j - equilibrium_j) - friction_rate q_j'.
struct ElasticBody {
  std::size_t offset = 0;  ///< of the first particle's x among the coordinates
  std::size_t stride = 0;  ///< from one axis to the next
  std::size_t count = 0;
  int axes = 0;
  bool turns = false;  ///< has a rotation in the plane
  double total_mass = 0.0;
  double friction_rate = 0.0;     ///< coefficient/mass, the same for all its particles
  std::vector<double> mass;       ///< [count]
  std::vector<double> root_mass;  ///< [count], square roots in power_of_two_above(mass[0])
  std::vector<double> shape;      ///< [n], relative to the centre of mass

  // These are empty for a body without bonds.
  std::vector<double> modes;        ///< Q, [mode * n + coordinate]
  std::vector<double> squares;      ///< squared angular frequencies, [mode]
  std::vector<double> equilibrium;  ///< where the bonds alone rest, [mode]

  std::size_t size() const { return static_cast<std::size_t>(axes) * count; }
};

}  // namespace tomlin
